//! Which of 4 x 4 x 4 cells a primitive meets, as a mask of 64 bits.
//!
//! Triangles by separating axes (Akenine-Möller, "Fast 3D triangle-box overlap testing", 2001), for all cells at once: the nine
//! cross products of edges and axes separate in a projection along an axis, where 16 cells are two registers of lanes, and the
//! triangle's normal separates in space, where they are eight. Any axis whatever may separate, so that the rounding of its
//! components does not matter, and neither does a degenerate triangle: what matters is that corners and cells are compared
//! along the same one.
//!
//! Error, with `e = 2^-24` and coordinates up to 1: corners in the window's units are off by `6 e` of the part (difference,
//! product), their products with an axis by `6 e` more times its size, and those of the cells' centres less: together below `20
//! e`, against [`PADDING`]'s 64.

use super::frame::PADDING;
use super::lanes::{Lanes, Row};

/// 4 x 4 x 4 cells in a part's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Least corner.
    pub low: [f32; 3],
    /// Edges of a cell.
    pub cell: [f32; 3],
    /// Cells for each unit.
    per_unit: [f32; 3],
    /// The padding in cells.
    padding: [f32; 3],
}

/// The cells along an axis that an interval meets, before they are cut down to the window; and that as bits.
struct Reach {
    one: bool,
    bits: u64,
}

impl Window {
    /// The window with this least corner and cells with these edges.
    #[inline]
    pub fn new(low: [f32; 3], cell: [f32; 3]) -> Self {
        Self { low, cell, per_unit: cell.map(|x| 1.0 / x), padding: cell.map(|x| PADDING / x) }
    }

    /// In the window's units, in which cells are 1 long.
    #[inline(always)]
    fn units(&self, axis: usize, x: f32) -> f32 {
        (x - self.low[axis]) * self.per_unit[axis]
    }

    #[inline(always)]
    fn reach(&self, axis: usize, low: f32, high: f32) -> Reach {
        let padding = self.padding[axis];
        // `as` saturates.
        let (low, high) = ((low - padding).floor() as i32, (high + padding).floor() as i32);
        let bits = if high < 0 || low > 3 { 0 } else { (2 << high.min(3)) - (1 << low.max(0)) };
        Reach { one: low == high, bits }
    }

    #[inline(always)]
    fn reach_of(&self, q: &[[f32; 3]; 3], axis: usize) -> Reach {
        let (low, high) = ends(q[0][axis], q[1][axis], q[2][axis]);
        self.reach(axis, low, high)
    }

    /// The cells that are in reach along all axes.
    #[inline(always)]
    fn block(reach: &[Reach; 3]) -> u64 {
        let [x, y, z] = [reach[0].bits, reach[1].bits, reach[2].bits];
        let y = (y | y << 3 | y << 6 | y << 9) & 0x1111;
        let z = (z | z << 15 | z << 30 | z << 45) & 0x0001_0001_0001_0001;
        (x * 0x1111_1111_1111_1111) & (y * 15 * 0x0001_0001_0001_0001) & (z * 0xffff)
    }

    /// The cells that meet a box, padded.
    pub fn aabb(&self, min: &[f32; 3], max: &[f32; 3]) -> u64 {
        let reach = |axis: usize| self.reach(axis, self.units(axis, min[axis]), self.units(axis, max[axis]));
        Self::block(&[reach(0), reach(1), reach(2)])
    }

    /// The cells that meet the triangle, padded.
    #[inline(always)]
    pub fn triangle<S: Lanes>(&self, corners: &[[f32; 3]; 3]) -> u64 {
        let mut q = [[0.0; 3]; 3];
        for (q, p) in q.iter_mut().zip(corners) {
            for axis in 0..3 {
                q[axis] = self.units(axis, p[axis]);
            }
        }
        let reach = [self.reach_of(&q, 0), self.reach_of(&q, 1), self.reach_of(&q, 2)];
        let mask = Self::block(&reach);
        let long = u32::from(!reach[0].one) + u32::from(!reach[1].one) + u32::from(!reach[2].one);
        // Within one row of cells, what is connected is in all of them.
        if mask == 0 || long <= 1 {
            return mask;
        }
        let mut outside = 0;
        for along in 0..3 {
            let (a, b) = ([1, 0, 0][along], [2, 2, 1][along]);
            // Seen along an axis of one layer, what meets a column meets its cell; seen along another, all is one row.
            if !reach[a].one && !reach[b].one {
                outside |= spread(self.outside_projection::<S>(&q, a, b), along);
            }
        }
        if long == 3 {
            outside |= self.outside_plane::<S>(&q);
        }
        mask & !outside
    }

    /// The 16 columns, `a` varying fastest, that an edge of the triangle separates from it.
    #[inline(always)]
    fn outside_projection<S: Lanes>(&self, q: &[[f32; 3]; 3], a: usize, b: usize) -> u64 {
        let (pad_a, pad_b) = (self.padding[a], self.padding[b]);
        let mut outside = 0;
        for i in 0..3 {
            let (p, r) = (q[i], q[(i + 1) % 3]);
            let (na, nb) = (r[b] - p[b], p[a] - r[a]);
            let (low, high) =
                ends(na * q[0][a] + nb * q[0][b], na * q[1][a] + nb * q[1][b], na * q[2][a] + nb * q[2][b]);
            let middle = S::splat(0.5 * (low + high));
            let reach = na.abs() * (0.5 + pad_a) + nb.abs() * (0.5 + pad_b) + 0.5 * (high - low);
            let (na, nb, reach) = (S::splat(na), S::splat(nb), S::splat(reach));
            let row = na * S::of(&MIDDLES) - middle;
            for (h, from) in [0.5, 2.5].into_iter().enumerate() {
                let distance = (row + nb * S::halves(from, from + 1.0)).abs();
                outside |= u64::from(S::bits(reach.less(distance))) << (8 * h);
            }
        }
        outside
    }

    /// The cells that the triangle's plane does not meet.
    #[inline(always)]
    fn outside_plane<S: Lanes>(&self, q: &[[f32; 3]; 3]) -> u64 {
        let (e, f) = (minus(&q[1], &q[0]), minus(&q[2], &q[0]));
        let n = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let (low, high) = ends(dot(&n, &q[0]), dot(&n, &q[1]), dot(&n, &q[2]));
        let mut size = 0.0;
        for axis in 0..3 {
            size += n[axis].abs() * (0.5 + self.padding[axis]);
        }
        let reach = S::splat(size + 0.5 * (high - low));
        let row = S::splat(n[0]) * S::of(&MIDDLES) - S::splat(0.5 * (low + high));
        let across = S::splat(n[1]);
        let layer = [row + across * S::halves(0.5, 1.5), row + across * S::halves(2.5, 3.5)];
        let mut outside = 0;
        for k in 0..4 {
            let height = S::splat(n[2] * (k as f32 + 0.5));
            let lower = S::bits(reach.less((layer[0] + height).abs()));
            let upper = S::bits(reach.less((layer[1] + height).abs()));
            outside |= u64::from(lower | upper << 8) << (16 * k);
        }
        outside
    }

    /// The cells that meet the surface of a ball, padded.
    #[inline(always)]
    pub fn sphere<S: Lanes>(&self, centre: &[f32; 3], radius: f32) -> u64 {
        let reach = [0, 1, 2].map(|axis| {
            self.reach(axis, self.units(axis, centre[axis] - radius), self.units(axis, centre[axis] + radius))
        });
        let mask = Self::block(&reach);
        if mask & mask.wrapping_sub(1) == 0 {
            return mask;
        }
        // Squared distances along each axis of the nearest and of the farthest point of a slice.
        let slices = [0, 1, 2].map(|axis| {
            let mut slices = [[0.0; 4]; 2];
            for i in 0..4 {
                let low = self.low[axis] + i as f32 * self.cell[axis] - centre[axis];
                let high = low + self.cell[axis];
                let near = low.max(-high).max(0.0);
                let far = high.max(-low);
                (slices[0][i], slices[1][i]) = (near * near, far * far);
            }
            slices
        });
        // The padding of the slices, 1.8 times as much along a diagonal, is put on the radius.
        let (most, least) = (radius + 2.0 * PADDING, (radius - 2.0 * PADDING).max(0.0));
        let (most, least) = (S::splat(most * most), S::splat(least * least));
        let mut outside = 0;
        for k in 0..4 {
            for h in 0..2 {
                let near = squares::<S>(&slices, 0, h, k);
                let far = squares::<S>(&slices, 1, h, k);
                let apart = most.less(near) | far.less(least);
                outside |= u64::from(S::bits(apart)) << (16 * k + 8 * h);
            }
        }
        mask & !outside
    }
}

/// The least and the greatest of three numbers.
#[inline(always)]
fn ends(a: f32, b: f32, c: f32) -> (f32, f32) {
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    (if c < low { c } else { low }, if c > high { c } else { high })
}

#[inline(always)]
fn minus(a: &[f32; 3], b: &[f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot(a: &[f32; 3], b: &[f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sums of squares along three axes for a register of cells of layer `k`: `y` is `2 h` or `2 h + 1`.
#[inline(always)]
fn squares<S: Lanes>(slices: &[[[f32; 4]; 2]; 3], end: usize, h: usize, k: usize) -> S {
    let [x, y, z] = [&slices[0][end], &slices[1][end], &slices[2][end]];
    let row = S::of(&Row([x[0], x[1], x[2], x[3], x[0], x[1], x[2], x[3]]));
    row + (S::halves(y[2 * h], y[2 * h + 1]) + S::splat(z[k]))
}

/// Middles of cells along an axis, twice.
const MIDDLES: Row = Row([0.5, 1.5, 2.5, 3.5, 0.5, 1.5, 2.5, 3.5]);

/// The cells of columns along an axis; columns are 16 bits, the first of the other axes varying fastest.
#[inline(always)]
fn spread(columns: u64, along: usize) -> u64 {
    match along {
        0 => {
            // Each bit four times.
            let x = (columns | columns << 24) & 0x0000_00ff_0000_00ff;
            let x = (x | x << 12) & 0x000f_000f_000f_000f;
            let x = (x | x << 6) & 0x0303_0303_0303_0303;
            let x = (x | x << 3) & 0x1111_1111_1111_1111;
            x * 15
        }
        1 => {
            // Each group of four bits four times.
            let x = (columns | columns << 24) & 0x0000_00ff_0000_00ff;
            let x = (x | x << 12) & 0x000f_000f_000f_000f;
            x * 0x1111
        }
        _ => columns * 0x0001_0001_0001_0001,
    }
}
