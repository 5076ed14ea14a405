//! The one place where instruction sets are chosen: eight lanes in a register of the processor at hand, and the walk
//! compiled for each set.
//!
//! A whole ray is one call: within it nothing is asked, and everything is inlined. There is a portable twin for
//! everything here ([`super::lanes::Portable`]), and a test that holds them equal to the bit.

#![cfg_attr(
    target_arch = "x86_64",
    allow(unsafe_code, reason = "instructions that must be known to exist before they are run")
)]

use super::exact::Exact;
use super::lanes::{Lanes, Portable};
use super::shape::Shape;
use super::walk::{self, Outcome};
use crate::ray::Ray;

/// Work that is compiled for each instruction set.
pub(super) trait Work {
    type Output;

    /// Does it, with lanes of that set. To be inlined always, and what it calls too.
    fn run<S: Lanes>(self) -> Self::Output;
}

/// An instruction set that the walk is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Isa {
    /// Whatever the compiler may assume.
    Portable,
    /// x86-64-v3. What need not fuse products and sums does not: `a * b + c` in the source is two operations.
    #[cfg(target_arch = "x86_64")]
    Avx2(avx2::Present),
}

impl Isa {
    /// The best one that this processor has.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(present) = avx2::Present::detect() {
            return Isa::Avx2(present);
        }
        Isa::Portable
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Isa::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(_) => "AVX2",
        }
    }

    /// Traces `ray` through `shape`, see [`walk::trace`].
    #[inline]
    pub fn trace<const EXACT: bool>(self, shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        match self {
            Isa::Portable => walk::trace::<Portable, (), EXACT>(shape, ray, any, exact, &mut ()),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(present) => avx2::trace::<EXACT>(present, shape, ray, any, exact),
        }
    }

    /// Does some work of the builder's in code that is compiled for the instruction set.
    #[inline]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            Isa::Portable => work.run::<Portable>(),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(present) => avx2::run(present, work),
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) mod avx2 {
    //! Eight lanes of 32 bytes.

    use super::{Exact, Outcome, Ray, Shape, Work, walk};
    use crate::nested::lanes::{Lanes, Row};
    #[cfg(test)]
    use crate::nested::{
        boxes::{BoxRay, Boxes},
        pack::{Pack, PackRay},
        sight::{Entry, Sight},
    };
    use std::arch::x86_64::*;
    use std::ops::{Add, BitAnd, BitOr, Div, Mul, Sub};

    /// Proof that the processor has the instructions of this module.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Present(());

    impl Present {
        /// Asks the processor.
        pub fn detect() -> Option<Self> {
            let present = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt");
            present.then_some(Self(()))
        }
    }

    /// [`walk::trace`] for this instruction set.
    #[inline]
    pub fn trace<const EXACT: bool>(_: Present, shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { trace_here::<EXACT>(shape, ray, any, exact) }
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn trace_here<const EXACT: bool>(shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        walk::trace::<Avx2, (), EXACT>(shape, ray, any, exact, &mut ())
    }

    /// [`Work::run`] for this instruction set.
    #[inline]
    pub fn run<W: Work>(_: Present, work: W) -> W::Output {
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { run_here(work) }
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    fn run_here<W: Work>(work: W) -> W::Output {
        work.run::<Avx2>()
    }

    /// What a pack says of a ray, for the tests: survivors, which of them are certain, where, and within which bound.
    #[cfg(test)]
    pub fn look<K: Pack>(_: Present, pack: &K, sight: &Sight) -> (u32, u32, Row, Row) {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn here<K: Pack>(pack: &K, sight: &Sight) -> (u32, u32, Row, Row) {
            let seen = pack.look(&PackRay::<Avx2>::new::<K>(sight), Avx2::splat(sight.end[1]));
            (seen.survivors, Avx2::bits(seen.certain) & seen.survivors, seen.p.row(), seen.bound.row())
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(pack, sight) }
    }

    /// [`Boxes::look`], for the tests.
    #[cfg(test)]
    pub fn boxes(_: Present, boxes: &Boxes, entry: &Entry, end: f32) -> (Row, u32) {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn here(boxes: &Boxes, entry: &Entry, end: f32) -> (Row, u32) {
            let (enters, met) = boxes.look(&BoxRay::<Avx2>::new(entry), end);
            (enters.row(), met)
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(boxes, entry, end) }
    }

    /// [`Lanes::crossed`], for the tests.
    #[cfg(test)]
    pub fn crossed(_: Present, axes: &[Row; 3]) -> u64 {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn here(axes: &[Row; 3]) -> u64 {
            Avx2::crossed(axes)
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(axes) }
    }

    /// [`Lanes::mirrored`], for the tests.
    #[cfg(test)]
    pub fn mirrored(_: Present, mask: u64, octant: usize) -> u64 {
        #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
        fn here(mask: u64, octant: usize) -> u64 {
            Avx2::mirrored(mask, octant)
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(mask, octant) }
    }

    /// Eight f32 in a register.
    ///
    /// Made in functions that are compiled for AVX2 alone: nothing else in the crate names this type but tests that have
    /// asked first.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2(__m256);

    /// A claim for each lane: all bits of it set or none.
    #[derive(Clone, Copy, Debug)]
    pub struct Mask(__m256);

    /// For each octant: what becomes of the lower half of a byte of a node's mask, what of the upper half, and which byte comes to
    /// each place.
    static TURNS: [[[u8; 16]; 3]; 8] = turns();

    const fn turns() -> [[[u8; 16]; 3]; 8] {
        let mut turns = [[[0; 16]; 3]; 8];
        let mut octant = 0;
        while octant < 8 {
            let mut i = 0;
            while i < 16 {
                let row = i as u8;
                let turned = if octant & 1 != 0 { row.reverse_bits() >> 4 } else { row };
                let (low, high) = if octant & 2 != 0 { (4, 0) } else { (0, 4) };
                turns[octant][0][i] = turned << low;
                turns[octant][1][i] = turned << high;
                let swap = (octant >> 1 & 1) as u8 | if octant & 4 != 0 { 6 } else { 0 };
                turns[octant][2][i] = if i < 8 { row ^ swap } else { 0x80 };
                i += 1;
            }
            octant += 1;
        }
        turns
    }

    macro_rules! operator {
        ($($trait:ident $method:ident $intrinsic:ident),*) => {$(
            impl $trait for Avx2 {
                type Output = Self;
                #[inline(always)]
                fn $method(self, other: Self) -> Self {
                    // SAFETY: the type is made where AVX2 is present only.
                    Self(unsafe { $intrinsic(self.0, other.0) })
                }
            }
        )*};
    }
    operator!(Add add _mm256_add_ps, Sub sub _mm256_sub_ps, Mul mul _mm256_mul_ps, Div div _mm256_div_ps);

    impl BitOr for Mask {
        type Output = Self;
        #[inline(always)]
        fn bitor(self, other: Self) -> Self {
            // SAFETY: the type is made where AVX2 is present only.
            Self(unsafe { _mm256_or_ps(self.0, other.0) })
        }
    }

    impl BitAnd for Mask {
        type Output = Self;
        #[inline(always)]
        fn bitand(self, other: Self) -> Self {
            // SAFETY: the type is made where AVX2 is present only.
            Self(unsafe { _mm256_and_ps(self.0, other.0) })
        }
    }

    // SAFETY of every block below: the type is used where AVX2 is present only; `of` and `row` read and write 32 bytes of a
    // `Row`, which has 32 and is aligned to them.
    impl Lanes for Avx2 {
        type Mask = Mask;

        #[inline(always)]
        fn of(row: &Row) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_load_ps(row.0.as_ptr()) })
        }
        #[inline(always)]
        fn splat(x: f32) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_set1_ps(x) })
        }
        #[inline(always)]
        fn halves(a: f32, b: f32) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_set_m128(_mm_set1_ps(b), _mm_set1_ps(a)) })
        }
        #[inline(always)]
        fn row(self) -> Row {
            let mut row = Row([0.0; 8]);
            // SAFETY: see above.
            unsafe { _mm256_store_ps(row.0.as_mut_ptr(), self.0) };
            row
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_sqrt_ps(self.0) })
        }
        #[inline(always)]
        fn plus_product(self, a: Self, b: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_fmadd_ps(a.0, b.0, self.0) })
        }
        #[inline(always)]
        fn minus_product(self, a: Self, b: Self) -> Self {
            // SAFETY: see above.
            Self(unsafe { _mm256_fnmadd_ps(a.0, b.0, self.0) })
        }
        #[inline(always)]
        fn less(self, other: Self) -> Mask {
            // SAFETY: see above.
            Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn bits(mask: Mask) -> u32 {
            // SAFETY: see above.
            unsafe { _mm256_movemask_ps(mask.0) as u32 }
        }
        #[inline(always)]
        fn apart<W: Work>(work: W) -> W::Output {
            #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
            #[inline(never)]
            fn here<W: Work>(work: W) -> W::Output {
                work.run::<Avx2>()
            }
            // SAFETY: see above.
            unsafe { here(work) }
        }
        /// Rows of cells are halves of bytes: two tables turn these round, and a third says where bytes go.
        #[inline(always)]
        fn mirrored(mask: u64, octant: usize) -> u64 {
            let [low, high, place] = &TURNS[octant & 7];
            // SAFETY: see above; tables have 16 bytes.
            unsafe {
                let table = |bytes: &[u8; 16]| _mm_loadu_si128(bytes.as_ptr().cast());
                let (mask, half) = (_mm_cvtsi64_si128(mask as i64), _mm_set1_epi8(15));
                let low = _mm_shuffle_epi8(table(low), _mm_and_si128(mask, half));
                let high = _mm_shuffle_epi8(table(high), _mm_and_si128(_mm_srli_epi64::<4>(mask), half));
                _mm_cvtsi128_si64(_mm_shuffle_epi8(_mm_or_si128(low, high), table(place))) as u64
            }
        }
    }
}
