//! Embree's C interface: declarations of `rtcore.h`, and the library that is opened at run time.

#![allow(unsafe_code, reason = "calls into a C library")]

use crate::ray::Ray;
use libloading::Library;
use std::ffi::{c_char, c_int, c_void};
use std::sync::OnceLock;

/// Names the library to open instead of the system's.
const VARIABLE: &str = "SKIPGRID_EMBREE";

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

// Opaque things of Embree's.
pub(super) type Device = *mut c_void;
pub(super) type Geometry = *mut c_void;
pub(super) type Handle = *mut c_void;

// Constants of `rtcore_common.h`, `rtcore_buffer.h`, `rtcore_device.h`, `rtcore_geometry.h` and `rtcore_scene.h`, the same
// in 3 and 4.
pub(super) const VERSION_MAJOR: c_int = 1;
pub(super) const TRIANGLES: c_int = 0;
pub(super) const SPHERES: c_int = 50;
pub(super) const INDEX_BUFFER: c_int = 0;
pub(super) const VERTEX_BUFFER: c_int = 1;
pub(super) const UINT3: c_int = 0x5003;
pub(super) const FLOAT3: c_int = 0x9003;
pub(super) const FLOAT4: c_int = 0x9004;
pub(super) const ROBUST: c_int = 1 << 2;
pub(super) const INVALID: u32 = u32::MAX;
pub(super) const OUT_OF_MEMORY: c_int = 4;

pub(super) type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// The functions of Embree that are used here.
pub(super) struct Api {
    /// Version, and where it comes from.
    pub name: String,
    pub new_device: unsafe extern "C" fn(*const c_char) -> Device,
    pub release_device: unsafe extern "C" fn(Device),
    pub device_error: unsafe extern "C" fn(Device) -> c_int,
    pub set_memory_monitor: unsafe extern "C" fn(Device, Option<Monitor>, *mut c_void),
    pub new_geometry: unsafe extern "C" fn(Device, c_int) -> Geometry,
    pub new_buffer: unsafe extern "C" fn(Geometry, c_int, u32, c_int, usize, usize) -> *mut c_void,
    pub commit_geometry: unsafe extern "C" fn(Geometry),
    pub release_geometry: unsafe extern "C" fn(Geometry),
    pub new_scene: unsafe extern "C" fn(Device) -> Handle,
    pub set_flags: unsafe extern "C" fn(Handle, c_int),
    pub set_quality: unsafe extern "C" fn(Handle, c_int),
    pub attach: unsafe extern "C" fn(Handle, Geometry) -> u32,
    pub commit: unsafe extern "C" fn(Handle),
    pub release_scene: unsafe extern "C" fn(Handle),
    pub queries: Queries,
    /// Keeps the code in memory: for good, since Embree's threads may outlive its devices.
    _library: Library,
}

/// `rtcIntersect1` and `rtcOccluded1`, which take a context before the ray in Embree 3 and arguments after it in Embree 4.
pub(super) enum Queries {
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
pub(super) struct Context {
    flags: c_int,
    filter: *const c_void,
    instances: [u32; 16],
}

impl Context {
    /// As `rtcInitIntersectContext` has it: rays that have nothing in common, no filter, no instance.
    #[inline]
    pub fn new() -> Self {
        Self { flags: 0, filter: std::ptr::null(), instances: [INVALID; 16] }
    }
}

/// `RTCRayHit`, which begins with the `RTCRay`, with room for deeper instances than Embree is usually built for.
#[repr(C, align(16))]
pub(super) struct RayHit {
    pub origin: [f32; 3],
    pub near: f32,
    pub direction: [f32; 3],
    pub time: f32,
    pub far: f32,
    pub mask: u32,
    pub id: u32,
    pub flags: u32,
    pub normal: [f32; 3],
    pub u: f32,
    pub v: f32,
    pub prim: u32,
    pub geometry: u32,
    pub instances: [u32; 13],
}

impl RayHit {
    /// `ray` comes from [`forwards`].
    #[inline]
    pub fn new(ray: &Ray) -> Self {
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
pub(super) fn api() -> std::result::Result<&'static Api, String> {
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
