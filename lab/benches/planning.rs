//! `cargo bench -p vantage-lab --bench planning`: rendering and planning at the sizes that the
//! README states. Each bench checks its result before it is timed.

use std::sync::LazyLock;

use divan::{Bencher, black_box};
use vantage_core::candidates::{Pool, ViewSpace};
use vantage_core::objectives::Reading;
use vantage_core::{Camera, Pose};
use vantage_lab::exact::Labelled;
use vantage_lab::label::RESOLUTION;
use vantage_lab::mesh::{self, Mesh};
use vantage_lab::pool::{DISTANCE, FOV_X_RAD};
use vantage_lab::render::Renderer;
use vantage_lab::scheme;

fn main() {
    divan::main();
}

fn blob(triangles: usize) -> Mesh {
    let mut blob = mesh::noisy_blob(triangles, 1);
    mesh::normalise(&mut blob);
    let got = blob.faces.len();
    assert!(got.abs_diff(triangles) * 20 < triangles, "{got} triangles, {triangles} asked for");
    blob
}

fn poses(count: usize) -> Vec<Pose> {
    let space = ViewSpace::RandomSphere { seed: 1 };
    Pool::try_new(space, count, DISTANCE).expect("a valid pool").iter().collect()
}

fn camera() -> Camera {
    Camera::from_fov(RESOLUTION, RESOLUTION, FOV_X_RAD).expect("a valid camera")
}

/// Face-id images: 100 views of 256 x 256 of 100,000 triangles, on all cores.
#[divan::bench(sample_count = 7)]
fn render_100_views_of_100k_triangles(bencher: Bencher<'_, '_>) {
    let renderer = Renderer::new(&blob(100_000));
    let poses = poses(100);
    let images = renderer.faces_of_all(&camera(), &poses);
    assert!(images.iter().all(|image| image.visible().len() > 5_000));
    bencher.bench_local(|| black_box(renderer.faces_of_all(&camera(), &poses)));
}

/// 200,000 faces, 1,000 candidates, labelled once.
static LARGE: LazyLock<Labelled> = LazyLock::new(|| {
    Labelled::new(&blob(200_000), &camera(), poses(1_000), Reading::default(), || {})
});

/// 100,000 faces, 100 candidates, labelled once.
static SMALL: LazyLock<Labelled> = LazyLock::new(|| {
    Labelled::new(&blob(100_000), &camera(), poses(100), Reading::default(), || {})
});

/// 30 of 1,000 candidates on 200,000 faces.
#[divan::bench(args = ["e", "c", "q", "d", "t", "sum", "fps", "random"], sample_count = 3)]
fn plan_30_of_1000_on_200k_faces(bencher: Bencher<'_, '_>, name: &str) {
    plan_30(bencher, &LARGE, name);
}

/// 30 of 100 candidates on 100,000 faces: divide by 30 for a step.
#[divan::bench(args = ["e", "c", "q", "d", "t", "sum", "fps"], sample_count = 5)]
fn plan_30_of_100_on_100k_faces(bencher: Bencher<'_, '_>, name: &str) {
    plan_30(bencher, &SMALL, name);
}

fn plan_30(bencher: Bencher<'_, '_>, labelled: &Labelled, name: &str) {
    let plan = scheme::plan(name, 30, 0).expect("a scheme by its name");
    let steps = labelled.run(plan, || {}).expect("a plan");
    let mut indices: Vec<usize> = steps.iter().map(|step| step.next.index).collect();
    indices.sort_unstable();
    indices.dedup();
    assert_eq!(indices.len(), 30, "all views differ");
    assert!(steps[29].scores.coverage > 0.5, "30 views see most of a blob");
    bencher.bench_local(|| black_box(labelled.run(plan, || {})));
}
