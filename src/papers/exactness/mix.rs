//! The fixed mix of stiff and ordinary rays that errors are counted on: cases of the stress test's catalogue.

use crate::geometry::Triangle;
use crate::ray::Ray;
use crate::scene::SceneGeometry;
use crate::stress::cases;
use std::sync::Arc;

/// One scene with its rays.
pub(super) struct Case {
    /// Name in the catalogue.
    pub name: &'static str,
    /// False if nothing about it is hard.
    pub stiff: bool,
    /// The scene.
    pub triangles: Arc<Vec<Triangle>>,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// Cases of triangles by name, and whether they are stiff.
const MIX: [(&str, bool); 8] = [
    ("soup", false),
    ("wt_sphere_rand", false),
    ("wt_sphere_vertex", true),
    ("wt_spiky", true),
    ("wt_slivers_1e4", true),
    ("axis_lattice", true),
    ("far_1e6", true),
    ("needles_1e8", true),
];

/// All cases, with `rays` rays each.
pub(super) fn cases(rays: u32) -> Vec<Case> {
    let case = |&(name, stiff): &(&'static str, bool)| {
        let Some(stage) = cases::all().find(|case| case.name == name).map(cases::Case::stage) else {
            unreachable!("the catalogue has {name}")
        };
        let SceneGeometry::Triangles(triangles) = &stage.geometry else { unreachable!("{name} consists of triangles") };
        let rays = (0..u64::from(rays)).map(|i| stage.ray(i)).collect();
        Case { name, stiff, triangles: triangles.clone(), rays }
    };
    MIX.iter().map(case).collect()
}
