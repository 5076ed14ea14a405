//! Everything in turns: levels of samples, replicates, renderers.

use super::Options;
use super::bits::{Difference, differing};
use super::cost::{Crossover, crossover};
use super::curve::{Clock, Curve, Point, Trial};
use super::equal_time::{EqualTime, even};
use super::errors::Errors;
use super::others::{Exported, Other};
use super::own;
use super::reference::{Reference, Truth};
use crate::error::{Error, Result};
use crate::measure::{Built, Machine};
use crate::picture::Picture;
use crate::registry::promises_exact;
use crate::render::Film;
use crate::scene::Scene;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// A picture in one or two halves, and what it took.
pub(super) struct Shot {
    /// Two of independent seeds, or one without random numbers.
    pub halves: Vec<Picture>,
    /// Seconds before the first ray, as far as the renderer tells; 0 for ours, whose build is measured apart.
    pub build: f64,
    /// Seconds of rendering.
    pub trace: f64,
    /// Seconds of wall time of both.
    pub wall: f64,
}

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The scene's name.
    pub scene: String,
    /// Number of primitives.
    pub primitives: u32,
    /// What it was measured on.
    pub machine: Machine,
    /// How.
    pub options: Options,
    /// What the pictures are held against.
    pub reference: Reference,
    /// The accelerators in the order given, then the other renderers.
    pub curves: Vec<Curve>,
    /// Versions of the other renderers that ran.
    pub versions: Vec<String>,
    /// Pictures of exact accelerators that are not equal; none if all is well.
    pub differences: Vec<Difference>,
    /// Other renderers that are not here, and why.
    pub left_out: Vec<(String, String)>,
    /// What the other renderers cannot show as we do.
    pub warnings: Vec<String>,
    /// Pictures of equal time, if they were asked for.
    pub equal_time: Vec<EqualTime>,
    /// Somebody wanted no more: levels are missing.
    pub interrupted: bool,
}

/// Called with the share of the work that is done, 0 to 1, and what is done next.
pub type Progress<'a> = &'a dyn Fn(f64, &str);

/// Builds the accelerators that `specs` name over `scene` and renders with all of them in turns.
///
/// Files for other renderers go into `folder`, which is left as it is. Soon after `stop` has become true it ends; levels of
/// samples that are whole are kept.
///
/// # Errors
/// There is no accelerator; one cannot be built; an option is out of range; the reference cannot be read, is of another size
/// or not finite; another renderer fails or a file cannot be written.
pub fn study(
    scene: &Scene,
    specs: &[String],
    options: &Options,
    folder: &Path,
    progress: Progress,
    stop: &AtomicBool,
) -> Result<Study> {
    options.check()?;
    let build = |spec: &String| {
        progress(0.0, &format!("building {spec}"));
        Built::new(spec, promises_exact(spec), || scene.accel(spec))
    };
    let built = specs.iter().map(build).collect::<Result<Vec<_>>>()?;
    study_of(scene, &built, options, folder, progress, stop)
}

/// As [`study`], with accelerators that are built over `scene`.
///
/// # Errors
/// As [`study`].
pub fn study_of(
    scene: &Scene,
    built: &[Built],
    options: &Options,
    folder: &Path,
    progress: Progress,
    stop: &AtomicBool,
) -> Result<Study> {
    options.check()?;
    let Some(first) = built.iter().find(|b| b.exact).or(built.first()) else {
        return Err(Error::invalid("no accelerator to render with"));
    };
    let mut run = Run { scene, built, options, progress, stop, done: 0.0, all: 1.0, exported: Vec::new() };
    let (mut left_out, mut versions, mut warnings) = (Vec::new(), Vec::new(), Vec::new());
    for &other in &options.others {
        progress(0.0, &format!("looking for {}", other.name()));
        match other.version() {
            Ok(version) => {
                versions.push(version);
                let (exported, said) = Exported::new(other, scene, options, folder)?;
                warnings.extend(said);
                run.exported.push(exported);
            }
            Err(reason) => left_out.push((other.name().to_string(), reason)),
        }
    }
    run.all = run.work();
    let reference = run.reference(first)?;
    let mut study = Study {
        scene: scene.name.clone(),
        primitives: scene.primitive_count(),
        machine: Machine::this(),
        options: options.clone(),
        reference,
        curves: run.curves(),
        versions,
        differences: Vec::new(),
        left_out,
        warnings,
        equal_time: Vec::new(),
        interrupted: stop.load(Ordering::Relaxed),
    };
    if study.interrupted {
        return Ok(study);
    }
    for (level, samples) in options.levels().into_iter().enumerate() {
        if !run.level(&mut study, level, samples)? {
            study.interrupted = true;
            return Ok(study);
        }
    }
    study.interrupted = !run.equal_time(&mut study)?;
    Ok(study)
}

impl Study {
    /// True if all pictures of exact accelerators were equal to the bit.
    pub fn identical(&self) -> bool {
        self.differences.is_empty()
    }

    /// Where the lines of time of two curves, numbers in [`Study::curves`], cross; and the same from each replicate alone.
    /// `None` where there is no line.
    pub fn crossover(&self, first: usize, second: usize) -> Option<(Crossover, Vec<Crossover>)> {
        let [a, b] = [&self.curves[first], &self.curves[second]];
        let all = crossover(&a.cost()?, &b.cost()?);
        let each =
            (0..self.options.replicates as usize).filter_map(|r| Some(crossover(&a.cost_of(r)?, &b.cost_of(r)?)));
        Some((all, each.collect()))
    }

    /// Numbers of the curves of our own accelerators.
    pub fn own(&self) -> std::ops::Range<usize> {
        0..self.curves.iter().filter(|c| c.clock == Clock::Processor).count()
    }
}

struct Run<'a> {
    scene: &'a Scene,
    built: &'a [Built],
    options: &'a Options,
    progress: Progress<'a>,
    stop: &'a AtomicBool,
    exported: Vec<Exported>,
    /// Samples rendered and to render, over all pictures.
    done: f64,
    all: f64,
}

impl Run<'_> {
    fn work(&self) -> f64 {
        let renderers = (self.built.len() + self.exported.len()) as f64;
        let levels: u32 = self.options.levels().iter().sum();
        let truth = match self.options.truth {
            Truth::Own(n) => f64::from(n),
            Truth::File(_) => 0.0,
        };
        truth + renderers * f64::from(self.options.replicates) * f64::from(levels)
    }

    fn tell(&self, stage: &str) {
        (self.progress)((self.done / self.all).min(1.0), stage);
    }

    fn curves(&self) -> Vec<Curve> {
        let own = self.built.iter().map(|b| (b.spec.clone(), Clock::Processor, b.exact));
        let others = self.exported.iter().map(|e| (e.other().name().to_string(), Clock::Wall, false));
        own.chain(others).map(|(name, clock, exact)| Curve { name, clock, exact, points: Vec::new() }).collect()
    }

    fn reference(&mut self, built: &Built) -> Result<Reference> {
        match &self.options.truth {
            Truth::File(path) => {
                let reference = Reference::read(path)?;
                let (w, h) = (reference.picture.width, reference.picture.height);
                let Options { width, height, .. } = *self.options;
                if (w, h) != (width, height) {
                    let cause = format!("the reference is {w} x {h}, the pictures are {width} x {height}");
                    return Err(Error::malformed(path, cause));
                }
                Ok(reference)
            }
            Truth::Own(samples) => {
                self.tell(&format!("rendering the reference, {samples} samples"));
                let seeds = self.options.reference_seeds();
                let rendered = own::halves(self.scene, &*built.accel, self.options, *samples, seeds, self.stop)?;
                self.done += f64::from(*samples);
                match rendered {
                    Some((shot, _)) => Reference::of_halves(&shot.halves[0], &shot.halves[1]),
                    // Told to stop: nobody looks at it.
                    None => Ok(Reference::of(Picture::new(self.options.width, self.options.height), None)),
                }
            }
        }
    }

    /// All replicates at one number of samples; false if it was told to stop, and then nothing of the level is kept.
    fn level(&mut self, study: &mut Study, level: usize, samples: u32) -> Result<bool> {
        let renderers = study.curves.len();
        let mut trials: Vec<Vec<Trial>> = vec![Vec::new(); renderers];
        for replicate in 0..self.options.replicates {
            let seeds = self.options.seeds(level, replicate);
            // Films of the first exact accelerator of this replicate.
            let mut truth: Option<(String, [Film; 2])> = None;
            for turn in 0..renderers {
                let i = (level + replicate as usize + turn) % renderers;
                if self.stop.load(Ordering::Relaxed) {
                    return Ok(false);
                }
                self.tell(&format!("{samples} samples, {}", study.curves[i].name));
                let shot = match self.built.get(i) {
                    Some(built) => self.own(study, built, samples, seeds, &mut truth)?,
                    None => self.other(i - self.built.len(), replicate, samples, seeds)?,
                };
                self.done += f64::from(samples);
                match shot {
                    Turn::Stopped => return Ok(false),
                    Turn::Missing => {}
                    Turn::Shot(shot) => {
                        let build = self.built.get(i).map_or(shot.build, |b| b.build.cpu_milliseconds * 1e-3);
                        let (errors, _) = Errors::of(&shot.halves, &study.reference)?;
                        trials[i].push(Trial { build, trace: shot.trace, wall: shot.wall, errors });
                    }
                }
            }
        }
        for (curve, trials) in study.curves.iter_mut().zip(trials).filter(|(_, trials)| !trials.is_empty()) {
            curve.points.push(Point { samples, trials });
        }
        Ok(true)
    }

    fn own(
        &self,
        study: &mut Study,
        built: &Built,
        samples: u32,
        seeds: [u64; 2],
        truth: &mut Option<(String, [Film; 2])>,
    ) -> Result<Turn> {
        let rendered = own::halves(self.scene, &*built.accel, self.options, samples, seeds, self.stop)?;
        let Some((shot, films)) = rendered else { return Ok(Turn::Stopped) };
        match truth {
            _ if !built.exact => {}
            None => *truth = Some((built.spec.clone(), films)),
            Some((name, first)) => {
                for ((a, b), seed) in first.iter().zip(&films).zip(seeds) {
                    let Some((count, pixel)) = differing(a, b) else { continue };
                    let between = [name.clone(), built.spec.clone()];
                    study.differences.push(Difference { between, samples, seed, pixel, count });
                }
            }
        }
        Ok(Turn::Shot(shot))
    }

    fn other(&self, i: usize, replicate: u32, samples: u32, seeds: [u64; 2]) -> Result<Turn> {
        let exported = &self.exported[i];
        let other = exported.other();
        // Without random numbers one picture is as good as many.
        let Some(samples) = other.samples(samples).filter(|_| replicate == 0 || other.is_random()) else {
            return Ok(Turn::Missing);
        };
        match exported.render(samples, seeds) {
            // An interrupt at the terminal ends the other program, too.
            Err(_) if self.stop.load(Ordering::Relaxed) => Ok(Turn::Stopped),
            shot => shot.map(Turn::Shot),
        }
    }

    /// False if it was told to stop.
    fn equal_time(&self, study: &mut Study) -> Result<bool> {
        let Some(seconds) = self.options.equal_time else { return Ok(true) };
        let seeds = self.options.equal_time_seeds();
        for i in 0..study.curves.len() {
            let name = study.curves[i].name.clone();
            self.tell(&format!("{seconds} seconds of {name}"));
            let Some(cost) = study.curves[i].cost() else { continue };
            let affordable = even(cost.samples(seconds), Options::MOST_SAMPLES);
            let samples = match self.exported.get(i.wrapping_sub(self.built.len())).map(Exported::other) {
                // A square number.
                Some(Other::Povray) => affordable.isqrt().pow(2),
                _ => affordable,
            };
            let nothing = EqualTime { name: name.clone(), samples: 0, seconds: 0.0, mse: f64::NAN, picture: None };
            if samples == 0 {
                study.equal_time.push(nothing);
                continue;
            }
            let shot = match self.built.get(i) {
                Some(built) => {
                    let rendered = own::halves(self.scene, &*built.accel, self.options, samples, seeds, self.stop)?;
                    let Some((shot, _)) = rendered else { return Ok(false) };
                    Shot { build: built.build.cpu_milliseconds * 1e-3, ..shot }
                }
                None => match self.exported[i - self.built.len()].render(samples, seeds) {
                    Err(_) if self.stop.load(Ordering::Relaxed) => return Ok(false),
                    shot => shot?,
                },
            };
            let (errors, picture) = Errors::of(&shot.halves, &study.reference)?;
            let took = shot.build + shot.trace;
            study.equal_time.push(EqualTime {
                samples,
                seconds: took,
                mse: errors.mse,
                picture: Some(picture),
                ..nothing
            });
        }
        Ok(true)
    }
}

/// How a turn ended.
enum Turn {
    /// With a picture.
    Shot(Shot),
    /// This renderer has none for so many samples.
    Missing,
    /// It was told to stop.
    Stopped,
}
