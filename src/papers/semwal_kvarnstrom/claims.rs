//! The paper's twelve claims, each judged by a stated rule on the measured numbers.

use super::super::report::{Claim, Verdict, significant};
use super::study::{CHESSBOARD, CLOUDS, DSZ, DUAL, Study};
use super::views::VIEWS;

/// A claim of the paper, and how it is judged.
struct Rule {
    id: &'static str,
    claim: &'static str,
    rule: &'static str,
    judge: fn(&Study) -> Outcome,
}

/// Whether the rule is met, and the numbers; `None` if something that it needs was not measured.
type Outcome = Option<(bool, String)>;

/// All claims in the order of the paper; their numbers are ours.
const RULES: [Rule; 12] = [
    Rule {
        id: "C1",
        claim: "every method renders faster than the plain grid, on every scene, view and grid",
        rule: "the ratio is above 1 for clouds, dsz and dual everywhere",
        judge: all_faster,
    },
    Rule {
        id: "C2",
        claim: "the ratios grow with the grid size",
        rule: "for clouds, dsz and dual, on every scene and view, each finer grid has a larger ratio",
        judge: ratios_grow,
    },
    Rule {
        id: "C3",
        claim: "the plain grid's render time worsens as the grid is refined",
        rule: "on every scene and view each finer grid takes the plain grid longer",
        judge: plain_worsens,
    },
    Rule {
        id: "C4",
        claim: "directed safe zones are never slower than proximity clouds, but for Lanes in the smallest grid",
        rule: "dsz renders no slower than clouds everywhere but on lanes in the smallest grid",
        judge: zones_beat_clouds,
    },
    Rule {
        id: "C5",
        claim: "dual extents are mostly faster than proximity clouds",
        rule: "dual renders faster than clouds in more than half of all cases",
        judge: dual_beats_clouds,
    },
    Rule {
        id: "C6",
        claim: "dual extents are the best on Lanes in all grids",
        rule: "on lanes, in every grid, dual takes less time for the three views together than the plain grid, clouds and dsz",
        judge: dual_wins_lanes,
    },
    Rule {
        id: "C7",
        claim: "dual extents lie between proximity clouds and directed safe zones on Random",
        rule: "on random, in every grid, dual's time for the three views together is between clouds' and dsz's",
        judge: dual_between,
    },
    Rule {
        id: "C8",
        claim: "preprocessing for directed safe zones takes only slightly longer than for proximity clouds",
        rule: "on every scene and grid dsz builds in at most 1.5 times clouds' time",
        judge: zones_build,
    },
    Rule {
        id: "C9",
        claim: "preprocessing for dual extents takes many times that of proximity clouds, and much memory",
        rule: "on every scene, in the largest grid, dual builds in at least 3 times clouds' time",
        judge: dual_builds,
    },
    Rule {
        id: "C10",
        claim: "in nearly full grids all methods fall back to the plain walk",
        rule: "on random with 4 and 8 voxels an axis clouds, dsz and dual enter at least 95 % as many voxels as the plain grid",
        judge: full_grids,
    },
    Rule {
        id: "C11",
        claim: "preprocessing pays off over several views",
        rule: "on every scene and grid building and three views take clouds, dsz and dual less time than the plain grid",
        judge: amortised,
    },
    Rule {
        id: "C12",
        claim: "the city-block metric is the best for proximity clouds",
        rule: "over all cases clouds (city-block) enter no more voxels and take no more time than chessboard distances",
        judge: city_block,
    },
];

/// Judges all claims, in the order of the paper.
pub fn judge(study: &Study) -> Vec<Claim> {
    let claim = |&Rule { id, claim, rule, judge }: &Rule| {
        let (verdict, numbers) = match judge(study) {
            Some((holds, numbers)) => (Verdict::of(holds), numbers),
            None => (Verdict::NotMeasured, String::new()),
        };
        Claim { id, claim, rule, verdict, numbers }
    };
    RULES.iter().map(claim).collect()
}

/// Scene, view and grid.
type Place = (usize, usize, usize);

fn places(study: &Study) -> impl Iterator<Item = Place> + '_ {
    let grids = study.grids.len();
    (0..study.scenes.len()).flat_map(move |s| (0..VIEWS.len()).flat_map(move |v| (0..grids).map(move |g| (s, v, g))))
}

fn name(study: &Study, (s, v, g): Place) -> String {
    format!("{}, {}, {}", study.scenes[s], VIEWS[v], study.grids[g])
}

/// Clouds, zones and dual extents.
fn papers(study: &Study) -> Option<[usize; 3]> {
    Some([study.method(CLOUDS)?, study.method(DSZ)?, study.method(DUAL)?])
}

/// The measured pairs of scene and view, once for each of the paper's methods.
fn series(study: &Study) -> Option<Vec<[usize; 3]>> {
    let methods = papers(study)?;
    let pairs = (0..study.scenes.len()).flat_map(|s| (0..VIEWS.len()).map(move |v| (s, v)));
    Some(pairs.flat_map(|(s, v)| methods.map(|m| [s, v, m])).collect())
}

fn all_faster(study: &Study) -> Outcome {
    let methods = papers(study)?;
    let all: Vec<(f64, usize, Place)> =
        places(study).flat_map(|p| methods.map(|m| (study.ratio(p.0, p.1, p.2, m), m, p))).collect();
    let above = all.iter().filter(|(ratio, ..)| *ratio > 1.0).count();
    let (least, m, place) = all.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let (method, place) = (&study.methods[*m], name(study, *place));
    let least = significant(*least);
    Some((above == all.len(), format!("{above} of {} above 1; least {least} ({method}; {place})", all.len())))
}

fn ratios_grow(study: &Study) -> Outcome {
    let series = series(study)?;
    let finest = study.grids.len() - 1;
    let rises =
        |[s, v, m]: &&[usize; 3]| (1..=finest).all(|g| study.ratio(*s, *v, g, *m) > study.ratio(*s, *v, g - 1, *m));
    let ends = |[s, v, m]: &&[usize; 3]| study.ratio(*s, *v, finest, *m) > study.ratio(*s, *v, 0, *m);
    let (rise, larger) = (series.iter().filter(rises).count(), series.iter().filter(ends).count());
    let numbers = format!(
        "{rise} of {0} rise at every refinement; {larger} of {0} are larger at {1} than at {2} voxels an axis",
        series.len(),
        study.grids[finest],
        study.grids[0]
    );
    (finest > 0).then_some((rise == series.len(), numbers))
}

fn plain_worsens(study: &Study) -> Outcome {
    let finest = study.grids.len() - 1;
    let pairs: Vec<(usize, usize)> =
        (0..study.scenes.len()).flat_map(|s| (0..VIEWS.len()).map(move |v| (s, v))).collect();
    let time = |s, v, g| study.cost(s, v, g, 0).seconds;
    let worse = pairs.iter().filter(|(s, v)| (1..=finest).all(|g| time(*s, *v, g) > time(*s, *v, g - 1))).count();
    let growth: Vec<String> = (0..study.scenes.len())
        .map(|s| {
            let factor = study.render(s, finest, 0) / study.render(s, 0, 0);
            format!("{} x{}", study.scenes[s], significant(factor))
        })
        .collect();
    let numbers = format!(
        "{worse} of {} worsen at every refinement; from {} to {} voxels an axis, all views: {}",
        pairs.len(),
        study.grids[0],
        study.grids[finest],
        growth.join(", ")
    );
    (finest > 0).then_some((worse == pairs.len(), numbers))
}

fn zones_beat_clouds(study: &Study) -> Outcome {
    let (clouds, dsz) = (study.method(CLOUDS)?, study.method(DSZ)?);
    let lanes = study.scene("lanes");
    let of = |(s, v, g): Place| study.cost(s, v, g, dsz).seconds / study.cost(s, v, g, clouds).seconds;
    let judged: Vec<Place> = places(study).filter(|p| !(Some(p.0) == lanes && p.2 == 0)).collect();
    let worst = judged.iter().copied().max_by(|a, b| of(*a).total_cmp(&of(*b)))?;
    let count = judged.iter().filter(|p| of(**p) <= 1.0).count();
    let mut numbers = format!(
        "{count} of {}; greatest time over clouds' {} ({})",
        judged.len(),
        significant(of(worst)),
        name(study, worst)
    );
    if let Some(s) = lanes {
        let small: Vec<String> = (0..VIEWS.len()).map(|v| significant(of((s, v, 0)))).collect();
        numbers += &format!("; on lanes in the smallest grid {}", small.join(", "));
    }
    Some((count == judged.len(), numbers))
}

fn dual_beats_clouds(study: &Study) -> Outcome {
    let (clouds, dual) = (study.method(CLOUDS)?, study.method(DUAL)?);
    let all = places(study).count();
    let faster = places(study)
        .filter(|&(s, v, g)| study.cost(s, v, g, dual).seconds < study.cost(s, v, g, clouds).seconds)
        .count();
    Some((2 * faster > all, format!("{faster} of {all}")))
}

fn dual_wins_lanes(study: &Study) -> Outcome {
    let s = study.scene("lanes")?;
    let [clouds, dsz, dual] = papers(study)?;
    let rivals = [0, clouds, dsz];
    let grids = 0..study.grids.len();
    let wins = |value: &dyn Fn(usize, usize) -> f64| {
        grids.clone().filter(|&g| rivals.iter().all(|&m| value(g, dual) < value(g, m))).count()
    };
    let all = wins(&|g, m| study.render(s, g, m));
    let axis = wins(&|g, m| study.cost(s, 1, g, m).seconds);
    let steps = wins(&|g, m| study.cost(s, 1, g, m).counts.steps as f64);
    let n = study.grids.len();
    let numbers = format!(
        "best in {all} of {n} grids; along the lanes alone: fastest in {axis} of {n}, fewest steps in {steps} of {n}"
    );
    Some((all == n, numbers))
}

fn dual_between(study: &Study) -> Outcome {
    let s = study.scene("random")?;
    let [clouds, dsz, dual] = papers(study)?;
    let times = |g: usize| [clouds, dual, dsz].map(|m| study.render(s, g, m));
    let between = |g: &usize| {
        let [a, x, b] = times(*g);
        a.min(b) <= x && x <= a.max(b)
    };
    let count = (0..study.grids.len()).filter(between).count();
    let numbers: Vec<String> = (0..study.grids.len())
        .map(|g| {
            let [a, x, b] = times(g).map(|t| significant(study.render(s, g, 0) / t));
            format!("{}: clouds {a}, dual {x}, dsz {b}", study.grids[g])
        })
        .collect();
    Some((count == study.grids.len(), format!("ratios at {}", numbers.join("; "))))
}

/// Build time of one method over another's, for each scene and grid.
fn build_factors(study: &Study, method: usize, other: usize) -> Vec<(f64, usize, usize)> {
    let pairs = (0..study.scenes.len()).flat_map(|s| (0..study.grids.len()).map(move |g| (s, g)));
    pairs.map(|(s, g)| (study.built(s, g, method).seconds / study.built(s, g, other).seconds, s, g)).collect()
}

fn zones_build(study: &Study) -> Outcome {
    let factors = build_factors(study, study.method(DSZ)?, study.method(CLOUDS)?);
    let (worst, s, g) = factors.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let count = factors.iter().filter(|(factor, ..)| *factor <= 1.5).count();
    let numbers = format!(
        "{count} of {}; greatest factor {} ({}, {})",
        factors.len(),
        significant(worst),
        study.scenes[s],
        study.grids[g]
    );
    Some((count == factors.len(), numbers))
}

fn dual_builds(study: &Study) -> Outcome {
    let (clouds, dual) = (study.method(CLOUDS)?, study.method(DUAL)?);
    let finest = study.grids.len() - 1;
    let factors = build_factors(study, dual, clouds);
    let largest = factors.into_iter().filter(|(.., g)| *g == finest);
    let mut holds = true;
    let numbers: Vec<String> = largest
        .map(|(factor, s, g)| {
            holds &= factor >= 3.0;
            let [bytes, other] = [dual, clouds].map(|m| study.built(s, g, m).memory.total() as f64);
            format!("{} x{} time, x{} bytes", study.scenes[s], significant(factor), significant(bytes / other))
        })
        .collect();
    let cap = "the capped search of ours is not the paper's";
    Some((holds, format!("at {}: {}; {cap}", study.grids[finest], numbers.join(", "))))
}

fn full_grids(study: &Study) -> Outcome {
    let methods = papers(study)?;
    let steps = |grid: u32, method: usize| {
        let found = study.full.iter().find(|f| (f.grid, f.method) == (grid, method))?;
        Some(found.cost.counts.steps as f64)
    };
    let mut holds = true;
    let mut numbers = Vec::new();
    for grid in [4, 8] {
        for m in methods {
            let share = steps(grid, m)? / steps(grid, 0)?;
            holds &= share >= 0.95;
            numbers.push(format!("{} {} % at {grid}", study.methods[m], significant(100.0 * share)));
        }
    }
    Some((holds, numbers.join(", ")))
}

fn amortised(study: &Study) -> Outcome {
    let methods = papers(study)?;
    let mut counts = [0, 0];
    // Views after which the extra build time is won back; never is infinite.
    let mut worst = (0.0, String::from("none"));
    for s in 0..study.scenes.len() {
        for g in 0..study.grids.len() {
            for m in methods {
                let saved = study.render(s, g, 0) - study.render(s, g, m);
                let extra = study.built(s, g, m).seconds - study.built(s, g, 0).seconds;
                counts[0] += usize::from(extra < saved);
                counts[1] += 1;
                let views = if saved > 0.0 { VIEWS.len() as f64 * extra / saved } else { f64::INFINITY };
                if views > worst.0 {
                    worst = (views, format!("{}, {}, {}", study.methods[m], study.scenes[s], study.grids[g]));
                }
            }
        }
    }
    let views = if worst.0.is_finite() { format!("after {} views", significant(worst.0)) } else { "never".into() };
    let [won, all] = counts;
    Some((won == all, format!("{won} of {all} within three views; the last pays off {views} ({})", worst.1)))
}

fn city_block(study: &Study) -> Outcome {
    let (clouds, chessboard) = (study.method(CLOUDS)?, study.method(CHESSBOARD)?);
    let sum = |value: &dyn Fn(Place, usize) -> f64| {
        let [a, b] = [clouds, chessboard].map(|m| places(study).map(|p| value(p, m)).sum::<f64>());
        a / b
    };
    let steps = sum(&|(s, v, g), m| study.cost(s, v, g, m).counts.steps as f64);
    let time = sum(&|(s, v, g), m| study.cost(s, v, g, m).seconds);
    let numbers = format!("clouds over chessboard: steps {}, time {}", significant(steps), significant(time));
    Some((steps <= 1.0 && time <= 1.0, numbers))
}

#[cfg(test)]
mod tests {
    use super::super::study::{Built, Full};
    use super::*;
    use crate::accel::{Counts, Memory};
    use crate::papers::trace::Cost;

    fn cost(seconds: f64, steps: u64) -> Cost {
        Cost { seconds, spread: 0.0, counts: Counts { rays: 10, steps, ..Counts::default() }, wrong: 0 }
    }

    /// A world in which the paper is right: plain, clouds, dsz, dual, chessboard in grids of 8 and 16.
    fn obliging() -> Study {
        let methods = ["grid", CLOUDS, DSZ, DUAL, CHESSBOARD].map(String::from).to_vec();
        let scenes = vec!["random", "lanes"];
        let mut study = Study { scenes, primitives: vec![1, 1], grids: vec![8, 16], methods, ..Study::default() };
        for s in 0..2 {
            for g in 0..2 {
                let seconds = [0.1, 0.2, 0.25, 0.9, 0.2];
                study.builds.extend(seconds.map(|seconds| Built { seconds, memory: Memory::default() }));
                for _ in VIEWS {
                    // On lanes dual is the best; on random it lies between the others.
                    let dual = if s == 0 { 3.5 } else { 2.5 };
                    let plain = if g == 0 { 10.0 } else { 14.0 };
                    study.runs.extend([plain, 4.0, 3.0, dual, 5.0].map(|x| cost(x, x as u64)));
                }
            }
        }
        study.full = [4, 8]
            .iter()
            .flat_map(|&grid| (0..5).map(move |method| Full { grid, method, cost: cost(1.0, 100) }))
            .collect();
        study
    }

    fn verdicts(study: &Study) -> Vec<(&'static str, Verdict)> {
        judge(study).into_iter().map(|c| (c.id, c.verdict)).collect()
    }

    #[test]
    fn all_claims_hold_where_the_paper_is_right() {
        let study = obliging();
        for claim in judge(&study) {
            assert_eq!(claim.verdict, Verdict::Holds, "{claim:?}");
            assert!(!claim.numbers.is_empty(), "{claim:?}");
        }
    }

    #[test]
    fn each_claim_fails_for_its_own_reason() {
        type Spoil = fn(&mut Study);
        // Index of a run: ((scene * 2 + grid) * 3 + view) * 5 + method.
        let spoils: [(&str, Spoil); 12] = [
            ("C1", |s| s.runs[1].seconds = 11.0),
            ("C2", |s| s.runs[15 + 2].seconds = 9.0),
            ("C3", |s| s.runs[15].seconds = 9.0),
            ("C4", |s| s.runs[2].seconds = 4.1),
            ("C5", |s| s.runs.iter_mut().skip(3).step_by(5).for_each(|r| r.seconds = 4.0)),
            ("C6", |s| s.runs[30 + 3].seconds = 9.0),
            ("C7", |s| s.runs[3].seconds = 9.0),
            ("C8", |s| s.builds[2].seconds = 0.31),
            ("C9", |s| s.builds[5 + 3].seconds = 0.5),
            ("C10", |s| s.full[1].cost.counts.steps = 94),
            ("C11", |s| s.builds[1].seconds = 99.0),
            ("C12", |s| s.runs.iter_mut().skip(4).step_by(5).for_each(|r| r.counts.steps = 3)),
        ];
        for (id, spoil) in spoils {
            let mut study = obliging();
            spoil(&mut study);
            let found = verdicts(&study).into_iter().find(|(name, _)| *name == id);
            assert_eq!(found, Some((id, Verdict::Fails)));
        }
    }

    #[test]
    fn what_was_not_measured_is_not_judged() {
        let mut study = obliging();
        study.methods = ["grid", "a", "b", "c", "d"].map(String::from).to_vec();
        let judged: Vec<&str> =
            verdicts(&study).into_iter().filter(|(_, v)| *v != Verdict::NotMeasured).map(|(id, _)| id).collect();
        assert_eq!(judged, ["C3"]);
    }
}
