//! Exported scenes say what the scene says.

mod real;
mod seen;

use glam::{DVec3, Vec2, Vec3};
use skipgrid::scene::{
    Bsdf, Camera, CameraSource, ExportSettings, Filter, Light, Material, Mesh, Scene, SceneParts, Texture, mitsuba,
    povray,
};
use skipgrid::{Error, Sphere};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

const SETTINGS: ExportSettings = ExportSettings { width: 48, height: 32, max_depth: 6, lamp_grid: 0 };

fn folder(test: &str) -> PathBuf {
    crate::folder("export", test)
}

fn material(name: &str, bsdf: Bsdf) -> Material {
    Material { name: name.into(), bsdf, emission: Vec3::ZERO }
}

fn lambert(albedo: Vec3) -> Bsdf {
    Bsdf::Lambert { albedo, texture: None }
}

/// A square of side `2 half` at height `y`, front side up; texture coordinates run once over it.
fn square(half: f32, y: f32, material: u32) -> Mesh {
    let corner = |x: f32, z: f32| Vec3::new(x * half, y, z * half);
    Mesh {
        name: "square".into(),
        positions: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: Vec::new(),
        uvs: vec![Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO],
        material,
    }
}

fn scene(meshes: Vec<Mesh>, spheres: Vec<(Sphere, u32)>, materials: Vec<Material>, lights: Vec<Light>) -> Scene {
    let camera = Camera {
        origin: DVec3::new(1.0, 6.0, 9.0),
        target: DVec3::new(0.5, 0.0, 0.0),
        up: DVec3::new(0.1, 1.0, 0.0),
        yfov: 40.0,
        source: CameraSource::File,
    };
    let name = "test".into();
    let parts = SceneParts { name, meshes, spheres, materials, lights, camera: Some(camera), ..SceneParts::default() };
    Scene::new(SceneParts { textures: vec![texels()], ..parts }).expect("a sound scene")
}

/// Six texels, no two alike.
fn texels() -> Texture {
    let texel = |i: u16| Vec3::new(f32::from(i), f32::from(5 - i), 2.5) / 5.0;
    Texture {
        name: "texels".into(),
        width: 3,
        height: 2,
        texels: (0..6).map(texel).collect(),
        srgb: false,
        filter: Filter::Bilinear,
    }
}

/// Every material, light and kind of primitive, with names that would break a careless writer.
fn everything() -> Scene {
    let textured = Bsdf::Lambert { albedo: Vec3::new(0.5, 1.0, 1.0), texture: Some(0) };
    let glowing =
        Material { name: "lamp".into(), bsdf: lambert(Vec3::new(0.0, 0.2, 0.2)), emission: Vec3::new(0.75, 0.5, 0.25) };
    let materials = vec![
        material("--> floor */ \"é\"\n", textured),
        material("silver", Bsdf::Mirror { reflectance: Vec3::splat(0.9) }),
        material("glass", Bsdf::Dielectric { ior: 1.5 }),
        material(
            "gold",
            Bsdf::Conductor {
                eta: Vec3::new(0.143, 0.375, 1.442),
                k: Vec3::new(3.983, 2.386, 1.603),
                reflectance: Vec3::ONE,
                alpha: 0.2,
            },
        ),
        glowing,
    ];
    let lights = vec![
        Light::Point { position: DVec3::new(3.0, 5.0, 2.0), intensity: Vec3::splat(20.0) },
        Light::Spot {
            position: DVec3::new(-3.0, 5.0, 2.0),
            direction: DVec3::NEG_Y,
            intensity: Vec3::new(9.0, 8.0, 7.0),
            cutoff: 30.0,
            beam_width: 20.0,
        },
        Light::Directional { direction: DVec3::new(0.6, -0.8, 0.0), irradiance: Vec3::splat(0.5) },
    ];
    let mut smooth = square(1.0, 0.1, 3);
    smooth.normals = vec![Vec3::Y, Vec3::new(0.6, 0.8, 0.0), Vec3::Y, Vec3::new(0.0, 0.8, 0.6)];
    let ball = |x: f32, material: u32| (Sphere { centre: Vec3::new(x, 0.8, 0.1), radius: 0.7 }, material);
    let mut scene = scene(
        vec![square(4.0, 0.0, 0), smooth, square(0.5, 3.0, 4)],
        vec![ball(-2.0, 1), ball(0.0, 2), ball(2.0, 0)],
        materials,
        lights,
    );
    scene.environment = Vec3::new(0.1, 0.2, 0.3);
    scene
}

fn count(text: &str, word: &str) -> usize {
    text.matches(word).count()
}

/// The numbers between `<` and `>` after the first `keyword`.
fn vector(text: &str, keyword: &str) -> DVec3 {
    let rest = &text[text.find(keyword).expect(keyword)..];
    let inside = &rest[rest.find('<').expect("<") + 1..rest.find('>').expect(">")];
    let numbers: Vec<f64> = inside.split(',').map(|n| n.trim().parse().expect("a number")).collect();
    DVec3::from_slice(&numbers)
}

#[test]
fn povray_text_says_what_the_scene_says() {
    let (scene, out) = (everything(), folder("povray_text").join("all.pov"));
    let warnings = povray::export(&scene, &SETTINGS, &out).expect("exports");
    let text = fs::read_to_string(&out).expect("the file is there");
    assert!(text.is_ascii(), "names are made safe");
    assert!(text.contains("max_trace_level 5 ") && text.contains("assumed_gamma 1.0"), "{text}");
    assert_eq!(vector(&text, "location"), scene.camera.origin);
    let (right, up) = (vector(&text, "right"), vector(&text, "up <"));
    assert!((right.length() / up.length() - 1.5).abs() < 1e-12 && right.dot(up).abs() < 1e-12);
    assert!((up.length() - 2.0 * 20f64.to_radians().tan()).abs() < 1e-12);
    assert_eq!(vector(&text, "background"), scene.environment.as_dvec3());
    assert_eq!((count(&text, "light_source"), count(&text, "mesh2 {")), (3, 3));
    // The glass sphere has a black twin that only stops shadow rays.
    assert_eq!((count(&text, "sphere {"), count(&text, "no_image no_reflection")), (4, 1));
    assert!(text.contains("radius 20 falloff 30 tightness 0"));
    // The light from afar stands outside the scene, against its direction.
    let from = vector(&text[text.rfind("light_source").expect("three lights")..], "light_source");
    let towards = vector(&text[text.rfind("point_at").expect("it has an aim")..], "point_at");
    assert!((towards - from).normalize().distance(DVec3::new(0.6, -0.8, 0.0)) < 1e-6 && from.length() > 8.0);
    let named = |words: &[&str]| warnings.iter().any(|w| words.iter().all(|word| w.contains(word)));
    assert!(named(&["gold", "GGX"]) && named(&["lamp", "emits"]) && named(&["light 1", "30"]), "{warnings:?}");
    assert!(named(&["environment", "lights nothing"]), "{warnings:?}");
    assert_eq!(warnings.len(), 4, "{warnings:?}");
}

#[test]
fn mitsuba_text_says_what_the_scene_says() {
    let (scene, out) = (everything(), folder("mitsuba_text").join("all.xml"));
    let warnings = mitsuba::export(&scene, &SETTINGS, &out).expect("exports");
    let text = fs::read_to_string(&out).expect("the file is there");
    assert_eq!(warnings, Vec::<String>::new());
    assert!(text.is_ascii(), "names are made safe");
    for part in [
        "<integer name=\"max_depth\" value=\"6\"/>",
        "<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"y\"/>",
        "<integer name=\"width\" value=\"48\"/><integer name=\"height\" value=\"32\"/>",
        "<float name=\"int_ior\" value=\"1.5\"/>",
        "<float name=\"cutoff_angle\" value=\"30\"/><float name=\"beam_width\" value=\"20\"/>",
        "<boolean name=\"raw\" value=\"true\"/>",
        "lookat origin=\"1, 6, 9\" target=\"0.5, 0, 0\"",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    for (kind, number) in [("shape type=\"ply\"", 3), ("shape type=\"sphere\"", 3), ("emitter type=\"area\"", 1)] {
        assert_eq!(count(&text, kind), number, "{kind}");
    }
    for kind in ["point", "spot", "directional", "constant"] {
        assert_eq!(count(&text, &format!("emitter type=\"{kind}\"")), 1, "{kind}");
    }
    // The textured sphere has no texture coordinates: it takes the plain form of its material.
    assert_eq!((count(&text, "ref id=\"m0\""), count(&text, "ref id=\"m0-plain\"")), (1, 1));
}

#[test]
fn meshes_and_textures_survive_to_the_bit() {
    let mut scene = everything();
    let odd = [0.1, 1.0 / 3.0, f32::MIN_POSITIVE, 16_777_217.0, -1e-20];
    for (p, &x) in scene.meshes[1].positions.iter_mut().zip(&odd) {
        p.x = x;
    }
    let folder = folder("assets");
    mitsuba::export(&scene, &SETTINGS, &folder.join("a.xml")).expect("exports");
    let bytes = fs::read(folder.join("a-mesh1.ply")).expect("the mesh is there");
    let end = bytes.windows(11).position(|w| w == b"end_header\n").expect("a header") + 11;
    let word = |i: usize| <[u8; 4]>::try_from(&bytes[end + 4 * i..end + 4 * i + 4]).expect("four bytes");
    let mesh = &scene.meshes[1];
    for (i, p) in mesh.positions.iter().enumerate() {
        let uv = mesh.uvs[i];
        let expected =
            [p.to_array().as_slice(), mesh.normals[i].to_array().as_slice(), uv.to_array().as_slice()].concat();
        for (j, x) in expected.into_iter().enumerate() {
            assert_eq!(f32::from_le_bytes(word(8 * i + j)).to_bits(), x.to_bits(), "vertex {i}, property {j}");
        }
    }
    let faces = &bytes[end + 4 * 8 * mesh.positions.len()..];
    assert_eq!(faces.len(), 13 * mesh.triangles.len());
    assert_eq!((faces[0], &faces[1..5], &faces[9..13]), (3, &[0, 0, 0, 0][..], &[2, 0, 0, 0][..]));

    povray::export(&scene, &SETTINGS, &folder.join("a.pov")).expect("exports");
    let text = fs::read_to_string(folder.join("a.pov")).expect("the scene is there");
    let second = &text[text.find("Mesh1 = ").expect("the second mesh")..];
    assert_eq!(vector(second, "vertex_vectors"), mesh.positions[0].as_dvec3());

    // Written once, in linear 16 bits, with the material's factor.
    let written = |ending: &str| {
        let names = fs::read_dir(&folder).expect("a folder").map(|e| e.expect("an entry").file_name());
        names.filter(|n| n.to_string_lossy().ends_with(ending)).count()
    };
    assert_eq!((written(".png"), written(".ply"), written(".part")), (1, 3, 0));
    let picture = image::open(folder.join("a-texture0.png")).expect("a picture").into_rgb16();
    assert_eq!(picture.dimensions(), (3, 2));
    for (pixel, texel) in picture.pixels().zip(&scene.textures[0].texels) {
        for (code, value) in pixel.0.into_iter().zip((*texel * Vec3::new(0.5, 1.0, 1.0)).to_array()) {
            assert!((f64::from(code) / 65535.0 - f64::from(value)).abs() <= 0.5 / 65535.0 + 1e-7);
        }
    }
}

#[test]
fn what_cannot_be_written_is_an_error_or_left_out() {
    let mut bad = everything();
    let folder = folder("bad");
    bad.meshes[1].positions[0].y = f32::NAN;
    bad.spheres[1].radius = f32::INFINITY;
    // A normal that is none: the triangles' own stands for it.
    bad.meshes[2].normals = vec![Vec3::ZERO, Vec3::NAN, Vec3::Y, Vec3::Y];
    for (name, warnings) in [
        ("bad.pov", povray::export(&bad, &SETTINGS, &folder.join("bad.pov")).expect("exports")),
        ("bad.xml", mitsuba::export(&bad, &SETTINGS, &folder.join("bad.xml")).expect("exports")),
    ] {
        let text = fs::read_to_string(folder.join(name)).expect("the file is there").to_lowercase();
        assert!(!text.contains("nan") && !text.contains("inf,"), "{name}");
        assert!(warnings.iter().any(|w| w.contains("2 triangles and 1 spheres")), "{warnings:?}");
    }
    let text = fs::read_to_string(folder.join("bad.pov")).expect("the file is there");
    let normals = &text[text.rfind("normal_vectors").expect("the last mesh is smooth")..];
    assert_eq!(count(&normals[..normals.find('}').expect("its end")], "<0, 1, 0>"), 4);
    let nowhere = folder.join("missing").join("a.pov");
    for result in [povray::export(&bad, &SETTINGS, &nowhere), mitsuba::export(&bad, &SETTINGS, &nowhere)] {
        assert!(matches!(result, Err(Error::Io { .. })), "{result:?}");
    }
    let nothing = ExportSettings { max_depth: 0, ..SETTINGS };
    for result in
        [povray::export(&bad, &nothing, &folder.join("b")), mitsuba::export(&bad, &nothing, &folder.join("b"))]
    {
        let message = result.expect_err("depth 0 shows nothing").to_string();
        assert!(message.contains("depth 0"), "{message}");
    }
    bad.camera.target = bad.camera.origin;
    let message = povray::export(&bad, &SETTINGS, &folder.join("b")).expect_err("no direction").to_string();
    assert!(message.contains("camera"), "{message}");
    assert!(!folder.join("b").exists());
}

/// Runs the command; `None` if there is no such program here.
fn run(command: &mut Command) -> Option<Output> {
    command.output().ok()
}
