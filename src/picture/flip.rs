//! FLIP: the perceived difference of two pictures that are shown in alternation.
//!
//! Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild 2020, "FLIP: A Difference Evaluator for
//! Alternating Images", for pictures in a range of 0 to 1; [`hdr`] is for all others. Constants are the paper's; colours as
//! in the authors' own program. Departs from the paper: the chroma filters are applied as separable passes, which gives
//! the same weights.

pub mod hdr;

use super::{Picture, metrics};
use crate::error::{Error, Result};

/// Pixels for each degree of the viewer's field: 3840 pixels over 0.7 m, seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * std::f64::consts::PI / 180.0;

/// Exponent on colour distances (q_c).
const COLOUR_EXPONENT: f64 = 0.7;
/// Share of the largest colour distance (p_c) that is mapped to [`KNEE_VALUE`].
const KNEE: f64 = 0.4;
/// Error at the knee (p_t).
const KNEE_VALUE: f64 = 0.95;
/// Width of edges and points that the eye detects, degrees (w).
const FEATURE_WIDTH: f64 = 0.082;
/// Exponent on feature differences (q_f).
const FEATURE_EXPONENT: f64 = 0.5;
/// Contrast sensitivity: `a sqrt(pi / b) exp(-pi^2 d^2 / b)` at `d` degrees, as (a, b), for achromatic, red-green and
/// blue-yellow contrast; the last has a second term.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The largest of the widths `b` above sets the radius of all filters.
const WIDEST: f64 = 0.04;

/// Bytes for each pixel while two pictures are compared: planes of both before and after each filter.
const PIXEL_BYTES: u64 = 256;
/// Most bytes that a comparison takes: pictures of 2^25 pixels, such as 8192 x 4096.
const MOST_BYTES: u64 = PIXEL_BYTES << 25;

/// XYZ of linear Rec. 709 primaries with the white point D65, rows X, Y, Z.
const RGB_TO_XYZ: [[f64; 3]; 3] = [
    [10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0],
    [2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0],
    [1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0],
];

/// Three planes of one picture, row by row.
type Planes = [Vec<f64>; 3];

/// FLIP error of each pixel, 0 (no difference seen) to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Row by row from the top; `width * height` entries, 0 to 1.
    pub errors: Vec<f32>,
}

impl ErrorMap {
    /// Mean error, 0 to 1; NaN without pixels.
    pub fn mean(&self) -> f64 {
        self.errors.iter().map(|&e| f64::from(e)).sum::<f64>() / self.errors.len() as f64
    }
}

/// Compares `test` with `reference`, both linear RGB and clamped to 0..1, at [`PIXELS_PER_DEGREE`].
///
/// Cost: 256 bytes a pixel while it runs.
///
/// # Errors
/// The sizes differ, the pictures are empty, a pixel is not finite, or there are more than 2^25 pixels.
pub fn compare(test: &Picture, reference: &Picture) -> Result<ErrorMap> {
    check(test, reference)?;
    let size = Size::of(test);
    let [a, b] = [reference, test].map(|p| Seen::new(p.pixels.iter().map(|p| p.map(f64::from)), size));
    Ok(ErrorMap { width: test.width, height: test.height, errors: errors(&a, &b) })
}

/// Refuses pictures that cannot be compared, or that take too much memory.
fn check(test: &Picture, reference: &Picture) -> Result<()> {
    metrics::check(test, reference)?;
    affordable(test.width, test.height)
}

fn affordable(width: u32, height: u32) -> Result<()> {
    let wanted = (u64::from(width) * u64::from(height)).saturating_mul(PIXEL_BYTES);
    if wanted > MOST_BYTES {
        return Err(Error::TooLarge {
            what: format!("FLIP of {width} x {height} pixels"),
            wanted,
            allowed: MOST_BYTES,
        });
    }
    Ok(())
}

/// The error of each pixel.
fn errors(a: &Seen, b: &Seen) -> Vec<f32> {
    let largest = largest_distance();
    let pixels = a.lab.iter().zip(&b.lab).zip(a.features.iter().zip(&b.features));
    let error = |((a_lab, b_lab), (a_feature, b_feature)): ((_, _), (&[f64; 2], &[f64; 2]))| {
        let colour = redistribute(hyab(a_lab, b_lab).powf(COLOUR_EXPONENT), largest);
        let edge = (a_feature[0] - b_feature[0]).abs();
        let point = (a_feature[1] - b_feature[1]).abs();
        let feature = (edge.max(point) / std::f64::consts::SQRT_2).powf(FEATURE_EXPONENT);
        colour.powf(1.0 - feature) as f32
    };
    pixels.map(error).collect()
}

#[derive(Clone, Copy)]
struct Size {
    width: usize,
    height: usize,
}

impl Size {
    fn of(picture: &Picture) -> Self {
        Self { width: picture.width as usize, height: picture.height as usize }
    }
}

/// What the eye makes of one picture.
struct Seen {
    /// Filtered colours in L*a*b*, chroma scaled with lightness (Hunt's effect).
    lab: Vec<[f64; 3]>,
    /// Strength of edges and of points in the lightness.
    features: Vec<[f64; 2]>,
}

impl Seen {
    /// `pixels` are linear RGB, clamped here to 0..1.
    fn new(pixels: impl Iterator<Item = [f64; 3]>, size: Size) -> Self {
        let opponent: Vec<[f64; 3]> = pixels.map(|p| opponent(p.map(|v| v.clamp(0.0, 1.0)))).collect();
        let planes: Planes = [0, 1, 2].map(|c| opponent.iter().map(|p| p[c]).collect());
        let lightness: Vec<f64> = planes[0].iter().map(|y| (y + 16.0) / 116.0).collect();
        let filtered: Planes = [0, 1, 2].map(|c| filter_colour(&planes[c], size, SENSITIVITY[c]));
        let lab = (0..lightness.len()).map(|i| {
            let rgb = from_opponent([filtered[0][i], filtered[1][i], filtered[2][i]]);
            hunt_lab(rgb.map(|v| v.clamp(0.0, 1.0)))
        });
        Self { lab: lab.collect(), features: features(&lightness, size) }
    }
}

/// Weights at -radius..=radius.
fn kernel(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let r = radius as i64;
    (-r..=r).map(|i| weight(i as f64)).collect()
}

fn filter_colour(plane: &[f64], size: Size, terms: &[(f64, f64)]) -> Vec<f64> {
    let pi = std::f64::consts::PI;
    let radius = (3.0 * (WIDEST / (2.0 * pi * pi)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let mut total = 0.0;
    let mut sum = vec![0.0; plane.len()];
    for &(a, b) in terms {
        let line = kernel(radius, |i| (-(pi * i / PIXELS_PER_DEGREE).powi(2) / b).exp());
        let height = a * (pi / b).sqrt();
        total += height * line.iter().sum::<f64>().powi(2);
        let part = convolve(plane, size, &line, &line);
        sum.iter_mut().zip(part).for_each(|(s, p)| *s += height * p);
    }
    sum.iter_mut().for_each(|s| *s /= total);
    sum
}

/// Strength of edges (first derivative) and points (second derivative) at each pixel.
fn features(lightness: &[f64], size: Size) -> Vec<[f64; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as usize;
    let gauss = |i: f64| (-i * i / (2.0 * deviation * deviation)).exp();
    let smooth = normalised(kernel(radius, gauss));
    let edge = normalised(kernel(radius, |i| -i * gauss(i)));
    let point = normalised(kernel(radius, |i| (i * i / (deviation * deviation) - 1.0) * gauss(i)));
    let gradient = |kernel: &[f64]| {
        let x = convolve(lightness, size, kernel, &smooth);
        let y = convolve(lightness, size, &smooth, kernel);
        x.into_iter().zip(y).map(|(x, y)| x.hypot(y))
    };
    gradient(&edge).zip(gradient(&point)).map(|(e, p)| [e, p]).collect()
}

/// Positive weights made to sum to 1, negative ones to -1.
fn normalised(mut kernel: Vec<f64>) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|w| **w < 0.0).sum::<f64>();
    kernel.iter_mut().for_each(|w| *w /= if *w > 0.0 { positive } else { negative.max(f64::MIN_POSITIVE) });
    kernel
}

/// Filters along rows with `horizontal` and along columns with `vertical`; the border pixels continue outside.
fn convolve(plane: &[f64], size: Size, horizontal: &[f64], vertical: &[f64]) -> Vec<f64> {
    let Size { width, height } = size;
    let clamped = |i: usize, k: usize, radius: usize, end: usize| (i + k).saturating_sub(radius).min(end - 1);
    let mut rows = vec![0.0; plane.len()];
    let radius = horizontal.len() / 2;
    for (source, target) in plane.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (x, value) in target.iter_mut().enumerate() {
            *value = horizontal.iter().enumerate().map(|(k, w)| w * source[clamped(x, k, radius, width)]).sum();
        }
    }
    let mut columns = vec![0.0; plane.len()];
    let radius = vertical.len() / 2;
    for (y, target) in columns.chunks_exact_mut(width).enumerate() {
        for (k, w) in vertical.iter().enumerate() {
            let row = clamped(y, k, radius, height) * width;
            target.iter_mut().zip(&rows[row..row + width]).for_each(|(t, s)| *t += w * s);
        }
    }
    columns
}

/// The white point: XYZ of RGB (1, 1, 1).
fn white() -> [f64; 3] {
    RGB_TO_XYZ.map(|row| row.iter().sum())
}

/// XYZ over the white point's.
fn relative_xyz(rgb: [f64; 3]) -> [f64; 3] {
    let white = white();
    [0, 1, 2].map(|i| (0..3).map(|c| RGB_TO_XYZ[i][c] * rgb[c]).sum::<f64>() / white[i])
}

/// YCxCz: L*a*b* without its cube roots, so that filters are linear in light.
fn opponent(rgb: [f64; 3]) -> [f64; 3] {
    let [x, y, z] = relative_xyz(rgb);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let white = glam::DVec3::from(white());
    let xyz = glam::DVec3::new(y + cx / 500.0, y, y - cz / 200.0) * white;
    // Columns of glam's matrix are the rows given here, hence the transposition.
    (glam::DMat3::from_cols_array_2d(&RGB_TO_XYZ).transpose().inverse() * xyz).into()
}

/// CIE L*a*b* with a* and b* multiplied by L* / 100.
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    let delta = 6.0f64 / 29.0;
    let [x, y, z] =
        relative_xyz(rgb).map(|t| if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 });
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// City-block distance in lightness, Euclidean in chroma.
fn hyab(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The largest distance within the gamut, from green to blue.
fn largest_distance() -> f64 {
    hyab(&hunt_lab([0.0, 1.0, 0.0]), &hunt_lab([0.0, 0.0, 1.0])).powf(COLOUR_EXPONENT)
}

/// Maps 0..largest to 0..1, with most of the range for distances below the knee.
fn redistribute(distance: f64, largest: f64) -> f64 {
    let knee = KNEE * largest;
    if distance < knee {
        KNEE_VALUE / knee * distance
    } else {
        KNEE_VALUE + (distance - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_pixels_are_refused_by_their_number_alone() {
        assert!(affordable(8192, 4096).is_ok());
        for (width, height) in [(8193, 4096), (u32::MAX, u32::MAX)] {
            let message = affordable(width, height).expect_err("too large").to_string();
            assert!(message.contains(&format!("FLIP of {width} x {height} pixels")), "{message}");
        }
    }
}
