//! `rtcInterpolate`: values of vertices between the corners of a triangle or a quad.

use crate::device::Fault;
use crate::geometry::Geometry;
use crate::types::{GeometryType, INVALID_ID};
use std::array;

/// Where and what.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Primitive of the geometry.
    pub primitive: u32,
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
    /// Buffer type of the values.
    pub kind: u32,
    /// Buffer slot of the values.
    pub slot: u32,
    /// Number of values.
    pub count: u32,
}

/// Where values go: P, dPdu, dPdv, ddPdudu, ddPdvdv, ddPdudv; the distance from one value to the next; null is not wanted.
#[derive(Clone, Copy, Debug)]
pub struct Results {
    /// The first value of each.
    pub to: [*mut f32; 6],
    /// In f32.
    pub stride: usize,
}

/// Writes the values at a place of a triangle or quad, which is flat or two flat ones: second derivatives are 0.
///
/// # Errors
/// The geometry has no such primitive, vertex or values.
///
/// # Safety
/// There is room for `place.count` values at each pointer that is not null.
pub unsafe fn interpolate(geometry: &Geometry, place: Place, results: Results) -> Result<(), Fault> {
    if !matches!(geometry.kind, GeometryType::Triangle | GeometryType::Quad) {
        return Err(Fault::unsupported("interpolation on user geometries and instances"));
    }
    let state = geometry.state();
    let none = |what: String| Fault::argument(format!("interpolation: there is no {what}"));
    let indices = state.view(crate::types::buffer_type::INDEX, 0);
    let corners = indices.and_then(|view| match geometry.kind {
        GeometryType::Quad => view.words(place.primitive as usize),
        _ => view.words(place.primitive as usize).map(|[a, b, c]| [a, b, c, INVALID_ID]),
    });
    let [a, b, c, d] = corners.ok_or_else(|| none(format!("primitive {}", place.primitive)))?;
    let values = state
        .view(place.kind, place.slot)
        .ok_or_else(|| none(format!("buffer of type {} in slot {}", place.kind, place.slot)))?;
    let quad = geometry.kind == GeometryType::Quad;
    // Quads as scenes cut them; in the second triangle both coordinates run backwards.
    let (corners, u, v, sign) = match quad {
        true if place.u + place.v > 1.0 => ([c, d, b], 1.0 - place.u, 1.0 - place.v, -1.0),
        true => ([a, b, d], place.u, place.v, 1.0),
        false => ([a, b, c], place.u, place.v, 1.0),
    };
    for index in 0..place.count as usize {
        let at = |corner: usize| values.number(corners[corner] as usize, index);
        let [p, q, r] = array::from_fn(at).map(|value: Option<f32>| value.ok_or(index));
        let (p, q, r) = match (p, q, r) {
            (Ok(p), Ok(q), Ok(r)) => (p, q, r),
            _ => return Err(none(format!("value {index} in every corner of primitive {}", place.primitive))),
        };
        let found = [(1.0 - u - v) * p + u * q + v * r, sign * (q - p), sign * (r - p), 0.0, 0.0, 0.0];
        for (to, value) in results.to.into_iter().zip(found) {
            if !to.is_null() {
                // SAFETY: as the caller promises.
                unsafe { to.add(index * results.stride).write(value) };
            }
        }
    }
    Ok(())
}
