//! The path tracer against integrals with closed forms.

use super::*;
use skipgrid::Sphere;
use skipgrid::scene::Light;
use std::f64::consts::PI;

/// Independent samples of one point.
fn samples(max_depth: u32) -> Settings {
    settings(Integrator::Path, 8, Sampler::Regular(16), max_depth)
}

#[test]
fn a_convex_ball_under_an_even_sky_returns_its_albedo() {
    let scene = scene(SceneParts {
        spheres: vec![(Sphere { centre: Vec3::ZERO, radius: 1.0 }, 0)],
        materials: vec![lambert(0.5)],
        environment: Vec3::new(1.0, 2.0, 0.25),
        camera: camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 10.0),
        ..SceneParts::default()
    });
    for max_depth in [2, 3, 9] {
        for sampler in [Sampler::Regular(2), Sampler::Sobol(16)] {
            let film = film(&scene, &settings(Integrator::Path, 8, sampler, max_depth));
            for (mean, albedo) in film.picture().pixels[0].iter().zip([0.5, 1.0, 0.125]) {
                // Connections and scattered rays give half each, to the last digits.
                assert!((mean - albedo).abs() < 1e-6 * albedo, "{mean} is not {albedo}");
            }
        }
    }
}

#[test]
fn light_in_a_shining_room_is_a_geometric_series() {
    let albedo = 0.6;
    let scene = scene(SceneParts {
        meshes: vec![cuboid([-1.0, -2.0, -1.5], [1.0, 2.0, 1.0], false, 0)],
        materials: vec![shining(0.6, Vec3::new(1.0, 0.5, 0.25))],
        camera: probe([0.1, 0.2, 0.3], [0.5, -1.0, -0.8]),
        ..SceneParts::default()
    });
    let albedo = f64::from(albedo as f32);
    for max_depth in [1, 2, 4, 7] {
        let series: f64 = (0..max_depth).map(|k| albedo.powi(k as i32)).sum();
        let settings = Settings { rr_depth: 100, ..samples(max_depth) };
        let what = format!("{max_depth} edges");
        assert_estimates(&film(&scene, &settings), [series, series / 2.0, series / 4.0], &what);
    }
    let all = 1.0 / (1.0 - albedo);
    let settings = Settings { rr_depth: 2, ..samples(200) };
    assert_estimates(&film(&scene, &settings), [all, all / 2.0, all / 4.0], "with roulette");
}

/// A floor seen from the side, and whatever shines.
fn floor_under(parts: SceneParts) -> Scene {
    let floor = square(90.0, 0.0, true, 0);
    let materials = vec![lambert(0.5), shining(0.0, Vec3::splat(4.0))];
    let meshes = std::iter::once(floor).chain(parts.meshes).collect();
    scene(SceneParts { meshes, materials, camera: probe([6.0, 1.0, 0.4], [0.0, 0.0, 0.0]), ..parts })
}

#[test]
fn a_square_light_has_the_form_factor_of_a_square() {
    for (half, height) in [(1.0f32, 2.0f32), (3.0, 0.5), (0.1, 1.0)] {
        let scene = floor_under(SceneParts { meshes: vec![square(half, height, false, 1)], ..SceneParts::default() });
        // A parallel rectangle over its corner (Howell, factor B-3), four times.
        let a = f64::from(half) / f64::from(height);
        let root = (1.0 + a * a).sqrt();
        let factor = 4.0 * 2.0 / (2.0 * PI) * a / root * (a / root).atan();
        assert_estimates(&film(&scene, &samples(2)), [0.5 * 4.0 * factor; 3], &format!("{half} {height}"));
    }
    // From behind the light is black.
    let scene = floor_under(SceneParts { meshes: vec![square(1.0, 2.0, true, 1)], ..SceneParts::default() });
    assert_eq!(mean(&film(&scene, &samples(2))).0, DVec3::ZERO);
}

#[test]
fn a_shining_ball_lights_by_its_solid_angle() {
    for (centre, radius) in [([0.0f32, 0.0, 2.0], 1.0f32), ([1.5, -2.0, 2.0], 0.5), ([0.3, 0.0, 9.0], 0.01)] {
        let centre = Vec3::from(centre);
        let spheres = vec![(Sphere { centre, radius }, 1)];
        let scene = floor_under(SceneParts { spheres, ..SceneParts::default() });
        // Wholly above the horizon: E = pi L (r / d)^2 cos.
        let d = centre.as_dvec3().length();
        let expected = 0.5 * 4.0 * (f64::from(radius) / d).powi(2) * f64::from(centre.z) / d;
        assert_estimates(&film(&scene, &samples(2)), [expected; 3], &format!("{centre} {radius}"));
    }
}

#[test]
fn many_lights_add_up() {
    // A square, a ball, a point, a sun and a sky: chosen at random, they must give the sum.
    let scene = floor_under(SceneParts {
        meshes: vec![square(0.5, 3.0, false, 1)],
        spheres: vec![(Sphere { centre: Vec3::new(0.0, 2.0, 2.0), radius: 0.3 }, 1)],
        lights: vec![
            Light::Point { position: DVec3::new(0.0, -2.0, 1.0), intensity: Vec3::splat(3.0) },
            Light::Directional { direction: DVec3::new(0.6, 0.0, -0.8), irradiance: Vec3::splat(1.5) },
        ],
        environment: Vec3::splat(0.2),
        ..SceneParts::default()
    });
    let root = (1.0f64 + 1.0 / 36.0).sqrt();
    let square = 4.0 / PI / 6.0 / root * (1.0 / 6.0 / root).atan();
    let radius = f64::from(0.3f32);
    let d2 = 8.0f64;
    let ball = radius * radius / d2 * 2.0 / d2.sqrt();
    let point = 3.0 / 5.0 / 5f64.sqrt();
    let sun = 1.5 * 0.8;
    // The sky is hidden by the square, and by the ball, as much as these light.
    let sky = 0.2 * (1.0 - square - ball);
    let expected = 0.5 * (4.0 * (square + ball) + (point + sun) / PI + f64::from(0.2f32) / 0.2 * sky);
    let settings = settings(Integrator::Path, 16, Sampler::Regular(16), 2);
    assert_estimates(&film(&scene, &settings), [expected; 3], "five lights");
}

#[test]
fn a_nearly_smooth_conductor_loses_nothing() {
    let bsdf = |alpha| Bsdf::Conductor { eta: Vec3::ZERO, k: Vec3::ONE, reflectance: Vec3::splat(0.5), alpha };
    for alpha in [0.001, 0.02] {
        let scene = scene(SceneParts {
            spheres: vec![(Sphere { centre: Vec3::ZERO, radius: 1.0 }, 0)],
            materials: vec![of(bsdf(alpha))],
            environment: Vec3::ONE,
            camera: probe([0.0, 3.0, 5.0], [0.0, 0.1, 0.0]),
            ..SceneParts::default()
        });
        let (mean, sigma) = mean(&film(&scene, &samples(3)));
        // Single scattering loses light to masking: less than alpha^2 at these angles.
        let allowed = 4.0 * sigma.x + f64::from(alpha * alpha);
        assert!((mean.x - 0.5).abs() < allowed && allowed < 5e-3, "{alpha} {mean} {sigma}");
    }
}

#[test]
fn radiance_grows_with_the_square_of_the_index() {
    // From inside glass of index 1.5: 4 % are reflected back into an equal sky, 96 % come from outside, times 1.5^2.
    let scene = scene(SceneParts {
        meshes: vec![square(90.0, 0.0, true, 0)],
        materials: vec![of(Bsdf::Dielectric { ior: 1.5 })],
        environment: Vec3::ONE,
        camera: probe([0.1, 0.2, -1.0], [0.1, 0.2, 0.0]),
        ..SceneParts::default()
    });
    assert_estimates(&film(&scene, &samples(5)), [0.04 + 0.96 * 2.25; 3], "from inside");
}

#[test]
fn a_closed_piece_of_glass_in_an_even_sky_is_invisible() {
    let scene = scene(SceneParts {
        spheres: vec![(Sphere { centre: Vec3::ZERO, radius: 1.0 }, 0)],
        materials: vec![of(Bsdf::Dielectric { ior: 1.7 })],
        environment: Vec3::splat(0.5),
        camera: camera([0.0, 0.0, 5.0], [0.0, 0.0, 0.0], 30.0),
        ..SceneParts::default()
    });
    let settings = Settings { rr_depth: 1000, ..settings(Integrator::Path, 16, Sampler::Sobol(16), 1000) };
    for pixel in film(&scene, &settings).picture().pixels {
        // The scaling at the entrance and the exit cancels up to roundings.
        assert!((pixel[0] - 0.5).abs() < 1e-6, "{pixel:?}");
    }
}

#[test]
fn direct_light_of_one_point_light_needs_no_random_numbers() {
    let lights = vec![Light::Point { position: DVec3::new(1.0, 1.0, 2.0), intensity: Vec3::new(1.0, 2.0, 3.0) }];
    let scene = floor_under(SceneParts { lights, ..SceneParts::default() });
    assert_eq!(pixel(&scene, Integrator::Path, 2), pixel(&scene, Integrator::Whitted, 2));
}

#[test]
fn low_discrepancy_samples_estimate_the_same_with_less_noise() {
    let scene = floor_under(SceneParts { meshes: vec![square(1.0, 2.0, false, 1)], ..SceneParts::default() });
    let spread = |sampler| {
        let picture = film(&scene, &settings(Integrator::Path, 8, sampler, 2)).picture();
        let values: Vec<f64> = picture.pixels.iter().map(|p| f64::from(p[0])).collect();
        let mean = values.iter().sum::<f64>() / 64.0;
        (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 63.0)
    };
    let ((a, noise), (b, less)) = (spread(Sampler::Regular(8)), spread(Sampler::Sobol(64)));
    assert!((a - b).abs() < 4.0 * ((noise + less) / 64.0).sqrt(), "{a} {b}");
    assert!(less < noise / 4.0, "{less} {noise}");
}
