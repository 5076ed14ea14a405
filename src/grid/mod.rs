//! Uniform grids.
