//! Eight numbers at a time: what the tests of packs and nodes are written in, once for all processors.

use super::simd::Work;
use glam::Vec3A;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

/// One f32 for each of eight lanes, aligned for processors that read it at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Row(pub [f32; 8]);

/// Eight f32 in registers. Every operation rounds as that of f32 does, so that all implementations have the same bits, but for
/// [`Lanes::plus_product`] and [`Lanes::minus_product`]: these may round the product before it is added or not.
pub(super) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// A claim for each lane.
    type Mask: Copy + BitAnd<Output = Self::Mask> + BitOr<Output = Self::Mask>;

    /// The lanes of a row.
    fn of(row: &Row) -> Self;

    /// The same number in all lanes.
    fn splat(x: f32) -> Self;

    /// `a` in the lower four lanes, `b` in the upper four.
    fn halves(a: f32, b: f32) -> Self;

    /// To memory.
    fn row(self) -> Row;

    /// The lesser one, lane by lane; `other` if one is a NaN.
    fn min(self, other: Self) -> Self;

    /// The greater one, lane by lane; `other` if one is a NaN.
    fn max(self, other: Self) -> Self;

    /// Without the sign.
    fn abs(self) -> Self;

    /// Square roots.
    fn sqrt(self) -> Self;

    /// `self + a b`, rounded once or twice.
    fn plus_product(self, a: Self, b: Self) -> Self;

    /// `self - a b`, rounded once or twice.
    fn minus_product(self, a: Self, b: Self) -> Self;

    /// Where this is less than `other`; false for a NaN.
    fn less(self, other: Self) -> Self::Mask;

    /// Bit `i` is set if the claim is true of lane `i`.
    fn bits(mask: Self::Mask) -> u32;

    /// Does some work in a function of its own that is compiled for the same instructions: what is rare and long stays out of the
    /// loops.
    fn apart<W: Work>(work: W) -> W::Output;

    /// The cells of a node that a ray crosses: bit `x + 4 y + 16 z` is set if the intervals `x` of the first axis, `y` of the
    /// second and `z` of the third have a point in common. The row of an axis has the four lower ends, then the four upper.
    #[inline(always)]
    fn crossed(axes: &[Row; 3]) -> u64 {
        let [Row(x), Row(y), Row(z)] = axes;
        let near_x = Self::of(&Row([x[0], x[1], x[2], x[3], x[0], x[1], x[2], x[3]]));
        let far_x = Self::of(&Row([x[4], x[5], x[6], x[7], x[4], x[5], x[6], x[7]]));
        let near = [near_x.max(Self::halves(y[0], y[1])), near_x.max(Self::halves(y[2], y[3]))];
        let far = [far_x.min(Self::halves(y[4], y[5])), far_x.min(Self::halves(y[6], y[7]))];
        let mut apart = 0;
        for k in 0..4 {
            let (near_z, far_z) = (Self::splat(z[k]), Self::splat(z[k + 4]));
            for h in 0..2 {
                let mask = far[h].min(far_z).less(near[h].max(near_z));
                apart |= u64::from(Self::bits(mask)) << (16 * k + 8 * h);
            }
        }
        !apart
    }

    /// The cells of a node seen along an octant of directions: bit `i` becomes bit `i` with the coordinates turned round of the
    /// axes along which rays move backwards.
    #[inline(always)]
    fn mirrored(mut mask: u64, octant: usize) -> u64 {
        if octant & 1 != 0 {
            mask = (mask >> 1 & 0x5555_5555_5555_5555) | (mask & 0x5555_5555_5555_5555) << 1;
            mask = (mask >> 2 & 0x3333_3333_3333_3333) | (mask & 0x3333_3333_3333_3333) << 2;
        }
        if octant & 2 != 0 {
            mask = (mask >> 4 & 0x0f0f_0f0f_0f0f_0f0f) | (mask & 0x0f0f_0f0f_0f0f_0f0f) << 4;
            mask = (mask >> 8 & 0x00ff_00ff_00ff_00ff) | (mask & 0x00ff_00ff_00ff_00ff) << 8;
        }
        if octant & 4 != 0 {
            mask = (mask >> 16 & 0x0000_ffff_0000_ffff) | (mask & 0x0000_ffff_0000_ffff) << 16;
            mask = mask.rotate_left(32);
        }
        mask
    }
}

/// Three numbers a lane: a vector of space in each.
///
/// Written out: closures and what takes them are not compiled for the instruction set of their caller.
#[derive(Clone, Copy)]
pub(super) struct Vector<S> {
    pub x: S,
    pub y: S,
    pub z: S,
}

impl<S: Lanes> Vector<S> {
    /// The lanes of three rows.
    #[inline(always)]
    pub fn of(rows: &[Row; 3]) -> Self {
        Self { x: S::of(&rows[0]), y: S::of(&rows[1]), z: S::of(&rows[2]) }
    }

    /// The same vector in all lanes.
    #[inline(always)]
    pub fn splat(v: Vec3A) -> Self {
        let [x, y, z] = v.to_array();
        Self { x: S::splat(x), y: S::splat(y), z: S::splat(z) }
    }

    /// The sum of the products of components.
    #[inline(always)]
    pub fn dot(&self, other: &Self) -> S {
        (self.x * other.x).plus_product(self.y, other.y).plus_product(self.z, other.z)
    }

    /// The cross product.
    #[inline(always)]
    pub fn cross(&self, other: &Self) -> Self {
        Self {
            x: (self.y * other.z).minus_product(self.z, other.y),
            y: (self.z * other.x).minus_product(self.x, other.z),
            z: (self.x * other.y).minus_product(self.y, other.x),
        }
    }

    /// The greatest size of a component.
    #[inline(always)]
    pub fn size(&self) -> S {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
    }

    /// The difference.
    #[inline(always)]
    pub fn minus(&self, other: &Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    /// This less `s` times `direction`.
    #[inline(always)]
    pub fn less_by(&self, s: S, direction: &Self) -> Self {
        Self {
            x: self.x.minus_product(s, direction.x),
            y: self.y.minus_product(s, direction.y),
            z: self.z.minus_product(s, direction.z),
        }
    }
}

/// Eight numbers for a processor of which nothing is known: the compiler makes of them what it can.
#[derive(Clone, Copy, Debug)]
pub(super) struct Portable([f32; 8]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        let mut lanes = [0.0; 8];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(self.0[i], other.0[i]);
        }
        Self(lanes)
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl $trait for Portable {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self { self.zip(other, |a, b| a $op b) }
        }
    )*};
}
operator!(Add add +, Sub sub -, Mul mul *, Div div /);

impl Lanes for Portable {
    type Mask = u32;

    #[inline(always)]
    fn of(row: &Row) -> Self {
        Self(row.0)
    }
    #[inline(always)]
    fn splat(x: f32) -> Self {
        Self([x; 8])
    }
    #[inline(always)]
    fn halves(a: f32, b: f32) -> Self {
        Self([a, a, a, a, b, b, b, b])
    }
    #[inline(always)]
    fn row(self) -> Row {
        Row(self.0)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.zip(self, |a, _| a.abs())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.zip(self, |a, _| a.sqrt())
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }
    #[inline(always)]
    fn less(self, other: Self) -> u32 {
        let mut bits = 0;
        for i in 0..8 {
            bits |= u32::from(self.0[i] < other.0[i]) << i;
        }
        bits
    }
    #[inline(always)]
    fn bits(mask: u32) -> u32 {
        mask
    }
    #[inline(never)]
    fn apart<W: Work>(work: W) -> W::Output {
        work.run::<Self>()
    }
}
