//! The types of Embree's C interface, with the names and the layout of its headers.

use std::ffi::{c_char, c_int, c_void};

/// No geometry, primitive or instance.
pub const INVALID_ID: u32 = u32::MAX;

/// Which of Embree's interfaces a library has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// Embree 3.13: contexts are arguments of their own, hits have no instance primitive.
    Three,
    /// Embree 4.4: contexts and filters come in optional arguments.
    Four,
}

/// `RTCError`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum ErrorCode {
    /// Nothing went wrong.
    None = 0,
    /// A fault without a code of its own.
    Unknown = 1,
    /// An argument that no call may have.
    InvalidArgument = 2,
    /// A call that the object does not allow, or that this library does not support.
    InvalidOperation = 3,
    /// No memory, or the memory monitor refused.
    OutOfMemory = 4,
    /// Never raised here.
    UnsupportedCpu = 5,
    /// The progress monitor stopped the build.
    Cancelled = 6,
}

/// `RTCGeometryType`, those that are supported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GeometryType {
    /// `RTC_GEOMETRY_TYPE_TRIANGLE`.
    Triangle,
    /// `RTC_GEOMETRY_TYPE_QUAD`.
    Quad,
    /// `RTC_GEOMETRY_TYPE_USER`.
    User,
    /// `RTC_GEOMETRY_TYPE_INSTANCE`.
    Instance,
}

impl GeometryType {
    /// The supported type of a number, or what the number means to Embree.
    ///
    /// # Errors
    /// The type is not supported.
    pub fn of(number: u32) -> Result<Self, &'static str> {
        Err(match number {
            0 => return Ok(Self::Triangle),
            1 => return Ok(Self::Quad),
            120 => return Ok(Self::User),
            121 => return Ok(Self::Instance),
            2 => "grid meshes",
            8 => "subdivision surfaces",
            15..=17 => "linear curves",
            24..=26 => "Bezier curves",
            32..=34 => "B-spline curves",
            40..=42 => "Hermite curves",
            50..=52 => "points",
            58..=60 => "Catmull-Rom curves",
            122 => "instance arrays",
            _ => "geometries of an unknown type",
        })
    }
}

/// `RTCBufferType`, those of triangles and quads.
pub mod buffer_type {
    /// Corners of primitives.
    pub const INDEX: u32 = 0;
    /// Positions.
    pub const VERTEX: u32 = 1;
    /// Values to be interpolated.
    pub const VERTEX_ATTRIBUTE: u32 = 2;
}

/// `RTCFormat`, those that are supported.
pub mod format {
    /// Three u32.
    pub const UINT3: u32 = 0x5003;
    /// Four u32.
    pub const UINT4: u32 = 0x5004;
    /// One f32; `FLOAT + n - 1` is n of them, up to 16.
    pub const FLOAT: u32 = 0x9001;
    /// Three f32.
    pub const FLOAT3: u32 = 0x9003;
    /// Sixteen f32.
    pub const FLOAT16: u32 = 0x9010;
    /// Three rows of four f32.
    pub const FLOAT3X4_ROW_MAJOR: u32 = 0x9134;
    /// Four rows of four f32.
    pub const FLOAT4X4_ROW_MAJOR: u32 = 0x9144;
    /// Four columns of three f32.
    pub const FLOAT3X4_COLUMN_MAJOR: u32 = 0x9234;
    /// Four columns of four f32.
    pub const FLOAT4X4_COLUMN_MAJOR: u32 = 0x9244;

    /// Bytes of an item, `None` for formats that are not supported.
    pub fn bytes(format: u32) -> Option<usize> {
        match format {
            UINT3 => Some(12),
            UINT4 => Some(16),
            FLOAT..=FLOAT16 => Some(4 * (format - FLOAT + 1) as usize),
            _ => None,
        }
    }
}

/// `RTCSceneFlags`.
pub mod scene_flag {
    /// Scenes that change often.
    pub const DYNAMIC: u32 = 1;
    /// Less memory.
    pub const COMPACT: u32 = 2;
    /// Tests that avoid holes.
    pub const ROBUST: u32 = 4;
    /// Filters of the context (3) or of the arguments (4) are called.
    pub const CONTEXT_FILTER: u32 = 8;
    /// All of them.
    pub const ALL: u32 = 15;
}

/// `RTCBounds`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct Bounds {
    /// Least corner and padding.
    pub lower: [f32; 4],
    /// Greatest corner and padding.
    pub upper: [f32; 4],
}

impl Bounds {
    /// Contains nothing.
    pub const EMPTY: Bounds = Bounds {
        lower: [f32::INFINITY, f32::INFINITY, f32::INFINITY, 0.0],
        upper: [f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY, 0.0],
    };
}

/// `RTCRay`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(16))]
pub struct Ray {
    /// Origin.
    pub origin: [f32; 3],
    /// Start of the segment, itself excluded.
    pub tnear: f32,
    /// Direction.
    pub direction: [f32; 3],
    /// Time for motion blur, which is not supported.
    pub time: f32,
    /// End of the segment; where the hit is.
    pub tfar: f32,
    /// Geometries that share no bit with it are not there.
    pub mask: u32,
    /// For the caller.
    pub id: u32,
    /// For the caller.
    pub flags: u32,
}

/// `RTCHit` of Embree 4. Embree 3 ends before the last member: those of callers are never taken as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Normal of the geometry, not of unit length, in the instance's own space.
    pub normal: [f32; 3],
    /// Weight of the second corner.
    pub u: f32,
    /// Weight of the third corner.
    pub v: f32,
    /// Primitive of the geometry.
    pub primitive: u32,
    /// Geometry of the scene.
    pub geometry: u32,
    /// Instance in the scene that rays are traced in.
    pub instance: u32,
    /// Primitive of the instance; Embree 4 only.
    pub instance_primitive: u32,
}

/// u32 or f32 that a ray is made of.
pub const RAY_WORDS: usize = 12;

/// u32 or f32 that a hit is made of.
pub const fn hit_words(version: Version) -> usize {
    match version {
        Version::Three => 8,
        Version::Four => 9,
    }
}

/// `RTCErrorFunction`.
pub type ErrorFunction = unsafe extern "C-unwind" fn(*mut c_void, ErrorCode, *const c_char);
/// `RTCMemoryMonitorFunction`.
pub type MemoryMonitor = unsafe extern "C-unwind" fn(*mut c_void, isize, bool) -> bool;
/// `RTCProgressMonitorFunction`.
pub type ProgressMonitor = unsafe extern "C-unwind" fn(*mut c_void, f64) -> bool;
/// `RTCBoundsFunction`.
pub type BoundsFunction = unsafe extern "C-unwind" fn(*const BoundsArguments);
/// `RTCIntersectFunctionN` and `RTCOccludedFunctionN`.
pub type UserFunction = unsafe extern "C-unwind" fn(*const UserArguments);
/// `RTCFilterFunctionN`.
pub type FilterFunction = unsafe extern "C-unwind" fn(*const FilterArguments);

/// `RTCBoundsFunctionArguments`.
#[derive(Debug)]
#[repr(C)]
pub struct BoundsArguments {
    /// The geometry's user data.
    pub geometry_user: *mut c_void,
    /// Primitive.
    pub primitive: u32,
    /// Always 0.
    pub time_step: u32,
    /// Where the box goes.
    pub bounds: *mut Bounds,
}

/// `RTCIntersectFunctionNArguments` and `RTCOccludedFunctionNArguments`.
#[derive(Debug)]
#[repr(C)]
pub struct UserArguments {
    /// One number, -1.
    pub valid: *mut c_int,
    /// The geometry's user data.
    pub geometry_user: *mut c_void,
    /// Primitive.
    pub primitive: u32,
    /// As the caller gave it.
    pub context: *mut c_void,
    /// A ray and its hit, or a ray alone.
    pub ray: *mut Ray,
    /// Always 1.
    pub n: u32,
    /// Geometry of the scene.
    pub geometry: u32,
}

/// `RTCFilterFunctionNArguments`.
#[derive(Debug)]
#[repr(C)]
pub struct FilterArguments {
    /// One number: -1 in, 0 out if the hit is refused.
    pub valid: *mut c_int,
    /// The geometry's user data.
    pub geometry_user: *mut c_void,
    /// As the caller gave it.
    pub context: *mut c_void,
    /// The ray, which ends at the hit.
    pub ray: *mut Ray,
    /// The hit.
    pub hit: *mut Hit,
    /// Always 1.
    pub n: u32,
}

/// `RTCIntersectContext` of Embree 3.
#[derive(Debug)]
#[repr(C)]
pub struct Context3 {
    /// Advice that is not needed.
    pub flags: u32,
    /// Called after the geometry's filter in scenes with [`scene_flag::CONTEXT_FILTER`].
    pub filter: Option<FilterFunction>,
    /// Instance that the ray is in.
    pub instance: u32,
}

/// `RTCRayQueryContext` of Embree 4.
#[derive(Debug)]
#[repr(C)]
pub struct Context4 {
    /// Instance that the ray is in.
    pub instance: u32,
    /// Its primitive.
    pub instance_primitive: u32,
}

/// `RTCIntersectArguments` and `RTCOccludedArguments` of Embree 4.
#[derive(Debug)]
#[repr(C)]
pub struct Arguments4 {
    /// [`INVOKE_FILTER`] and advice.
    pub flags: u32,
    /// Advice.
    pub features: u32,
    /// May be null.
    pub context: *mut Context4,
    /// Called after the geometry's filter, where the geometry or the flags say so.
    pub filter: Option<FilterFunction>,
    /// Called for user geometries that have no function of their own.
    pub function: Option<UserFunction>,
}

/// `RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER`.
pub const INVOKE_FILTER: u32 = 2;

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{align_of, offset_of, size_of};

    #[test]
    fn layouts_are_those_of_the_headers() {
        assert_eq!((size_of::<Ray>(), align_of::<Ray>()), (48, 16));
        assert_eq!((offset_of!(Ray, direction), offset_of!(Ray, tfar), offset_of!(Ray, flags)), (16, 32, 44));
        assert_eq!(size_of::<Ray>(), 4 * RAY_WORDS);
        assert_eq!(size_of::<Hit>(), 4 * hit_words(Version::Four));
        assert_eq!(offset_of!(Hit, instance_primitive), 4 * hit_words(Version::Three));
        assert_eq!(size_of::<Bounds>(), 32);
        assert_eq!(offset_of!(Context3, instance), 16);
        assert_eq!((offset_of!(UserArguments, context), offset_of!(UserArguments, n)), (24, 40));
        assert_eq!((size_of::<FilterArguments>(), offset_of!(FilterArguments, n)), (48, 40));
        assert_eq!((offset_of!(Arguments4, context), offset_of!(Arguments4, function)), (8, 24));
    }

    #[test]
    fn formats_have_the_size_of_their_items() {
        assert_eq!(format::bytes(format::FLOAT3), Some(12));
        assert_eq!(format::bytes(format::FLOAT16), Some(64));
        assert_eq!(format::bytes(format::UINT4), Some(16));
        assert_eq!(format::bytes(0x3001), None);
    }
}
