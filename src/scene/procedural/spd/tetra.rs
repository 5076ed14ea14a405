//! Tetra: Sierpinski's tetrahedron.

use super::setting::{Setting, surface};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use glam::DVec3;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-tetra",
    summary: "SPD tetra: Sierpinski's tetrahedron of 4096 triangles, mostly background",
    options: "n: size factor, levels (6)",
    slots: "all have slot 0",
    source: "Haines 1987, SPD 3.14 tetra; after Glassner 1984 and Kay & Kajiya 1986",
    keys: &["n"],
    body,
    stage,
};

/// Every other corner of a cube.
const CORNERS: [DVec3; 4] =
    [DVec3::new(-1.0, -1.0, 1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(1.0, -1.0, -1.0), DVec3::new(1.0, 1.0, 1.0)];

fn body(options: &Options) -> Result<Body> {
    let n = options.n(6, 1..=30)?;
    options.limit_size(4_u64.pow(n))?;
    let mut centres = vec![DVec3::ZERO];
    let mut half = 1.0;
    for _ in 1..n {
        half /= 2.0;
        centres = centres.iter().flat_map(|&c| CORNERS.map(|corner| c + half * corner)).collect();
    }
    let mut mesh = Mesh { name: "tetra".into(), ..Mesh::default() };
    for centre in centres {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(CORNERS.map(|corner| (centre + half * corner).as_vec3()));
        let faces = [[0, 1, 2], [3, 2, 1], [2, 3, 0], [1, 0, 3]];
        mesh.triangles.extend(faces.map(|face| face.map(|i| first + i)));
    }
    Ok(Body { meshes: vec![mesh], ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    let setting = Setting {
        from: [1.022846, -3.177154, -2.174512],
        at: [-0.004103, -0.004103, 0.216539],
        up: [-0.816497, -0.816497, 0.816497],
        lights: &[[2.0, -18.0, -5.0]],
        ..Setting::USUAL
    };
    setting.stage(vec![surface("red", [1.0, 0.2, 0.2], 1.0, 0.0)], Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Aabb;
    use glam::Vec3;

    #[test]
    fn counts_bounds_and_volume_are_those_of_the_construction() {
        for n in [1, 2, 3, 6] {
            let meshes = body(&Options { n: Some(n), ..Options::default() }).expect("a usual size").meshes;
            let mesh = &meshes[0];
            assert_eq!(mesh.triangles.len(), 4_usize.pow(n as u32));
            assert_eq!(Aabb::of_points(&mesh.positions), Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
            // The tetrahedron in a cube of edge 2 has a third of its volume; each level halves it.
            let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
            let volume6: f64 = mesh.triangles.iter().map(|&[a, b, c]| corner(a).dot(corner(b).cross(corner(c)))).sum();
            assert!((volume6 / 6.0 - 8.0 / 3.0 / 2_f64.powi(n as i32 - 1)).abs() < 1e-9, "{volume6}");
        }
    }
}
