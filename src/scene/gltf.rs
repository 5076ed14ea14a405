//! glTF 2.0 scenes.
use super::{LoadOptions, SceneParts};
use crate::error::{Error, Result};
use std::path::Path;
pub(super) fn read(path: &Path, _options: &LoadOptions) -> Result<SceneParts> {
    Err(Error::malformed(path, "soon"))
}
