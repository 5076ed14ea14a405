//! The stress test: every accelerator on the catalogue of hard cases, against exact arithmetic.
//!
//! [`cases`] has the scenes and rays, [`run`] asks the accelerators and judges their answers by the oracle, [`Study`] is
//! what came out. [`walks`] looks at the voxels that walks visit.

mod ask;
pub mod cases;
mod contender;
mod html;
mod judge;
mod report;
mod run;
mod time;
pub mod walks;

pub use contender::{Contender, contenders, spelled_out};
pub use html::page;
pub use judge::{Fault, Tally};
pub use report::{CaseResult, Outcome, Row, Study, Verdict, WalkResult};
pub use run::{Options, run};
pub use time::Times;
