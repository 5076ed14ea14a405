//! The one error type of the library: every variant says which thing is at fault and the values that clash.

use std::path::{Path, PathBuf};

/// What went wrong, where, and with which values.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read or written.
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A file was read but its content is not usable.
    Malformed {
        /// The file.
        path: PathBuf,
        /// Place and cause, such as "face 12 refers to vertex 900 of 640".
        cause: String,
    },
    /// An accelerator specification such as `grid:density=4` is not understood.
    Spec {
        /// The specification as given.
        spec: String,
        /// Which part is wrong and what would be right.
        cause: String,
    },
    /// A structure would need more memory than its budget, or more than the system gives.
    TooLarge {
        /// What was to be built, with its size.
        what: String,
        /// Bytes that it would take.
        wanted: u64,
        /// Bytes that it may take; 0 where there is no budget and the system refuses them.
        allowed: u64,
    },
    /// What was given in memory breaks a stated precondition, or another library refuses it.
    Invalid {
        /// The thing, its place and the cause.
        cause: String,
    },
}

/// The library's result.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// [`Error::Malformed`]: a file's content is not usable; `cause` names the place and the reason.
    pub fn malformed(path: impl AsRef<Path>, cause: impl Into<String>) -> Self {
        Error::Malformed { path: path.as_ref().to_path_buf(), cause: cause.into() }
    }

    /// [`Error::Io`]: a file could not be read or written.
    pub fn io(path: impl AsRef<Path>, source: std::io::Error) -> Self {
        Error::Io { path: path.as_ref().to_path_buf(), source }
    }

    /// [`Error::Invalid`]: what was given in memory is not usable; `cause` names the thing, its place and the reason.
    pub fn invalid(cause: impl Into<String>) -> Self {
        Error::Invalid { cause: cause.into() }
    }

    /// The program's exit code for this error: 3 for input and output, else 2.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Io { .. } => 3,
            _ => 2,
        }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Error::Io { path, source } => write!(f, "{}: {source}", path.display()),
            Error::Malformed { path, cause } => write!(f, "{}: {cause}", path.display()),
            Error::Spec { spec, cause } => write!(f, "accelerator `{spec}`: {cause}"),
            Error::TooLarge { what, wanted, allowed } => {
                write!(f, "{what}: wants {wanted} bytes, allowed are {allowed}")
            }
            Error::Invalid { cause } => f.write_str(cause),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}
