//! Pictures of geometry and of work: no light in them.

use super::super::sampler::mix;
use super::super::tracer::Tracer;
use crate::accel::Accel;
use crate::ray::Ray;
use glam::DVec3;

/// See [`crate::render::Integrator::Depth`]. `ray` has a unit direction.
pub(in super::super) fn depth<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray) -> DVec3 {
    tracer.seen(ray).map_or(DVec3::ZERO, |hit| DVec3::splat(f64::from(hit.t)))
}

/// See [`crate::render::Integrator::Normal`].
pub(in super::super) fn normal<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray) -> DVec3 {
    tracer.vertex(ray, 1).map_or(DVec3::ZERO, |vertex| (vertex.shading + 1.0) / 2.0)
}

/// See [`crate::render::Integrator::Prim`].
pub(in super::super) fn prim<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray) -> DVec3 {
    tracer.seen(ray).map_or(DVec3::ZERO, |hit| colour(hit.prim))
}

/// See [`crate::render::Integrator::Steps`].
pub(in super::super) fn steps<A: Accel + ?Sized>(tracer: &mut Tracer<A>, ray: &Ray) -> DVec3 {
    let counts = tracer.seen_counted(ray);
    // Counts stay far below 2^53.
    DVec3::new(counts.steps as f64, counts.tests as f64, counts.leaps as f64)
}

/// A colour for an index, channels 0.1 to 1; neighbours differ.
fn colour(prim: u32) -> DVec3 {
    let bits = mix(u64::from(prim));
    let channel = |shift: u32| 0.1 + 0.9 * f64::from((bits >> shift) as u8) / 255.0;
    DVec3::new(channel(0), channel(8), channel(16))
}
