//! Convex polygons that are cut by planes: how builders find which cells a triangle reaches.

use glam::DVec3;

/// A convex polygon of at most `MOST` corners: a triangle cut by `MOST - 3` planes at most.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polygon<const MOST: usize> {
    corners: [DVec3; MOST],
    len: usize,
}

impl<const MOST: usize> Polygon<MOST> {
    const EMPTY: Self = Self { corners: [DVec3::ZERO; MOST], len: 0 };

    /// With these corners, `MOST` at most.
    pub(crate) fn new(corners: &[DVec3]) -> Self {
        let mut polygon = Self::EMPTY;
        corners.iter().for_each(|&p| polygon.push(p));
        polygon
    }

    fn push(&mut self, p: DVec3) {
        // Rounding can make a sliver's outline cross a plane more often than a convex one may; the surplus corners lie
        // within rounding of those kept.
        if self.len < MOST {
            self.corners[self.len] = p;
            self.len += 1;
        }
    }

    /// Its corners, in order around it; none if nothing is left.
    #[inline]
    pub(crate) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.len]
    }

    /// The part that is not outside, where `outside`, an affine function, is at most 0 (Sutherland & Hodgman 1974).
    #[inline]
    pub(crate) fn cut(&self, outside: impl Fn(DVec3) -> f64) -> Self {
        if self.corners().iter().all(|&p| outside(p) <= 0.0) {
            return *self;
        }
        let mut kept = Self::EMPTY;
        for i in 0..self.len {
            let (p, q) = (self.corners[i], self.corners[(i + 1) % self.len]);
            let (a, b) = (outside(p), outside(q));
            if a <= 0.0 {
                kept.push(p);
            }
            if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                kept.push(p + (q - p) * (a / (a - b)));
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_planes_leave_the_part_on_their_side() {
        let [a, b, c] = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(0.0, 4.0, 2.0)];
        let triangle = Polygon::<5>::new(&[a, b, c]);
        let left = triangle.cut(|p| p.x - 1.0);
        assert_eq!(left.corners(), [a, DVec3::new(1.0, 0.0, 0.0), DVec3::new(1.0, 3.0, 1.5), c]);
        assert!(left.cut(|p| 1.5 - p.x).corners().is_empty());
        // What only touches is kept.
        assert_eq!(triangle.cut(|p| 4.0 - p.x).corners(), [b]);
        assert_eq!(triangle.cut(|p| p.x - 4.0).corners(), [a, b, c]);
    }
}
