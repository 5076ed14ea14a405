//! Triangles and spheres in one scene, where they touch: ties between an exact quotient and a root.

use super::draw::{in_box, in_cube, inwards, pick, sign, unit, whole, zero};
use super::shapes::{Mesh, mixed};
use super::{Case, Stage};
use crate::geometry::{Sphere, Triangle};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new(
        "mixed_tangent_plane",
        "spheres that rest on the quads of a plane, rays at the points where they touch",
        |_| resting(),
    ),
    Case::new(
        "mixed_kissing",
        "spheres of radius 1/2 at whole numbers, that touch each other, and quads between them",
        |_| kissing(),
    ),
    Case::new("mixed_edges", "triangles whose corners and edges touch spheres, rays at those points", edges),
    Case::new("mixed_inscribed", "bumpy meshes with corners on spheres, rays at the corners", inscribed),
    Case::new("mixed_soup", "500 random triangles through 100 random spheres, rays where they cross", crossing),
];

/// The quad of side 2 about `centre` across the axis `k`.
fn quad(centre: Vec3, k: usize) -> [Triangle; 2] {
    let at = |u: f32, v: f32| {
        let mut p = centre;
        p[(k + 1) % 3] += u;
        p[(k + 2) % 3] += v;
        p
    };
    let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    [[a, b, c], [a, c, d]]
}

fn resting() -> Stage {
    let places: Vec<Vec3> = (0..64).map(|i| Vec3::new((i % 8) as f32, (i / 8) as f32, 0.0)).collect();
    // Radii with few bits: the lowest point of each sphere has z = 0 exactly.
    let radius = |i: usize| [0.5, 0.25, 0.375, 1.0 / 1024.0][i % 4];
    let ball = |(i, p): (usize, &Vec3)| Sphere { centre: *p + Vec3::Z * radius(i), radius: radius(i) };
    let balls = places.iter().enumerate().map(ball).collect();
    let list = (0..16).flat_map(|i| quad(Vec3::new((2 * (i % 4)) as f32, (2 * (i / 4)) as f32, 0.0), 2)).collect();
    let shoot = move |random: &mut Random| {
        let touch = pick(random, &places);
        let origin = match random.below(4) {
            0 => touch - Vec3::Z * whole(random, 1, 8),
            1 => touch + Vec3::new(whole(random, -8, 8), whole(random, -8, 8), -whole(random, 1, 8)),
            2 => touch + (in_cube(random) * 8.0).with_z(-random.within(0.5, 8.0) as f32),
            // Within the plane: the triangles are not hit, the spheres are touched.
            _ => touch + (in_cube(random) * 8.0).with_z(0.0),
        };
        Ray::new(origin, touch - origin)
    };
    Stage::new(mixed(list, balls), shoot, |random| inwards(random, Vec3::new(3.5, 3.5, 0.0), 8.0))
}

fn kissing() -> Stage {
    let grid = |n: i32| Vec3::new((n % 4) as f32, (n / 4 % 4) as f32, (n / 16) as f32);
    let balls = (0..64).map(|n| Sphere { centre: grid(n), radius: 0.5 }).collect();
    // Quads in the planes in which neighbours touch.
    let list = (0..16).flat_map(|i| {
        let mut centre = Vec3::splat((i / 3 % 3) as f32 + 0.5);
        centre[(i + 1) % 3] = (i % 4) as f32;
        quad(centre, i % 3)
    });
    let shoot = |random: &mut Random| {
        let (k, mut touch) = (random.below(3), Vec3::from([(); 3].map(|()| whole(random, 0, 3))));
        touch[k] += 0.5 * sign(random);
        let mut direction = match random.below(4) {
            0 => Vec3::new(whole(random, -3, 3), whole(random, -3, 3), whole(random, -3, 3)),
            1 => unit(random),
            _ => Vec3::new(zero(random), zero(random), zero(random)),
        };
        if random.below(2) == 0 {
            // Within the plane of contact: a tangent of both.
            direction[k] = zero(random);
        }
        if direction == Vec3::ZERO {
            direction[random.below(3)] = sign(random);
        }
        Ray::new(touch - direction * whole(random, 1, 5), direction)
    };
    Stage::new(mixed(list.collect(), balls), shoot, |random| inwards(random, Vec3::splat(1.5), 5.0))
}

fn edges(random: &mut Random) -> Stage {
    let (mut list, mut balls, mut touches) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..60 {
        let centre = Vec3::from([(); 3].map(|()| whole(random, 0, 20)));
        let radius = whole(random, 1, 16) / 16.0;
        let (k, side) = (random.below(3), sign(random));
        let mut touch = centre;
        touch[k] += side * radius;
        // An edge through the point, across the radius: a tangent. The third corner lies beyond it.
        let mut along = Vec3::new(whole(random, -4, 4), whole(random, -4, 4), whole(random, -4, 4));
        along[k] = 0.0;
        let mut beyond = touch;
        beyond[k] += side;
        list.push([touch - along, touch + along, beyond]);
        // A corner on the sphere.
        list.push([touch, touch + in_cube(random), touch + in_cube(random)]);
        balls.push(Sphere { centre, radius });
        touches.push(touch);
    }
    let shoot = move |random: &mut Random| {
        let touch = pick(random, &touches);
        let origin = match random.below(3) {
            0 => touch + Vec3::from([(); 3].map(|()| whole(random, -8, 8))),
            1 => touch + super::draw::axis(random) * whole(random, 1, 8),
            _ => touch + in_cube(random) * 8.0,
        };
        let direction = touch - origin;
        Ray::new(origin, if direction == Vec3::ZERO { Vec3::ONE } else { direction })
    };
    Stage::new(mixed(list, balls), shoot, |random| inwards(random, Vec3::splat(10.0), 22.0))
}

fn inscribed(random: &mut Random) -> Stage {
    let (mut list, mut balls, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..4 {
        let (centre, radius) = (in_box(random, 0.0, 10.0), random.within(0.5, 2.0) as f32);
        let mesh = Mesh::sphere(8, 12, centre.as_dvec3(), || f64::from(radius));
        list.extend(mesh.triangles());
        balls.push(Sphere { centre, radius });
        meshes.push(mesh);
    }
    let shoot = move |random: &mut Random| {
        let target = meshes[random.below(4)].corner(random);
        let origin = in_box(random, -5.0, 15.0);
        Ray::new(origin, target - origin)
    };
    Stage::new(mixed(list, balls), shoot, |random| inwards(random, Vec3::splat(5.0), 14.0))
}

fn crossing(random: &mut Random) -> Stage {
    let list = super::shapes::soup(random, 500);
    let balls: Vec<Sphere> = (0..100)
        .map(|_| Sphere { centre: in_box(random, 0.0, 10.0), radius: random.within(0.2, 1.5) as f32 })
        .collect();
    let targets: Vec<Vec3> =
        (0..2000).filter_map(|_| on_both(pick(random, &list), pick(random, &balls), random.unit())).collect();
    let shoot = move |random: &mut Random| {
        let target = if targets.is_empty() { Vec3::splat(5.0) } else { pick(random, &targets) };
        let origin = Vec3::splat(5.0) + unit(random) * 15.0;
        Ray::new(origin, target - origin)
    };
    Stage::new(mixed(list, balls), shoot, |random| inwards(random, super::shapes::SOUP.0, super::shapes::SOUP.1))
}

/// Where the segment between a corner and a point of the opposite edge leaves the sphere, if it does.
fn on_both([a, b, c]: Triangle, ball: Sphere, s: f64) -> Option<Vec3> {
    let [a, b, c, centre] = [a, b, c, ball.centre].map(|p| p.as_dvec3());
    let d: DVec3 = b + s * (c - b) - a;
    let (f, r) = (a - centre, f64::from(ball.radius));
    let (half, power) = (f.dot(d) / d.length_squared(), (f.length_squared() - r * r) / d.length_squared());
    let t = -half + (half * half - power).sqrt();
    (0.0..=1.0).contains(&t).then(|| (a + t * d).as_vec3())
}
