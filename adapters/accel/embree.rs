//! Intel's Embree 3 or 4, opened at run time: nothing of it is needed to build this program.
//!
//! A peer to compare with, as its authors intend: one triangle mesh or one set of spheres, single rays, its own tests in
//! f32. The library is the one that the environment variable `SKIPGRID_EMBREE` names, else what the system finds under
//! Embree's usual names.
//!
//! Some builds of Embree (Debian's 3.13.5 is one) check rays by assertions, which end the process. So no ray is handed over
//! that such a check refuses: not what [`Ray::intake`] refuses, none with a negative `t_min` (0 instead) and none beyond 2^60,
//! which all miss; see [`super::soup`]. Embree ignores triangles beyond that itself.
//!
//! Nodes and tests are not counted.

#![allow(unsafe_code, reason = "calls into a C library")]

mod interface;

use super::soup::{Given, Labels, Soup, forwards};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::{Error, Result};
use crate::geometry::Sphere;
use crate::ray::{Aabb, Ray};
use interface::{
    Api, Context, Device, FLOAT3, FLOAT4, Handle, INDEX_BUFFER, INVALID, OUT_OF_MEMORY, Queries, ROBUST, RayHit,
    SPHERES, TRIANGLES, UINT3, VERTEX_BUFFER, api,
};
use std::ffi::{c_int, c_void};
use std::sync::atomic::{AtomicI64, Ordering};

/// How much work Embree puts into its tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// `RTC_BUILD_QUALITY_LOW`: Morton codes.
    Low,
    /// `RTC_BUILD_QUALITY_MEDIUM`: binned surface areas; Embree's default.
    #[default]
    Medium,
    /// `RTC_BUILD_QUALITY_HIGH`: with spatial splits.
    High,
}

impl Quality {
    /// Names as in specifications, in the order of the variants.
    pub const NAMES: [(&'static str, Quality); 3] =
        [("low", Quality::Low), ("medium", Quality::Medium), ("high", Quality::High)];

    /// Its name in specifications.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// What rays go through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// Effort of the build.
    pub quality: Quality,
    /// `RTC_SCENE_FLAG_ROBUST`: tests that avoid holes at shared edges.
    pub robust: bool,
}

/// Builds Embree's BVH over what is given, on all cores.
///
/// # Errors
/// There is no Embree, see [`missing`]; or Embree reports an error.
pub fn embree(given: Given, options: Options) -> Result<Box<dyn Accel>> {
    let api = api().map_err(Error::invalid)?;
    let (scene, labels) = match given {
        Given::Triangles(Soup { shapes, labels }) => (Scene::new(api, Shapes::Triangles(&shapes), options)?, labels),
        Given::Spheres(Soup { shapes, labels }) => (Scene::new(api, Shapes::Spheres(&shapes), options)?, labels),
    };
    Ok(Box::new(Adapter { scene, labels, options }))
}

/// Why there is no Embree on this machine, and what helps; `None` if there is.
pub fn missing() -> Option<String> {
    api().err()
}

/// What a scene is made of.
#[derive(Clone, Copy)]
enum Shapes<'a> {
    Triangles(&'a [crate::Triangle]),
    Spheres(&'a [Sphere]),
}

impl Shapes<'_> {
    fn len(self) -> usize {
        match self {
            Shapes::Triangles(triangles) => triangles.len(),
            Shapes::Spheres(spheres) => spheres.len(),
        }
    }
}

/// A committed scene of one mesh or set of spheres, with its device.
struct Scene {
    api: &'static Api,
    /// Null only while it is built.
    device: Device,
    /// Null only while it is built.
    handle: Handle,
    /// Bytes that the device holds; its address is the monitor's.
    bytes: Box<AtomicI64>,
}

// SAFETY: a committed scene may be traced by several threads at once, says Embree's manual, and nothing here changes it. The
// handles do not belong to a thread.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Drop for Scene {
    fn drop(&mut self) {
        // SAFETY: both are ours, released once, the scene before its device; no thread traces what is being dropped.
        unsafe {
            if !self.handle.is_null() {
                (self.api.release_scene)(self.handle);
            }
            if !self.device.is_null() {
                (self.api.release_device)(self.device);
            }
        }
    }
}

/// Counts what Embree allocates and frees; `counter` is a [`Scene::bytes`].
unsafe extern "C" fn monitor(counter: *mut c_void, bytes: isize, _: bool) -> bool {
    // SAFETY: the counter lives in a box of the scene, which outlives the device that calls this.
    unsafe { &*counter.cast::<AtomicI64>() }.fetch_add(bytes as i64, Ordering::Relaxed);
    true
}

impl Scene {
    fn new(api: &'static Api, shapes: Shapes, options: Options) -> Result<Self> {
        let null = std::ptr::null_mut();
        let mut scene = Self { api, device: null, handle: null, bytes: Box::default() };
        // SAFETY: handles are checked before use; `Drop` releases them on every way out, and after it the counter.
        unsafe {
            scene.device = (api.new_device)(std::ptr::null());
            scene.check("rtcNewDevice", shapes.len(), scene.device)?;
            let counter: *const AtomicI64 = &*scene.bytes;
            (api.set_memory_monitor)(scene.device, Some(monitor), counter.cast_mut().cast());
            scene.handle = (api.new_scene)(scene.device);
            scene.check("rtcNewScene", shapes.len(), scene.handle)?;
            (api.set_flags)(scene.handle, if options.robust { ROBUST } else { 0 });
            (api.set_quality)(scene.handle, options.quality as c_int);
            match shapes {
                _ if shapes.len() == 0 => (),
                Shapes::Triangles(triangles) => scene.attach(triangles)?,
                Shapes::Spheres(spheres) => scene.attach_spheres(spheres)?,
            }
            (api.commit)(scene.handle);
            scene.check("rtcCommitScene", shapes.len(), scene.handle)?;
        }
        Ok(scene)
    }

    /// Copies the triangles, at least one, into a mesh of the scene.
    fn attach(&self, triangles: &[crate::Triangle]) -> Result<()> {
        let (api, count) = (self.api, triangles.len());
        // SAFETY: the device and the scene are not null. Buffers are checked before they are filled, with what they were asked
        // for: `3 * count` corners of 12 bytes and `count` triples of 12 bytes, which `Soup` keeps within u32 and which have
        // no alignment beyond 4. The geometry is released here on every way out; the scene holds its own reference.
        unsafe {
            let geometry = (api.new_geometry)(self.device, TRIANGLES);
            self.check("rtcNewGeometry", count, geometry)?;
            let corners = (api.new_buffer)(geometry, VERTEX_BUFFER, 0, FLOAT3, 12, 3 * count);
            let indices = (api.new_buffer)(geometry, INDEX_BUFFER, 0, UINT3, 12, count);
            let checked = [corners, indices].iter().try_for_each(|b| self.check("rtcSetNewGeometryBuffer", count, *b));
            if checked.is_ok() {
                let corners = std::slice::from_raw_parts_mut(corners.cast::<[f32; 3]>(), 3 * count);
                corners.iter_mut().zip(triangles.iter().flatten()).for_each(|(to, corner)| *to = corner.to_array());
                let indices = std::slice::from_raw_parts_mut(indices.cast::<u32>(), 3 * count);
                indices.iter_mut().zip(0..).for_each(|(to, index)| *to = index);
                (api.commit_geometry)(geometry);
                (api.attach)(self.handle, geometry);
            }
            (api.release_geometry)(geometry);
            checked?;
            self.check("rtcAttachGeometry", count, self.handle)
        }
    }

    /// Copies the spheres, at least one, into a set of the scene.
    fn attach_spheres(&self, spheres: &[Sphere]) -> Result<()> {
        let (api, count) = (self.api, spheres.len());
        // SAFETY: the device and the scene are not null. The buffer is checked before it is filled, with what it was asked
        // for: `count` quadruples of 16 bytes, of floats. The geometry is released here on every way out; the scene holds its
        // own reference.
        unsafe {
            let geometry = (api.new_geometry)(self.device, SPHERES);
            self.check("rtcNewGeometry", count, geometry)?;
            let buffer = (api.new_buffer)(geometry, VERTEX_BUFFER, 0, FLOAT4, 16, count);
            let checked = self.check("rtcSetNewGeometryBuffer", count, buffer);
            if checked.is_ok() {
                let places = std::slice::from_raw_parts_mut(buffer.cast::<[f32; 4]>(), count);
                let place = |s: &Sphere| s.centre.extend(s.radius).to_array();
                places.iter_mut().zip(spheres).for_each(|(to, sphere)| *to = place(sphere));
                (api.commit_geometry)(geometry);
                (api.attach)(self.handle, geometry);
            }
            (api.release_geometry)(geometry);
            checked?;
            self.check("rtcAttachGeometry", count, self.handle)
        }
    }

    /// An error if `made` is null or the device has one to report.
    fn check(&self, function: &str, shapes: usize, made: *mut c_void) -> Result<()> {
        // SAFETY: a null device asks for the error of the last attempt to make one.
        let error = unsafe { (self.api.device_error)(self.device) };
        if error == 0 && !made.is_null() {
            return Ok(());
        }
        let cause = if error == OUT_OF_MEMORY { "no memory is left" } else { "see rtcore_device.h" };
        let name = &self.api.name;
        Err(Error::invalid(format!("{name}: {function} for {shapes} primitives fails with error {error}: {cause}")))
    }

    #[inline]
    fn intersect(&self, ray: &mut RayHit) {
        // SAFETY: the scene is committed; the structures are laid out as the version wants them, and outlive the call.
        unsafe {
            match self.api.queries {
                Queries::Three { intersect, .. } => intersect(self.handle, &mut Context::new(), ray),
                Queries::Four { intersect, .. } => intersect(self.handle, ray, std::ptr::null_mut()),
            }
        }
    }

    #[inline]
    fn occluded(&self, ray: &mut RayHit) {
        // SAFETY: as for `intersect`; a `RayHit` begins with the ray that this function takes.
        unsafe {
            match self.api.queries {
                Queries::Three { occluded, .. } => occluded(self.handle, &mut Context::new(), ray),
                Queries::Four { occluded, .. } => occluded(self.handle, ray, std::ptr::null_mut()),
            }
        }
    }
}

struct Adapter {
    scene: Scene,
    labels: Labels,
    options: Options,
}

impl Adapter {
    #[inline]
    fn closest<P: Probe>(&self, ray: &Ray, _: &mut P) -> Option<Hit> {
        let mut ray = RayHit::new(&forwards(ray)?);
        self.scene.intersect(&mut ray);
        (ray.geometry != INVALID).then(|| Hit { t: ray.far, prim: self.labels.prim(ray.prim) })
    }

    #[inline]
    fn any<P: Probe>(&self, ray: &Ray, _: &mut P) -> bool {
        let Some(ray) = forwards(ray) else { return false };
        let mut ray = RayHit::new(&ray);
        self.scene.occluded(&mut ray);
        ray.far == f32::NEG_INFINITY
    }
}

impl Accel for Adapter {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.labels.bounds
    }

    /// As Embree's memory monitor counts it: with its copy of the primitives.
    fn memory(&self) -> Memory {
        let bytes = self.scene.bytes.load(Ordering::Relaxed);
        Memory { structure: u64::try_from(bytes).unwrap_or(0), ..Memory::default() }
    }

    fn describe(&self) -> String {
        let quality = self.options.quality.name();
        let robust = if self.options.robust { ", robust" } else { "" };
        let name = &self.scene.api.name;
        self.labels.describe(&format!("{name}, quality {quality}{robust}, nodes and tests are not counted"))
    }
}
