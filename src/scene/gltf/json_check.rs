//! Checks the document by itself: version, extensions, references, and that views and accessors fit.

use super::Notices;
use super::accessor::element_bytes;
use crate::error::{Error, Result};
use ::gltf::json::mesh::Semantic;
use ::gltf::json::validation::{Checked, Error as Defect, Validate};
use ::gltf::json::{Path as Place, Root};
use std::path::Path;

/// Extensions that are read or need no reading.
const KNOWN: [&str; 5] = [
    "KHR_lights_punctual",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_emissive_strength",
    "KHR_mesh_quantization",
];

pub(super) fn check(path: &Path, root: &Root, notices: &mut Notices) -> Result<()> {
    let fail = |cause: String| Err(Error::malformed(path, cause));
    for (what, version) in [("version", Some(&root.asset.version)), ("minVersion", root.asset.min_version.as_ref())] {
        let Some(version) = version else { continue };
        let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
        let readable = version.split_once('.').is_some_and(|(major, minor)| major == "2" && digits(minor));
        if !readable {
            return fail(format!("asset.{what} is `{version}`, only 2.x is read"));
        }
    }
    if let Some(name) = root.extensions_required.iter().find(|e| !KNOWN.contains(&e.as_str())) {
        return fail(format!("requires the extension {name}, which is not read"));
    }
    for name in root.extensions_used.iter().filter(|e| !KNOWN.contains(&e.as_str())) {
        notices.warn(format_args!("the extension {name} is not read"));
    }
    // The library's own validation indexes accessors by this one unchecked.
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(a) = positions.filter(|a| a.value() >= root.accessors.len()) {
                let count = root.accessors.len();
                return fail(format!("meshes[{m}].primitives[{p}] refers to accessor {a} of {count}"));
            }
        }
    }
    validate(path, root, notices)?;
    views(path, root)?;
    (0..root.accessors.len()).try_for_each(|a| check_layout(path, root, a))
}

/// References within the document and enumerations, by the library.
fn validate(path: &Path, root: &Root, notices: &mut Notices) -> Result<()> {
    let mut first = None;
    root.validate(root, Place::new, &mut |place: &dyn Fn() -> Place, defect| {
        let place = place().to_string();
        let bounds = place.ends_with(".min") || place.ends_with(".max");
        let quantised = defect == Defect::Unsupported && place.contains("KHR_mesh_quantization");
        // Bounds are computed afresh, and quantised positions are read.
        if bounds && matches!(defect, Defect::Missing | Defect::Invalid) {
            notices.note(format_args!("{place} is missing or invalid"));
        } else if !quantised && first.is_none() {
            first = Some(format!("{place}: {}", defect.to_string().to_lowercase()));
        }
    });
    first.map_or(Ok(()), |cause| Err(Error::malformed(path, cause)))
}

/// Views lie in their buffers, strides in their views.
fn views(path: &Path, root: &Root) -> Result<()> {
    for (i, view) in root.buffer_views.iter().enumerate() {
        let fail = |cause: String| Err(Error::malformed(path, format!("bufferViews[{i}]: {cause}")));
        let (offset, length) = (view.byte_offset.map_or(0, |o| o.0), view.byte_length.0);
        let allowed = root.buffers.get(view.buffer.value()).map_or(0, |b| b.byte_length.0);
        if offset.checked_add(length).is_none_or(|end| end > allowed) {
            return fail(format!("bytes {offset} and {length} more, of a buffer of {allowed}"));
        }
        if let Some(stride) = view.byte_stride.map(|s| s.0 as u64).filter(|&s| s > length || s % 4 != 0) {
            return fail(format!("stride {stride} in {length} bytes; strides are multiples of 4 that fit"));
        }
    }
    Ok(())
}

/// The accessor's elements lie in its view and are aligned. Source: glTF 2.0 specification, section 3.6.2.4.
fn check_layout(path: &Path, root: &Root, a: usize) -> Result<()> {
    let accessor = &root.accessors[a];
    let fail = |cause: String| Err(Error::malformed(path, format!("accessors[{a}]: {cause}")));
    let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
        return fail("unknown component type or type".into());
    };
    let (element, component) = (element_bytes(component.0, kind), component.0.size() as u64);
    let (offset, count) = (accessor.byte_offset.map_or(0, |o| o.0), accessor.count.0);
    if let Some(view) = accessor.buffer_view.and_then(|v| root.buffer_views.get(v.value())) {
        let stride = view.byte_stride.map_or(element, |s| s.0 as u64);
        let start = view.byte_offset.map_or(0, |o| o.0);
        // The view's own range was checked, so this sum cannot overflow unless the offset is absurd.
        let aligned = offset.is_multiple_of(component) && start.wrapping_add(offset).is_multiple_of(component);
        if !aligned {
            return fail(format!("starts at byte {offset} of a view at {start}; must be multiples of {component}"));
        }
        if stride < element {
            return fail(format!("elements of {element} bytes at a stride of {stride}"));
        }
        let last = count.checked_sub(1).and_then(|n| n.checked_mul(stride));
        let end = last.and_then(|l| l.checked_add(element)).and_then(|e| e.checked_add(offset));
        if count > 0 && end.is_none_or(|end| end > view.byte_length.0) {
            let have = view.byte_length.0;
            return fail(format!("{count} elements of {element} bytes from byte {offset}, of a view of {have}"));
        }
    } else if count > MAX_WITHOUT_DATA {
        return fail(format!("{count} elements without a buffer view, at most {MAX_WITHOUT_DATA} are read"));
    }
    let Some(sparse) = &accessor.sparse else { return Ok(()) };
    let Checked::Valid(index) = sparse.indices.component_type else {
        return fail("unknown component type of sparse indices".into());
    };
    let parts = [
        ("sparse indices", sparse.indices.buffer_view, sparse.indices.byte_offset.0, index.0.size() as u64),
        ("sparse values", sparse.values.buffer_view, sparse.values.byte_offset.0, element),
    ];
    for (what, view, offset, element) in parts {
        let have = root.buffer_views.get(view.value()).map_or(0, |v| v.byte_length.0);
        let end = sparse.count.0.checked_mul(element).and_then(|n| n.checked_add(offset));
        if sparse.count.0 > count || end.is_none_or(|end| end > have) {
            let n = sparse.count.0;
            return fail(format!("{n} {what} of {element} bytes from byte {offset}, of a view of {have}"));
        }
    }
    Ok(())
}

/// Sparse accessors without a view are zeros, however many the file states.
const MAX_WITHOUT_DATA: u64 = 1 << 24;
