//! Exported scenes say what the scene says, and the other renderers see what the laws of light ask for.

mod real;

use glam::{DVec3, Vec2, Vec3};
use skipgrid::scene::{
    Bsdf, Camera, CameraSource, ExportSettings, Filter, Light, Material, Mesh, Scene, SceneParts, Texture, mitsuba,
    povray,
};
use skipgrid::{Error, Sphere};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const SETTINGS: ExportSettings = ExportSettings { width: 48, height: 32, max_depth: 6, lamp_grid: 0 };

/// An empty folder below `target/`, one for each test.
fn folder(test: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("export").join(test);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder below target/");
    path
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

/// POV-Ray's picture, linear RGB at pixel centres; `None` without POV-Ray.
fn povray_picture(scene: &Scene, folder: &Path) -> Option<Vec<[f64; 3]>> {
    povray::export(scene, &SETTINGS, &folder.join("s.pov")).expect("exports");
    let (w, h) = (format!("+W{}", SETTINGS.width), format!("+H{}", SETTINGS.height));
    let options = ["+Is.pov", "+Os.ppm", "+FP16", "File_Gamma=1.0", "-D", "-A", "-GA", "+WT1", &w, &h];
    let Some(output) = run(Command::new("povray").args(options).current_dir(folder)) else {
        eprintln!("skipped: povray is not installed");
        return None;
    };
    assert!(output.status.success(), "povray: {}", String::from_utf8_lossy(&output.stderr));
    let bytes = fs::read(folder.join("s.ppm")).expect("POV-Ray wrote the picture");
    let (pixels, bytes) = ((SETTINGS.width * SETTINGS.height) as usize, bytes.as_slice());
    let codes: Vec<f64> = bytes[bytes.len() - pixels * 6..]
        .chunks_exact(2)
        .map(|c| f64::from(u16::from_be_bytes([c[0], c[1]])) / 65535.0)
        .collect();
    Some(codes.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

/// Mitsuba's picture, linear RGB; `None` without Mitsuba.
fn mitsuba_picture(scene: &Scene, folder: &Path) -> Option<Vec<[f64; 3]>> {
    mitsuba::export(scene, &SETTINGS, &folder.join("s.xml")).expect("exports");
    if !run(Command::new("python3").args(["-c", "import mitsuba, numpy"])).is_some_and(|o| o.status.success()) {
        eprintln!("skipped: mitsuba is not installed");
        return None;
    }
    let script = "import mitsuba as mi, numpy as np\nmi.set_variant('scalar_rgb')\n\
                  np.array(mi.render(mi.load_file('s.xml', spp='16', seed='1'))).astype('<f4').tofile('s.raw')";
    let output = run(Command::new("python3").args(["-c", script]).current_dir(folder)).expect("python3 is there");
    assert!(output.status.success(), "mitsuba: {}", String::from_utf8_lossy(&output.stderr));
    let bytes = fs::read(folder.join("s.raw")).expect("Mitsuba wrote the picture");
    let values = bytes.chunks_exact(4).map(|c| f64::from(f32::from_le_bytes([c[0], c[1], c[2], c[3]])));
    let values: Vec<f64> = values.collect();
    assert_eq!(values.len(), (SETTINGS.width * SETTINGS.height * 3) as usize);
    Some(values.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect())
}

/// A floor that fills the picture, under a point light, a wide spot and light from afar.
fn lit_floor(scale: f64) -> Scene {
    let lights = vec![
        Light::Point { position: DVec3::new(2.0, 4.0, 1.0) * scale, intensity: Vec3::new(9.0, 6.0, 3.0) },
        Light::Spot {
            position: DVec3::new(-1.0, 5.0, 0.0) * scale,
            direction: DVec3::NEG_Y,
            intensity: Vec3::new(2.0, 4.0, 8.0),
            cutoff: 85.0,
            beam_width: 85.0,
        },
        Light::Directional { direction: DVec3::new(0.6, -0.8, 0.0), irradiance: Vec3::new(0.4, 0.5, 0.6) },
    ];
    let floor = material("floor", lambert(Vec3::new(0.8, 0.6, 0.4)));
    let mut scene = scene(vec![square(50.0 * scale as f32, 0.0, 0)], Vec::new(), vec![floor], lights);
    scene.camera.origin *= scale;
    scene.camera.target *= scale;
    scene
}

/// Direct light of [`lit_floor`] by the laws: `albedo / pi (I cos / d^2 + E cos)`.
fn lit_floor_radiance(scene: &Scene, pixel: usize) -> DVec3 {
    let (x, y) = (pixel % SETTINGS.width as usize, pixel / SETTINGS.width as usize);
    let direction = scene.camera.direction(x as f64 + 0.5, y as f64 + 0.5, SETTINGS.width, SETTINGS.height);
    let point = scene.camera.origin - direction * (scene.camera.origin.y / direction.y);
    let light = |l: &Light| match l {
        Light::Point { position, intensity } | Light::Spot { position, intensity, .. } => {
            let to = *position - point;
            intensity.as_dvec3() * to.y / to.length().powi(3)
        }
        Light::Directional { direction, irradiance } => irradiance.as_dvec3() * -direction.y,
    };
    DVec3::new(0.8, 0.6, 0.4) / std::f64::consts::PI * scene.lights.iter().map(light).sum::<DVec3>()
}

#[test]
fn povray_shades_the_exported_floor_by_the_laws() {
    for (name, scale) in [("floor", 1.0), ("floor_tiny", 1.0 / 256.0)] {
        let mut scene = lit_floor(scale);
        for light in &mut scene.lights {
            if let Light::Point { intensity, .. } | Light::Spot { intensity, .. } = light {
                *intensity *= (scale * scale) as f32;
            }
        }
        let Some(picture) = povray_picture(&scene, &folder(name)) else { return };
        for (i, pixel) in picture.into_iter().enumerate() {
            let expected = lit_floor_radiance(&scene, i);
            // Rounded to 16 bits, and light colours are kept in f32.
            let bound = 1.0 / 65535.0 + 1e-6;
            assert!((DVec3::from(pixel) - expected).abs().max_element() < bound, "pixel {i}: {pixel:?}, {expected}");
        }
    }
}

#[test]
fn mitsuba_shades_the_exported_floor_by_the_laws() {
    let all = lit_floor(1.0);
    // One light at a time: Mitsuba picks one for each sample, which is noise.
    for (i, light) in all.lights.iter().enumerate() {
        let scene = Scene { lights: vec![*light], ..all.clone() };
        let Some(picture) = mitsuba_picture(&scene, &folder(&format!("floor_mitsuba{i}"))) else { return };
        let [mut seen, mut due] = [DVec3::ZERO; 2];
        for (i, pixel) in picture.into_iter().map(DVec3::from).enumerate() {
            let expected = lit_floor_radiance(&scene, i);
            // 16 random points of a pixel over which the light varies.
            let bound = expected * 0.05 + 2e-3;
            assert!((pixel - expected).abs().cmple(bound).all(), "pixel {i}: {pixel}, {expected}");
            seen += pixel;
            due += expected;
        }
        assert!((seen / due - 1.0).abs().max_element() < 1e-3, "light {i}: {}", seen / due);
    }
}

/// Bilinear between texel centres at (i + 0.5) / size, repeated.
fn bilinear(texture: &Texture, u: f64, v: f64) -> DVec3 {
    let (x, y) = (u * f64::from(texture.width) - 0.5, v * f64::from(texture.height) - 0.5);
    let texel = |x: f64, y: f64| {
        let (w, h) = (f64::from(texture.width), f64::from(texture.height));
        texture.texels[y.rem_euclid(h) as usize * texture.width as usize + x.rem_euclid(w) as usize].as_dvec3()
    };
    let (left, top) = (x.floor(), y.floor());
    let row = |y: f64| texel(left, y).lerp(texel(left + 1.0, y), x - left);
    row(top).lerp(row(top + 1.0), y - top)
}

#[test]
fn textures_lie_as_they_do_here() {
    for (name, srgb, factor) in [("linear", false, Vec3::new(0.5, 1.0, 0.75)), ("srgb", true, Vec3::ONE)] {
        let mut scene = everything();
        scene.environment = Vec3::ZERO;
        scene.meshes.truncate(1);
        scene.spheres.clear();
        scene.meshes[0] = square(40.0, 0.0, 0);
        // Texture coordinates run from -2 to 3: the texture repeats, and not about 0.
        scene.meshes[0].uvs.iter_mut().for_each(|uv| *uv = *uv * 5.0 - 2.0);
        scene.materials[0] = material("floor", Bsdf::Lambert { albedo: factor, texture: Some(0) });
        scene.lights = vec![Light::Directional { direction: DVec3::NEG_Y, irradiance: Vec3::splat(3.0) }];
        let texture = &mut scene.textures[0];
        texture.srgb = srgb;
        if srgb {
            let decoded = |code: u16| ((f64::from(code) / 255.0 + 0.055) / 1.055).powf(2.4) as f32;
            let texels = (0..6).map(|i| Vec3::new(decoded(20 + 40 * i), decoded(250 - 30 * i), decoded(99)));
            texture.texels = texels.collect();
        }
        let expected = |pixel: usize| {
            let (x, y) = (pixel % SETTINGS.width as usize, pixel / SETTINGS.width as usize);
            let direction = scene.camera.direction(x as f64 + 0.5, y as f64 + 0.5, SETTINGS.width, SETTINGS.height);
            let p = scene.camera.origin - direction * (scene.camera.origin.y / direction.y);
            let (u, v) = ((p.x / 80.0 + 0.5) * 5.0 - 2.0, (p.z / 80.0 + 0.5) * 5.0 - 2.0);
            bilinear(&scene.textures[0], u, v) * factor.as_dvec3() * 3.0 / std::f64::consts::PI
        };
        let folder = folder(&format!("texture_{name}"));
        // POV-Ray takes pixel centres. Mitsuba averages 16 random points of each pixel: looser, yet half a texel shows.
        let pictures = [(povray_picture(&scene, &folder), 4e-5, 2e-5), (mitsuba_picture(&scene, &folder), 0.1, 5e-3)];
        for (picture, each, mean) in pictures.into_iter().filter_map(|(p, each, mean)| Some((p?, each, mean))) {
            let errors = picture.iter().enumerate().map(|(i, p)| (DVec3::from(*p) - expected(i)).abs().max_element());
            let errors: Vec<f64> = errors.collect();
            assert!(errors.iter().all(|e| *e < each), "{name}: {:?}", errors.iter().copied().fold(0.0, f64::max));
            let average = errors.iter().sum::<f64>() / errors.len() as f64;
            assert!(average < mean, "{name}: {average} on average");
        }
    }
}

#[test]
fn both_renderers_take_every_material_and_an_empty_scene() {
    let mut empty = scene(Vec::new(), Vec::new(), vec![material("none", lambert(Vec3::ZERO))], Vec::new());
    empty.environment = Vec3::new(0.25, 0.5, 0.75);
    for (name, scene) in [("everything", everything()), ("empty", empty)] {
        let folder = folder(name);
        for picture in [povray_picture(&scene, &folder), mitsuba_picture(&scene, &folder)].into_iter().flatten() {
            assert!(picture.iter().flatten().all(|c| c.is_finite() && *c >= 0.0), "{name}");
            // The first pixel sees the environment in both scenes.
            let sky = DVec3::from(picture[0]);
            assert!(sky.distance(scene.environment.as_dvec3()) < 1e-4, "{name}: {sky}");
        }
    }
}
