//! Random scenes and rays that are likely to be hard: small, in few numbers, through each other's corners.

use glam::Vec3;
use proptest::prelude::*;
use skipgrid::geometry::Mixed;
use skipgrid::scene::SceneGeometry;
use skipgrid::{Ray, Sphere, Triangle};
use std::sync::Arc;

/// A scene, the rays through it, and which accelerators are asked.
#[derive(Clone, Debug)]
pub struct Case {
    pub kind: Kind,
    pub triangles: Vec<Triangle>,
    pub spheres: Vec<Sphere>,
    pub rays: Vec<Ray>,
    /// Chooses among the specifications.
    pub choice: usize,
}

/// What a scene consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Triangles,
    Spheres,
    Mixed,
}

impl Case {
    pub fn geometry(&self) -> SceneGeometry {
        let (triangles, spheres) = (self.triangles.clone(), self.spheres.clone());
        match self.kind {
            Kind::Triangles => SceneGeometry::Triangles(Arc::new(triangles)),
            Kind::Spheres => SceneGeometry::Spheres(Arc::new(spheres)),
            Kind::Mixed => SceneGeometry::Mixed(Arc::new(Mixed { triangles, spheres })),
        }
    }
}

/// Numbers, the simplest first: that is where shrinking goes. All are finite.
fn number() -> impl Strategy<Value = f32> {
    let sign = |x: f32, negative: bool| if negative { -x } else { x };
    prop_oneof![
        8 => (-3i8..=3).prop_map(f32::from),
        3 => (-16i8..=16).prop_map(|n| f32::from(n) / 4.0),
        2 => any::<bool>().prop_map(move |negative| sign(0.0, negative)),
        2 => (-3i32..=3, any::<bool>()).prop_map(move |(ulps, negative)| {
            sign(f32::from_bits(1f32.to_bits().wrapping_add_signed(ulps)), negative)
        }),
        4 => -1f32..1.0,
        1 => (-60i32..60, any::<bool>()).prop_map(move |(power, negative)| sign(2f32.powi(power), negative)),
        1 => (0u32..5, any::<bool>()).prop_map(move |(bits, negative)| sign(f32::from_bits(bits), negative)),
        1 => any::<u32>().prop_map(f32::from_bits).prop_filter("finite", |x| x.is_finite()),
    ]
}

fn vector() -> impl Strategy<Value = Vec3> {
    [number(), number(), number()].prop_map(Vec3::from)
}

/// Spheres may be points; `least` is the least radius.
fn sphere(points: Vec<Vec3>, least: f32) -> impl Strategy<Value = Sphere> {
    let radius = prop_oneof![
        3 => (0u8..=8).prop_map(|n| f32::from(n) / 2.0),
        2 => number().prop_map(f32::abs),
    ];
    // Around one point, with any radius or so that another point is nearly on it.
    (any::<usize>(), any::<usize>(), any::<bool>(), radius).prop_map(move |(at, through, free, radius)| {
        let centre = points[at % points.len()];
        let distance = centre.distance(points[through % points.len()]);
        let radius = if free || !distance.is_finite() { radius } else { distance };
        Sphere { centre, radius: radius.max(least) }
    })
}

/// Rays from points or beside them, towards points, the middles of edges and of triangles, along axes and diagonals.
fn ray(points: Vec<Vec3>) -> impl Strategy<Value = Ray> {
    let pick = move |i: usize| points[i % points.len()];
    let origin = prop_oneof![
        2 => vector().prop_map(|v| (None, v)),
        1 => (any::<usize>(), vector()).prop_map(|(i, v)| (Some(i), v)),
    ];
    let axes = [-1i8, 0, 1].map(f32::from);
    let aim = (0u8..7, any::<[usize; 3]>(), vector());
    let length = prop_oneof![4 => Just(0), 1 => -20i32..20, 1 => -130i32..120];
    let bounds = prop_oneof![
        4 => Just((0.0, f32::INFINITY)),
        1 => Just((f32::NEG_INFINITY, f32::INFINITY)),
        1 => (number(), number()).prop_map(|(a, b)| (a.min(b), a.max(b))),
        1 => number().prop_map(|t| (t, t)),
        1 => Just((0.0, 1.0)),
        1 => Just((1.0, f32::MAX)),
    ];
    (origin, aim, length, bounds).prop_map(move |((at, offset), (aim, corners, free), length, (t_min, t_max))| {
        // At a point, or within rounding of a line through it.
        let origin = at.map_or(offset, |i| pick(i) + [Vec3::ZERO, offset][i % 2]);
        let [a, b, c] = corners.map(&pick);
        let direction = match aim {
            0 => free,
            1 => a - origin,
            2 => (a * 0.5 + b * 0.5) - origin,
            3 => (a + b + c) / 3.0 - origin,
            4 => a - b,
            5 => Vec3::from(corners.map(|i| axes[i % 3])),
            _ => {
                let mut d = Vec3::from(corners.map(|i| [0.0, -0.0][i % 2]));
                d[corners[0] % 3] = axes[2 * (corners[1] % 2)];
                d
            }
        };
        // Not finite in rare cases: those hit nothing.
        Ray::new(origin, direction * 2f32.powi(length)).with_range(t_min, t_max)
    })
}

/// Scenes of a kind with rays through them.
pub fn case(kind: Kind) -> impl Strategy<Value = Case> {
    let scale = prop_oneof![6 => Just(0), 1 => -70i32..60];
    let points = (prop::collection::vec(vector(), 3..9), scale).prop_map(|(points, power)| {
        let finite = |p: Vec3| p.clamp(Vec3::splat(-f32::MAX), Vec3::splat(f32::MAX));
        points.into_iter().map(|p| finite(p * 2f32.powi(power))).collect::<Vec<_>>()
    });
    points.prop_flat_map(move |points| {
        let (most_triangles, most_spheres) = match kind {
            Kind::Triangles => (10, 0),
            Kind::Spheres => (0, 7),
            Kind::Mixed => (5, 4),
        };
        let corners = points.clone();
        let triangle = any::<[usize; 3]>().prop_map(move |at| at.map(|i| corners[i % corners.len()]));
        // Scene files of both kinds have no sphere that is a point.
        let least = if kind == Kind::Mixed { f32::from_bits(1) } else { 0.0 };
        let spheres = prop::collection::vec(sphere(points.clone(), least), 0..=most_spheres);
        let triangles = prop::collection::vec(triangle, 0..=most_triangles);
        let rays = prop::collection::vec(ray(points), 1..6);
        (triangles, spheres, rays, any::<usize>()).prop_map(move |(triangles, spheres, rays, choice)| {
            let mut case = Case { kind, triangles, spheres, rays, choice };
            // A scene of both has at least one of each.
            if kind == Kind::Mixed && case.triangles.is_empty() {
                case.triangles.push([Vec3::ZERO, Vec3::X, Vec3::Y]);
            }
            if kind == Kind::Mixed && case.spheres.is_empty() {
                case.spheres.push(Sphere { centre: Vec3::ZERO, radius: 1.0 });
            }
            case
        })
    })
}
