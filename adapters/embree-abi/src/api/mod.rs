//! The functions that programs call, by Embree's names: those that both versions have.
//!
//! Errors are raised on the device that the argument belongs to, or without a device where the argument is null.

#![allow(non_snake_case, reason = "names are those of the C interface")]

pub mod devices;
pub mod geometries;
pub mod refused;
pub mod scenes;

use crate::device::{Fault, raise_without_device};
use crate::handle;

/// Functions with C names that may be unwound through: callbacks of C++ programs throw.
macro_rules! c_functions {
    ($($(#[$doc:meta])* fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $back:ty)? $body:block)*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// As Embree demands: handles are null or alive, pointers good for what they are said to point to.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name($($argument: $type),*) $(-> $back)? {
            // SAFETY: as the caller promises.
            #[allow(unused_unsafe, reason = "some of the functions need nothing unsafe")]
            unsafe { $body }
        }
    )*};
}
pub(crate) use c_functions;

/// The object of a handle, or an error.
///
/// # Safety
/// The handle is null or alive.
pub(crate) unsafe fn object<'a, T>(handle: *const T, what: &str) -> Option<&'a T> {
    // SAFETY: as the caller promises.
    let found = unsafe { handle::get(handle) };
    if found.is_none() {
        raise_without_device(&Fault::argument(format!("{what} that is null")));
    }
    found
}
