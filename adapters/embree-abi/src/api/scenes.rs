//! `rtc*Scene*`, and attaching geometries to them.

use super::{c_functions, object};
use crate::device::{Callback, Device, Fault};
use crate::geometry::Geometry;
use crate::handle;
use crate::scene::Scene;
use crate::types::{Bounds, INVALID_ID, ProgressMonitor};
use skipgrid::Aabb;
use std::ffi::c_void;
use std::ptr;
use std::sync::Arc;

/// Runs `work` on the scene of a handle; raises its error, if any.
///
/// # Safety
/// The handle is null or alive.
unsafe fn with(scene: *const Scene, work: impl FnOnce(&Scene) -> Result<(), Fault>) {
    // SAFETY: as the caller promises.
    if let Some(scene) = unsafe { object(scene, "a scene") } {
        scene.device.check(work(scene), ());
    }
}

/// The box of what was committed.
fn bounds(scene: &Scene) -> Bounds {
    let Aabb { min, max } = scene.with_built(|built| built.map_or(Aabb::EMPTY, |built| built.bounds()));
    Bounds { lower: [min.x, min.y, min.z, 0.0], upper: [max.x, max.y, max.z, 0.0] }
}

c_functions! {
    /// `rtcNewScene`.
    fn rtcNewScene(device: *const Device) -> *const Scene {
        object(device, "a device");
        handle::share(device).map_or(ptr::null(), |device| handle::give(Arc::new(Scene::new(device))))
    }

    /// `rtcGetSceneDevice`: the caller gets a count of its own.
    fn rtcGetSceneDevice(scene: *const Scene) -> *const Device {
        object(scene, "a scene").map_or(ptr::null(), |scene| handle::give(scene.device.clone()))
    }

    /// `rtcRetainScene`.
    fn rtcRetainScene(scene: *const Scene) {
        std::mem::forget(handle::share(scene));
        object(scene, "a scene");
    }

    /// `rtcReleaseScene`.
    fn rtcReleaseScene(scene: *const Scene) {
        if !handle::release(scene) {
            object(scene, "a scene");
        }
    }

    /// `rtcAttachGeometry`.
    fn rtcAttachGeometry(scene: *const Scene, geometry: *const Geometry) -> u32 {
        let Some(scene) = object(scene, "a scene") else { return INVALID_ID };
        let geometry = handle::share(geometry).ok_or_else(|| Fault::argument("a geometry that is null"));
        scene.device.check(geometry.and_then(|geometry| scene.attach(geometry, None)), INVALID_ID)
    }

    /// `rtcAttachGeometryByID`.
    fn rtcAttachGeometryByID(scene: *const Scene, geometry: *const Geometry, id: u32) {
        with(scene, |scene| {
            let geometry = handle::share(geometry).ok_or_else(|| Fault::argument("a geometry that is null"))?;
            scene.attach(geometry, Some(id)).map(drop)
        });
    }

    /// `rtcDetachGeometry`.
    fn rtcDetachGeometry(scene: *const Scene, id: u32) {
        with(scene, |scene| scene.detach(id));
    }

    /// `rtcGetGeometry`: the scene's count keeps it alive.
    fn rtcGetGeometry(scene: *const Scene, id: u32) -> *const Geometry {
        object(scene, "a scene").and_then(|scene| scene.geometry(id)).map_or(ptr::null(), |geometry| Arc::as_ptr(&geometry))
    }

    /// `rtcGetGeometryThreadSafe`.
    fn rtcGetGeometryThreadSafe(scene: *const Scene, id: u32) -> *const Geometry {
        rtcGetGeometry(scene, id)
    }

    /// `rtcCommitScene`.
    fn rtcCommitScene(scene: *const Scene) {
        with(scene, Scene::commit);
    }

    /// `rtcJoinCommitScene`: one of the threads builds, with those of the device; the others wait.
    fn rtcJoinCommitScene(scene: *const Scene) {
        with(scene, Scene::commit);
    }

    /// `rtcSetSceneProgressMonitorFunction`.
    fn rtcSetSceneProgressMonitorFunction(scene: *const Scene, function: Option<ProgressMonitor>, user: *mut c_void) {
        with(scene, |scene| {
            scene.set_progress(Callback { function, user });
            Ok(())
        });
    }

    /// `rtcSetSceneBuildQuality`.
    fn rtcSetSceneBuildQuality(scene: *const Scene, quality: u32) {
        with(scene, |scene| scene.set_quality(quality));
    }

    /// `rtcSetSceneFlags`.
    fn rtcSetSceneFlags(scene: *const Scene, flags: u32) {
        with(scene, |scene| scene.set_flags(flags));
    }

    /// `rtcGetSceneFlags`.
    fn rtcGetSceneFlags(scene: *const Scene) -> u32 {
        object(scene, "a scene").map_or(0, Scene::flags)
    }

    /// `rtcGetSceneBounds`.
    fn rtcGetSceneBounds(scene: *const Scene, to: *mut Bounds) {
        with(scene, |scene| {
            if to.is_null() {
                return Err(Fault::argument("a place for bounds that is null"));
            }
            to.write_unaligned(bounds(scene));
            Ok(())
        });
    }

    /// `rtcGetSceneLinearBounds`: without motion both ends are the same.
    fn rtcGetSceneLinearBounds(scene: *const Scene, to: *mut [Bounds; 2]) {
        with(scene, |scene| {
            if to.is_null() {
                return Err(Fault::argument("a place for bounds that is null"));
            }
            to.write_unaligned([bounds(scene); 2]);
            Ok(())
        });
    }
}
