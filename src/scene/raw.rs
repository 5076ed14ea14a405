//! Bare triangles, spheres and rays: `.tri`, `.sph`, `.rays`, `.truth`.
