//! The lights of a scene and the choice among them.

mod emitter;

pub(super) use emitter::{Arrival, Target};

use super::frame::{cosine_hemisphere, from_local};
use super::tracer::Vertex;
use crate::ray::Aabb;
use crate::scene::Scene;
use emitter::{Emitter, Extended};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

/// All lights: those without extent, then emissive primitives in the order of their indices, then the environment.
///
/// A light is chosen half by its share of the power, half with equal chances for every light without extent, for the
/// environment and for the emissive primitives together.
#[derive(Clone, Debug)]
pub(super) struct Lights {
    delta: Vec<Emitter>,
    points: Vec<DVec3>,
    areas: Vec<Extended>,
    environment: DVec3,
    /// Sum of the chances up to and with each light.
    cumulative: Vec<f64>,
    environment_chance: f64,
}

/// Light that arrives at a point, chosen at random.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightSample {
    /// The light that arrives, radiance over density.
    pub arrival: Arrival,
    /// Density in solid angle; `None`: the light has no extent.
    pub pdf: Option<f64>,
}

impl Lights {
    /// Gathers the lights of `scene`, whose primitives lie within `bounds`.
    pub fn new(scene: &Scene, bounds: &Aabb) -> Self {
        let radius = f64::from(bounds.extent().length()) / 2.0;
        let (mut delta, mut points) = (Vec::new(), Vec::new());
        for light in &scene.lights {
            if let Some(emitter) = Emitter::new(light, points.len()) {
                points.extend(emitter.position());
                delta.push(emitter);
            }
        }
        let areas = emissive(scene);
        let environment = scene.environment.as_dvec3();
        let lit = usize::from(environment.max_element() > 0.0);

        let mut powers: Vec<f64> = delta.iter().map(|e| e.power(radius)).collect();
        powers.extend(areas.iter().map(Extended::power));
        powers.resize(powers.len() + lit, luminance(environment) * 4.0 * PI * PI * radius * radius);
        let chances = chances(&powers, delta.len(), areas.len());

        let mut sum = 0.0;
        let cumulative = chances.iter().map(|c| {
            sum += c;
            sum
        });
        let cumulative = cumulative.collect();
        let environment_chance = if lit == 1 { chances.last().copied().unwrap_or(0.0) } else { 0.0 };
        Self { delta, points, areas, environment, cumulative, environment_chance }
    }

    /// Lights without extent.
    pub fn delta(&self) -> &[Emitter] {
        &self.delta
    }

    /// Where the lights without extent are that have a place, world units.
    pub fn points(&self) -> &[DVec3] {
        &self.points
    }

    /// Chooses a light by `u[2]` and a point or direction of it by `u[0]` and `u[1]`; `None` if no light arrives.
    pub fn sample(&self, vertex: &Vertex, u: [f64; 4]) -> Option<LightSample> {
        let last = self.cumulative.len().checked_sub(1)?;
        let index = self.cumulative.partition_point(|&c| c <= u[2] * self.cumulative[last]).min(last);
        let chance = self.chance(index);
        if let Some(emitter) = self.delta.get(index) {
            let arrival = emitter.arrival(vertex.position)?;
            return Some(LightSample { arrival: arrival.scaled(1.0 / chance), pdf: None });
        }
        let (arrival, density) = match self.areas.get(index - self.delta.len()) {
            Some(area) => area.sample(vertex.position, [u[0], u[1]])?,
            None => {
                let local = cosine_hemisphere([u[0], u[1]]);
                let direction = from_local(vertex.shading, local);
                let arrival = Arrival { target: Target::Infinity, direction, radiance: self.environment };
                (arrival, local.z * FRAC_1_PI)
            }
        };
        let pdf = chance * density;
        (pdf > 0.0).then(|| LightSample { arrival: arrival.scaled(1.0 / pdf), pdf: Some(pdf) })
    }

    /// Density with which [`Lights::sample`] gives, for `from`, the direction of `vertex` on an emissive primitive.
    pub fn pdf_of_hit(&self, from: DVec3, vertex: &Vertex) -> f64 {
        match self.areas.binary_search_by_key(&vertex.prim, |area| area.prim) {
            Ok(i) => self.chance(self.delta.len() + i) * self.areas[i].pdf(from, vertex.position),
            Err(_) => 0.0,
        }
    }

    /// Density with which [`Lights::sample`] gives `direction` of the environment at a point with this shading normal.
    pub fn pdf_of_environment(&self, shading: DVec3, direction: DVec3) -> f64 {
        self.environment_chance * shading.dot(direction).max(0.0) * FRAC_1_PI
    }

    fn chance(&self, index: usize) -> f64 {
        self.cumulative[index] - index.checked_sub(1).map_or(0.0, |i| self.cumulative[i])
    }
}

/// Chances from powers of lights in the order of [`Lights`].
fn chances(powers: &[f64], delta: usize, areas: usize) -> Vec<f64> {
    let total: f64 = powers.iter().sum();
    let area_total: f64 = powers[delta..delta + areas].iter().sum();
    let groups = powers.len() - areas + usize::from(areas > 0);
    // Powers that are not finite, or all zero (a scene without extent), say nothing.
    let trust = if total > 0.0 && total.is_finite() { 0.5 } else { 0.0 };
    let chance = |(i, &power): (usize, &f64)| {
        let in_group = match (delta..delta + areas).contains(&i) {
            false => 1.0,
            true if trust > 0.0 && area_total > 0.0 => power / area_total,
            true => 1.0 / areas as f64,
        };
        let by_power = if trust > 0.0 { trust * power / total } else { 0.0 };
        by_power + (1.0 - trust) * in_group / groups as f64
    };
    powers.iter().enumerate().map(chance).collect()
}

/// Primitives that shine, in the order of their indices.
fn emissive(scene: &Scene) -> Vec<Extended> {
    let mut areas = Vec::new();
    for (mesh, &first) in scene.meshes.iter().zip(&scene.mesh_offsets) {
        let radiance = scene.materials[mesh.material as usize].emission.as_dvec3();
        if radiance.max_element() > 0.0 {
            let triangles = (first..).zip(&mesh.triangles);
            areas.extend(triangles.filter_map(|(prim, corners)| {
                let corners = corners.map(|i| mesh.positions[i as usize].as_dvec3());
                Extended::triangle(prim, corners, radiance)
            }));
        }
    }
    for (prim, (sphere, &material)) in (scene.triangle_count()..).zip(scene.spheres.iter().zip(&scene.sphere_materials))
    {
        let radiance = scene.materials[material as usize].emission.as_dvec3();
        if radiance.max_element() > 0.0 {
            areas.extend(Extended::sphere(prim, sphere, radiance));
        }
    }
    areas
}

/// True if `scene` has a primitive that shines, which [`super::Integrator::Whitted`] cannot let light others.
pub(super) fn has_area_lights(scene: &Scene) -> bool {
    !emissive(scene).is_empty()
}

/// Luminance of linear RGB with the primaries of Rec. 709.
fn luminance(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chances_add_up_to_one() {
        for (powers, delta, areas) in [
            (vec![1.0, 2.0, 3.0, 4.0, 5.0], 2, 2),
            (vec![0.0, 0.0], 0, 1),
            (vec![f64::INFINITY, 1.0, 1.0], 1, 2),
            (vec![3.0], 0, 0),
            (vec![1.0, 0.0, 0.0], 1, 2),
        ] {
            let chances = chances(&powers, delta, areas);
            // Each is rounded a few times.
            assert!((chances.iter().sum::<f64>() - 1.0).abs() < 1e-15, "{powers:?} {chances:?}");
        }
        // Half by power 1:2:1:6, half one third for each of: the point light, both areas, the environment.
        let expected = [0.05 + 0.5 / 3.0, 0.1 + 0.5 / 3.0 * 2.0 / 3.0, 0.05 + 0.5 / 9.0, 0.3 + 0.5 / 3.0];
        for (ours, theirs) in chances(&[1.0, 2.0, 1.0, 6.0], 1, 2).iter().zip(expected) {
            assert!((ours - theirs).abs() < 1e-15);
        }
        assert!(chances(&[], 0, 0).is_empty());
    }
}
