//! What a ray has decided in exact arithmetic is not decided again.
//!
//! A grid lists a triangle in many voxels. Tests that f32 or f64 answer are cheap to repeat; the exact stage is not, and it is
//! needed again for every triangle around a corner that the ray meets exactly, in every voxel. This is the mailbox of
//! Amanatides & Woo (1987, "Avoiding Multiple Intersections") for those triangles alone: a ray that leaves nothing undecided,
//! which is nearly every ray, pays one comparison with null.

use super::Triangle;
use glam::Vec3;
use std::cell::RefCell;
use std::collections::HashSet;

/// The memory of one ray and one winner; empty, and without allocation, until something is undecided.
#[derive(Debug, Default)]
pub(super) struct Decided(RefCell<Option<Box<Memory>>>);

#[derive(Debug, Default)]
struct Memory {
    /// The first triangles decided; looking through these is cheaper than hashing.
    few: Vec<u32>,
    many: HashSet<u32>,
    /// The triangle last made the winner by the exact stage, and its corner if the ray passes exactly through it.
    corner: Option<(u32, Vec3)>,
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

    /// Remembers that the winner is `prim`, and the corner if the ray meets it exactly in one.
    pub fn note_winner(&self, prim: u32, corner: Option<Vec3>) {
        if let Some(memory) = &mut *self.0.borrow_mut() {
            memory.corner = corner.map(|corner| (prim, corner));
        }
    }
}

impl Memory {
    fn is_beaten(&self, prim: u32, corners: &Triangle, winner: Option<u32>) -> bool {
        let shares =
            |(holder, corner): &(u32, Vec3)| Some(*holder) == winner && prim > *holder && corners.contains(corner);
        self.corner.as_ref().is_some_and(shares)
            || self.few.contains(&prim)
            || (!self.many.is_empty() && self.many.contains(&prim))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_is_remembered() {
        let decided = Decided::default();
        let corners = [Vec3::ZERO; 3];
        assert!(!decided.is_beaten(0, &corners, None));
        (0..100).for_each(|prim| decided.note(2 * prim));
        assert!((0..100).all(|prim| decided.is_beaten(2 * prim, &corners, None)));
        assert!((0..100).all(|prim| !decided.is_beaten(2 * prim + 1, &corners, None)));
    }

    #[test]
    fn a_shared_corner_ties_for_the_same_winner_and_greater_indices_alone() {
        let decided = Decided::default();
        let fan = [Vec3::X, Vec3::Y, Vec3::Z];
        decided.note(7);
        decided.note_winner(7, Some(Vec3::Y));
        assert!(decided.is_beaten(8, &fan, Some(7)));
        assert!(!decided.is_beaten(6, &fan, Some(7)), "the lesser index wins a tie");
        assert!(!decided.is_beaten(8, &fan, Some(5)), "another winner, elsewhere");
        assert!(!decided.is_beaten(8, &[Vec3::X, Vec3::ZERO, Vec3::Z], Some(7)), "another corner");
        decided.note_winner(9, None);
        assert!(!decided.is_beaten(10, &fan, Some(9)));
    }
}
