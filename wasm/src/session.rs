//! A capture in progress: over what a network predicts, or over poses alone.

use std::rc::Rc;

use js_sys::Uint32Array;
use self_cell::self_cell;
use vantage_core::planner::{
    Blind, Candidate, Contents, Finish, Plan, Session as CoreSession, View,
};
use vantage_core::record::SnapshotError;
use vantage_core::soarnet::{Model as CoreModel, Photo as CorePhoto, SoarNet};
use vantage_core::{Objective, Pose, Scores};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::memory::{Growing, MOST_NETWORK_VIEWS, NetworkMemory};
use crate::photo::Photo;
use crate::{Model, Pool, Refusal, input, output, plan};

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** The next view: its number, pose (rows of world_from_camera, 12 numbers), and why. `objective` is
 *  the one that chose it, if one did. `gain` is what is expected of it: of the objective, where 1 is
 *  all that can be had; of the mean of all four for "all-objectives"; of the hull's support, about 2.5 in all,
 *  for "support"; the distance to the nearest view in metres (or to its opposite side, as it counts) for
 *  "farthest"; 0 for "start" and "chance". */
export type NextView = {
  index: number; pose: Float32Array; gain: number; objective?: Objective;
  reason: "start" | "chance" | "farthest" | "all-objectives" | "support" | Objective; why: string;
};

/** Why there is no next view. */
export type Finish = "budget-spent" | "good-enough" | "nothing-left";

/** What has become of a candidate. */
export type Status = "available" | "visited" | "skipped" | "blocked";

/** How far a capture is. `scores` (0 to 1) and `gainLeft`, the best expected gain of one further photo
 *  (0 where no candidate is left), are a network's estimates: absent without one and before the first
 *  photo; so is `clutter`, how much of what lies beside the object its outlines take for it (0 to 1; above
 *  0.1 the background misleads them). `isEnough` says that the plan's stop rule has ended the session. */
export type Progress = {
  views: number; budget: number; isEnough: boolean;
  scores?: Record<Objective, number>; gainLeft?: Record<Objective, number>; clutter?: number;
};

/** Candidates in the order that moves the camera least, and the length of the way. */
export type Tour = { order: Uint32Array; lengthRad: number };
"#;

type Predicting<'m> = CoreSession<SoarNet<'m, NetworkMemory>, Growing>;

self_cell! {
    /// A session with a network, and the bytes of the network's model, which it borrows.
    struct Networked {
        owner: Rc<Vec<u8>>,

        #[covariant]
        dependent: Predicting,
    }
}

/// The session that a network scores, or nobody.
enum Inner {
    Poses(CoreSession<Blind, Growing>),
    Network(Networked),
}

/// Does the same with either session.
macro_rules! read {
    ($inner:expr, $session:ident => $act:expr) => {
        match $inner {
            Inner::Poses($session) => $act,
            Inner::Network(networked) => {
                let $session = networked.borrow_dependent();
                $act
            }
        }
    };
}

/// Does the same with either session, changing it.
macro_rules! change {
    ($inner:expr, $session:ident => $act:expr) => {
        match $inner {
            Inner::Poses($session) => $act,
            Inner::Network(networked) => networked.with_dependent_mut(|_, $session| $act),
        }
    };
}

/// The most places of a tour: its time grows with their square.
const MOST_PLACES: usize = 1024;

/// A capture in progress.
#[wasm_bindgen]
pub struct Session {
    inner: Inner,
}

#[wasm_bindgen]
impl Session {
    /// A session over the views of a pool. Without a model the plan must be one that looks at poses.
    #[wasm_bindgen(constructor)]
    pub fn try_new(
        pool: &Pool,
        #[wasm_bindgen(unchecked_param_type = "Plan")] plan: &JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Model")] model: &JsValue,
    ) -> Result<Session, Refusal> {
        let plan = plan::read(plan, pool.centre)?;
        Self::begin(pool, plan, Model::read(model)?.as_ref())
    }

    /// Where to stand next; undefined when the session is over. Asking again changes nothing.
    #[wasm_bindgen(js_name = nextView, unchecked_return_type = "NextView | undefined")]
    pub fn next_view(&mut self) -> JsValue {
        let next = change!(&mut self.inner, session => session.next_view());
        next.map_or(JsValue::UNDEFINED, |next| output::next_view(&next))
    }

    /// Takes in that candidate `index` was photographed, at `pose` if not exactly at its own. A network
    /// that sees photos needs one; without a network it is only checked.
    pub fn observe(
        &mut self,
        index: f64,
        #[wasm_bindgen(unchecked_optional_param_type = "Photo")] photo: &JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Float32Array")] pose: &JsValue,
    ) -> Result<(), Refusal> {
        let index = whole_index(index)?;
        let pose = match input::optional_pose("pose", pose)? {
            Some(pose) => pose,
            None => *read!(&self.inner, session => session.candidate(index))?.pose(),
        };
        self.take_in(Some(index), pose, Photo::read(photo)?)
    }

    /// Takes in a photo that was taken at `pose`, for no candidate.
    #[wasm_bindgen(js_name = observeElsewhere)]
    pub fn observe_elsewhere(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Float32Array")] pose: &JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Photo")] photo: &JsValue,
    ) -> Result<(), Refusal> {
        let pose = input::pose(&input::floats("pose", pose)?)?;
        self.take_in(None, pose, Photo::read(photo)?)
    }

    /// Candidate `index` cannot be reached.
    pub fn block(&mut self, index: f64) -> Result<(), Refusal> {
        let index = whole_index(index)?;
        Ok(change!(&mut self.inner, session => session.block(index))?)
    }

    /// Candidate `index` can be reached after all.
    pub fn unblock(&mut self, index: f64) -> Result<(), Refusal> {
        let index = whole_index(index)?;
        Ok(change!(&mut self.inner, session => session.unblock(index))?)
    }

    /// Not candidate `index` now; perhaps after the next photo.
    pub fn skip(&mut self, index: f64) -> Result<(), Refusal> {
        let index = whole_index(index)?;
        Ok(change!(&mut self.inner, session => session.skip(index))?)
    }

    /// Goes on with another plan; views, blocked candidates and what was learned stay.
    pub fn replan(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Plan")] plan: &JsValue,
    ) -> Result<(), Refusal> {
        let plan = plan::read(plan, self.plan().centre())?;
        if let Inner::Poses(_) = self.inner {
            poses_suffice(&plan)?;
        }
        Ok(change!(&mut self.inner, session => session.replan(plan))?)
    }

    /// Why there is no next view; undefined while there is one.
    #[wasm_bindgen(unchecked_return_type = "Finish | undefined")]
    pub fn finish(&mut self) -> JsValue {
        self.ended().map_or(JsValue::UNDEFINED, |finish| output::finish(finish).into())
    }

    /// What a photo of each candidate is expected to add to an objective, where 1 is all that can be
    /// had. NaN for candidates that are not available, and for all where nothing is known: without a
    /// model, or before the first photo.
    pub fn gains(
        &mut self,
        #[wasm_bindgen(unchecked_param_type = "Objective")] objective: &JsValue,
    ) -> Result<Vec<f32>, Refusal> {
        let objective = objective.as_string().and_then(|name| input::objective(&name));
        let refused = "`objective` must be coverage, geometry, diversity or texture";
        Ok(self.expected(objective.ok_or_else(|| Refusal::bad_argument(refused.into()))?))
    }

    /// How far the capture is.
    #[wasm_bindgen(unchecked_return_type = "Progress")]
    pub fn progress(&mut self) -> JsValue {
        let (scores, left) = match self.knows() {
            true => (output::scores(&self.scores()), output::scores(&self.gain_left())),
            false => (JsValue::UNDEFINED, JsValue::UNDEFINED),
        };
        output::object([
            ("views", (self.taken().len() as u32).into()),
            ("budget", (self.budget() as u32).into()),
            ("isEnough", (self.ended() == Some(Finish::GoodEnough)).into()),
            ("scores", scores),
            ("gainLeft", left),
            ("clutter", self.clutter().map_or(JsValue::UNDEFINED, JsValue::from)),
        ])
    }

    /// What has become of every candidate, in order.
    #[wasm_bindgen(unchecked_return_type = "Status[]")]
    pub fn statuses(&self) -> Vec<JsValue> {
        self.candidates().iter().map(|c| output::status(c.status()).into()).collect()
    }

    /// The candidates that were photographed, in order; photos of no candidate are left out.
    pub fn views(&self) -> Vec<u32> {
        let views = self.taken().iter();
        views.filter_map(|view| view.candidate).map(|index| index as u32).collect()
    }

    /// The poses at which photos were really taken, all of them, shape (views, 3, 4).
    #[wasm_bindgen(js_name = viewPoses)]
    pub fn view_poses(&self) -> Vec<f32> {
        self.taken().iter().flat_map(|view| input::numbers(&view.pose)).collect()
    }

    /// All poses of the candidates, shape (candidates, 3, 4).
    pub fn poses(&self) -> Vec<f32> {
        self.candidates().iter().flat_map(|c| input::numbers(c.pose())).collect()
    }

    /// How many views the plan asks for.
    #[wasm_bindgen(getter)]
    pub fn budget(&self) -> usize {
        self.plan().budget()
    }

    /// Whether a network tells what further views would bring.
    #[wasm_bindgen(getter, js_name = hasModel)]
    pub fn has_model(&self) -> bool {
        matches!(self.inner, Inner::Network(_))
    }

    /// Puts candidates, 1024 at most, into the order that moves the camera least, from the last view on.
    #[wasm_bindgen(unchecked_return_type = "Tour")]
    pub fn tour(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Uint32Array")] indices: &JsValue,
    ) -> Result<JsValue, Refusal> {
        let (order, length_rad) = self.ordered(&input::whole_numbers("indices", indices)?)?;
        Ok(output::object([
            ("order", Uint32Array::from(order.as_slice()).into()),
            ("lengthRad", length_rad.into()),
        ]))
    }

    /// The session as bytes, to go on after a reload. The model is not in them.
    pub fn snapshot(&self) -> Result<Vec<u8>, Refusal> {
        let mut buffer = input::filled(4096, 0)?;
        loop {
            match read!(&self.inner, session => session.snapshot(&mut buffer)) {
                Ok(length) => {
                    buffer.truncate(length);
                    return Ok(buffer);
                }
                // A candidate or view takes less than 512 bytes, so this ends before 64 MiB.
                Err(SnapshotError::NoRoom) if buffer.len() < 1 << 26 => {
                    buffer = input::filled(buffer.len() * 2, 0)?;
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// The session that wrote these bytes. One with a network needs the same model again.
    pub fn restore(
        #[wasm_bindgen(unchecked_param_type = "Uint8Array")] bytes: &JsValue,
        #[wasm_bindgen(unchecked_optional_param_type = "Model")] model: &JsValue,
    ) -> Result<Session, Refusal> {
        Self::from_snapshot(&input::bytes("bytes", bytes)?, Model::read(model)?.as_ref())
    }
}

impl Session {
    fn begin(pool: &Pool, plan: Plan, model: Option<&Model>) -> Result<Self, Refusal> {
        let poses = pool.poses.iter().copied();
        let Some(model) = model else {
            poses_suffice(&plan)?;
            let session = CoreSession::try_new(Growing::new(usize::MAX), poses, Blind, plan)?;
            return Ok(Self { inner: Inner::Poses(session) });
        };
        // Before the network asks the same centre for directions, and finds none.
        plan.check(pool.poses.len())?;
        let networked = Networked::try_new(Rc::clone(&model.bytes), |bytes| {
            let scorer = scorer(bytes, &plan, &pool.poses)?;
            let memory = Growing::new(MOST_NETWORK_VIEWS);
            Ok::<_, Refusal>(CoreSession::try_new(memory, poses, scorer, plan)?)
        })?;
        Ok(Self { inner: Inner::Network(networked) })
    }

    fn from_snapshot(bytes: &[u8], model: Option<&Model>) -> Result<Self, Refusal> {
        let contents = Contents::parse(bytes)?;
        // Nobody's fingerprint is 0. A model of that checksum is refused below, by its records.
        if contents.fingerprint() == 0 {
            let session = CoreSession::restore(Growing::new(usize::MAX), Blind, bytes)?;
            return Ok(Self { inner: Inner::Poses(session) });
        }
        let Some(model) = model else {
            let message = "the snapshot is of a session with a network: give its model too";
            return Err(Refusal::needs_model(message.into()));
        };
        if model.checksum() != contents.fingerprint() {
            return Err(SnapshotError::OtherScorer.into());
        }
        let poses: Vec<Pose> = contents.candidates().collect();
        let networked = Networked::try_new(Rc::clone(&model.bytes), |model| {
            let scorer = scorer(model, contents.plan(), &poses)?;
            let memory = Growing::new(MOST_NETWORK_VIEWS);
            Ok::<_, Refusal>(CoreSession::restore(memory, scorer, bytes)?)
        })?;
        Ok(Self { inner: Inner::Network(networked) })
    }

    fn take_in(
        &mut self,
        index: Option<usize>,
        pose: Pose,
        photo: Option<Photo>,
    ) -> Result<(), Refusal> {
        match &mut self.inner {
            Inner::Poses(session) => match index {
                Some(index) => session.observe(index, pose, &())?,
                None => session.observe_elsewhere(pose, &())?,
            },
            Inner::Network(networked) => {
                let photo = match &photo {
                    Some(photo) => photo.core()?,
                    None => CorePhoto::default(),
                };
                networked.with_dependent_mut(|_, session| match index {
                    Some(index) => session.observe(index, pose, &photo),
                    None => session.observe_elsewhere(pose, &photo),
                })?;
            }
        }
        Ok(())
    }

    fn plan(&self) -> &Plan {
        read!(&self.inner, session => session.plan())
    }

    fn candidates(&self) -> &[Candidate] {
        read!(&self.inner, session => session.candidates())
    }

    fn taken(&self) -> &[View] {
        read!(&self.inner, session => session.views())
    }

    fn ended(&mut self) -> Option<Finish> {
        change!(&mut self.inner, session => session.finish())
    }

    fn scores(&self) -> Scores {
        read!(&self.inner, session => session.scores())
    }

    fn clutter(&self) -> Option<f32> {
        match &self.inner {
            Inner::Network(network) if self.knows() => {
                Some(network.borrow_dependent().scorer().clutter())
            }
            _ => None,
        }
    }

    /// Whether there is anything to estimate from.
    fn knows(&self) -> bool {
        self.has_model() && !self.taken().is_empty()
    }

    fn expected(&mut self, objective: Objective) -> Vec<f32> {
        let knows = self.knows();
        let candidates = change!(&mut self.inner, session => session.score_all(objective).iter());
        let gain = |c: &Candidate| match knows && c.is_available() {
            true => c.gain(objective),
            false => f32::NAN,
        };
        candidates.map(gain).collect()
    }

    /// The highest expected gain in each objective; 0 where no candidate is left.
    fn gain_left(&mut self) -> Scores {
        let [coverage, geometry, diversity, texture] = Objective::ALL.map(|objective| {
            let gains = self.expected(objective).into_iter();
            gains.filter(|gain| !gain.is_nan()).reduce(f32::max).unwrap_or(0.0)
        });
        Scores { coverage, geometry, diversity, texture }
    }

    fn ordered(&self, indices: &[u32]) -> Result<(Vec<u32>, f32), Refusal> {
        if indices.len() > MOST_PLACES {
            return Err(Refusal::too_large(format!(
                "a tour of {} places would take too long: {MOST_PLACES} at most",
                indices.len()
            )));
        }
        let mut order: Vec<usize> = indices.iter().map(|&index| index as usize).collect();
        for &index in &order {
            read!(&self.inner, session => session.candidate(index))?;
        }
        let length_rad = read!(&self.inner, session => session.order_by_travel(&mut order));
        Ok((order.into_iter().map(|index| index as u32).collect(), length_rad))
    }
}

/// The scorer of a session with a network.
fn scorer<'m>(
    model: &'m [u8],
    plan: &Plan,
    poses: &[Pose],
) -> Result<SoarNet<'m, NetworkMemory>, Refusal> {
    let model = CoreModel::parse(model)?;
    let memory = NetworkMemory::try_new(&model, poses.len())?;
    Ok(SoarNet::try_new(model, memory, plan.centre(), poses.iter().copied())?)
}

fn poses_suffice(plan: &Plan) -> Result<(), Refusal> {
    if plan::needs_model(plan) {
        let message = "the plan asks what a view would bring, which takes a network: make the \
                       session with a model, or plan by farthest-point, pseudo-coverage or random";
        return Err(Refusal::needs_model(message.into()));
    }
    Ok(())
}

fn whole_index(index: f64) -> Result<usize, Refusal> {
    input::whole("index", index, u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::tests::shipped;
    use vantage_core::Vec3;
    use vantage_core::candidates::{Pool as CorePool, ViewSpace};
    use vantage_core::planner::Stop;

    const CENTRE: Vec3 = Vec3::new(0.1, -0.2, 0.3);

    fn pool(count: usize) -> Pool {
        let pool = CorePool::try_new(ViewSpace::FibonacciSphere, count, 3.0).unwrap();
        Pool { poses: pool.with_target(CENTRE).unwrap().iter().collect(), centre: CENTRE }
    }

    fn session(plan: Plan, model: Option<&Model>) -> Session {
        Session::begin(&pool(40), plan.with_centre(CENTRE), model).unwrap()
    }

    fn next(session: &mut Session) -> Option<(usize, Pose, f32)> {
        let next = change!(&mut session.inner, session => session.next_view())?;
        Some((next.index, next.pose, next.gain))
    }

    /// Takes up to `most` views of no picture; the indices and the gains.
    fn carry_on(session: &mut Session, most: usize) -> Vec<(usize, f32)> {
        let mut taken = Vec::new();
        while taken.len() < most
            && let Some((index, pose, gain)) = next(session)
        {
            session.take_in(Some(index), pose, None).unwrap();
            taken.push((index, gain));
        }
        taken
    }

    #[test]
    fn a_plan_that_asks_for_gains_needs_a_model() {
        let [_, model] = shipped();
        let begin = |plan, model| Session::begin(&pool(40), plan, model).map(|_| ());
        assert_eq!(begin(Plan::ensemble(5), None).unwrap_err().code(), "needs-model");
        assert_eq!(begin(Plan::ensemble(5), Some(&model)), Ok(()));
        assert_eq!(begin(Plan::random(5), None), Ok(()));
    }

    #[test]
    fn a_network_that_sees_photos_refuses_to_go_without_and_nothing_changes() {
        let [model, _] = shipped();
        let mut session = session(Plan::ensemble(5), Some(&model));
        let chosen = next(&mut session);
        let (index, pose, _) = chosen.unwrap();
        let refused = session.take_in(Some(index), pose, None);
        assert_eq!(refused.unwrap_err().code(), "needs-photo");
        assert!(session.taken().is_empty());
        assert_eq!(next(&mut session), chosen);
    }

    #[test]
    fn a_session_outlives_its_model_and_its_pool() {
        let [_, model] = shipped();
        let mut session = session(Plan::ensemble(8), Some(&model));
        drop(model);
        assert_eq!(carry_on(&mut session, 99).len(), 8);
        assert_eq!(session.ended(), Some(Finish::BudgetSpent));
    }

    #[test]
    fn a_restored_session_goes_on_to_the_same_plan() {
        let [_, model] = shipped();
        for (plan, model) in
            [(Plan::ensemble(12), Some(&model)), (Plan::random(12).with_seed(4), None)]
        {
            let mut session = session(plan, model);
            carry_on(&mut session, 5);
            let kept = session.snapshot().unwrap();
            let mut again = Session::from_snapshot(&kept, model).unwrap();
            assert_eq!(again.has_model(), model.is_some());
            assert_eq!(again.plan().centre(), CENTRE);
            let rest = carry_on(&mut session, 99);
            assert_eq!(rest.len(), 7);
            assert_eq!(carry_on(&mut again, 99), rest);
            assert_eq!(again.scores(), session.scores());
        }
    }

    #[test]
    fn a_snapshot_is_refused_without_its_model_or_with_another() {
        let [sees, poses] = shipped();
        let mut session = session(Plan::sum(6), Some(&poses));
        carry_on(&mut session, 3);
        let mut kept = session.snapshot().unwrap();
        let code = |bytes: &[u8], model| Session::from_snapshot(bytes, model).err().unwrap().code();
        assert_eq!(code(&kept, None), "needs-model");
        assert_eq!(code(&kept, Some(&sees)), "other-model");
        assert_eq!(code(&kept[1..], Some(&poses)), "bad-snapshot");
        kept[40] ^= 1;
        assert_eq!(code(&kept, Some(&poses)), "bad-snapshot");
        kept[4] = 77;
        assert_eq!(code(&kept, Some(&poses)), "other-version");
    }

    #[test]
    fn nothing_is_known_without_a_model_or_a_photo() {
        let [_, model] = shipped();
        let mut blind = session(Plan::farthest_point(4), None);
        carry_on(&mut blind, 2);
        let mut fresh = session(Plan::ensemble(4), Some(&model));
        for session in [&mut blind, &mut fresh] {
            assert!(!session.knows());
            assert!(session.expected(Objective::Coverage).iter().all(|gain| gain.is_nan()));
        }
        carry_on(&mut fresh, 1);
        assert!(fresh.knows());
    }

    #[test]
    fn gains_are_those_that_the_plan_goes_by_and_nan_where_nothing_can_be_had() {
        let [_, model] = shipped();
        let mut session = session(Plan::single(Objective::Diversity, 20), Some(&model));
        carry_on(&mut session, 4);
        change!(&mut session.inner, session => session.block(7)).unwrap();
        let gains = session.expected(Objective::Diversity);
        for (index, gain) in gains.iter().enumerate() {
            assert_eq!(gain.is_nan(), !session.candidates()[index].is_available(), "{index}");
        }
        assert!(gains[7].is_nan());
        let (index, _, gain) = next(&mut session).unwrap();
        assert_eq!(gains[index], gain);
        assert_eq!(session.gain_left().diversity, gain);
    }

    #[test]
    fn the_stop_rule_is_what_says_enough() {
        let [_, model] = shipped();
        let stop = Stop { gain: 1.0, patience: 2 };
        let mut session = session(Plan::ensemble(30).with_stop(stop), Some(&model));
        assert_eq!(carry_on(&mut session, 99).len(), 5);
        assert_eq!(session.ended(), Some(Finish::GoodEnough));
    }

    #[test]
    fn a_network_remembers_256_views_and_no_more_can_be_asked_for() {
        let [_, model] = shipped();
        let too_many = Session::begin(&pool(257), Plan::ensemble(257), Some(&model));
        assert_eq!(too_many.err().unwrap().code(), "too-large");
        let mut session = session(Plan::ensemble(9), Some(&model));
        let pose = *session.candidates()[0].pose();
        for _ in 0..256 {
            session.take_in(None, pose, None).unwrap();
        }
        assert_eq!(session.take_in(None, pose, None).unwrap_err().code(), "too-large");
        assert_eq!(session.taken().len(), 256);
        // The largest snapshot of this model can be read again.
        let kept = session.snapshot().unwrap();
        assert_eq!(Session::from_snapshot(&kept, Some(&model)).unwrap().taken().len(), 256);
    }

    #[test]
    fn a_tour_visits_what_it_is_given() {
        let session = session(Plan::random(3), None);
        let (mut order, length_rad) = session.ordered(&[9, 3, 30, 12]).unwrap();
        assert!(length_rad > 0.0);
        order.sort_unstable();
        assert_eq!(order, [3, 9, 12, 30]);
        assert_eq!(session.ordered(&[40]).unwrap_err().code(), "unknown-candidate");
        assert_eq!(session.ordered(&[0; 1025]).unwrap_err().code(), "too-large");
    }
}
