//! NumPy arrays in: checked once, read where they are if they are float32 in C order.

use crate::errors::invalid;
use glam::Vec3;
use numpy::{Element, PyArray, PyArrayMethods, PyReadonlyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyString;
use skipgrid::{Ray, Triangle};

/// `value` as an aligned array of `T` in C order, itself if it is one. `fits` judges its shape, and `kinds` lists the kinds of
/// numbers that are converted, as NumPy letters them.
fn array<'py, T: Element, D: numpy::ndarray::Dimension>(
    value: &Bound<'py, PyAny>,
    what: &str,
    kinds: &str,
    fits: impl Fn(&[usize]) -> bool,
    wanted: &str,
) -> PyResult<PyReadonlyArray<'py, T, D>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (value,))?;
    let (dtype, shape) = (array.getattr("dtype")?, array.getattr("shape")?);
    let kind: Bound<'_, PyString> = dtype.getattr("kind")?.cast_into()?;
    if !kinds.contains(kind.to_str()?) || !fits(&shape.extract::<Vec<usize>>()?) {
        return Err(invalid(format!("{what}: an array of shape {shape} and dtype {dtype}, where {wanted} are wanted")));
    }
    let array = numpy.call_method1("require", (array, T::get_dtype(value.py()), ["C", "A"]))?;
    Ok(array.cast_into::<PyArray<T, D>>()?.readonly())
}

/// Floating-point and whole numbers: all that float32 can stand for, rounded.
const NUMBERS: &str = "fiu";

/// A table with one of the numbers of columns.
pub fn floats<'py>(
    value: &Bound<'py, PyAny>,
    what: &str,
    columns: &[usize],
    wanted: &str,
) -> PyResult<PyReadonlyArray2<'py, f32>> {
    let fits = |shape: &[usize]| matches!(shape, [_, n] if columns.contains(n));
    array(value, what, NUMBERS, fits, wanted)
}

/// A list of numbers.
pub fn column<'py>(value: &Bound<'py, PyAny>, what: &str) -> PyResult<PyReadonlyArray1<'py, f32>> {
    array(value, what, NUMBERS, |shape| shape.len() == 1, "(n,) numbers")
}

/// The triangles of a mesh, copied.
pub fn corners(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<Vec<Triangle>> {
    let vertices = floats(vertices, "vertices", &[3], "(n, 3) numbers")?;
    let three = |shape: &[usize]| matches!(shape, [_, 3]);
    let faces: PyReadonlyArray2<'_, i64> = array(faces, "faces", "iu", three, "(m, 3) whole numbers")?;
    let (vertices, faces) = (vertices.as_slice()?, faces.as_slice()?);
    let (vertices, _) = vertices.as_chunks::<3>();
    let (faces, _) = faces.as_chunks::<3>();
    if faces.len() >= u32::MAX as usize {
        return Err(invalid(format!("faces: {} triangles, at most {} can be told apart", faces.len(), u32::MAX - 1)));
    }
    let corner = |(i, &index): (usize, &i64)| {
        let vertex = usize::try_from(index).ok().and_then(|index| vertices.get(index));
        let none = || invalid(format!("faces: face {i} refers to vertex {index} of {}", vertices.len()));
        vertex.copied().map(Vec3::from).ok_or_else(none)
    };
    let triangle = |(i, [a, b, c]): (usize, &[i64; 3])| Ok([corner((i, a))?, corner((i, b))?, corner((i, c))?]);
    faces.iter().enumerate().map(triangle).collect()
}

const RAYS: &str = "(n, 6) numbers ox oy oz dx dy dz, or (n, 8) numbers ox oy oz tmin dx dy dz tmax";

/// Rays in one array, or origins and directions.
pub enum Rays<'py> {
    One(PyReadonlyArray2<'py, f32>),
    Two(PyReadonlyArray2<'py, f32>, PyReadonlyArray2<'py, f32>),
}

impl<'py> Rays<'py> {
    pub fn of(rays: &Bound<'py, PyAny>, directions: Option<&Bound<'py, PyAny>>) -> PyResult<Self> {
        let Some(directions) = directions else { return Ok(Self::One(floats(rays, "rays", &[6, 8], RAYS)?)) };
        let origins = floats(rays, "origins, with directions", &[3], "(n, 3) numbers")?;
        let directions = floats(directions, "directions", &[3], "(n, 3) numbers")?;
        let [n, m] = [&origins, &directions].map(|array| array.as_array().nrows());
        if n != m {
            return Err(invalid(format!("{n} origins and {m} directions")));
        }
        Ok(Self::Two(origins, directions))
    }

    /// What other threads can read.
    pub fn view(&self) -> PyResult<View<'_>> {
        Ok(match self {
            Self::One(rays) if rays.as_array().ncols() == 6 => View::Six(rays.as_slice()?.as_chunks().0),
            Self::One(rays) => View::Eight(rays.as_slice()?.as_chunks().0),
            Self::Two(origins, directions) => {
                View::Two(origins.as_slice()?.as_chunks().0, directions.as_slice()?.as_chunks().0)
            }
        })
    }
}

/// Rays where NumPy keeps them.
#[derive(Clone, Copy)]
pub enum View<'a> {
    Six(&'a [[f32; 6]]),
    Eight(&'a [[f32; 8]]),
    Two(&'a [[f32; 3]], &'a [[f32; 3]]),
}

impl View<'_> {
    pub fn len(&self) -> usize {
        match self {
            Self::Six(rays) => rays.len(),
            Self::Eight(rays) => rays.len(),
            Self::Two(origins, _) => origins.len(),
        }
    }

    pub fn ray(&self, i: usize) -> Ray {
        match self {
            Self::Six(rays) => {
                let [ox, oy, oz, dx, dy, dz] = rays[i];
                Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz))
            }
            Self::Eight(rays) => {
                let [ox, oy, oz, t_min, dx, dy, dz, t_max] = rays[i];
                Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz)).with_range(t_min, t_max)
            }
            Self::Two(origins, directions) => Ray::new(origins[i].into(), directions[i].into()),
        }
    }
}
