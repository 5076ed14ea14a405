//! The voxel walk exactly as printed in 1987, over numbers that count what is done with them.
//!
//! J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987: each voxel costs two
//! comparisons and one addition of floating-point numbers, and two comparisons and one addition of integers. This walk
//! shows that and finds no hits; accelerators walk otherwise, see [`crate::grid`].

use std::cell::Cell;

/// Operations by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Comparisons of floating-point numbers.
    pub float_compares: u64,
    /// Additions and subtractions of floating-point numbers.
    pub float_adds: u64,
    /// Multiplications and divisions of floating-point numbers.
    pub float_products: u64,
    /// Absolute values of floating-point numbers.
    pub absolutes: u64,
    /// Conversions between floating-point numbers and integers.
    pub conversions: u64,
    /// Comparisons of integers, that of a list with NIL too.
    pub int_compares: u64,
    /// Additions of integers.
    pub int_adds: u64,
}

impl Operations {
    /// Everything done with floating-point numbers.
    pub fn float(&self) -> u64 {
        self.float_compares + self.float_adds + self.float_products + self.absolutes + self.conversions
    }
}

/// Where a walk went and what it took.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Walked {
    /// Voxels in the order visited, the first one too.
    pub voxels: Vec<[i64; 3]>,
    /// What finding the first voxel and the increments took.
    pub start: Operations,
    /// What going from voxel to voxel took.
    pub steps: Operations,
    /// True if the walk left the grid; false if it ended at a list.
    pub left: bool,
}

/// Walks from `origin` along `direction` through a grid of `count` unit voxels on each axis whose corner is the origin of
/// coordinates, until `occupied` says that the voxel has a list.
///
/// `enter` is the parameter at which a ray from outside meets the grid, `None` if it starts inside; how the paper finds it
/// is not printed, so that is not counted. The printed form does not say what to do along an axis on which the ray does
/// not move; its components must all be other than zero here.
pub fn walk(
    origin: [f64; 3],
    direction: [f64; 3],
    enter: Option<f64>,
    count: i64,
    occupied: impl Fn([i64; 3]) -> bool,
) -> Walked {
    let tally = Tally::default();
    let number = |x: f64| Number(x, &tally);
    let whole = |i: i64| Whole(i, &tally);
    let (corner, size) = (number(0.0), number(1.0));

    // The first point in the grid.
    let start: [Number; 3] = match enter {
        Some(t) => [0, 1, 2].map(|i| number(origin[i]).plus(number(direction[i]).times(number(t)))),
        None => origin.map(number),
    };
    // Eleven operations for each axis: three for the voxel, one for the sense, five for the first crossing, two for the
    // increment. The paper gives sums only; this is the plain way to write it.
    let axis = |i: usize| {
        let d = number(direction[i]);
        let voxel = start[i].minus(corner).over(size).truncated(count);
        let forward = !d.less(number(0.0));
        let face = whole(voxel.0 + i64::from(forward)).converted().times(size).plus(corner);
        let t_max = face.minus(start[i]).over(d);
        let t_delta = size.over(d).absolute();
        let (step, just_out) = if forward { (1, count) } else { (-1, -1) };
        Axis { voxel, step: whole(step), just_out: whole(just_out), t_max, t_delta }
    };
    let [mut x, mut y, mut z] = [axis(0), axis(1), axis(2)];
    let begun = tally.taken();

    let mut voxels = vec![[x.voxel.0, y.voxel.0, z.voxel.0]];
    let mut left = false;
    // The caller tests the first voxel; the printed loop steps first.
    if !occupied(voxels[0]) {
        loop {
            let moved = if x.t_max.less(y.t_max) {
                if x.t_max.less(z.t_max) { x.advance() } else { z.advance() }
            } else if y.t_max.less(z.t_max) {
                y.advance()
            } else {
                z.advance()
            };
            if !moved {
                left = true;
                break;
            }
            let voxel = [x.voxel.0, y.voxel.0, z.voxel.0];
            voxels.push(voxel);
            if !tally.list_is_nil(!occupied(voxel)) {
                break;
            }
        }
    }
    Walked { voxels, start: begun, steps: tally.taken(), left }
}

/// State of one axis, by the paper's names: X, stepX, justOutX, tMaxX, tDeltaX.
struct Axis<'a> {
    voxel: Whole<'a>,
    step: Whole<'a>,
    just_out: Whole<'a>,
    t_max: Number<'a>,
    t_delta: Number<'a>,
}

impl Axis<'_> {
    /// `X = X + stepX; if (X == justOutX) return(NIL); tMaxX = tMaxX + tDeltaX;`: false if the grid is left.
    fn advance(&mut self) -> bool {
        self.voxel = self.voxel.plus(self.step);
        if self.voxel.equals(self.just_out) {
            return false;
        }
        self.t_max = self.t_max.plus(self.t_delta);
        true
    }
}

/// The operations so far.
#[derive(Default)]
struct Tally(Cell<Operations>);

impl Tally {
    fn count(&self, change: impl FnOnce(&mut Operations)) {
        let mut operations = self.0.get();
        change(&mut operations);
        self.0.set(operations);
    }

    fn taken(&self) -> Operations {
        self.0.take()
    }

    /// `while (list == NIL)`.
    fn list_is_nil(&self, nil: bool) -> bool {
        self.count(|o| o.int_compares += 1);
        nil
    }
}

/// A floating-point number whose operations are counted.
#[derive(Clone, Copy)]
struct Number<'a>(f64, &'a Tally);

impl<'a> Number<'a> {
    fn less(self, other: Self) -> bool {
        self.1.count(|o| o.float_compares += 1);
        self.0 < other.0
    }

    fn plus(self, other: Self) -> Self {
        self.1.count(|o| o.float_adds += 1);
        Number(self.0 + other.0, self.1)
    }

    fn minus(self, other: Self) -> Self {
        self.1.count(|o| o.float_adds += 1);
        Number(self.0 - other.0, self.1)
    }

    fn times(self, other: Self) -> Self {
        self.1.count(|o| o.float_products += 1);
        Number(self.0 * other.0, self.1)
    }

    fn over(self, other: Self) -> Self {
        self.1.count(|o| o.float_products += 1);
        Number(self.0 / other.0, self.1)
    }

    fn absolute(self) -> Self {
        self.1.count(|o| o.absolutes += 1);
        Number(self.0.abs(), self.1)
    }

    /// The voxel, within the grid.
    fn truncated(self, count: i64) -> Whole<'a> {
        self.1.count(|o| o.conversions += 1);
        Whole((self.0.floor() as i64).clamp(0, count - 1), self.1)
    }
}

/// An integer whose operations are counted.
#[derive(Clone, Copy)]
struct Whole<'a>(i64, &'a Tally);

impl<'a> Whole<'a> {
    fn plus(self, other: Self) -> Self {
        self.1.count(|o| o.int_adds += 1);
        Whole(self.0 + other.0, self.1)
    }

    fn equals(self, other: Self) -> bool {
        self.1.count(|o| o.int_compares += 1);
        self.0 == other.0
    }

    fn converted(self) -> Number<'a> {
        self.1.count(|o| o.conversions += 1);
        Number(self.0 as f64, self.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORIGIN: [f64; 3] = [0.3, 0.6, 0.2];
    const DIRECTION: [f64; 3] = [1.0, 0.7, 0.25];

    #[test]
    fn a_step_costs_what_the_paper_says() {
        // The ray leaves through x = 16 at t = 15.7: 15 crossings in x; y reaches 11.59, 11 crossings; z 4.125, 4.
        let walked = walk(ORIGIN, DIRECTION, None, 16, |_| false);
        let crossings = 15 + 11 + 4;
        assert!(walked.left);
        assert_eq!(walked.voxels.len(), 1 + crossings as usize);
        assert_eq!((walked.voxels[0], walked.voxels[crossings as usize]), ([0, 0, 0], [15, 11, 4]));
        // Each of them costs 2 + 1 and 2 + 1; the one that leaves neither advances tMax nor looks a list up.
        let steps = crossings + 1;
        let expected = Operations {
            float_compares: 2 * steps,
            float_adds: crossings,
            int_compares: 2 * crossings + 1,
            int_adds: steps,
            ..Operations::default()
        };
        assert_eq!(walked.steps, expected);
    }

    #[test]
    fn a_walk_that_ends_at_a_list_costs_the_same_in_every_step() {
        for target in [[1, 1, 0], [7, 5, 1], [15, 11, 4]] {
            let walked = walk(ORIGIN, DIRECTION, None, 16, |voxel| voxel == target);
            assert!(!walked.left);
            assert_eq!(walked.voxels.last(), Some(&target));
            let steps = walked.voxels.len() as u64 - 1;
            let expected = Operations {
                float_compares: 2 * steps,
                float_adds: steps,
                int_compares: 2 * steps,
                int_adds: steps,
                ..Operations::default()
            };
            assert_eq!(walked.steps, expected);
        }
    }

    #[test]
    fn the_start_costs_at_most_what_the_paper_says() {
        // 33 where the ray starts inside, up to 40 where it does not.
        assert_eq!(walk(ORIGIN, DIRECTION, None, 16, |_| false).start.float(), 33);
        let outside = walk([-1.0, -0.5, -0.25], DIRECTION, Some(1.0), 16, |_| false);
        assert_eq!(outside.voxels[0], [0, 0, 0]);
        assert!((34..=40).contains(&outside.start.float()), "{:?}", outside.start);
    }

    #[test]
    fn the_walk_visits_every_voxel_that_the_ray_meets() {
        // Backwards through the same voxels: the reversed ray from the far end.
        let there = walk(ORIGIN, DIRECTION, None, 16, |_| false).voxels;
        let end: [f64; 3] = std::array::from_fn(|i| ORIGIN[i] + 15.5 * DIRECTION[i]);
        let back = walk(end, DIRECTION.map(|d| -d), None, 16, |voxel| voxel == [0, 0, 0]).voxels;
        assert_eq!(back.into_iter().rev().collect::<Vec<_>>(), there);
    }
}
