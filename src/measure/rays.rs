//! The rays that a renderer would ask for: camera, shadow and diffuse-bounce rays of a scene.

use crate::accel::{Accel, half_the_memory};
use crate::error::{Error, Result};
use crate::random::Random;
use crate::ray::{Aabb, Ray};
use crate::scene::{Light, Scene, Surface};
use glam::{DVec3, Vec3};

/// Where the rays of a set come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the eye through a random point of each pixel, row by row: neighbours are alike.
    Camera,
    /// From the points that camera rays hit towards a light.
    Shadow,
    /// From the points that camera rays hit into the hemisphere above, in random order: neighbours have nothing in common.
    Diffuse,
    /// Given by the user.
    Given,
}

impl RayKind {
    /// One word for tables.
    pub fn name(self) -> &'static str {
        match self {
            RayKind::Camera => "camera",
            RayKind::Shadow => "shadow",
            RayKind::Diffuse => "diffuse",
            RayKind::Given => "given",
        }
    }
}

/// What is asked for each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Query {
    /// [`Accel::closest_hit`].
    Closest,
    /// [`Accel::any_hit`].
    Any,
}

/// Rays of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// Where they come from.
    pub kind: RayKind,
    /// What is asked when they are timed.
    pub query: Query,
    /// The rays.
    pub rays: Vec<Ray>,
}

/// How many rays, and which.
#[derive(Clone, Debug, PartialEq)]
pub struct RayOptions {
    /// Columns of the film, at least 1.
    pub width: u32,
    /// Rows of the film, at least 1.
    pub height: u32,
    /// Same seed, same rays.
    pub seed: u64,
    /// Most rays in a set, at least 1; of a larger film every so-many-th pixel is taken.
    pub max_rays: usize,
}

impl Default for RayOptions {
    fn default() -> Self {
        Self { width: 256, height: 256, seed: 0, max_rays: 1 << 16 }
    }
}

/// Camera, shadow and diffuse rays of `scene`. `accel` finds the points that the latter two start from; as answers are
/// exact, any accelerator gives the same sets.
///
/// Shadow rays go towards a light, chosen at random; in a scene without lights towards a random point of a ball above
/// it. Diffuse directions are distributed with the cosine to the geometric normal.
///
/// # Errors
/// The film has no pixels, no ray is allowed, or the sets do not fit into memory.
pub fn ray_sets(scene: &Scene, accel: &dyn Accel, options: &RayOptions) -> Result<Vec<RaySet>> {
    let camera = camera_rays(scene, options)?;
    let mut shadow = with_capacity(camera.len())?;
    let mut diffuse = with_capacity(camera.len())?;
    let targets = Targets::of(scene, &accel.bounds());
    let mut random = Random::new(options.seed ^ 0x7368_6164_6f77);
    for ray in &camera {
        let Some(hit) = accel.closest_hit(ray) else { continue };
        let surface = scene.surface(ray, hit);
        if let Some(start) = Start::above(&surface, ray) {
            shadow.push(targets.ray(&start, &mut random));
            diffuse.push(start.cosine_ray(&mut random));
        }
    }
    random.shuffle(&mut diffuse);
    Ok(vec![
        RaySet { kind: RayKind::Camera, query: Query::Closest, rays: camera },
        RaySet { kind: RayKind::Shadow, query: Query::Any, rays: shadow },
        RaySet { kind: RayKind::Diffuse, query: Query::Closest, rays: diffuse },
    ])
}

fn camera_rays(scene: &Scene, options: &RayOptions) -> Result<Vec<Ray>> {
    let &RayOptions { width, height, seed, max_rays } = options;
    let pixels = u64::from(width) * u64::from(height);
    let count = pixels.min(max_rays as u64);
    if count == 0 {
        return Err(Error::invalid(format!("no camera rays: film of {width} x {height}, at most {max_rays} rays")));
    }
    let mut rays = with_capacity(usize::try_from(count).unwrap_or(usize::MAX))?;
    let mut random = Random::new(seed);
    for i in 0..count {
        // Less than `pixels`, which is below 2^64; the product may not be.
        let pixel = (u128::from(i) * u128::from(pixels) / u128::from(count)) as u64;
        let (x, y) = (pixel % u64::from(width), pixel / u64::from(width));
        let direction =
            scene.camera.direction(x as f64 + random.unit(), y as f64 + random.unit(), width, height).as_vec3();
        rays.push(Ray::new(scene.camera.origin.as_vec3(), direction));
    }
    Ok(rays)
}

fn with_capacity(count: usize) -> Result<Vec<Ray>> {
    // There are three sets.
    let wanted = (count as u64).saturating_mul(3 * size_of::<Ray>() as u64);
    let allowed = half_the_memory();
    let mut rays = Vec::new();
    if wanted > allowed || rays.try_reserve_exact(count).is_err() {
        return Err(Error::TooLarge { what: format!("three sets of {count} rays"), wanted, allowed });
    }
    Ok(rays)
}

/// A point just above a surface, on the side that the incoming ray sees.
struct Start {
    origin: Vec3,
    normal: DVec3,
}

impl Start {
    /// `None` where the surface has no finite position or normal.
    fn above(surface: &Surface, ray: &Ray) -> Option<Self> {
        let n = surface.geometric_normal;
        let normal = if n.dot(ray.direction.as_dvec3()) > 0.0 { -n } else { n };
        // The origin is rounded to f32, by at most 2^-24 of its largest coordinate: eight times that leaves the surface
        // without being seen.
        let lift = surface.position.abs().max_element() * f64::from(f32::EPSILON) * 4.0;
        let origin = (surface.position + normal * lift).as_vec3();
        (origin.is_finite() && normal.is_finite()).then_some(Self { origin, normal })
    }

    /// Cosine distribution: a unit normal plus a uniform unit vector.
    fn cosine_ray(&self, random: &mut Random) -> Ray {
        let direction = self.normal + random.direction();
        let direction = if direction.length_squared() > 1e-12 { direction.normalize() } else { self.normal };
        Ray::new(self.origin, direction.as_vec3())
    }
}

/// What shadow rays aim at.
struct Targets<'a> {
    scene: &'a Scene,
    meshes: Vec<usize>,
    spheres: Vec<usize>,
    /// Where there is no light at all: centre and radius of a ball.
    ball: (DVec3, f64),
}

impl<'a> Targets<'a> {
    fn of(scene: &'a Scene, bounds: &Aabb) -> Self {
        let shines = |material: u32| scene.materials.get(material as usize).is_some_and(|m| m.emission != Vec3::ZERO);
        let meshes = &scene.meshes;
        let meshes = (0..meshes.len()).filter(|&m| !meshes[m].triangles.is_empty() && shines(meshes[m].material));
        let spheres = (0..scene.spheres.len()).filter(|&s| shines(scene.sphere_materials[s]));
        let radius = bounds.extent().as_dvec3().length() / 2.0;
        let centre =
            if bounds.is_empty() { DVec3::ZERO } else { (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0 };
        let above = centre + scene.camera.up.normalize_or(DVec3::Y) * 1.5 * radius;
        Self { scene, meshes: meshes.collect(), spheres: spheres.collect(), ball: (above, radius / 2.0) }
    }

    /// A ray from `start` that ends just before its target.
    fn ray(&self, start: &Start, random: &mut Random) -> Ray {
        let lights = &self.scene.lights;
        let target = match random.below(lights.len() + self.meshes.len() + self.spheres.len()) {
            i if i < lights.len() => match lights[i] {
                Light::Point { position, .. } | Light::Spot { position, .. } => position,
                Light::Directional { direction, .. } => return Ray::new(start.origin, (-direction).as_vec3()),
            },
            i if i < lights.len() + self.meshes.len() => self.on_mesh(self.meshes[i - lights.len()], random),
            i if !self.spheres.is_empty() => {
                let sphere = &self.scene.spheres[self.spheres[i - lights.len() - self.meshes.len()]];
                sphere.centre.as_dvec3() + random.direction() * f64::from(sphere.radius)
            }
            _ => self.ball.0 + random.direction() * self.ball.1,
        };
        Ray::new(start.origin, (target - start.origin.as_dvec3()).as_vec3()).with_range(0.0, 0.9999)
    }

    /// A uniform point of a random triangle.
    fn on_mesh(&self, mesh: usize, random: &mut Random) -> DVec3 {
        let mesh = &self.scene.meshes[mesh];
        let corners = mesh.triangles[random.below(mesh.triangles.len())];
        let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
        let (u, v) = (random.unit(), random.unit());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        a + u * (b - a) + v * (c - a)
    }
}
