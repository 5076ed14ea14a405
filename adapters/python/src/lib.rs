//! The Python module: accelerators built from NumPy arrays or scenes, asked with arrays of rays.

mod arrays;
mod errors;
mod trace;

use arrays::{Rays, corners, floats};
use errors::{invalid, raised};
use glam::Vec3;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use skipgrid::accel::Counts;
use skipgrid::geometry::{Geometry, Sphere};
use skipgrid::oracle::{Oracle, Primitive};
use skipgrid::registry;
use skipgrid::scene::{self, LoadOptions, SceneGeometry};
use std::ffi::CString;
use std::sync::Arc;
use trace::{Threads, each_ray};

/// What `prim` is where nothing is hit.
const MISS: u32 = u32::MAX;

/// Times and primitives, one for each ray.
type Hits<'py, T> = (Bound<'py, PyArray1<T>>, Bound<'py, PyArray1<u32>>);

/// Triangles behind an accelerator; see also spheres() and load().
///
/// vertices: (n, 3) numbers, kept as float32. faces: (m, 3) integers, three vertices for each triangle. Both are copied: later
/// changes to the arrays change nothing here. Triangles with a coordinate that is not finite keep their index and are never hit.
///
/// accel: a name with options, such as "grid-octant:density=4"; accelerators() has all. threads: how many build; default: all.
///
/// Raises ValueError for arrays of another shape or type, faces that refer to no vertex, and names or options that are not
/// known; MemoryError for structures beyond their budget.
#[pyclass(frozen, module = "skipgrid")]
struct Accel {
    geometry: SceneGeometry,
    accel: Box<dyn skipgrid::Accel>,
    spec: String,
}

impl Accel {
    fn over(py: Python<'_>, geometry: SceneGeometry, spec: &str, threads: Option<usize>) -> PyResult<Self> {
        let threads = Threads::new(threads)?;
        let accel = py.detach(|| threads.run(|| geometry.accel(spec))).map_err(raised)?;
        Ok(Self { geometry, accel, spec: spec.into() })
    }

    /// Everything that the oracle knows.
    fn primitives(&self) -> PyResult<Vec<Primitive>> {
        fn of<G: Geometry>(set: &G) -> Option<Vec<Primitive>> {
            let triangle = |prim| set.triangle(prim).map(Primitive::Triangle);
            let sphere = |prim| set.sphere(prim).map(|s| Primitive::Sphere { centre: s.centre, radius: s.radius });
            (0..set.len()).map(|prim| triangle(prim).or_else(|| sphere(prim))).collect()
        }
        let primitives = match &self.geometry {
            SceneGeometry::Triangles(set) => of(set),
            SceneGeometry::Spheres(set) => of(set),
            SceneGeometry::Mixed(set) => of(set),
            SceneGeometry::Voxels(set) => of(set),
            SceneGeometry::Patches(_) => None,
        };
        primitives.ok_or_else(|| invalid("the exact truth is known for triangles, spheres and voxels, not for patches"))
    }

    fn len(&self) -> u32 {
        match &self.geometry {
            SceneGeometry::Triangles(set) => Geometry::len(set),
            SceneGeometry::Spheres(set) => Geometry::len(set),
            SceneGeometry::Mixed(set) => Geometry::len(set),
            SceneGeometry::Voxels(set) => Geometry::len(set),
            SceneGeometry::Patches(set) => Geometry::len(set),
        }
    }
}

#[pymethods]
impl Accel {
    #[new]
    #[pyo3(signature = (vertices, faces, accel = "nested", *, threads = None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        accel: &str,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let triangles = corners(vertices, faces)?;
        Self::over(vertices.py(), SceneGeometry::Triangles(Arc::new(triangles)), accel, threads)
    }

    /// The first primitive that each ray meets: (t, prim), float32 and uint32. A miss is t = inf and prim = 0xffffffff (MISS).
    ///
    /// rays: (n, 6) of ox oy oz dx dy dz; or (n, 8) of ox oy oz tmin dx dy dz tmax; or origins (n, 3), with directions (n, 3).
    /// float32 in C order is read where it is, and must not be written to meanwhile; all else is converted to a float32 copy.
    /// Directions need not be unit: t counts in their length. A ray that is not finite, has no direction or has tmin > tmax hits
    /// nothing. Both ends of the range count; without one it is 0 to inf.
    ///
    /// threads: how many trace; default: all. Other Python threads run meanwhile, and Ctrl-C ends it.
    #[pyo3(signature = (rays, directions = None, *, threads = None))]
    fn closest_hit<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        directions: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
    ) -> PyResult<Hits<'py, f32>> {
        let rays = Rays::of(rays, directions)?;
        let hits = each_ray(py, threads, &rays.view()?, |ray| {
            self.accel.closest_hit(&ray).map_or((f32::INFINITY, MISS), |hit| (hit.t, hit.prim))
        })?;
        let (t, prim): (Vec<f32>, Vec<u32>) = hits.into_iter().unzip();
        Ok((t.into_pyarray(py), prim.into_pyarray(py)))
    }

    /// Whether each ray meets anything within its range: an array of bool. Arguments as of closest_hit().
    #[pyo3(signature = (rays, directions = None, *, threads = None))]
    fn any_hit<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        directions: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let rays = Rays::of(rays, directions)?;
        Ok(each_ray(py, threads, &rays.view()?, |ray| self.accel.any_hit(&ray))?.into_pyarray(py))
    }

    /// What each ray hits in exact arithmetic: (t, prim), float64, the nearest to the exact value, and uint32; misses as of
    /// closest_hit(). Every primitive is looked at for every ray, by code of its own: slow, and the judge of all others.
    ///
    /// Raises ValueError for scenes of patches.
    #[pyo3(signature = (rays, directions = None, *, threads = None))]
    fn exact_hit<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        directions: Option<&Bound<'py, PyAny>>,
        threads: Option<usize>,
    ) -> PyResult<Hits<'py, f64>> {
        let (rays, primitives) = (Rays::of(rays, directions)?, self.primitives()?);
        let oracle = py.detach(|| Oracle::new(primitives));
        let hits = each_ray(py, threads, &rays.view()?, |ray| {
            oracle.closest(&ray).map_or((f64::INFINITY, MISS), |truth| (truth.t, truth.prims[0]))
        })?;
        let (t, prim): (Vec<f64>, Vec<u32>) = hits.into_iter().unzip();
        Ok((t.into_pyarray(py), prim.into_pyarray(py)))
    }

    /// The work of the rays, which does not depend on the machine: a dict with the sums "rays", "steps" (voxels or nodes visited),
    /// "leaps" (over several voxels), "leaves" (of trees) and "tests" (of primitives). 0 where an accelerator cannot count.
    /// any: of any_hit() instead of closest_hit(). Other arguments as there.
    #[pyo3(signature = (rays, directions = None, *, any = false, threads = None))]
    fn statistics<'py>(
        &self,
        py: Python<'py>,
        rays: &Bound<'py, PyAny>,
        directions: Option<&Bound<'py, PyAny>>,
        any: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let rays = Rays::of(rays, directions)?;
        let each = each_ray(py, threads, &rays.view()?, |ray| {
            let mut counts = Counts::default();
            if any {
                self.accel.any_hit_counted(&ray, &mut counts);
            } else {
                self.accel.closest_hit_counted(&ray, &mut counts);
            }
            counts
        })?;
        let mut sum = Counts::default();
        each.into_iter().for_each(|counts| sum += counts);
        let dict = PyDict::new(py);
        dict.set_item("rays", sum.rays)?;
        dict.set_item("steps", sum.steps)?;
        dict.set_item("leaps", sum.leaps)?;
        dict.set_item("leaves", sum.leaves)?;
        dict.set_item("tests", sum.tests)?;
        Ok(dict)
    }

    /// Bytes beside the primitives: a dict with "structure", "references", "tables" and "total".
    #[getter]
    fn memory<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let memory = self.accel.memory();
        let dict = PyDict::new(py);
        dict.set_item("structure", memory.structure)?;
        dict.set_item("references", memory.references)?;
        dict.set_item("tables", memory.tables)?;
        dict.set_item("total", memory.total())?;
        Ok(dict)
    }

    /// The least and the greatest corner of all that can be hit, float32 of shape (2, 3); inf and -inf if there is nothing.
    #[getter]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let bounds = self.accel.bounds();
        [bounds.min.to_array(), bounds.max.to_array()].concat().into_pyarray(py).reshape([2, 3])
    }

    /// The corners of all triangles, float32 of shape (n, 3, 3), by primitive. Raises ValueError if not all are triangles.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let SceneGeometry::Triangles(triangles) = &self.geometry else {
            return Err(invalid("not all primitives are triangles"));
        };
        let flat: Vec<f32> = triangles.iter().flatten().flat_map(|corner| corner.to_array()).collect();
        flat.into_pyarray(py).reshape([Vec::len(triangles), 3, 3])
    }

    /// The accelerator as it was asked for.
    #[getter]
    fn accel(&self) -> &str {
        &self.spec
    }

    /// What was built, in a line: resolution, share of empty cells, what was left out.
    fn describe(&self) -> String {
        self.accel.describe()
    }

    /// Number of primitives.
    fn __len__(&self) -> usize {
        self.len() as usize
    }

    fn __repr__(&self) -> String {
        format!("<skipgrid.Accel {} over {} primitives>", self.spec, self.len())
    }
}

/// Spheres behind an accelerator: centres (n, 3) and radii (n,), kept as float32. Other arguments as of Accel.
///
/// Spheres are surfaces: rays from inside hit them. One with a negative radius or a number that is not finite is never hit.
#[pyfunction]
#[pyo3(signature = (centres, radii, accel = "nested", *, threads = None))]
fn spheres(
    py: Python<'_>,
    centres: &Bound<'_, PyAny>,
    radii: &Bound<'_, PyAny>,
    accel: &str,
    threads: Option<usize>,
) -> PyResult<Accel> {
    let centres = floats(centres, "centres", &[3], "(n, 3) numbers")?;
    let radii = arrays::column(radii, "radii")?;
    let (centres, radii) = (centres.as_slice()?, radii.as_slice()?);
    if centres.len() != 3 * radii.len() {
        return Err(invalid(format!("{} centres and {} radii", centres.len() / 3, radii.len())));
    }
    let sphere = |(c, &radius): (&[f32], &f32)| Sphere { centre: Vec3::from_slice(c), radius };
    let spheres: Vec<Sphere> = centres.chunks_exact(3).zip(radii).map(sphere).collect();
    Accel::over(py, SceneGeometry::Spheres(Arc::new(spheres)), accel, threads)
}

/// A scene behind an accelerator: the path of a .gltf, .glb, .obj, .vox, .npy (voxels), .toml, .tri or .sph file, or a scene made
/// by formula such as "random:n=10000".
///
/// drop_invalid: leave primitives with coordinates that are not finite out, with a warning, instead of refusing the file. Other
/// arguments as of Accel.
///
/// Raises OSError for files that cannot be read, and ValueError, with the place and the cause, for those that cannot be used.
#[pyfunction]
#[pyo3(signature = (scene, accel = "nested", *, drop_invalid = false, threads = None))]
fn load(
    py: Python<'_>,
    scene: std::path::PathBuf,
    accel: &str,
    drop_invalid: bool,
    threads: Option<usize>,
) -> PyResult<Accel> {
    let name = scene.to_str().ok_or_else(|| invalid(format!("{}: a name that is not UTF-8", scene.display())))?;
    let options = LoadOptions { drop_invalid, ..LoadOptions::default() };
    let scene = py.detach(|| scene::load(name, &options)).map_err(raised)?;
    for warning in &scene.warnings {
        let text = CString::new(warning.replace('\0', " "))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
    }
    Accel::over(py, scene.geometry, accel, threads)
}

/// All accelerators: a list of dicts with "name", "summary", "options", "source", "exact" (False for peers with a primitive test
/// of their own) and "missing" (why it cannot be built on this machine, or None).
#[pyfunction]
fn accelerators(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let entry = |entry: &registry::Entry| {
        let dict = PyDict::new(py);
        dict.set_item("name", entry.name)?;
        dict.set_item("summary", entry.summary)?;
        dict.set_item("options", entry.options)?;
        dict.set_item("source", entry.source)?;
        dict.set_item("exact", entry.exact)?;
        dict.set_item("missing", entry.missing())?;
        Ok(dict)
    };
    registry::ENTRIES.iter().map(entry).collect()
}

/// The part of the package that is in Rust.
#[pymodule]
fn _skipgrid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("MISS", MISS)?;
    module.add_class::<Accel>()?;
    module.add_function(wrap_pyfunction!(spheres, module)?)?;
    module.add_function(wrap_pyfunction!(load, module)?)?;
    module.add_function(wrap_pyfunction!(accelerators, module)?)
}
