//! Answers what shading asks of a hit: point, normals, texture coordinates, material; in f64.

use super::{Mesh, Scene, SceneGeometry, Surface, patches};
use crate::accel::Hit;
use crate::geometry::{SolidVoxels, Sphere};
use crate::ray::Ray;
use glam::{DVec2, DVec3};

/// How far the parameter in f64 may stray from the hit's f32 one, relative: 2 ulp of f32. Further means that the
/// primitive is grazed and the division is not to be trusted.
const STRAY: f64 = 2.4e-7;

/// See [`Scene::surface`].
pub(super) fn surface(scene: &Scene, ray: &Ray, hit: Hit) -> Surface {
    if let Some(voxels) = scene.voxels() {
        return on_voxel(voxels, ray, hit);
    }
    if let SceneGeometry::Patches(set) = &scene.geometry {
        return patches::surface(set, scene.patch_materials[hit.prim as usize], ray, hit);
    }
    let triangles = scene.triangle_count();
    if hit.prim >= triangles {
        let i = (hit.prim - triangles) as usize;
        return on_sphere(&scene.spheres[i], scene.sphere_materials[i], ray, hit);
    }
    // Empty meshes share their offset with the next one: the last of them that starts at or before the primitive.
    let m = scene.mesh_offsets.partition_point(|&first| first <= hit.prim) - 1;
    on_triangle(&scene.meshes[m], (hit.prim - scene.mesh_offsets[m]) as usize, ray, hit)
}

fn on_triangle(mesh: &Mesh, triangle: usize, ray: &Ray, hit: Hit) -> Surface {
    let corners = mesh.triangles[triangle].map(|i| i as usize);
    let [a, b, c] = corners.map(|i| mesh.positions[i].as_dvec3());
    let direction = ray.direction.as_dvec3();
    let normal = (b - a).cross(c - a);
    let area2 = normal.length_squared();
    let flat = area2 > 0.0 && area2.is_finite();
    let geometric_normal = if flat { normal / area2.sqrt() } else { facing(direction) };
    let position = if flat {
        // f64 plane parameter; relative to the corner, so that a far origin costs nothing more.
        let t = (a - ray.origin.as_dvec3()).dot(geometric_normal) / direction.dot(geometric_normal);
        let p = ray.at(trusted(t, hit.t));
        p - (p - a).dot(geometric_normal) * geometric_normal
    } else {
        ray.at(f64::from(hit.t))
    };
    let weights = if flat { barycentric(position, [a, b, c], normal, area2) } else { [1.0 / 3.0; 3] };
    let shading_normal = if mesh.normals.is_empty() {
        geometric_normal
    } else {
        let n = weigh(weights, corners.map(|i| mesh.normals[i].as_dvec3()));
        match n.try_normalize() {
            Some(n) if n.dot(geometric_normal) < 0.0 => -n,
            Some(n) => n,
            None => geometric_normal,
        }
    };
    let uv = if mesh.uvs.is_empty() {
        DVec2::ZERO
    } else {
        let [p, q, r] = corners.map(|i| mesh.uvs[i].as_dvec2());
        weights[0] * p + weights[1] * q + weights[2] * r
    };
    Surface { position, geometric_normal, shading_normal, uv, material: mesh.material }
}

/// The coordinate along the face's axis is the plane's own; the others stay within the square.
fn on_voxel(voxels: &SolidVoxels, ray: &Ray, hit: Hit) -> Surface {
    let (voxel, face) = voxels.face_of(hit.prim);
    let axis = face.axis();
    let plane = |axis: usize, upper: bool| f64::from(voxels.planes(axis)[voxel[axis] as usize + usize::from(upper)]);
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let mut position = ray.at(trusted((plane(axis, face.is_upper()) - origin[axis]) / direction[axis], hit.t));
    for other in 0..3 {
        position[other] = position[other].clamp(plane(other, false), plane(other, true));
    }
    position[axis] = plane(axis, face.is_upper());
    let normal = face.normal().as_dvec3();
    // Solid: the byte is at least 1.
    let material = u32::from(voxels.material(voxel)) - 1;
    Surface { position, geometric_normal: normal, shading_normal: normal, uv: DVec2::ZERO, material }
}

fn on_sphere(sphere: &Sphere, material: u32, ray: &Ray, hit: Hit) -> Surface {
    let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
    let direction = ray.direction.as_dvec3();
    let p = ray.at(trusted(sphere_parameter(ray, centre, radius, f64::from(hit.t)), hit.t));
    let normal = (p - centre).try_normalize().unwrap_or_else(|| facing(direction));
    Surface {
        position: centre + radius * normal,
        geometric_normal: normal,
        shading_normal: normal,
        uv: DVec2::ZERO,
        material,
    }
}

/// The root of the sphere's equation that is nearer to `near`, without cancellation.
/// Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems (2019), chapter 7.
fn sphere_parameter(ray: &Ray, centre: DVec3, radius: f64, near: f64) -> f64 {
    let (f, d) = (ray.origin.as_dvec3() - centre, ray.direction.as_dvec3());
    let (a, b) = (d.length_squared(), -f.dot(d));
    let discriminant = radius * radius - (f + b / a * d).length_squared();
    let q = b + (a * discriminant.max(0.0)).sqrt().copysign(b);
    let (t0, t1) = ((f.length_squared() - radius * radius) / q, q / a);
    if (t0 - near).abs() <= (t1 - near).abs() { t0 } else { t1 }
}

/// `fresh` if it agrees with the hit's parameter, else that; a hit beyond f32's range says nothing against `fresh`.
fn trusted(fresh: f64, hit: f32) -> f64 {
    let t = f64::from(hit);
    let agrees = (fresh - t).abs() <= STRAY * t.abs() + f64::from(f32::MIN_POSITIVE);
    if agrees || (t.is_infinite() && fresh.is_finite()) { fresh } else { t }
}

/// Barycentric coordinates of a point of the plane, moved into the triangle where rounding left it.
fn barycentric(p: DVec3, [a, b, c]: [DVec3; 3], normal: DVec3, area2: f64) -> [f64; 3] {
    let u = (c - b).cross(p - b).dot(normal) / area2;
    let v = (a - c).cross(p - c).dot(normal) / area2;
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let w = (1.0 - u - v).max(0.0);
    let sum = u + v + w;
    [u / sum, v / sum, w / sum]
}

fn weigh(w: [f64; 3], [a, b, c]: [DVec3; 3]) -> DVec3 {
    w[0] * a + w[1] * b + w[2] * c
}

/// The unit normal of a primitive without one: towards the viewer.
fn facing(direction: DVec3) -> DVec3 {
    (-direction).try_normalize().unwrap_or(DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneParts;
    use glam::{Vec2, Vec3};

    fn triangle_scene() -> Scene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            normals: vec![Vec3::Z, Vec3::X, Vec3::Z],
            uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            ..Mesh::default()
        };
        let empty = Mesh::default();
        let parts = SceneParts { meshes: vec![empty.clone(), mesh, empty], ..SceneParts::default() };
        Scene::new(parts).expect("a valid scene")
    }

    #[test]
    fn triangle_point_lies_on_the_plane_and_interpolates() {
        let scene = triangle_scene();
        let ray = Ray::new(Vec3::new(0.25, 0.5, 1e4), Vec3::new(0.0, 0.0, -3.0));
        let t = (1e4_f64 / 3.0) as f32;
        let s = surface(&scene, &ray, Hit { t, prim: 0 });
        assert!((s.position - DVec3::new(0.25, 0.5, 0.0)).length() < 1e-12, "{s:?}");
        assert_eq!(s.geometric_normal, DVec3::Z);
        assert!((s.uv - DVec2::new(0.25, 0.5)).length() < 1e-12);
        // Corner weights 0.25, 0.25, 0.5: the normal is (0.25, 0, 0.75) normalised.
        assert!((s.shading_normal - DVec3::new(0.25, 0.0, 0.75).normalize()).length() < 1e-12);
    }

    #[test]
    fn normals_against_the_winding_are_negated() {
        let mut scene = triangle_scene();
        scene.meshes[1].normals = vec![Vec3::NEG_Z; 3];
        let ray = Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z);
        assert_eq!(surface(&scene, &ray, Hit { t: 1.0, prim: 0 }).shading_normal, DVec3::Z);
        scene.meshes[1].normals = vec![Vec3::ZERO; 3];
        assert_eq!(surface(&scene, &ray, Hit { t: 1.0, prim: 0 }).shading_normal, DVec3::Z);
    }

    #[test]
    fn voxel_points_lie_on_the_plane_and_in_the_square() {
        let voxels = SolidVoxels::new([1, 1, 2], vec![2, 1], Vec3::splat(0.1), 0.3).expect("voxels");
        let materials = vec![crate::scene::Material::grey(); 2];
        let scene = Scene::new(SceneParts { voxels: Some(voxels), materials, ..SceneParts::default() }).expect("valid");
        let ray = Ray::new(Vec3::new(0.25, 0.2, 7.0), Vec3::new(0.0, 0.01, -1.0));
        let hit = scene.accel("voxels").expect("voxels").closest_hit(&ray).expect("the upper voxel is in the way");
        let s = surface(&scene, &ray, hit);
        let top = f64::from(0.7_f64 as f32);
        assert!((s.position.z - top).abs() < 1e-7 && (s.position.y - (0.2 + 0.01 * (7.0 - top))).abs() < 1e-7, "{s:?}");
        assert_eq!((s.geometric_normal, s.shading_normal, s.material), (DVec3::Z, DVec3::Z, 0));
        // From below: the other voxel.
        let ray = Ray::new(Vec3::new(0.25, 0.2, -7.0), Vec3::Z);
        let hit = scene.accel("grid").expect("a grid").closest_hit(&ray).expect("the lower voxel is in the way");
        let s = surface(&scene, &ray, hit);
        assert_eq!((s.position.z, s.geometric_normal, s.material), (f64::from(0.1_f32), DVec3::NEG_Z, 1));
    }

    #[test]
    fn sphere_point_has_the_radius_in_f64() {
        let sphere = Sphere { centre: Vec3::new(3.0, -1.0, 7.0), radius: 0.75 };
        let scene = Scene::new(SceneParts { spheres: vec![(sphere, 0)], ..SceneParts::default() }).expect("valid");
        let ray = Ray::new(Vec3::new(3.1, -0.9, 0.0), Vec3::Z);
        // Depth of the surface over (0.1, 0.1) off the axis, with the coordinates as they are in f32.
        let (dx, dy) = (f64::from(3.1_f32) - 3.0, f64::from(-0.9_f32) + 1.0);
        let z = 7.0 - (0.5625 - dx * dx - dy * dy).sqrt();
        let s = surface(&scene, &ray, Hit { t: z as f32, prim: 0 });
        assert!((s.position.z - z).abs() < 1e-14, "{} {z}", s.position.z);
        assert!(((s.position - DVec3::new(3.0, -1.0, 7.0)).length() - 0.75).abs() < 1e-15);
    }
}
