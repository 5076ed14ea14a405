//! Numbers as colours: differences, deviations to either side, limits exceeded, counts.

use super::{Picture, metrics, srgb};
use crate::error::Result;

/// Relative differences up to this are black.
pub const LEAST: f64 = 1e-5;
/// Relative differences from this on are white.
pub const MOST: f64 = 1.0;
/// Pixels of the reference darker than this are taken as this bright.
const DARK: f64 = 0.1;

/// Colours in sRGB from no difference to [`MOST`]; lightness rises all the way, so that they are right in grey too.
const RAMP: [[f32; 3]; 7] = [
    [0.0, 0.0, 0.0],
    [0.16, 0.05, 0.38],
    [0.47, 0.11, 0.43],
    [0.76, 0.22, 0.33],
    [0.95, 0.47, 0.13],
    [0.98, 0.78, 0.20],
    [1.0, 1.0, 1.0],
];

/// Colours in sRGB from far below to far above: lightness falls to either side.
const SIDES: [[f32; 3]; 5] =
    [[0.13, 0.30, 0.60], [0.50, 0.69, 0.86], [0.95, 0.95, 0.94], [0.93, 0.61, 0.50], [0.65, 0.09, 0.15]];

/// Colours in sRGB (0 to 1) of pixels within all limits, above the lower and above the higher.
pub const LIMITS: [[f32; 3]; 3] = [[0.16, 0.18, 0.22], [0.98, 0.72, 0.20], [1.0, 0.25, 0.25]];

/// A colour for each pixel by its largest channel difference over the reference's largest channel (at least 0.1), on a
/// logarithmic scale from [`LEAST`] (black) to [`MOST`] (white). Linear RGB.
///
/// # Errors
/// The sizes differ, the pictures are empty, or a pixel is not finite.
pub fn difference(test: &Picture, reference: &Picture) -> Result<Picture> {
    metrics::check(test, reference)?;
    let pixels = test.pixels.iter().zip(&reference.pixels).map(|(a, b)| {
        let largest = (0..3).map(|c| (f64::from(a[c]) - f64::from(b[c])).abs()).fold(0.0, f64::max);
        let bright = b.iter().map(|&v| f64::from(v)).fold(DARK, f64::max);
        let level = (largest / bright / LEAST).max(1.0).log10() / (MOST / LEAST).log10();
        colour(level as f32)
    });
    Ok(Picture { width: test.width, height: test.height, pixels: pixels.collect() })
}

/// A colour for each pixel by this channel (0 to 2), a count: black at 0, white at `most` (at least 1) and above, linear in
/// `ln(1 + count)`. Counts below 0 and NaN are black.
pub fn counts(picture: &Picture, channel: usize, most: f32) -> Picture {
    let whole = most.max(1.0).ln_1p();
    let pixels = picture.pixels.iter().map(|p| colour(p[channel].max(0.0).ln_1p() / whole));
    Picture { width: picture.width, height: picture.height, pixels: pixels.collect() }
}

/// Linear RGB of the ramp from black to white at `level`, clamped to 0..1; NaN gives NaN.
pub fn colour(level: f32) -> [f32; 3] {
    between(&RAMP, level)
}

/// Linear RGB for a deviation clamped to -1..1: blue below 0, near white at 0, red above; NaN gives NaN.
pub fn diverging(deviation: f32) -> [f32; 3] {
    between(&SIDES, 0.5 + 0.5 * deviation)
}

/// Linear RGB for the number of limits that a pixel exceeds, 2 or more being the most: [`LIMITS`].
pub fn limit(exceeded: usize) -> [f32; 3] {
    LIMITS[exceeded.min(2)].map(|v| srgb::decode(f64::from(v)))
}

/// Linear RGB at `level`, clamped to 0..1, of sRGB colours that are evenly spaced.
fn between(ramp: &[[f32; 3]], level: f32) -> [f32; 3] {
    let last = ramp.len() - 2;
    let at = level.clamp(0.0, 1.0) * (last + 1) as f32;
    // at lies in 0..=last + 1.
    let i = (at as usize).min(last);
    let f = at - i as f32;
    [0, 1, 2].map(|c| srgb::decode(f64::from(ramp[i][c] + f * (ramp[i + 1][c] - ramp[i][c]))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ramp_rises_from_black_to_white() {
        assert_eq!((colour(0.0), colour(1.0), colour(7.0)), ([0.0; 3], [1.0; 3], [1.0; 3]));
        let luminance = |i: u16| {
            let [r, g, b] = colour(f32::from(i) / 100.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..100).all(|i| luminance(i) < luminance(i + 1)));
    }

    #[test]
    fn sides_darken_away_from_the_middle() {
        let luminance = |i: i16| {
            let [r, g, b] = diverging(f32::from(i) / 100.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..100).all(|i| luminance(i) > luminance(i + 1) && luminance(-i) > luminance(-i - 1)));
        let [low, high] = [diverging(-1.0), diverging(1.0)];
        assert!(low[2] > low[0] && high[0] > high[2] && diverging(9.0) == high);
    }

    #[test]
    fn counts_are_on_one_scale() {
        let picture = Picture { width: 4, height: 1, pixels: [0.0, 9.0, 99.0, 1e9].map(|n| [7.0, n, 7.0]).to_vec() };
        let map = counts(&picture, 1, 99.0);
        let half = colour(0.5);
        assert_eq!((map.pixels[0], map.pixels[2], map.pixels[3]), ([0.0; 3], [1.0; 3], [1.0; 3]));
        assert!((0..3).all(|c| (map.pixels[1][c] - half[c]).abs() < 1e-5), "{:?}", map.pixels[1]);
        assert_eq!(counts(&Picture::new(2, 2), 0, 0.0), Picture::new(2, 2));
    }

    #[test]
    fn decades_are_evenly_spaced() {
        let reference = Picture { width: 3, height: 1, pixels: vec![[1.0; 3]; 3] };
        let mut test = reference.clone();
        test.pixels[1][2] = 1.01;
        test.pixels[2][0] = 3.0;
        let map = difference(&test, &reference).expect("comparable");
        assert_eq!((map.pixels[0], map.pixels[2]), ([0.0; 3], [1.0; 3]));
        // A hundredth is three of the five decades.
        let expected = colour(0.6);
        assert!((0..3).all(|c| (map.pixels[1][c] - expected[c]).abs() < 1e-5), "{:?}", map.pixels[1]);
    }
}
