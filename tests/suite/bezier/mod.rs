//! Bicubic patches against closed forms, exact arithmetic, tessellations, and each accelerator against brute force.

mod conform;
mod exact;
mod papers;
mod pictures;
mod truth;

use glam::{DVec3, Vec3};
use skipgrid::Accel;
use skipgrid::accel::BruteForce;
use skipgrid::geometry::bezier::ControlPoints;
use skipgrid::geometry::{BezierPatches, Geometry};
use skipgrid::scene::procedural;

/// The control points of the Utah teapot.
fn teapot() -> Vec<ControlPoints> {
    let parts = procedural::parse("teapot-patches").expect("a scene");
    parts.patches.into_iter().map(|(points, _)| points).collect()
}

/// The control points of `(x, y, height)` over the unit square in u and v, where height is a polynomial of degree 2 in each
/// given by its values at 0, 1/2 and 1 through the 9 control values `net`, elevated to degree 3.
fn quadric(net: [[f32; 3]; 3]) -> ControlPoints {
    let elevate = |[a, b, c]: [f32; 3]| [a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c];
    let rows = net.map(elevate);
    let column = |i: usize| elevate([rows[0][i], rows[1][i], rows[2][i]]);
    std::array::from_fn(|j| std::array::from_fn(|i| Vec3::new(i as f32 / 3.0, j as f32 / 3.0, column(i)[j])))
}

fn brute(patches: &BezierPatches) -> Box<dyn Accel + '_> {
    Box::new(BruteForce::new(patches))
}

/// A point of a patch in f64.
fn point(patches: &BezierPatches, prim: u32, u: f64, v: f64) -> DVec3 {
    patches.evaluate(prim, u, v)[0]
}

#[test]
fn sets_are_geometries() {
    let patches = BezierPatches::new(teapot());
    assert_eq!(patches.len(), 32);
    let all = (0..32).map(|p| patches.bounds(p)).fold(skipgrid::Aabb::EMPTY, |a, b| a.union(&b));
    // The pot is 3.15 high; the spout ends and the handle begins where the curves do, within the control points.
    assert!((all.min.y, all.max.y) == (0.0, 3.15), "{all:?}");
    assert!(all.min.x >= -3.0 && all.max.x <= 3.525 && all.extent().x > 6.0, "{all:?}");
}
