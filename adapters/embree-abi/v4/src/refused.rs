//! Functions of Embree 4 that are not supported: each raises an error that names it, so that nothing is left out silently.

use skipgrid_embree::device::{Fault, raise_without_device};
use std::ffi::c_void;
use std::ptr::null_mut;

/// Functions whose arguments do not matter. C callers may pass more than these take.
macro_rules! refused {
    ($($name:ident $(-> $back:ty = $value:expr)?;)*) => {$(
        #[unsafe(no_mangle)]
        extern "C-unwind" fn $name() $(-> $back)? {
            raise_without_device(&Fault::unsupported(stringify!($name)));
            $($value)?
        }
    )*};
}

refused! {
    rtcCommitBuffer;
    rtcForwardIntersect1;
    rtcForwardIntersect16;
    rtcForwardIntersect16Ex;
    rtcForwardIntersect1Ex;
    rtcForwardIntersect4;
    rtcForwardIntersect4Ex;
    rtcForwardIntersect8;
    rtcForwardIntersect8Ex;
    rtcForwardOccluded1;
    rtcForwardOccluded16;
    rtcForwardOccluded16Ex;
    rtcForwardOccluded1Ex;
    rtcForwardOccluded4;
    rtcForwardOccluded4Ex;
    rtcForwardOccluded8;
    rtcForwardOccluded8Ex;
    rtcGetBufferDataDevice -> *mut c_void = null_mut();
    rtcGetGeometryBufferDataDevice -> *mut c_void = null_mut();
    rtcGetGeometryTransformEx;
    rtcGetGeometryTransformFromTraversable;
    rtcGetGeometryUserDataFromTraversable -> *mut c_void = null_mut();
    rtcGetSceneTraversable -> *mut c_void = null_mut();
    rtcNewBufferHostDevice -> *mut c_void = null_mut();
    rtcNewSharedBufferHostDevice -> *mut c_void = null_mut();
    rtcSetGeometryInstancedScenes;
    rtcSetNewGeometryBufferHostDevice;
    rtcSetSharedGeometryBufferHostDevice;
    rtcTraversableForwardIntersect1;
    rtcTraversableForwardIntersect16;
    rtcTraversableForwardIntersect16Ex;
    rtcTraversableForwardIntersect1Ex;
    rtcTraversableForwardIntersect4;
    rtcTraversableForwardIntersect4Ex;
    rtcTraversableForwardIntersect8;
    rtcTraversableForwardIntersect8Ex;
    rtcTraversableForwardOccluded1;
    rtcTraversableForwardOccluded16;
    rtcTraversableForwardOccluded16Ex;
    rtcTraversableForwardOccluded1Ex;
    rtcTraversableForwardOccluded4;
    rtcTraversableForwardOccluded4Ex;
    rtcTraversableForwardOccluded8;
    rtcTraversableForwardOccluded8Ex;
    rtcTraversableIntersect1;
    rtcTraversableIntersect16;
    rtcTraversableIntersect4;
    rtcTraversableIntersect8;
    rtcTraversableOccluded1;
    rtcTraversableOccluded16;
    rtcTraversableOccluded4;
    rtcTraversableOccluded8;
    rtcTraversablePointQuery -> bool = false;
    rtcTraversablePointQuery16 -> bool = false;
    rtcTraversablePointQuery4 -> bool = false;
    rtcTraversablePointQuery8 -> bool = false;
}
