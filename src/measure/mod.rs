//! Interleaved measurements of several accelerators on the same rays, and the check that their answers are equal.

mod clock;
mod compare;
mod comparison;
mod machine;
pub mod npy;
mod rays;
pub(crate) mod rounds;
mod sweep;
mod swept;

#[cfg(feature = "validate")]
pub(crate) use clock::{process_seconds, wall_seconds};
pub use compare::{Built, Rounds, compare, compare_with, contest};
pub use comparison::{Build, Comparison, Deviations, Difference, Kind, Rate, Row};
pub use machine::Machine;
pub use rays::{Query, RayKind, RayOptions, RaySet, ray_sets};
pub use sweep::{Axis, SweepOptions, matching, sweep};
pub use swept::{Final, Setting, Sweep};
