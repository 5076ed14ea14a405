//! Interleaved measurements of several accelerators on the same rays.
