//! The scenes of the benchmark: one line each.

use crate::error::{Error, Result};
use crate::registry::did_you_mean;
use crate::scene::{Camera, CameraSource, procedural};
use glam::DVec3;
use std::path::Path;

/// What a scene is like; means are taken over classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Spheres that fill a volume evenly.
    SphereClouds,
    /// Spheres in heaps.
    SphereClusters,
    /// Surfaces, plants, buildings, small unconnected triangles.
    Triangles,
    /// Large triangles through each other, and long thin ones.
    Overlapping,
    /// Something small in something very large.
    MixedScale,
    /// Not in the catalogue.
    Other,
}

impl Class {
    /// All of the catalogue, in its order.
    pub const ALL: [Class; 5] =
        [Class::SphereClouds, Class::SphereClusters, Class::Triangles, Class::Overlapping, Class::MixedScale];

    /// Name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Class::SphereClouds => "sphere-clouds",
            Class::SphereClusters => "sphere-clusters",
            Class::Triangles => "triangles",
            Class::Overlapping => "overlapping",
            Class::MixedScale => "mixed-scale",
            Class::Other => "other",
        }
    }

    /// For people.
    pub fn title(self) -> &'static str {
        match self {
            Class::SphereClouds => "sphere clouds",
            Class::SphereClusters => "sphere clusters",
            Class::Triangles => "ordinary triangles",
            Class::Overlapping => "overlapping triangles and slivers",
            Class::MixedScale => "stadium and mixed scale",
            Class::Other => "other scenes",
        }
    }
}

/// Where a scene comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// Made by formula: a specification that every verb takes.
    Made(&'static str),
    /// A file below the folder of shared scenes, which need not be there.
    File(&'static str),
    /// As the user named it, a specification or a file.
    Given,
}

/// A camera: eye, target and up in world units, vertical field of view in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Eye.
    pub eye: [f64; 3],
    /// Middle of the picture.
    pub target: [f64; 3],
    /// A direction that points up in the picture.
    pub up: [f64; 3],
    /// Vertical field of view, degrees.
    pub yfov: f64,
}

impl View {
    /// The camera.
    pub fn camera(&self) -> Camera {
        let [origin, target, up] = [self.eye, self.target, self.up].map(DVec3::from_array);
        Camera { origin, target, up, yfov: self.yfov, source: CameraSource::File }
    }
}

/// A scene of the benchmark.
#[derive(Clone, Debug, PartialEq)]
pub struct BenchScene {
    /// Name on the command line and in tables.
    pub name: String,
    /// What it is like.
    pub class: Class,
    /// Where it comes from.
    pub source: Source,
    /// Number of primitives; 0 if it is not known before loading.
    pub primitives: u32,
    /// `None`: the scene's own camera, or a framed one.
    pub view: Option<View>,
    /// Asked for by its own name, so that it is measured whatever its size.
    pub named: bool,
}

/// A line of the catalogue.
type Line = (&'static str, Class, Source, u32, Option<View>);

const fn made(name: &'static str, class: Class, spec: &'static str, primitives: u32) -> Line {
    (name, class, Source::Made(spec), primitives, None)
}

const fn file(name: &'static str, path: &'static str, primitives: u32, view: Option<View>) -> Line {
    (name, Class::Triangles, Source::File(path), primitives, view)
}

/// `y` is up.
const fn view(eye: [f64; 3], target: [f64; 3], yfov: f64) -> Option<View> {
    Some(View { eye, target, up: [0.0, 1.0, 0.0], yfov })
}

const GARDEN: Option<View> = Some(View {
    eye: [-66.2697, -75.5289, 56.2241],
    target: [4.2555, 15.1463, 5.849],
    up: [0.0, 0.0, 1.0],
    yfov: 50.0,
});

/// All scenes, by class. Each has one kind of primitive, as peers take no scene of both.
const SCENES: &[Line] = &[
    made("random-1k", Class::SphereClouds, "random:n=1000", 1_000),
    made("random-10k", Class::SphereClouds, "random:n=10000", 10_000),
    made("random-100k", Class::SphereClouds, "random:n=100000", 100_000),
    made("random-1m", Class::SphereClouds, "random:n=1000000", 1_000_000),
    made("overlap-10k", Class::SphereClouds, "overlap:n=10000", 10_000),
    made("lanes-32k", Class::SphereClouds, "lanes:n=32", 32_768),
    made("flakes-7k", Class::SphereClusters, "sphereflake:depth=4", 7_381),
    made("flakes-66k", Class::SphereClusters, "sphereflake:depth=5", 66_430),
    file("bunny", "bunny.obj", 69_451, None),
    file("dragon", "dragon.glb", 871_414, view([0.1443, 0.215, 0.1956], [-0.0059, 0.125, -0.0046], 40.0)),
    made("teapot", Class::Triangles, "teapot:n=6", 2_256),
    made("tetra-65k", Class::Triangles, "spd-tetra:n=8", 65_536),
    made("mountain-131k", Class::Triangles, "spd-mount:n=8,balls=3", 136_192),
    made("tree-114k", Class::Triangles, "spd-tree:n=9,balls=1", 114_578),
    made("icospheres-320k", Class::Triangles, "icospheres:n=1000", 320_000),
    made("soup-100k", Class::Triangles, "soup:n=100000", 100_000),
    made("city-110k", Class::Triangles, "city:n=96", 110_594),
    file("smallhouse", "smallhouse.glb", 145_844, view([-7.2067, 1.4993, 4.2951], [9.3, 1.4993, -2.6379], 70.0)),
    file(
        "willowgarage",
        "willowgarage.glb",
        13_839,
        view([8.2675, 1.4224, -27.798], [45.9597, 1.4224, -27.2205], 70.0),
    ),
    file("warehouse", "warehouse.glb", 15_003, view([1.996, 1.6099, 7.8444], [-6.8614, 1.6099, -9.5503], 70.0)),
    file("flight-helmet", "FlightHelmet.glb", 94_722, view([0.4781, 0.657, 0.6788], [-0.0204, 0.358, 0.0142], 40.0)),
    file("engine", "2CylinderEngine.glb", 121_496, view([470.2784, 237.7021, 621.0379], [0.0, -44.465, -6.0], 40.0)),
    file("furball", "furball_ribbons.glb", 303_690, view([3.0375, 2.455, 4.2087], [-0.0155, 0.6232, 0.1381], 40.0)),
    file(
        "japanese-maple",
        "japaneseMaple/japaneseMaple.obj",
        198_396,
        view([782.1903, 776.9472, 1024.0904], [70.545, 349.96, 75.23], 40.0),
    ),
    file("sterngarten", "sterngarten/Sterngarten_Wien_innerArea-optimized.obj", 71_673, GARDEN),
    file(
        "pool-table",
        "poolTable/poolTable.obj",
        57_184,
        view([170.3252, 143.3726, 227.1003], [0.0, 41.1775, 0.0], 40.0),
    ),
    made("big-soup-20k", Class::Overlapping, "big-soup:n=20000", 20_000),
    made("sticks-20k", Class::Overlapping, "sticks:n=20000", 20_000),
    made("stadium", Class::MixedScale, "teapot-stadium:n=12", 18_432),
    made("giant-sphere", Class::MixedScale, "giant-sphere:depth=4", 7_382),
];

impl BenchScene {
    fn of(&(name, class, source, primitives, view): &Line) -> Self {
        Self { name: name.to_string(), class, source, primitives, view, named: false }
    }

    /// What to load, as every verb takes it; `shared` is the folder of the files.
    pub fn spec(&self, shared: &Path) -> String {
        match self.source {
            Source::Made(spec) => spec.to_string(),
            Source::File(path) => shared.join(path).display().to_string(),
            Source::Given => self.name.clone(),
        }
    }
}

/// The scenes that `names` name, each once: scenes of the catalogue, classes of it, or whatever else can be loaded. Without
/// a name, the whole catalogue.
///
/// # Errors
/// A name is none of these.
pub fn select(names: &[String]) -> Result<Vec<BenchScene>> {
    let mut found: Vec<BenchScene> = Vec::new();
    if names.is_empty() {
        found.extend(SCENES.iter().map(BenchScene::of));
    }
    for name in names {
        let of_name = |line: &&Line| line.0 == name || line.1.name() == name;
        let before = found.len();
        let scene = |line: &Line| BenchScene { named: line.0 == name, ..BenchScene::of(line) };
        found.extend(SCENES.iter().filter(of_name).map(scene));
        if found.len() == before {
            found.push(given(name)?);
        }
    }
    let mut seen = std::collections::HashSet::new();
    found.retain(|scene| seen.insert(scene.name.clone()));
    Ok(found)
}

/// A scene that is not in the catalogue. That a file is there shows when it is loaded.
fn given(name: &str) -> Result<BenchScene> {
    let made = name.split(':').next().is_some_and(|kind| procedural::ENTRIES.iter().any(|e| e.name == kind));
    if made || Path::new(name).extension().is_some() {
        let (class, source) = (Class::Other, Source::Given);
        return Ok(BenchScene { name: name.to_string(), class, source, primitives: 0, view: None, named: true });
    }
    let known = SCENES.iter().map(|line| line.0).chain(Class::ALL.iter().map(|class| class.name()));
    let made = procedural::ENTRIES.iter().map(|entry| entry.name);
    let hint = did_you_mean(&known.chain(made).collect::<Vec<_>>(), name, 4);
    let kinds = "neither a scene of the benchmark, nor a class of them, nor made by formula, nor a file";
    Err(Error::invalid(format!("scene `{name}`: {kinds}{hint}; `skipgrid bench --list` shows what there is")))
}
