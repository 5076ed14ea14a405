//! Scenes made from a few numbers: the sources' test scenes and shapes for reference scenes; all seeded.

mod bumpy;
mod cars;
mod city;
mod cornell;
mod cubes;
mod flakes;
mod giant;
mod icosphere;
mod icospheres;
mod knot;
mod lanes;
mod options;
mod overlap;
pub(super) mod patch;
mod random;
mod soup;
pub mod spd;
mod stock;
mod teapot;
mod teapot_patches;
mod teapot_stadium;
mod terrain;

use super::budget::Budget;
use super::{Camera, Light, LoadOptions, Material, Mesh, RenderDefaults, SceneParts};
use crate::error::{Error, Result};
use crate::geometry::bezier::ControlPoints;
use crate::geometry::{SolidVoxels, Sphere};
use crate::registry::did_you_mean;
use glam::Vec3;

pub use options::Options;

/// What a user may know about a procedural scene.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name in specifications such as `random:n=1000,seed=7` and in the `type` of a scene file's `[[procedural]]`.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Options with their meanings and defaults, empty if there is none.
    pub options: &'static str,
    /// Which primitives have which material slot.
    pub slots: &'static str,
    /// Where the scene comes from.
    pub source: &'static str,
    keys: &'static [&'static str],
    /// Makes the geometry.
    body: fn(&Options) -> Result<Body>,
    /// What stands around it.
    stage: fn(&Options) -> Stage,
}

/// All procedural scenes, in the order of `skipgrid list`.
pub const ENTRIES: &[Entry] = &[
    random::ENTRY,
    lanes::ENTRY,
    flakes::ENTRY,
    cars::ENTRY,
    teapot_stadium::ENTRY,
    teapot::ENTRY,
    teapot_patches::ENTRY,
    cornell::ENTRY,
    knot::ENTRY,
    bumpy::ENTRY,
    cubes::ENTRY,
    terrain::ENTRY,
    overlap::ENTRY,
    flakes::ALONE,
    giant::ENTRY,
    icospheres::ENTRY,
    city::ENTRY,
    soup::SOUP,
    soup::BIG,
    soup::STICKS,
    spd::balls::ENTRY,
    spd::gears::ENTRY,
    spd::jacks::ENTRY,
    spd::lattice::ENTRY,
    spd::mount::ENTRY,
    spd::rings::ENTRY,
    spd::shells::ENTRY,
    spd::sombrero::ENTRY,
    spd::teapot::ENTRY,
    spd::tetra::ENTRY,
    spd::tree::ENTRY,
];

/// Geometry; materials are slot numbers, to be taken modulo the number of materials.
#[derive(Clone, Debug, Default)]
pub(super) struct Body {
    pub(super) meshes: Vec<Mesh>,
    pub(super) spheres: Vec<(Sphere, u32)>,
    /// Voxels; their bytes are slots plus one.
    pub(super) voxels: Option<SolidVoxels>,
    pub(super) patches: Vec<(ControlPoints, u32)>,
}

/// What makes a scene of a body.
struct Stage {
    /// The materials that slots cycle over.
    palette: Vec<Material>,
    /// More meshes, with materials of their own.
    props: Vec<(Mesh, Material)>,
    lights: Vec<Light>,
    environment: Vec3,
    camera: Option<Camera>,
    defaults: RenderDefaults,
}

/// The whole scene that `spec` names: `NAME` or `NAME:key=value,..`.
///
/// # Errors
/// The name or an option is unknown, a value is out of range, or the scene would take more memory than
/// [`LoadOptions::memory`] allows by default.
pub fn parse(spec: &str) -> Result<SceneParts> {
    parse_within(spec, &Budget::new(&LoadOptions::default()))
}

/// As [`parse`], with the memory that is left.
pub(super) fn parse_within(spec: &str, budget: &Budget) -> Result<SceneParts> {
    let (name, rest) = spec.split_once(':').unwrap_or((spec, ""));
    let entry = find(name).ok_or_else(|| {
        let files = "a file (.toml, .gltf, .glb, .obj, .vox, .npy, .tri, .sph)";
        Error::invalid(format!("scene `{spec}`: neither {files} nor {}", unknown(name)))
    })?;
    let mut options = Options::default();
    for option in rest.split(',').filter(|o| !o.is_empty()) {
        let bad = |cause: String| Error::invalid(format!("scene `{spec}`: option `{option}`: {cause}"));
        let (key, value) = option.split_once('=').ok_or_else(|| bad("not of the form key=value".into()))?;
        if !entry.keys.contains(&key) {
            let hint = did_you_mean(entry.keys, key, 2.min(key.len().saturating_sub(1)));
            return Err(bad(format!("`{name}` takes {}{hint}", keys(entry))));
        }
        options.set(key, value.parse().map_err(|_| bad(format!("`{value}` is no whole number from 0 to 2^64 - 1")))?);
    }
    scene(entry, &options, budget).map_err(|e| Error::invalid(format!("scene `{spec}`: {e}")))
}

/// The geometry that `name` makes; materials are slots. Voxels come as meshes, which can be moved.
///
/// # Errors
/// The name is unknown, or an option is not one of the entry's or out of range.
pub(super) fn body(name: &str, options: &Options, budget: &Budget) -> Result<Body> {
    let entry = find(name).ok_or_else(|| Error::invalid(format!("`{name}` is not {}", unknown(name))))?;
    if let Some(key) = options.given().find(|key| !entry.keys.contains(key)) {
        return Err(Error::invalid(format!("`{name}` takes {}, not `{key}`", keys(entry))));
    }
    let mut body = made(entry, options, budget)?;
    if let Some(voxels) = body.voxels.take() {
        body.meshes.extend(super::voxels::meshes(&voxels));
    }
    Ok(body)
}

fn scene(entry: &Entry, options: &Options, budget: &Budget) -> Result<SceneParts> {
    let Body { mut meshes, mut spheres, voxels, mut patches } = made(entry, options, budget)?;
    let Stage { palette, props, lights, environment, camera, defaults } = (entry.stage)(options);
    let colours = palette.len().max(1) as u32;
    meshes.iter_mut().for_each(|m| m.material %= colours);
    spheres.iter_mut().for_each(|(_, m)| *m %= colours);
    patches.iter_mut().for_each(|(_, m)| *m %= colours);
    let mut materials = palette;
    for (mut mesh, material) in props {
        mesh.material = materials.len() as u32;
        materials.push(material);
        meshes.push(mesh);
    }
    let name = entry.name.to_owned();
    let set = SceneParts { materials, lights, environment, camera, defaults, ..SceneParts::default() };
    Ok(SceneParts { name, meshes, spheres, voxels, patches, ..set })
}

/// The body, if there is memory for it.
fn made(entry: &Entry, options: &Options, budget: &Budget) -> Result<Body> {
    let body = (entry.body)(&Options { room: Some(budget.left() / PRIMITIVE_BYTES), ..*options })?;
    let triangles: usize = body.meshes.iter().map(|m| m.triangles.len()).sum();
    let primitives = (triangles + body.spheres.len() + body.patches.len()) as u64;
    budget.take(primitives * PRIMITIVE_BYTES, || format!("`{}`: {primitives} primitives", entry.name))?;
    Ok(body)
}

/// About the most bytes for a primitive: three corners and indices of a triangle, and its share of the vertices.
const PRIMITIVE_BYTES: u64 = 96;

fn find(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|e| e.name == name)
}

fn keys(entry: &Entry) -> String {
    if entry.keys.is_empty() { "no options".into() } else { entry.keys.join(", ") }
}

fn unknown(name: &str) -> String {
    let names: Vec<_> = ENTRIES.iter().map(|e| e.name).collect();
    let hint = did_you_mean(&names, name, 2);
    format!("one of the procedural scenes {}{hint}", names.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(name: &str, options: &Options) -> Result<Body> {
        super::body(name, options, &Budget::new(&LoadOptions::default()))
    }

    fn made(spec: &str) -> SceneParts {
        parse(spec).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Six times the volume that the mesh's outward triangles enclose.
    fn volume6(mesh: &Mesh) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum()
    }

    /// Triangles whose front disagrees with a normal at a corner.
    fn turned(mesh: &Mesh) -> usize {
        let against = |t: &&[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let front = (b - a).cross(c - a);
            t.iter().any(|&i| mesh.normals[i as usize].dot(front) <= 0.0)
        };
        mesh.triangles.iter().filter(against).count()
    }

    /// Edges that are not shared by exactly two triangles, once for each direction, by position.
    fn open_edges(mesh: &Mesh) -> usize {
        let key = |i: u32| mesh.positions[i as usize].to_array().map(f32::to_bits);
        let mut edges = std::collections::HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                *edges.entry((key(p), key(q))).or_insert(0) += 1;
                *edges.entry((key(q), key(p))).or_insert(0) -= 1;
            }
        }
        edges.values().filter(|&&n| n != 0).count()
    }

    #[test]
    fn every_entry_makes_a_valid_scene_that_is_lit() {
        for entry in ENTRIES {
            let parts = made(entry.name);
            let some = parts.meshes.len() + parts.spheres.len() + parts.patches.len() > 0;
            assert!(some || parts.voxels.is_some(), "{}", entry.name);
            let normals_fit = |m: &Mesh| m.normals.is_empty() || turned(m) == 0;
            for mesh in &parts.meshes {
                assert!(normals_fit(mesh), "{} `{}`: {} turned", entry.name, mesh.name, turned(mesh));
            }
            let scene = crate::scene::Scene::new(parts).unwrap_or_else(|e| panic!("{e}"));
            assert!(scene.warnings.is_empty() && scene.notes.is_empty(), "{:?} {:?}", scene.warnings, scene.notes);
        }
    }

    #[test]
    fn seeds_repeat_and_differ() {
        let place = |spec| made(spec).spheres[0].0.centre;
        assert_eq!(place("random:n=10,seed=7"), place("random:seed=7,n=10"));
        assert_ne!(place("random:n=10,seed=7"), place("random:n=10,seed=8"));
        let inside = |&(s, _): &(Sphere, u32)| s.centre.abs().max_element() <= 5.0 && s.radius > 0.0;
        assert!(made("random:n=500").spheres.iter().all(inside));
    }

    #[test]
    fn sphereflake_has_the_original_sums() {
        // SPD 3.14, `balls` at size factor 4: 7381 spheres; sums of x, y, z and r; top of the highest.
        let spheres = made("flakes").spheres;
        assert_eq!(spheres.len(), 7381);
        let sum =
            spheres.iter().fold(glam::DVec4::ZERO, |sum, (s, _)| sum + s.centre.as_dvec3().extend(f64::from(s.radius)));
        for (ours, right) in [(sum.x, 0.0), (sum.y, 0.0), (sum.z, 1472.163), (sum.w, 60.5)] {
            assert!((ours - right).abs() < 2e-3, "{sum}");
        }
        let top = spheres.iter().map(|(s, _)| s.centre.z + s.radius).fold(f32::MIN, f32::max);
        assert!((top - 0.8306).abs() < 1e-4, "{top}");
    }

    #[test]
    fn teapot_has_the_original_counts_and_height() {
        for n in [1, 5, 12] {
            let mesh = teapot::mesh(n);
            assert_eq!(mesh.triangles.len() as u32, 64 * n * n - 8 * n);
            let heights = mesh.positions.iter().map(|p| p.y);
            assert_eq!(heights.clone().fold(f32::MAX, f32::min), 0.0);
            assert_eq!(heights.fold(f32::MIN, f32::max), 3.15);
        }
        // The body alone is about a ball of radius 1.6 or so; inside out it would be negative.
        assert!(volume6(&teapot::mesh(8)) / 6.0 > 10.0);
    }

    #[test]
    fn closed_bodies_are_closed_and_turned_outwards() {
        for spec in
            ["knot:n=64", "bumpy:n=24", "cubes:n=3", "cars:n=2", "spd-gears:n=3", "spd-tetra:n=1", "icospheres:n=3"]
        {
            let body = {
                let (name, _) = spec.split_once(':').expect("an option");
                let n = spec.rsplit('=').next().and_then(|n| n.parse().ok());
                body(name, &Options { n, ..Options::default() }).expect("valid options")
            };
            for mesh in &body.meshes {
                assert_eq!(open_edges(mesh), 0, "{spec} `{}`", mesh.name);
                assert!(volume6(mesh) > 0.0, "{spec} `{}`", mesh.name);
            }
        }
        // A ball of 20480 triangles has all but a thousandth of its sphere's volume.
        let ball = volume6(&icosphere::unit(5)) / 6.0 * 0.75 / std::f64::consts::PI;
        assert!(ball > 0.999 && ball < 1.0, "{ball}");
        // 27 cubes of edge 0.4.
        let cubes = body("cubes", &Options { n: Some(3), ..Options::default() }).expect("valid options");
        let volume: f64 = cubes.meshes.iter().map(volume6).sum::<f64>() / 6.0;
        assert!((volume - 27.0 * 0.064).abs() < 1e-5, "{volume}");
        assert_eq!(cubes.meshes.iter().map(|m| m.triangles.len()).sum::<usize>(), 27 * 12);
    }

    #[test]
    fn counts_are_as_documented() {
        let triangles = |spec| made(spec).meshes.iter().map(|m| m.triangles.len()).sum::<usize>();
        assert_eq!(triangles("knot"), 256 * 256 / 4);
        assert_eq!(triangles("bumpy"), 4 * 80 * 79);
        assert_eq!(made("lanes:n=6").spheres.len(), 216);
        assert_eq!(made("random").spheres.len(), 1000);
        assert_eq!(triangles("cornell"), 6 * 2 + 2 * 12);
        assert_eq!(triangles("city:n=5"), 25 * 12 + 2);
        assert_eq!(triangles("icospheres:n=7,balls=1"), 7 * 80);
        for soup in ["soup:n=9", "big-soup:n=9", "sticks:n=9"] {
            assert_eq!(triangles(soup), 9);
        }
        // Balls of triangles are beside what they are balls of.
        assert_eq!(triangles("spd-mount:n=3,balls=2"), 2 * 64 + 4 * 320);
        assert_eq!(triangles("spd-tree:n=2,sides=5,balls=0"), 7 * (10 + 20) + 2);
        assert!(made("spd-tree:n=2,balls=0").spheres.is_empty());
        assert_eq!((made("giant-sphere:depth=1").spheres.len(), triangles("giant-sphere:depth=1")), (11, 0));
        assert_eq!((triangles("flakes:depth=1"), triangles("sphereflake:depth=1")), (2, 0));
    }

    #[test]
    fn bodies_are_refused_before_they_are_made_if_they_are_too_large() {
        let little = Budget::new(&LoadOptions { memory: 100 * PRIMITIVE_BYTES, ..LoadOptions::default() });
        for entry in
            ENTRIES.iter().filter(|e| e.keys.contains(&"n") && !["voxel-terrain", "spd-mount"].contains(&e.name))
        {
            let large = |name: &str| if name.starts_with("spd-") { name.to_owned() } else { format!("{name}:n=200") };
            let spec = large(entry.name);
            let message = parse_within(&spec, &little).expect_err(&spec).to_string();
            assert!(message.contains(&spec) && message.contains("memory is left for 100"), "{message}");
        }
        assert!(parse_within("random:n=60", &little).is_ok());
        assert!(parse_within("random:n=60", &little).is_err(), "what was taken is gone");
    }

    #[test]
    fn the_limit_is_asked_for_no_less_than_is_made() {
        for entry in ENTRIES {
            let body = (entry.body)(&Options::default()).expect("the usual size");
            let triangles: usize = body.meshes.iter().map(|m| m.triangles.len()).sum();
            let all = (triangles + body.spheres.len()) as u64;
            let bounded = entry.keys.contains(&"n") && !["voxel-terrain", "spd-mount"].contains(&entry.name);
            let refused = (entry.body)(&Options { room: Some(all.saturating_sub(1)), ..Options::default() }).is_err();
            assert!(refused || !bounded, "{} made {all}", entry.name);
        }
    }

    #[test]
    fn mistakes_are_explained() {
        for (spec, cause) in [
            ("flake", "did you mean `flakes`"),
            ("nothing-like-it", "random, lanes"),
            ("random:n=0", "n=0 is not within 1"),
            ("random:n=x", "`x` is no whole number"),
            ("random:depth=3", "`random` takes n, seed"),
            ("random:n", "key=value"),
            ("cornell:n=3", "no options"),
            ("flakes:depth=8", "depth=8 is not within 0 to 7"),
            ("icospheres:balls=8", "balls=8 is not within 0 to 7"),
        ] {
            let message = parse(spec).expect_err(spec).to_string();
            assert!(message.contains(cause) && message.contains(spec), "{spec}: {message}");
        }
    }
}
