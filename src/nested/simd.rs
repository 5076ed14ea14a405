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
    /// x86-64-v3 but for fused multiply-add, which the walk must not use.
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
    pub fn trace(self, shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        match self {
            Isa::Portable => walk::trace::<Portable, ()>(shape, ray, any, exact, &mut ()),
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2(present) => avx2::trace(present, shape, ray, any, exact),
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
        frame::Entry,
        pack::{Pack, PackRay},
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
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt");
            present.then_some(Self(()))
        }
    }

    /// [`walk::trace`] for this instruction set.
    #[inline]
    pub fn trace(_: Present, shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { trace_here(shape, ray, any, exact) }
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn trace_here(shape: &Shape, ray: &Ray, any: bool, exact: &mut dyn Exact) -> Outcome {
        walk::trace::<Avx2, ()>(shape, ray, any, exact, &mut ())
    }

    /// [`Work::run`] for this instruction set.
    #[inline]
    pub fn run<W: Work>(_: Present, work: W) -> W::Output {
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { run_here(work) }
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn run_here<W: Work>(work: W) -> W::Output {
        work.run::<Avx2>()
    }

    /// What a pack says of a ray, for the tests: survivors, which of them are certain, where, and within which bound.
    #[cfg(test)]
    pub fn look<K: Pack>(_: Present, pack: &K, entry: &Entry) -> (u32, u32, Row, Row) {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        fn here<K: Pack>(pack: &K, entry: &Entry) -> (u32, u32, Row, Row) {
            let seen = pack.look(&PackRay::<Avx2>::new(entry), Avx2::splat(entry.end));
            (seen.survivors, Avx2::bits(seen.certain) & seen.survivors, seen.s.row(), seen.bound.row())
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(pack, entry) }
    }

    /// [`Lanes::crossed`], for the tests.
    #[cfg(test)]
    pub fn crossed(_: Present, axes: &[Row; 3]) -> u64 {
        #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
        fn here(axes: &[Row; 3]) -> u64 {
            Avx2::crossed(axes)
        }
        // SAFETY: there is a `Present`, so the processor has these instructions.
        unsafe { here(axes) }
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
        fn less(self, other: Self) -> Mask {
            // SAFETY: see above.
            Mask(unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) })
        }
        #[inline(always)]
        fn bits(mask: Mask) -> u32 {
            // SAFETY: see above.
            unsafe { _mm256_movemask_ps(mask.0) as u32 }
        }
    }
}
