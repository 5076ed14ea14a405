//! Whether two pictures of one scene agree: tile by tile where both are noisy, pixel by pixel where neither is.

mod deterministic;
mod maps;
mod statistical;

pub use deterministic::{DeterministicLimits, DeterministicVerdict, deterministic};
pub use maps::{MAP_Z, above_limits, z_map};
pub use statistical::{Estimate, StatisticalLimits, StatisticalVerdict, TILE, statistical};

#[cfg(test)]
pub(crate) mod noise {
    //! Seeded noise for tests.

    /// Uniform in 0..1: SplitMix64 (Steele, Lea & Flood 2014).
    pub(crate) fn uniform(state: &mut u64) -> f64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
