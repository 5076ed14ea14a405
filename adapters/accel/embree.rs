//! Intel's Embree 3 or 4, opened at run time: nothing of it is needed to build this program.
//!
//! A peer to compare with, as its authors intend: one triangle mesh or one set of spheres, single rays, its own tests in f32. The library is
//! the one that the environment variable `SKIPGRID_EMBREE` names, else what the system finds under Embree's usual names.
//!
//! Some builds of Embree (Debian's 3.13.5 is one) check rays by assertions, which end the process. So no ray is handed over
//! that such a check refuses: not what [`Ray::intake`] refuses, none with a negative `t_min` (0 instead) and none beyond 2^60,
//! which all miss; see [`super::soup`]. Embree ignores triangles beyond that itself.
//!
//! Nodes and tests are not counted.

#![allow(unsafe_code, reason = "calls into a C library")]

use super::soup::{Given, Labels, Soup, forwards};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::{Error, Result};
use crate::geometry::Sphere;
use crate::ray::{Aabb, Ray};
use libloading::Library;
use std::ffi::{c_char, c_int, c_void};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};

/// Names the library to open instead of the system's.
pub const VARIABLE: &str = "SKIPGRID_EMBREE";

/// Under these names, the first that opens, unless [`VARIABLE`] is set.
const NAMES: [&str; 8] = [
    "libembree4.so.4",
    "libembree4.so",
    "libembree3.so.3",
    "libembree3.so",
    "libembree4.4.dylib",
    "libembree3.3.dylib",
    "embree4.dll",
    "embree3.dll",
];

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
    /// Names as in specifications.
    pub const NAMES: [(&'static str, Quality); 3] =
        [("low", Quality::Low), ("medium", Quality::Medium), ("high", Quality::High)];
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

// Opaque things of Embree's.
type Device = *mut c_void;
type Geometry = *mut c_void;
type Handle = *mut c_void;

// Constants of `rtcore_common.h`, `rtcore_buffer.h`, `rtcore_device.h`, `rtcore_geometry.h` and `rtcore_scene.h`, the same in 3 and 4.
const VERSION_MAJOR: c_int = 1;
const TRIANGLES: c_int = 0;
const SPHERES: c_int = 50;
const INDEX_BUFFER: c_int = 0;
const VERTEX_BUFFER: c_int = 1;
const UINT3: c_int = 0x5003;
const FLOAT3: c_int = 0x9003;
const FLOAT4: c_int = 0x9004;
const ROBUST: c_int = 1 << 2;
const INVALID: u32 = u32::MAX;
const OUT_OF_MEMORY: c_int = 4;

type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// The functions of Embree that are used here.
struct Api {
    /// Version, and where it comes from.
    name: String,
    new_device: unsafe extern "C" fn(*const c_char) -> Device,
    release_device: unsafe extern "C" fn(Device),
    device_error: unsafe extern "C" fn(Device) -> c_int,
    set_memory_monitor: unsafe extern "C" fn(Device, Option<Monitor>, *mut c_void),
    new_geometry: unsafe extern "C" fn(Device, c_int) -> Geometry,
    new_buffer: unsafe extern "C" fn(Geometry, c_int, u32, c_int, usize, usize) -> *mut c_void,
    commit_geometry: unsafe extern "C" fn(Geometry),
    release_geometry: unsafe extern "C" fn(Geometry),
    new_scene: unsafe extern "C" fn(Device) -> Handle,
    set_flags: unsafe extern "C" fn(Handle, c_int),
    set_quality: unsafe extern "C" fn(Handle, c_int),
    attach: unsafe extern "C" fn(Handle, Geometry) -> u32,
    commit: unsafe extern "C" fn(Handle),
    release_scene: unsafe extern "C" fn(Handle),
    queries: Queries,
    /// Keeps the code in memory: for good, since Embree's threads may outlive its devices.
    _library: Library,
}

/// `rtcIntersect1` and `rtcOccluded1`, which take a context before the ray in Embree 3 and arguments after it in Embree 4.
enum Queries {
    Three {
        intersect: unsafe extern "C" fn(Handle, *mut Context, *mut RayHit),
        occluded: unsafe extern "C" fn(Handle, *mut Context, *mut RayHit),
    },
    Four {
        intersect: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
        occluded: unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void),
    },
}

/// `RTCIntersectContext` of Embree 3, with room for deeper instances than it is usually built for.
#[repr(C)]
struct Context {
    flags: c_int,
    filter: *const c_void,
    instances: [u32; 16],
}

/// `RTCRayHit`, which begins with the `RTCRay`, with room for deeper instances than Embree is usually built for.
#[repr(C, align(16))]
struct RayHit {
    origin: [f32; 3],
    near: f32,
    direction: [f32; 3],
    time: f32,
    far: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    u: f32,
    v: f32,
    prim: u32,
    geometry: u32,
    instances: [u32; 13],
}

impl RayHit {
    /// `ray` comes from [`forwards`].
    #[inline]
    fn new(ray: &Ray) -> Self {
        Self {
            origin: ray.origin.to_array(),
            near: ray.t_min,
            direction: ray.direction.to_array(),
            time: 0.0,
            far: ray.t_max,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            prim: INVALID,
            geometry: INVALID,
            instances: [INVALID; 13],
        }
    }
}

/// The library, opened once, or why there is none.
fn api() -> std::result::Result<&'static Api, String> {
    static API: OnceLock<std::result::Result<Api, String>> = OnceLock::new();
    API.get_or_init(Api::open).as_ref().map_err(Clone::clone)
}

impl Api {
    fn open() -> std::result::Result<Self, String> {
        let help = "apt install libembree-dev or the like, or name the library in SKIPGRID_EMBREE";
        if let Some(path) = std::env::var_os(VARIABLE) {
            let name = path.to_string_lossy().into_owned();
            return open(&path)
                .and_then(|library| Self::of(library, &name))
                .map_err(|cause| format!("needs Embree 3 or 4, but {VARIABLE}={name} will not do: {cause}"));
        }
        let Some((library, name)) = NAMES.iter().find_map(|name| Some((open(name.as_ref()).ok()?, name))) else {
            return Err(format!("needs Embree 3 or 4: {help} (found none of {})", NAMES.join(", ")));
        };
        Self::of(library, name).map_err(|cause| format!("needs Embree 3 or 4, but {name} will not do: {cause}; {help}"))
    }

    fn of(library: Library, name: &str) -> std::result::Result<Self, String> {
        // SAFETY: the types of the functions are those of `rtcore_device.h`; enumerations are C's int.
        let (new_device, release_device, property): (
            unsafe extern "C" fn(*const c_char) -> Device,
            unsafe extern "C" fn(Device),
            unsafe extern "C" fn(Device, c_int) -> isize,
        ) = unsafe {
            (
                symbol(&library, "rtcNewDevice")?,
                symbol(&library, "rtcReleaseDevice")?,
                symbol(&library, "rtcGetDeviceProperty")?,
            )
        };
        // SAFETY: a null pointer asks for the default configuration, and a null device is not used further.
        let version = unsafe {
            let device = new_device(std::ptr::null());
            if device.is_null() {
                return Err("it makes no device".to_string());
            }
            let version = property(device, VERSION_MAJOR);
            release_device(device);
            version
        };
        let queries = match version {
            // SAFETY: the types are those of `rtcore_scene.h` of Embree 3; for a function of rays a `RayHit` begins with one.
            3 => unsafe {
                Queries::Three {
                    intersect: symbol(&library, "rtcIntersect1")?,
                    occluded: symbol(&library, "rtcOccluded1")?,
                }
            },
            // SAFETY: the types are those of `rtcore_scene.h` of Embree 4.
            4 => unsafe {
                Queries::Four {
                    intersect: symbol(&library, "rtcIntersect1")?,
                    occluded: symbol(&library, "rtcOccluded1")?,
                }
            },
            other => return Err(format!("it is version {other}")),
        };
        // SAFETY: the types are those of `rtcore_device.h`, `rtcore_geometry.h` and `rtcore_scene.h`, the same in 3 and 4.
        unsafe {
            Ok(Self {
                name: format!("Embree {version} ({name})"),
                new_device,
                release_device,
                device_error: symbol(&library, "rtcGetDeviceError")?,
                set_memory_monitor: symbol(&library, "rtcSetDeviceMemoryMonitorFunction")?,
                new_geometry: symbol(&library, "rtcNewGeometry")?,
                new_buffer: symbol(&library, "rtcSetNewGeometryBuffer")?,
                commit_geometry: symbol(&library, "rtcCommitGeometry")?,
                release_geometry: symbol(&library, "rtcReleaseGeometry")?,
                new_scene: symbol(&library, "rtcNewScene")?,
                set_flags: symbol(&library, "rtcSetSceneFlags")?,
                set_quality: symbol(&library, "rtcSetSceneBuildQuality")?,
                attach: symbol(&library, "rtcAttachGeometry")?,
                commit: symbol(&library, "rtcCommitScene")?,
                release_scene: symbol(&library, "rtcReleaseScene")?,
                queries,
                _library: library,
            })
        }
    }
}

fn open(name: &std::ffi::OsStr) -> std::result::Result<Library, String> {
    // SAFETY: opening runs the library's initialisers: the user asked for Embree, and is trusted to have a real one.
    unsafe { Library::new(name) }.map_err(|error| error.to_string())
}

/// The function `name`.
///
/// # Safety
/// `T` is the type of the function.
unsafe fn symbol<T: Copy>(library: &Library, name: &str) -> std::result::Result<T, String> {
    // SAFETY: as the caller promises.
    let symbol = unsafe { library.get::<T>(name.as_bytes()) };
    symbol.map(|symbol| *symbol).map_err(|error| error.to_string())
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

impl Context {
    /// As `rtcInitIntersectContext` has it: rays that have nothing in common, no filter, no instance.
    #[inline]
    fn new() -> Self {
        Self { flags: 0, filter: std::ptr::null(), instances: [INVALID; 16] }
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
        let quality = Quality::NAMES.iter().find(|(_, q)| *q == self.options.quality).map_or("", |(name, _)| name);
        let robust = if self.options.robust { ", robust" } else { "" };
        let name = &self.scene.api.name;
        self.labels.describe(&format!("{name}, quality {quality}{robust}, nodes and tests are not counted"))
    }
}
