//! Measures one option of an accelerator after the other over its range: build, bytes, steps, tests and time.

use super::compare::{Built, contest};
use super::comparison::Comparison;
use super::machine::Machine;
use super::rays::{RayOptions, RaySet, ray_sets};
use super::swept::{Final, Setting, Sweep};
use crate::error::{Error, Result};
use crate::registry::{ENTRIES, Needs, did_you_mean, promises_exact, with_default};
use crate::scene::Scene;
use std::sync::atomic::{AtomicBool, Ordering};

/// An option that is swept; the others keep their defaults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Voxels, or cells, for each primitive: `density`.
    Density,
    /// The least distance worth a leap: `threshold`.
    Leap,
    /// Whether a ray remembers what it has tested: `mailbox`.
    Mailbox,
    /// The longest list that is not split: `leaf`.
    Leaf,
}

impl Axis {
    /// All of them.
    pub const ALL: [Axis; 4] = [Axis::Density, Axis::Leap, Axis::Mailbox, Axis::Leaf];

    /// The option's name in specifications.
    pub fn name(self) -> &'static str {
        match self {
            Axis::Density => "density",
            Axis::Leap => "threshold",
            Axis::Mailbox => "mailbox",
            Axis::Leaf => "leaf",
        }
    }

    /// The values that it takes.
    fn values(self, options: &SweepOptions) -> Vec<String> {
        let texts = |values: &[u32]| values.iter().map(u32::to_string).collect();
        match self {
            Axis::Density => options.densities.iter().map(f64::to_string).collect(),
            Axis::Leap => texts(&[1, 2, 3, 5, 8, 16]),
            Axis::Mailbox => vec!["off".into(), "on".into()],
            Axis::Leaf => texts(&[1, 2, 4, 8, 16, 32]),
        }
    }
}

/// What is swept, and how it is timed.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepOptions {
    /// Voxels for each primitive, each finite and above 0.
    pub densities: Vec<f64>,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Which rays.
    pub rays: RayOptions,
}

impl Default for SweepOptions {
    /// Densities from 1/8 to 64 by factors of two, five rounds.
    fn default() -> Self {
        let densities = (-3..=6).map(|e| 2f64.powi(e)).collect();
        Self { densities, rounds: 5, rays: RayOptions::default() }
    }
}

/// Accelerators whose names match `patterns`: a name, with options or not, or the beginning of names with a `*` behind it.
///
/// # Errors
/// A pattern matches nothing.
pub fn matching(patterns: &[String]) -> Result<Vec<String>> {
    let mut specs: Vec<String> = Vec::new();
    for pattern in patterns {
        let Some(start) = pattern.strip_suffix('*') else {
            specs.push(pattern.clone());
            continue;
        };
        let general = ENTRIES.iter().filter(|e| e.exact && e.needs == Needs::Any && e.missing().is_none());
        let found: Vec<&str> = general.map(|e| e.name).filter(|name| name.starts_with(start)).collect();
        if found.is_empty() {
            let names: Vec<&str> = ENTRIES.iter().map(|e| e.name).collect();
            let hint = did_you_mean(&names, start, 3);
            return Err(Error::Spec { spec: pattern.clone(), cause: format!("no accelerator's name begins so{hint}") });
        }
        specs.extend(found.into_iter().map(String::from));
    }
    let mut seen = std::collections::HashSet::new();
    specs.retain(|spec| seen.insert(spec.clone()));
    Ok(specs)
}

/// Sweeps every option that the accelerators have and that `specs` do not set.
///
/// The settings of one axis take turns with the accelerator as it was asked for and with the first one of all. Soon
/// after `stop` has become true it ends; axes that are finished are kept. `progress` hears of the finished axes, of
/// all, and of what is done next.
///
/// # Errors
/// There is no accelerator or no round; a density is not finite and above 0; an accelerator as it was asked for cannot
/// be built; the film has no pixels; the rays do not fit into memory.
pub fn sweep(
    scene: &Scene,
    specs: &[String],
    options: &SweepOptions,
    progress: &dyn Fn(usize, usize, &str),
    stop: &AtomicBool,
) -> Result<Sweep> {
    let (Some(first), true) = (specs.first(), options.rounds > 0) else {
        let (accels, rounds) = (specs.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to sweep: {accels} accelerators, {rounds} rounds")));
    };
    if let Some(bad) = options.densities.iter().find(|d| !(d.is_finite() && **d > 0.0)) {
        return Err(Error::invalid(format!("density {bad} is not finite and above 0")));
    }
    let groups: Vec<(usize, Option<Axis>)> =
        (0..specs.len()).flat_map(|i| axes(&specs[i]).into_iter().map(move |axis| (i, axis))).collect();
    let all = groups.len() + specs.len();
    progress(0, all, &format!("building {first}"));
    let built = vec![make(scene, first)?];
    let sets = ray_sets(scene, &*built[0].accel, &options.rays)?;
    let sweep = Sweep {
        scene: scene.name.clone(),
        primitives: scene.primitive_count(),
        machine: Machine::this(),
        kinds: Vec::new(),
        accels: specs.to_vec(),
        settings: Vec::new(),
        finals: Vec::new(),
        left_out: Vec::new(),
        differing: 0,
        difference: None,
        interrupted: false,
    };
    let mut run = Run { scene, specs, options, sets, built, sweep };
    for (done, &(accel, axis)) in groups.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            run.sweep.interrupted = true;
            break;
        }
        let title = format!("{}, {}", specs[accel], axis.map_or("as it is", Axis::name));
        run.axis(accel, axis, &|stage| progress(done, all, &format!("{title}: {stage}")))?;
    }
    for (accel, spec) in specs.iter().enumerate() {
        if stop.load(Ordering::Relaxed) {
            run.sweep.interrupted = true;
            break;
        }
        let done = groups.len() + accel;
        run.best(accel, &|stage| progress(done, all, &format!("{spec}, the best once more: {stage}")))?;
    }
    Ok(run.sweep)
}

/// A sweep under way.
struct Run<'a> {
    scene: &'a Scene,
    specs: &'a [String],
    options: &'a SweepOptions,
    sets: Vec<RaySet>,
    /// Those that take turns: the first accelerator of all as it was asked for, and what is added for one contest.
    built: Vec<Built>,
    sweep: Sweep,
}

impl Run<'_> {
    /// Measures an accelerator at every value of an axis, or as it was asked for.
    fn axis(&mut self, accel: usize, axis: Option<Axis>, stage: &dyn Fn(&str)) -> Result<()> {
        stage("building");
        let own = self.own(accel)?;
        let first = self.built.len();
        let mut values = Vec::new();
        for value in axis.map_or(Vec::new(), |axis| axis.values(self.options)) {
            let spec = with_default(&self.specs[accel], axis.map_or("", Axis::name), &value);
            match make(self.scene, &spec) {
                Ok(setting) => {
                    self.built.push(setting);
                    values.push(value);
                }
                Err(error) => self.sweep.left_out.push((spec, error.to_string())),
            }
        }
        let result = self.contest(stage)?;
        let settings = &mut self.sweep.settings;
        match axis {
            None => settings.push(Setting::of(&result, own, own, (accel, None, String::new()))),
            Some(_) => {
                let values = values.into_iter().enumerate();
                settings.extend(values.map(|(i, value)| Setting::of(&result, first + i, own, (accel, axis, value))));
            }
        }
        self.sweep.take(result);
        Ok(())
    }

    /// Measures the fastest settings of an accelerator once more.
    fn best(&mut self, accel: usize, stage: &dyn Fn(&str)) -> Result<()> {
        let kinds = 0..self.sweep.kinds.len();
        let best: Vec<Setting> = kinds.clone().filter_map(|kind| self.sweep.candidate(accel, kind)).cloned().collect();
        let own = self.own(accel)?;
        let mut rows = Vec::new();
        for setting in &best {
            let known = self.built[own..].iter().position(|b| b.spec == setting.spec).map(|row| own + row);
            rows.push(known.unwrap_or(self.built.len()));
            if known.is_none() {
                self.built.push(make(self.scene, &setting.spec)?);
            }
        }
        let result = self.contest(stage)?;
        let kinds = kinds.filter(|&kind| !self.sets[kind].rays.is_empty());
        for ((kind, row), old) in kinds.zip(rows).zip(best) {
            let setting = Setting::of(&result, row, own, (accel, old.axis, old.value));
            self.sweep.finals.push(Final { kind, setting });
        }
        self.sweep.take(result);
        Ok(())
    }

    /// The number of an accelerator, as it was asked for, among those that take turns.
    fn own(&mut self, accel: usize) -> Result<usize> {
        if accel == 0 {
            return Ok(0);
        }
        self.built.push(make(self.scene, &self.specs[accel])?);
        Ok(self.built.len() - 1)
    }

    /// What all that take turns gave; only the first of all stays.
    fn contest(&mut self, stage: &dyn Fn(&str)) -> Result<Comparison> {
        let result = contest(self.scene, &self.built, &self.sets, self.options.rounds, stage)?;
        self.built.truncate(1);
        Ok(result)
    }
}

fn make(scene: &Scene, spec: &str) -> Result<Built> {
    Built::new(spec, promises_exact(spec), || scene.accel(spec))
}

/// First as it is, then what it can be swept over: the options that it has and that `spec` does not set.
fn axes(spec: &str) -> Vec<Option<Axis>> {
    let free = |axis: &Axis| {
        // A resolution overrides the density.
        let fixed = *axis == Axis::Density && spec.contains("resolution=");
        !fixed && with_default(spec, axis.name(), "1") != spec
    };
    std::iter::once(None).chain(Axis::ALL.into_iter().filter(free).map(Some)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_options_that_exist_and_are_free_are_swept() {
        use Axis::{Density, Leaf, Leap, Mailbox};
        assert_eq!(axes("brute"), [None]);
        assert_eq!(axes("grid"), [None, Some(Density), Some(Mailbox)]);
        assert_eq!(axes("grid:resolution=8"), [None, Some(Mailbox)]);
        assert_eq!(axes("grid-octant:mailbox=on"), [None, Some(Density), Some(Leap)]);
        assert_eq!(axes("nested"), [None, Some(Density)]);
        assert_eq!(axes("bsp"), [None, Some(Leaf)]);
    }

    #[test]
    fn patterns_name_accelerators_once() {
        let all = |patterns: &[&str]| matching(&patterns.iter().map(|p| p.to_string()).collect::<Vec<_>>());
        let grids = all(&["grid", "grid*"]).expect("there are grids");
        assert_eq!((grids[0].as_str(), grids.iter().filter(|g| *g == "grid").count()), ("grid", 1));
        assert!(grids.len() >= 7 && !grids.contains(&"voxels".to_string()), "{grids:?}");
        assert_eq!(all(&["bsp:leaf=4"]).expect("a name"), ["bsp:leaf=4"]);
        assert!(all(&["grod*"]).expect_err("no such name").to_string().contains("grid"));
    }
}
