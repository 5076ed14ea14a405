//! Handles: what the C side holds of an object is one count of an [`Arc`].

use std::sync::Arc;

/// The handle of a new object; the caller owns one count of it.
pub fn give<T>(object: Arc<T>) -> *const T {
    Arc::into_raw(object)
}

/// The object of a handle.
///
/// # Safety
/// `handle` is null or comes from [`give`], and a count of it lasts as long as the reference is used.
pub unsafe fn get<'a, T>(handle: *const T) -> Option<&'a T> {
    // SAFETY: as the caller promises.
    unsafe { handle.as_ref() }
}

/// A count of its own for the object of a handle.
///
/// # Safety
/// `handle` is null or comes from [`give`], and a count of it is alive.
pub unsafe fn share<T>(handle: *const T) -> Option<Arc<T>> {
    if handle.is_null() {
        return None;
    }
    // SAFETY: as the caller promises; the count that `from_raw` takes is the one that is added here.
    unsafe {
        Arc::increment_strong_count(handle);
        Some(Arc::from_raw(handle))
    }
}

/// Takes back one count of a handle. False if it is null.
///
/// # Safety
/// `handle` is null or comes from [`give`], and the caller owns a count of it that it gives up.
pub unsafe fn release<T>(handle: *const T) -> bool {
    if handle.is_null() {
        return false;
    }
    // SAFETY: as the caller promises.
    drop(unsafe { Arc::from_raw(handle) });
    true
}
