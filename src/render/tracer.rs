//! Rays of one tile: traces them, counts them, and turns hits into what shading needs.

use super::film::RenderStats;
use super::light::{Arrival, Lights, Target};
use super::spawn::Spawner;
use crate::accel::{Accel, Counts, Hit, PointShadows, Shadow};
use crate::ray::Ray;
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// What all tiles share beside the accelerator.
pub(super) struct Stage<'a> {
    /// What is rendered.
    pub scene: &'a Scene,
    /// Its lights.
    pub lights: Lights,
    /// What is known of shadow rays to [`Lights::points`], if anything.
    pub shadows: Option<Box<dyn PointShadows>>,
    /// Makes rays that start on surfaces.
    pub spawner: Spawner,
    /// Longest path in edges.
    pub max_depth: u32,
    /// The edge from which on Russian roulette may end a path.
    pub rr_depth: u32,
}

/// Traces the rays of one tile.
pub(super) struct Tracer<'a, A: ?Sized> {
    /// What all tiles share.
    pub stage: &'a Stage<'a>,
    accel: &'a A,
    /// Rays so far.
    pub stats: RenderStats,
}

/// A point on a surface, seen from somewhere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// World units.
    pub position: DVec3,
    /// Unit normal of the primitive, on the viewer's side.
    pub geometric: DVec3,
    /// Unit shading normal, on the viewer's side.
    pub shading: DVec3,
    /// Unit direction to the viewer.
    pub outgoing: DVec3,
    /// True if the viewer sees the front of the primitive.
    pub front: bool,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Index of the material.
    pub material: u32,
    /// Index of the primitive.
    pub prim: u32,
}

impl<'a, A: Accel + ?Sized> Tracer<'a, A> {
    /// A tracer that has traced nothing.
    pub fn new(stage: &'a Stage<'a>, accel: &'a A) -> Self {
        Self { stage, accel, stats: RenderStats::default() }
    }

    /// What a ray from the eye hits.
    pub fn seen(&mut self, ray: &Ray) -> Option<Hit> {
        self.stats.camera += 1;
        self.accel.closest_hit(ray)
    }

    /// As [`Tracer::seen`], and the work done.
    pub fn seen_counted(&mut self, ray: &Ray) -> Counts {
        self.stats.camera += 1;
        let mut counts = Counts::default();
        self.accel.closest_hit_counted(ray, &mut counts);
        counts
    }

    /// The surface at the end of edge `edge` of a path; edge 1 starts at the eye.
    pub fn vertex(&mut self, ray: &Ray, edge: u32) -> Option<Vertex> {
        let hit = if edge == 1 {
            self.seen(ray)?
        } else {
            self.stats.bounce += 1;
            self.accel.closest_hit(ray)?
        };
        Some(self.shade_point(ray, hit))
    }

    /// True if nothing lies between the surface and where the light comes from.
    pub fn lit(&mut self, vertex: &Vertex, arrival: &Arrival) -> bool {
        let spawner = &self.stage.spawner;
        let ray = match arrival.target {
            Target::Point(target, number) => {
                let ray = spawner.ending_at(vertex.position, vertex.geometric, target);
                let asked = self.stage.shadows.as_ref().map(|s| s.ask(number, vertex.prim, &ray));
                match asked.unwrap_or(Shadow::Unknown) {
                    known @ (Shadow::Lit | Shadow::Dark) => {
                        self.stats.spared += 1;
                        return known == Shadow::Lit;
                    }
                    Shadow::Until(t) => {
                        self.stats.shortened += 1;
                        ray.with_range(ray.t_min, t)
                    }
                    Shadow::Unknown => ray,
                }
            }
            Target::Surface(target, normal) => spawner.ending_on(vertex.position, vertex.geometric, target, normal),
            Target::Infinity => spawner.along(vertex.position, vertex.geometric, arrival.direction),
        };
        self.stats.shadow += 1;
        !self.accel.any_hit(&ray)
    }

    /// The ray that leaves the surface along the unit `direction`.
    pub fn leave(&self, vertex: &Vertex, direction: DVec3) -> Ray {
        self.stage.spawner.along(vertex.position, vertex.geometric, direction)
    }

    /// Radiance emitted towards the viewer: from the front only.
    pub fn emission(&self, vertex: &Vertex) -> DVec3 {
        let emission = self.stage.scene.materials[vertex.material as usize].emission;
        if vertex.front { emission.as_dvec3() } else { DVec3::ZERO }
    }

    fn shade_point(&self, ray: &Ray, hit: Hit) -> Vertex {
        let surface = self.stage.scene.surface(ray, hit);
        let outgoing = -ray.direction.as_dvec3().normalize();
        let front = surface.geometric_normal.dot(outgoing) >= 0.0;
        let turned = |normal: DVec3| if normal.dot(outgoing) < 0.0 { -normal } else { normal };
        Vertex {
            position: surface.position,
            geometric: turned(surface.geometric_normal),
            shading: turned(surface.shading_normal),
            outgoing,
            front,
            uv: surface.uv,
            material: surface.material,
            prim: hit.prim,
        }
    }
}
