//! The catalogue: scenes and rays that are hard to get right, each a seeded generator with a name.
//!
//! A case has the difficulty in its name whatever the number of rays: ray `i` depends on the case and on `i` alone, so a
//! shorter run is a prefix of a longer one, and any ray can be made again by its index.

mod degenerate;
mod directions;
mod draw;
mod far;
mod instances;
mod lattice;
mod many;
mod mixed;
mod ranges;
mod resolutions;
mod shapes;
mod slivers;
mod solid;
mod spheres;
mod watertight;

use super::walks::{self, VoxelCase};
use crate::error::{Error, Result};
use crate::random::Random;
use crate::ray::Ray;
use crate::registry::did_you_mean;
use crate::scene::SceneGeometry;

/// Cases of one kind, a file and a table each.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Short name.
    pub name: &'static str,
    /// One line.
    pub title: &'static str,
    /// Its cases, in the order of reports.
    pub cases: &'static [Case],
}

/// All families in the order of reports.
pub const FAMILIES: &[Family] = &[
    Family { name: "watertight", title: "closed surfaces seen from inside: every ray hits", cases: watertight::CASES },
    Family { name: "slivers", title: "needles, strips and fans", cases: slivers::CASES },
    Family { name: "lattice", title: "axes, planes, diagonals and corners of lattices", cases: lattice::CASES },
    Family {
        name: "directions",
        title: "directions that are not unit vectors, or nearly axes",
        cases: directions::CASES,
    },
    Family { name: "far", title: "far origins and scenes of very different sizes", cases: far::CASES },
    Family {
        name: "degenerate",
        title: "overlaps, flat scenes, degenerate and bad triangles",
        cases: degenerate::CASES,
    },
    Family { name: "ranges", title: "ranges of the parameter, and rays that are none", cases: ranges::CASES },
    Family { name: "spheres", title: "spheres", cases: spheres::CASES },
    Family { name: "mixed", title: "triangles and spheres that touch", cases: mixed::CASES },
    Family { name: "instances", title: "instances, transformed and rounded to f32", cases: instances::CASES },
    Family { name: "resolutions", title: "grids of degenerate resolutions", cases: resolutions::CASES },
    Family { name: "solid", title: "solid voxels", cases: solid::CASES },
    Family { name: "many", title: "crowds of primitives in one place", cases: many::CASES },
];

/// One case of the catalogue.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Name on the command line.
    pub name: &'static str,
    /// What is in it, one line.
    pub summary: &'static str,
    /// True if every ray hits something: a miss is a leak.
    pub must_hit: bool,
    /// True if rays or primitives are not finite: such rays must not cost more than 2.5 ordinary ones.
    pub bad_input: bool,
    /// Most rays that are traced, and why no more.
    pub most_rays: Option<(u64, &'static str)>,
    /// Resolution that grids are given, where their specification gives none.
    pub resolution: Option<&'static str>,
    make: fn(&mut Random) -> Stage,
}

impl Case {
    /// A case of triangles.
    const fn new(name: &'static str, summary: &'static str, make: fn(&mut Random) -> Stage) -> Self {
        Self { name, summary, must_hit: false, bad_input: false, most_rays: None, resolution: None, make }
    }

    /// Every ray hits something.
    const fn must_hit(self) -> Self {
        Self { must_hit: true, ..self }
    }

    /// Rays or primitives are not finite.
    const fn bad_input(self) -> Self {
        Self { bad_input: true, ..self }
    }

    /// At most `rays` are traced, because of `reason`.
    const fn at_most(self, rays: u64, reason: &'static str) -> Self {
        Self { most_rays: Some((rays, reason)), ..self }
    }

    /// Grids get this resolution.
    const fn resolution(self, resolution: &'static str) -> Self {
        Self { resolution: Some(resolution), ..self }
    }

    /// Makes the scene; the same at each call.
    pub fn stage(&self) -> Stage {
        // FNV-1a: cases do not share their random numbers.
        let seed =
            self.name.bytes().fold(0xcbf2_9ce4_8422_2325u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        Stage { seed, ..(self.make)(&mut Random::new(seed)) }
    }

    /// How many rays are traced where `rays` are asked for.
    pub fn rays(&self, rays: u64) -> u64 {
        self.most_rays.map_or(rays, |(most, _)| rays.min(most))
    }
}

/// What draws a ray.
type Shoot = Box<dyn Fn(&mut Random) -> Ray + Send + Sync>;

/// The scene of a case and its rays.
pub struct Stage {
    /// The primitives.
    pub geometry: SceneGeometry,
    /// The scene that ordinary rays are traced through; `None`: the same.
    ordinary: Option<SceneGeometry>,
    rays: Shoot,
    good: Shoot,
    seed: u64,
}

impl Stage {
    /// Rays by `rays`; for comparison of times ordinary ones over the same scene by `good`.
    fn new(
        geometry: SceneGeometry,
        rays: impl Fn(&mut Random) -> Ray + Send + Sync + 'static,
        good: impl Fn(&mut Random) -> Ray + Send + Sync + 'static,
    ) -> Self {
        Self { geometry, ordinary: None, rays: Box::new(rays), good: Box::new(good), seed: 0 }
    }

    /// Times are compared with rays through another scene.
    fn against(self, ordinary: SceneGeometry) -> Self {
        Self { ordinary: Some(ordinary), ..self }
    }

    /// Ray `index` of the case.
    pub fn ray(&self, index: u64) -> Ray {
        (self.rays)(&mut stream(self.seed, index))
    }

    /// Ordinary ray `index`, through [`Stage::ordinary`].
    pub fn good_ray(&self, index: u64) -> Ray {
        (self.good)(&mut stream(!self.seed, index))
    }

    /// The scene of the ordinary rays.
    pub fn ordinary(&self) -> &SceneGeometry {
        self.ordinary.as_ref().unwrap_or(&self.geometry)
    }

    /// True if the ordinary rays go through another scene than the case's.
    pub fn has_other_scene(&self) -> bool {
        self.ordinary.is_some()
    }
}

/// Random numbers for item `index`. The seed is mixed, since neighbouring seeds of [`Random`] share their numbers.
fn stream(seed: u64, index: u64) -> Random {
    Random::new(Random::new(seed ^ index.wrapping_mul(0xd134_2543_de82_ef95)).next())
}

/// All cases in the order of reports.
pub fn all() -> impl Iterator<Item = &'static Case> {
    FAMILIES.iter().flat_map(|family| family.cases)
}

/// What a run is about.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Cases of the catalogue.
    pub cases: Vec<&'static Case>,
    /// Cases of the voxel walks.
    pub walks: Vec<&'static VoxelCase>,
}

/// The cases that `patterns` name, in the order of reports: names, or beginnings followed by `*`. None: all.
///
/// # Errors
/// A pattern names no case.
pub fn select(patterns: &[String]) -> Result<Selection> {
    let matches = |pattern: &str, name: &str| match pattern.strip_suffix('*') {
        Some(beginning) => name.starts_with(beginning),
        None => name == pattern,
    };
    let names: Vec<&str> = all().map(|case| case.name).chain(walks::CASES.iter().map(|case| case.name)).collect();
    if let Some(pattern) = patterns.iter().find(|p| !names.iter().any(|name| matches(p, name))) {
        let hint = did_you_mean(&names, pattern.trim_end_matches('*'), 4);
        return Err(Error::invalid(format!("no case `{pattern}`{hint}; `skipgrid stress --list` shows all")));
    }
    let chosen = |name: &str| patterns.is_empty() || patterns.iter().any(|p| matches(p, name));
    Ok(Selection {
        cases: all().filter(|case| chosen(case.name)).collect(),
        walks: walks::CASES.iter().filter(|case| chosen(case.name)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_patterns_select() {
        let mut names: Vec<&str> = all().map(|case| case.name).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        let chosen = |p: &[&str]| {
            select(&p.iter().map(|s| s.to_string()).collect::<Vec<_>>()).map(|c| c.cases.len() + c.walks.len())
        };
        assert_eq!(chosen(&[]).unwrap(), count + walks::CASES.len());
        assert_eq!(chosen(&["vox_*"]).unwrap(), walks::CASES.len());
        assert_eq!(chosen(&["soup", "empty"]).unwrap(), 2);
        assert!(chosen(&["wt_*"]).unwrap() > 10);
        assert!(chosen(&["wt_sphere_rnd"]).unwrap_err().to_string().contains("did you mean `wt_sphere_rand`?"));
        assert!(chosen(&["zz*"]).unwrap_err().to_string().contains("no case `zz*`;"));
    }

    #[test]
    fn rays_depend_on_their_index_alone() {
        let bits = |ray: Ray| {
            let (o, d) = (ray.origin, ray.direction);
            [o.x, o.y, o.z, d.x, d.y, d.z, ray.t_min, ray.t_max].map(f32::to_bits)
        };
        for case in all().filter(|case| case.most_rays.is_none()) {
            let (first, again) = (case.stage(), case.stage());
            let forwards: Vec<_> = (0..20).map(|i| bits(first.ray(i))).collect();
            let backwards: Vec<_> = (0..20).rev().map(|i| bits(again.ray(i))).collect();
            assert!(forwards.iter().eq(backwards.iter().rev()), "{}", case.name);
            assert!(forwards.iter().any(|ray| *ray != forwards[0]), "{}: all rays are equal", case.name);
        }
    }
}
