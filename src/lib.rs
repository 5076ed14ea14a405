//! Grid ray-tracing accelerators that leap over empty space, behind one [`accel::Accel`] trait, next to BVHs that can
//! be swapped for them; exact answers; a path tracer; and a validator against POV-Ray and Mitsuba.

pub mod accel;
#[path = "../adapters/accel/mod.rs"]
pub mod adapters;
pub mod auto;
#[cfg(feature = "cli")]
pub mod bench;
pub mod bsp;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "validate")]
pub mod converge;
pub mod error;
pub mod geometry;
pub mod grid;
#[cfg(feature = "render")]
pub mod measure;
pub mod nested;
#[cfg(feature = "scene")]
mod npy;
#[cfg(feature = "oracle")]
pub mod oracle;
#[cfg(feature = "cli")]
pub mod papers;
mod parallel;
#[cfg(feature = "picture")]
pub mod picture;
#[cfg(any(test, feature = "scene"))]
mod random;
pub mod ray;
pub mod registry;
#[cfg(feature = "render")]
pub mod render;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "shards")]
pub mod shards;
#[cfg(feature = "cli")]
pub mod stress;
#[cfg(feature = "validate")]
pub mod validate;

/// Compiles the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

pub use accel::{Accel, Hit};
pub use error::{Error, Result};
pub use geometry::{Geometry, Sphere, Triangle};
pub use ray::{Aabb, Ray};
