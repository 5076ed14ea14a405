//! The teapot's patches and the tessellated teapot as depth pictures, and the scene as the program sees it.

use glam::DVec3;
use skipgrid::Ray;
use skipgrid::scene::{ExportSettings, Scene, SceneParts, mitsuba, povray, procedural};
use std::fs;

fn scene(spec: &str) -> Scene {
    Scene::new(procedural::parse(spec).expect("a scene")).expect("a scene")
}

/// Depths of a picture of `n` x `n` pixels through the middle of each; infinite where nothing is hit.
fn depths(scene: &Scene, camera: &Scene, n: u32) -> Vec<f64> {
    let accel = scene.accel("grid").expect("a grid");
    let [forward, right, up] = camera.camera.basis();
    let half = (camera.camera.yfov.to_radians() / 2.0).tan();
    let at = |i: u32| (2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0) * half;
    let pixel = |i: u32| {
        let direction: DVec3 = forward + right * at(i % n) - up * at(i / n);
        let ray = Ray::new(camera.camera.origin.as_vec3(), direction.as_vec3());
        accel.closest_hit(&ray).map_or(f64::INFINITY, |hit| f64::from(hit.t))
    };
    (0..n * n).map(pixel).collect()
}

#[test]
fn the_tessellated_teapot_approaches_the_patches_with_the_square_of_its_steps() {
    let patches = scene("teapot-patches");
    let truth = depths(&patches, &patches, 96);
    let error = |n: u32| {
        let mut apart: Vec<f64> = depths(&scene(&format!("teapot:n={n}")), &patches, 96)
            .iter()
            .zip(&truth)
            .filter(|(a, b)| a.is_finite() && b.is_finite())
            .map(|(a, b)| (a - b).abs())
            .collect();
        assert!(apart.len() > 1000, "{}", apart.len());
        // The median says how far surfaces lie apart; silhouettes have no bound.
        apart.sort_by(f64::total_cmp);
        apart[apart.len() / 2]
    };
    let (coarse, fine) = (error(8), error(16));
    let order = (coarse / fine).log2();
    assert!((1.7..2.3).contains(&order), "{coarse} {fine}: order {order}");
}

#[test]
fn surfaces_lie_on_the_ray_and_look_outwards() {
    let scene = scene("teapot-patches");
    let accel = scene.accel("grid").expect("a grid");
    let mut random = crate::random::Random::new(61);
    let mut hits = 0;
    for _ in 0..1000 {
        let origin = scene.camera.origin.as_vec3() + random.in_cube();
        let ray = Ray::new(origin, 2.0 * random.in_cube() + glam::Vec3::Y * 1.5 - origin);
        let Some(hit) = accel.closest_hit(&ray) else { continue };
        hits += 1;
        let s = scene.surface(&ray, hit);
        let line = (s.position - ray.origin.as_dvec3()).cross(ray.direction.as_dvec3()).length();
        assert!(line < 1e-8 * ray.direction.length_squared() as f64, "{ray:?}: {line}");
        assert!((s.geometric_normal.length() - 1.0).abs() < 1e-12);
        // The lid's rim lets rays in; what is seen from above and outside is front nearly always.
        assert!((0.0..=1.0).contains(&s.uv.x) && (0.0..=1.0).contains(&s.uv.y));
    }
    assert!(hits > 300, "{hits}");
    // The knob's top has no tangents; its normal is that of a point nearby, straight up.
    let top = Ray::new(glam::Vec3::new(0.0, 7.0, 0.0), glam::Vec3::NEG_Y);
    let normal = scene.surface(&top, accel.closest_hit(&top).expect("the knob")).shading_normal;
    assert!(normal.y > 0.99, "{normal}");
    let side = Ray::new(glam::Vec3::new(0.5, 1.0, 7.0), glam::Vec3::NEG_Z);
    let s = scene.surface(&side, accel.closest_hit(&side).expect("the body"));
    assert!(s.geometric_normal.z > 0.5, "{s:?}");
}

#[test]
fn patches_stand_alone_and_do_not_shine() {
    let refused = |change: &dyn Fn(&mut SceneParts), part: &str| {
        let mut parts = procedural::parse("teapot-patches").expect("a scene");
        change(&mut parts);
        let error = Scene::new(parts).expect_err("refused").to_string();
        assert!(error.contains(part), "{error}");
    };
    refused(&|p| p.spheres.push((skipgrid::Sphere { centre: glam::Vec3::ZERO, radius: 1.0 }, 0)), "no other primitive");
    refused(&|p| p.materials[0].emission = glam::Vec3::ONE, "emits light");
    refused(&|p| p.patches[3].1 = 7, "patch 3: material 7 of 1");
}

#[test]
fn both_exporters_write_the_patches() {
    let folder = crate::scenes::folder("patches");
    let scene = scene("teapot-patches");
    let out = folder.join("pot.pov");
    let warnings = povray::export(&scene, &ExportSettings::default(), &out).expect("written");
    assert!(warnings.len() == 1 && warnings[0].contains("environment"), "{warnings:?}");
    let text = fs::read_to_string(&out).expect("written");
    assert_eq!(text.matches("bicubic_patch").count(), 32);
    let out = folder.join("pot.xml");
    let warnings = mitsuba::export(&scene, &ExportSettings::default(), &out).expect("written");
    assert!(warnings.len() == 1 && warnings[0].contains("no bicubic patches"), "{warnings:?}");
    assert_eq!(fs::read_to_string(&out).expect("written").matches("type=\"ply\"").count(), 32);
}
