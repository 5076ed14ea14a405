//! Whitted 1980, "An Improved Illumination Model for Shaded Display": no random numbers.
//!
//! Point, spot and directional lights with shadow rays at diffuse and rough surfaces; mirrors; dielectrics split every
//! ray in two by Fresnel's formulas and let no shadow ray pass. Emission and environment are seen by the eye, over
//! mirrors and through glass, but light nothing; rough conductors show lights only. Radiance is not scaled at
//! refractions. All of it as POV-Ray has it, which sees the same picture with `max_trace_level` one less than
//! `max_depth`: the last edge of a path is the connection to a light, so no scattered ray is traced along it.

use super::super::scatter::{self, Lobe};
use super::super::tracer::{Tracer, Vertex};
use crate::accel::Accel;
use crate::ray::Ray;
use glam::DVec3;

/// Share of a sample below which a branch is cut: far below the last digit of a pixel in f32.
const NEGLIGIBLE: f64 = 1e-9;

/// Radiance that arrives along `ray` from the eye.
pub(in super::super) fn radiance<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray) -> DVec3 {
    trace(tracer, ray, 1, 1.0)
}

/// Radiance that arrives along `ray`, edge `edge` of a path, of which the share `weight` reaches the eye.
fn trace<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray, edge: u32, weight: f64) -> DVec3 {
    let stage = tracer.stage;
    let Some(vertex) = tracer.vertex(ray, edge) else { return stage.scene.environment.as_dvec3() };
    let emission = tracer.emission(&vertex);
    if edge == stage.max_depth {
        return emission;
    }
    let lobe = Lobe::at(stage.scene, &vertex);
    let scattered = match lobe {
        Lobe::Lambert { .. } | Lobe::Conductor(_) => direct(tracer, &vertex, &lobe),
        Lobe::Mirror { reflectance } => {
            let direction = scatter::mirrored(&vertex);
            reflectance * branch(tracer, &vertex, direction, edge, weight * reflectance.max_element())
        }
        Lobe::Dielectric { ratio } => {
            let split = scatter::split(&vertex, ratio);
            let (back, through) = (split.reflectance, 1.0 - split.reflectance);
            branch(tracer, &vertex, split.reflected, edge, weight * back) * back
                + branch(tracer, &vertex, split.refracted, edge, weight * through) * through
        }
    };
    emission + scattered
}

/// Radiance that arrives from `direction`, unless the path would get too long or matters too little.
fn branch<A: Accel + ?Sized>(
    tracer: &mut Tracer<A>,
    vertex: &Vertex,
    direction: DVec3,
    edge: u32,
    weight: f64,
) -> DVec3 {
    if edge + 1 >= tracer.stage.max_depth || weight < NEGLIGIBLE {
        return DVec3::ZERO;
    }
    let ray = tracer.leave(vertex, direction);
    trace(tracer, &ray, edge + 1, weight)
}

/// Light that the lights without extent send to the viewer by way of `vertex`.
fn direct<A: Accel + ?Sized>(tracer: &mut Tracer<A>, vertex: &Vertex, lobe: &Lobe) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for emitter in tracer.stage.lights.delta() {
        let Some(arrival) = emitter.arrival(vertex.position) else { continue };
        let light = lobe.evaluate(vertex, arrival.direction).0 * arrival.radiance;
        if light != DVec3::ZERO && tracer.lit(vertex, &arrival) {
            sum += light;
        }
    }
    sum
}
