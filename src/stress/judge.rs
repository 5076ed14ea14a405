//! Judges answers by the exact ones, and counts what is wrong with them.

use super::ask::{Answer, Asked};
use crate::accel::Hit;
use crate::measure::rounds::same;
use crate::oracle::Truth;
use crate::ray::Ray;

/// How many faults of an accelerator on a case are kept.
const MOST_FAULTS: usize = 3;

/// What an accelerator did on a case; counts of rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// Rays that were asked about.
    pub rays: u64,
    /// Hits that were not found.
    pub missed: u64,
    /// Hits of rays that hit nothing.
    pub false_hits: u64,
    /// Hits with another primitive than the least of those at the least parameter.
    pub wrong: u64,
    /// Of these, hits with a primitive that is not at the least parameter at all.
    pub outside: u64,
    /// Parameters that are NaN, or infinite where f32 can hold the exact one.
    pub not_finite: u64,
    /// Parameters that are not the f32 nearest to the exact one.
    pub not_rounded: u64,
    /// Largest error of a parameter, where the primitive is one at the least parameter; units in the last place of f32.
    pub t_error: f64,
    /// Rays on which `any_hit` contradicts `closest_hit`.
    pub any: u64,
    /// Rays on which a method that counts contradicts the one that does not.
    pub counted: u64,
    /// Answers that differ, in primitive or in a bit of the parameter, from those of the first exact accelerator.
    pub differing: u64,
    /// Rays that made it panic.
    pub panics: u64,
    /// Rays that took more steps or tests than any ray should.
    pub hangs: u64,
    /// Rays that were left when the time was up.
    pub untraced: u64,
    /// Most voxels, nodes or leaps of a ray.
    pub most_steps: u64,
    /// Most primitive tests of a ray.
    pub most_tests: u64,
    /// The first faults.
    pub faults: Vec<Fault>,
}

/// A ray on which an accelerator is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Index of the ray in its case.
    pub index: u64,
    /// The ray.
    pub ray: Ray,
    /// What is wrong, such as "missed".
    pub kind: &'static str,
    /// What the accelerator said.
    pub answer: String,
    /// What is true.
    pub truth: String,
}

impl Tally {
    /// Judges the answer about ray `index`. `first` is the answer of the first exact accelerator, if it gave one; a ray that
    /// takes more than `most_work` steps and tests together counts as endless.
    pub(super) fn judge(
        &mut self,
        (index, ray): (u64, &Ray),
        asked: &Asked,
        truth: Option<&Truth>,
        first: Option<&Asked>,
        most_work: u64,
    ) {
        let answer = match asked {
            Asked::Left => {
                self.untraced += 1;
                return;
            }
            Asked::Panicked(message) => {
                self.rays += 1;
                self.panics += 1;
                self.fault(index, ray, "panic", message.clone(), truth);
                return;
            }
            Asked::Answered(answer) => answer,
        };
        self.rays += 1;
        let mut fault = self.closest(answer.closest, truth);
        let mut count = |is_wrong: bool, counter: &mut u64, kind| {
            if is_wrong {
                *counter += 1;
                fault = fault.or(Some(kind));
            }
        };
        count(answer.any != answer.closest.is_some(), &mut self.any, "any hit contradicts closest hit");
        let told = !same(answer.counted, answer.closest) || answer.any_counted != answer.any;
        count(told, &mut self.counted, "counting changes the answer");
        if let Some(Asked::Answered(first)) = first {
            count(!same(first.closest, answer.closest), &mut self.differing, "differs from the first accelerator");
        }
        let steps = answer.counts.steps + answer.counts.leaps;
        count(steps + answer.counts.tests > most_work, &mut self.hangs, "too many steps");
        self.most_steps = self.most_steps.max(steps);
        self.most_tests = self.most_tests.max(answer.counts.tests);
        if let Some(kind) = fault {
            self.fault(index, ray, kind, show(answer), truth);
        }
    }

    /// Judges the closest hit; gives the worst that is wrong with it.
    fn closest(&mut self, hit: Option<Hit>, truth: Option<&Truth>) -> Option<&'static str> {
        let (hit, truth) = match (hit, truth) {
            (None, None) => return None,
            (None, Some(_)) => {
                self.missed += 1;
                return Some("missed");
            }
            (Some(_), None) => {
                self.false_hits += 1;
                return Some("false hit");
            }
            (Some(hit), Some(truth)) => (hit, truth),
        };
        let mut fault = None;
        let is_finite = hit.t.is_finite() || (hit.t.is_infinite() && truth.nearest.is_infinite());
        if !is_finite {
            self.not_finite += 1;
            fault = Some("parameter is not finite");
        }
        if truth.prims.first() != Some(&hit.prim) {
            self.wrong += 1;
            fault = Some("wrong primitive");
            if truth.prims.binary_search(&hit.prim).is_err() {
                self.outside += 1;
                return fault;
            }
        }
        // Zeros of both signs are one number.
        if hit.t != truth.nearest {
            self.not_rounded += 1;
            fault = fault.or(Some("not the nearest parameter"));
        }
        if hit.t.is_finite() && truth.nearest.is_finite() {
            self.t_error = self.t_error.max(truth.ulps(hit.t));
        }
        fault
    }

    fn fault(&mut self, index: u64, ray: &Ray, kind: &'static str, answer: String, truth: Option<&Truth>) {
        if self.faults.len() < MOST_FAULTS {
            let truth = truth.map_or("nothing".to_string(), |truth| {
                let (few, count) = (&truth.prims[..truth.prims.len().min(4)], truth.prims.len());
                let more = if count > few.len() { format!(" and {} more", count - few.len()) } else { String::new() };
                format!("t = {:?} (f32 {:?}), primitives {few:?}{more}", truth.t, truth.nearest)
            });
            self.faults.push(Fault { index, ray: *ray, kind, answer, truth });
        }
    }

    /// Rays that are wrong in the hit itself.
    pub fn strict(&self) -> u64 {
        self.missed + self.false_hits + self.wrong
    }

    /// Rays per million that were missed, false and wrong in the primitive, with what else is wrong; `0` if nothing is.
    pub fn per_million(&self) -> String {
        let of = |n: u64| (n as f64 * 1e6 / self.rays.max(1) as f64).round();
        let mut text = match self.strict() {
            0 => "0".to_string(),
            _ => format!("{}/{}/{}", of(self.missed), of(self.false_hits), of(self.wrong)),
        };
        let others = [
            (self.not_finite, "not finite"),
            (self.any + self.counted, "contradictory"),
            (self.differing, "different"),
            (self.panics, "panics"),
            (self.hangs, "endless"),
            (self.untraced, "left"),
        ];
        for (n, what) in others.into_iter().filter(|(n, _)| *n > 0) {
            text += &format!(" !{n} {what}");
        }
        text
    }

    /// True if nothing at all is wrong with an accelerator that promises exact answers, its parameters aside.
    pub fn is_zero(&self) -> bool {
        let others = [self.not_finite, self.any, self.counted, self.differing, self.panics, self.hangs, self.untraced];
        self.strict() == 0 && others == [0; 7]
    }
}

fn show(answer: &Answer) -> String {
    let hit = |hit: Option<Hit>| {
        hit.map_or("nothing".to_string(), |hit| {
            format!("primitive {} at t = {:?} ({:08x})", hit.prim, hit.t, hit.t.to_bits())
        })
    };
    let mut text = hit(answer.closest);
    if answer.any != answer.closest.is_some() {
        text += &format!("; any hit: {}", answer.any);
    }
    if !same(answer.counted, answer.closest) || answer.any_counted != answer.any {
        text += &format!("; counted: {}, any hit: {}", hit(answer.counted), answer.any_counted);
    }
    text
}
