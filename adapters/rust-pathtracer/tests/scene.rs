//! The two questions of rust-pathtracer's trait `Scene`, against closed forms, and every accelerator against every other.

use glam::Vec3;
use rust_pathtracer::prelude::{AnalyticalLight, F3, LightSampleRec, Material, Ray, Scene, State};
use skipgrid::scene::{LoadOptions, load};
use skipgrid::{Triangle, registry};
use skipgrid_rust_pathtracer::MeshScene;

/// A square of side 2 around the axis z, seen from +z counter-clockwise, in two triangles.
fn square(z: f32) -> [Triangle; 2] {
    let at = |x: f32, y: f32| Vec3::new(x, y, z);
    [[at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0)], [at(-1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)]]
}

fn numbered(prim: u32) -> Material {
    Material { rgb: F3::new(prim as f32, 0.0, 0.0), roughness: 0.25, ..Material::new() }
}

fn ask(scene: &MeshScene, ray: &Ray) -> (bool, State) {
    let mut state = State::new();
    let hit = scene.closest_hit(ray, &mut state, &mut LightSampleRec::new());
    (hit, state)
}

fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
    let f3 = |[x, y, z]: [f32; 3]| F3::new(x, y, z);
    Ray::new(f3(origin), f3(direction))
}

#[test]
fn the_closest_hit_comes_with_normal_and_material() {
    let triangles = [square(1.0), square(-1.0)].concat();
    for entry in registry::ENTRIES.iter().filter(|entry| entry.missing().is_none() && entry.suits(&triangles)) {
        let scene = MeshScene::build(entry.name, triangles.clone(), numbered).expect("triangles");
        let (hit, state) = ask(&scene, &ray([0.5, -0.25, 3.0], [0.0, 0.0, -1.0]));
        assert!(hit && state.hit_dist == 2.0 && !state.is_emitter, "{}: {}", entry.name, state.hit_dist);
        assert_eq!((state.normal, state.material.rgb.x), (F3::new(0.0, 0.0, 1.0), 0.0));
        // From behind: the tracer turns the normal itself.
        let (hit, state) = ask(&scene, &ray([-0.5, 0.25, -3.0], [0.0, 0.0, 1.0]));
        assert!(hit && state.hit_dist == 2.0 && state.material.roughness == 0.25);
        assert_eq!((state.normal, state.material.rgb.x), (F3::new(0.0, 0.0, 1.0), 3.0));
        let (hit, state) = ask(&scene, &ray([1.5, 0.0, 3.0], [0.0, 0.0, -1.0]));
        assert!(!hit && state.hit_dist == f32::INFINITY);
    }
}

#[test]
fn shadow_rays_end_at_the_distance() {
    let scene = MeshScene::build("nested", square(0.0).to_vec(), numbered).expect("triangles");
    let down = ray([0.5, 0.5, 3.0], [0.0, 0.0, -1.0]);
    assert!(scene.any_hit(&down, 3.5) && scene.any_hit(&down, 3.0));
    assert!(!scene.any_hit(&down, 2.9) && !scene.any_hit(&ray([0.5, 0.5, 3.0], [0.0, 0.0, 1.0]), 9.0));
}

#[test]
fn a_light_counts_where_it_comes_first() {
    let light = || AnalyticalLight::spherical(F3::new(0.5, 0.0, 0.0), 0.5, F3::new(7.0, 8.0, 9.0));
    let lit = |z: f32| MeshScene::build("nested", square(z).to_vec(), numbered).expect("triangles").with_light(light());
    let down = ray([0.5, 0.0, 3.0], [0.0, 0.0, -1.0]);
    for (z, distance, emitter) in [(-1.0, 2.5, true), (1.0, 2.0, false)] {
        let (hit, state) = ask(&lit(z), &down);
        assert_eq!((hit, state.hit_dist, state.is_emitter), (true, distance, emitter));
    }
    let (hit, state) = ask(&lit(-1.0), &ray([0.5, 0.0, 3.0], [0.0, 0.0, 1.0]));
    assert!(!hit && !state.is_emitter);
}

#[test]
fn every_accelerator_gives_the_tracer_the_same_bits() {
    let mesh = load("bumpy:n=12", &LoadOptions::default()).expect("a scene made by formula").meshes.remove(0);
    let triangles: Vec<Triangle> = mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect();
    let names: Vec<&str> =
        registry::ENTRIES.iter().filter(|e| e.exact && e.suits(&triangles)).map(|e| e.name).collect();
    assert!(names.len() > 8 && names[0] == "brute");
    let scenes: Vec<MeshScene> =
        names.iter().map(|name| MeshScene::build(name, triangles.clone(), numbered).expect("triangles")).collect();
    let mut hits = 0;
    for i in 0..2000 {
        let angle = i as f32 * 2.399_963;
        let z = 1.0 - i as f32 / 1000.0;
        let from = [angle.cos() * 3.0, z * 2.0, angle.sin() * 3.0];
        let ray = ray(from, [-from[0], 0.4 * (i as f32 * 0.7).sin() - from[1], -from[2]]);
        let answers: Vec<_> = scenes
            .iter()
            .map(|scene| {
                let (hit, state) = ask(scene, &ray);
                assert_eq!(scene.any_hit(&ray, f32::INFINITY), hit);
                (hit, state.hit_dist.to_bits(), state.normal, state.material.rgb)
            })
            .collect();
        hits += usize::from(answers[0].0);
        assert!(answers.iter().all(|answer| *answer == answers[0]), "ray {i}: {answers:?}");
    }
    assert!(hits > 1000, "{hits} of 2000 rays hit");
}

#[test]
fn unknown_accelerators_are_refused_and_nothing_is_a_scene() {
    let error = MeshScene::build("netsed", vec![], numbered).err().expect("no such accelerator");
    assert!(error.to_string().contains("did you mean `nested`"), "{error}");
    assert!(!ask(&MeshScene::new(), &ray([0.0, 0.0, 3.0], [0.0, 0.0, -1.0])).0);
}
