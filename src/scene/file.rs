//! Scene files in TOML.
