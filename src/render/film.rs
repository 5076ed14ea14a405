//! Sums and sums of squares for each pixel.

use crate::picture::Picture;
use glam::DVec3;

/// The samples of all pixels, summed.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples for each pixel.
    pub samples: u32,
    /// Sum of the samples, row by row from the top, linear RGB.
    pub sum: Vec<DVec3>,
    /// Sum of the squares of the samples.
    pub sum_squares: Vec<DVec3>,
}

impl Film {
    /// The mean of the samples.
    pub fn picture(&self) -> Picture {
        unimplemented!()
    }
}
