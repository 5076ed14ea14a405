//! Tree: branches that fork in two, after Aono and Kunii, on a field far larger than the tree.

use super::super::icosphere;
use super::super::patch::append;
use super::setting::{Setting, surface};
use super::tube::{End, tube};
use super::{Body, Entry, Mesh, Options, Stage, quad};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::{DAffine3, DQuat, DVec3};

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-tree",
    summary: "SPD tree: 4095 cones and 4095 spheres on a field of side 100; z up",
    options: "n: size factor, times that a branch forks (11); sides of a cone (16); balls: triangles instead of spheres, halvings \
              of an icosahedron's edges",
    slots: "all have slot 0",
    source: "Haines 1987, SPD 3.14 tree; after Aono & Kunii 1984",
    keys: &["n", "sides", "balls"],
    body,
    stage,
};

/// Angle from the parent's direction and angle about it, degrees, and length as a share of the parent's.
const FORKS: [[f64; 3]; 2] = [[40.0, 90.0, 0.65], [25.0, 230.0, 0.70]];
/// Radius of the trunk's foot; its length is 1.
const GIRTH: f64 = 0.15;
/// Radius of a branch's tip, and of the foot of the next, as a share of the radius of its foot.
const TAPER: f64 = 0.67;

fn body(options: &Options) -> Result<Body> {
    let (n, sides, halvings) = (options.n(11, 1..=40)?, options.sides()?, options.balls()?);
    let ball = halvings.map_or(1, icosphere::triangles);
    options.limit_size(((2_u64 << n) - 1).saturating_mul(ball + 2 * u64::from(sides)) + 2)?;
    let forks = FORKS.map(|[branch, divergence, contraction]| {
        let turn = DQuat::from_rotation_z(divergence.to_radians()) * DQuat::from_rotation_x(branch.to_radians());
        DAffine3::from_scale_rotation_translation(DVec3::splat(contraction), turn, DVec3::Z)
    });
    let mut branches = Mesh { name: "branches".into(), ..Mesh::default() };
    let mut spheres = Vec::new();
    let mut radius = GIRTH;
    // Frames of the branches of a level, from (0, 0, 0) to (0, 0, 1) each.
    let mut level = vec![DAffine3::IDENTITY];
    for depth in 0..=n {
        for frame in &level {
            let base = End { centre: frame.translation, radius };
            let apex = End { centre: frame.transform_point3(DVec3::Z), radius: TAPER * radius };
            append(&mut branches, tube(base, apex, sides));
            spheres.push((Sphere { centre: apex.centre.as_vec3(), radius: apex.radius as f32 }, 0));
        }
        radius *= TAPER;
        if depth < n {
            level = level.iter().flat_map(|&frame| forks.map(|fork| frame * fork)).collect();
        }
    }
    let Some(halvings) = halvings else {
        return Ok(Body { meshes: vec![branches], spheres, ..Body::default() });
    };
    let (unit, mut balls) = (icosphere::unit(halvings), Mesh { name: "joints".into(), ..Mesh::default() });
    spheres.iter().for_each(|(sphere, _)| append(&mut balls, icosphere::placed(&unit, sphere)));
    Ok(Body { meshes: vec![branches, balls], ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    let setting = Setting {
        from: [4.5, 0.4, 2.0],
        at: [0.0, 0.0, 1.5],
        lights: &[
            [-5.0, 5.0, 50.0],
            [30.0, -30.0, 30.0],
            [-40.0, -30.0, 20.0],
            [10.0, 30.0, 40.0],
            [-30.0, 40.0, 10.0],
            [50.0, 25.0, 20.0],
            [-10.0, -60.0, 30.0],
        ],
        ..Setting::USUAL
    };
    let field = quad("field", [[50.0, 50.0, 0.0], [-50.0, 50.0, 0.0], [-50.0, -50.0, 0.0], [50.0, -50.0, 0.0]]);
    let field = (field, surface("field", [0.2, 0.7, 0.2], 1.0, 0.0));
    setting.stage(vec![surface("wood", [0.55, 0.4, 0.2], 1.0, 0.0)], vec![field])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_sums() {
        let made = body(&Options::default()).expect("the standard size");
        assert_eq!((made.spheres.len(), made.meshes[0].triangles.len()), (4095, 4095 * 32));
        let (mut z, mut r) = (0.0, 0.0);
        for (sphere, _) in &made.spheres {
            z += f64::from(sphere.centre.z);
            r += f64::from(sphere.radius);
        }
        assert!((z - 10060.588).abs() < 1e-3 && (r - 9.6115).abs() < 1e-4, "{z} {r}");
        let top = made.spheres.iter().map(|(s, _)| s.centre.z + s.radius).fold(f32::MIN, f32::max);
        assert!((top - 3.1375).abs() < 1e-4, "{top}");
    }
}
