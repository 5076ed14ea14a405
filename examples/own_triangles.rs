//! A grid over triangles of one's own: build it, ask it, see what it holds.

use glam::Vec3;
use skipgrid::{Accel, Ray, Triangle, registry};

/// A paraboloid of `2 n^2` triangles over the square from -1 to 1.
fn bowl(n: u32) -> Vec<Triangle> {
    let corner = |i: u32, j: u32| {
        let [x, y] = [i, j].map(|k| k as f32 / n as f32 * 2.0 - 1.0);
        Vec3::new(x, y, 0.5 * (x * x + y * y))
    };
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    cells
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn main() -> skipgrid::Result<()> {
    let triangles = bowl(100);
    let grid = registry::build("grid:density=4", &triangles)?;
    println!("{} triangles, {} bytes beside them", triangles.len(), grid.memory().total());

    // From above onto the point (0.3, 0.4): the bowl is 0.125 high there.
    let ray = Ray::new(Vec3::new(0.3, 0.4, 5.0), Vec3::NEG_Z);
    let hit = grid.closest_hit(&ray).expect("the bowl lies below");
    println!("hit at t = {}, primitive {}: {:?}", hit.t, hit.prim, triangles[hit.prim as usize]);
    assert!((hit.t - 4.875).abs() < 1e-3);

    // The same question limited to the air above the bowl.
    assert!(!grid.any_hit(&ray.with_range(0.0, 4.0)));
    Ok(())
}
