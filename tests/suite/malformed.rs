//! Malformed input: one clear error, no panic.
