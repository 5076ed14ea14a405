//! Entries of accelerators with a triangle test of their own, here to be compared with.

#[cfg(feature = "obvhs")]
use super::obvhs::{OPTIONS, preset};
use super::{Entry, Needs, Spec};
use crate::accel::Accel;
#[cfg(feature = "bvh")]
use crate::adapters::bvh;
#[cfg(feature = "embree")]
use crate::adapters::embree::{self, Quality};
#[cfg(feature = "obvhs")]
use crate::adapters::obvhs_native;
#[cfg(feature = "parry")]
use crate::adapters::parry;
use crate::adapters::soup::{Given, Soup};
use crate::error::{Error, Result};
use crate::geometry::Geometry;

/// What all of these have in common.
#[allow(dead_code, reason = "none may be compiled in")]
const fn peer(name: &'static str, summary: &'static str, options: &'static str, source: &'static str) -> Entry {
    Entry { name, summary, options, source, needs: Needs::Triangles, exact: false }
}

/// Those that take spheres as well.
#[allow(dead_code, reason = "none may be compiled in")]
const fn round(entry: Entry) -> Entry {
    Entry { needs: Needs::OneKind, ..entry }
}

#[cfg(feature = "obvhs")]
pub(super) const OBVHS_BVH2: Entry = round(peer(
    "obvhs-native-bvh2",
    "peer, not exact: two-wide BVH of the crate obvhs with its own triangle test, or a plain one of spheres",
    OPTIONS,
    "obvhs 0.4 as its authors intend",
));

#[cfg(feature = "obvhs")]
pub(super) const OBVHS_CWBVH: Entry = round(peer(
    "obvhs-native-cwbvh",
    "peer, not exact: eight-wide compressed BVH of the crate obvhs with its own triangle test, or a plain one of spheres",
    OPTIONS,
    "obvhs 0.4 as its authors intend",
));

#[cfg(feature = "embree")]
const QUALITIES: &str = "quality=low|medium|high (medium)";

#[cfg(feature = "embree")]
pub(super) const EMBREE: Entry = round(peer(
    "embree",
    "peer, not exact: Intel's Embree 3 or 4 as it is by default, opened at run time",
    QUALITIES,
    "Wald et al. 2014, \"Embree: a kernel framework for efficient CPU ray tracing\"",
));

#[cfg(feature = "embree")]
pub(super) const EMBREE_ROBUST: Entry = round(peer(
    "embree-robust",
    "peer, not exact: Embree with its robust flag, which avoids holes",
    QUALITIES,
    EMBREE.source,
));

#[cfg(feature = "bvh")]
pub(super) const BVH: Entry =
    peer("bvh", "peer, not exact: two-wide BVH of the crate bvh with its own triangle test", "", "bvh 0.13");

#[cfg(feature = "parry")]
pub(super) const PARRY: Entry =
    peer("parry", "peer, not exact: triangle mesh of the crate parry3d with its own triangle test", "", "parry3d 0.31");

/// Why the accelerator `name` cannot be built on this machine, if so.
pub(super) fn missing(name: &str) -> Option<String> {
    match name {
        #[cfg(feature = "embree")]
        "embree" | "embree-robust" => embree::missing(),
        _ => None,
    }
}

/// True if the accelerator `name` takes spheres alone as well as triangles alone.
fn takes_spheres(name: &str) -> bool {
    super::ENTRIES.iter().any(|entry| entry.name == name && entry.needs == Needs::OneKind)
}

/// True if [`build`] knows the accelerator `name`: the entries of this file are those that are not exact.
pub(super) fn has(name: &str) -> bool {
    super::ENTRIES.iter().any(|entry| entry.name == name && !entry.exact)
}

/// What peers of triangles alone are given.
#[cfg(any(feature = "bvh", feature = "parry"))]
fn triangles(given: Given) -> Soup {
    match given {
        Given::Triangles(soup) => soup,
        Given::Spheres(_) => unreachable!("spheres are given to others only"),
    }
}

/// Builds the peer that `spec` describes over what it can take of `geometry`.
pub(super) fn build<G: Geometry>(spec: Spec, geometry: &G) -> Result<Box<dyn Accel>> {
    let given = if takes_spheres(spec.name()) { Given::of(geometry) } else { Soup::of(geometry).map(Given::Triangles) };
    let given = given.map_err(|error| match error {
        Error::Invalid { cause } => spec.error(cause),
        other => other,
    })?;
    build_over(spec, given)
}

/// Spheres are given only to those that [`takes_spheres`] names. Not generic: peers copy the primitives.
#[allow(unused_mut, unused_variables, reason = "not all peers have options, and none may be compiled in")]
fn build_over(mut spec: Spec, given: Given) -> Result<Box<dyn Accel>> {
    match spec.name() {
        #[cfg(feature = "obvhs")]
        name @ ("obvhs-native-bvh2" | "obvhs-native-cwbvh") => {
            let make = if name == "obvhs-native-bvh2" { obvhs_native::bvh2 } else { obvhs_native::cwbvh };
            make(given, preset(&mut spec)?)
        }
        #[cfg(feature = "embree")]
        name @ ("embree" | "embree-robust") => {
            let robust = name == "embree-robust";
            let quality = spec.take_choice("quality", &Quality::NAMES)?.unwrap_or_default();
            spec.finish()?;
            if let Some(cause) = embree::missing() {
                return Err(spec.error(cause));
            }
            embree::embree(given, embree::Options { quality, robust })
        }
        #[cfg(feature = "bvh")]
        "bvh" => {
            spec.finish()?;
            bvh::bvh(triangles(given))
        }
        #[cfg(feature = "parry")]
        "parry" => {
            spec.finish()?;
            parry::parry(triangles(given))
        }
        _ => unreachable!("asked for peers that it has"),
    }
}
