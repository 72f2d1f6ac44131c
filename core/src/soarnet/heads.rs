//! From embeddings and poses to what a further view would bring.
//!
//! SO-NeRF pools the views seen so far and lets two heads tell the scores now and with one more view.
//! We pool for each candidate: a *token* tells what one view means for one candidate, and depends on
//! the candidate only through where it lies in that view's camera. Mean and maximum of the tokens are
//! kept up as views are added, so a further view costs one token for each candidate, whatever the
//! number of views, and the order of views does not matter.
//!
//! ```text
//! token(k, z)      = cut(W2 · cut(W1 · [embedding_k | direction_k | relation(k, z)]))     (H)
//! candidate head   : [mean_k token | max_k token | outlook_z | direction_z | count] → rank scores (4)
//! state head       : [mean over z of the pooled tokens | count] → scores, mean gain, spread (12)
//! ```
//!
//! The outlook tells what the candidate would see of the visual hull: see `outlook`. A network without
//! images knows none.
//!
//! The rank scores say which candidate is better and the state's head how much gain there is at all;
//! the paper's head H tells the score after the next view instead, whose differences are small beside
//! it.

use super::features::{COUNT, DIRECTION, Direction, Stance, count};
use super::model::{Model, RANKS, STATE, WIDEST};
use super::outlook::OUTLOOK;
use crate::kernels::{accumulate, fully_connected, fully_connected_wide, mean, requantize_all};

/// The part of a token's first layer that a view brings, the same for every candidate.
#[derive(Clone, Copy, Debug)]
pub(super) struct ViewSums([i32; WIDEST]); // (H)

/// The mean over all candidates, as it is gathered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Context {
    means: [i32; WIDEST],  // (H), sums over the candidates
    maxima: [i32; WIDEST], // (H), likewise
    candidates: i32,
}

impl Default for Context {
    fn default() -> Self {
        Self { means: [0; WIDEST], maxima: [0; WIDEST], candidates: 0 }
    }
}

impl Model<'_> {
    /// Shapes: `embedding` (E), the result (H).
    pub(super) fn view_sums(&self, embedding: &[i8], stance: &Stance) -> ViewSums {
        let [layer, _] = &self.token;
        let mut sums = [0; WIDEST];
        for (sum, bias) in sums.iter_mut().zip(layer.bias) {
            *sum = i32::from_le_bytes(*bias);
        }
        accumulate(layer, 0, embedding, &mut sums);
        accumulate(layer, embedding.len(), &stance.direction.features(), &mut sums);
        ViewSums(sums)
    }

    /// Adds to a candidate's pooled state the token of a view. Shapes: `sums` and `maxima` (H).
    ///
    /// `sums` cannot overflow while there are at most 256 views.
    pub(super) fn pool(
        &self,
        view: &ViewSums,
        stance: &Stance,
        candidate: Direction,
        sums: &mut [i16],
        maxima: &mut [i8],
    ) {
        let [first, second] = &self.token;
        let ViewSums(mut totals) = *view;
        let relation = stance.relation(candidate);
        accumulate(first, self.dimensions().embedding + DIRECTION, &relation, &mut totals);
        let (mut hidden, mut token) = ([0; WIDEST], [0; WIDEST]);
        requantize_all(first, &totals, &mut hidden);
        fully_connected(second, &hidden, &mut token);
        for ((sum, maximum), token) in sums.iter_mut().zip(maxima).zip(token) {
            *sum = sum.saturating_add(token.into());
            *maximum = token.max(*maximum);
        }
    }

    /// A candidate's rank scores, units of 2^-16, from its pooled state; adds the state to `context`.
    ///
    /// Shapes: `sums` and `maxima` (H); `outlook` standardised. `views` is at least 1.
    pub(super) fn candidate_head(
        &self,
        views: usize,
        direction: Direction,
        sums: &[i16],
        maxima: &[i8],
        outlook: &[i32; OUTLOOK],
        context: &mut Context,
    ) -> [i32; RANKS] {
        let width = self.dimensions().width;
        // [mean | max | outlook | direction | count]
        let mut input = [0; 2 * WIDEST + OUTLOOK + DIRECTION + COUNT];
        let (means, rest) = input.split_at_mut(width.min(WIDEST));
        for (mean_of, sum) in means.iter_mut().zip(sums) {
            *mean_of = mean(i32::from(*sum), views as i32);
        }
        let known = if self.encoder.is_some() { OUTLOOK } else { 0 };
        let outlook = outlook.iter().map(|&number| number as i8).take(known); // at most 127
        let features = maxima.iter().copied().chain(outlook);
        let features = features.chain(direction.features()).chain(count(views));
        for (place, value) in rest.iter_mut().zip(features) {
            *place = value;
        }
        for (total, value) in context.means.iter_mut().zip(&*means) {
            *total = total.saturating_add(i32::from(*value));
        }
        for (total, value) in context.maxima.iter_mut().zip(maxima) {
            *total = total.saturating_add(i32::from(*value));
        }
        context.candidates = context.candidates.saturating_add(1);
        let [hidden_layer, output_layer] = &self.candidate;
        let mut hidden = [0; WIDEST];
        fully_connected(hidden_layer, &input, &mut hidden);
        let mut output = [0; RANKS];
        fully_connected_wide(output_layer, &hidden, &mut output);
        output
    }

    /// The scores, the mean gains and the spreads of gains, units of 2^-16.
    pub(super) fn state_head(&self, views: usize, context: &Context) -> [i32; STATE] {
        let width = self.dimensions().width;
        let mut input = [0; 2 * WIDEST + COUNT]; // [mean of means | mean of maxima | count]
        let means = context.means.iter().take(width);
        let maxima = context.maxima.iter().take(width);
        let pooled = means.chain(maxima).map(|&sum| mean(sum, context.candidates));
        for (place, value) in input.iter_mut().zip(pooled.chain(count(views))) {
            *place = value;
        }
        let [hidden_layer, output_layer] = &self.state;
        let mut hidden = [0; WIDEST];
        fully_connected(hidden_layer, &input, &mut hidden);
        let mut output = [0; STATE];
        fully_connected_wide(output_layer, &hidden, &mut output);
        output
    }
}
