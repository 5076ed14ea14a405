//! The stress test: what rounding could break, against exact arithmetic.

pub mod walks;
