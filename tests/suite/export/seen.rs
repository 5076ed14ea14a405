//! The other renderers see in an exported scene what the laws of light ask for.

use super::{SETTINGS, everything, folder, lambert, material, run, scene, square};
use glam::{DVec3, Vec3};
use skipgrid::scene::{Bsdf, Light, Scene, Texture, mitsuba, povray};
use std::fs;
use std::path::Path;
use std::process::Command;

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
