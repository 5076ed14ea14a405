//! What the caller hangs on a ray, in the way of either version.

use crate::built::Built;
use crate::types::{
    Arguments4, Context3, Context4, FilterFunction, Hit, INVALID_ID, INVOKE_FILTER, Ray, UserFunction, Version,
    scene_flag,
};
use std::ffi::c_void;
use std::ptr;

/// What the caller hung on a ray, in either version's way.
#[derive(Clone, Copy, Debug)]
pub enum Asked {
    /// Embree 3: a context that may not be null.
    Three(*mut Context3),
    /// Embree 4: arguments that may be null.
    Four(*const Arguments4),
}

impl Asked {
    /// Runs `trace` on the terms of a ray, unless it is no ray that anything can meet.
    ///
    /// # Safety
    /// The pointers are good for the size of what Embree 3 or 4 has there.
    pub unsafe fn with_terms(&self, built: &Built, ray: *mut Ray, hit: *mut Hit, trace: impl FnOnce(Terms)) {
        // SAFETY: as the caller promises; what is made here lives as long as `trace` runs.
        unsafe {
            let masks = built.device().has_masks();
            // With a NaN there is no range.
            let active = (*ray).tnear <= (*ray).tfar;
            if !active || (masks && (*ray).mask == 0) {
                return;
            }
            let mut own = Context4 { instance: INVALID_ID, instance_primitive: INVALID_ID };
            let mut terms = Terms {
                ray,
                hit,
                version: built.device().version(),
                context: ptr::null_mut(),
                instance: &raw mut own.instance,
                instance_primitive: ptr::null_mut(),
                filter: None,
                filter_everywhere: false,
                function: None,
                masks,
            };
            match *self {
                Asked::Three(context) => {
                    terms.context = context.cast();
                    if !context.is_null() {
                        terms.instance = &raw mut (*context).instance;
                        if built.signature.flags & scene_flag::CONTEXT_FILTER != 0 {
                            terms.filter = (*context).filter;
                            terms.filter_everywhere = true;
                        }
                    }
                }
                Asked::Four(arguments) => {
                    let mut context = &raw mut own;
                    if let Some(arguments) = arguments.as_ref() {
                        if !arguments.context.is_null() {
                            context = arguments.context;
                        }
                        terms.filter = arguments.filter;
                        terms.filter_everywhere = arguments.flags & INVOKE_FILTER != 0;
                        terms.function = arguments.function;
                    }
                    terms.context = context.cast();
                    terms.instance = &raw mut (*context).instance;
                    terms.instance_primitive = &raw mut (*context).instance_primitive;
                }
            }
            trace(terms);
        }
    }
}

/// What the caller hung on the ray: the same in all instances.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// The ray, which ends at the closest hit so far.
    pub ray: *mut Ray,
    /// Where the closest hit goes; null if any hit will do.
    pub hit: *mut Hit,
    /// Which layout the hit has.
    pub version: Version,
    /// What callbacks get.
    pub context: *mut c_void,
    /// The number of the instance that the ray is in.
    pub instance: *mut u32,
    /// Its primitive; null for Embree 3.
    pub instance_primitive: *mut u32,
    /// Filter of the context or the arguments.
    pub filter: Option<FilterFunction>,
    /// True if it is asked about geometries too that did not say so.
    pub filter_everywhere: bool,
    /// For user geometries without a function of their own.
    pub function: Option<UserFunction>,
    /// True if masks count.
    pub masks: bool,
}
