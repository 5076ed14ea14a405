//! What a ray has decided in exact arithmetic is not decided again.
//!
//! A grid lists a primitive in many voxels. Tests that f32 or f64 answer are cheap to repeat; the exact stage is not, and it is
//! needed again for every primitive around a point that the ray meets exactly, in every voxel. This is the mailbox of
//! Amanatides & Woo (1987, "Avoiding Multiple Intersections") for those primitives alone: a ray that leaves nothing undecided,
//! which is nearly every ray, pays one comparison with null.

use super::Triangle;
use super::meeting::Point;
use std::cell::RefCell;
use std::collections::HashSet;

/// The memory of one ray and one winner; empty, and without allocation, until something is undecided.
#[derive(Debug, Default)]
pub(super) struct Decided(RefCell<Option<Box<Memory>>>);

#[derive(Debug, Default)]
struct Memory {
    /// The first primitives decided; looking through these is cheaper than hashing.
    few: Vec<u32>,
    many: HashSet<u32>,
    /// A winner, and the point in which the ray meets it exactly, if f32 holds that point.
    meeting: Option<(u32, Option<Point>)>,
}

const FEW: usize = 32;

impl Decided {
    /// True if `prim`, whose corners are given, can no longer become the winner in the place of `winner`.
    ///
    /// Either it was decided before: it lost then, and winners only get better. Or the ray passes exactly through one of its
    /// corners, which is where it meets `winner`: the line meets the triangle there or, being parallel, not at all, so that
    /// it ties at best, and `winner` has the lesser index.
    #[inline]
    pub fn is_beaten(&self, prim: u32, corners: &Triangle, winner: Option<u32>) -> bool {
        match &*self.0.borrow() {
            None => false,
            Some(memory) => memory.is_beaten(prim, corners, winner),
        }
    }

    /// True if `prim` was decided before. Unless it is the winner it can no longer become it: it lost then, and winners only get
    /// better.
    #[inline]
    pub fn is_known(&self, prim: u32) -> bool {
        self.0.borrow().as_ref().is_some_and(|memory| memory.is_known(prim))
    }

    /// Remembers that `prim` has been decided.
    pub fn note(&self, prim: u32) {
        let mut memory = self.0.borrow_mut();
        let memory = memory.get_or_insert_default();
        if memory.few.len() < FEW {
            memory.few.push(prim);
        } else {
            memory.many.insert(prim);
        }
    }

    /// Remembers where the ray meets `winner`.
    pub fn note_point(&self, winner: u32, point: Point) {
        self.0.borrow_mut().get_or_insert_default().meeting = Some((winner, Some(point)));
    }

    /// Where the ray meets `winner`, by `find` unless that is known.
    pub fn point(&self, winner: u32, find: impl FnOnce() -> Option<Point>) -> Option<Point> {
        let mut memory = self.0.borrow_mut();
        let memory = memory.get_or_insert_default();
        match memory.meeting {
            Some((holder, point)) if holder == winner => point,
            _ => {
                let point = find();
                memory.meeting = Some((winner, point));
                point
            }
        }
    }
}

impl Memory {
    fn is_beaten(&self, prim: u32, corners: &Triangle, winner: Option<u32>) -> bool {
        let shares = match &self.meeting {
            Some((holder, Some(point))) => Some(*holder) == winner && prim > *holder && corners.contains(&point.at),
            _ => false,
        };
        shares || self.is_known(prim)
    }

    fn is_known(&self, prim: u32) -> bool {
        self.few.contains(&prim) || (!self.many.is_empty() && self.many.contains(&prim))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Ray;
    use glam::Vec3;

    #[test]
    fn any_number_is_remembered() {
        let decided = Decided::default();
        let corners = [Vec3::ZERO; 3];
        assert!(!decided.is_beaten(0, &corners, None));
        (0..100).for_each(|prim| decided.note(2 * prim));
        assert!((0..100).all(|prim| decided.is_beaten(2 * prim, &corners, None)));
        assert!((0..100).all(|prim| !decided.is_beaten(2 * prim + 1, &corners, None)));
        assert!((0..200).all(|prim| decided.is_known(prim) == (prim % 2 == 0)));
    }

    #[test]
    fn a_shared_corner_ties_for_the_same_winner_and_greater_indices_alone() {
        let decided = Decided::default();
        let fan = [Vec3::X, Vec3::Y, Vec3::Z];
        let ray = Ray::new(Vec3::ZERO, Vec3::Y);
        decided.note(7);
        decided.note_point(7, Point::proven(Vec3::Y, &ray));
        assert!(decided.is_beaten(8, &fan, Some(7)));
        assert!(!decided.is_beaten(6, &fan, Some(7)), "the lesser index wins a tie");
        assert!(!decided.is_beaten(8, &fan, Some(5)), "another winner, elsewhere");
        assert!(!decided.is_beaten(8, &[Vec3::X, Vec3::ZERO, Vec3::Z], Some(7)), "another corner");
        assert_eq!(decided.point(7, || unreachable!("it is known")).map(|point| point.at), Some(Vec3::Y));
        assert_eq!(decided.point(9, || None), None);
        assert_eq!(decided.point(9, || unreachable!("that there is none is known")), None);
        assert!(!decided.is_beaten(10, &fan, Some(9)));
    }
}
