//! Errors of the library as Python's exceptions.

use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyValueError};
use skipgrid::Error;

/// An argument is not usable.
pub fn invalid(cause: impl Into<String>) -> PyErr {
    PyValueError::new_err(cause.into())
}

/// OSError with number and name of the file, so that Python makes it FileNotFoundError and the like; MemoryError; or ValueError.
pub fn raised(error: Error) -> PyErr {
    match &error {
        Error::Io { path, source } => match source.raw_os_error() {
            Some(number) => {
                // The reason without the number, which Python adds itself.
                let text = source.to_string();
                let reason = text.split(" (os error").next().unwrap_or(&text).to_string();
                PyOSError::new_err((number, reason, path.display().to_string()))
            }
            None => PyOSError::new_err(error.to_string()),
        },
        Error::TooLarge { .. } => PyMemoryError::new_err(error.to_string()),
        _ => invalid(error.to_string()),
    }
}
