//! Counter-based random numbers: a sample does not depend on threads, tiles or accelerator.
//!
//! Every number is a function of (seed, pixel, sample, set, place in the set). Sets of four numbers are drawn for each
//! purpose: set 0 places the sample in its pixel, sets `2 e - 1` and `2 e` serve the light and the scattering at the end
//! of edge `e` of a path.

use super::Sampler;

impl Sampler {
    /// Samples for each pixel.
    pub fn samples(&self) -> u32 {
        match *self {
            Sampler::Regular(n) => n.saturating_mul(n),
            Sampler::Sobol(n) => n,
        }
    }
}

/// Greatest number of Sobol points; beyond it the generator repeats itself.
pub(super) const SOBOL_LIMIT: u32 = 1 << 16;

/// The numbers of one pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct PixelSamples {
    sampler: Sampler,
    seed: u64,
}

/// The numbers of one sample of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Samples {
    sampler: Sampler,
    seed: u64,
    index: u32,
}

impl PixelSamples {
    /// `x` and `y` count in the whole picture, so that a crop changes nothing.
    pub fn new(sampler: Sampler, seed: u64, x: u32, y: u32) -> Self {
        let pixel = u64::from(y) << 32 | u64::from(x);
        Self { sampler, seed: mix(mix(seed) ^ pixel) }
    }

    /// The numbers of sample `index`.
    pub fn sample(&self, index: u32) -> Samples {
        Samples { sampler: self.sampler, seed: self.seed, index }
    }
}

impl Samples {
    /// Place in the pixel, each coordinate from 0 inclusive to 1 exclusive.
    pub fn offset(&self) -> [f64; 2] {
        match self.sampler {
            Sampler::Regular(n) => {
                let centre = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
                [centre(self.index % n), centre(self.index / n)]
            }
            Sampler::Sobol(_) => {
                let [x, y, ..] = self.four(0);
                [x, y]
            }
        }
    }

    /// Four numbers from 0 inclusive to 1 exclusive; the first two are the best spread over the unit square.
    ///
    /// Sobol points are padded with their own first four dimensions under another scramble: Burley 2020, "Practical
    /// Hash-based Owen Scrambling", section 5.
    pub fn four(&self, set: u32) -> [f64; 4] {
        match self.sampler {
            Sampler::Regular(_) => {
                let base = mix(self.seed ^ (u64::from(self.index) << 32 | u64::from(set)));
                // The top 53 bits, as f64 holds them.
                [0, 1, 2, 3].map(|i| (mix(base ^ i) >> 11) as f64 * (0.5 / (1u64 << 52) as f64))
            }
            Sampler::Sobol(_) => {
                let scramble = (mix(self.seed ^ u64::from(set)) >> 32) as u32;
                sobol_burley::sample_4d(self.index, 0, scramble).map(f64::from)
            }
        }
    }
}

/// Scatters the bits of `x`: one step of SplitMix64 (Steele, Lea and Flood 2014, with Vigna's constants).
pub(super) fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ x >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ x >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ x >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitmix_gives_its_published_sequence() {
        // First outputs of the reference implementation for seed 1234567.
        let step = 0x9e37_79b9_7f4a_7c15u64;
        assert_eq!(mix(1_234_567), 6_457_827_717_110_365_317);
        assert_eq!(mix(1_234_567u64.wrapping_add(step)), 3_203_168_211_198_807_973);
    }

    #[test]
    fn regular_samples_are_the_centres_of_the_sub_grid() {
        let pixel = PixelSamples::new(Sampler::Regular(2), 7, 3, 4);
        let offsets: Vec<_> = (0..4).map(|i| pixel.sample(i).offset()).collect();
        assert_eq!(offsets, [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]]);
    }

    #[test]
    fn sobol_samples_fill_every_cell_of_a_pixel_once() {
        let pixel = PixelSamples::new(Sampler::Sobol(64), 1, 10, 20);
        for set in [0, 5] {
            let mut seen = [false; 64];
            for i in 0..64 {
                let [x, y, ..] = pixel.sample(i).four(set);
                let cell = (y * 8.0) as usize * 8 + (x * 8.0) as usize;
                assert!(!std::mem::replace(&mut seen[cell], true), "two points in cell {cell} of set {set}");
            }
        }
    }

    #[test]
    fn numbers_have_the_moments_of_the_uniform_distribution() {
        for sampler in [Sampler::Regular(100), Sampler::Sobol(10_000)] {
            let pixel = PixelSamples::new(sampler, 3, 0, 0);
            let (mut sum, mut square, mut product) = (0.0, 0.0, 0.0);
            for i in 0..10_000 {
                let [a, b, c, d] = pixel.sample(i).four(2);
                assert!([a, b, c, d].iter().all(|v| (0.0..1.0).contains(v)));
                sum += a + b + c + d;
                square += a * a + d * d;
                product += a * c + pixel.sample(i).four(3)[0] * b;
            }
            // Four standard deviations of independent numbers: 4 * sqrt(1/12 / 40000), and alike for the others.
            assert!((sum / 40_000.0 - 0.5).abs() < 0.0058, "{sampler:?} {sum}");
            assert!((square / 20_000.0 - 1.0 / 3.0).abs() < 0.0085, "{sampler:?} {square}");
            assert!((product / 20_000.0 - 0.25).abs() < 0.0063, "{sampler:?} {product}");
        }
    }
}
