//! What every renderer can do in the same time.

use crate::picture::Picture;

/// A picture that was to take a given time.
#[derive(Clone, Debug, PartialEq)]
pub struct EqualTime {
    /// The curve's name.
    pub name: String,
    /// Samples a pixel that its cost promises for that time; 0: none, as even the build takes longer, or as the times
    /// that were measured do not tell what a sample takes.
    pub samples: u32,
    /// Seconds that it took, by the clock of its curve, build included.
    pub seconds: f64,
    /// Its mean squared error; NaN without a picture.
    pub mse: f64,
    /// The picture, if there is one.
    pub picture: Option<Picture>,
}

/// The greatest even number that is not above `samples`, at most `most`; 0 below two and for what is no number.
pub(super) fn even(samples: f64, most: u32) -> u32 {
    if samples.is_nan() {
        return 0;
    }
    // Clamped, so that the conversion is exact.
    let whole = samples.clamp(0.0, f64::from(most)) as u32;
    whole - whole % 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_even_and_never_more_than_there_is_time_for() {
        let cases = [(-3.0, 0), (1.9, 0), (2.0, 2), (7.9, 6), (1e9, 64), (f64::INFINITY, 64), (f64::NAN, 0)];
        for (samples, expected) in cases {
            assert_eq!(even(samples, 64), expected, "{samples}");
        }
    }
}
