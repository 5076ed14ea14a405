//! Which primitives a structure needs to know: those that a ray can hit, each once.
//!
//! At equal `t` the least index wins. So a primitive that equals an earlier one in every bit can tie with it at best and
//! never wins: no structure needs it. Left in, 10^5 copies of one triangle would make every ray that meets it test them all,
//! fill a grid's voxels with 10^5 references each, and take obvhs' builder minutes, since it compares boxes that are alike.

use crate::geometry::Geometry;
use crate::ray::Aabb;
use std::fmt;
use std::hash::{BuildHasher, RandomState};

/// The primitives that can win, in ascending order, and the box around them.
pub(crate) struct Candidates {
    /// Indices in the geometry.
    pub prims: Vec<u32>,
    /// The least box around all of them.
    pub bounds: Aabb,
    /// What is not among them.
    pub left_out: LeftOut,
}

/// How many primitives a structure does without, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct LeftOut {
    /// No ray can hit them: a coordinate that is not finite, say.
    pub unhittable: u32,
    /// They equal an earlier primitive.
    pub copies: u32,
}

impl Candidates {
    /// Looks through all primitives of `geometry`.
    ///
    /// Takes eight bytes or so for each primitive that has a fingerprint while it looks.
    pub fn of<G: Geometry>(geometry: &G) -> Self {
        let mut found = Self { prims: Vec::new(), bounds: Aabb::EMPTY, left_out: LeftOut::default() };
        let mut seen = Seen::default();
        for prim in 0..geometry.len() {
            let bounds = geometry.bounds(prim);
            if bounds.is_empty() {
                found.left_out.unhittable += 1;
            } else if seen.is_copy(geometry, prim) {
                found.left_out.copies += 1;
            } else {
                found.bounds = found.bounds.union(&bounds);
                found.prims.push(prim);
            }
        }
        found
    }
}

/// Nothing if nothing is left out, else `, ...` to follow a description.
impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if self.unhittable > 0 {
            write!(f, ", {} primitives that no ray can hit left out", self.unhittable)?;
        }
        if self.copies > 0 {
            write!(f, ", {} copies of primitives left out", self.copies)?;
        }
        Ok(())
    }
}

/// The primitives seen so far, by fingerprint: open addressing, at most half full. A slot is an index plus one, or 0.
#[derive(Default)]
struct Seen {
    slots: Vec<u32>,
    count: usize,
    keys: RandomState,
}

impl Seen {
    /// True if an earlier primitive has the same fingerprint; remembers `prim` if not.
    fn is_copy<G: Geometry>(&mut self, geometry: &G, prim: u32) -> bool {
        let Some(print) = geometry.fingerprint(prim) else { return false };
        if 2 * (self.count + 1) > self.slots.len() {
            self.grow(geometry);
        }
        let mut slot = self.home(&print);
        while self.slots[slot] != 0 {
            if geometry.fingerprint(self.slots[slot] - 1) == Some(print) {
                return true;
            }
            slot = (slot + 1) & (self.slots.len() - 1);
        }
        self.slots[slot] = prim + 1;
        self.count += 1;
        false
    }

    /// Where the search for a fingerprint begins. Keyed afresh each time, so that no input can be made to collide.
    fn home(&self, print: &[u32; 9]) -> usize {
        self.keys.hash_one(print) as usize & (self.slots.len() - 1)
    }

    fn grow<G: Geometry>(&mut self, geometry: &G) {
        let size = (2 * self.slots.len()).max(64);
        let old = std::mem::replace(&mut self.slots, vec![0; size]);
        for kept in old.into_iter().filter(|&kept| kept != 0) {
            let Some(print) = geometry.fingerprint(kept - 1) else { continue };
            let mut slot = self.home(&print);
            while self.slots[slot] != 0 {
                slot = (slot + 1) & (size - 1);
            }
            self.slots[slot] = kept;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;
    use crate::geometry::{Mixed, Sphere, Triangle};
    use glam::Vec3;

    #[test]
    fn the_first_of_each_kind_is_kept() {
        let (a, b, c) = (Vec3::X, Vec3::Y, Vec3::new(0.0, 2.0, -1.0));
        let zeros = |t: Triangle| t.map(|p| Vec3::select(p.cmpeq(Vec3::ZERO), Vec3::splat(-0.0), p));
        let triangles = vec![
            [a, b, c],
            [Vec3::NAN; 3],
            [b, c, a],           // the same points in another order
            [c, b, a],           // turned over
            zeros([a, b, c]),    // zeros of the other sign
            [a, b, c + Vec3::Z], // another
            [a, a, b],           // degenerate, and not the same set as the next
            [a, b, b],
        ];
        let ball = Sphere { centre: a, radius: 1.0 };
        let spheres = vec![ball, Sphere { radius: 2.0, ..ball }, ball, Sphere { radius: -1.0, ..ball }];
        let mixed = Mixed { triangles, spheres };
        let found = Candidates::of(&mixed);
        assert_eq!(found.prims, [0, 5, 6, 7, 8, 9]);
        assert_eq!(found.left_out, LeftOut { unhittable: 2, copies: 4 });
        let all = (0..mixed.len()).fold(Aabb::EMPTY, |b, prim| b.union(&mixed.bounds(prim)));
        assert_eq!(found.bounds, all);
        let line = ", 2 primitives that no ray can hit left out, 4 copies of primitives left out";
        assert_eq!(found.left_out.to_string(), line);
        assert_eq!(LeftOut::default().to_string(), "");
    }

    #[test]
    fn many_are_told_apart() {
        let (mut random, n) = (Random::new(4), if cfg!(miri) { 100 } else { 5_000 });
        let mut triangles: Vec<Triangle> = (0..n).map(|_| [(); 3].map(|()| random.in_cube())).collect();
        assert_eq!(Candidates::of(&triangles).prims.len(), n);
        triangles.extend_from_within(n / 5..n / 5 * 4);
        let found = Candidates::of(&triangles);
        assert_eq!((found.prims.len(), found.left_out.copies as usize), (n, n / 5 * 3));
    }
}
