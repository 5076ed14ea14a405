//! The tables and claims of the papers, measured again.
//!
//! Every experiment records the rays of real pictures once and traces that very list through each accelerator, so that
//! all of them answer the same questions in the same order; see [`trace`].

pub mod amanatides_woo;
pub mod arvo;
pub mod dda;
pub mod exactness;
pub mod newton_seeds;
pub mod plot;
pub mod printed_dda;
pub mod printed_walk;
pub mod report;
pub mod semwal_kvarnstrom;
pub mod shadow_voxels;
pub mod spd;
pub mod trace;

pub use report::{Cell, Claim, Report, Table, Verdict};

/// Called before each stage: stages done, stages in all, and what comes next in a few words.
pub type Watch<'a> = dyn Fn(usize, usize, &str) + 'a;

/// The measure of all methods: the walk without skips, SEADS in the papers.
const PLAIN: &str = "grid";

/// From the least to the greatest, each once.
fn rising(numbers: &[u32]) -> Vec<u32> {
    let mut numbers = numbers.to_vec();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The plain grid, then the others.
fn plain_first(accels: &[String]) -> Vec<String> {
    let others = accels.iter().filter(|a| *a != PLAIN).cloned();
    std::iter::once(PLAIN.to_string()).chain(others).collect()
}
