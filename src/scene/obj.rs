//! OBJ and MTL scenes.
use super::SceneParts;
use crate::error::{Error, Result};
use std::path::Path;
pub(super) fn read(path: &Path) -> Result<SceneParts> {
    Err(Error::malformed(path, "soon"))
}
