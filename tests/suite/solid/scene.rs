//! Scenes of solid voxels: pictures, exports, files, the command line.

use super::voxels;
use crate::scenes::{expect, folder, read};
use crate::shared;
use glam::Vec3;
use skipgrid::geometry::Geometry;
use skipgrid::render::{Integrator, Sampler, Settings, render};
use skipgrid::scene::{ExportSettings, LoadOptions, Material, Scene, SceneGeometry, SceneParts, load, mitsuba, povray};
use skipgrid::{Sphere, registry};
use std::process::Command;

fn made(spec: &str) -> Scene {
    load(spec, &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Small pictures must be the same with all of `accels`, and not black.
pub fn same_pictures(scene: &Scene, accels: &[&str]) {
    for (integrator, spp) in [(Integrator::Path, 2), (Integrator::Whitted, 1)] {
        let sampler = if spp == 1 { Sampler::Regular(1) } else { Sampler::Sobol(spp) };
        let settings = Settings { integrator, sampler, width: 40, height: 30, max_depth: 4, ..Settings::default() };
        let films: Vec<_> = accels
            .iter()
            .map(|name| {
                let accel = scene.accel(name).unwrap_or_else(|e| panic!("{e}"));
                render(scene, &accel, &settings, &|_, _| ()).unwrap_or_else(|e| panic!("{e}"))
            })
            .collect();
        assert!(films[0].sum.iter().any(|s| s.max_element() > 0.0), "{integrator:?} is black");
        for (film, name) in films.iter().zip(accels) {
            assert_eq!(*film, films[0], "{integrator:?} {name}");
        }
    }
}

#[test]
fn pictures_do_not_depend_on_the_accelerator() {
    let scene = made("voxel-terrain:n=24");
    let all: Vec<&str> =
        registry::ENTRIES.iter().filter(|e| e.exact).map(|e| e.name).filter(|&name| name != "brute").collect();
    same_pictures(&scene, &all);
    same_pictures(
        &scene,
        &["voxels", "voxels:step=branchless", "voxels:skip=dsz", "voxels:skip=octant,distances=half"],
    );
}

#[test]
fn a_voxel_that_emits_lights_the_others() {
    // A floor, and a lamp over it; the same as meshes lights as much.
    let set = voxels([7, 5, 7], Vec3::ZERO, 1.0, |[x, y, z]| y == 0 || [x, y, z] == [3, 4, 3]);
    let bytes = set.materials().iter().zip(0..).map(|(&m, i)| if m != 0 && i / 7 % 5 == 4 { 2 } else { m }).collect();
    let set = skipgrid::geometry::SolidVoxels::new([7, 5, 7], bytes, Vec3::ZERO, 1.0).expect("voxels");
    let lamp = Material { emission: Vec3::splat(20.0), ..Material::grey() };
    let parts = SceneParts { voxels: Some(set), materials: vec![Material::grey(), lamp], ..SceneParts::default() };
    let scene = Scene::new(parts).expect("a valid scene");
    assert!(scene.notes.iter().all(|note| !note.contains("no light")), "{:?}", scene.notes);
    let settings = Settings { width: 32, height: 32, sampler: Sampler::Sobol(16), max_depth: 2, ..Settings::default() };
    let mean = |scene: &Scene| {
        let film = render(scene, &scene.accel("grid").expect("small"), &settings, &|_, _| ()).expect("a picture");
        film.sum.iter().map(|s| s.x).sum::<f64>() / film.sum.len() as f64
    };
    let (ours, meshes) = (mean(&scene), mean(&scene.with_meshes()));
    // Faces come in another order, so the noise is another: 1024 pixels of 16 samples.
    assert!(ours > 0.0 && (ours / meshes - 1.0).abs() < 0.05, "{ours} {meshes}");
}

#[test]
fn voxels_become_meshes_where_they_must() {
    let scene = made("voxel-terrain:n=12");
    let SceneGeometry::Voxels(set) = &scene.geometry else { panic!("solid voxels") };
    assert_eq!((scene.triangle_count(), scene.primitive_count()), (Geometry::len(set), Geometry::len(set)));
    let meshes = scene.with_meshes();
    assert_eq!(meshes.triangle_count(), scene.triangle_count());
    assert!(meshes.voxels().is_none() && meshes.meshes.len() > 2);
    // Exporters write these.
    let folder = folder("voxel-export");
    let settings = ExportSettings { width: 16, height: 16, max_depth: 2, ..ExportSettings::default() };
    mitsuba::export(&scene, &settings, &folder.join("v.xml")).expect("the folder can be written");
    let xml = std::fs::read_to_string(folder.join("v.xml")).expect("was written");
    assert_eq!(xml.matches("type=\"ply\"").count(), meshes.meshes.len());
    povray::export(&scene, &settings, &folder.join("v.pov")).expect("the folder can be written");
    let pov = std::fs::read_to_string(folder.join("v.pov")).expect("was written");
    assert_eq!(pov.matches("mesh2 {").count(), meshes.meshes.len());
    // Beside a sphere.
    let ball = (Sphere { centre: Vec3::splat(9.0), radius: 1.0 }, 0);
    let parts = SceneParts { voxels: Some(set.clone()), spheres: vec![ball], ..SceneParts::default() };
    let refused = Scene::new(parts.clone()).expect_err("five materials are in use").to_string();
    assert!(refused.contains("voxels: material 4 of 1"), "{refused}");
    let mixed = Scene::new(SceneParts { materials: scene.materials.clone(), ..parts }).expect("a valid scene");
    assert!(matches!(mixed.geometry, SceneGeometry::Mixed(_)));
    assert_eq!(mixed.primitive_count(), scene.triangle_count() + 1);
    assert!(mixed.notes.iter().any(|note| note.contains("became meshes")), "{:?}", mixed.notes);
    // In a scene file, where they can be moved.
    let text = "[[procedural]]\ntype = \"voxel-terrain\"\nn = 12\nscale = 0.1\n";
    assert_eq!(expect(&folder, "t.toml", text).triangle_count(), scene.triangle_count());
}

#[test]
fn arrays_of_numpy_are_voxels() {
    let folder = folder("voxel-npy");
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (3, 1, 2), }";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend([0, 1, 0, 0, 7, 0]);
    let path = folder.join("a.npy");
    std::fs::write(&path, &bytes).expect("the folder can be written");
    let scene = read(&path).unwrap_or_else(|e| panic!("{e}"));
    let set = scene.voxels().expect("solid voxels");
    assert_eq!((set.resolution(), set.solid_voxels(), scene.triangle_count()), ([3, 1, 2], 2, 24));
    assert!(set.material([0, 0, 1]) == 1 && set.material([2, 0, 0]) == 1);
    std::fs::write(&path, &bytes[..bytes.len() - 1]).expect("the folder can be written");
    let error = read(&path).expect_err("a byte is missing").to_string();
    assert!(error.contains("a.npy: the header promises 6 voxels of a byte, but 5 bytes follow"), "{error}");
}

#[test]
fn the_program_takes_voxels() {
    let folder = folder("voxel-cli");
    let run = |args: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_skipgrid")).args(args).current_dir(&folder).output();
        output.expect("the program starts")
    };
    let json = |args: &[&str]| -> serde_json::Value {
        let output = run(args);
        assert_eq!(output.status.code(), Some(0), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    };
    let info = json(&["info", "voxel-terrain:n=16", "--accel", "voxels:skip=chessboard", "--format", "json"]);
    assert_eq!(info["voxels"], serde_json::json!([16, 8, 16]));
    assert!(info["solid_voxels"].as_u64() > Some(100) && info["triangles"].as_u64() > Some(100), "{info}");
    let built = info["built"].as_str().expect("a line");
    assert!(built.contains("16 x 8 x 16 voxels and a border") && built.contains("chessboard distances"), "{built}");
    let args = ["compare", "voxel-terrain:n=16", "--size", "24x18", "--rounds", "1", "--format", "json"];
    let accels = ["--accel", "grid", "--accel", "voxels", "--accel", "voxels:step=branchless"];
    let compared = json(&[&args[..], &accels].concat());
    assert_eq!(compared["identical"], true);
    // What has no voxels says so.
    let refused = run(&["info", "cornell", "--accel", "voxels"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(refused.status.code() == Some(2) && said.contains("needs a scene of solid voxels"), "{said}");
}

#[cfg(feature = "vox")]
#[test]
fn the_shared_store_is_read_and_renders_alike() {
    let Some(path) = shared("scenes/scene_store8.vox") else { return };
    let scene = read(&path).unwrap_or_else(|e| panic!("{e}"));
    let set = scene.voxels().expect("solid voxels");
    // As the list beside the scene says; z upwards became y.
    assert_eq!((set.solid_voxels(), scene.triangle_count()), (441_118, 121_284));
    assert!(set.resolution().iter().zip([124, 68, 124]).all(|(&n, most)| n <= most), "{:?}", set.resolution());
    assert!(scene.materials.len() > 3, "{}", scene.materials.len());
    let bvh = registry::ENTRIES.iter().map(|e| e.name).find(|&name| name == "obvhs-cwbvh").unwrap_or("grid");
    same_pictures(&scene, &["voxels", "voxels:skip=octant", bvh]);
}
