//! The entry `nested`: how much building is worth.

use super::{Entry, Needs, Spec, spec};
use crate::accel::Accel;
use crate::error::Result;
use crate::geometry::Geometry;
use crate::nested::{Instructions, Nested, NestedOptions, Quality};

pub(super) const ENTRY: Entry = Entry {
    name: "nested",
    summary: "the fast one: grids with skip bytes over trees of 4x4x4 cells, boxes and packs of eight at the leaves",
    options: "quality=fast|default|best (default), memory=BYTES (as of grid), isa=detected|portable (detected)",
    source: "octant distances as of grid-octant; packs after Möller & Trumbore 1997",
    needs: Needs::Any,
    exact: true,
};

/// Builds the nested grid that `spec` describes.
pub(super) fn build<'a, G: Geometry + 'a>(mut spec: Spec, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    let usual = NestedOptions::default();
    let options = NestedOptions {
        quality: spec.take_choice("quality", &Quality::NAMES)?.unwrap_or_default(),
        memory: spec.take("memory", spec::parse_bytes)?.unwrap_or(usual.memory),
        instructions: spec.take_choice("isa", &Instructions::NAMES)?.unwrap_or_default(),
    };
    spec.finish()?;
    Ok(Box::new(Nested::build(geometry, &options)?))
}
