//! How good a scheme is at the objective it plans for, and a predictor at ranking candidates.
//!
//! Everything is measured after the same first views: three by farthest points, from a candidate
//! that the seed draws. From there the baseline goes on by chance, and the oracle greedily by the
//! exact gain of one objective.
//!
//! **Spearman's rank correlation** of predicted with exact gains, over the candidates not yet
//! visited, along one path for all predictors: the baseline's. For a budget B it is the mean over
//! the states of 3 to B - 1 views, then over seeds, then over objects. States in which every
//! candidate would gain the same have no order and are left out.
//!
//! **Closed gap** of objective O at budget B: what the scheme that plans for O alone reaches of the
//! way from the baseline to the oracle, `(scheme - random) / (oracle - random)`, each a mean over
//! seeds. Over objects it is the ratio of the two means, not the mean of ratios: an object on which
//! the oracle gains next to nothing over chance would decide the latter.
//!
//! **Intervals** are 95 % bootstrap intervals over objects, see
//! [`interval`]. Differences are paired: of the same draw.

use vantage_core::{Objective, Pose, Scores};

use crate::record::{
    DifferenceRow, Estimate, Measure, MetricRow, MetricsRecord, ObjectMetrics, OfObjective,
};
use crate::statistics::{self, RESAMPLES, interval, mean};

/// A value for each objective, C, Q, D, T.
pub type Four<T> = [T; 4];

/// What was measured on one object with one seed.
#[derive(Clone, Debug)]
pub struct Run {
    /// The object's place in the comparison; runs of one object stand together.
    pub number: usize,
    /// The object's name.
    pub object: String,
    /// The baseline's scores after 1, 2, 3 … views.
    pub random: Vec<Scores>,
    /// The scores of each objective's oracle, by that objective; shape (views).
    pub oracle: Vec<Four<f32>>,
    /// What each scheme did, in the order of the comparison.
    pub schemes: Vec<SchemeRun>,
}

/// What one scheme did on one object with one seed.
#[derive(Clone, Debug)]
pub struct SchemeRun {
    /// Its name.
    pub scheme: String,
    /// By objective, the score that its plan for that objective has after 1, 2, 3 … views.
    pub scores: Vec<Four<f32>>,
    /// Rank correlations in the states of 3, 4, 5 … views of the baseline's path; empty for a
    /// scheme that predicts nothing.
    pub spearman: Vec<Four<Option<f64>>>,
}

/// The rank correlations of predicted with exact gains over candidates not visited, in each state.
///
/// `path`: the views, in order; `from`: how many are taken in the first state. `predicted` and
/// `exact`: shape (states, 4, candidates).
pub fn rank_correlations(
    path: &[usize],
    from: usize,
    predicted: &[Four<Vec<f32>>],
    exact: &[Four<Vec<f32>>],
) -> Vec<Four<Option<f64>>> {
    let states = predicted.iter().zip(exact).enumerate();
    states
        .map(|(state, (predicted, exact))| {
            let visited = &path[..from + state];
            std::array::from_fn(|objective| {
                let of = |gains: &[f32]| -> Vec<f64> {
                    let open = gains.iter().enumerate().filter(|(i, _)| !visited.contains(i));
                    open.map(|(_, &gain)| f64::from(gain)).collect()
                };
                statistics::spearman(&of(&predicted[objective]), &of(&exact[objective]))
            })
        })
        .collect()
}

/// The distance of every candidate to the nearest view of a path, as farthest-point sampling
/// predicts gains: the same for all objectives. Shapes as of
/// [`Labelled::gains_along`](crate::exact::Labelled::gains_along).
pub fn distances_along(poses: &[Pose], path: &[usize], from: usize) -> Vec<Four<Vec<f32>>> {
    let nearest = |taken: usize| -> Vec<f32> {
        let distance = |pose: &Pose| {
            let to = |&view: &usize| poses[view].position().distance(pose.position());
            path[..taken].iter().map(to).fold(f32::INFINITY, f32::min)
        };
        poses.iter().map(distance).collect()
    };
    (from..path.len()).map(|taken| std::array::from_fn(|_| nearest(taken))).collect()
}

/// One object's means over its seeds, for one scheme and budget.
#[derive(Clone, Copy, Debug)]
struct Means {
    scheme: Four<f64>,
    random: Four<f64>,
    oracle: Four<f64>,
    spearman: Four<Option<f64>>,
}

/// Schemes that others are compared with.
const BASELINES: [&str; 2] = ["fps", "soarnet-poses"];

/// All figures of a comparison, at the budgets beyond the first views.
pub fn summarise(runs: &[Run], budgets: &[usize], start: usize) -> MetricsRecord {
    let mut record = MetricsRecord {
        resamples: RESAMPLES,
        spearman: Vec::new(),
        closed_gap: Vec::new(),
        differences: Vec::new(),
        objects: Vec::new(),
    };
    let schemes: Vec<&str> = runs
        .first()
        .map(|run| run.schemes.iter().map(|scheme| scheme.scheme.as_str()).collect())
        .unwrap_or_default();
    for &budget in budgets.iter().filter(|&&budget| budget > start) {
        // Shape (schemes, objects).
        let table: Vec<Vec<Means>> = (0..schemes.len())
            .map(|place| by_object(runs).map(|runs| means(runs, place, budget, start)).collect())
            .collect();
        for (place, (&scheme, means)) in schemes.iter().zip(&table).enumerate() {
            record.closed_gap.push(row(scheme, budget, means.len(), |drawn, objective| {
                closed_gap(drawn.iter().map(|&object| &means[object]), objective)
            }));
            let ranks = means.iter().any(|means| means.spearman.iter().any(Option::is_some));
            if ranks {
                record.spearman.push(row(scheme, budget, means.len(), |drawn, objective| {
                    correlation(drawn.iter().map(|&object| &means[object]), objective)
                }));
            }
            for (other, &minus) in schemes.iter().enumerate() {
                let compared = BASELINES.contains(&minus) && other != place;
                // Farthest points are what networks are held against, not the other way round.
                if !compared || ["random", "fps"].contains(&scheme) {
                    continue;
                }
                let others = &table[other];
                let mut difference = |measure, value: fn(&[&Means], usize) -> Option<f64>| {
                    let of = |table: &[Means], drawn: &[usize], objective| {
                        let drawn: Vec<&Means> =
                            drawn.iter().map(|&object| &table[object]).collect();
                        value(&drawn, objective)
                    };
                    let MetricRow { of_objective, mean, .. } =
                        row(scheme, budget, means.len(), |drawn, objective| {
                            Some(of(means, drawn, objective)? - of(others, drawn, objective)?)
                        });
                    record.differences.push(DifferenceRow {
                        measure,
                        scheme: scheme.to_owned(),
                        minus: minus.to_owned(),
                        budget,
                        of_objective,
                        mean,
                    });
                };
                difference(Measure::ClosedGap, |drawn, objective| {
                    closed_gap(drawn.iter().copied(), objective)
                });
                if ranks && others.iter().any(|m| m.spearman.iter().any(Option::is_some)) {
                    difference(Measure::Spearman, |drawn, objective| {
                        correlation(drawn.iter().copied(), objective)
                    });
                }
            }
            for (runs, means) in by_object(runs).zip(means) {
                record.objects.push(object_metrics(runs, scheme, budget, means));
            }
        }
    }
    record
}

/// The runs of each object, which stand together.
fn by_object(runs: &[Run]) -> impl Iterator<Item = &[Run]> {
    runs.chunk_by(|a, b| a.number == b.number)
}

fn means(runs: &[Run], place: usize, budget: usize, start: usize) -> Means {
    let over_seeds = |value: &dyn Fn(&Run) -> f32| -> f64 {
        mean(runs.iter().map(|run| f64::from(value(run)))).unwrap_or(f64::NAN)
    };
    let step = budget - 1;
    let of = |scores: &[Four<f32>], objective: usize| {
        scores.get(step).map_or(f32::NAN, |scores| scores[objective])
    };
    Means {
        scheme: std::array::from_fn(|o| over_seeds(&|run| of(&run.schemes[place].scores, o))),
        random: Objective::ALL.map(|objective| {
            over_seeds(&|run| run.random.get(step).map_or(f32::NAN, |s| s.get(objective)))
        }),
        oracle: std::array::from_fn(|o| over_seeds(&|run| of(&run.oracle, o))),
        spearman: std::array::from_fn(|objective| {
            let states = |run: &Run| {
                let states = &run.schemes[place].spearman;
                let counted = states.iter().take(budget - start);
                mean(counted.filter_map(|state| state[objective]))
            };
            mean(runs.iter().filter_map(states))
        }),
    }
}

/// The ratio of what the scheme gains over chance to what the oracle does.
fn closed_gap<'a>(objects: impl Iterator<Item = &'a Means>, objective: usize) -> Option<f64> {
    let (mut scheme, mut oracle) = (0.0, 0.0);
    for means in objects {
        scheme += means.scheme[objective] - means.random[objective];
        oracle += means.oracle[objective] - means.random[objective];
    }
    (oracle > LEAST_GAP).then(|| scheme / oracle)
}

/// An oracle that gains less than this over chance leaves no gap to close: rounding.
const LEAST_GAP: f64 = 1e-6;

fn correlation<'a>(objects: impl Iterator<Item = &'a Means>, objective: usize) -> Option<f64> {
    mean(objects.filter_map(|means| means.spearman[objective]))
}

/// A statistic of drawn objects for each objective, and its mean over the four.
fn row(
    scheme: &str,
    budget: usize,
    objects: usize,
    statistic: impl Fn(&[usize], usize) -> Option<f64>,
) -> MetricRow {
    let all: Vec<usize> = (0..objects).collect();
    let estimate = |statistic: &dyn Fn(&[usize]) -> Option<f64>| {
        let value = statistic(&all);
        let interval = value.and_then(|_| interval(objects, statistic));
        Estimate { value, low: interval.map(|i| i[0]), high: interval.map(|i| i[1]) }
    };
    let [coverage, geometry, diversity, texture] =
        std::array::from_fn(|objective| estimate(&|drawn| statistic(drawn, objective)));
    // An objective in which there is nothing to gain does not count, and none may be missing
    // in some draws only.
    let counted: Vec<usize> = (0..4).filter(|&o| statistic(&all, o).is_some()).collect();
    let mean = estimate(&|drawn| {
        let values: Option<Vec<f64>> = counted.iter().map(|&o| statistic(drawn, o)).collect();
        mean(values?)
    });
    MetricRow {
        scheme: scheme.to_owned(),
        budget,
        of_objective: OfObjective { coverage, geometry, diversity, texture },
        mean,
    }
}

fn object_metrics(runs: &[Run], scheme: &str, budget: usize, means: &Means) -> ObjectMetrics {
    let of = |values: Four<Option<f64>>| {
        let [coverage, geometry, diversity, texture] = values;
        OfObjective { coverage, geometry, diversity, texture }
    };
    let some = |values: Four<f64>| of(values.map(Some));
    ObjectMetrics {
        object: runs[0].object.clone(),
        scheme: scheme.to_owned(),
        budget,
        scores: some(means.scheme),
        random: some(means.random),
        oracle: some(means.oracle),
        closed_gap: of(std::array::from_fn(|o| closed_gap(std::iter::once(means), o))),
        spearman: of(means.spearman),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATH: [usize; 5] = [4, 0, 2, 3, 1];

    /// One object with one seed; scores are the same in all objectives and after any view.
    fn run(number: usize, [random, mine, oracle]: [f32; 3], spearman: f64) -> Run {
        let four = |score: f32| vec![[score; 4]; 5];
        let [coverage, geometry, diversity, texture] = [random; 4];
        let states = vec![[Some(spearman); 4], [Some(spearman), None, Some(0.0), Some(spearman)]];
        let scheme = |name: &str, score, spearman| SchemeRun {
            scheme: name.to_owned(),
            scores: four(score),
            spearman,
        };
        Run {
            number,
            object: format!("object {number}"),
            random: vec![Scores { coverage, geometry, diversity, texture }; 5],
            oracle: four(oracle),
            schemes: vec![scheme("fps", random, vec![]), scheme("mine", mine, states)],
        }
    }

    fn near(estimate: Estimate, expected: f64) {
        let value = estimate.value.unwrap();
        assert!((value - expected).abs() < 1e-6, "{value} {expected}");
    }

    #[test]
    fn closed_gaps_are_ratios_of_means() {
        // Of 0.4 the scheme closes 0.2, of 0.1 it closes 0.1: 0.3 of 0.5 together. Two seeds each.
        let runs = [
            run(0, [0.4, 0.6, 0.8], 0.5),
            run(0, [0.4, 0.6, 0.8], 0.7),
            run(1, [0.5, 0.6, 0.6], 0.8),
            run(1, [0.5, 0.6, 0.6], 0.8),
        ];
        let record = summarise(&runs, &[3, 5], 3);
        let row = |name| record.closed_gap.iter().find(|row| row.scheme == name).unwrap();
        assert!(record.closed_gap.iter().all(|row| row.budget == 5));
        near(row("mine").of_objective.coverage, 0.6);
        near(row("mine").mean, 0.6);
        near(row("fps").mean, 0.0);
        // Draws of one object alone have 0.5 and 1.
        let Estimate { low, high, .. } = row("mine").mean;
        assert!((low.unwrap() - 0.5).abs() < 1e-6 && (high.unwrap() - 1.0).abs() < 1e-6);
        let [first, ..] =
            record.objects.iter().filter(|o| o.scheme == "mine").collect::<Vec<_>>()[..]
        else {
            panic!("no objects")
        };
        assert!((first.closed_gap.texture.unwrap() - 0.5).abs() < 1e-6);
        let [difference] = record.differences.as_slice() else { panic!("one difference") };
        assert_eq!((difference.measure, difference.minus.as_str()), (Measure::ClosedGap, "fps"));
        near(difference.mean, 0.6);
    }

    #[test]
    fn rank_correlations_are_means_over_states_then_seeds_then_objects() {
        let scores = [0.4, 0.6, 0.8];
        let runs = [run(0, scores, 0.5), run(0, scores, 0.7), run(1, scores, 0.8)];
        let record = summarise(&runs, &[4, 5], 3);
        let [four, five] = record.spearman.as_slice() else { panic!("one predictor, two budgets") };
        assert_eq!((four.budget, five.budget), (4, 5));
        near(four.of_objective.coverage, (0.6 + 0.8) / 2.0);
        near(five.of_objective.coverage, (0.6 + 0.8) / 2.0);
        near(five.of_objective.geometry, (0.6 + 0.8) / 2.0); // states without an order do not count
        near(five.of_objective.diversity, (0.3 + 0.4) / 2.0);
    }

    #[test]
    fn where_nothing_can_be_gained_there_is_no_gap() {
        let record = summarise(&[run(0, [0.5, 0.5, 0.5], 1.0)], &[5], 3);
        assert_eq!(record.closed_gap[1].of_objective.coverage.value, None);
        assert_eq!(record.closed_gap[1].mean.value, None);
        assert_eq!(record.spearman[0].mean.low, None); // one object has no interval
    }

    #[test]
    fn visited_candidates_do_not_count() {
        let gains = |values: [f32; 5]| -> Four<Vec<f32>> { std::array::from_fn(|_| values.into()) };
        // 4, 0 and 2 are visited: of 1 and 3 the order is right, then wrong.
        let exact = [gains([9.0, 1.0, 9.0, 2.0, 9.0])];
        let right = [gains([0.0, 0.3, 5.0, 0.4, 7.0])];
        let wrong = [gains([0.0, 0.4, 5.0, 0.3, 7.0])];
        assert_eq!(rank_correlations(&PATH, 3, &right, &exact), [[Some(1.0); 4]]);
        assert_eq!(rank_correlations(&PATH, 3, &wrong, &exact), [[Some(-1.0); 4]]);
    }

    #[test]
    fn farthest_points_predict_the_distance_to_the_nearest_view() {
        let at =
            |x: f32| Pose::looking_at(vantage_core::Vec3::new(x, 1.0, 0.0), Default::default());
        let poses: Vec<Pose> = [0.0, 1.0, 3.0, 7.0, 4.0].map(|x| at(x).unwrap()).into();
        let gains = distances_along(&poses, &PATH, 3);
        assert_eq!(gains.len(), 2);
        assert_eq!(gains[0][0], [0.0, 1.0, 0.0, 3.0, 0.0]);
        assert_eq!(gains[1][3], [0.0, 1.0, 0.0, 0.0, 0.0]);
    }
}
