//! Scenes from TOML and by name: what is in them, and errors with their place.

use crate::shared;
use glam::{DVec3, Vec2, Vec3};
use skipgrid::scene::{Bsdf, CameraSource, Filter, Light, LoadOptions, Scene, SceneGeometry, SceneParts, load};
use std::path::{Path, PathBuf};

pub fn folder(test: &str) -> PathBuf {
    crate::folder("scenes", test)
}

/// Reads a scene file without options.
pub fn read(path: &Path) -> skipgrid::Result<Scene> {
    load(path.to_str().expect("a UTF-8 path"), &LoadOptions::default())
}

/// Writes `text` to a file and reads it as a scene.
pub fn scene(folder: &Path, name: &str, text: &str) -> skipgrid::Result<Scene> {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("the folder can be written");
    read(&path)
}

/// As [`scene`]; it must be usable.
pub fn expect(folder: &Path, name: &str, text: &str) -> Scene {
    scene(folder, name, text).unwrap_or_else(|e| panic!("{e}"))
}

/// The message of an error that must come, which names the file.
pub fn message(folder: &Path, name: &str, text: &str) -> String {
    let message = scene(folder, name, text).map(|s| s.name).expect_err(text).to_string();
    assert!(message.contains(name), "{message}");
    message
}

/// Corners of triangle `i` of the whole scene.
pub fn corners(scene: &Scene, i: usize) -> [Vec3; 3] {
    match &scene.geometry {
        SceneGeometry::Triangles(t) => t[i],
        SceneGeometry::Mixed(m) => m.triangles[i],
        SceneGeometry::Voxels(v) => skipgrid::Geometry::triangle(v, i as u32).expect("a triangle"),
        SceneGeometry::Spheres(_) | SceneGeometry::Patches(_) => panic!("no triangles"),
    }
}

/// Within 1e-6, which is a few roundings of f32.
pub fn close(a: DVec3, b: DVec3) -> bool {
    (a - b).length() < 1e-6
}

/// A PNG of a white and a black texel.
pub fn checks() -> Vec<u8> {
    let mut png = Vec::new();
    let pixels = image::RgbImage::from_raw(2, 1, vec![255, 255, 255, 0, 0, 0]).expect("six values");
    pixels.write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png).expect("PNG can hold it");
    png
}

const KNOT: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2/1/1 3/1/1\n";

/// The example of the module's documentation, as it stands there.
fn documented_example() -> String {
    let docs = include_str!("../../src/scene/file.rs");
    let lines = docs.lines().map_while(|l| l.strip_prefix("//!"));
    let body = lines.skip_while(|l| l.trim() != "```toml").skip(1).take_while(|l| l.trim() != "```");
    body.map(|l| format!("{}\n", l.strip_prefix(' ').unwrap_or(l))).collect()
}

#[test]
fn the_documented_scene_file_is_read_as_documented() {
    let folder = folder("documented");
    std::fs::write(folder.join("checks.png"), checks()).expect("the folder can be written");
    std::fs::write(folder.join("knot.obj"), KNOT).expect("the folder can be written");
    let s = expect(&folder, "example.toml", &documented_example());
    assert_eq!((s.name.as_str(), s.warnings.len(), s.notes.len()), ("glass", 0, 0));
    assert_eq!((s.camera.origin, s.camera.target), (DVec3::new(0.0, 2.0, 8.0), DVec3::Y));
    assert_eq!((s.camera.yfov, s.camera.source), (40.0, CameraSource::File));
    assert_eq!(s.defaults.size, Some((256, 256)));
    assert_eq!(s.defaults.integrator.as_deref(), Some("whitted"));
    assert_eq!((s.defaults.max_depth, s.defaults.spp), (Some(6), Some(64)));
    let t = &s.textures[0];
    assert_eq!((t.width, t.height, t.filter, t.srgb), (2, 1, Filter::Bilinear, true));
    let names: Vec<_> = s.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["floor", "silver", "crown glass", "gold"]);
    assert_eq!(s.materials[0].bsdf, Bsdf::Lambert { albedo: Vec3::splat(0.5), texture: Some(0) });
    assert_eq!(s.materials[1].bsdf, Bsdf::Mirror { reflectance: Vec3::splat(0.9) });
    assert_eq!(s.materials[2].bsdf, Bsdf::Dielectric { ior: 1.5 });
    let Bsdf::Conductor { eta, alpha, .. } = s.materials[3].bsdf else { panic!("gold is a conductor") };
    assert_eq!((eta, alpha), (Vec3::new(0.143, 0.375, 1.442), 0.1));
    // Depth 3 of the sphereflake: 1 + 9 + 81 + 729 spheres, after the one by hand; moved up by 1.
    assert_eq!((s.spheres.len(), s.triangle_count()), (821, 4));
    assert_eq!((s.spheres[1].centre, s.spheres[1].radius), (Vec3::Y, 0.5));
    assert_eq!((s.sphere_materials[0], s.sphere_materials[1], s.sphere_materials[2]), (2, 1, 0));
    assert!(matches!(s.geometry, SceneGeometry::Mixed(_)));
    // The quad looks up, and its texture stands upright: v is 0, the top row, where the quad's v points.
    let quad = &s.meshes[0];
    assert_eq!(quad.uvs, [Vec2::new(0.0, 4.0), Vec2::new(4.0, 4.0), Vec2::new(4.0, 0.0), Vec2::ZERO]);
    let [a, b, c] = corners(&s, 0);
    assert_eq!((b - a).cross(c - a).normalize(), Vec3::Y);
    // The mesh is turned by 45 degrees about y: its x edge points to (1, 0, -1) / sqrt 2.
    let turned = s.meshes.iter().find(|m| m.name == "mesh 0").expect("the OBJ's mesh");
    assert!((turned.positions[1] - Vec3::new(0.5_f32.sqrt(), 0.0, -0.5_f32.sqrt())).length() < 1e-6);
    assert!((turned.normals[0] - Vec3::new(0.5_f32.sqrt(), 0.0, 0.5_f32.sqrt())).length() < 1e-6);
    let lights = [
        Light::Point { position: DVec3::new(2.0, 5.0, 2.0), intensity: Vec3::splat(40.0) },
        Light::Spot {
            position: DVec3::new(0.0, 6.0, 0.0),
            direction: DVec3::NEG_Y,
            intensity: Vec3::splat(40.0),
            cutoff: 30.0,
            beam_width: 30.0,
        },
    ];
    assert_eq!(s.lights[..2], lights);
    let Light::Directional { direction, .. } = s.lights[2] else { panic!("the third is directional") };
    assert!(close(direction, DVec3::new(-1.0, -2.0, -1.0) / 6.0_f64.sqrt()));
}

#[test]
fn scene_file_errors_name_line_and_cause() {
    let folder = folder("toml-errors");
    for (text, line, cause) in [
        ("name = \"x\"\n\n[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\ncolour = 3\n", 6, "unknown field `colour`"),
        ("[camera\n", 1, ""),
        ("name = \"a\"\n[[sphere]]\ncentre = [0, nan, 0]\nradius = 1\n", 2, "centre"),
        ("[[sphere]]\ncentre = [0, 0, 0]\nradius = 0\n", 1, "radius 0 is not above 0"),
        ("[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\nmaterial = \"gold\"\n", 4, "no material `gold` among []"),
        ("[[sphere]]\ncentre = [0, 0]\nradius = 1\n", 2, "length"),
        ("[[sphere]]\nradius = 1\n", 1, "missing field `centre`"),
        ("[[material]]\nname = \"m\"\ntype = \"mirror\"\nior = 1.5\n", 1, "`ior` does not belong to mirror"),
        ("[[material]]\nname = \"m\"\ntype = \"glossy\"\n", 1, "`glossy` is none of lambert"),
        ("[[material]]\nname = \"m\"\ntype = \"lambert\"\nalbedo = [2, 0, 0]\n", 1, "albedo"),
        ("\n[[material]]\nname = \"m\"\ntype = \"lambert\"\ntexture = \"t\"\n", 5, "no texture `t`"),
        ("[[light]]\ntype = \"spot\"\nposition = [0, 0, 0]\n", 1, "`cutoff` is missing"),
        ("[[light]]\ntype = \"point\"\nposition = [0, 0, 0]\ncutoff = 3\n", 1, "`cutoff` does not belong to point"),
        ("[[light]]\ntype = \"directional\"\ndirection = [0, 0, 0]\nirradiance = [1, 1, 1]\n", 1, "no length"),
        ("[camera]\norigin = [0, 0, 0]\ntarget = [0, 0, 0]\nyfov = 40\n", 1, "span no plane"),
        ("[camera]\norigin = [0, 0, 0]\ntarget = [0, 0, 1]\nyfov = 180\n", 1, "field of view 180"),
        ("[render]\nwidth = 0\n", 1, "width is not within 1"),
        ("[render]\nintegrator = \"magic\"\n", 1, "`magic` is neither"),
        ("[[quad]]\ncorner = [0, 0, 0]\nu = [1, 0, 0]\nv = [2, 0, 0]\n", 1, "span no parallelogram"),
        ("[[triangles]]\npositions = [[0, 0, 0]]\nindices = [[0, 1, 2]]\n", 1, "triangle 0 refers to vertex 1 of 1"),
        ("[[procedural]]\ntype = \"flakes\"\nn = 3\n", 1, "`flakes` takes depth, not `n`"),
        ("[[procedural]]\ntype = \"flake\"\n", 1, "did you mean `flakes`"),
        ("[[procedural]]\ntype = \"flakes\"\nscale = [1, 2, 1]\n", 1, "one positive number"),
        ("[[procedural]]\ntype = \"knot\"\nscale = 0\n", 1, "flatten"),
        ("environment = [-1, 0, 0]\n", 1, "negative"),
    ] {
        let message = message(&folder, "bad.toml", text);
        assert!(message.contains(&format!("bad.toml: line {line}: ")), "{text}\n{message}");
        assert!(message.contains(cause), "{text}\n{message}");
    }
    let missing = scene(&folder, "bad.toml", "[[mesh]]\nfile = \"nowhere.obj\"\n").expect_err("no such file");
    assert!(missing.to_string().contains("nowhere.obj") && missing.exit_code() == 3, "{missing}");
}

#[test]
fn what_a_scene_lacks_is_added_and_said() {
    let folder = folder("defaults");
    let s = expect(&folder, "one.toml", "[[sphere]]\ncentre = [0, 0, 0]\nradius = 1\n");
    assert_eq!((s.name.as_str(), s.camera.source), ("one", CameraSource::Framed));
    assert_eq!(s.materials[0].bsdf, Bsdf::Lambert { albedo: Vec3::splat(0.5), texture: None });
    assert!(s.warnings.is_empty() && s.notes.len() == 1, "{:?}", s.notes);
    // Path tracing a surface of albedo 1 that sees the whole sky and faces the light: radiance 1.
    let Light::Directional { irradiance, .. } = s.lights[0] else { panic!("a directional light") };
    let brightest = s.environment.x + irradiance.x / std::f32::consts::PI;
    assert!((brightest - 1.0).abs() < 1e-6, "{brightest}");
    let lit = expect(&folder, "lit.toml", "environment = [0.5, 0.5, 0.5]\n");
    assert!(lit.lights.is_empty() && lit.notes.is_empty());
    assert!(lit.warnings[0].contains("no primitive") && lit.warnings[0].contains("lit.toml"));
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let mesh = skipgrid::scene::Mesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        ..Default::default()
    };
    let with = |change: fn(&mut skipgrid::scene::Mesh)| {
        let mut mesh = mesh.clone();
        change(&mut mesh);
        Scene::new(SceneParts { name: "s".into(), meshes: vec![mesh], ..SceneParts::default() })
    };
    assert!(with(|_| ()).is_ok());
    for (result, cause) in [
        (with(|m| m.triangles[0][1] = 3), "triangle 0 refers to vertex 3 of 3"),
        (with(|m| m.normals = vec![Vec3::Z; 2]), "2 normals for 3 vertices"),
        (with(|m| m.uvs = vec![Vec2::ZERO; 4]), "4 texture coordinates for 3 vertices"),
        (with(|m| m.material = 1), "material 1 of 1"),
    ] {
        let message = result.expect_err(cause).to_string();
        assert!(message.contains(cause), "{message}");
    }
}

#[test]
fn what_is_no_scene_is_explained() {
    let folder = folder("nothing");
    let text = load(folder.to_str().expect("UTF-8"), &LoadOptions::default()).expect_err("a folder").to_string();
    assert!(text.contains("procedural scenes random, lanes"), "{text}");
    let odd = folder.join("folder.obj");
    std::fs::create_dir(&odd).expect("the folder can be written");
    assert!(read(&odd).expect_err("a folder").to_string().contains("not a regular file"));
    let missing = read(&folder.join("missing.glb")).expect_err("no such file");
    assert!(missing.exit_code() == 3 && missing.to_string().contains("missing.glb"), "{missing}");
}

#[test]
fn bare_primitives_keep_their_indices() {
    let folder = folder("bare");
    let bad = [Vec3::NAN, Vec3::X, Vec3::Y];
    let good = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let path = folder.join("two.tri");
    skipgrid::scene::raw::write_triangles(&path, &[bad, good]).expect("the folder can be written");
    let s = read(&path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!((s.triangle_count(), corners(&s, 1)), (2, good));
    assert!(s.warnings[0].contains("two.tri: 1 primitives are not finite"), "{:?}", s.warnings);
    let ball = |radius| skipgrid::Sphere { centre: Vec3::ONE, radius };
    let path = folder.join("two.sph");
    skipgrid::scene::raw::write_spheres(&path, &[ball(-1.0), ball(2.0)]).expect("the folder can be written");
    let s = read(&path).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(s.spheres, [ball(-1.0), ball(2.0)]);
    assert!(s.warnings[0].contains("two.sph: 1 primitives are not finite"), "{:?}", s.warnings);
}

#[test]
fn the_shared_scenes_have_the_triangles_of_their_list() {
    let Some(folder) = shared("scenes") else { return };
    let list = std::fs::read_to_string(folder.join("SOURCES.md")).expect("the list is beside the scenes");
    let mut read_files = 0;
    for line in list.lines() {
        let cells: Vec<_> = line.split('|').map(str::trim).collect();
        let [_, file, _, triangles, ..] = cells[..] else { continue };
        let Ok(triangles) = triangles.replace(',', "").parse::<u32>() else { continue };
        // Voxels are not read, and a row of the second table has its bytes in this column.
        if !(file.ends_with(".glb") || file.ends_with(".obj")) {
            continue;
        }
        let s = read(&folder.join(file)).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(s.triangle_count(), triangles, "{file}");
        for warning in s.warnings.iter().chain(&s.notes) {
            eprintln!("{warning}");
        }
        read_files += 1;
    }
    assert_eq!(read_files, 14, "the list has 14 glTF and OBJ files");
}
