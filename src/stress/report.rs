//! What a run gave, and what the bar says about it.

use super::cases::Case;
use super::judge::Tally;
use super::time::Times;
use super::walks::{self, VoxelCase};
use crate::measure::Machine;

/// A run over cases of the catalogue.
#[derive(Clone, Debug)]
pub struct Study {
    /// One for each case.
    pub results: Vec<CaseResult>,
    /// One for each case of the voxel walks.
    pub walks: Vec<WalkResult>,
    /// Rays asked for in each case.
    pub rays: u64,
    /// Timed rounds.
    pub rounds: u32,
    /// What it was measured on.
    pub machine: Machine,
}

/// One case.
#[derive(Clone, Debug)]
pub struct CaseResult {
    /// The case.
    pub case: &'static Case,
    /// Number of primitives.
    pub primitives: u64,
    /// Rays traced.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
    /// Rays that hit several primitives at the same, least parameter.
    pub ties: u64,
    /// How long all of it took.
    pub seconds: f64,
    /// One for each accelerator that suits the case's primitives.
    pub rows: Vec<Row>,
}

/// One case of the voxel walks.
#[derive(Clone, Debug)]
pub struct WalkResult {
    /// The case.
    pub case: &'static VoxelCase,
    /// Every walk with every kind of rays.
    pub rows: Vec<walks::Row>,
}

/// One accelerator on a case.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its specification.
    pub accel: String,
    /// True if it promises exact answers.
    pub exact: bool,
    /// What became of it.
    pub outcome: Outcome,
}

/// What became of an accelerator on a case.
#[derive(Clone, Debug)]
pub enum Outcome {
    /// It was built and asked.
    Traced {
        /// What it answered.
        tally: Tally,
        /// What that cost; `None` if it was not timed.
        times: Option<Times>,
    },
    /// It refused the primitives, with this reason.
    Refused(String),
    /// Building it panicked, with this message.
    Panicked(String),
}

impl Row {
    /// What it answered, if it was built.
    pub fn tally(&self) -> Option<&Tally> {
        match &self.outcome {
            Outcome::Traced { tally, .. } => Some(tally),
            _ => None,
        }
    }

    /// What that cost, if it was timed.
    pub fn times(&self) -> Option<Times> {
        match &self.outcome {
            Outcome::Traced { times, .. } => *times,
            _ => None,
        }
    }

    /// True if it did not do what an exact accelerator promises. A refusal with a reason is no failure.
    pub fn fails(&self) -> bool {
        match &self.outcome {
            Outcome::Traced { tally, .. } => !(tally.is_zero() && tally.not_rounded == 0),
            Outcome::Refused(_) => false,
            Outcome::Panicked(_) => true,
        }
    }
}

/// What is to be said of one line of the bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// What is demanded of the exact accelerators.
    pub bar: &'static str,
    /// Whether it is met.
    pub met: bool,
    /// Whether the run counts as failed if it is not met.
    pub decides: bool,
    /// The numbers that decided.
    pub numbers: String,
}

/// Bad rays and bad vertices may cost this many ordinary rays.
const BAD: f64 = 2.5;
/// Rays of any case may cost this many ordinary rays.
const SLOW: f64 = 20.0;

impl Study {
    /// Every accelerator on every case.
    pub fn rows(&self) -> impl Iterator<Item = (&CaseResult, &Row)> {
        self.results.iter().flat_map(|result| result.rows.iter().map(move |row| (result, row)))
    }

    /// The exact accelerators on every case.
    fn exact(&self) -> impl Iterator<Item = (&CaseResult, &Row)> {
        self.rows().filter(|(_, row)| row.exact)
    }

    /// Names of all accelerators in order, with whether they promise exact answers.
    pub fn accels(&self) -> Vec<(String, bool)> {
        let mut names: Vec<(String, bool)> = Vec::new();
        for (_, row) in self.rows() {
            if !names.iter().any(|(name, _)| *name == row.accel) {
                names.push((row.accel.clone(), row.exact));
            }
        }
        names
    }

    /// The lines of the bar.
    pub fn verdicts(&self) -> Vec<Verdict> {
        let (mut traced, mut refused) = (0, 0);
        for (_, row) in self.exact() {
            match &row.outcome {
                Outcome::Refused(_) => refused += 1,
                Outcome::Traced { tally, .. } => traced += tally.rays,
                Outcome::Panicked(_) => {}
            }
        }
        let panicked = |row: &Row| matches!(row.outcome, Outcome::Panicked(_));
        let faulty = self.exact().filter(|(_, row)| panicked(row) || row.tally().is_some_and(|t| !t.is_zero())).count();
        let tallies = || self.exact().filter_map(|(_, row)| row.tally());
        let strayed = tallies().filter(|tally| tally.not_rounded > 0).count();
        let worst = tallies().fold(0.0f64, |worst, tally| worst.max(tally.t_error));
        vec![
            Verdict {
                bar: "strict zero: nothing missed, false, wrong, contradictory, different, endless, no panic",
                met: faulty == 0,
                decides: true,
                numbers: format!(
                    "{faulty} of {} pairs of case and accelerator are faulty; {traced} answers, {refused} refusals",
                    self.exact().count()
                ),
            },
            Verdict {
                bar: "t the f32 nearest to the exact parameter: within 0.5 ulp",
                met: strayed == 0,
                decides: true,
                numbers: format!("{strayed} pairs are not; largest error {worst:.4} ulp"),
            },
            self.walked(),
            self.slowest("bad input costs at most 2.5 ordinary rays", BAD, |case| case.bad_input),
            self.slowest("no case's rays cost more than 20 ordinary ones, on the average", SLOW, |_| true),
        ]
    }

    fn walked(&self) -> Verdict {
        let ours = || self.walks.iter().flat_map(|result| &result.rows).filter(|row| row.walk.is_ours());
        let (broken, rays) =
            (ours().filter(|row| !row.keeps_promise()).count(), ours().map(|row| row.tally.rays).sum::<u64>());
        let uncovered: u64 = ours().map(|row| row.tally.uncovered).sum();
        Verdict {
            bar: "no length lost in any voxel walk: no part of a ray outside the padded voxels visited",
            met: broken == 0,
            decides: true,
            numbers: format!(
                "{broken} of {} rows lose some, {uncovered} voxels uncovered; {rays} rays",
                ours().count()
            ),
        }
    }

    fn slowest(&self, bar: &'static str, most: f64, which: impl Fn(&Case) -> bool) -> Verdict {
        let mut timed: Vec<(f64, &str, &str)> = self
            .exact()
            .filter(|(result, _)| which(result.case))
            .filter_map(|(result, row)| Some((row.times()?.ratio(), result.case.name, row.accel.as_str())))
            .collect();
        timed.sort_by(|a, b| b.0.total_cmp(&a.0));
        let over = timed.iter().filter(|(ratio, ..)| *ratio > most).count();
        let numbers = match timed.first() {
            Some((ratio, case, accel)) => {
                format!("{over} of {} pairs cost more; the most is {ratio:.1} ({case}, {accel})", timed.len())
            }
            None => "nothing was timed".to_string(),
        };
        Verdict { bar, met: over == 0, decides: false, numbers }
    }

    /// True if no line of the bar that decides is missed.
    pub fn passed(&self) -> bool {
        self.verdicts().iter().all(|verdict| verdict.met || !verdict.decides)
    }

    /// The exact accelerators that fail, with their cases.
    pub fn failures(&self) -> impl Iterator<Item = (&CaseResult, &Row)> {
        self.exact().filter(|(_, row)| row.fails())
    }
}
