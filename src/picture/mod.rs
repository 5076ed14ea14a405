//! Pictures: linear RGB in f32, files, metrics and statistical comparison.

pub mod falsecolour;
pub mod flip;
pub mod io;
pub mod metrics;
pub mod srgb;
#[cfg(feature = "validate")]
pub mod tiles;

/// A picture in linear RGB, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB, row by row from the top; `width * height` entries.
    pub pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// A black picture.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }
}
