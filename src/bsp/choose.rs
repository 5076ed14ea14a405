//! Where to split: in the middle, or where rays are expected to do least work.

use super::frame::PADDING;
use super::options::Choice;
use super::reference::{Extent, Reference, Sorter};
use super::tree::{AnyPlane, AxisPlane, Oblique};
use glam::DVec3;

/// What a test of a primitive costs, in visits of a node.
const TEST: f64 = 2.0;

/// What a visit of a node with an oblique plane costs: six more multiplications and a division.
const OBLIQUE: f64 = 2.0;

/// A plane that cuts off empty space is worth this much more than the heuristic says (Hurley et al. 2002 use the same 20 %).
const EMPTY: f64 = 0.8;

/// The references' reach along a direction is cut into so many parts, and planes are tried where these begin and end.
const BINS: usize = 24;

/// Directions that are tried, of unit length: the axes, then the diagonals of two.
const DIRECTIONS: [DVec3; 9] = {
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
        DVec3::new(D, D, 0.0),
        DVec3::new(D, -D, 0.0),
        DVec3::new(D, 0.0, D),
        DVec3::new(D, 0.0, -D),
        DVec3::new(0.0, D, D),
        DVec3::new(0.0, D, -D),
    ]
};

impl Sorter<'_> {
    /// The plane for the references of a cell at a depth, or `None` if splitting does not pay.
    pub fn choose(&self, choice: Choice, references: &[Reference], cell: &Extent, depth: u32) -> Option<AnyPlane> {
        match choice {
            Choice::Midpoint => {
                let axis = depth % 3;
                let middle = 0.5 * (cell.min[axis as usize] + cell.max[axis as usize]);
                // A whole number up to 2^20.
                Some(AnyPlane::Axis(AxisPlane { axis, at: middle as f32 }))
            }
            Choice::Sah => self.cheapest(references, cell, 3),
            Choice::Oblique => self.cheapest(references, cell, DIRECTIONS.len()),
        }
    }

    /// The plane of least expected cost: a node visit, and tests of each side's list weighed by the chance that a ray
    /// through the cell meets that side.
    ///
    /// Across an axis the chance is the ratio of surfaces. Across a diagonal it is that of a slab of a cube, by its share of
    /// the width of the references: an estimate, for cells that such planes have cut are no boxes.
    fn cheapest(&self, references: &[Reference], cell: &Extent, directions: usize) -> Option<AnyPlane> {
        let mut best = (TEST * references.len() as f64, None);
        for (direction, &normal) in DIRECTIONS[..directions].iter().enumerate() {
            let plane = |at: f32| match direction {
                0..3 => AnyPlane::Axis(AxisPlane { axis: direction as u32, at }),
                _ => AnyPlane::Oblique(Oblique { normal, at: f64::from(at) }),
            };
            let reach = |r: &Reference| self.reach(r, &plane(0.0));
            let (low, high) = references
                .iter()
                .map(reach)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
            // Clear of the padding, so that nothing is cut off with the empty space.
            let (low, high) = (low - 4.0 * PADDING, high + 4.0 * PADDING);
            let width = (high - low) / BINS as f64;
            let bin = |x: f64| (((x - low) / width) as usize).min(BINS - 1);
            let (mut begins, mut ends) = ([0_usize; BINS], [0_usize; BINS]);
            for (from, to) in references.iter().map(reach) {
                begins[bin(from - PADDING)] += 1;
                ends[bin(to + PADDING)] += 1;
            }
            let (mut left, mut right) = (0, references.len());
            for place in 0..=BINS {
                if place > 0 {
                    left += begins[place - 1];
                    right -= ends[place - 1];
                }
                let at = (low + width * place as f64) as f32;
                let (visit, chances) = match direction {
                    0..3 => {
                        if f64::from(at) <= cell.min[direction] || f64::from(at) >= cell.max[direction] {
                            continue;
                        }
                        (1.0, cell.sides(&plane(at), 0.0).map(|side| side.area() / cell.area()))
                    }
                    // Empty corners may have been cut off before; the cell's box does not tell.
                    _ if left == 0 || right == 0 => continue,
                    _ => {
                        let share = place as f64 / BINS as f64;
                        (OBLIQUE, [share, 1.0 - share].map(|share| (1.0 + 2.0 * share) / 3.0))
                    }
                };
                let tests = TEST * (chances[0] * left as f64 + chances[1] * right as f64);
                let bonus = if left == 0 || right == 0 { EMPTY } else { 1.0 };
                let cost = bonus * (visit + tests);
                if cost < best.0 {
                    best = (cost, Some(plane(at)));
                }
            }
        }
        best.1
    }
}
