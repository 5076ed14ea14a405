//! See [`skipgrid_fuzz::entry::obj`].
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| skipgrid_fuzz::entry::obj(bytes));
