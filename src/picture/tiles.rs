//! Statistical and deterministic tests of two pictures.
