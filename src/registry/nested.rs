//! The entry `nested`: how much building is worth.

use super::{Entry, Needs, Spec, spec};
use crate::accel::Accel;
use crate::error::Result;
use crate::geometry::Geometry;
use crate::nested::{Below, Instructions, Nested, NestedOptions, Quality};

pub(super) const ENTRY: Entry = Entry {
    name: "nested",
    summary: "the fast one: grids with skip bytes over trees of boxes, eight at a time, or of 4x4x4 cells; packs of eight at the leaves",
    options: "quality=fast|default|best (default), memory=BYTES (as of grid), below=boxes|nodes (boxes), \
              density=F (cells of the grid on top for each primitive, from 0; as they fill the box), \
              isa=detected|portable (detected)",
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
        below: spec.take_choice("below", &Below::NAMES)?.unwrap_or_default(),
        density: spec.take("density", |v| v.parse().ok().filter(|d: &f64| d.is_finite() && *d >= 0.0))?,
    };
    spec.finish()?;
    Ok(Box::new(Nested::build(geometry, &options)?))
}
