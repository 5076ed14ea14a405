//! Where two pictures differ, as pictures of their size: tiles by standard deviations, pixels by the limits.

use super::deterministic::{ONE_PERCENT, TENTH_PERCENT, is_off};
use super::statistical::{Estimate, TILE, each_tile, unusable};
use crate::error::{Error, Result};
use crate::picture::{Picture, falsecolour, metrics};

/// Standard deviations from which on [`z_map`] has its strongest colours.
pub const MAP_Z: f64 = 4.0;

/// A colour for each tile of [`super::statistical`] by the standard deviations between the means over all channels, see
/// [`falsecolour::diverging`]: blue where ours is darker, red where it is brighter, strongest from [`MAP_Z`] on.
///
/// # Errors
/// The estimates cannot be compared: the reason is that of the verdict.
pub fn z_map(test: Estimate, reference: Estimate) -> Result<Picture> {
    if let Some(reason) = unusable(&test, &reference) {
        return Err(Error::invalid(reason));
    }
    let (width, height) = (test.mean.width, test.mean.height);
    let mut map = Picture::new(width, height);
    each_tile(&test, &reference, |(x, y), tile| {
        let colour = falsecolour::diverging((tile.z() / MAP_Z) as f32);
        for row in y..(y + TILE as u32).min(height) {
            let start = row as usize * width as usize;
            map.pixels[start + x as usize..start + (x as usize + TILE).min(width as usize)].fill(colour);
        }
    });
    Ok(map)
}

/// A colour for each pixel by what [`super::deterministic`] counts: [`falsecolour::LIMITS`] for those within 0.1 %, above it,
/// and above 1 %.
///
/// # Errors
/// The sizes differ, the pictures are empty, or a pixel is not finite.
pub fn above_limits(test: &Picture, reference: &Picture) -> Result<Picture> {
    metrics::check(test, reference)?;
    let pixels = test.pixels.iter().zip(&reference.pixels).map(|(a, b)| {
        let (a, b) = (a.map(f64::from), b.map(f64::from));
        let limits = [TENTH_PERCENT, ONE_PERCENT];
        falsecolour::limit(limits.into_iter().filter(|&share| is_off(a, b, share)).count())
    });
    Ok(Picture { width: test.width, height: test.height, pixels: pixels.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_have_the_colour_of_their_deviation() {
        // Variance 1 for each pixel and 64 pixels: a tile's mean has a standard deviation of 1 / 8 on each side.
        let reference = Picture { width: 20, height: 9, pixels: vec![[10.0; 3]; 180] };
        let variance = Picture { pixels: vec![[1.0; 3]; 180], ..reference.clone() };
        let mut ours = reference.clone();
        for row in 0..8 {
            ours.pixels[row * 20..row * 20 + 8].fill([10.5; 3]);
            ours.pixels[row * 20 + 8..row * 20 + 16].fill([9.0; 3]);
        }
        let of = |mean| Estimate { mean, variance: &variance, replicates: u32::MAX };
        let map = z_map(of(&ours), of(&reference)).expect("comparable");
        let standard_error = |mean: f64| (2.0 / 64.0 + (5e-4 * mean).powi(2)).sqrt();
        for (at, z) in
            [(0, 0.5 / standard_error(10.0)), (8, -1.0 / standard_error(10.0)), (16, 0.0), (8 * 20 + 19, 0.0)]
        {
            let expected = falsecolour::diverging((z / MAP_Z) as f32);
            let near = (0..3).all(|c| (map.pixels[at][c] - expected[c]).abs() < 1e-3);
            assert!(near, "pixel {at}: {:?}, expected {expected:?}", map.pixels[at]);
        }
        assert_eq!((map.pixels[7], map.pixels[7 * 20 + 7]), (map.pixels[0], map.pixels[0]));
        let small = Picture::new(3, 3);
        let bad = z_map(of(&small), of(&reference)).expect_err("another size");
        assert!(bad.to_string().contains("3 x 3"), "{bad}");
    }

    #[test]
    fn pixels_have_the_colour_of_the_limit_they_exceed() {
        let reference = Picture { width: 4, height: 1, pixels: vec![[0.5; 3]; 4] };
        let mut ours = reference.clone();
        for (pixel, off) in ours.pixels.iter_mut().zip([0.0f32, 0.0004, 0.004, 0.04]) {
            pixel[1] += off;
        }
        let map = above_limits(&ours, &reference).expect("comparable");
        assert_eq!(map.pixels, [0, 0, 1, 2].map(falsecolour::limit));
        assert!(above_limits(&ours, &Picture::new(3, 1)).is_err());
    }
}
