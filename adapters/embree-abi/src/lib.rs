//! Embree's C interface over any accelerator of skipgrid: what both versions of the library share.
//!
//! Two shared libraries are made of it: `skipgrid-embree3` for programs that load Embree 3, and Mitsuba, whose copy of Embree has
//! C++ names; and `skipgrid-embree4` for Embree 4. Programs load them in Embree's place without a change.
//!
//! - [`device`], [`buffer`], [`geometry`], [`scene`]: what programs describe.
//! - [`part`], [`built`], [`called`]: what a commit makes of it.
//! - [`asked`], [`trace`], [`seen`], [`packets`]: rays.
//! - [`api`]: the functions by name.
//!
//! What is not supported raises a device error that names it; nothing is left out silently.

#![allow(unsafe_code, reason = "a C interface: handles, rays and callbacks are pointers of the caller")]
#![deny(clippy::undocumented_unsafe_blocks)]

pub mod api;
pub mod asked;
pub mod buffer;
pub mod built;
pub mod called;
pub mod device;
pub mod geometry;
pub mod handle;
pub mod interpolate;
pub mod packets;
pub mod part;
pub mod report;
pub mod scene;
pub mod seen;
pub mod trace;
pub mod transform;
pub mod types;
