//! Chooses an accelerator for a scene and a number of rays, and says what it leaves out and why.
//!
//! A structure is worth building if it saves more on the rays than it costs. So the choice is the least of estimated times,
//! build and rays together: `costs` has the estimates, from measurements, and [`Look`] what they depend on. A wrong
//! estimate costs time, never an answer: all that can be chosen gives the same bits.

mod costs;
mod look;

pub use look::{Kind, Look};

use crate::geometry::Geometry;
use costs::CANDIDATES;

/// Rays to expect where nobody says: a picture of 512 x 512 pixels, a sample each, with a ray to a light.
pub const USUAL_RAYS: f64 = 524_288.0;

/// What is estimated of an accelerator, in seconds of one core.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Specification for the registry.
    pub spec: &'static str,
    /// To build it.
    pub build: f64,
    /// To send the rays through it.
    pub trace: f64,
}

impl Estimate {
    /// Build and rays.
    pub fn total(&self) -> f64 {
        self.build + self.trace
    }
}

/// What was chosen, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// What the scene is like.
    pub look: Look,
    /// The number of rays that was reckoned with, as given.
    pub rays: f64,
    /// All that could be chosen, the best first; two at least.
    pub estimates: Vec<Estimate>,
}

impl Choice {
    /// Specification of the best, for the registry.
    pub fn spec(&self) -> &'static str {
        self.estimates[0].spec
    }

    /// One sentence for people: the choice, the numbers that led to it, and the gain that is expected over the next.
    pub fn reason(&self) -> String {
        let [best, next] = [&self.estimates[0], &self.estimates[1]];
        let Look { primitives, empty, .. } = self.look;
        format!(
            "{} for {primitives} primitives and {:.2e} rays, {:.0} % of a coarse grid empty: estimated {} to build and {} of rays; {} would \
             take {:.2} times as long",
            best.spec,
            self.rays,
            100.0 * empty,
            seconds(best.build),
            seconds(best.trace),
            next.spec,
            next.total() / best.total()
        )
    }

    /// What was left out: every other accelerator with its estimate, and parts that the chosen one does without; one sentence each.
    pub fn left_out(&self) -> Vec<String> {
        let best = self.estimates[0].total();
        let mut sentences: Vec<String> = self
            .estimates
            .iter()
            .skip(1)
            .map(|e| {
                let (build, trace, times) = (seconds(e.build), seconds(e.trace), e.total() / best);
                format!("{}: {build} to build and {trace} of rays, {times:.2} times as long", e.spec)
            })
            .collect();
        if self.look.crowding > costs::CROWDED {
            let crowding = self.look.crowding;
            sentences.push(format!(
                "uniform grids: primitives are crowded, with {crowding:.0} others in a cell (up to {:.0} pay)",
                costs::CROWDED
            ));
        }
        let spec = self.spec();
        if !spec.starts_with("grid-") && !spec.starts_with("nested") {
            sentences.push(format!(
                "skip table: {spec} has none, and {:.0} % of a coarse grid is empty",
                100.0 * self.look.empty
            ));
        }
        if !spec.starts_with("grid") {
            let cells = self.look.cells_each;
            sentences.push(format!(
                "mailbox: only uniform grids list a primitive in many cells, here in {cells:.1} if there were two for each"
            ));
        }
        sentences
    }
}

/// Chooses for `geometry` and a number of rays, finite and from 0; [`USUAL_RAYS`] where nobody says. Looks at 16 384
/// primitives at most.
///
/// This is what the name `auto` of [`registry::build`](crate::registry::build) does;
/// [`registry::choose`](crate::registry::choose) says what it would. With a NaN or a number below 0 there is a choice too,
/// but without meaning.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::{auto, registry};
///
/// let row: Vec<_> = (0..5000).map(|i| [Vec3::ZERO, Vec3::Y, Vec3::Z].map(|p| p + Vec3::X * i as f32)).collect();
/// let [few, many] = [1.0, 1e9].map(|rays| auto::choose(&row, rays));
/// assert_eq!(few.spec(), "brute");
/// assert!(many.estimates[0].trace < few.estimates[0].trace * 1e9);
/// println!("{}", many.reason());
/// let accel = registry::build(many.spec(), &row)?;
/// # assert!(accel.bounds().max.x == 4999.0);
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn choose<G: Geometry + ?Sized>(geometry: &G, rays: f64) -> Choice {
    let look = Look::at(geometry);
    let possible = CANDIDATES.iter().filter(|candidate| candidate.suits(&look));
    let mut estimates: Vec<Estimate> = possible.map(|candidate| candidate.estimate(&look, rays)).collect();
    estimates.sort_by(|a, b| a.total().total_cmp(&b.total()));
    Choice { look, rays, estimates }
}

/// A time for people.
fn seconds(s: f64) -> String {
    match s {
        s if s < 1e-3 => format!("{:.1} us", s * 1e6),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Triangle;
    use crate::geometry::tests::Random;
    use glam::Vec3;

    fn soup(count: usize, size: f32) -> Vec<Triangle> {
        Random::new(5).soup(count, size)
    }

    #[test]
    fn a_handful_is_not_worth_a_structure_and_more_rays_are_worth_a_better_one() {
        assert_eq!(choose(&soup(3, 0.5), 1e6).spec(), "brute");
        let many = soup(200_000, 0.01);
        assert_eq!(choose(&many, 1.0).spec(), "brute");
        assert_eq!(choose(&many, 1e5).spec(), "nested:quality=fast");
        assert_eq!(choose(&many, 1e8).spec(), "nested");
        let builds: Vec<f64> = [1.0, 1e4, 1e5, 1e8].map(|rays| choose(&many, rays).estimates[0].build).to_vec();
        assert!(builds.is_sorted(), "{builds:?}");
    }

    #[test]
    fn uniform_grids_are_left_out_where_a_small_object_is_crowded() {
        let mut triangles = soup(30_000, 0.02);
        let even = choose(&triangles, 1e4);
        assert!(even.estimates.iter().any(|e| e.spec.starts_with("grid")), "{even:?}");
        triangles.push([Vec3::splat(-1e4), Vec3::splat(1e4), Vec3::new(1e4, 0.0, -1e4)]);
        let crowded = choose(&triangles, 1e4);
        assert!(!crowded.estimates.iter().any(|e| e.spec.starts_with("grid")), "{crowded:?}");
        assert!(crowded.left_out().iter().any(|s| s.starts_with("uniform grids")));
    }
}
