//! What the targets do with their bytes; the same code runs under `cargo test`.

#[path = "../tests/suite/fuzz/entry.rs"]
pub mod entry;
