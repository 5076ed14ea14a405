//! Pictures: linear RGB in f32, files, metrics and statistical comparison.
//!
//! ```
//! use skipgrid::picture::{Picture, flip, io, metrics};
//!
//! let mut ours = Picture::new(4, 3);
//! ours.pixels.fill([0.25, 0.5, 1.0]);
//! let file = std::env::temp_dir().join(format!("skipgrid-picture-{}.exr", std::process::id()));
//! io::write(&file, &ours, &io::Attributes::default().with("renderer", "mine"))?;
//!
//! // EXR keeps every bit.
//! let mut theirs = io::read(&file)?;
//! assert_eq!(metrics::compare(&ours, &theirs)?.max, 0.0);
//! assert_eq!(io::read_attributes(&file)?.get("renderer"), Some("mine"));
//!
//! theirs.pixels[0][1] = 0.25;
//! let metrics = metrics::compare(&ours, &theirs)?;
//! assert_eq!((metrics.max, metrics.max_at, metrics.differing), (0.25, (0, 0), 1.0 / 12.0));
//! assert!(flip::compare(&ours, &theirs)?.mean() > 0.0);
//! # std::fs::remove_file(&file).map_err(|error| skipgrid::Error::io(&file, error))?;
//! # Ok::<(), skipgrid::Error>(())
//! ```

#[cfg(feature = "validate")]
pub mod agreement;
pub mod falsecolour;
pub mod flip;
pub mod io;
pub mod metrics;
pub mod srgb;

/// A picture in linear RGB, rows from the top.
///
/// Values are radiance, of any size: 1 is what a screen shows as white. Negative ones, NaN and infinities can be held;
/// what compares pictures says what it does with them.
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
    /// A black picture. A side of 0 makes one without pixels, which no file takes and nothing compares.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, pixels: vec![[0.0; 3]; width as usize * height as usize] }
    }
}
