//! What a commit makes of a scene: up to four accelerators, one for each kind of primitive.
//!
//! - Triangles that nothing can take away: the accelerator's own exact tests, packs and all.
//! - Triangles with filters or masks, twice. First like the others: most hits are accepted, and then the first hit is the answer.
//!   If it is refused, the ray goes through the second structure, whose tests ask about each triangle.
//! - User primitives and instances, whose tests are calls.

use crate::called::{FilteredTriangles, Others};
use crate::device::{Device, Fault};
use crate::geometry::Geometry;
use crate::part::{Part, Triangles, user_bounds};
use crate::report;
use crate::scene::Scene;
use crate::transform;
use crate::types::{ErrorCode, GeometryType, Version};
use skipgrid::{Aabb, Accel, registry};
use std::sync::Arc;

/// Everything that rays need, until the next commit.
pub struct Built {
    device: Arc<Device>,
    /// What it was made from.
    pub signature: Signature,
    /// All enabled geometries.
    pub parts: Arc<Vec<Part>>,
    /// Triangles that no filter and no mask but [`Built::common_mask`] can take away.
    pub plain: Option<(Triangles, Box<dyn Accel>)>,
    /// Triangles with filters or other masks.
    pub filtered: Option<Filtered>,
    /// User primitives and instances.
    pub others: Option<Box<dyn Accel>>,
    /// The mask of all plain triangles.
    pub common_mask: u32,
    /// True if it shows other scenes.
    pub has_instances: bool,
    bounds: Aabb,
    primitives: i64,
    bytes: isize,
}

/// Triangles that filters or masks may take away.
pub struct Filtered {
    /// The triangles.
    pub triangles: Arc<Triangles>,
    /// As they are: the nearest hit, which most filters accept.
    pub nearest: Box<dyn Accel>,
    /// Its tests ask masks and filters.
    pub asking: Box<dyn Accel>,
}

/// What a scene consisted of: where two are equal nothing needs to be built.
#[derive(Debug, Default, PartialEq)]
pub struct Signature {
    /// Number, address and count of changes of each geometry, and of the build of what it shows.
    pub geometries: Vec<(u32, usize, u64, usize)>,
    /// Scene flags.
    pub flags: u32,
    /// Build quality.
    pub quality: u32,
}

impl Built {
    /// Builds over enabled geometries. `goes_on` hears what share is done, 0 to 1, and says whether to go on.
    ///
    /// # Errors
    /// The scene cannot be traced, its structures do not fit into their budget, or `goes_on` or the memory monitor said no.
    pub fn new(
        scene: &Scene,
        geometries: &[(u32, Arc<Geometry>)],
        signature: Signature,
        filters_in_queries: bool,
        mut goes_on: impl FnMut(f64) -> bool,
    ) -> Result<Self, Fault> {
        let device = scene.device.clone();
        let mut step = |share: f64| {
            let cancelled =
                || Fault { code: ErrorCode::Cancelled, message: "the progress monitor stopped the build".into() };
            if goes_on(share) { Ok(()) } else { Err(cancelled()) }
        };
        step(0.0)?;
        let common_mask = match device.version() {
            Version::Three => u32::MAX,
            Version::Four => 1,
        };
        let parts: Vec<Part> = geometries.iter().map(|(id, geometry)| Part::new(*id, geometry)).collect();
        let (mut plain, mut filtered) = (Triangles::default(), Triangles::default());
        let (mut list, mut boxes) = (Vec::new(), Vec::new());
        for (index, ((_, geometry), part)) in (0u32..).zip(geometries.iter().zip(&parts)) {
            match geometry.kind {
                GeometryType::Triangle | GeometryType::Quad => {
                    let asked = filters_in_queries
                        || part.intersect_filter.is_some()
                        || part.occluded_filter.is_some()
                        || part.filter_from_arguments
                        || part.mask != common_mask;
                    (if asked { &mut filtered } else { &mut plain }).add(index, geometry)?;
                }
                GeometryType::User => {
                    // Its functions may ask the geometry: nothing of it is held meanwhile.
                    let count = geometry.state().user_primitives;
                    for primitive in 0..count {
                        list.push((index, primitive));
                        boxes.push(user_bounds(geometry, primitive)?);
                    }
                }
                GeometryType::Instance => {
                    list.push((index, 0));
                    boxes.push(instance_bounds(scene, geometry)?);
                }
            }
        }
        step(0.1)?;
        let parts = Arc::new(parts);
        let has_instances = parts.iter().any(|part| part.instance.is_some());
        let spec = specification(device.accel(), signature.quality);
        let mut made = Self {
            device,
            signature,
            parts: parts.clone(),
            plain: None,
            filtered: None,
            others: None,
            common_mask,
            has_instances,
            bounds: Aabb::EMPTY,
            primitives: 0,
            bytes: 0,
        };
        let primitives = plain.corners.len() + filtered.corners.len() + list.len();
        if !plain.is_empty() {
            let accel = made.accelerator(&spec, plain.corners.clone(), 36 * plain.corners.len())?;
            made.plain = Some((plain, accel));
        }
        step(0.5)?;
        if !filtered.is_empty() {
            let triangles = Arc::new(filtered);
            let nearest = made.accelerator(&spec, triangles.corners.clone(), 36 * triangles.corners.len())?;
            let set = FilteredTriangles { triangles: triangles.clone(), parts: parts.clone() };
            let asking = made.accelerator(&spec, set, 0)?;
            made.filtered = Some(Filtered { triangles, nearest, asking });
        }
        step(0.8)?;
        if !list.is_empty() {
            let bytes = 32 * list.len();
            made.others = Some(made.accelerator(&spec, Others { list, boxes, parts }, bytes)?);
        }
        step(1.0)?;
        made.primitives = primitives as i64;
        report::holds(made.primitives, 0);
        Ok(made)
    }

    /// An accelerator over primitives that hold `bytes` themselves; the sum of bytes and the bounds take it in.
    fn accelerator<G>(&mut self, spec: &str, geometry: G, bytes: usize) -> Result<Box<dyn Accel>, Fault>
    where
        G: skipgrid::Geometry + 'static,
    {
        let accel = self.device.install(|| registry::build(spec, geometry)).map_err(|error| Fault {
            code: if matches!(error, skipgrid::Error::TooLarge { .. }) {
                ErrorCode::OutOfMemory
            } else {
                ErrorCode::Unknown
            },
            message: error.to_string(),
        })?;
        let bytes = (accel.memory().total() as isize).saturating_add(bytes as isize);
        if !self.device.memory(bytes) {
            let message = format!("{bytes} bytes of an accelerator: the memory monitor refuses them");
            // What was refused is not given back.
            return Err(Fault { code: ErrorCode::OutOfMemory, message });
        }
        self.bytes += bytes;
        report::holds(0, bytes as i64);
        self.bounds = self.bounds.union(&accel.bounds());
        Ok(accel)
    }

    /// The least box around everything, empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Where its errors go.
    pub fn device(&self) -> &Device {
        &self.device
    }
}

impl Drop for Built {
    fn drop(&mut self) {
        self.device.memory(-self.bytes);
        report::holds(-self.primitives, -(self.bytes as i64));
    }
}

/// The box of what an instance shows, in the space of the scene.
fn instance_bounds(scene: &Scene, geometry: &Geometry) -> Result<Aabb, Fault> {
    let state = geometry.state();
    let Some(shown) = &state.instanced else { return Err(Fault::operation("an instance without a scene")) };
    if std::ptr::eq(&raw const **shown, scene) {
        return Err(Fault::operation("a scene that instances itself"));
    }
    shown.with_built(|built| match built {
        Some(built) if built.has_instances => Err(Fault::unsupported(
            "instances of scenes with instances (hits have one instance number, as in Embree's usual builds)",
        )),
        Some(built) => Ok(transform::image(&state.transform, &built.bounds())),
        None => Ok(Aabb::EMPTY),
    })
}

/// The specification with the effort that the program asks for, where the accelerator knows one and the user did not say.
fn specification(accel: &str, quality: u32) -> String {
    let effort = match quality {
        0 | 3 => "fast",
        2 => "best",
        _ => return accel.into(),
    };
    let (name, options) = accel.split_once(':').unwrap_or((accel, ""));
    if name != "nested" || options.contains("quality=") {
        return accel.into();
    }
    let comma = if options.is_empty() { "" } else { "," };
    format!("{name}:{options}{comma}quality={effort}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quality_of_the_program_gives_way_to_that_of_the_user() {
        assert_eq!(specification("nested", 1), "nested");
        assert_eq!(specification("nested", 0), "nested:quality=fast");
        assert_eq!(specification("nested:density=3", 2), "nested:density=3,quality=best");
        assert_eq!(specification("nested:quality=fast", 2), "nested:quality=fast");
        assert_eq!(specification("grid", 2), "grid");
    }
}
