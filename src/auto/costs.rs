//! What accelerators cost: nanoseconds of one core for each primitive of a build, and for each ray.
//!
//! Fitted to `skipgrid bench` over its thirty scenes and to `skipgrid compare soup:n=..` and `random:n=..` with 1 to 200
//! primitives (docs/auto.md). Of a ray it takes the mean over camera, shadow and diffuse rays; `a + b n^c` is off by a
//! factor of 1.3 to 1.5 on a single scene, and less between accelerators on the same scene. Ratios matter here, not the
//! machine's speed.

use super::{Estimate, Kind, Look};

/// From this many other primitives in a cell on, uniform grids are not considered.
///
/// Ordinary scenes have 0.5 to 20; a dense object in a wide scene hundreds, where grids take ten to a hundred times as long
/// as the best.
pub(super) const CROWDED: f64 = 50.0;

/// An accelerator that may be chosen.
pub(super) struct Candidate {
    spec: &'static str,
    /// Nanoseconds to build it, and more for each primitive.
    build: [f64; 2],
    /// `a`, `b`, `c` of the nanoseconds for a ray.
    ray: [f64; 3],
    suits: fn(&Look) -> bool,
}

impl Candidate {
    /// Whether it can be built over such a scene and was measured on such.
    pub(super) fn suits(&self, look: &Look) -> bool {
        (self.suits)(look)
    }

    /// Its times for a number of rays.
    pub(super) fn estimate(&self, look: &Look, rays: f64) -> Estimate {
        let (n, [fixed, each], [a, b, c]) = (f64::from(look.primitives), self.build, self.ray);
        Estimate { spec: self.spec, build: 1e-9 * (fixed + each * n), trace: 1e-9 * rays * (a + b * n.powf(c)) }
    }
}

fn even(look: &Look) -> bool {
    look.kind == Kind::Simple && look.crowding <= CROWDED
}

fn simple(look: &Look) -> bool {
    look.kind != Kind::Other
}

fn voxels(look: &Look) -> bool {
    look.kind == Kind::Voxels
}

fn other(look: &Look) -> bool {
    look.kind == Kind::Other
}

/// Two of these at least suit every scene.
pub(super) const CANDIDATES: &[Candidate] = &[
    Candidate { spec: "brute", build: [0.0, 0.0], ray: [25.0, 5.0, 1.0], suits: simple },
    Candidate { spec: "grid:density=0.5", build: [20_000.0, 97.0], ray: [120.0, 1.6, 0.52], suits: even },
    Candidate { spec: "nested:quality=fast", build: [40_000.0, 208.0], ray: [81.0, 4.8, 0.35], suits: simple },
    Candidate { spec: "nested", build: [40_000.0, 271.0], ray: [75.0, 4.4, 0.35], suits: simple },
    #[cfg(feature = "obvhs")]
    Candidate { spec: "obvhs-bvh2:preset=fastest", build: [3_000.0, 115.0], ray: [15.0, 19.0, 0.35], suits: simple },
    // No table: a voxel costs less than a look at its distance.
    Candidate { spec: "voxels", build: [5_000.0, 20.0], ray: [100.0, 13.0, 0.35], suits: voxels },
    // Every test of such primitives is dear, as are those of patches, about 1500 ns here; boxes around single ones spare
    // most of them.
    Candidate { spec: "brute", build: [0.0, 0.0], ray: [0.0, 200.0, 1.0], suits: other },
    #[cfg(feature = "obvhs")]
    Candidate { spec: "obvhs-bvh2:preset=fastest", build: [3_000.0, 115.0], ray: [500.0, 300.0, 0.35], suits: other },
    // Grids of patches keep where their tests begin.
    Candidate { spec: "grid", build: [500_000.0, 15_000.0], ray: [500.0, 500.0, 0.45], suits: other },
    Candidate { spec: "nested", build: [40_000.0, 271.0], ray: [500.0, 600.0, 0.4], suits: other },
];
