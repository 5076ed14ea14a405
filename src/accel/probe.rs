//! Watching a walk at no cost when nobody watches.

/// Watches a walk. Every method is empty by default; `()` watches nothing and costs nothing, [`Counts`] counts all.
pub trait Probe {
    /// Whether any method does anything. Watched walks need not be fast: they are compiled once for both queries.
    const WATCHES: bool = true;

    /// A voxel or node was entered.
    #[inline(always)]
    fn step(&mut self) {}

    /// Several voxels were skipped at once.
    #[inline(always)]
    fn leap(&mut self) {}

    /// A leaf of a tree was reached; an empty subtree counts as a leaf, though it is no node and takes no step.
    #[inline(always)]
    fn leaf(&mut self) {}

    /// A primitive was tested.
    #[inline(always)]
    fn test(&mut self) {}
}

impl Probe for () {
    const WATCHES: bool = false;
}

/// Work done for a number of rays; independent of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Rays traced.
    pub rays: u64,
    /// Voxels or nodes visited; 0 for accelerators that cannot count them.
    pub steps: u64,
    /// Leaps over several voxels.
    pub leaps: u64,
    /// Leaves of trees reached, empty ones among them; 0 for all other accelerators.
    pub leaves: u64,
    /// Primitive tests.
    pub tests: u64,
}

impl Probe for Counts {
    #[inline]
    fn step(&mut self) {
        self.steps += 1;
    }
    #[inline]
    fn leap(&mut self) {
        self.leaps += 1;
    }
    #[inline]
    fn leaf(&mut self) {
        self.leaves += 1;
    }
    #[inline]
    fn test(&mut self) {
        self.tests += 1;
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.steps += other.steps;
        self.leaps += other.leaps;
        self.leaves += other.leaves;
        self.tests += other.tests;
    }
}
