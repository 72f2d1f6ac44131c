//! A capture assistant for the terminal: it says where to stand, takes the photo's path, goes on.
//!
//! ```sh
//! cargo run --release --package vantage-host -- 12     # plan 12 photos
//! ```
//!
//! The smallest whole use of the core: a pool of poses, a network over memory of fixed size, a session,
//! photos in. Poses are taken at their word, as on a tripod; `observe` also takes the pose that was
//! really reached.

use std::io::{self, BufRead, Write};

use anyhow::{Context, Result, ensure};
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::planner::{self, Plan, Session};
use vantage_core::soarnet::{self, Image, Model, Photo, Pixels, SoarNet};
use vantage_core::{Pose, Vec3};

const CANDIDATES: usize = 100;
const VIEWS: usize = 64;

/// The network that comes with Vantage; on a controller it stays in flash.
static MODEL: &[u8] = include_bytes!("../../../lab/models/soarnet.model");

fn main() -> Result<()> {
    let budget = match std::env::args().nth(1) {
        Some(word) => word.parse().with_context(|| {
            format!("the first argument is how many photos to plan, not `{word}`")
        })?,
        None => 12,
    };
    ensure!(budget <= VIEWS, "this example has room for {VIEWS} photos, not {budget}");
    assist(budget, io::stdin().lock(), io::stdout().lock())
}

/// Leads through a capture: an answer is a photo's path, `block` or nothing to skip the view.
fn assist(budget: usize, answers: impl BufRead, mut out: impl Write) -> Result<()> {
    // Cameras two metres from the object's middle, from level to 70 degrees above.
    let space =
        ViewSpace::Hemisphere { min_elevation_rad: 0.0, max_elevation_rad: 70f32.to_radians() };
    let pool = Pool::try_new(space, CANDIDATES, 2.0)?;

    let mut memory = Box::new(soarnet::Fixed::<CANDIDATES, VIEWS>::new());
    let scorer = SoarNet::try_new(Model::parse(MODEL)?, &mut *memory, Vec3::ZERO, pool.iter())?;
    let memory = planner::Fixed::<CANDIDATES, VIEWS>::default();
    let mut session = Session::try_new(memory, pool.iter(), scorer, Plan::support(budget))?;

    let mut answers = answers.lines();
    while let Some(next) = session.next_view() {
        let taken = session.views().len();
        writeln!(out, "{}/{budget}  stand {}: {}", taken + 1, place(&next.pose), next.reason)?;
        write!(out, "photo (Enter: not now, `block`: cannot stand there)> ")?;
        out.flush()?;
        let Some(answer) = answers.next().transpose()? else { break };
        match answer.trim() {
            "" => session.skip(next.index)?,
            "block" => session.block(next.index)?,
            path => match image::open(path) {
                Ok(photo) => {
                    let photo = photo.into_rgb8();
                    let (width, height) = photo.dimensions();
                    let image = Image::try_new(width, height, Pixels::Rgb888, photo.as_raw())?;
                    session.observe(next.index, next.pose, &Photo::new(image))?;
                }
                Err(error) => writeln!(out, "cannot read {path}: {error}; try another")?,
            },
        }
    }
    writeln!(out, "\n{} of {budget} photos taken", session.views().len())?;
    Ok(())
}

/// Where a camera stands, in degrees around the object and above it.
fn place(pose: &Pose) -> String {
    let Vec3 { x, y, z } = pose.position();
    let (around, above) = (y.atan2(x).to_degrees(), z.atan2(x.hypot(y)).to_degrees());
    format!("at {:3.0} degrees around, {above:2.0} above", around.rem_euclid(360.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(answers: &str) -> String {
        let mut out = Vec::new();
        assist(4, answers.as_bytes(), &mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn photos_are_asked_for_until_there_are_enough() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("photo.png");
        image::RgbImage::from_fn(96, 64, |x, y| image::Rgb([x as u8, y as u8, 90]))
            .save(&path)
            .unwrap();
        let photo = path.to_str().unwrap();
        // A photo, one that is not there, one not now, one not at all, and three more.
        let out = told(&[photo, "nowhere.png", "", "block", photo, photo, photo].join("\n"));
        assert!(out.ends_with("4 of 4 photos taken\n"), "{out}");
        assert!(out.contains("cannot read nowhere.png"), "{out}");
        assert!(out.contains("4/4  stand at"), "{out}");
        // An unreadable photo changes nothing; skipped and blocked views give way to others.
        let second: Vec<&str> = out.lines().filter(|line| line.contains("2/4  stand")).collect();
        let [unread, again, skipped, blocked] = second[..] else { panic!("{out}") };
        let place = |line: &str| line.split_once("4  stand").unwrap().1.to_owned();
        assert_eq!(place(unread), place(again));
        assert!(place(again) != place(skipped) && place(skipped) != place(blocked), "{out}");
    }

    #[test]
    fn an_end_of_the_answers_ends_the_capture() {
        assert!(told("").ends_with("0 of 4 photos taken\n"));
    }
}
