//! Every accelerator by name, one entry each; parses specifications such as `grid:density=4,mailbox=on`.

mod auto;
mod bsp;
mod grid;
mod nearest;
mod nested;
#[cfg(feature = "obvhs")]
mod obvhs;
mod peers;
mod spec;
mod variants;
mod voxels;

#[cfg(feature = "scene")]
pub(crate) use nearest::did_you_mean;
pub(crate) use spec::Spec;
#[cfg(feature = "cli")]
pub(crate) use spec::parse_bytes;
pub use variants::{peers, variants, walks};

use crate::accel::{Accel, BruteForce, PointShadows};
use crate::auto::Choice;
use crate::error::Result;
use crate::geometry::Geometry;
use crate::grid::{GridOptions, ShadowVoxels};
use glam::DVec3;

/// What a user may know about an accelerator before building it.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name in specifications.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Options with their ranges and defaults, empty if there is none.
    pub options: &'static str,
    /// Where the method comes from.
    pub source: &'static str,
    /// Which geometry it can be built over.
    pub needs: Needs,
    /// True if its answers are exact; false if it brings a primitive test of its own and is here to be compared with.
    pub exact: bool,
}

/// Which geometry an accelerator can be built over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// Any.
    Any,
    /// Solid voxels: one with [`Geometry::solid`].
    SolidVoxels,
    /// Triangles alone: every primitive with [`Geometry::triangle`].
    Triangles,
    /// Triangles alone, or spheres alone: every primitive with [`Geometry::sphere`].
    OneKind,
}

impl Entry {
    /// True if it can be built over `geometry`, of which it may look at every primitive.
    pub fn suits<G: Geometry + ?Sized>(&self, geometry: &G) -> bool {
        match self.needs {
            Needs::Any => true,
            Needs::SolidVoxels => geometry.solid().is_some(),
            Needs::Triangles => (0..geometry.len()).all(|prim| geometry.triangle(prim).is_some()),
            Needs::OneKind => {
                let all = |is: &dyn Fn(u32) -> bool| (0..geometry.len()).all(is);
                all(&|prim| geometry.triangle(prim).is_some()) || all(&|prim| geometry.sphere(prim).is_some())
            }
        }
    }

    /// Why it cannot be built on this machine, if so: the library that it opens at run time is not there.
    pub fn missing(&self) -> Option<String> {
        peers::missing(self.name)
    }
}

/// All accelerators compiled in, in the order of `skipgrid list`.
pub const ENTRIES: &[Entry] = &[
    Entry {
        name: "brute",
        summary: "tests every primitive for every ray",
        options: "",
        source: "the reference of the conformance tests",
        needs: Needs::Any,
        exact: true,
    },
    grid::PLAIN,
    grid::CLOUDS,
    grid::DSZ,
    grid::DUAL,
    grid::DSZ24,
    grid::CHESSBOARD,
    grid::OCTANT,
    voxels::ENTRY,
    bsp::ENTRY,
    nested::ENTRY,
    auto::ENTRY,
    #[cfg(feature = "obvhs")]
    obvhs::BVH2,
    #[cfg(feature = "obvhs")]
    obvhs::CWBVH,
    #[cfg(feature = "obvhs")]
    peers::OBVHS_BVH2,
    #[cfg(feature = "obvhs")]
    peers::OBVHS_CWBVH,
    #[cfg(feature = "embree")]
    peers::EMBREE,
    #[cfg(feature = "embree")]
    peers::EMBREE_ROBUST,
    #[cfg(feature = "bvh")]
    peers::BVH,
    #[cfg(feature = "parry")]
    peers::PARRY,
];

/// Names of accelerators that are not compiled in, with the feature that brings each in.
pub const LEFT_OUT: &[(&str, &str)] = &[
    #[cfg(not(feature = "obvhs"))]
    ("obvhs-bvh2", "obvhs"),
    #[cfg(not(feature = "obvhs"))]
    ("obvhs-cwbvh", "obvhs"),
    #[cfg(not(feature = "obvhs"))]
    ("obvhs-native-bvh2", "obvhs"),
    #[cfg(not(feature = "obvhs"))]
    ("obvhs-native-cwbvh", "obvhs"),
    #[cfg(not(feature = "embree"))]
    ("embree", "embree"),
    #[cfg(not(feature = "embree"))]
    ("embree-robust", "embree"),
    #[cfg(not(feature = "bvh"))]
    ("bvh", "bvh"),
    #[cfg(not(feature = "parry"))]
    ("parry", "parry"),
];

/// Whether the accelerator that `spec` describes promises exact answers: no peer, and no leaps that land as printed. One that
/// is not known counts as exact.
pub fn promises_exact(spec: &str) -> bool {
    let (name, options) = spec.split_once(':').unwrap_or((spec, ""));
    let entry = ENTRIES.iter().find(|entry| entry.name == name);
    entry.is_none_or(|entry| entry.exact) && !options.split(',').any(|option| option == "landing=paper")
}

/// Builds the accelerator that `spec` names over `geometry`, which it owns, borrows (`&G`) or shares (`Arc<G>`).
///
/// `spec` is a name of [`ENTRIES`], or a name and options: `name:key=value,key=value`. [`Entry::options`] says which there are.
///
/// ```
/// use skipgrid::{Accel, Hit, Ray, registry};
/// use glam::Vec3;
/// let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
/// let accel = registry::build("grid:density=4", &triangles)?;
/// let hit = accel.closest_hit(&Ray::new(Vec3::new(0.25, 0.25, -2.0), Vec3::Z));
/// assert_eq!(hit, Some(Hit { t: 2.0, prim: 0 }));
/// # Ok::<(), skipgrid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Spec`](crate::Error::Spec): the name or an option is unknown, a value is out of range, the accelerator
/// [`Needs`] another geometry or a library that is [`Entry::missing`]. [`Error::TooLarge`](crate::Error::TooLarge): the
/// structure would exceed its memory budget, or what another library can take. [`Error::Invalid`](crate::Error::Invalid):
/// another library fails.
pub fn build<'a, G: Geometry + 'a>(spec: &str, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let spec = Spec::parse(spec)?;
    Ok(match spec.name() {
        "brute" => {
            spec.finish()?;
            Box::new(BruteForce::new(geometry))
        }
        name if name == "grid" || name.starts_with("grid-") => grid::build(spec, geometry)?,
        "bsp" => bsp::build(spec, geometry)?,
        "nested" => nested::build(spec, geometry)?,
        "auto" => {
            let (chosen, _) = auto::choose(spec, &geometry)?;
            build(&chosen, geometry)?
        }
        "voxels" => match geometry.solid() {
            Some(solid) => voxels::build(spec, solid.clone())?,
            None => return Err(spec.error("needs a scene of solid voxels such as a .vox file")),
        },
        #[cfg(feature = "obvhs")]
        "obvhs-bvh2" | "obvhs-cwbvh" => obvhs::build(spec, geometry)?,
        name if peers::has(name) => peers::build(spec, &geometry)?,
        _ => return Err(spec.unknown_name(ENTRIES)),
    })
}

/// What `spec` stands for over `geometry`, and why, if it is `auto`; else `None`, and nothing but the name is looked at.
///
/// # Errors
/// It is no specification (`name:key=value,key=value`), or an option of `auto` is unknown or out of range.
pub fn choose<G: Geometry>(spec: &str, geometry: &G) -> Result<Option<(String, Choice)>> {
    let spec = Spec::parse(spec)?;
    if spec.name() == "auto" { auto::choose(spec, geometry).map(Some) } else { Ok(None) }
}

/// Builds shadow voxels over `geometry` for point lights at `lights`, world units, with `density` voxels for each primitive.
///
/// # Errors
/// As [`ShadowVoxels::build`].
pub fn shadow_voxels<'a, G: Geometry + 'a>(
    geometry: G,
    lights: &[DVec3],
    density: f64,
) -> Result<Box<dyn PointShadows + 'a>> {
    Ok(Box::new(ShadowVoxels::build(geometry, lights, &GridOptions { density, ..GridOptions::default() })?))
}

/// `spec` with the option `key=value`, where its accelerator has that option and `spec` does not set it.
pub(crate) fn with_default(spec: &str, key: &str, value: &str) -> String {
    spec::with_default(ENTRIES, spec, key, value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn every_entry_builds_over_nothing_and_over_something() {
        for entry in ENTRIES {
            for triangles in [vec![], vec![[Vec3::ZERO, Vec3::X, Vec3::Y]]] {
                if let Some(cause) = entry.missing() {
                    let Err(error) = build(entry.name, &triangles) else { panic!("{} was built", entry.name) };
                    assert!(error.to_string().contains(&cause), "{error}");
                    continue;
                }
                if !entry.suits(&triangles) {
                    let Err(error) = build(entry.name, &triangles) else { panic!("{} was accepted", entry.name) };
                    assert!(error.to_string().contains("needs a scene of solid voxels"), "{error}");
                    continue;
                }
                let accel = build(entry.name, &triangles).expect(entry.name);
                let ray = crate::Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z);
                assert_eq!(accel.any_hit(&ray), !triangles.is_empty(), "{}", entry.name);
            }
        }
    }

    #[test]
    fn wrong_specifications_say_what_is_wrong() {
        let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
        for (spec, part) in [
            ("gird", "did you mean `grid`"),
            ("grid:density=0", "density"),
            ("grid:density=nan", "density"),
            ("grid:dens=1", "unknown option `dens`; did you mean `density`?; there are"),
            ("grid:mailboxes=on", "did you mean `mailbox`?"),
            ("grid-dsz:treshold=2", "did you mean `threshold`?"),
            ("grid:mailbox=maybe", "on|off"),
            ("grid:resolution=0", "resolution"),
            ("grid:resolution=8x8", "resolution"),
            ("grid:density", "density"),
            ("grid:density=1,density=2", "twice"),
            ("brute:density=1", "unknown option `density`; `brute` has none"),
            ("obvhs-cwbvh:preset=best", "very_slow"),
            ("obvhs-native-cwbvh:preset=best", "very_slow"),
            ("embree:quality=best", "low|medium|high"),
            ("grid:seeds=none", "voxel|fixed"),
            ("grid:step=fast", "branching|branchless|integer"),
            ("grid-dsz:step=branchless", "unknown option `step`"),
            ("grid-dsz:threshold=0", "threshold"),
            ("grid-dual:lane=256", "lane"),
            ("grid-octant:lane=4", "unknown option `lane`"),
            ("grid-clouds:distances=log", "linear|log2|half"),
            ("grid-octant:landing=paper", "unknown option `landing`"),
            ("grid-dsz:landing=paper,distances=log2", "linear distances only"),
            ("bsp:listing=midpoint,planes=sah", "listing=midpoint is for planes=midpoint alone"),
            ("bsp:walk=climb,planes=oblique", "planes=midpoint alone"),
            ("bsp:walk=retraverse,listing=interval", "walk=partition alone"),
            ("bsp:planes=best", "midpoint|sah|oblique"),
            ("bsp:leaf=0", "leaf"),
            ("bsp:depth=61", "depth"),
            ("bsp:density=2", "unknown option `density`"),
            ("nested:quality=good", "fast|default|best"),
            ("nested:memory=-1", "memory"),
            ("nested:isa=avx9", "detected|portable"),
            ("nested:below=sky", "boxes|nodes"),
            ("nested:density=-1", "density"),
            ("", "name"),
        ] {
            let Err(error) = build(spec, &triangles) else { panic!("{spec} was accepted") };
            assert!(error.to_string().contains(part), "{spec}: {error}");
        }
    }

    #[test]
    fn the_printed_landing_counts_what_it_gets_wrong() {
        let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
        for name in ["grid-clouds", "grid-dsz", "grid-dual"] {
            let accel = build(&format!("{name}:landing=paper"), &triangles).expect(name);
            assert!(accel.any_hit(&crate::Ray::new(Vec3::new(0.2, 0.2, 1.0), -Vec3::Z)));
            let line = accel.describe();
            assert!(line.ends_with("LANDING AS PRINTED: 0 of 1 rays wrong so far"), "{line}");
        }
    }

    #[test]
    fn skip_tables_beyond_the_budget_are_refused() {
        let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
        // The voxels alone fit: 64 cubed times 4 bytes.
        assert!(build("grid:resolution=64,memory=2M", &triangles).is_ok());
        let Err(error) = build("grid-dsz:resolution=64,memory=2M", &triangles) else { panic!("accepted") };
        assert!(matches!(error, crate::Error::TooLarge { .. }) && error.to_string().contains("skip table"), "{error}");
    }

    #[test]
    fn a_grid_beyond_its_budget_is_refused_with_both_sizes() {
        let place = |i: u16| Vec3::X * f32::from(i) * 0.001;
        let triangles: Vec<_> = (0..100).map(|i| [Vec3::ZERO, Vec3::ONE, Vec3::Y].map(|p| p + place(i))).collect();
        let Err(error) = build("grid:resolution=4096,memory=1M", &triangles) else { panic!("accepted") };
        assert!(matches!(error, crate::Error::TooLarge { allowed: 1_048_576, .. }), "{error}");
        // The voxels fit, the references do not.
        let Err(error) = build("grid:resolution=64,memory=1100000", &triangles) else { panic!("accepted") };
        assert!(error.to_string().contains("wants"), "{error}");
    }
}
