//! How the primitives of a part fill its box, which decides how fine the grid on top is.
//!
//! Where they lie on surfaces, most of a fine grid is empty or holds little, and boxes find their way better than cells do: few
//! cells, that only save the upper levels of a tree. Where they fill the box, cells are as good as boxes and cost less, and
//! where they overlap besides, as slivers do, boxes hold next to everything: the more cells the better.
//!
//! Chosen by the time of rays through 26 scenes, out of 0.0002 to 0.6 cells for each primitive: within a factor of three of
//! these numbers the mean changes by a few hundredths.

use super::split::ENOUGH;
use crate::ray::Aabb;
use glam::DVec3;

/// Cells for each primitive.
const SURFACES: f64 = 0.001;
const CLOUDS: f64 = 0.03;
const OVERLAPPING: f64 = 0.07;

/// Cells of the grid on top for each of the primitives `members` of a part. Boxes are by index.
///
/// What counts is how their middles fill the box around these: where primitives are large, none has its middle near the
/// part's faces.
pub(super) fn density(boxes: &[Aabb], members: &[u32]) -> f64 {
    let each = members.len().div_ceil(ENOUGH).max(1);
    let seen = || members.iter().step_by(each).map(|&prim| &boxes[prim as usize]);
    let middle = |aabb: &Aabb| (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
    let (mut low, mut high, mut lengths, mut count) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0.0, 0.0);
    for aabb in seen() {
        (low, high) = (low.min(middle(aabb)), high.max(middle(aabb)));
        lengths += (aabb.max.as_dvec3() - aabb.min.as_dvec3()).max_element();
        count += 1.0;
    }
    let longest = (high - low).max_element();
    if count < 2.0 || longest <= 0.0 {
        return SURFACES;
    }
    // In units of the longest edge, none of them flat.
    let size = ((high - low) / longest).max(DVec3::splat(1.0 / 128.0));
    let cells = resolution((0.5 * size).as_vec3().to_array(), CLOUDS * count).map(|n| n as usize);
    let per_unit = DVec3::from_array(cells.map(|n| n as f64)) / size;
    let mut filled = vec![false; cells.iter().product()];
    for aabb in seen() {
        let at = ((middle(aabb) - low) / longest * per_unit).to_array().map(|x| x as usize);
        filled[[2, 1, 0].iter().fold(0, |index, &a| index * cells[a] + at[a].min(cells[a] - 1))] = true;
    }
    let share = filled.iter().filter(|&&filled| filled).count() as f64 / filled.len() as f64;
    if share < 0.85 {
        SURFACES
    } else if lengths / count > 0.75 * longest / per_unit.min_element() {
        OVERLAPPING
    } else {
        CLOUDS
    }
}

/// Cubic cells, `wanted` of them; an axis shorter than one gets one, and the others share them.
pub(super) fn resolution(half: [f32; 3], wanted: f64) -> [u32; 3] {
    const MOST: f64 = 512.0;
    let sides = half.map(|h| 2.0 * f64::from(h));
    let mut longer = [true; 3];
    let edge = loop {
        let cut = || (0..3).filter(|&a| longer[a]);
        let edge = (cut().map(|a| sides[a]).product::<f64>() / wanted.max(1.0)).powf(1.0 / cut().count() as f64);
        let Some(flat) = cut().find(|&a| sides[a] < edge && cut().count() > 1) else { break edge };
        longer[flat] = false;
    };
    [0, 1, 2].map(|a| if longer[a] { (sides[a] / edge).round().clamp(1.0, MOST) as u32 } else { 1 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;
    use glam::Vec3;

    fn density_of(points: impl Iterator<Item = Vec3>, size: f32) -> f64 {
        let boxes: Vec<Aabb> = points.map(|p| Aabb { min: p, max: p + size }).collect();
        density(&boxes, &(0..boxes.len() as u32).collect::<Vec<_>>())
    }

    #[test]
    fn flat_boxes_have_no_more_cells_than_cubes() {
        for (half, wanted, expected) in [
            ([1.0, 1.0, 1.0], 27.0, [3, 3, 3]),
            ([1.0, 1.0, 1.0 / 128.0], 1.0, [1, 1, 1]),
            ([1.0, 1.0, 1.0 / 128.0], 100.0, [10, 10, 1]),
            ([1.0, 1.0 / 128.0, 1.0 / 128.0], 50.0, [50, 1, 1]),
            ([1.0, 0.5, 0.25], 1e12, [512, 512, 512]),
        ] {
            assert_eq!(resolution(half, wanted), expected, "{half:?}, {wanted}");
        }
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
        for count in 0..3 {
            assert_eq!(density_of(std::iter::repeat_n(Vec3::ZERO, count), 1.0), SURFACES, "{count} copies");
        }
    }
}
