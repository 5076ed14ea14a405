//! Walks the node tree without recursion and places meshes, lights and the camera in world space.

use super::accessor::Data;
use super::material::Materials;
use super::{Notices, mesh};
use crate::error::{Error, Result};
use crate::scene::transform::{apply, is_regular};
use crate::scene::{Camera, CameraSource, Light, Mesh, SceneParts};
use ::gltf::json::Node;
use ::gltf::json::camera::Type as CameraType;
use ::gltf::json::extensions::scene::khr_lights_punctual::{Light as Punctual, Type as LightType};
use ::gltf::json::validation::Checked;
use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};
use std::collections::HashMap;

/// Most vertices of all instances together: an instance costs a few bytes in the file.
const MAX_VERTICES: u64 = 1 << 27;

/// Adds what the scene's nodes hold.
pub(super) fn walk(data: &Data, materials: &Materials, parts: &mut SceneParts, notices: &mut Notices) -> Result<()> {
    let mut walk =
        Walk { data, materials, meshes: HashMap::new(), vertices: 0, other_cameras: 0, skipped: 0, parts, notices };
    let nodes = &data.root.nodes;
    let scene = data.root.scene.or((!data.root.scenes.is_empty()).then(|| ::gltf::json::Index::new(0)));
    let roots: Vec<usize> = match scene.and_then(|s| data.root.scenes.get(s.value())) {
        Some(scene) => scene.nodes.iter().map(|n| n.value()).collect(),
        None => roots(nodes),
    };
    let mut visited = vec![false; nodes.len()];
    // Last in, first out: reversed, so that nodes are visited in the file's order.
    let mut stack: Vec<_> = roots.into_iter().rev().map(|n| (n, DAffine3::IDENTITY)).collect();
    while let Some((n, parent)) = stack.pop() {
        let fail = |cause: String| Error::malformed(data.path, format!("nodes[{n}]: {cause}"));
        let node = nodes.get(n).ok_or_else(|| fail(format!("there are {} nodes", nodes.len())))?;
        if std::mem::replace(&mut visited[n], true) {
            return Err(fail("is reached twice: the nodes form no tree".into()));
        }
        let transform = parent * local(node).map_err(fail)?;
        if !transform.is_finite() {
            return Err(fail("its transform is not finite in world space".into()));
        }
        walk.place(n, node, &transform)?;
        let children = node.children.iter().flatten().rev().map(|c| (c.value(), transform));
        stack.extend(children);
    }
    if scene.is_none()
        && let Some(n) = visited.iter().position(|v| !v)
    {
        return Err(Error::malformed(data.path, format!("nodes[{n}]: is its own ancestor")));
    }
    walk.finish();
    Ok(())
}

/// Nodes that are nobody's children.
fn roots(nodes: &[Node]) -> Vec<usize> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|n| n.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    (0..nodes.len()).filter(|&n| !is_child[n]).collect()
}

/// The node's own transform. The error is the cause alone.
fn local(node: &Node) -> std::result::Result<DAffine3, String> {
    let transform = if let Some(m) = node.matrix {
        DAffine3::from_mat4(DMat4::from_cols_array(&m.map(f64::from)))
    } else {
        let vector = |v: Option<[f32; 3]>, default| v.map_or(default, |v| Vec3::from_array(v).as_dvec3());
        let q = node.rotation.map_or([0.0, 0.0, 0.0, 1.0], |r| r.0);
        let rotation = DQuat::from_array(q.map(f64::from));
        if !(rotation.is_finite() && rotation.length() > 0.0) {
            return Err(format!("rotation {q:?} is no quaternion of a rotation"));
        }
        let (scale, translation) = (vector(node.scale, DVec3::ONE), vector(node.translation, DVec3::ZERO));
        DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation)
    };
    if transform.is_finite() { Ok(transform) } else { Err("its transform is not finite".into()) }
}

struct Walk<'a, 'b> {
    data: &'a Data<'a>,
    materials: &'a Materials,
    /// Meshes in their own space, read when first placed.
    meshes: HashMap<usize, Vec<Mesh>>,
    vertices: u64,
    other_cameras: usize,
    skipped: usize,
    parts: &'b mut SceneParts,
    notices: &'b mut Notices,
}

impl Walk<'_, '_> {
    fn place(&mut self, n: usize, node: &Node, transform: &DAffine3) -> Result<()> {
        if let Some(m) = node.mesh {
            self.mesh(n, m.value(), transform)?;
            if node.skin.is_some() {
                self.notices.note("skins are passed over: meshes keep the shape and place that they have without");
            }
        }
        if let Some(camera) = node.camera {
            self.camera(camera.value(), transform);
        }
        let light = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(light) = light.and_then(|l| self.data.root.get(l.light)) {
            self.light(n, light, transform)?;
        }
        Ok(())
    }

    fn mesh(&mut self, n: usize, m: usize, transform: &DAffine3) -> Result<()> {
        if !is_regular(transform) {
            // Scale 0 is a common way to hide things.
            self.skipped += 1;
            return Ok(());
        }
        if !self.meshes.contains_key(&m) {
            let read = mesh::read(self.data, m, self.materials, self.notices)?;
            self.meshes.insert(m, read);
        }
        for mesh in self.meshes.get(&m).into_iter().flatten() {
            self.vertices += (mesh.positions.len() + mesh.triangles.len()) as u64;
            if self.vertices > MAX_VERTICES {
                let cause = format!("nodes[{n}]: more than {MAX_VERTICES} vertices and triangles with all instances");
                return Err(Error::malformed(self.data.path, cause));
            }
            let (vertices, triangles) = (mesh.positions.len() as u64, mesh.triangles.len() as u64);
            let what = || format!("{}: nodes[{n}]: an instance of mesh {m}", self.data.path.display());
            self.data.budget.take_mesh(vertices, triangles, what)?;
            let mut placed = mesh.clone();
            apply(&mut placed, transform);
            self.parts.meshes.push(placed);
        }
        Ok(())
    }

    fn camera(&mut self, c: usize, transform: &DAffine3) {
        let Some(camera) = self.data.root.cameras.get(c) else { return };
        let perspective =
            camera.perspective.as_ref().filter(|_| camera.type_ == Checked::Valid(CameraType::Perspective));
        let Some(perspective) = perspective else {
            self.notices.warn(format_args!("cameras[{c}]: only perspective cameras are read"));
            return;
        };
        let origin = transform.translation;
        let camera = Camera {
            origin,
            target: origin + transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero(),
            up: transform.transform_vector3(DVec3::Y),
            yfov: f64::from(perspective.yfov).to_degrees(),
            source: CameraSource::File,
        };
        match camera.defect() {
            Some(what) => self.notices.warn(format_args!("cameras[{c}] is left out: {what}")),
            None if self.parts.camera.is_some() => self.other_cameras += 1,
            None => self.parts.camera = Some(camera),
        }
    }

    fn light(&mut self, n: usize, light: &Punctual, transform: &DAffine3) -> Result<()> {
        let colour = Vec3::from_array(light.color) * light.intensity;
        let position = transform.translation;
        let direction = transform.transform_vector3(DVec3::NEG_Z).normalize_or_zero();
        let light = match &light.type_ {
            Checked::Valid(LightType::Point) => Light::Point { position, intensity: colour },
            Checked::Valid(LightType::Directional) => Light::Directional { direction, irradiance: colour },
            Checked::Valid(LightType::Spot) => {
                let spot = light.spot.clone().unwrap_or_default();
                let degrees = |a: f32| f64::from(a).to_degrees();
                // A right angle in f32 is a little more than one.
                let cutoff = degrees(spot.outer_cone_angle);
                let cutoff = if cutoff < 90.001 { cutoff.min(90.0) } else { cutoff };
                let beam_width = degrees(spot.inner_cone_angle);
                Light::Spot { position, direction, intensity: colour, cutoff, beam_width }
            }
            Checked::Invalid => return Err(Error::malformed(self.data.path, format!("nodes[{n}]: unknown light"))),
        };
        match light.defect() {
            Some(what) => Err(Error::malformed(self.data.path, format!("nodes[{n}]: light: {what}"))),
            None => {
                self.parts.lights.push(light);
                Ok(())
            }
        }
    }

    fn finish(self) {
        if self.skipped > 0 {
            let count = self.skipped;
            self.notices.warn(format_args!("{count} meshes are left out: their transforms flatten them to nothing"));
        }
        if self.other_cameras > 0 {
            self.notices.note(format_args!("{} more cameras are passed over", self.other_cameras));
        }
    }
}
