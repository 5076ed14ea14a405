//! Every accelerator by name, one line each; parses specifications such as `grid:density=4`.

use crate::accel::{Accel, BruteForce};
use crate::error::{Error, Result};
use crate::geometry::Geometry;

/// What a user may know about an accelerator before building it.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// Name in specifications.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Options with their ranges and defaults, empty if there is none.
    pub options: &'static str,
    /// Where the method comes from.
    pub source: &'static str,
}

/// All accelerators compiled in, in the order of `skipgrid list`.
pub const ENTRIES: &[Entry] =
    &[Entry { name: "brute", summary: "every primitive for every ray", options: "", source: "none needed" }];

/// Builds the accelerator that `spec` names over `geometry`.
///
/// # Errors
/// The name or an option is unknown or out of range, or the structure would exceed its memory budget.
pub fn build<'a, G: Geometry + 'a>(spec: &str, geometry: G) -> Result<Box<dyn Accel + 'a>> {
    match spec {
        "brute" => Ok(Box::new(BruteForce::new(geometry))),
        _ => Err(Error::Spec { spec: spec.into(), cause: "unknown".into() }),
    }
}
