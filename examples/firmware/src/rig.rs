//! What a capture needs of the world: a camera, something that moves it, and a sign to whoever looks.

use vantage_core::Pose;
use vantage_core::planner::Finish;
use vantage_core::soarnet::Photo;

/// Takes photos.
pub trait Camera {
    /// Why there is no photo.
    type Error;
    /// Takes one, into `frame` where the controller sees it: the photo then borrows from there.
    /// [`Photo::default`] is a photo that only the camera has, for a network that looks at poses alone.
    fn photograph<'f>(&mut self, frame: &'f mut [u8]) -> Result<Photo<'f>, Self::Error>;
}

/// Moves the camera around the object, or the object before the camera.
pub trait Mount {
    /// What is broken.
    type Error;
    /// Moves to a pose and waits until everything is still. Gives the pose really reached.
    fn move_to(&mut self, pose: &Pose) -> Result<Pose, Miss<Self::Error>>;
}

/// Why a pose was not reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Miss<E> {
    /// It never can be.
    OutOfReach,
    /// Not this time.
    NotNow,
    /// The mount is broken.
    Broken(E),
}

/// Tells a person what is going on.
pub trait Indicator {
    /// Shows it. An indicator that fails stops no capture.
    fn show(&mut self, cue: Cue);
}

/// What there is to tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cue {
    /// The camera goes there: so far to the right and so far up around the object, radians.
    Move {
        /// To the right, as whoever faces the object sees it; at most half a turn.
        right_rad: f32,
        /// Up.
        up_rad: f32,
    },
    /// A photo is taken.
    Photo,
    /// The view cannot be had.
    Missed,
    /// The capture is over.
    Done(Finish),
}

/// A camera, its mount and an indicator.
#[derive(Clone, Copy, Debug)]
pub struct Rig<C, M, I> {
    /// Takes the photos.
    pub camera: C,
    /// Moves the camera.
    pub mount: M,
    /// Tells where it goes.
    pub indicator: I,
}
