//! Reads the elements of accessors whose layout was checked.

use crate::error::{Error, Result};
use crate::scene::budget::Budget;
use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;
use ::gltf::json::{Accessor, Root};
use std::borrow::Cow;
use std::path::Path;

/// A document with the content of its buffers.
pub(super) struct Data<'a> {
    pub path: &'a Path,
    pub root: &'a Root,
    pub buffers: &'a [Cow<'a, [u8]>],
    pub budget: &'a Budget,
}

/// Bytes of an element; columns of matrices start at multiples of four.
pub(super) fn element_bytes(component: ComponentType, kind: Type) -> u64 {
    let (columns, rows) = match kind {
        Type::Scalar => (1, 1),
        Type::Vec2 => (1, 2),
        Type::Vec3 => (1, 3),
        Type::Vec4 => (1, 4),
        Type::Mat2 => (2, 2),
        Type::Mat3 => (3, 3),
        Type::Mat4 => (4, 4),
    };
    let column = rows * component.size() as u64;
    columns * if columns > 1 { column.next_multiple_of(4) } else { column }
}

impl Data<'_> {
    /// The bytes of a view.
    pub(super) fn view(&self, v: usize) -> Result<&[u8]> {
        let bytes = self.root.buffer_views.get(v).and_then(|view| {
            let start = usize::try_from(view.byte_offset.map_or(0, |o| o.0)).ok()?;
            let length = usize::try_from(view.byte_length.0).ok()?;
            self.buffers.get(view.buffer.value())?.get(start..)?.get(..length)
        });
        bytes.ok_or_else(|| Error::malformed(self.path, format!("bufferViews[{v}] lies outside its buffer")))
    }

    /// Sparse indices are in range, and floats finite unless `allow_invalid`.
    pub(super) fn check_all(&self, allow_invalid: bool) -> Result<()> {
        for (a, accessor) in self.root.accessors.iter().enumerate() {
            self.sparse_indices(a, accessor)?;
            let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
                continue;
            };
            if component.0 != ComponentType::F32 || allow_invalid {
                continue;
            }
            let floats = element_bytes(component.0, kind) / 4;
            self.each_element(a, |i, bytes| {
                let bad = bytes.chunks_exact(4).map(float).take(floats as usize).find(|v| !v.is_finite());
                bad.map_or(Ok(()), |v| Err(Error::malformed(self.path, format!("accessors[{a}]: element {i}: {v}"))))
            })?;
        }
        Ok(())
    }

    /// Elements of `N` numbers; integers are normalised where the accessor says so.
    pub(super) fn vectors<const N: usize>(&self, a: usize) -> Result<Vec<[f32; N]>> {
        let accessor = self.accessor(a)?;
        let kinds = [Type::Scalar, Type::Vec2, Type::Vec3, Type::Vec4];
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(self.fail(a, "unknown component type or type"));
        };
        if kinds.get(N - 1) != Some(&kind) {
            return Err(self.fail(a, format_args!("elements are {kind:?}, {:?} are needed", kinds.get(N - 1))));
        }
        let read = reader(component.0, accessor.normalized);
        let size = component.0.size();
        self.list(a, accessor, |bytes| std::array::from_fn(|k| bytes.get(k * size..).map_or(0.0, read)))
    }

    /// Vertex indices.
    pub(super) fn indices(&self, a: usize) -> Result<Vec<u32>> {
        let accessor = self.accessor(a)?;
        let (Checked::Valid(component), Checked::Valid(Type::Scalar)) = (accessor.component_type, accessor.type_)
        else {
            return Err(self.fail(a, "vertex indices are scalars"));
        };
        let read = match component.0 {
            ComponentType::U8 | ComponentType::U16 | ComponentType::U32 => unsigned,
            other => return Err(self.fail(a, format_args!("vertex indices are unsigned, not {other:?}"))),
        };
        self.list(a, accessor, |bytes| read(bytes, component.0.size()))
    }

    /// All elements, read one by one.
    fn list<T>(&self, a: usize, accessor: &Accessor, read: impl Fn(&[u8]) -> T) -> Result<Vec<T>> {
        let mut list = self.reserve(a, accessor)?;
        self.each_element(a, |i, bytes| {
            let value = read(bytes);
            // Sparse elements come after the dense ones and replace them.
            match list.get_mut(i) {
                Some(old) => *old = value,
                None => list.push(value),
            }
            Ok(())
        })?;
        Ok(list)
    }

    fn accessor(&self, a: usize) -> Result<&Accessor> {
        let count = self.root.accessors.len();
        self.root.accessors.get(a).ok_or_else(|| Error::malformed(self.path, format!("accessor {a} of {count}")))
    }

    fn reserve<T>(&self, a: usize, accessor: &Accessor) -> Result<Vec<T>> {
        let mut list = Vec::new();
        let count = usize::try_from(accessor.count.0).unwrap_or(usize::MAX);
        let bytes = accessor.count.0.saturating_mul(size_of::<T>() as u64);
        self.budget.take(bytes, || format!("{}: accessors[{a}]: {count} elements", self.path.display()))?;
        list.try_reserve_exact(count).map_err(|_| self.fail(a, format_args!("no memory for {count} elements")))?;
        Ok(list)
    }

    fn fail(&self, a: usize, cause: impl std::fmt::Display) -> Error {
        Error::malformed(self.path, format!("accessors[{a}]: {cause}"))
    }

    /// Calls `visit` with number and bytes of each element, dense ones first, then sparse ones.
    fn each_element(&self, a: usize, mut visit: impl FnMut(usize, &[u8]) -> Result<()>) -> Result<()> {
        let accessor = self.accessor(a)?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
            return Err(self.fail(a, "unknown component type or type"));
        };
        let (element, count) = (element_bytes(component.0, kind) as usize, accessor.count.0 as usize);
        match accessor.buffer_view {
            None => {
                let zero = [0; 64];
                for i in 0..count {
                    visit(i, &zero[..element])?;
                }
            }
            Some(v) => {
                let view = &self.root.buffer_views[v.value()];
                let stride = view.byte_stride.map_or(element, |s| s.0).max(1);
                let bytes = self.view(v.value())?;
                let bytes = accessor.byte_offset.and_then(|o| bytes.get(o.0 as usize..)).unwrap_or(bytes);
                for (i, bytes) in bytes.chunks(stride).take(count).enumerate() {
                    let bytes = bytes.get(..element).ok_or_else(|| self.fail(a, format_args!("element {i} is cut")))?;
                    visit(i, bytes)?;
                }
            }
        }
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let values = self.view(sparse.values.buffer_view.value())?;
        let values = values.get(sparse.values.byte_offset.0 as usize..).unwrap_or_default();
        let indices = self.sparse_indices(a, accessor)?;
        indices.iter().zip(values.chunks_exact(element)).try_for_each(|(&i, bytes)| visit(i, bytes))
    }

    /// Which elements are sparse ones; every one is below the accessor's count.
    fn sparse_indices(&self, a: usize, accessor: &Accessor) -> Result<Vec<usize>> {
        let Some(sparse) = &accessor.sparse else { return Ok(Vec::new()) };
        let Checked::Valid(component) = sparse.indices.component_type else {
            return Err(self.fail(a, "unknown component type of sparse indices"));
        };
        let size = component.0.size();
        let bytes = self.view(sparse.indices.buffer_view.value())?;
        let bytes = bytes.get(sparse.indices.byte_offset.0 as usize..).unwrap_or_default();
        let each = |bytes| {
            let i = unsigned(bytes, size) as usize;
            let count = accessor.count.0;
            let good = (i as u64) < count;
            if good { Ok(i) } else { Err(self.fail(a, format_args!("sparse index {i} of {count} elements"))) }
        };
        bytes.chunks_exact(size).take(sparse.count.0 as usize).map(each).collect()
    }
}

fn float(bytes: &[u8]) -> f32 {
    bytes.first_chunk().map_or(0.0, |b| f32::from_le_bytes(*b))
}

/// A little-endian number of `size` bytes, at most four.
fn unsigned(bytes: &[u8], size: usize) -> u32 {
    bytes.iter().take(size).rev().fold(0, |value, &b| value << 8 | u32::from(b))
}

/// Reads one component. Normalised: glTF 2.0 specification, section 3.6.2.2.
fn reader(component: ComponentType, normalised: bool) -> fn(&[u8]) -> f32 {
    fn i8(b: &[u8]) -> f32 {
        f32::from(unsigned(b, 1) as u8 as i8)
    }
    fn u8(b: &[u8]) -> f32 {
        unsigned(b, 1) as f32
    }
    fn i16(b: &[u8]) -> f32 {
        f32::from(unsigned(b, 2) as u16 as i16)
    }
    fn u16(b: &[u8]) -> f32 {
        unsigned(b, 2) as f32
    }
    match (component, normalised) {
        (ComponentType::F32, _) => float,
        (ComponentType::U32, _) => |b| unsigned(b, 4) as f32,
        (ComponentType::I8, false) => i8,
        (ComponentType::U8, false) => u8,
        (ComponentType::I16, false) => i16,
        (ComponentType::U16, false) => u16,
        (ComponentType::I8, true) => |b| (i8(b) / 127.0).max(-1.0),
        (ComponentType::U8, true) => |b| u8(b) / 255.0,
        (ComponentType::I16, true) => |b| (i16(b) / 32767.0).max(-1.0),
        (ComponentType::U16, true) => |b| u16(b) / 65535.0,
    }
}
