//! The voxels between a voxel and a light.
//!
//! The convex hull of two boxes is the union of the boxes between them: corner by corner `(1 - s) a + s b` for s from 0 to 1.
//! Layer by layer of voxels, along the axis on which the light is farthest, the boxes that meet the layer are those of an
//! interval of s; what they cover of the layer lies in a rectangle with the extremes at the interval's ends.

use crate::grid::frame::{Frame, PADDING};
use crate::ray::Cell;
use glam::DVec3;

/// A light nearer than this to the voxel, in voxels, is not judged.
const NEAREST: f64 = 2.0;

/// Nor is one whose box is wider than this, in voxels.
const WIDEST: f64 = 0.25;

/// More than the rounding of what is computed here, in voxels and as a parameter.
const ROUNDING: f64 = 1e-7;

/// Whether `fine` says so of every voxel of the grid that meets the hull of `voxel`, padded, and `light`, a box in voxel
/// coordinates. False if the light is too near to be judged.
pub(super) fn all_voxels(frame: &Frame, voxel: [u32; 3], light: &Cell, fine: &mut impl FnMut(usize) -> bool) -> bool {
    let corner = DVec3::from(voxel.map(f64::from));
    let from = Cell { min: corner - PADDING, max: corner + 1.0 + PADDING };
    let way = 0.5 * (light.min + light.max - from.min - from.max);
    let axis = way.abs().max_position();
    let wide = (light.max - light.min).max_element() > WIDEST;
    // Also where a coordinate is not finite.
    if wide || !(way[axis].abs() >= NEAREST && way.is_finite()) {
        return false;
    }
    let last = i64::from(frame.resolution[axis]) - 1;
    // A layer of padding lies behind the voxel.
    let own = i64::from(voxel[axis]);
    let (begin, end, sense) = if way[axis] > 0.0 { (own - 1, last, 1) } else { (own + 1, 0, -1) };
    let mut layer = begin;
    while (end - layer) * sense >= 0 {
        let (low, high) = (layer as f64 - ROUNDING, (layer + 1) as f64 + ROUNDING);
        let (rise, fall) = (light.max[axis] - from.max[axis], light.min[axis] - from.min[axis]);
        // Where the greater side of the box is at the layer's lower face, and the lesser at its upper: neither slope is 0.
        let (at_low, at_high) = ((low - from.max[axis]) / rise, (high - from.min[axis]) / fall);
        let (enter, leave) = if sense > 0 { (at_low, at_high) } else { (at_high, at_low) };
        if enter > 1.0 {
            break;
        }
        if (0..=last).contains(&layer) && leave >= 0.0 {
            let ends = [(enter - ROUNDING).clamp(0.0, 1.0), (leave + ROUNDING).clamp(0.0, 1.0)];
            if !rectangle(frame, axis, layer as u32, &from, light, ends, fine) {
                return false;
            }
        }
        layer += sense;
    }
    true
}

/// Whether `fine` says so of every voxel of the layer that the boxes between the two ends may meet.
fn rectangle(
    frame: &Frame,
    axis: usize,
    layer: u32,
    from: &Cell,
    light: &Cell,
    ends: [f64; 2],
    fine: &mut impl FnMut(usize) -> bool,
) -> bool {
    let [a, b] = ends.map(|s| from.min + (light.min - from.min) * s);
    let [c, d] = ends.map(|s| from.max + (light.max - from.max) * s);
    let (min, max) = (a.min(b) - ROUNDING, c.max(d) + ROUNDING);
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let range = |axis: usize| {
        let n = f64::from(frame.resolution[axis]);
        let beside = max[axis] < 0.0 || min[axis] > n;
        // `as` saturates at 0; an empty range for what lies beside the grid.
        let to = if beside { 0 } else { (max[axis].min(n - 0.5) as u32) + 1 };
        min[axis] as u32..to
    };
    let mut place = [0; 3];
    place[axis] = layer;
    for i in range(u) {
        place[u] = i;
        for j in range(v) {
            place[v] = j;
            if !fine(frame.index(place)) {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;

    /// Points of segments between the boxes lie in voxels that are named.
    #[test]
    fn every_voxel_on_the_way_is_named() {
        let frame = Frame { lo: DVec3::ZERO, inverse: DVec3::ONE, resolution: [9, 14, 6] };
        let mut random = Random::new(41);
        let mut judged = 0;
        for _ in 0..400 {
            let voxel = frame.resolution.map(|n| (random.unit() * n as f32) as u32);
            let centre = random.in_cube().as_dvec3() * 30.0;
            let light = Cell { min: centre - 0.05, max: centre + 0.05 };
            let mut named = vec![false; 9 * 14 * 6];
            let decided = all_voxels(&frame, voxel, &light, &mut |v| {
                named[v] = true;
                true
            });
            if !decided {
                continue;
            }
            judged += 1;
            for _ in 0..200 {
                let mut unit = || (0.5 * random.in_cube() + 0.5).as_dvec3();
                let start = DVec3::from(voxel.map(f64::from)) - PADDING + unit() * (1.0 + 2.0 * PADDING);
                let end = light.min + unit() * (light.max - light.min);
                for step in 0..=400 {
                    let p = start + (end - start) * f64::from(step) / 400.0;
                    if p.cmpge(DVec3::ZERO).all() && p.cmplt(frame.size()).all() {
                        let v = frame.index([p.x as u32, p.y as u32, p.z as u32]);
                        assert!(named[v], "{voxel:?} {centre} {p}");
                    }
                }
            }
        }
        assert!(judged > 300, "{judged}");
    }
}
