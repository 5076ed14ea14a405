//! Geometries as callers describe them, before scenes build anything over them.

use crate::buffer::{Buffer, View};
use crate::device::{Callback, Device, Fault};
use crate::scene::Scene;
use crate::types::{
    BoundsFunction, FilterFunction, GeometryType, INVALID_ID, UserFunction, Version, buffer_type, format,
};
use glam::DAffine3;
use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A geometry, shared by the caller and the scenes that it is attached to.
#[derive(Debug)]
pub struct Geometry {
    /// Where its errors go.
    pub device: Arc<Device>,
    /// What it consists of.
    pub kind: GeometryType,
    state: Mutex<State>,
    /// Apart from the rest: programs ask for it at every hit.
    user: AtomicPtr<c_void>,
    changes: AtomicU64,
}

/// What a geometry was told.
#[derive(Clone, Debug)]
pub struct State {
    views: Vec<(u32, u32, View)>,
    /// Rays that share no bit with it pass.
    pub mask: u32,
    /// False while it is as if not attached.
    pub enabled: bool,
    /// Vertex attributes that may be set.
    pub attributes: u32,
    /// Primitives of a user geometry.
    pub user_primitives: u32,
    /// Boxes of a user geometry's primitives.
    pub bounds: Callback<BoundsFunction>,
    /// Closest hit with a user geometry's primitive.
    pub intersect: Option<UserFunction>,
    /// Any hit with a user geometry's primitive.
    pub occluded: Option<UserFunction>,
    /// Asked about each closest hit.
    pub intersect_filter: Option<FilterFunction>,
    /// Asked about each hit that hides.
    pub occluded_filter: Option<FilterFunction>,
    /// Embree 4: filters of arguments are asked too.
    pub filter_from_arguments: bool,
    /// What an instance shows.
    pub instanced: Option<Arc<Scene>>,
    /// From the space of `instanced` to that of the scene.
    pub transform: DAffine3,
}

// SAFETY: nothing behind the pointers is touched here.
unsafe impl Send for Geometry {}
// SAFETY: as above.
unsafe impl Sync for Geometry {}

impl Geometry {
    /// A geometry without primitives.
    ///
    /// # Errors
    /// The type is not supported.
    pub fn new(device: Arc<Device>, kind: u32) -> Result<Self, Fault> {
        let kind = GeometryType::of(kind).map_err(Fault::unsupported)?;
        let mask = match device.version() {
            Version::Three => u32::MAX,
            Version::Four => 1,
        };
        let state = State {
            views: Vec::new(),
            mask,
            enabled: true,
            attributes: 0,
            user_primitives: 0,
            bounds: Callback::NONE,
            intersect: None,
            occluded: None,
            intersect_filter: None,
            occluded_filter: None,
            filter_from_arguments: false,
            instanced: None,
            transform: DAffine3::IDENTITY,
        };
        let user = AtomicPtr::new(ptr::null_mut());
        Ok(Self { device, kind, state: Mutex::new(state), user, changes: AtomicU64::new(0) })
    }

    /// What it was told up to now.
    pub fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells it something.
    pub fn set(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state());
        self.changed();
    }

    /// Scenes build anew: something that they copied has changed.
    pub fn changed(&self) {
        self.changes.fetch_add(1, Ordering::AcqRel);
    }

    /// Differs from what it was before a change.
    pub fn changes(&self) -> u64 {
        self.changes.load(Ordering::Acquire)
    }

    /// The caller's own pointer.
    pub fn user(&self) -> *mut c_void {
        self.user.load(Ordering::Acquire)
    }

    /// Sets the caller's own pointer.
    pub fn set_user(&self, user: *mut c_void) {
        self.user.store(user, Ordering::Release);
        self.changed();
    }

    /// Sees items of a buffer as the corners, the vertices or the values of the geometry.
    ///
    /// # Errors
    /// The geometry has no such items, or they have another format.
    pub fn set_view(&self, kind: u32, slot: u32, view: View) -> Result<(), Fault> {
        let mut state = self.state();
        self.suits(&state, kind, slot, view.format())?;
        state.views.retain(|(k, s, _)| (*k, *s) != (kind, slot));
        state.views.push((kind, slot, view));
        drop(state);
        self.changed();
        Ok(())
    }

    /// Sees the items of a new buffer; returns where they are.
    ///
    /// # Errors
    /// As [`Geometry::set_view`] and [`Buffer::new`].
    pub fn set_new_buffer(
        &self,
        kind: u32,
        slot: u32,
        format: u32,
        stride: usize,
        count: usize,
    ) -> Result<*mut c_void, Fault> {
        self.suits(&self.state(), kind, slot, format)?;
        let bytes =
            stride.checked_mul(count).ok_or_else(|| Fault::argument(format!("{count} items every {stride} bytes")))?;
        let view = View::new(Arc::new(Buffer::new(self.device.clone(), bytes)?), 0, stride, count, format)?;
        let data = view.data();
        self.set_view(kind, slot, view)?;
        Ok(data)
    }

    fn suits(&self, state: &State, kind: u32, slot: u32, format: u32) -> Result<(), Fault> {
        let corners = match self.kind {
            GeometryType::Triangle => format::UINT3,
            GeometryType::Quad => format::UINT4,
            GeometryType::User | GeometryType::Instance => {
                return Err(Fault::operation("user geometries and instances have no buffers"));
            }
        };
        let slots = if kind == buffer_type::VERTEX_ATTRIBUTE { state.attributes } else { 1 };
        if slot >= slots {
            return Err(Fault::argument(format!("buffer slot {slot} of {slots}")));
        }
        match kind {
            buffer_type::INDEX if format != corners => {
                Err(Fault::operation(format!("indices of format {format:#x}, not {corners:#x}")))
            }
            buffer_type::VERTEX if format != format::FLOAT3 => {
                Err(Fault::operation(format!("vertices of format {format:#x}, not three f32")))
            }
            buffer_type::VERTEX_ATTRIBUTE if !(format::FLOAT..=format::FLOAT16).contains(&format) => {
                Err(Fault::operation(format!("vertex attributes of format {format:#x}, not f32")))
            }
            buffer_type::INDEX | buffer_type::VERTEX | buffer_type::VERTEX_ATTRIBUTE => Ok(()),
            _ => Err(Fault::unsupported(&format!("buffers of type {kind} for triangles and quads"))),
        }
    }
}

impl State {
    /// The items that were set for a type and slot.
    pub fn view(&self, kind: u32, slot: u32) -> Option<&View> {
        self.views.iter().find(|(k, s, _)| (*k, *s) == (kind, slot)).map(|(_, _, view)| view)
    }

    /// Takes an instance's scene, or takes it back.
    pub fn set_instanced(&mut self, scene: Option<Arc<Scene>>) {
        self.instanced = scene;
    }

    /// The corners of each primitive as indices of vertices: of triangles the fourth is none.
    pub fn corners(&self, kind: GeometryType) -> Vec<[u32; 4]> {
        let Some(view) = self.view(buffer_type::INDEX, 0) else { return Vec::new() };
        (0..view.count())
            .map(|item| match kind {
                GeometryType::Quad => view.words(item).unwrap_or([INVALID_ID; 4]),
                _ => view.words(item).map_or([INVALID_ID; 4], |[a, b, c]| [a, b, c, INVALID_ID]),
            })
            .collect()
    }
}
