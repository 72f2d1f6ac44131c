//! How well a network ranks views, on objects it was not trained on.

use burn::tensor::{Device, Tensor, TensorData};
use rand::SeedableRng;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use vantage_core::soarnet::{OUTLOOK, SKETCH};
use vantage_lab::statistics::spearman;

use crate::net::{Network, OBJECTIVES, Question};
use crate::samples::{Ask, Batch, Object, sketch_of};

/// Fewest and most views of the states that are measured: after the first look, up to one before
/// the budget of 12.
const COUNTS: std::ops::Range<usize> = 3..12;

/// Means over states of held-out objects, by objective C, Q, D, T.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Spearman's rank correlation of predicted and exact gains over the views not yet taken.
    pub spearman: [f32; OBJECTIVES],
    /// Of what the best view would gain more than a mean one, the share that the chosen view does.
    pub share: [f32; OBJECTIVES],
}

impl Measured {
    /// One number to tell which network is better.
    pub fn mean(&self) -> f32 {
        (self.spearman.iter().sum::<f32>() + self.share.iter().sum::<f32>()) / 8.0
    }
}

/// Measures a network over all walks' first `walks`, its photos unchanged, given true outlines.
pub fn measure(net: &Network, objects: &[Object], walks: usize, device: &Device) -> Measured {
    measure_with(net, objects, walks, device, |_, _, _| {})
}

/// The same with the outlines that the network itself draws, as in a capture.
pub fn measure_drawn(net: &Network, objects: &[Object], walks: usize, device: &Device) -> Measured {
    measure_with(net, objects, walks, device, |objects, walk, question| {
        let Some(encoder) = &net.encoder else { return };
        let (_, cells) = encoder.forward(question.photos.clone());
        let cells: Vec<f32> = cells.into_data().try_to_vec().expect("sketches are f32");
        let sketches: Vec<_> = cells.chunks_exact(SKETCH).map(sketch_of).collect();
        let [number, taken, _] = question.views.dims();
        let [_, others, _] = question.candidates.dims();
        let counts = question.counts.iter();
        let of_count = counts.map(|&count| {
            let captures = objects.iter().zip(sketches.chunks_exact(taken));
            let outlooks = captures.flat_map(|(object, sketches)| {
                let views: Vec<usize> = object.walk(walk).take(count).collect();
                object.outlooks(&views, sketches)
            });
            let values = TensorData::new(outlooks.collect(), [number, others, OUTLOOK]);
            Tensor::from_data(values, device)
        });
        question.outlooks = of_count.collect();
    })
}

/// The same with questions that are changed before they are asked.
fn measure_with(
    net: &Network,
    objects: &[Object],
    walks: usize,
    device: &Device,
    change: impl Fn(&[&Object], usize, &mut Question),
) -> Measured {
    let mut chance = Pcg64::seed_from_u64(0);
    let steps = objects.iter().map(Object::steps).min().unwrap_or(0);
    let end = COUNTS.end.min(steps + 1);
    let ask = Ask {
        views: end - 1,
        counts: (COUNTS.start..end).collect(),
        candidates: usize::MAX,
        augment: false,
        photos: net.encoder.is_some(),
    };
    let mut sums = [[0f64; 3]; OBJECTIVES]; // correlation, share, states
    for walk in 0..walks {
        for group in objects.chunks(4) {
            let group: Vec<&Object> = group.iter().collect();
            let batch = Batch::draw(&group, Some(walk), &ask, &mut chance);
            let mut question = batch.question(device);
            change(&group, walk, &mut question);
            let answer = net.forward(question);
            let ranks: Vec<f32> = answer.ranks.into_data().try_to_vec().expect("ranks are f32");
            add(&batch, &ranks, &mut sums);
        }
    }
    let of = |index: usize| sums.map(|sum| (sum[index] / sum[2].max(1.0)) as f32);
    Measured { spearman: of(0), share: of(1) }
}

fn add(batch: &Batch, ranks: &[f32], sums: &mut [[f64; 3]; OBJECTIVES]) {
    for state in 0..batch.counts.len() * batch.objects {
        let free: Vec<usize> = (0..batch.others)
            .map(|other| state * batch.others + other)
            .filter(|&place| !batch.visited[place])
            .collect();
        for (objective, sum) in sums.iter_mut().enumerate() {
            let of = |values: &[f32]| -> Vec<f32> {
                free.iter().map(|&place| values[place * OBJECTIVES + objective]).collect()
            };
            let (exact, predicted) = (of(&batch.truth.gains), of(ranks));
            let best = exact.iter().copied().fold(f32::MIN, f32::max);
            let mean = exact.iter().sum::<f32>() / exact.len() as f32;
            if best - mean < 1e-6 {
                continue; // all views are alike: nothing to rank
            }
            let chosen = (0..predicted.len())
                .max_by(|&a, &b| predicted[a].total_cmp(&predicted[b]))
                .map_or(mean, |index| exact[index]);
            let wide = |values: &[f32]| values.iter().copied().map(f64::from).collect::<Vec<_>>();
            sum[0] += spearman(&wide(&predicted), &wide(&exact)).unwrap_or(0.0);
            sum[1] += f64::from((chosen - mean) / (best - mean));
            sum[2] += 1.0;
        }
    }
}
