//! SOARNet: what a further view would bring, predicted from the photos and poses so far.
//!
//! The learned objective of SO-NeRF (Lee et al., 2023): a network looks at the photos taken and their
//! poses and tells the four scores now, and for every candidate what a photo from there would add,
//! without a mesh and without that photo. It is ours in three ways. A photo is encoded once, to a few
//! bytes; each candidate pools what the views mean *for it*, seen in each view's camera; and it ranks
//! candidates by gain instead of telling the next score. All of it is integer arithmetic on signed
//! bytes, so every target chooses the same views.
//!
//! ```text
//! image, features      what the network is told: a window of a photo; poses and counts
//! model                the file of a network, read in place
//! encoder, heads       the layers
//! hull, rays, outlook  what outlines tell: the object's hull, and what a candidate would see of it
//! support              the same: what a candidate would be to later views
//! SoarNet              the scorer for a session; its memory is the caller's
//! ```
//!
//! A session with a network that has learned nothing, for want of a file:
//!
//! ```
//! use vantage_core::candidates::{Pool, ViewSpace};
//! use vantage_core::planner::{self, Plan, Session};
//! use vantage_core::soarnet::{Dimensions, Fixed, Layer, Model, Network, Photo, SoarNet};
//! use vantage_core::{Objective, Vec3};
//!
//! let sizes = Dimensions { width: 4, head: 4, context: 4, ..Dimensions::default() };
//! let layer = |rows: usize, columns: usize| Layer {
//!     weights: &[1; 128][..rows * columns],
//!     bias: &[0; 12][..rows],
//!     multipliers: &[1 << 26; 12][..rows],
//!     zero: 0,
//! };
//! let network = Network {
//!     dimensions: sizes.without_images(),
//!     encoder: None,
//!     token: [layer(4, 32), layer(4, 4)],
//!     candidate: [layer(4, 28), layer(4, 4)],
//!     state: [layer(4, 12), layer(12, 4)],
//! };
//! let mut file = [0; 700]; // on a controller: `include_bytes!`, in flash
//! let length = network.write(&mut file)?;
//! let model = Model::parse(&file[..length])?;
//!
//! let pool = Pool::try_new(ViewSpace::FibonacciSphere, 40, 3.0)?;
//! let mut memory = Fixed::<40, 8>::new();
//! let scorer = SoarNet::try_new(model, &mut memory, Vec3::ZERO, pool.iter())?;
//! let plan = Plan::single(Objective::Diversity, 6);
//! let mut session = Session::try_new(planner::Fixed::<40, 8>::default(), pool.iter(), scorer, plan)?;
//! while let Some(next) = session.next_view() {
//!     // With images: Photo::new(Image::try_new(640, 480, Pixels::Rgb565, frame)?).
//!     session.observe(next.index, next.pose, &Photo::default())?;
//! }
//! assert_eq!(session.views().len(), 6);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

mod encoder;
pub mod features;
mod heads;
mod hull;
mod image;
mod memory;
mod model;
mod outlook;
mod rays;
mod scorer;
mod support;

pub use encoder::{Impression, Scratch};
pub use image::{
    CELL, COVER, DETAIL, INPUT, Image, ImageError, LONGEST_WINDOW, Pixels, SIDE, SKETCH, Window,
    places_in_sketch,
};
pub use memory::{Fixed, Lists, ListsMut, Memory};
pub use model::{
    Aligned, Dimensions, EncoderParts, Fault, Layer, Model, ModelError, Network, RANKS, STATE,
    Stage, VERSION, WIDEST, WriteError,
};
pub use outlook::{Eye, Form, OUTLOOK};
pub use scorer::{CLUTTERED, Photo, PhotoError, SetupError, SoarNet};
pub use support::{Seen, Standpoint};
