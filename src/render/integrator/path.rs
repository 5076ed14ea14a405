//! Path tracing: at every rough surface one connection to a light and one scattered ray, weighted against each other.
//!
//! Depth, weights and Russian roulette are those of Mitsuba 3's `path` integrator, so that equal settings estimate
//! equal pictures. Source: Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation", chapters 9 and 10.

use super::super::sampler::Samples;
use super::super::scatter::Lobe;
use super::super::tracer::{Tracer, Vertex};
use crate::accel::Accel;
use crate::ray::Ray;
use glam::DVec3;

/// Greatest chance of a path to survive Russian roulette.
const MAX_SURVIVAL: f64 = 0.95;

/// How the two ways to reach a light share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Share {
    /// By the squares of their densities (the power heuristic).
    Power,
    /// Lights are reached by connections only, except from the eye and over mirrors.
    #[cfg(test)]
    Connections,
    /// Lights with extent are reached by scattered rays only.
    #[cfg(test)]
    Scattering,
}

impl Share {
    fn of_connection(self, connection: f64, scattering: f64) -> f64 {
        match self {
            Share::Power => power(connection, scattering),
            #[cfg(test)]
            Share::Connections => 1.0,
            #[cfg(test)]
            Share::Scattering => 0.0,
        }
    }

    fn of_scattering(self, connection: f64, scattering: f64) -> f64 {
        match self {
            Share::Power => power(scattering, connection),
            #[cfg(test)]
            Share::Connections => 0.0,
            #[cfg(test)]
            Share::Scattering => 1.0,
        }
    }
}

/// The power heuristic with exponent 2; Veach 1997, section 9.2.4.
fn power(own: f64, other: f64) -> f64 {
    // The ratio cannot overflow where the squares would.
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// Where a scattered ray came from, if a connection could have gone the same way.
struct Origin {
    position: DVec3,
    shading: DVec3,
    pdf: f64,
}

/// Radiance that arrives along `ray`, estimated.
pub(in super::super) fn radiance<A: Accel + ?Sized>(
    tracer: &mut Tracer<A>,
    mut ray: Ray,
    samples: &Samples,
    share: Share,
) -> DVec3 {
    let stage = tracer.stage;
    let mut result = DVec3::ZERO;
    let mut throughput = DVec3::ONE;
    let mut eta = 1.0;
    let mut origin: Option<Origin> = None;
    for edge in 1..=stage.max_depth {
        let Some(vertex) = tracer.vertex(&ray, edge) else {
            let weight = origin.map_or(1.0, |o| {
                let direction = ray.direction.as_dvec3().normalize();
                share.of_scattering(stage.lights.pdf_of_environment(o.shading, direction), o.pdf)
            });
            return result + throughput * stage.scene.environment.as_dvec3() * weight;
        };
        let emission = tracer.emission(&vertex);
        if emission != DVec3::ZERO {
            let weight =
                origin.map_or(1.0, |o| share.of_scattering(stage.lights.pdf_of_hit(o.position, &vertex), o.pdf));
            result += throughput * emission * weight;
        }
        if edge == stage.max_depth {
            break;
        }

        let lobe = Lobe::at(stage.scene, &vertex);
        if !lobe.is_delta() {
            result += throughput * connect(tracer, &vertex, &lobe, samples.four(2 * edge - 1), share);
        }
        let by_scattering = samples.four(2 * edge);
        let Some(scattered) = lobe.sample(&vertex, by_scattering) else { break };
        throughput *= scattered.weight;
        eta *= scattered.eta;
        // The scaling of radiance at refractions says nothing about how much the path still matters.
        let strength = throughput.max_element() * eta * eta;
        if strength == 0.0 {
            break;
        }
        if edge >= stage.rr_depth {
            let survival = strength.min(MAX_SURVIVAL);
            if by_scattering[3] >= survival {
                break;
            }
            throughput /= survival;
        }
        ray = tracer.leave(&vertex, scattered.direction);
        origin = scattered.pdf.map(|pdf| Origin { position: vertex.position, shading: vertex.shading, pdf });
    }
    result
}

/// Light that one light source, chosen at random, sends to the viewer by way of `vertex`.
fn connect<A: Accel + ?Sized>(
    tracer: &mut Tracer<A>,
    vertex: &Vertex,
    lobe: &Lobe,
    u: [f64; 4],
    share: Share,
) -> DVec3 {
    let Some(sample) = tracer.stage.lights.sample(vertex, u) else { return DVec3::ZERO };
    let (value, scattering) = lobe.evaluate(vertex, sample.arrival.direction);
    let weight = sample.pdf.map_or(1.0, |pdf| share.of_connection(pdf, scattering));
    let light = value * sample.arrival.radiance * weight;
    if light == DVec3::ZERO || !tracer.lit(vertex, &sample.arrival) { DVec3::ZERO } else { light }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Sampler, light, sampler, spawn, tracer};
    use crate::scene::{Bsdf, Material, Mesh, Scene, SceneParts};
    use crate::{Accel, Sphere};
    use glam::Vec3;

    /// A floor under a square light, a shining ball and a sky, with a ball in the way.
    fn scene(floor: Bsdf) -> Scene {
        let material = |bsdf, emission| Material { name: String::new(), bsdf, emission };
        let grey = Bsdf::Lambert { albedo: Vec3::splat(0.5), texture: None };
        let square = |half: f32, z: f32, up: bool, material| Mesh {
            positions: [(-half, -half), (half, -half), (half, half), (-half, half)]
                .map(|(x, y)| Vec3::new(x, y, z))
                .to_vec(),
            triangles: if up { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[0, 2, 1], [0, 3, 2]] },
            material,
            ..Mesh::default()
        };
        Scene::new(SceneParts {
            meshes: vec![square(20.0, 0.0, true, 0), square(1.0, 3.0, false, 1)],
            spheres: vec![
                (Sphere { centre: Vec3::new(2.0, 0.0, 1.0), radius: 0.7 }, 2),
                (Sphere { centre: Vec3::new(-0.8, 0.5, 1.0), radius: 0.4 }, 3),
            ],
            materials: vec![
                material(floor, Vec3::ZERO),
                material(grey.clone(), Vec3::new(2.0, 1.0, 0.5)),
                material(grey.clone(), Vec3::new(0.5, 1.0, 3.0)),
                material(grey, Vec3::ZERO),
            ],
            environment: Vec3::new(0.1, 0.2, 0.3),
            ..SceneParts::default()
        })
        .expect("a valid scene")
    }

    /// Mean and variance of the mean of the radiance along one ray.
    fn estimate(scene: &Scene, accel: &dyn Accel, share: Share) -> (DVec3, DVec3) {
        let bounds = accel.bounds();
        let stage = tracer::Stage {
            scene,
            lights: light::Lights::new(scene, &bounds),
            shadows: None,
            spawner: spawn::Spawner::new(&bounds),
            max_depth: 3,
            rr_depth: 2,
        };
        let mut tracer = Tracer::new(&stage, accel);
        let ray = Ray::new(Vec3::new(0.0, -4.0, 2.0), Vec3::new(0.0, 3.9, -2.0));
        let pixel = sampler::PixelSamples::new(Sampler::Regular(200), share as u64, 0, 0);
        let (mut sum, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        let n = 40_000;
        for i in 0..n {
            let value = radiance(&mut tracer, ray, &pixel.sample(i), share);
            sum += value;
            squares += value * value;
        }
        let n = f64::from(n);
        (sum / n, (squares / n - (sum / n) * (sum / n)) / n)
    }

    #[test]
    fn both_ways_to_reach_lights_agree_with_their_combination() {
        let rough = |alpha| {
            let (eta, k) = (Vec3::new(0.2, 0.9, 1.1), Vec3::new(3.9, 2.4, 2.2));
            Bsdf::Conductor { eta, k, reflectance: Vec3::ONE, alpha }
        };
        for floor in [Bsdf::Lambert { albedo: Vec3::splat(0.7), texture: None }, rough(0.2), rough(0.7)] {
            let scene = scene(floor.clone());
            let accel = scene.accel("brute").expect("brute exists");
            let all = [Share::Power, Share::Connections, Share::Scattering].map(|s| estimate(&scene, &accel, s));
            for (a, b) in [(0, 1), (0, 2), (1, 2)] {
                let sigma = (all[a].1 + all[b].1).map(f64::sqrt);
                let off = (all[a].0 - all[b].0).abs() / sigma;
                // Nine comparisons of three channels: 4.5 sigma happens once in 5000 runs; the seeds are fixed.
                assert!(off.max_element() < 4.5, "{floor:?} {a} {b}: {all:?}");
            }
            // The combination has to be worth it: no noisier than the better of the two by more than a half.
            let best = all[1].1.min(all[2].1);
            assert!((all[0].1 / best).max_element() < 1.5, "{floor:?}: {all:?}");
        }
    }
}
