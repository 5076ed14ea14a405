//! What a sweep gives: every setting with its cost and gain, and the fastest ones timed once more.

use super::comparison::{Build, Comparison, Difference, Kind, Rate};
use super::machine::Machine;
use super::sweep::Axis;

/// One setting of one accelerator.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What was swept; `None` for the accelerator as it was asked for.
    pub axis: Option<Axis>,
    /// The accelerator as it was asked for: number in [`Sweep::accels`].
    pub accel: usize,
    /// The option's value; empty for the accelerator as it was asked for.
    pub value: String,
    /// The whole specification.
    pub spec: String,
    /// Cost of building.
    pub build: Build,
    /// One for each set of rays; `None` if that is empty.
    pub rates: Vec<Option<Rate>>,
    /// For each set of rays, its rate over that of the accelerator as it was asked for, timed in the same turns; NaN if the
    /// set is empty.
    pub gains: Vec<f64>,
    /// The same over the first accelerator as it was asked for.
    pub ratios: Vec<f64>,
    /// Spread of [`Setting::gains`], as a share: the spreads of both sides, added as independent ones are.
    pub spreads: Vec<f64>,
}

impl Setting {
    /// Row `row` of `result`, whose row `own` is the accelerator as it was asked for.
    pub(super) fn of(result: &Comparison, row: usize, own: usize, what: (usize, Option<Axis>, String)) -> Self {
        let of = &result.rows[row];
        let pair = |k: usize, base: usize| Some((of.rates[k]?, result.rows[base].rates[k]?));
        let ratio = |base: usize| {
            let over = |k| pair(k, base).map_or(f64::NAN, |(a, b): (Rate, Rate)| a.rays_per_second / b.rays_per_second);
            (0..result.kinds.len()).map(over).collect()
        };
        let spread =
            |k: usize| pair(k, own).map_or(f64::NAN, |(a, b)| if row == own { 0.0 } else { a.spread.hypot(b.spread) });
        let (accel, axis, value) = what;
        Self {
            axis,
            accel,
            value,
            spec: of.accel.clone(),
            build: of.build,
            rates: of.rates.clone(),
            gains: ratio(own),
            ratios: ratio(0),
            spreads: (0..result.kinds.len()).map(spread).collect(),
        }
    }
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Sweep {
    /// The scene's name.
    pub scene: String,
    /// Number of primitives.
    pub primitives: u32,
    /// What it was measured on.
    pub machine: Machine,
    /// The sets of rays.
    pub kinds: Vec<Kind>,
    /// The accelerators as they were asked for; the first is the measure of all.
    pub accels: Vec<String>,
    /// By accelerator, then by axis, then by value; the accelerator as it was asked for comes before its axes.
    pub settings: Vec<Setting>,
    /// For each accelerator and set of rays its fastest setting, timed once more.
    pub finals: Vec<Final>,
    /// Settings that could not be built, and why.
    pub left_out: Vec<(String, String)>,
    /// Answers that differ from the first accelerator's though they promise to be exact.
    pub differing: u64,
    /// The first of them.
    pub difference: Option<Difference>,
    /// Somebody wanted no more: settings are missing.
    pub interrupted: bool,
}

impl Sweep {
    /// True if every setting that promises exact answers gave the same, to the bit, on every ray.
    pub fn identical(&self) -> bool {
        self.differing == 0
    }

    /// The fastest setting of all for the rays of set `kind`, a number in [`Sweep::kinds`], by its last rate over the first
    /// accelerator's; `None` if nothing was timed.
    pub fn fastest(&self, kind: usize) -> Option<&Final> {
        let timed = self.finals.iter().filter(|f| f.kind == kind);
        timed.max_by(|a, b| a.setting.ratios[kind].total_cmp(&b.setting.ratios[kind]))
    }

    /// The setting of accelerator `accel` that seems to be the fastest for set `kind`; `None` if nothing was timed.
    pub(super) fn candidate(&self, accel: usize, kind: usize) -> Option<&Setting> {
        let timed = self.settings.iter().filter(|s| s.accel == accel && s.gains[kind].is_finite());
        timed.max_by(|a, b| a.gains[kind].total_cmp(&b.gains[kind]))
    }

    /// Counts differences and notes the sets.
    pub(super) fn take(&mut self, result: Comparison) {
        self.differing += result.differing;
        if self.difference.is_none() {
            self.difference = result.difference;
        }
        self.kinds = result.kinds;
    }
}

/// The fastest setting of an accelerator for one set of rays.
///
/// The greatest of many noisy rates is flattered; so the fastest settings of an accelerator are timed once more, in
/// turns with it as it was asked for, and these rates count.
#[derive(Clone, Debug, PartialEq)]
pub struct Final {
    /// The set of rays: number in [`Sweep::kinds`].
    pub kind: usize,
    /// The setting, with the rates of the last time.
    pub setting: Setting,
}

impl Final {
    /// Its rate over that of its accelerator as that was asked for.
    pub fn gain(&self) -> f64 {
        self.setting.gains[self.kind]
    }

    /// Spread of the gain, as a share; 0 if the accelerator is best as it was asked for.
    pub fn spread(&self) -> f64 {
        self.setting.spreads[self.kind]
    }

    /// True if the gain is more than the spread.
    pub fn is_clear(&self) -> bool {
        self.gain() > 1.0 + self.spread()
    }
}
