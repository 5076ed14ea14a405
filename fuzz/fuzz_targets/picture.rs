//! See [`skipgrid_fuzz::entry::picture`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| skipgrid_fuzz::entry::picture(bytes));
