//! Binary space partitions and octrees, walked as Arvo's note of 1988 has it.
//!
//! J. Arvo, "Linear-time voxel walking for octrees", Ray Tracing News, 1988. An octree is a tree whose planes halve x, y and
//! z in turn, three levels for one of its own; leaves lie at any depth and empty subtrees are NIL. The partitioning walk is
//! in `walk`, one file for each of its listings; the walks from leaf to leaf that it is compared with are in `relocate`.
//! What the walks do that the print does not, and why no hit is lost, stands there.

mod build;
mod choose;
mod frame;
mod interval;
mod midpoint;
mod nodes;
mod options;
mod reference;
mod regular;
mod relocate;
mod segment;
mod tree;
mod walk;

pub use interval::Interval;
pub use midpoint::Midpoint;
pub use options::{BspOptions, Choice};
pub use regular::{Form, Met, Regular};
pub use relocate::{Climb, Retraverse};
pub use segment::Segment;
pub use tree::{AnyPlane, AxisPlane};
pub use walk::Partition;

use crate::accel::{Accel, Hit, LeftOut, Memory, Probe, queries_with_probe, scan_all, scan_any};
use crate::error::{Error, Result};
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray};
use frame::{Frame, Line, Start};
use nodes::{Kept, Nodes, Planes, Shape};
use std::marker::PhantomData;
use walk::{Visit, Walk};

/// A binary space partition over any geometry, which it owns, borrows (`&G`) or shares (`Arc<G>`).
///
/// `P` is what its planes may be: [`AxisPlane`] or [`AnyPlane`]. `W` is how rays find its leaves: [`Partition`] of
/// [`Interval`], [`Segment`] or [`Midpoint`], [`Retraverse`] or [`Climb`].
///
/// Memory: 16 bytes for each node, leaves too, four for each reference from a leaf to a primitive, 32 for each oblique
/// plane.
#[derive(Clone, Debug)]
pub struct Bsp<G, P = AxisPlane, W = Partition<Interval>> {
    geometry: G,
    frame: Frame,
    nodes: Nodes,
    shape: Shape,
    planes: Choice,
    bounds: Aabb,
    left_out: LeftOut,
    form: PhantomData<(P, W)>,
}

impl<G, P, W> Bsp<G, P, W> {
    /// The same tree walked by `V`.
    ///
    /// # Errors
    /// `V` is for trees alone that halve x, y and z in turn, and this is another.
    pub fn with_walk<V: Walk>(self) -> Result<Bsp<G, P, V>> {
        let Self { geometry, frame, nodes, shape, planes, bounds, left_out, .. } = self;
        if V::REGULAR_ONLY && planes != Choice::Midpoint {
            return Err(Error::invalid("this walk is for midpoint planes alone"));
        }
        Ok(Bsp { geometry, frame, nodes, shape, planes, bounds, left_out, form: PhantomData })
    }
}

impl<G: Geometry, P: Planes, W: Walk> Bsp<G, P, W> {
    /// The closest hit, watched by `probe`; `()` watches nothing and costs nothing.
    pub fn closest_hit_with<R: Probe>(&self, ray: &Ray, probe: &mut R) -> Option<Hit> {
        let ray = ray.intake()?;
        let best = match Line::start(&self.frame, &ray) {
            Start::Miss => return None,
            Start::TooFar => scan_all(&self.geometry, &ray, probe),
            Start::Inside(line) => self.trace(false, &ray, &line, probe),
        };
        best.prim().map(|prim| Hit { t: self.geometry.round(&ray, &best), prim })
    }

    /// Whether there is any hit, watched by `probe`.
    pub fn any_hit_with<R: Probe>(&self, ray: &Ray, probe: &mut R) -> bool {
        let Some(ray) = ray.intake() else { return false };
        match Line::start(&self.frame, &ray) {
            Start::Miss => false,
            Start::TooFar => scan_any(&self.geometry, &ray, probe),
            Start::Inside(line) => self.trace(true, &ray, &line, probe).is_hit(),
        }
    }

    /// The winner, or the first hit if `any` will do. Compiled once for both queries: which it is matters where there is a
    /// hit alone.
    #[inline(never)]
    fn trace<R: Probe>(&self, any: bool, ray: &Ray, line: &Line, probe: &mut R) -> Best {
        let prep = self.geometry.prepare(ray);
        let mut lists = Lists { geometry: &self.geometry, ray, prep, any, shift: line.shift, best: Best::NONE, probe };
        W::walk(&Kept::<P>::new(&self.nodes), line, &mut lists);
        lists.best
    }
}

/// Tests the lists of the leaves.
struct Lists<'a, G: Geometry, R> {
    geometry: &'a G,
    ray: &'a Ray,
    prep: G::Prep,
    any: bool,
    /// See [`Line::shift`].
    shift: f64,
    best: Best,
    probe: &'a mut R,
}

impl<G: Geometry, R: Probe> Visit<&[u32]> for Lists<'_, G, R> {
    #[inline(always)]
    fn node(&mut self) {
        self.probe.step();
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Option<&[u32]>) -> f64 {
        self.probe.leaf();
        for &prim in leaf.unwrap_or_default() {
            self.probe.test();
            self.geometry.test(prim, self.ray, &self.prep, &mut self.best);
            if self.any && self.best.is_hit() {
                return f64::NEG_INFINITY;
            }
        }
        // Infinite if there is no winner.
        self.best.upper() - self.shift
    }
}

impl<G: Geometry, P: Planes, W: Walk> Accel for Bsp<G, P, W> {
    queries_with_probe!(closest_hit_with, any_hit_with);

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory(&self) -> Memory {
        let references = size_of_val(&self.nodes.prims[..]) as u64;
        Memory { structure: self.nodes.bytes(), references, tables: 0 }
    }

    fn describe(&self) -> String {
        let Shape { inner, leaves, nil, depth } = self.shape;
        let mut line = format!(
            "{} nodes, {leaves} leaves, {:.1} % of the children NIL, depth {depth}, {:.2} references a leaf",
            inner + leaves,
            100.0 * nil as f64 / (2 * inner).max(1) as f64,
            self.nodes.prims.len() as f64 / leaves.max(1) as f64,
        );
        if !self.nodes.oblique.is_empty() {
            line += &format!(", {} planes across no axis", self.nodes.oblique.len());
        }
        line + &self.left_out.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::Vec3;

    /// Notes the leaves that a walk reaches, by the place of their lists; never satisfied.
    #[derive(Default)]
    struct Trail {
        nodes: usize,
        leaves: Vec<Option<*const u32>>,
    }

    impl Visit<&[u32]> for Trail {
        fn node(&mut self) {
            self.nodes += 1;
        }

        fn leaf(&mut self, leaf: Option<&[u32]>) -> f64 {
            self.leaves.push(leaf.map(<[u32]>::as_ptr));
            f64::INFINITY
        }
    }

    fn soup(random: &mut Random) -> Vec<[Vec3; 3]> {
        // A cloud, and within it a much denser one.
        (0..300)
            .map(|i| {
                let size = [1.0, 0.01][i % 2];
                let place = size * random.unit() * random.direction();
                let mut corner = || (place + 0.05 * size * random.direction()).as_vec3();
                [corner(), corner(), corner()]
            })
            .collect()
    }

    #[test]
    fn all_walks_visit_the_same_leaves_in_the_same_order_at_any_depth() {
        let mut random = Random::new(9);
        let set = soup(&mut random);
        for options in [BspOptions::default(), BspOptions { leaf: 1, depth: Some(60), ..BspOptions::default() }] {
            let tree = Bsp::build(&set, &options).expect("a tree");
            assert!(tree.shape.nil > 20, "{:?}", tree.shape);
            let (mut met, mut empty) = (0, 0);
            for _ in 0..500 {
                let origin = random.direction() * [2.0, 0.02][random.below(2)];
                let ray = Ray::new(origin.as_vec3(), (0.5 * random.unit() * random.direction() - origin).as_vec3());
                let Start::Inside(line) = Line::start(&tree.frame, &ray) else { continue };
                let kept = Kept::<AxisPlane>::new(&tree.nodes);
                let mut trails = [(); 5].map(|()| Trail::default());
                Partition::<Interval>::walk(&kept, &line, &mut trails[0]);
                Partition::<Segment>::walk(&kept, &line, &mut trails[1]);
                Partition::<Midpoint>::walk(&kept, &line, &mut trails[2]);
                Retraverse::walk(&kept, &line, &mut trails[3]);
                Climb::walk(&kept, &line, &mut trails[4]);
                for (i, trail) in trails.iter().enumerate() {
                    assert_eq!(trail.leaves, trails[0].leaves, "walk {i}: {ray:?}");
                    // Partitioning enters no node twice, and no other walk fewer.
                    assert!(trail.nodes >= trails[0].nodes && (i > 2 || trail.nodes == trails[0].nodes), "{i}");
                }
                met += trails[0].leaves.len();
                empty += trails[0].leaves.iter().filter(|leaf| leaf.is_none()).count();
            }
            assert!(met > 2000 && empty > 50, "{met} leaves, {empty} of them NIL");
        }
    }

    #[test]
    fn only_a_ray_from_beyond_all_measure_is_tested_against_all() {
        let set = soup(&mut Random::new(10));
        let tree = Bsp::build(&set, &BspOptions::default()).expect("a tree");
        let target = set[0][0] * 0.4 + set[0][1] * 0.3 + set[0][2] * 0.3;
        for (far, all) in [(1e3, false), (1e5, false), (1e8, false), (1e13, false), (1e18, true)] {
            let origin = target - Vec3::X * far;
            let mut counts = crate::accel::Counts::default();
            // Of no length that a few bits hold.
            let hit = tree.closest_hit_counted(&Ray::new(origin, 0.7 * Vec3::X), &mut counts);
            assert_eq!(hit, crate::accel::BruteForce::new(&set).closest_hit(&Ray::new(origin, 0.7 * Vec3::X)), "{far}");
            assert_eq!((counts.steps == 0, counts.tests == 300), (all, all), "{far}: {counts:?}");
        }
    }

    #[test]
    fn a_small_sphere_beside_a_huge_one_is_found() {
        let sphere = |centre: [f32; 3], radius| crate::geometry::Sphere { centre: Vec3::from(centre), radius };
        let set = vec![
            sphere([-0.999_999_9, 2.0, 1.0], f32::from_bits(0x67c4_160c)),
            sphere([-1.0, 0.0, -2.0], 3.5),
            sphere([1.0, 3.5, 2.0], f32::from_bits(0x40b5_b99e)),
        ];
        let bits = [0x3fb5_5555, 0x3f95_5556, 0x406a_aaaa].map(f32::from_bits);
        let ray = Ray::new(Vec3::new(-1.0, 0.0, -2.0), Vec3::from(bits)).with_range(1.0, f32::MAX);
        let tree = Bsp::build(&set, &BspOptions::default()).expect("a tree");
        let hit = tree.closest_hit(&ray);
        assert_eq!(hit, crate::accel::BruteForce::new(&set).closest_hit(&ray));
        assert_eq!(hit.map(|hit| hit.prim), Some(2));
    }

    #[test]
    fn walks_for_halves_refuse_other_planes() {
        let set = soup(&mut Random::new(11));
        let options = BspOptions { planes: Choice::Sah, ..BspOptions::default() };
        let tree = Bsp::build(&set, &options).expect("a tree");
        assert!(tree.clone().with_walk::<Partition<Segment>>().is_ok());
        assert!(tree.clone().with_walk::<Partition<Midpoint>>().is_err());
        assert!(tree.clone().with_walk::<Retraverse>().is_err() && tree.with_walk::<Climb>().is_err());
        let oblique = BspOptions { planes: Choice::Oblique, ..BspOptions::default() };
        assert!(Bsp::build(&set, &oblique).is_err() && Bsp::build_oblique(&set, &oblique).is_ok());
    }
}
