//! A ray from cell to cell of the grid on top: the walk of Amanatides and Woo in f32, and leaps out of empty cubes.
//!
//! A crossing is computed anew from the number of its plane, alike from both sides; no parameter is added up.

use super::shape::Top;
use super::sight::Entry;
use crate::ray::lesser;
use glam::Vec3A;

/// A cell of the grid on top, and where the ray leaves it. A plane is crossed at its number times the pace less the base.
pub(super) struct Place {
    pub cell: isize,
    /// Where the ray crosses the next plane of each axis.
    pub crossing: [f32; 3],
    /// Numbers of these planes.
    plane: [f32; 3],
    pace: [f32; 3],
    /// Planes for each unit of `s`.
    planes: [f32; 3],
    base: [f32; 3],
    /// From cell to cell along each axis.
    stride: [isize; 3],
    /// Steps that stay within the grid.
    left: [i32; 3],
}

impl Place {
    /// Where a ray from `origin`, seen along its octant, begins.
    #[inline(always)]
    pub fn new(top: &Top, origin: Vec3A, entry: &Entry, octant: usize) -> Self {
        let from = top.half + origin;
        let (base, pace) = (from * entry.inverse, top.cell * entry.inverse);
        // The origin is in the grid but for rounding.
        let shifted = (from * top.per_unit - 0.5).max(Vec3A::ZERO).min(top.last) + SHIFT;
        let plane = (shifted - SHIFT) + 1.0;
        let crossing = plane * pace - base;
        let (mut cell, mut stride, mut left, mut step) = (0, [0; 3], [0; 3], 1);
        for (a, number) in shifted.to_array().map(number).into_iter().enumerate() {
            left[a] = top.cells[a] as i32 - 1 - number;
            let backward = octant >> a & 1 != 0;
            stride[a] = if backward { -step } else { step };
            cell += (if backward { left[a] } else { number }) as isize * step;
            step *= top.cells[a] as isize;
        }
        Self {
            cell,
            crossing: crossing.to_array(),
            plane: plane.to_array(),
            pace: pace.to_array(),
            planes: (top.per_unit * entry.size).to_array(),
            base: base.to_array(),
            stride,
            left,
        }
    }

    /// The cell of a grid that has no other, which is left at `end`.
    #[inline(always)]
    pub fn only(end: f32) -> Self {
        let none = [0.0; 3];
        let (crossing, pace) = ([end; 3], none);
        Self { cell: 0, crossing, plane: none, pace, planes: none, base: none, stride: [0; 3], left: [0; 3] }
    }

    /// To the next cell along an axis, and `s` to where it begins; false outside the grid.
    #[inline(always)]
    pub fn step<const A: usize>(&mut self, s: &mut f32) -> bool {
        *s = self.crossing[A];
        self.left[A] -= 1;
        self.plane[A] += 1.0;
        self.cell += self.stride[A];
        self.crossing[A] = self.plane[A] * self.pace[A] - self.base[A];
        self.left[A] >= 0
    }

    /// To where the ray leaves the empty cube of `edge` cells that begins with this one; false outside the grid or beyond
    /// `end`.
    #[inline(always)]
    pub fn leap(&mut self, edge: f32, end: f32, s: &mut f32) -> bool {
        let mut exits = [0.0; 3];
        for a in 0..3 {
            exits[a] = self.crossing[a] + (edge - 1.0) * self.pace[a];
        }
        let exit = lesser(exits[0], lesser(exits[1], exits[2]));
        *s = exit;
        let mut outside = 0;
        for a in 0..3 {
            // Planes crossed on the way; all of the cube's along the axis of the exit, and at most one less along another. The
            // product may round to a plane that is crossed just behind the exit, or not to one just before it: by rounding of the
            // crossing, which the padding allows for.
            let beyond = (exit - self.crossing[a]) * self.planes[a];
            let within = if beyond < 0.0 { 0.0 } else { lesser(beyond + 0.5, edge - 1.0) };
            let shifted = if exits[a] == exit { edge } else { within } + SHIFT;
            let (crossed, number) = (shifted - SHIFT, number(shifted));
            self.plane[a] += crossed;
            self.left[a] -= number;
            outside |= self.left[a];
            self.cell += number as isize * self.stride[a];
            self.crossing[a] = self.plane[a] * self.pace[a] - self.base[a];
        }
        outside >= 0 && exit <= end
    }
}

/// With this added, a number from 0 to 2^22 is rounded to a whole one: without a conversion, which would have to ask for its range.
const SHIFT: f32 = 8_388_608.0;

/// A whole number to which [`SHIFT`] was added.
#[inline(always)]
fn number(shifted: f32) -> i32 {
    (shifted.to_bits() & 0x007f_ffff) as i32
}
