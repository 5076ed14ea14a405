//! The measured numbers: every scene, grid size, view and method.

use super::super::trace::{Asked, Cost, check, costs, record, thinned};
use super::super::{PLAIN, Watch, plain_first, rising};
use super::Options;
use super::landing::{self, Landing};
use super::views::{SETTINGS, Setting, VIEWS};
use crate::accel::{Accel, Memory};
use crate::error::Result;
use crate::geometry::Geometry;
use crate::grid::{Grid, GridOptions};
use crate::measure::rounds::build;
use crate::registry::{promises_exact, with_default};
use crate::scene::{Scene, with_geometry};

/// The paper's methods, by their names here.
pub const CLOUDS: &str = "grid-clouds";
/// Directed safe zones.
pub const DSZ: &str = "grid-dsz";
/// Dual extents.
pub const DUAL: &str = "grid-dual";
/// The methods whose landing is in print.
const PRINTED: [&str; 3] = [CLOUDS, DSZ, DUAL];
/// The isotropic rival of the clouds.
pub const CHESSBOARD: &str = "grid-chessboard";

/// What was measured.
#[derive(Clone, Debug, Default)]
pub struct Study {
    /// Names.
    pub scenes: Vec<&'static str>,
    /// Primitives of each scene.
    pub primitives: Vec<u32>,
    /// Voxels on each axis, coarsest first.
    pub grids: Vec<u32>,
    /// Specifications without resolution; the plain grid is the first.
    pub methods: Vec<String>,
    /// By scene and grid.
    pub fillings: Vec<Filling>,
    /// By scene, grid and method.
    pub builds: Vec<Built>,
    /// By scene, grid, view and method.
    pub runs: Vec<Cost>,
    /// Wrong rays of the printed landing rule.
    pub landings: Vec<Landing>,
    /// Grids that have next to no empty voxel.
    pub full: Vec<Full>,
    /// Every object for every ray, on Random.
    pub brute: Option<Brute>,
}

/// Cost of building.
#[derive(Clone, Copy, Debug)]
pub struct Built {
    /// Seconds on all cores.
    pub seconds: f64,
    /// Bytes.
    pub memory: Memory,
}

/// A method on a coarse grid over Random.
#[derive(Clone, Debug)]
pub struct Full {
    /// Voxels on each axis.
    pub grid: u32,
    /// Index.
    pub method: usize,
    /// What it took.
    pub cost: Cost,
}

/// Brute force on the first view of Random.
#[derive(Clone, Copy, Debug)]
pub struct Brute {
    /// Rays traced.
    pub sample: u64,
    /// Rays of the picture.
    pub rays: u64,
    /// Seconds for all of them, extrapolated from the sample.
    pub seconds: f64,
    /// Rays of the sample whose answer differs from the plain grid's.
    pub wrong: u64,
}

/// How the voxels of a grid are filled.
#[derive(Clone, Copy, Debug)]
pub struct Filling {
    /// Voxels without a primitive.
    pub empty: u64,
    /// All voxels.
    pub voxels: u64,
    /// References from voxels to primitives.
    pub references: u64,
}

impl Study {
    /// Measures what `options` say.
    ///
    /// # Errors
    /// As [`super::run`].
    pub fn measure(options: &Options, watch: &Watch) -> Result<Self> {
        let methods = plain_first(&options.accels);
        let mut study = Study { methods, grids: rising(&options.grids), ..Study::default() };
        let wanted = |s: &&Setting| options.scenes.is_empty() || options.scenes.iter().any(|name| name == s.name);
        let settings: Vec<&Setting> = SETTINGS.iter().filter(wanted).collect();
        let all = settings.len() * study.grids.len();
        for (s, setting) in settings.into_iter().enumerate() {
            let scene = setting.scene()?;
            study.scenes.push(setting.name);
            study.primitives.push(scene.primitive_count());
            let pictures = pictures(setting, &scene, options.size)?;
            for g in 0..study.grids.len() {
                let grid = study.grids[g];
                watch(s * study.grids.len() + g, all, &format!("{} in {grid} voxels an axis", setting.name));
                study.grid(&scene, (s, g), &pictures, options)?;
            }
            if setting.name == "random" {
                study.full(&scene, &pictures[0], options)?;
                study.brute = Some(brute(&scene, &pictures[0], options)?);
            }
        }
        let printed: Vec<&str> = PRINTED.into_iter().filter(|m| study.method(m).is_some()).collect();
        let boxes = landing::on_boxes(&printed, options.size)?;
        study.landings.extend(boxes);
        Ok(study)
    }

    /// All methods on one scene in one grid size.
    fn grid(
        &mut self,
        scene: &Scene,
        (s, g): (usize, usize),
        pictures: &[Vec<Asked>],
        options: &Options,
    ) -> Result<()> {
        self.fillings.push(filling(scene, self.grids[g])?);
        let mut accels = Vec::new();
        for method in &self.methods {
            let (accel, milliseconds) = build(scene, &at(method, self.grids[g]))?;
            self.builds.push(Built { seconds: milliseconds / 1e3, memory: accel.memory() });
            accels.push(accel);
        }
        let accels: Vec<&dyn Accel> = accels.iter().map(|a| &**a).collect();
        for asked in pictures {
            self.runs.extend(costs(asked, &accels, options.rounds));
        }
        for method in PRINTED.into_iter().filter(|m| self.methods.iter().any(|own| own == m)) {
            let method = format!("{method}:landing=paper");
            let accel = scene.accel(&at(&method, self.grids[g]))?;
            let (mut rays, mut wrong) = (0, 0);
            for asked in pictures {
                rays += asked.len() as u64;
                wrong += check(asked, &*accel).1;
            }
            let scene = self.scenes[s].to_string();
            self.landings.push(Landing { scene, grid: self.grids[g], method, rays, wrong });
        }
        Ok(())
    }

    /// Grids so coarse that next to no voxel is empty.
    fn full(&mut self, scene: &Scene, asked: &[Asked], options: &Options) -> Result<()> {
        for grid in [4, 8] {
            let accels: Vec<Box<dyn Accel>> =
                self.methods.iter().map(|m| scene.accel(&at(m, grid))).collect::<Result<_>>()?;
            let accels: Vec<&dyn Accel> = accels.iter().map(|a| &**a).collect();
            let costs = costs(&thinned(asked, 20_000), &accels, options.rounds);
            self.full.extend(costs.into_iter().enumerate().map(|(method, cost)| Full { grid, method, cost }));
        }
        Ok(())
    }

    /// Answers that differ from the plain grid's, of everything that promises exact ones.
    pub fn wrong(&self) -> u64 {
        let exact = |m: usize| promises_exact(&self.methods[m]);
        let runs = self.runs.iter().enumerate().map(|(i, cost)| (i % self.methods.len(), cost));
        let full = self.full.iter().map(|f| (f.method, &f.cost));
        let wrong = runs.chain(full).filter(|(m, _)| exact(*m)).map(|(_, cost)| cost.wrong);
        wrong.sum::<u64>() + self.brute.map_or(0, |brute| brute.wrong)
    }

    /// Number of views.
    pub fn views(&self) -> usize {
        VIEWS.len()
    }

    /// By indices of scene, view, grid and method.
    pub fn cost(&self, s: usize, v: usize, g: usize, m: usize) -> &Cost {
        &self.runs[((s * self.grids.len() + g) * VIEWS.len() + v) * self.methods.len() + m]
    }

    /// By indices of scene, grid and method.
    pub fn built(&self, s: usize, g: usize, m: usize) -> &Built {
        &self.builds[(s * self.grids.len() + g) * self.methods.len() + m]
    }

    /// Index of a method, if it was measured.
    pub fn method(&self, name: &str) -> Option<usize> {
        self.methods.iter().position(|m| m == name)
    }

    /// Index of a scene, if it was measured.
    pub fn scene(&self, name: &str) -> Option<usize> {
        self.scenes.iter().position(|s| *s == name)
    }

    /// The plain grid's render time over the method's.
    pub fn ratio(&self, s: usize, v: usize, g: usize, m: usize) -> f64 {
        self.cost(s, v, g, 0).seconds / self.cost(s, v, g, m).seconds
    }

    /// Render time of all views, seconds.
    pub fn render(&self, s: usize, g: usize, m: usize) -> f64 {
        (0..VIEWS.len()).map(|v| self.cost(s, v, g, m).seconds).sum()
    }
}

/// How the voxels of the plain grid of `n` voxels an axis are filled.
fn filling(scene: &Scene, n: u32) -> Result<Filling> {
    fn of<G: Geometry>(geometry: G, n: u32) -> Result<Filling> {
        let options = GridOptions { resolution: Some([n; 3]), ..GridOptions::default() };
        let grid = Grid::build(geometry, &options)?;
        Ok(Filling { empty: grid.empty_voxels(), voxels: u64::from(n).pow(3), references: grid.references() })
    }
    with_geometry!(scene.geometry, g => of(g.clone(), n))
}

/// `method` in a grid of `n` voxels an axis, if it is a grid.
fn at(method: &str, n: u32) -> String {
    with_default(method, "resolution", &n.to_string())
}

/// The rays of the three views.
fn pictures(setting: &Setting, scene: &Scene, size: u32) -> Result<Vec<Vec<Asked>>> {
    let plain = scene.accel(PLAIN)?;
    let mut seen = scene.clone();
    let cameras = setting.cameras(scene.camera, &plain.bounds()).into_iter();
    cameras
        .map(|camera| {
            seen.camera = camera;
            record(&seen, &*plain, size)
        })
        .collect()
}

/// A sample of the rays, so that it takes about 2^24 tests a round.
fn brute(scene: &Scene, asked: &[Asked], options: &Options) -> Result<Brute> {
    let brute = scene.accel("brute")?;
    let primitives = scene.primitive_count().max(1) as usize;
    let sample = thinned(asked, (1 << 24) / primitives);
    let cost = costs(&sample, &[&*brute], options.rounds.min(3))[0];
    let (some, rays) = (sample.len() as u64, asked.len() as u64);
    let seconds = cost.seconds * rays as f64 / some as f64;
    Ok(Brute { sample: some, rays, seconds, wrong: cost.wrong })
}
