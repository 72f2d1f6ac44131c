//! One object, from its mesh to everything a data set holds of it.

use anyhow::Result;
use rayon::prelude::*;
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::{Objective, Reading};
use vantage_core::planner::Plan;
use vantage_core::{Camera, Pose};

use super::data::{ObjectData, State, TestViews, Trajectory, Views};
use super::manifest::Parameters;
use crate::label::{label_all, texture_limit};
use crate::mesh::{self, Chance, Mesh};
use crate::pool::{DISTANCE, FOV_X_RAD};
use crate::render::{NO_FACE, PhotoOptions, Renderer};
use crate::surface;

/// Everything about an object. `mesh` is as loaded or made; `seed` is the object's own.
pub(super) fn object(
    name: String,
    class: String,
    mut mesh: Mesh,
    seed: u64,
    parameters: &Parameters,
) -> Result<ObjectData> {
    mesh::normalise(&mut mesh);
    let renderer = Renderer::new(&mesh);
    let reading = Reading::default();
    let faces = surface::faces(&mesh, reading.sigma_q);
    let camera = |side: u32| Camera::from_fov(side, side, FOV_X_RAD);
    let (photo_camera, label_camera) =
        (camera(parameters.image_size)?, camera(parameters.resolution)?);

    let mut chance = Chance::new(seed);
    let mut views = |count: usize| -> Result<Views> {
        let space = ViewSpace::RandomSphere { seed: chance.bits() };
        let poses: Vec<Pose> = Pool::try_new(space, count, DISTANCE)?.iter().collect();
        let labels = label_all(&renderer, &label_camera, &poses, faces.len(), &reading, || {});
        let photo =
            |pose: &Pose| renderer.photo(&photo_camera, pose, &PhotoOptions::default()).into_raw();
        let photos = poses.par_iter().flat_map_iter(photo).collect();
        Ok(Views { poses, labels, photos })
    };
    let train = views(parameters.train_views)?;
    let validation = views(parameters.validation_views)?;

    let spiral = ViewSpace::Spiral {
        turns: 5.0,
        min_elevation_rad: (-40f32).to_radians(),
        max_elevation_rad: 70f32.to_radians(),
    };
    let poses: Vec<Pose> = Pool::try_new(spiral, parameters.test_views, DISTANCE)?.iter().collect();
    let seen = renderer.faces_of_all(&photo_camera, &poses);
    let masks = seen.iter().flat_map(|image| &image.faces).map(|&face| u8::from(face != NO_FACE));
    let test = TestViews { masks: masks.collect(), poses };

    let texture_limit = texture_limit(&train.labels, faces.len(), &reading);
    let trajectories = Vec::new();
    let mut data =
        ObjectData { name, class, faces, texture_limit, train, validation, test, trajectories };
    data.trajectories = (0..parameters.trajectories)
        .map(|number| walk(&data, number, parameters.steps, &mut chance))
        .collect();
    Ok(data)
}

/// A walk over the train views, none twice.
///
/// The walks of even number are by chance alone. The others pass through states as a planner meets
/// them: views that lie far apart first, then by chance either any view or the one that gains most
/// in an objective.
fn walk(data: &ObjectData, number: usize, steps: usize, chance: &mut Chance) -> Trajectory {
    let mut left: Vec<u16> = (0..data.train.poses.len() as u16).collect();
    let mut accounts = Vec::new();
    let mut ledger = data.ledger(&mut accounts);
    let (mut views, mut states) = (Vec::with_capacity(steps), Vec::<State>::with_capacity(steps));
    for step in 0..steps {
        let any = chance.below(left.len() as u32) as usize;
        let planned = number % 2 == 1 && step > 0;
        let place = match states.last() {
            Some(_) if planned && step < Plan::START_VIEWS => farthest(data, &left, &views),
            Some(state) if planned && chance.below(2) == 0 => {
                let objective = chance.below(4) as usize;
                highest(&left, |view| state.gains[usize::from(view)][objective])
            }
            _ => any,
        };
        let view = left.swap_remove(place);
        let index = usize::from(view);
        ledger.add(data.train.position(index), &data.train.sighting(index));
        views.push(view);
        let gains = (0..data.train.poses.len()).into_par_iter().map(|candidate| {
            let (camera, sighting) =
                (data.train.position(candidate), data.train.sighting(candidate));
            Objective::ALL.map(|objective| ledger.gain(objective, camera, &sighting))
        });
        states.push(State { gains: gains.collect(), scores: ledger.scores() });
    }
    Trajectory { views, states }
}

/// The place in `left` of the view that is farthest from all `taken`.
fn farthest(data: &ObjectData, left: &[u16], taken: &[u16]) -> usize {
    let position = |view: u16| data.train.position(view.into());
    highest(left, |view| {
        let distances = taken.iter().map(|&other| position(other).distance_squared(position(view)));
        distances.fold(f32::INFINITY, f32::min)
    })
}

/// The place in `left`, which is not empty, of the view of the highest value.
fn highest(left: &[u16], value: impl Fn(u16) -> f32) -> usize {
    let values = left.iter().map(|&view| value(view)).enumerate();
    values.max_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(place, _)| place)
}
