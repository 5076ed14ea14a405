//! The figures that the fast accelerator is to reach, judged by a benchmark.

use super::catalogue::Class;
use super::study::{KINDS, SceneResult, Study, geomean};
use std::fmt::Write as _;

/// One figure and what is to be said of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What is to be reached.
    pub bar: String,
    /// Whether it is; `None` if what it needs was not measured.
    pub met: Option<bool>,
    /// The numbers that decided.
    pub numbers: String,
}

const OBVHS: &str = "obvhs-native-cwbvh:preset=very_slow";
const EMBREE: &str = "embree";
const ROBUST: &str = "embree-robust";
const SPHERES: &[Class] = &[Class::SphereClouds, Class::SphereClusters];
const TRIANGLES: &[Class] = &[Class::Triangles];
const OVERLAPPING: &[Class] = &[Class::Overlapping];

/// Who competes for the earliest image.
const RIVALS: [&str; 5] = [
    "embree:quality=low",
    EMBREE,
    "obvhs-native-bvh2:preset=fastest",
    "obvhs-native-cwbvh:preset=fastest",
    "obvhs-native-cwbvh",
];

/// The figures for the accelerator `subject` (and for `subject:quality=fast`, where that was measured); none if it was not
/// measured at all.
///
/// What takes other programs to measure (the cost of exactness, two threads, dispatch) is not among them.
pub fn figures(study: &Study, subject: &str) -> Vec<Figure> {
    if !study.accels().iter().any(|accel| accel == subject) {
        return Vec::new();
    }
    let judge = Judge { study, subject, fast: format!("{subject}:quality=fast") };
    let mut all = vec![
        judge.speed("ordinary triangles", TRIANGLES, OBVHS, 1.3),
        judge.speed("spheres", SPHERES, OBVHS, 2.2),
        judge.speed("overlapping and slivers", OVERLAPPING, OBVHS, 5.0),
        judge.worst(OBVHS, 0.8),
        judge.speed("ordinary triangles, first bar", TRIANGLES, EMBREE, 0.85),
        judge.speed("ordinary triangles, aim", TRIANGLES, EMBREE, 1.0),
        judge.speed("ordinary triangles", TRIANGLES, ROBUST, 1.0),
        judge.speed("spheres", SPHERES, EMBREE, 2.0),
        judge.speed("overlapping and slivers", OVERLAPPING, EMBREE, 3.0),
        judge.speed("stadium and mixed scale", &[Class::MixedScale], EMBREE, 0.7),
        judge.cost(
            "build of ordinary triangles, quality=fast",
            "ns",
            TRIANGLES,
            &judge.fast,
            90.0,
            SceneResult::build_ns,
        ),
        judge.cost("build of ordinary triangles", "ns", TRIANGLES, subject, 380.0, SceneResult::build_ns),
        judge.slivers(3.0),
        judge.cost("build of spheres", "ns", SPHERES, subject, 90.0, SceneResult::build_ns),
        judge.cost("ordinary triangles", "bytes", TRIANGLES, subject, 150.0, SceneResult::bytes),
        judge.cost("overlapping and slivers", "bytes", OVERLAPPING, subject, 300.0, SceneResult::bytes),
    ];
    let of = |classes: &'static [Class]| move |scene: &SceneResult| classes.contains(&scene.class);
    all.push(judge.image("1 spp, spheres and dragon", 1, 1.0, |s| of(SPHERES)(s) || s.name == "dragon"));
    all.push(judge.image("64 spp, spheres and slivers", 64, 1.0, |s| of(SPHERES)(s) || of(OVERLAPPING)(s)));
    all.push(judge.image("64 spp, elsewhere", 64, 0.9, |s| !of(SPHERES)(s) && !of(OVERLAPPING)(s)));
    all
}

struct Judge<'a> {
    study: &'a Study,
    subject: &'a str,
    fast: String,
}

impl Judge<'_> {
    fn scenes(&self, classes: &'static [Class]) -> impl Iterator<Item = (&SceneResult, usize)> {
        let of_class = self.study.scenes.iter().filter(|scene| classes.contains(&scene.class));
        of_class.filter_map(|scene| Some((scene, scene.row(self.subject)?)))
    }

    /// Speed of the subject over that of `anchor`, in each kind of rays, in the mean.
    fn speed(&self, what: &str, classes: &'static [Class], anchor: &str, least: f64) -> Figure {
        let means = KINDS.map(|kind| geomean(self.scenes(classes).map(|(s, row)| s.ratio(row, anchor, kind))));
        let bar = format!("{what}: at least {least} times {anchor} in each kind of rays");
        Figure { bar, met: all(&means, |mean| mean >= least), numbers: triple(means) }
    }

    /// The slowest scene and kind of rays against `anchor`.
    fn worst(&self, anchor: &str, least: f64) -> Figure {
        let mut worst: Option<(f64, String)> = None;
        for scene in &self.study.scenes {
            let Some(row) = scene.row(self.subject) else { continue };
            for kind in KINDS {
                let ratio = scene.ratio(row, anchor, kind);
                if ratio.is_finite() && worst.as_ref().is_none_or(|(least, _)| ratio < *least) {
                    worst = Some((ratio, format!("{ratio:.2} on {}, {}", scene.name, kind.name())));
                }
            }
        }
        let bar = format!("every scene and kind of rays: at least {least} times {anchor}");
        let met = worst.as_ref().map(|(ratio, _)| *ratio >= least);
        Figure { bar, met, numbers: worst.map_or(String::new(), |(_, words)| words) }
    }

    /// The mean of what `of` says of `accel`.
    fn cost(
        &self,
        what: &str,
        unit: &str,
        classes: &'static [Class],
        accel: &str,
        most: f64,
        of: fn(&SceneResult, usize) -> f64,
    ) -> Figure {
        let scenes = self.study.scenes.iter().filter(|scene| classes.contains(&scene.class));
        let mean = geomean(scenes.filter_map(|scene| Some(of(scene, scene.row(accel)?))));
        let met = mean.is_finite().then_some(mean <= most);
        let numbers = if mean.is_finite() { format!("{mean:.0} {unit}") } else { String::new() };
        Figure { bar: format!("{what}: at most {most} {unit} a primitive"), met, numbers }
    }

    /// The build over overlapping triangles and slivers against Embree's.
    fn slivers(&self, most: f64) -> Figure {
        let ratio = |(s, row): (&SceneResult, usize)| Some(s.build_ns(row) / s.build_ns(s.row(EMBREE)?));
        let mean = geomean(self.scenes(OVERLAPPING).filter_map(ratio));
        let met = mean.is_finite().then_some(mean <= most);
        let numbers = if mean.is_finite() { format!("{mean:.2}") } else { String::new() };
        Figure { bar: format!("build of overlapping and slivers: at most {most} times {EMBREE}'s"), met, numbers }
    }

    /// The time to an image of every scene that is `meant`, against the best rival.
    fn image(&self, what: &str, spp: u32, least: f64, meant: impl Fn(&SceneResult) -> bool) -> Figure {
        let mut ratios = Vec::new();
        for scene in self.study.scenes.iter().filter(|scene| meant(scene)) {
            let best = |accels: &mut dyn Iterator<Item = &str>| {
                let seconds = accels.filter_map(|accel| Some(scene.image_seconds(scene.row(accel)?, spp)));
                seconds.fold(f64::NAN, f64::min)
            };
            let ours = best(&mut [self.subject, self.fast.as_str()].into_iter());
            let ratio = best(&mut RIVALS.into_iter()) / ours;
            if ratio.is_finite() {
                ratios.push((ratio, scene.name.as_str()));
            }
        }
        ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
        let bar =
            format!("image at {what}: on every scene at least {least} times as soon as the best of Embree and obvhs");
        let mut numbers = String::new();
        for (ratio, name) in ratios.iter().take(4) {
            // Writing to a string cannot fail.
            let _ = write!(numbers, "{}{name} {ratio:.2}", if numbers.is_empty() { "" } else { ", " });
        }
        Figure { bar, met: ratios.first().map(|(ratio, _)| *ratio >= least), numbers }
    }
}

/// Whether all are `good`; `None` if one is unknown.
fn all(values: &[f64; 3], good: impl Fn(f64) -> bool) -> Option<bool> {
    values.iter().all(|v| v.is_finite()).then(|| values.iter().all(|v| good(*v)))
}

fn triple(values: [f64; 3]) -> String {
    if values.iter().all(|v| v.is_nan()) {
        return String::new();
    }
    values.map(|v| if v.is_finite() { format!("{v:.2}") } else { "-".to_string() }).join(" / ")
}
