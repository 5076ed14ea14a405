//! Exports a scene to POV-Ray.
