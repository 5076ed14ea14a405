//! What a scene is like, seen from some of its primitives.

use crate::geometry::Geometry;
use crate::ray::Aabb;
use glam::DVec3;

/// So many primitives, at equal distances in the list, are looked at.
const ENOUGH: u32 = 1 << 14;

/// What primitives are, as far as it matters to the cost of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Triangles, spheres or both: there are tests of eight at a time.
    Simple,
    /// Faces of solid voxels.
    Voxels,
    /// Anything else: every test is the primitive's own.
    Other,
}

/// What a scene is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Number of primitives, those included that no ray can hit.
    pub primitives: u32,
    /// What they are.
    pub kind: Kind,
    /// Share of the cells of a coarse grid, two for each primitive looked at, in which none has its middle; 0 to 1.
    pub empty: f64,
    /// Other primitives with the middle in the same cell as one, in the mean over primitives, if there were two cells for each.
    pub crowding: f64,
    /// Cells of that grid that the box of a primitive reaches into, in the mean.
    pub cells_each: f64,
}

impl Look {
    /// Looks at `geometry`: at 16 384 primitives at most, at equal distances in the list. Where nothing can be hit, or all of
    /// it is in one point, `empty` and `crowding` are 0 and `cells_each` is 1.
    pub fn at<G: Geometry + ?Sized>(geometry: &G) -> Self {
        let count = geometry.len();
        let stride = count.div_ceil(ENOUGH).max(1);
        let seen = || (0..count).step_by(stride as usize);
        let boxes: Vec<Aabb> = seen().map(|prim| geometry.bounds(prim)).filter(|aabb| !aabb.is_empty()).collect();
        let simple = seen().all(|prim| geometry.triangle(prim).is_some() || geometry.sphere(prim).is_some());
        let kind = match (geometry.solid().is_some(), simple) {
            (true, _) => Kind::Voxels,
            (_, true) => Kind::Simple,
            _ => Kind::Other,
        };
        let none = Self { primitives: count, kind, empty: 0.0, crowding: 0.0, cells_each: 1.0 };
        let whole = boxes.iter().fold(Aabb::EMPTY, |whole, aabb| whole.union(aabb));
        let extent = (whole.max.as_dvec3() - whole.min.as_dvec3()).max_element();
        if boxes.is_empty() || extent <= 0.0 || !extent.is_finite() {
            return none;
        }
        let grid = Coarse::new(&whole, 2.0 * boxes.len() as f64);
        let mut cells = vec![0_u32; grid.cells.iter().product()];
        let mut reach = 0.0;
        for aabb in &boxes {
            let [low, high] = [aabb.min, aabb.max].map(|p| grid.cell(p.as_dvec3()));
            reach += (0..3).map(|a| (high[a] - low[a] + 1) as f64).product::<f64>();
            let [x, y, z] = grid.cell((aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5);
            cells[(z * grid.cells[1] + y) * grid.cells[0] + x] += 1;
        }
        let others: f64 = cells.iter().map(|&n| f64::from(n) * (f64::from(n) - 1.0)).sum();
        Self {
            empty: cells.iter().filter(|&&n| n == 0).count() as f64 / cells.len() as f64,
            crowding: others / boxes.len() as f64,
            cells_each: reach / boxes.len() as f64,
            ..none
        }
    }
}

/// A grid over a box.
struct Coarse {
    origin: DVec3,
    per_unit: DVec3,
    cells: [usize; 3],
}

impl Coarse {
    /// Cubic cells, `wanted` of them or somewhat more.
    fn new(whole: &Aabb, wanted: f64) -> Self {
        let (origin, size) = (whole.min.as_dvec3(), whole.max.as_dvec3() - whole.min.as_dvec3());
        // Nothing is flat.
        let size = size.max(DVec3::splat(size.max_element() / 128.0));
        let edge = (size.element_product() / wanted).cbrt();
        let cells = size.to_array().map(|x| ((x / edge).round() as usize).clamp(1, 512));
        Self { origin, per_unit: DVec3::from_array(cells.map(|n| n as f64)) / size, cells }
    }

    fn cell(&self, p: DVec3) -> [usize; 3] {
        let place = ((p - self.origin) * self.per_unit).to_array();
        // A conversion keeps to the range of its type, and takes a NaN to 0.
        [0, 1, 2].map(|a| (place[a] as usize).min(self.cells[a] - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;
    use crate::geometry::{Sphere, Triangle};
    use glam::Vec3;

    #[test]
    fn even_clouds_flat_floors_and_nothing_at_all_are_told_apart() {
        let mut random = Random::new(9);
        let cloud: Vec<Sphere> = (0..40_000).map(|_| Sphere { centre: random.in_cube(), radius: 1e-4 }).collect();
        let look = Look::at(&cloud);
        assert_eq!((look.primitives, look.kind), (40_000, Kind::Simple));
        // A Poisson distribution of one for two cells: exp(-1/2) of them empty, 1/2 others in the same.
        assert!((look.empty - (-0.5_f64).exp()).abs() < 0.02, "{look:?}");
        assert!((look.crowding - 0.5).abs() < 0.05, "{look:?}");
        assert!(look.cells_each < 1.1, "{look:?}");
        let nothing: Vec<Triangle> = vec![];
        assert_eq!(Look::at(&nothing).empty, 0.0);
        let point = vec![[Vec3::ONE; 3]; 9];
        assert_eq!(Look::at(&point).crowding, 0.0);
        let huge = vec![[Vec3::splat(-3e38), Vec3::splat(3e38), Vec3::X], [Vec3::X, Vec3::Y, Vec3::Z]];
        assert!(Look::at(&huge).crowding.is_finite());
    }
}
