//! What schemes are compared on: a mesh that is rendered, or a folder of photos.
//!
//! A folder of photos is one of NeRF's synthetic scenes or like them: see [`Scene`]. Its views to train
//! on are the candidates; what is trained is compared with its views to test by. Of the comparison that the SO-NeRF paper makes on them, these things differ:
//!
//! - Photos and renders have 100 pixels a side (`paper`: 400), made from the 800 of the files by means
//!   over areas, after white has been laid behind them in sRGB.
//! - The mean is over 24 of the 200 test views, every eighth or so, unless `--test-views 200` is given.
//! - Fields are this crate's, not nerfstudio's, at the presets' sizes.
//! - The object is brought into the unit sphere by the outlines in all photos to train on: that is
//!   more than a planner in the field would know, and the same for all schemes.
//! - ActiveNeRF runs at a small size: see [`active`].
//! - The paper leaves out *chair*, since its network was trained on chairs; ours was trained on made
//!   objects of 20 classes, a class of chairs among them. Nothing is left out here.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use image::RgbImage;
use vantage_core::{Camera, Pose};
use vantage_lab::mesh::Mesh;
use vantage_lab::network::Network;
use vantage_lab::photos::{Scene, View};
use vantage_lab::render::Renderer;
use vantage_lab::{blind, scheme};

use crate::active::{self, Active};
use crate::photos::{Photos, Picture};
use crate::plans::{self, Planner, Views};

/// The scenes that a named folder holds: itself, or its sub-folders; none if it holds none.
pub fn scenes_in(folder: &Path) -> Vec<PathBuf> {
    if Scene::is_in(folder) {
        return vec![folder.to_owned()];
    }
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut scenes: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| Scene::is_in(path)).collect();
    scenes.sort();
    scenes
}

/// Whether a scheme can choose among photos whose object nobody knows.
fn needs_a_mesh(scheme: &str) -> bool {
    let can = |scheme: &str| {
        scheme == active::NAME
            || scheme::needs_poses_only(scheme)
            || scheme::network(scheme).is_some()
    };
    !plans::parts(scheme, 0).iter().all(|(scheme, _)| can(scheme))
}

/// Fails for schemes that folders of photos have no answer to.
pub fn check(schemes: &[String], objects: &[String]) -> Result<()> {
    let scene = objects.iter().find(|object| Scene::is_in(Path::new(object)));
    let scheme = schemes.iter().find(|scheme| needs_a_mesh(scheme));
    if let (Some(scene), Some(scheme)) = (scene, scheme) {
        bail!(
            "the scheme {scheme} needs a mesh, and {scene} is a folder of photos: choose soarnet…, \
             fps, pc-fps, random, best-of-4-random or activenerf"
        );
    }
    Ok(())
}

/// Networks, and which they are.
type Networks<'a> = &'a [(scheme::Network, Network)];

/// Views to choose from, and their photos.
pub trait Subject {
    /// The views of a scheme.
    fn views(&self, scheme: &str, budget: usize, seed: u64) -> Result<Views>;

    /// Photos of views that were chosen.
    fn photos(&self, views: &Views) -> Photos;

    /// What renders are compared with.
    fn test(&self) -> Photos;
}

/// A mesh: photos are rendered.
pub struct Rendered<'a> {
    planner: Planner<'a>,
    renderer: Renderer,
    camera: Camera,
    poses: &'a [Pose],
    test_poses: &'a [Pose],
}

impl<'a> Rendered<'a> {
    /// Labels the candidates of an object, and prepares what these schemes look at.
    pub fn new(
        mesh: &'a Mesh,
        camera: Camera,
        [poses, test_poses]: [&'a [Pose]; 2],
        networks: Networks<'a>,
        schemes: &[&str],
    ) -> Result<Self> {
        let planner = Planner::new(mesh, poses, networks, schemes)?;
        Ok(Self { planner, renderer: Renderer::new(mesh), camera, poses, test_poses })
    }

    fn taken(&self, poses: Vec<Pose>) -> Photos {
        Photos::of_mesh(&self.renderer, self.camera, poses)
    }
}

impl Subject for Rendered<'_> {
    fn views(&self, scheme: &str, budget: usize, seed: u64) -> Result<Views> {
        if scheme != active::NAME {
            return self.planner.views(scheme, budget, seed);
        }
        let take = |indices: &[usize]| self.taken(indices.iter().map(|&i| self.poses[i]).collect());
        Active::default().views(self.poses, take, budget, seed)
    }

    fn photos(&self, views: &Views) -> Photos {
        self.taken(views.poses.clone())
    }

    fn test(&self) -> Photos {
        self.taken(self.test_poses.to_vec())
    }
}

/// One of NeRF's synthetic scenes: its views to train on are the candidates.
pub struct Photographed<'a> {
    candidates: Photos,
    test: Photos,
    looked_from: Vec<Pose>, // (candidates), as networks are given them; empty if none is asked
    looked_at: Vec<RgbImage>, // (candidates), likewise
    networks: Networks<'a>,
}

impl<'a> Photographed<'a> {
    /// Reads a folder, and makes its photos as small as they are compared.
    pub fn open(
        folder: &Path,
        side: u32,
        test_views: usize,
        networks: Networks<'a>,
    ) -> Result<Self> {
        let scene = Scene::open(folder, test_views)?;
        let Camera { width, height, .. } = scene.camera;
        ensure!(
            width == height && width >= side,
            "its photos have {width} x {height} pixels: they must be square, of {side} or more"
        );
        let camera = scene.camera.resized(side, side)?;
        let photos = |views: &[View]| Photos {
            camera,
            poses: views.iter().map(|view| view.pose).collect(),
            pictures: views
                .iter()
                .map(|view| Picture::on_background(&view.photo).smaller(side as usize))
                .collect(),
        };
        let (mut looked_from, mut looked_at) = (Vec::new(), Vec::new());
        if !networks.is_empty() {
            for view in &scene.train {
                let looked = scene.for_network(view)?;
                looked_from.push(looked.pose);
                looked_at.push(looked.window);
            }
        }
        let (candidates, test) = (photos(&scene.train), photos(&scene.test));
        Ok(Self { candidates, test, looked_from, looked_at, networks })
    }

    fn taken(&self, indices: &[usize]) -> Photos {
        Photos {
            camera: self.candidates.camera,
            poses: indices.iter().map(|&index| self.candidates.poses[index]).collect(),
            pictures: indices.iter().map(|&i| self.candidates.pictures[i].clone()).collect(),
        }
    }
}

impl Subject for Photographed<'_> {
    fn views(&self, name: &str, budget: usize, seed: u64) -> Result<Views> {
        let poses = &self.candidates.poses;
        if name == active::NAME {
            return Active::default().views(poses, |indices| self.taken(indices), budget, seed);
        }
        let start = Instant::now();
        let plan = scheme::plan(name, budget, seed).with_context(|| scheme::unknown(name, &[]))?;
        let (mut chosen, mut seconds) = (Vec::new(), Vec::new());
        if let Some((asked, _)) = scheme::network(name) {
            let network = self.networks.iter().find(|(known, _)| *known == asked);
            let (_, network) = network.context("a network is missing")?;
            let photo = |index: usize| self.looked_at[index].clone();
            network.choose(&self.looked_from, photo, plan, |next, second| {
                chosen.push(next.index);
                seconds.push(second);
            })?;
        } else {
            ensure!(scheme::needs_poses_only(name), "the scheme {name} needs a mesh");
            chosen = blind::views(poses, plan)?;
            seconds = vec![start.elapsed().as_secs_f64(); chosen.len()];
        }
        plans::check_length(name, chosen.len(), budget)?;
        Ok(Views {
            poses: chosen.iter().map(|&index| poses[index]).collect(),
            candidates: Some(chosen),
            seconds,
        })
    }

    fn photos(&self, views: &Views) -> Photos {
        self.taken(views.candidates.as_deref().unwrap_or_default())
    }

    fn test(&self) -> Photos {
        self.test.clone()
    }
}
