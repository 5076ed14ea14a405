//! How the primitives of a part fill its box, which decides how fine the grid on top is.
//!
//! Where they lie on surfaces, most of a fine grid is empty or holds little, and boxes find their way better than cells do: few
//! cells, that only save the upper levels of a tree. Where they fill the box, cells are as good as boxes and cost less, and
//! where they overlap besides, as slivers do, boxes hold next to everything: the more cells the better.
//!
//! Chosen by the time of rays through 26 scenes, out of 0.0002 to 0.6 cells for each primitive: within a factor of three of these numbers the
//! mean changes by a few hundredths.

use super::frame::Frame;
use crate::ray::Aabb;

/// Cells for each primitive.
const SURFACES: f64 = 0.001;
const CLOUDS: f64 = 0.03;
const OVERLAPPING: f64 = 0.07;

/// So many primitives tell how all of them lie.
const ENOUGH: usize = 1 << 15;

/// Cells of the grid on top for each of the primitives `members` of a part. Boxes are by index.
pub(super) fn density(frame: &Frame, boxes: &[Aabb], members: &[u32]) -> f64 {
    let each = members.len().div_ceil(ENOUGH).max(1);
    let seen = members.len().div_ceil(each);
    let cells = resolution(frame.half, CLOUDS * seen as f64).map(|n| n as usize);
    let mut filled = vec![false; cells.iter().product()];
    let mut lengths = 0.0;
    for &prim in members.iter().step_by(each) {
        let Aabb { min, max } = boxes[prim as usize];
        let (min, max) = (min.as_dvec3(), max.as_dvec3());
        let middle = frame.local((min + max) * 0.5);
        let at = [0, 1, 2].map(|a| {
            let half = f64::from(frame.half[a]);
            ((middle[a] + half) / (2.0 * half) * cells[a] as f64) as usize
        });
        let index = [2, 1, 0].iter().fold(0, |index, &a| index * cells[a] + at[a].min(cells[a] - 1));
        filled[index] = true;
        lengths += (max - min).max_element() * frame.scale;
    }
    let share = filled.iter().filter(|&&filled| filled).count() as f64 / filled.len() as f64;
    if share < 0.85 {
        return SURFACES;
    }
    let cell = [0, 1, 2].map(|a| f64::from(2.0 * frame.half[a]) / cells[a] as f64);
    if lengths / seen as f64 > 0.75 * cell.iter().copied().fold(0.0, f64::max) { OVERLAPPING } else { CLOUDS }
}

/// Cubic cells, `wanted` of them; an axis shorter than one gets one.
pub(super) fn resolution(half: [f32; 3], wanted: f64) -> [u32; 3] {
    const MOST: f64 = 512.0;
    let volume: f64 = half.iter().map(|&h| 2.0 * f64::from(h)).product();
    let edge = (volume / wanted.max(1.0)).cbrt();
    half.map(|h| (2.0 * f64::from(h) / edge).round().clamp(1.0, MOST) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;
    use glam::Vec3;

    fn density_of(points: impl Iterator<Item = Vec3>, size: f32) -> f64 {
        let boxes: Vec<Aabb> = points.map(|p| Aabb { min: p, max: p + size }).collect();
        let all = boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one));
        density(&Frame::new(&all), &boxes, &(0..boxes.len() as u32).collect::<Vec<_>>())
    }

    #[test]
    fn surfaces_clouds_and_what_overlaps_are_told_apart() {
        let mut random = Random::new(7);
        let mut cloud = |count: usize| -> Vec<Vec3> { (0..count).map(|_| random.in_cube()).collect() };
        for count in [3000, 100_000] {
            let points = cloud(count);
            assert_eq!(density_of(points.iter().copied(), 1e-4), CLOUDS, "{count} points");
            assert_eq!(density_of(points.iter().copied(), 0.9), OVERLAPPING, "{count} boxes");
            let sheet = points.iter().map(|p| Vec3::new(p.x, p.y, p.x * p.y));
            assert_eq!(density_of(sheet, 1e-4), SURFACES, "{count} points of a surface");
        }
        assert_eq!(density_of([Vec3::ZERO].into_iter(), 0.0), CLOUDS, "one point");
        assert_eq!(density_of(std::iter::empty(), 0.0), SURFACES.min(CLOUDS), "none");
    }
}
