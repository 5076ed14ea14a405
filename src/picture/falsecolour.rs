//! The difference of two pictures as a picture.

use super::{Picture, metrics, srgb};
use crate::error::Result;

/// Differences from here on are darker than black can show.
pub const LEAST: f64 = 1e-5;
/// Differences from here on are white.
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

/// A colour for each pixel by its largest channel difference over the reference's largest channel (at least 0.1), on a
/// logarithmic scale from [`LEAST`] (black) to [`MOST`] (white).
///
/// # Errors
/// The sizes differ or a pixel is not finite.
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

/// Linear RGB of the ramp at `level`, clamped to 0..1.
pub fn colour(level: f32) -> [f32; 3] {
    let last = RAMP.len() - 2;
    let at = level.clamp(0.0, 1.0) * (last + 1) as f32;
    // at lies in 0..=last + 1.
    let i = (at as usize).min(last);
    let f = at - i as f32;
    [0, 1, 2].map(|c| srgb::decode(f64::from(RAMP[i][c] + f * (RAMP[i + 1][c] - RAMP[i][c]))))
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
