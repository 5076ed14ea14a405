//! The entries `obvhs-bvh2` and `obvhs-cwbvh`: the trees of the crate obvhs over our exact test.

use super::{Entry, Needs, Spec};
use crate::accel::Accel;
use crate::adapters::obvhs::{self, Preset};
use crate::error::Result;
use crate::geometry::Geometry;

/// The options of both, and of the same trees with obvhs' own test.
pub(super) const OPTIONS: &str = "preset=fastest|very_fast|fast|medium|slow|very_slow (medium)";

pub(super) const BVH2: Entry = Entry {
    name: "obvhs-bvh2",
    summary: "two-wide BVH of the crate obvhs",
    options: OPTIONS,
    source: "obvhs 0.4: PLOC (Meister & Bittner 2018), reinsertion",
    needs: Needs::Any,
    exact: true,
};

pub(super) const CWBVH: Entry = Entry {
    name: "obvhs-cwbvh",
    summary: "eight-wide compressed BVH of the crate obvhs",
    options: OPTIONS,
    source: "obvhs 0.4: Ylitie et al. 2017 over PLOC",
    needs: Needs::Any,
    exact: true,
};

/// Takes the preset out of a specification of obvhs, with either test.
pub(super) fn preset(spec: &mut Spec) -> Result<Preset> {
    let preset = spec.take_choice("preset", &Preset::NAMES)?.unwrap_or_default();
    spec.finish()?;
    Ok(preset)
}

/// Builds the tree that `spec` describes.
pub(super) fn build<'a, G: Geometry + 'a>(mut spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let preset = preset(&mut spec)?;
    Ok(match spec.name() {
        "obvhs-bvh2" => Box::new(obvhs::bvh2(geometry, preset)),
        _ => Box::new(obvhs::cwbvh(geometry, preset)),
    })
}
