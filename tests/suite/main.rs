//! One test program: behaviour through the public interface.
mod cli;
mod conformance;
mod export;
mod malformed;
mod pictures;
mod random;
mod render;
mod scenes;
mod tidy;
mod truth;
mod validate;
