//! Scenes: which geometries are attached, and when what was built over them is built anew.

use crate::built::{Built, Signature};
use crate::device::{Callback, Device, Fault};
use crate::geometry::Geometry;
use crate::report;
use crate::types::{INVALID_ID, ProgressMonitor, scene_flag};
use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard};
use std::time::Instant;

/// A scene.
#[derive(Debug)]
pub struct Scene {
    /// Where its errors go.
    pub device: Arc<Device>,
    slots: RwLock<Vec<Option<Arc<Geometry>>>>,
    flags: AtomicU32,
    quality: AtomicU32,
    progress: Mutex<Callback<ProgressMonitor>>,
    committing: Mutex<()>,
    /// Comes from a box; null before the first commit. Replaced by commits, during which no ray may be traced.
    built: AtomicPtr<Built>,
}

// SAFETY: nothing behind the callback's pointer is touched here; what is built is Send and Sync itself.
unsafe impl Send for Scene {}
// SAFETY: as above.
unsafe impl Sync for Scene {}

impl Scene {
    /// A scene with nothing in it.
    pub fn new(device: Arc<Device>) -> Self {
        Self {
            device,
            slots: RwLock::default(),
            flags: AtomicU32::new(0),
            // RTC_BUILD_QUALITY_MEDIUM
            quality: AtomicU32::new(1),
            progress: Mutex::new(Callback::NONE),
            committing: Mutex::new(()),
            built: AtomicPtr::new(ptr::null_mut()),
        }
    }

    fn slots(&self) -> RwLockReadGuard<'_, Vec<Option<Arc<Geometry>>>> {
        self.slots.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// Attaches a geometry under the first number that is free, or under `id`.
    ///
    /// # Errors
    /// The number is taken, or there are too many.
    pub fn attach(&self, geometry: Arc<Geometry>, id: Option<u32>) -> Result<u32, Fault> {
        let mut slots = self.slots.write().unwrap_or_else(PoisonError::into_inner);
        let free = || slots.iter().position(Option::is_none).unwrap_or(slots.len());
        let index = id.map_or_else(free, |id| id as usize);
        // A number from nowhere must not take memory without bound.
        if index >= slots.len() + (1 << 24) {
            return Err(Fault::argument(format!("geometry number {index} in a scene of {}", slots.len())));
        }
        if slots.get(index).is_some_and(Option::is_some) {
            return Err(Fault::operation(format!("geometry number {index} is taken")));
        }
        if index >= slots.len() {
            slots.resize(index + 1, None);
        }
        slots[index] = Some(geometry);
        u32::try_from(index).map_err(|_| Fault::argument("too many geometries"))
    }

    /// Detaches the geometry with a number.
    ///
    /// # Errors
    /// There is none.
    pub fn detach(&self, id: u32) -> Result<(), Fault> {
        let mut slots = self.slots.write().unwrap_or_else(PoisonError::into_inner);
        let slot = slots.get_mut(id as usize).and_then(Option::take);
        drop(slots);
        slot.map(drop).ok_or_else(|| Fault::operation(format!("no geometry has the number {id}")))
    }

    /// The geometry with a number.
    pub fn geometry(&self, id: u32) -> Option<Arc<Geometry>> {
        self.slots().get(id as usize).cloned().flatten()
    }

    /// Scene flags.
    pub fn flags(&self) -> u32 {
        self.flags.load(Ordering::Relaxed)
    }

    /// Sets scene flags. Answers are always watertight and exact, so that most change nothing.
    ///
    /// # Errors
    /// A flag is not known.
    pub fn set_flags(&self, flags: u32) -> Result<(), Fault> {
        if flags & !scene_flag::ALL != 0 {
            return Err(Fault::argument(format!("scene flags {flags:#x}")));
        }
        self.flags.store(flags, Ordering::Relaxed);
        Ok(())
    }

    /// Sets the effort of builds.
    ///
    /// # Errors
    /// Scenes have no such quality.
    pub fn set_quality(&self, quality: u32) -> Result<(), Fault> {
        if quality > 2 {
            return Err(Fault::operation(format!("build quality {quality} of a scene")));
        }
        self.quality.store(quality, Ordering::Relaxed);
        Ok(())
    }

    /// Sets who hears how far builds are.
    pub fn set_progress(&self, callback: Callback<ProgressMonitor>) {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = callback;
    }

    /// Builds what rays need, if anything has changed. Threads that come meanwhile wait and find it done.
    ///
    /// # Errors
    /// As [`Built::new`]; what was built before is kept.
    pub fn commit(&self) -> Result<(), Fault> {
        let _only_one = self.committing.lock().unwrap_or_else(PoisonError::into_inner);
        let geometries: Vec<(u32, Arc<Geometry>)> = (0..INVALID_ID)
            .zip(self.slots().iter())
            .filter_map(|(id, slot)| Some((id, slot.clone()?)))
            .filter(|(_, geometry)| geometry.state().enabled)
            .collect();
        let signature = Signature {
            geometries: geometries.iter().map(|(id, geometry)| signature(*id, geometry)).collect(),
            flags: self.flags(),
            quality: self.quality.load(Ordering::Relaxed),
        };
        if self.with_built(|built| built.is_some_and(|built| built.signature == signature)) {
            return Ok(());
        }
        let Callback { function, user } = *self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the caller set both for this purpose.
        let goes_on = |share: f64| function.is_none_or(|function| unsafe { function(user, share) });
        let filters_in_queries = self.flags() & scene_flag::CONTEXT_FILTER != 0;
        let start = Instant::now();
        let built = Built::new(self, &geometries, signature, filters_in_queries, goes_on)?;
        report::built(start.elapsed());
        self.replace(Box::into_raw(Box::new(built)));
        Ok(())
    }

    fn replace(&self, built: *mut Built) {
        let old = self.built.swap(built, Ordering::AcqRel);
        if !old.is_null() {
            // SAFETY: it came from a box, and no ray is traced during commits and after the last release, as Embree demands.
            drop(unsafe { Box::from_raw(old) });
        }
    }

    /// What the last commit built, if there was one.
    #[inline]
    pub fn with_built<R>(&self, see: impl FnOnce(Option<&Built>) -> R) -> R {
        // SAFETY: it lives until the next commit or the last release, during which callers may do nothing else with the scene.
        see(unsafe { self.built.load(Ordering::Acquire).as_ref() })
    }
}

/// What tells whether a geometry is as it was.
fn signature(id: u32, geometry: &Arc<Geometry>) -> (u32, usize, u64, usize) {
    let shown = geometry.state().instanced.as_ref().map_or(0, |scene| scene.built.load(Ordering::Acquire).addr());
    (id, Arc::as_ptr(geometry).addr(), geometry.changes(), shown)
}

impl Drop for Scene {
    fn drop(&mut self) {
        self.replace(ptr::null_mut());
    }
}
