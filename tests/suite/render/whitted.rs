//! The deterministic integrator against optics on paper.

use super::*;
use approx::assert_relative_eq;
use skipgrid::Sphere;
use skipgrid::scene::Light;
use std::f64::consts::PI;

/// f32 rays miss the point they are aimed at by 2^-24 of the distance, times a slope of a few.
const F32: f64 = 2e-6;

/// Where the camera's ray through the centre of pixel (x, y) of 16 x 16 meets the plane z = 0.
fn on_floor(camera: &Camera, x: u32, y: u32) -> DVec3 {
    let direction = camera.direction(f64::from(x) + 0.5, f64::from(y) + 0.5, 16, 16);
    camera.origin - direction * (camera.origin.z / direction.z)
}

fn lit_floor(light: Light) -> (Scene, Camera) {
    let camera = camera([1.0, -5.0, 4.0], [0.0, 0.5, 0.0], 40.0);
    let parts = SceneParts {
        meshes: vec![square(50.0, 0.0, true, 0)],
        materials: vec![lambert(0.6)],
        lights: vec![light],
        camera,
        ..SceneParts::default()
    };
    (scene(parts), camera.expect("given"))
}

fn picture(scene: &Scene) -> Picture {
    film(scene, &settings(Integrator::Whitted, 16, Sampler::Regular(1), 2)).picture()
}

#[test]
fn point_light_falls_off_with_distance_and_angle() {
    let position = DVec3::new(0.5, 0.3, 1.5);
    let (scene, camera) = lit_floor(Light::Point { position, intensity: Vec3::splat(7.0) });
    assert_pixels(&picture(&scene), F32, |x, y| {
        let way = position - on_floor(&camera, x, y);
        0.6 / PI * 7.0 * way.z / way.length().powi(3)
    });
}

#[test]
fn directional_light_depends_on_the_angle_only() {
    let direction = DVec3::new(0.3, -0.4, -0.8).normalize();
    let (scene, _) = lit_floor(Light::Directional { direction, irradiance: Vec3::splat(2.0) });
    assert_pixels(&picture(&scene), 1e-7, |_, _| 0.6 / PI * 2.0 * -direction.z);
}

#[test]
fn spot_light_has_an_edge_and_a_linear_ramp() {
    let position = DVec3::new(0.2, 0.1, 3.0);
    let axis = DVec3::new(0.1, 0.2, -1.0).normalize();
    for beam_width in [30.0, 12.0] {
        let light = Light::Spot { position, direction: axis, intensity: Vec3::splat(5.0), cutoff: 30.0, beam_width };
        let (scene, camera) = lit_floor(light);
        let expected = |x, y| {
            let way = position - on_floor(&camera, x, y);
            let angle = (-way.normalize()).angle_between(axis).to_degrees();
            let share = if angle <= beam_width { 1.0 } else { ((30.0 - angle) / (30.0 - beam_width)).max(0.0) };
            share * 0.6 / PI * 5.0 * way.z / way.length().powi(3)
        };
        let dark = (0..256).filter(|i| expected(i % 16, i / 16) == 0.0).count();
        assert!((50..200).contains(&dark), "the edge must cross the picture: {dark}");
        // The ramp has a slope of 1 in 18 degrees; near its end a relative error is that much greater.
        assert_pixels(&picture(&scene), 2e-4, expected);
    }
}

#[test]
fn a_ball_throws_the_shadow_that_geometry_says() {
    let position = DVec3::new(0.0, 0.0, 5.0);
    let (mut scene, camera) = lit_floor(Light::Point { position, intensity: Vec3::splat(9.0) });
    let (centre, radius) = (Vec3::new(0.2, 0.4, 3.0), 0.5f32);
    let parts = SceneParts {
        meshes: std::mem::take(&mut scene.meshes),
        spheres: vec![(Sphere { centre, radius }, 0)],
        materials: scene.materials,
        lights: scene.lights,
        camera: Some(camera),
        ..SceneParts::default()
    };
    let picture = picture(&super::scene(parts));
    let mut dark = 0;
    for (i, pixel) in picture.pixels.iter().enumerate() {
        let view = camera.direction(f64::from(i as u32 % 16) + 0.5, f64::from(i as u32 / 16) + 0.5, 16, 16);
        let miss = |from: DVec3, along: DVec3| (centre.as_dvec3() - from).cross(along).length() / f64::from(radius);
        if miss(camera.origin, view) < 1.0 {
            continue;
        }
        let way = position - on_floor(&camera, i as u32 % 16, i as u32 / 16);
        let hidden = miss(position, way.normalize());
        // No sample lies as near to the edge as rounding.
        assert!((hidden - 1.0).abs() > 1e-5);
        let expected = if hidden < 1.0 { 0.0 } else { 0.6 / PI * 9.0 * way.z / way.length().powi(3) };
        assert_relative_eq!(f64::from(pixel[0]), expected, max_relative = F32);
        dark += usize::from(hidden < 1.0);
    }
    assert!(dark > 5, "{dark}");
}

#[test]
fn a_mirror_shows_what_the_mirrored_camera_sees() {
    // Above the floor z = 0 hangs a ball, lit from the side of the camera. The camera looks down past it, and its mirror
    // image looks up from below the floor.
    let picture = |mirror: bool| {
        let side = if mirror { 1.0 } else { -1.0 };
        let camera = Camera {
            origin: DVec3::new(0.0, -4.0, side),
            target: DVec3::new(0.0, 0.0, -1.2 * side),
            up: DVec3::new(0.0, 0.0, side),
            yfov: 25.0,
            source: CameraSource::File,
        };
        let direction = DVec3::new(0.5, 0.8, -0.2).normalize();
        let scene = scene(SceneParts {
            meshes: if mirror { vec![square(50.0, 0.0, true, 1)] } else { vec![] },
            spheres: vec![(Sphere { centre: Vec3::new(0.3, 0.2, 1.6), radius: 1.0 }, 0)],
            materials: vec![lambert(0.9), of(Bsdf::Mirror { reflectance: Vec3::splat(0.8) })],
            lights: vec![Light::Directional { direction, irradiance: Vec3::splat(3.0) }],
            camera: Some(camera),
            ..SceneParts::default()
        });
        film(&scene, &settings(Integrator::Whitted, 16, Sampler::Regular(1), 3)).picture()
    };
    let (over_mirror, behind) = (picture(true), picture(false));
    let mut lit = 0;
    for y in 0..16 {
        for x in 0..16 {
            let direct = behind.pixels[y * 16 + 15 - x][0];
            let mirrored = over_mirror.pixels[y * 16 + x][0];
            // Two rounded rays; slopes at the ball's limb reach about ten.
            assert_relative_eq!(mirrored, 0.8 * direct, max_relative = 2e-5, epsilon = 1e-6);
            lit += usize::from(direct > 0.0);
        }
    }
    assert!(lit > 30, "{lit}");
}

/// A slab of glass 1 thick under a camera that looks straight down, with a shining floor below it.
fn slab(ior: f32, floor: f32, environment: f32) -> Scene {
    scene(SceneParts {
        meshes: vec![cuboid([-9.0, -9.0, -1.0], [9.0, 9.0, 0.0], true, 0), square(50.0, -3.0, true, 1)],
        materials: vec![of(Bsdf::Dielectric { ior }), shining(0.0, Vec3::splat(floor))],
        environment: Vec3::splat(environment),
        camera: probe([0.1, 0.2, 4.0], [0.1, 0.2, 0.0]),
        ..SceneParts::default()
    })
}

#[test]
fn a_slab_of_glass_passes_what_all_inner_reflections_add_up_to() {
    for ior in [1.5f32, 1.33, 2.4] {
        let n = f64::from(ior);
        // With R = ((n - 1) / (n + 1))^2 a slab passes (1 - R) / (1 + R).
        let passed = 2.0 * n / (n * n + 1.0);
        let [through, ..] = pixel(&slab(ior, 1.0, 0.0), Integrator::Whitted, 100);
        assert_relative_eq!(through, passed, max_relative = 1e-7);
        let [all, ..] = pixel(&slab(ior, 0.25, 0.25), Integrator::Whitted, 100);
        assert_relative_eq!(all, 0.25, max_relative = 1e-7);
        // Of depth 3 there is the first reflection, and nothing has come through yet.
        let first = ((n - 1.0) / (n + 1.0)).powi(2);
        assert_relative_eq!(pixel(&slab(ior, 1.0, 0.5), Integrator::Whitted, 3)[0], 0.5 * first, max_relative = 1e-7);
    }
}

#[test]
fn beyond_the_critical_angle_glass_is_a_mirror() {
    // The camera is inside glass of index 1.5, whose surface is z = 0; below it the floor shines.
    let look = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        let scene = scene(SceneParts {
            meshes: vec![square(90.0, 0.0, true, 0), square(90.0, -2.0, true, 1)],
            materials: vec![of(Bsdf::Dielectric { ior: 1.5 }), shining(0.0, Vec3::splat(3.0))],
            environment: Vec3::splat(0.5),
            camera: probe([0.1, 0.2, -1.0], [0.1 + s, 0.2, -1.0 + c]),
            ..SceneParts::default()
        });
        pixel(&scene, Integrator::Whitted, 10)[0]
    };
    for degrees in [42.0, 60.0, 80.0] {
        assert_eq!(look(degrees), 3.0, "{degrees}");
    }
    assert_relative_eq!(look(0.0), 0.04 * 3.0 + 0.96 * 0.5, max_relative = 1e-9);
    assert!(look(41.7) < 3.0);
}

#[test]
fn shadow_rays_do_not_pass_glass_and_area_lights_light_nothing() {
    let with_glass = |glass: bool, light: bool| {
        let point = Light::Point { position: DVec3::new(0.0, 0.0, 4.0), intensity: Vec3::ONE };
        scene(SceneParts {
            meshes: vec![square(9.0, 0.0, true, 0), square(1.0, 8.0, false, 2)],
            spheres: if glass { vec![(Sphere { centre: Vec3::Z, radius: 0.5 }, 1)] } else { vec![] },
            materials: vec![lambert(0.5), of(Bsdf::Dielectric { ior: 1.5 }), shining(0.0, Vec3::ONE)],
            lights: if light { vec![point] } else { vec![] },
            camera: probe([5.0, 0.0, 1.0], [0.0, 0.0, 0.0]),
            ..SceneParts::default()
        })
    };
    assert_eq!(pixel(&with_glass(true, true), Integrator::Whitted, 9), [0.0; 3]);
    assert!(pixel(&with_glass(false, true), Integrator::Whitted, 9)[0] > 0.0);
    assert_eq!(pixel(&with_glass(false, false), Integrator::Whitted, 9), [0.0; 3]);
    assert_eq!(skipgrid::render::omissions(&with_glass(true, true), Integrator::Whitted).len(), 1);
    assert!(skipgrid::render::omissions(&with_glass(true, true), Integrator::Path).is_empty());
}

#[test]
fn depth_counts_edges_as_the_other_renderers_do() {
    // A closed room of shining mirrors: every hit adds its emission.
    let scene = scene(SceneParts {
        meshes: vec![cuboid([-1.0, -2.0, -1.5], [1.0, 2.0, 1.0], false, 0)],
        materials: vec![Material {
            name: "shining mirror".into(),
            bsdf: Bsdf::Mirror { reflectance: Vec3::splat(0.75) },
            emission: Vec3::ONE,
        }],
        camera: probe([0.1, 0.2, 0.3], [0.5, -1.0, -0.8]),
        ..SceneParts::default()
    });
    let series = |hits: u32| (0..hits).map(|k| 0.75f64.powi(k as i32)).sum::<f64>();
    for max_depth in [1, 2, 3, 6, 256] {
        // Mitsuba: as many hits as edges. POV-Ray: the last edge is the connection to a light.
        let path = pixel(&scene, Integrator::Path, max_depth)[0];
        let whitted = pixel(&scene, Integrator::Whitted, max_depth)[0];
        // Beyond depth 5 roulette may end or strengthen a path.
        if max_depth < 6 {
            assert_relative_eq!(path, series(max_depth), max_relative = 1e-12);
        }
        // Branches that carry less than 1e-9 are cut.
        assert_relative_eq!(whitted, series((max_depth - 1).max(1)), max_relative = 1e-8);
    }
}
