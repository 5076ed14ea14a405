//! Which primitives a structure needs to know: those that a ray can hit, each once.
//!
//! At equal `t` the least index wins. So a primitive that equals an earlier one in every bit can tie with it at best and
//! never wins: no structure needs it. Left in, 10^5 copies of one triangle would make every ray that meets it test them all,
//! fill a grid's voxels with 10^5 references each, and take obvhs' builder minutes, since it compares boxes that are alike.

use super::copies::Copies;
use crate::geometry::Geometry;
use crate::parallel;
use crate::ray::Aabb;
use std::fmt;

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
    pub fn of<G: Geometry>(geometry: &G) -> Self {
        let mut sieve = Sieve::default();
        let (bounds, left_out) = sieve.sift(geometry);
        Self { prims: sieve.prims, bounds, left_out }
    }
}

/// Looks for candidates, in memory that the next search uses again: 32 bytes or so for each primitive.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sieve {
    /// Indices in the geometry, ascending.
    pub prims: Vec<u32>,
    /// The box of each primitive of the geometry, candidate or not.
    pub boxes: Vec<Aabb>,
    copies: Copies,
}

impl Sieve {
    /// Looks through all primitives of `geometry`; the box around the candidates and what is not among them.
    pub fn sift<G: Geometry>(&mut self, geometry: &G) -> (Aabb, LeftOut) {
        const LEAST: usize = 4096;
        let len = geometry.len() as usize;
        self.boxes.resize(len, Aabb::EMPTY);
        let mut prints = self.copies.take_prints(len);
        let copies = &self.copies;
        let chunks = parallel::chunks(len, LEAST);
        let size = chunks.clone().next().map_or(1, |chunk| chunk.len());
        let work = chunks.zip(self.boxes.chunks_mut(size).zip(prints.chunks_mut(size)));
        let found = parallel::map(work, |(chunk, (boxes, prints))| {
            let (mut bounds, mut unhittable) = (Aabb::EMPTY, 0);
            for ((prim, place), print) in (chunk.start as u32..).zip(boxes).zip(prints) {
                *place = geometry.bounds(prim);
                if place.is_empty() {
                    unhittable += 1;
                    *print = None;
                } else {
                    bounds = bounds.union(place);
                    *print = copies.print(geometry, prim);
                }
            }
            (bounds, unhittable)
        });
        let bounds = found.iter().fold(Aabb::EMPTY, |all, (bounds, _)| all.union(bounds));
        let unhittable: u32 = found.iter().map(|(_, unhittable)| unhittable).sum();
        let copies = self.copies.find(geometry, prints);
        self.prims.clear();
        if unhittable == 0 && copies.is_empty() {
            self.prims.extend(0..len as u32);
        } else {
            let mut copies = copies.iter().copied().peekable();
            let wanted = |&prim: &u32| copies.next_if_eq(&prim).is_none() && !self.boxes[prim as usize].is_empty();
            self.prims.extend((0..len as u32).filter(wanted));
        }
        (bounds, LeftOut { unhittable, copies: (len - self.prims.len()) as u32 - unhittable })
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
