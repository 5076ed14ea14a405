//! What a benchmark gave, and what follows from it: images, ratios, means.

use super::catalogue::Class;
use super::run::Options;
use crate::measure::{Comparison, Machine, Rate, RayKind};

/// The kinds of rays, in the order of all tables: from the eye, towards a light (any hit), in all directions.
pub const KINDS: [RayKind; 3] = [RayKind::Camera, RayKind::Shadow, RayKind::Diffuse];

/// Rows and columns of the image whose time is computed.
pub const IMAGE: u32 = 512;

/// A whole benchmark.
#[derive(Clone, Debug)]
pub struct Study {
    /// What it was measured on.
    pub machine: Machine,
    /// How: with the kinds of rays that were traced, and of the anchors those that ran, in the order of the columns.
    pub options: Options,
    /// One for each scene that was measured.
    pub scenes: Vec<SceneResult>,
    /// Scenes that were not, with reasons.
    pub left_out: Vec<(String, String)>,
    /// Whether the user wanted no more.
    pub interrupted: bool,
}

/// One scene. Rows are numbers in [`Comparison::rows`], which exist.
#[derive(Clone, Debug)]
pub struct SceneResult {
    /// Name in the catalogue, or as given.
    pub name: String,
    /// What it is like.
    pub class: Class,
    /// What was loaded.
    pub spec: String,
    /// Rates, work, builds, answers.
    pub comparison: Comparison,
    /// Accelerators that were not measured, with reasons.
    pub refused: Vec<(String, String)>,
}

impl SceneResult {
    /// The row of an accelerator, if it was measured.
    pub fn row(&self, accel: &str) -> Option<usize> {
        self.comparison.rows.iter().position(|row| row.accel == accel)
    }

    /// What the accelerator of that row did with rays of that kind; `None` if there were none.
    pub fn rate(&self, row: usize, kind: RayKind) -> Option<&Rate> {
        let set = self.comparison.kinds.iter().position(|k| k.kind == kind)?;
        self.comparison.rows.get(row)?.rates.get(set)?.as_ref()
    }

    /// Rays in a second of processor time; NaN if that was not measured.
    pub fn speed(&self, row: usize, kind: RayKind) -> f64 {
        self.rate(row, kind).map_or(f64::NAN, |rate| rate.rays_per_second)
    }

    /// Speed over that of `anchor`; NaN if one of them was not measured.
    pub fn ratio(&self, row: usize, anchor: &str, kind: RayKind) -> f64 {
        self.row(anchor).map_or(f64::NAN, |anchor| self.speed(row, kind) / self.speed(anchor, kind))
    }

    /// Processor time of the build in nanoseconds for each primitive.
    pub fn build_ns(&self, row: usize) -> f64 {
        self.comparison.rows[row].build.cpu_milliseconds * 1e6 / f64::from(self.comparison.primitives.max(1))
    }

    /// Bytes beside the geometry for each primitive.
    pub fn bytes(&self, row: usize) -> f64 {
        self.comparison.rows[row].build.memory.total() as f64 / f64::from(self.comparison.primitives.max(1))
    }

    /// Seconds of processor time for an image of 512 x 512 pixels with `spp` samples each, build included: computed, not
    /// measured. A sample is one camera ray and as many shadow rays as the measured camera rays had; nothing is shaded.
    /// NaN if one of the two kinds was not measured.
    pub fn image_seconds(&self, row: usize, spp: u32) -> f64 {
        let rays = |kind| self.comparison.kinds.iter().find(|k| k.kind == kind).map_or(f64::NAN, |k| k.rays as f64);
        let samples = f64::from(IMAGE) * f64::from(IMAGE) * f64::from(spp);
        let shadow = match rays(RayKind::Shadow) / rays(RayKind::Camera) {
            0.0 => 0.0,
            share => share / self.speed(row, RayKind::Shadow),
        };
        self.comparison.rows[row].build.cpu_milliseconds / 1e3
            + samples * (1.0 / self.speed(row, RayKind::Camera) + shadow)
    }
}

/// Geometric means over the scenes of a class, of one accelerator.
#[derive(Clone, Debug, PartialEq)]
pub struct Mean {
    /// What the scenes are like.
    pub class: Class,
    /// The accelerator.
    pub accel: String,
    /// Scenes of the class that it was measured on: not the same ones for all.
    pub scenes: usize,
    /// Rays a second, by [`KINDS`]; NaN where nothing was measured.
    pub speed: [f64; 3],
    /// Speed over that of each of [`Options::anchors`] on the scenes that both were measured on, by [`KINDS`].
    pub ratios: Vec<[f64; 3]>,
    /// Processor time of the build, nanoseconds a primitive.
    pub build_ns: f64,
    /// Bytes a primitive.
    pub bytes: f64,
}

impl Study {
    /// True if on every scene the accelerators that promise exact answers gave the same, to the bit.
    pub fn identical(&self) -> bool {
        self.scenes.iter().all(|scene| scene.comparison.identical())
    }

    /// All accelerators that were measured on some scene, in the order in which they first come.
    pub fn accels(&self) -> Vec<String> {
        let mut accels: Vec<String> = Vec::new();
        for row in self.scenes.iter().flat_map(|scene| &scene.comparison.rows) {
            if !accels.contains(&row.accel) {
                accels.push(row.accel.clone());
            }
        }
        accels
    }

    /// The scenes of a class.
    pub fn of_class(&self, class: Class) -> impl Iterator<Item = &SceneResult> {
        self.scenes.iter().filter(move |scene| scene.class == class)
    }

    /// The means of every class and accelerator that was measured on some of its scenes.
    pub fn means(&self) -> Vec<Mean> {
        let mut means = Vec::new();
        for class in Class::ALL.into_iter().chain([Class::Other]) {
            for accel in self.accels() {
                let rows: Vec<(&SceneResult, usize)> =
                    self.of_class(class).filter_map(|scene| Some((scene, scene.row(&accel)?))).collect();
                if rows.is_empty() {
                    continue;
                }
                let mean = |of: &dyn Fn(&SceneResult, usize) -> f64| geomean(rows.iter().map(|(s, r)| of(s, *r)));
                means.push(Mean {
                    class,
                    scenes: rows.len(),
                    speed: KINDS.map(|kind| mean(&|s, r| s.speed(r, kind))),
                    ratios: (self.options.anchors.iter())
                        .map(|anchor| KINDS.map(|kind| mean(&|s, r| s.ratio(r, anchor, kind))))
                        .collect(),
                    build_ns: mean(&|s, r| s.build_ns(r)),
                    bytes: mean(&|s, r| s.bytes(r)),
                    accel,
                });
            }
        }
        means
    }
}

/// The geometric mean of the values that are finite and above 0; NaN if there is none.
pub fn geomean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for value in values.filter(|v| v.is_finite() && *v > 0.0) {
        sum += value.ln();
        count += 1.0;
    }
    if count == 0.0 { f64::NAN } else { (sum / count).exp() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Counts, Memory};
    use crate::measure::{Build, Deviations, Kind, Query, Row};

    /// A scene of 100 primitives where `a` builds in 1 ms of 2000 bytes and traces 1, 2, 4 million rays a second, and `b`
    /// half as many of each.
    fn scene(name: &str, factor: f64) -> SceneResult {
        let kind = |kind, rays| Kind { kind, query: Query::Closest, rays, hits: rays };
        let row = |accel: &str, speed: f64| Row {
            accel: accel.into(),
            described: String::new(),
            build: Build {
                milliseconds: 9.0,
                cpu_milliseconds: 1.0,
                memory: Memory { structure: 2000, ..Memory::default() },
            },
            rates: [1e6, 2e6, 4e6]
                .map(|rate| {
                    Some(Rate { rays_per_second: rate * speed, spread: 0.0, counts: Counts::default(), differing: 0 })
                })
                .to_vec(),
            exact: true,
            deviations: Deviations::default(),
        };
        SceneResult {
            name: name.into(),
            class: Class::Triangles,
            spec: name.into(),
            comparison: Comparison {
                scene: name.into(),
                primitives: 100,
                rounds: 1,
                machine: Machine::this(),
                kinds: vec![kind(RayKind::Camera, 400), kind(RayKind::Shadow, 100), kind(RayKind::Diffuse, 100)],
                rows: vec![row("a", factor), row("b", 0.5)],
                differing: 0,
                difference: None,
                truth: 0,
            },
            refused: Vec::new(),
        }
    }

    #[test]
    fn images_ratios_and_means_are_as_by_hand() {
        let one = scene("one", 1.0);
        // 1 ms, and 512 x 512 x (1 us + a quarter of 0.5 us) for each sample.
        assert!((one.image_seconds(0, 1) - (0.001 + 262_144.0 * 1.125e-6)).abs() < 1e-12);
        assert!((one.image_seconds(0, 64) - (0.001 + 64.0 * 262_144.0 * 1.125e-6)).abs() < 1e-9);
        assert_eq!((one.build_ns(0), one.bytes(1)), (1e4, 20.0));
        assert_eq!((one.ratio(0, "b", RayKind::Diffuse), one.ratio(1, "a", RayKind::Shadow)), (2.0, 0.5));
        assert!(one.ratio(0, "c", RayKind::Camera).is_nan());

        let scenes = vec![one, scene("two", 4.0)];
        let options = Options {
            rounds: 1,
            rays: 1,
            seed: 0,
            spp: vec![1],
            kinds: KINDS.to_vec(),
            anchors: vec!["b".to_string(), "c".to_string()],
            most_primitives: u32::MAX,
            shared: Default::default(),
        };
        let study = Study { machine: Machine::this(), options, scenes, left_out: Vec::new(), interrupted: false };
        let means = study.means();
        assert_eq!(means.iter().map(|m| (m.accel.as_str(), m.scenes)).collect::<Vec<_>>(), [("a", 2), ("b", 2)]);
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        // Twice and eight times as fast as `b`: four times in the mean.
        assert!(near(means[0].ratios[0][0], 4.0) && near(means[0].speed[0], 2e6) && near(means[1].ratios[0][2], 1.0));
        assert!(means[0].ratios[1][0].is_nan());
        assert!(geomean([f64::NAN, 0.0].into_iter()).is_nan());
    }
}
