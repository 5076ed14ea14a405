//! Grid ray-tracing accelerators that leap over empty space, behind one trait, [`Accel`], next to BVHs that can be swapped for them; exact
//! answers; a path tracer; and a validator against POV-Ray and Mitsuba.
//!
//! # What a ray hits
//!
//! An accelerator is built over a [`Geometry`], a set of primitives in order: a `Vec` or slice of [`Triangle`]s or [`Sphere`]s, both, or one of
//! your own. It answers with a parameter and an index; what these mean is yours.
//!
//! ```
//! use glam::Vec3;
//! use skipgrid::{Accel, Ray, Triangle, registry};
//!
//! // Two walls across the x axis, at x = 4 and x = 7, in world units.
//! let wall = |x: f32| -> Triangle { [Vec3::new(x, -9.0, -9.0), Vec3::new(x, 9.0, -9.0), Vec3::new(x, 0.0, 9.0)] };
//! let walls = vec![wall(7.0), wall(4.0)];
//!
//! let accel = registry::build("grid-octant", &walls)?;
//! let ray = Ray::new(Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0));
//! let hit = accel.closest_hit(&ray).expect("both walls are ahead");
//! assert_eq!((hit.prim, hit.t), (1, 2.0)); // the second primitive, two lengths of the direction ahead
//!
//! // A shadow ray: is anything between here and x = 3?
//! assert!(!accel.any_hit(&ray.with_range(0.0, 1.5)));
//! # Ok::<(), skipgrid::Error>(())
//! ```
//!
//! # Swapped at run time, or by type
//!
//! ```
//! use glam::Vec3;
//! use skipgrid::grid::{Grid, GridOptions};
//! use skipgrid::{Accel, Ray, Sphere, registry};
//!
//! fn depth<A: Accel + ?Sized>(accel: &A) -> Option<f32> {
//!     accel.closest_hit(&Ray::new(Vec3::ZERO, Vec3::Z)).map(|hit| hit.t)
//! }
//!
//! let ball = [Sphere { centre: Vec3::new(0.0, 0.0, 5.0), radius: 1.0 }];
//! assert_eq!(depth(&Grid::build(&ball[..], &GridOptions::default())?), Some(4.0)); // no virtual call
//! for entry in registry::ENTRIES.iter().filter(|entry| entry.exact && entry.suits(&ball[..])) {
//!     let accel: Box<dyn Accel> = registry::build(entry.name, &ball[..])?; // one virtual call a ray
//!     assert_eq!(depth(&accel), Some(4.0), "{}", entry.name);
//! }
//! # Ok::<(), skipgrid::Error>(())
//! ```
//!
//! # What is promised
//!
//! - **Exact.** Rays and primitives are the bits of their f32. What is hit first is decided as in exact arithmetic; `t` is the exact value,
//!   rounded to f32. At equal `t` the lower index wins. So accelerators can be compared by `==`, and no ray slips through an edge that
//!   two triangles share. [`geometry`] says how, `oracle` checks it with code of its own.
//! - **Any bits.** A ray that is not finite or has no direction hits nothing, a primitive that is not finite is never hit. No query panics or
//!   runs for ever; what can fail (files, options, memory budgets) returns an [`Error`] that names the thing and the place.
//! - **The same everywhere.** Answers and pictures do not depend on the machine, the number of threads or the time.
//!
//! # Where to look
//!
//! | for | see |
//! |---|---|
//! | the trait, the counts of work, memory | [`accel`] |
//! | every accelerator by name, with options as text | [`registry`], and [`auto`] to have one chosen |
//! | voxel walks and skip methods; the walk alone | [`grid`], [`grid::VoxelGrid`] |
//! | Arvo's trees; the fast one of several methods | [`bsp`], [`nested`] |
//! | primitives, their exact tests, primitives of one's own | [`geometry`] |
//! | BVHs of other crates, Embree | [`adapters`] |
//! | scenes, pictures, the path tracer | `scene`, `picture`, `render` |
//! | comparing, benchmarks, error against run time | `measure`, `bench`, `converge` |
//! | pictures of other renderers | `validate` |
//!
//! # Features
//!
//! Default is `cli`, the program and everything that it needs. A tracer that wants accelerators alone takes `default-features = false` and depends on
//! `glam` and `num-bigint`; beside that:
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | builds on all cores, by rayon; the same result |
//! | `obvhs`, `embree`, `bvh`, `parry`, or `peers` for all four | accelerators of others behind the same trait |
//! | `oracle` | exact arithmetic that judges answers |
//! | `picture`, `scene`, `render` | images; scenes; the path tracer, each with those before |
//! | `gltf`, `obj`, `vox` | scene files |
//! | `validate`, `shards` | the validator; pictures in parts |

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
