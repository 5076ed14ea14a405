//! Which voxels a primitive overlaps.
//!
//! A triangle is rasterised by clipping: it is cut into slabs along one axis, each slab into columns along a second, and the
//! extent of what is left gives the voxels along the third. The work is proportional to the columns that the triangle
//! really meets, not to its bounding box, and the result is exact up to the padding: a voxel is in exactly if the triangle
//! meets the voxel inflated by [`PADDING`]. Other primitives are asked voxel by voxel.

use super::frame::{Frame, PADDING};
use crate::geometry::polygon::Polygon;
use crate::geometry::{Geometry, Triangle};
use glam::DVec3;

/// Calls `visit` with the index of every voxel that `prim` overlaps, each once. Nothing if no ray can hit it.
pub(super) fn voxels_of<G: Geometry>(geometry: &G, prim: u32, frame: &Frame, visit: &mut impl FnMut(usize)) {
    let bounds = geometry.bounds(prim);
    if bounds.is_empty() {
        return;
    }
    let min = voxel(frame, frame.local(bounds.min.as_dvec3()) - PADDING);
    let max = voxel(frame, frame.local(bounds.max.as_dvec3()) + PADDING);
    let long_axes = (0..3).filter(|&a| min[a] < max[a]).count();
    match geometry.triangle(prim) {
        // Within one row of voxels, a connected primitive is in all of them.
        Some(_) if long_axes <= 1 => each(min, max, |v| visit(frame.index(v))),
        Some(triangle) => rasterise(frame, &triangle, (min, max), visit),
        None => each(min, max, |v| {
            if geometry.overlaps(prim, &frame.cell(v)) {
                visit(frame.index(v));
            }
        }),
    }
}

/// The voxel that contains a point in voxel coordinates; the nearest one if it lies outside.
fn voxel(frame: &Frame, p: DVec3) -> [u32; 3] {
    // `as` saturates at 0.
    [0, 1, 2].map(|a| (p[a] as u32).min(frame.resolution[a] - 1))
}

fn each(min: [u32; 3], max: [u32; 3], mut visit: impl FnMut([u32; 3])) {
    for z in min[2]..=max[2] {
        for y in min[1]..=max[1] {
            for x in min[0]..=max[0] {
                visit([x, y, z]);
            }
        }
    }
}

fn rasterise(frame: &Frame, triangle: &Triangle, (min, max): ([u32; 3], [u32; 3]), visit: &mut impl FnMut(usize)) {
    let corners = triangle.map(|p| frame.local(p.as_dvec3()));
    // The axis with most voxels last: its voxels cost nothing but the visit.
    let mut axes = [0, 1, 2];
    axes.sort_by_key(|&a| max[a] - min[a]);
    let [slab, column, run] = axes;
    for (s, part) in Slices::new(Part::new(&corners), slab, min[slab], max[slab]) {
        let Some((from, to)) = reach(&part, column, min[column], max[column]) else { continue };
        for (c, part) in Slices::new(part, column, from, to) {
            let Some((from, to)) = reach(&part, run, min[run], max[run]) else { continue };
            let mut v = [0; 3];
            v[slab] = s;
            v[column] = c;
            for r in from..=to {
                v[run] = r;
                visit(frame.index(v));
            }
        }
    }
}

/// A triangle cut by at most four planes.
type Part = Polygon<7>;

/// The voxels of an axis that a polygon reaches, padded, within `least..=most`; `None` if it has no corner.
fn reach(part: &Part, axis: usize, least: u32, most: u32) -> Option<(u32, u32)> {
    let min = part.corners().iter().map(|p| p[axis]).reduce(f64::min)?;
    let max = part.corners().iter().map(|p| p[axis]).reduce(f64::max)?;
    Some((((min - PADDING) as u32).clamp(least, most), ((max + PADDING) as u32).clamp(least, most)))
}

/// Cuts a polygon into padded slices of one voxel along an axis.
struct Slices {
    rest: Part,
    axis: usize,
    next: u32,
    last: u32,
}

impl Slices {
    fn new(polygon: Part, axis: usize, first: u32, last: u32) -> Self {
        Self { rest: polygon, axis, next: first, last }
    }
}

impl Iterator for Slices {
    type Item = (u32, Part);

    fn next(&mut self) -> Option<(u32, Part)> {
        if self.next > self.last {
            return None;
        }
        let i = self.next;
        self.next += 1;
        if i == self.last {
            return Some((i, self.rest));
        }
        let face = f64::from(i) + 1.0;
        let slice = self.rest.cut(|p| p[self.axis] - (face + PADDING));
        self.rest = self.rest.cut(|p| face - PADDING - p[self.axis]);
        Some((i, slice))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GridOptions;
    use crate::ray::Aabb;
    use glam::Vec3;
    use std::collections::BTreeSet;

    /// Separating axes of a triangle and a box: three of the box, one of the triangle, nine cross products (Akenine-Möller
    /// 2001). True if no axis separates them.
    fn meets(corners: &[DVec3; 3], min: DVec3, max: DVec3) -> bool {
        let (centre, half) = ((min + max) * 0.5, (max - min) * 0.5);
        let corners = corners.map(|p| p - centre);
        let edges = [corners[1] - corners[0], corners[2] - corners[1], corners[0] - corners[2]];
        let mut axes = vec![edges[0].cross(edges[1])];
        for axis in DVec3::AXES {
            axes.push(axis);
            axes.extend(edges.map(|e| e.cross(axis)));
        }
        axes.into_iter().all(|axis| {
            let reach = half.dot(axis.abs());
            let along = corners.map(|p| p.dot(axis));
            let (low, high) =
                (along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(f64::MIN, f64::max));
            low <= reach && high >= -reach
        })
    }

    #[test]
    fn triangles_are_in_exactly_the_voxels_that_they_meet() {
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.6) };
        let frame = Frame::new(&bounds, 1, &GridOptions { resolution: Some([13, 9, 5]), ..GridOptions::default() });
        let mut visited_in_all = 0;
        for i in 0..600 {
            let mut point = || Vec3::new(unit(), unit(), 0.6 * unit());
            let mut triangle = [point(), point(), point()];
            match i % 4 {
                // Small, flat on an axis, a sliver.
                1 => triangle = triangle.map(|p| triangle[0] + (p - triangle[0]) * 0.1),
                2 => triangle = triangle.map(|p| Vec3::new(p.x, 0.5, p.z)),
                3 => triangle[2] = triangle[0] + (triangle[1] - triangle[0]) * 0.5 + Vec3::X * 1e-5,
                _ => {}
            }
            let corners = triangle.map(|p| frame.local(p.as_dvec3()));
            let mut visited = BTreeSet::new();
            voxels_of(&vec![triangle], 0, &frame, &mut |v| assert!(visited.insert(v), "voxel {v} twice"));
            visited_in_all += visited.len();
            each([0; 3], frame.resolution.map(|n| n - 1), |v| {
                let (least, index) = (DVec3::from(v.map(f64::from)), frame.index(v));
                let padded = |padding: f64| meets(&corners, least - padding, least + 1.0 + padding);
                // Between the two lies the rounding of f64.
                if padded(PADDING * 0.999) {
                    assert!(visited.contains(&index), "{triangle:?} misses {v:?}");
                }
                if !padded(PADDING * 1.001) {
                    assert!(!visited.contains(&index), "{triangle:?} does not reach {v:?}");
                }
            });
        }
        assert!(visited_in_all > 5000, "{visited_in_all}");
    }
}
