//! A pixel does not depend on threads, crop or accelerator; and what cannot be rendered is refused.

use super::*;
use skipgrid::Sphere;
use skipgrid::render::Crop;
use skipgrid::scene::Light;
use std::sync::Mutex;

const ALL: [Integrator; 6] =
    [Integrator::Path, Integrator::Whitted, Integrator::Depth, Integrator::Normal, Integrator::Prim, Integrator::Steps];

/// A room with every material and every light.
fn room() -> Scene {
    let conductor =
        Bsdf::Conductor { eta: Vec3::splat(0.2), k: Vec3::splat(3.0), reflectance: Vec3::splat(0.9), alpha: 0.3 };
    let ball = |x: f32, radius: f32, material| (Sphere { centre: Vec3::new(x, 0.5, radius), radius }, material);
    let spot = Light::Spot {
        position: DVec3::new(0.0, 0.0, 2.5),
        direction: DVec3::new(0.3, 0.0, -1.0).normalize(),
        intensity: Vec3::new(1.0, 0.0, 2.0),
        cutoff: 40.0,
        beam_width: 20.0,
    };
    scene(SceneParts {
        meshes: vec![
            square(3.0, 0.0, true, 0),
            square(0.5, 2.9, false, 4),
            cuboid([-3.0, 2.0, 0.0], [3.0, 2.5, 3.0], true, 0),
        ],
        spheres: vec![ball(-1.2, 0.5, 1), ball(0.0, 0.4, 2), ball(1.2, 0.6, 3)],
        materials: vec![
            lambert(0.7),
            of(Bsdf::Mirror { reflectance: Vec3::splat(0.9) }),
            of(Bsdf::Dielectric { ior: 1.5 }),
            of(conductor),
            shining(0.0, Vec3::splat(5.0)),
        ],
        lights: vec![
            spot,
            Light::Point { position: DVec3::new(-1.0, -1.0, 2.0), intensity: Vec3::ONE },
            Light::Directional { direction: DVec3::new(0.0, 1.0, -0.5).normalize(), irradiance: Vec3::ONE },
        ],
        environment: Vec3::new(0.05, 0.1, 0.2),
        camera: camera([0.2, -5.0, 1.8], [0.0, 0.5, 0.6], 45.0),
        ..SceneParts::default()
    })
}

fn room_settings(integrator: Integrator) -> Settings {
    let sampler = Sampler::Sobol(4);
    Settings { width: 50, height: 37, ..settings(integrator, 50, sampler, 6) }
}

#[test]
fn threads_change_no_bit() {
    let room = room();
    for integrator in ALL {
        let one = film(&room, &room_settings(integrator));
        assert!(one.sum.iter().any(|s| s.max_element() > 0.0), "{integrator:?} is black");
        for threads in [Some(2), Some(5), None] {
            let other = film(&room, &Settings { threads, ..room_settings(integrator) });
            assert_eq!(one, other, "{integrator:?} {threads:?}");
        }
    }
}

/// A table of one square over a floor of many, under a lamp and a spot light: whole voxels are lit and whole voxels are dark.
fn table() -> Scene {
    let lamp = |x: f64, z: f64| Light::Point { position: DVec3::new(x, 0.3, z), intensity: Vec3::splat(4.0) };
    let floor = |i: i32| {
        let corner = [(i % 9 - 4) as f32 * 0.5, (i / 9 - 4) as f32 * 0.5];
        cuboid([corner[0], corner[1], -0.1], [corner[0] + 0.5, corner[1] + 0.5, 0.0], true, 0)
    };
    let mut meshes: Vec<_> = (0..81).map(floor).collect();
    meshes.push(square(0.9, 0.8, true, 0));
    scene(SceneParts {
        meshes,
        materials: vec![lambert(0.7)],
        lights: vec![lamp(0.2, 3.0), lamp(-1.5, 2.0), lamp(0.0, 0.4)],
        camera: camera([0.2, -5.0, 1.8], [0.0, 0.5, 0.4], 45.0),
        ..SceneParts::default()
    })
}

#[test]
fn shadow_voxels_change_no_bit() {
    let mut total = [0; 2];
    for scene in [room(), table()] {
        for integrator in [Integrator::Path, Integrator::Whitted] {
            let with = |on| film(&scene, &Settings { shadow_voxels: Some(on), ..room_settings(integrator) });
            let (plain, asked) = (with(false), with(true));
            assert_eq!((&plain.sum, &plain.sum_squares), (&asked.sum, &asked.sum_squares), "{integrator:?}");
            assert_eq!(plain.stats.shadow, asked.stats.shadow + asked.stats.spared);
            assert_eq!((plain.stats.spared, plain.stats.shortened), (0, 0));
            total[0] += asked.stats.spared;
            total[1] += asked.stats.shortened;
        }
    }
    assert!(total[0] > 1000 && total[1] > 1000, "next to nothing is known: {total:?}");
}

#[test]
fn shadow_voxels_are_left_out_where_they_cannot_pay() {
    let table = table();
    let of = |settings: &Settings| film(&table, settings).stats;
    let many = of(&Settings { sampler: Sampler::Sobol(64), ..room_settings(Integrator::Whitted) });
    assert!(many.spared > 0, "{many:?}");
    let few = of(&Settings { width: 5, height: 4, sampler: Sampler::Sobol(1), ..room_settings(Integrator::Whitted) });
    assert_eq!((few.spared, few.shortened), (0, 0), "{few:?}");
    let seen_only = of(&Settings { shadow_voxels: Some(true), max_depth: 1, ..room_settings(Integrator::Whitted) });
    assert_eq!(seen_only.spared + seen_only.shadow, 0, "{seen_only:?}");
}

#[test]
fn accelerators_change_no_bit() {
    let room = room();
    for integrator in [Integrator::Path, Integrator::Whitted, Integrator::Depth, Integrator::Prim] {
        let settings = room_settings(integrator);
        let expected = film(&room, &settings);
        for entry in skipgrid::registry::ENTRIES.iter().filter(|e| e.needs == skipgrid::registry::Needs::Any) {
            let accel = room.accel(entry.name).expect("a small scene");
            let ours = render(&room, &accel, &settings, &|_, _| ()).expect("usable settings");
            assert_eq!(expected, ours, "{integrator:?} {}", entry.name);
        }
    }
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let room = room();
    for integrator in [Integrator::Path, Integrator::Whitted] {
        let whole = film(&room, &room_settings(integrator));
        for crop in [Crop { x: 0, y: 0, width: 1, height: 1 }, Crop { x: 13, y: 5, width: 37, height: 32 }] {
            let part = film(&room, &Settings { crop: Some(crop), ..room_settings(integrator) });
            assert_eq!((part.width, part.height), (crop.width, crop.height));
            for y in 0..crop.height {
                let start = ((crop.y + y) * whole.width + crop.x) as usize;
                let row = (y * crop.width) as usize;
                let width = crop.width as usize;
                assert_eq!(part.sum[row..row + width], whole.sum[start..start + width], "row {y} of {crop:?}");
            }
        }
    }
}

#[test]
fn seeds_change_the_noise_but_not_deterministic_pictures() {
    let room = room();
    let with = |integrator, sampler, seed| film(&room, &Settings { seed, sampler, ..room_settings(integrator) });
    let path = |seed| with(Integrator::Path, Sampler::Sobol(4), seed);
    assert_ne!(path(1).sum, path(2).sum);
    let whitted = |seed| with(Integrator::Whitted, Sampler::Regular(2), seed);
    assert_eq!(whitted(1), whitted(2));
}

#[test]
fn progress_and_rays_are_counted() {
    let room = room();
    let accel = room.accel("brute").expect("brute exists");
    let settings = Settings { threads: Some(2), ..room_settings(Integrator::Path) };
    let seen = Mutex::new(Vec::new());
    let film = render(&room, &accel, &settings, &|done, all| seen.lock().expect("no panic").push((done, all)));
    let stats = film.expect("usable settings").stats;
    let mut seen = seen.into_inner().expect("no panic");
    seen.sort_unstable();
    // 50 x 37 pixels are 4 x 3 tiles of 16 x 16.
    assert_eq!(seen, (1..=12).map(|i| (i, 12)).collect::<Vec<_>>());
    assert_eq!(stats.camera, 50 * 37 * 4);
    // At most five bounces of each path, and a connection at each of their starts.
    assert!(stats.shadow > 0 && stats.shadow <= 5 * stats.camera, "{stats:?}");
    assert!(stats.bounce > 0 && stats.bounce <= 5 * stats.camera, "{stats:?}");
    assert_eq!(stats.discarded, 0);
}

#[test]
fn features_show_the_first_hit() {
    let scene = scene(SceneParts {
        meshes: vec![square(2.0, 1.0, false, 0)],
        environment: Vec3::ONE,
        camera: camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 90.0),
        ..SceneParts::default()
    });
    let camera = scene.camera;
    let picture = |integrator| film(&scene, &settings(integrator, 9, Sampler::Regular(1), 1)).picture();
    let depth = picture(Integrator::Depth);
    assert_pixels(&depth, 1e-6, |x, y| {
        let direction = camera.direction(f64::from(x) + 0.5, f64::from(y) + 0.5, 9, 9);
        let p = camera.origin + direction * (3.0 / -direction.z);
        if p.x.abs() <= 2.0 && p.y.abs() <= 2.0 { 3.0 / -direction.z } else { 0.0 }
    });
    let centre = 4 * 9 + 4;
    // The front looks down, the viewer sees the back: the normal is turned.
    assert_eq!(picture(Integrator::Normal).pixels[centre], [0.5, 0.5, 1.0]);
    assert_eq!(picture(Integrator::Normal).pixels[0], [0.0; 3]);
    assert!(picture(Integrator::Prim).pixels[centre].iter().all(|&c| (0.1..=1.0).contains(&c)));
    // Brute force tests both triangles for every ray.
    assert_eq!(picture(Integrator::Steps).pixels[0], [0.0, 2.0, 0.0]);
}

#[test]
fn an_empty_scene_shows_its_environment() {
    let environment = Vec3::new(0.25, 0.5, 2.0);
    let scene = scene(SceneParts { environment, ..SceneParts::default() });
    for integrator in [Integrator::Path, Integrator::Whitted] {
        for max_depth in [1, 5] {
            let film = film(&scene, &settings(integrator, 5, Sampler::Sobol(4), max_depth));
            assert!(film.picture().pixels.iter().all(|&p| p == environment.to_array()), "{integrator:?}");
        }
    }
}

#[test]
fn what_cannot_be_rendered_is_refused() {
    let scene = room();
    let accel = scene.accel("brute").expect("brute exists");
    let good = room_settings(Integrator::Path);
    let crop = |x, y, width, height| Settings { crop: Some(Crop { x, y, width, height }), ..good.clone() };
    let sampler = |sampler| Settings { sampler, ..good.clone() };
    let bad = [
        (Settings { width: 0, ..good.clone() }, "size is 0x37"),
        (Settings { height: 0, ..good.clone() }, "size is 50x0"),
        (Settings { width: u32::MAX, height: u32::MAX, ..good.clone() }, "film of 4294967295x4294967295"),
        (crop(0, 0, 0, 5), "crop of 0x5"),
        (crop(40, 0, 11, 5), "leaves the picture of 50x37"),
        (crop(0, u32::MAX, 1, 2), "leaves the picture"),
        (sampler(Sampler::Sobol(0)), "0 samples"),
        (sampler(Sampler::Sobol(65_537)), "65537 samples"),
        (sampler(Sampler::Regular(0)), "0x0"),
        (sampler(Sampler::Regular(65_536)), "65536x65536"),
        (Settings { max_depth: 0, ..good.clone() }, "max_depth is 0"),
        (Settings { max_depth: 257, ..room_settings(Integrator::Whitted) }, "max_depth is 257"),
        (Settings { threads: Some(0), ..good.clone() }, "0 threads"),
    ];
    for (settings, part) in bad {
        let error = render(&scene, &accel, &settings, &|_, _| ()).expect_err(part).to_string();
        assert!(error.contains(part), "{error} does not say {part}");
    }
    let broken = |change: &dyn Fn(&mut Scene), part: &str| {
        let mut scene = room();
        change(&mut scene);
        let error = render(&scene, &accel, &good, &|_, _| ()).expect_err(part).to_string();
        assert!(error.contains(part), "{error} does not say {part}");
    };
    broken(&|s| s.camera.yfov = 180.0, "yfov is 180");
    broken(&|s| s.camera.target = s.camera.origin, "camera: no view");
    broken(&|s| s.materials[3].bsdf = Bsdf::Dielectric { ior: 0.0 }, "index of refraction is 0");
    broken(&|s| s.materials[0].bsdf = Bsdf::Lambert { albedo: Vec3::ONE, texture: Some(2) }, "texture 2 of 0");
}
