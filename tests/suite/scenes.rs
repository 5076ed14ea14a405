//! Scene files, loaders and procedural scenes.
