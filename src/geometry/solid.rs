//! Solid voxels: the exposed faces of a dense array of materials, two triangles each.

use super::triangle;
use super::{Best, Face, Geometry, Triangle, TrianglePrep};
use crate::error::{Error, Result};
use crate::ray::{Aabb, Ray};
use glam::Vec3;
use std::sync::Arc;

/// A box of cubic voxels, each empty or solid.
///
/// Its primitives are the triangles of the exposed faces, those between a solid voxel and an empty one or the outside, in
/// the order of the voxels (x varies fastest, z slowest) and of their [`Face`]s: face `f` has the primitives `2 f` and
/// `2 f + 1`, counter-clockwise seen from outside. Answers are those of the same triangles in a list, to the bit; so every
/// accelerator works on voxels, and [`crate::grid::SolidGrid`] needs no list of primitives at all.
///
/// Plane `k` of an axis lies at `origin + k edge`, computed in f64 and rounded to f32. A clone shares everything.
///
/// Memory: a byte for each voxel, four for each exposed face, four for each row of voxels along x.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::geometry::{Face, Geometry, SolidVoxels};
///
/// // Two voxels, one solid.
/// let voxels = SolidVoxels::new([2, 1, 1], vec![0, 7], Vec3::ZERO, 1.0)?;
/// assert_eq!(Geometry::len(&voxels), 12);
/// assert_eq!(voxels.face_of(0), ([1, 0, 0], Face::NegX));
/// assert_eq!(voxels.material([1, 0, 0]), 7);
/// # Ok::<(), skipgrid::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SolidVoxels(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    resolution: [u32; 3],
    /// 0: empty.
    materials: Vec<u8>,
    origin: Vec3,
    edge: f32,
    planes: [Vec<f32>; 3],
    /// Exposed faces: six times the index of the voxel, and the number of the face. Ascending.
    faces: Vec<u32>,
    /// Row `r` of voxels along x has the faces `rows[r]..rows[r + 1]`.
    rows: Vec<u32>,
    solid: u64,
    bounds: Aabb,
}

impl SolidVoxels {
    /// Most voxels along one axis.
    pub const MAX_RESOLUTION: u32 = 4096;
    /// Most voxels: a face is kept in four bytes.
    pub const MAX_VOXELS: u64 = (1 << 32) / 6;
    /// Most exposed faces: there are two triangles for each and at most 2^32 - 2 primitives.
    const MAX_FACES: u64 = (1 << 31) - 1;
    /// Planes may lie this far from where exact arithmetic has them, in voxels.
    const MAX_DEVIATION: f64 = 0.25;

    /// Voxels of edge length `edge` from `origin` (the least corner, world units) on; `materials` has a byte for each, x
    /// varying fastest: 0 for an empty voxel, else a number that is the caller's.
    ///
    /// # Errors
    /// A resolution is not 1 to [`SolidVoxels::MAX_RESOLUTION`]; more than [`SolidVoxels::MAX_VOXELS`] voxels or 2^31 - 1
    /// exposed faces; `materials` has another length; the origin is not finite or the edge not above 0; a plane is not
    /// finite, or f32 cannot hold it within a quarter of the edge; no memory.
    pub fn new(resolution: [u32; 3], materials: Vec<u8>, origin: Vec3, edge: f32) -> Result<Self> {
        let [nx, ny, nz] = resolution;
        if let Some(n) = resolution.into_iter().find(|n| !(1..=Self::MAX_RESOLUTION).contains(n)) {
            let most = Self::MAX_RESOLUTION;
            return Err(Error::invalid(format!(
                "{nx} x {ny} x {nz} voxels: {n} along an axis, but must be 1 to {most}"
            )));
        }
        // At most 2^36.
        let voxels = u64::from(nx) * u64::from(ny) * u64::from(nz);
        if voxels > Self::MAX_VOXELS {
            let most = Self::MAX_VOXELS;
            return Err(Error::invalid(format!("{nx} x {ny} x {nz} are {voxels} voxels, at most {most} are possible")));
        }
        if materials.len() as u64 != voxels {
            let given = materials.len();
            return Err(Error::invalid(format!(
                "{nx} x {ny} x {nz} voxels need {voxels} materials, {given} are given"
            )));
        }
        let planes = planes(resolution, origin, edge)?;
        let (faces, rows) = exposed(resolution, &materials)?;
        let solid = materials.iter().filter(|&&m| m != 0).count() as u64;
        let mut parts = Parts { resolution, materials, origin, edge, planes, faces, rows, solid, bounds: Aabb::EMPTY };
        parts.bounds =
            (0..parts.faces.len() as u32).fold(Aabb::EMPTY, |all, f| all.union(&Aabb::of_points(&parts.square(f))));
        Ok(Self(Arc::new(parts)))
    }

    /// Voxels along x, y and z.
    pub fn resolution(&self) -> [u32; 3] {
        self.0.resolution
    }

    /// The least corner, world units.
    pub fn origin(&self) -> Vec3 {
        self.0.origin
    }

    /// Edge length of a voxel, world units.
    pub fn edge(&self) -> f32 {
        self.0.edge
    }

    /// Positions of the planes of an axis, 0 to 2, world units, ascending: one more than voxels.
    ///
    /// # Panics
    /// There is no such axis.
    pub fn planes(&self, axis: usize) -> &[f32] {
        &self.0.planes[axis]
    }

    /// The bytes of all voxels, x varying fastest; 0 is an empty voxel.
    pub fn materials(&self) -> &[u8] {
        &self.0.materials
    }

    /// The byte of a voxel within the resolution; 0 if it is empty.
    ///
    /// # Panics
    /// The voxel may lie beyond the resolution.
    pub fn material(&self, voxel: [u32; 3]) -> u8 {
        self.0.materials[self.0.index(voxel)]
    }

    /// Number of solid voxels.
    pub fn solid_voxels(&self) -> u64 {
        self.0.solid
    }

    /// Number of exposed faces, half the number of primitives.
    pub fn exposed_faces(&self) -> u32 {
        self.0.faces.len() as u32
    }

    /// The least box around all exposed faces, world units; empty if there is none.
    pub fn solid_bounds(&self) -> Aabb {
        self.0.bounds
    }

    /// The voxel and face that a primitive is half of.
    ///
    /// # Panics
    /// There is no such primitive.
    pub fn face_of(&self, prim: u32) -> ([u32; 3], Face) {
        self.0.place(prim / 2)
    }

    /// The first of the two primitives of a face of a voxel within the resolution; `None` if it is not exposed.
    ///
    /// # Panics
    /// The voxel may lie beyond the resolution.
    pub fn prim_of(&self, voxel: [u32; 3], face: Face) -> Option<u32> {
        let Parts { faces, rows, .. } = &*self.0;
        let index = self.0.index(voxel);
        let row = index / self.0.resolution[0] as usize;
        let (first, last) = (rows[row] as usize, rows[row + 1] as usize);
        let key = index as u32 * 6 + face as u32;
        let place = faces[first..last].binary_search(&key).ok()?;
        Some(2 * (first + place) as u32)
    }

    /// All primitives as a list of triangles, in their order.
    pub fn triangles(&self) -> impl Iterator<Item = Triangle> + '_ {
        (0..Geometry::len(self)).map(|prim| self.0.corners(prim))
    }

    /// Bytes of all that is kept.
    pub fn memory(&self) -> u64 {
        let Parts { materials, faces, rows, planes, .. } = &*self.0;
        let planes: usize = planes.iter().map(Vec::len).sum();
        (materials.len() + 4 * (faces.len() + rows.len() + planes)) as u64
    }
}

impl Parts {
    #[inline]
    fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        (z as usize * ny + y as usize) * nx + x as usize
    }

    /// The voxel and face of an exposed face.
    #[inline]
    fn place(&self, face: u32) -> ([u32; 3], Face) {
        let [nx, ny, _] = self.resolution;
        let key = self.faces[face as usize];
        let (voxel, face) = (key / 6, Face::ALL[(key % 6) as usize]);
        let row = voxel / nx;
        ([voxel % nx, row % ny, row / ny], face)
    }

    /// The corners of an exposed face, counter-clockwise seen from outside.
    #[inline]
    fn square(&self, face: u32) -> [Vec3; 4] {
        let (voxel, face) = self.place(face);
        let axis = face.axis();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = |axis: usize, upper: bool| self.planes[axis][voxel[axis] as usize + usize::from(upper)];
        let corner = |upper_u: bool, upper_v: bool| {
            let mut corner = [0.0; 3];
            corner[axis] = at(axis, face.is_upper());
            corner[u] = at(u, upper_u);
            corner[v] = at(v, upper_v);
            Vec3::from_array(corner)
        };
        // Turned by the first axis, then the second: about the normal of an upper face.
        let turn = face.is_upper();
        [corner(false, false), corner(turn, !turn), corner(true, true), corner(!turn, turn)]
    }

    #[inline]
    fn corners(&self, prim: u32) -> Triangle {
        let [a, b, c, d] = self.square(prim / 2);
        if prim.is_multiple_of(2) { [a, b, c] } else { [a, c, d] }
    }
}

/// Positions of the planes of each axis.
fn planes(resolution: [u32; 3], origin: Vec3, edge: f32) -> Result<[Vec<f32>; 3]> {
    if !(origin.is_finite() && edge > 0.0 && edge.is_finite()) {
        return Err(Error::invalid(format!(
            "voxels of edge {edge} from {origin} on: must be finite, the edge above 0"
        )));
    }
    let edge = f64::from(edge);
    let mut planes = [const { Vec::new() }; 3];
    for axis in 0..3 {
        for k in 0..=resolution[axis] {
            let exact = f64::from(origin[axis]) + f64::from(k) * edge;
            let plane = exact as f32;
            // Infinitely far off for an infinite plane.
            if (f64::from(plane) - exact).abs() > SolidVoxels::MAX_DEVIATION * edge {
                return Err(Error::invalid(format!(
                    "voxels of edge {edge} from {origin} on: plane {k} along {} at {exact} cannot be told apart from its \
                     neighbours in single precision",
                    ["x", "y", "z"][axis]
                )));
            }
            planes[axis].push(plane);
        }
    }
    Ok(planes)
}

/// Exposed faces, ascending, and the number of them before each row and at the end.
fn exposed([nx, ny, nz]: [u32; 3], materials: &[u8]) -> Result<(Vec<u32>, Vec<u32>)> {
    let (nx, ny, nz) = (nx as usize, ny as usize, nz as usize);
    let each = |found: &mut dyn FnMut(usize, usize, Face)| {
        for row in 0..ny * nz {
            let (y, z) = (row % ny, row / ny);
            for x in 0..nx {
                let v = row * nx + x;
                if materials[v] == 0 {
                    continue;
                }
                let open = [
                    x == 0 || materials[v - 1] == 0,
                    x + 1 == nx || materials[v + 1] == 0,
                    y == 0 || materials[v - nx] == 0,
                    y + 1 == ny || materials[v + nx] == 0,
                    z == 0 || materials[v - nx * ny] == 0,
                    z + 1 == nz || materials[v + nx * ny] == 0,
                ];
                Face::ALL.into_iter().zip(open).filter(|(_, open)| *open).for_each(|(face, _)| found(row, v, face));
            }
        }
    };
    let mut count = 0_u64;
    each(&mut |_, _, _| count += 1);
    if count > SolidVoxels::MAX_FACES {
        let most = SolidVoxels::MAX_FACES;
        return Err(Error::invalid(format!(
            "{nx} x {ny} x {nz} voxels: {count} exposed faces, at most {most} are possible"
        )));
    }
    let (mut faces, mut rows) = (Vec::new(), Vec::new());
    let places = [(&mut faces, count as usize), (&mut rows, ny * nz + 1)];
    for (list, length) in places {
        Vec::try_reserve_exact(list, length).map_err(|_| Error::TooLarge {
            what: format!("{nx} x {ny} x {nz} voxels with {count} exposed faces (the system refuses the memory)"),
            wanted: (count + (ny * nz) as u64 + 1) * 4,
            allowed: 0,
        })?;
    }
    rows.push(0);
    each(&mut |row, voxel, face| {
        // Every row before this one ends here.
        rows.resize(row + 1, faces.len() as u32);
        // Below 6 MAX_VOXELS.
        faces.push(voxel as u32 * 6 + face as u32);
    });
    rows.resize(ny * nz + 1, faces.len() as u32);
    Ok((faces, rows))
}

impl Geometry for SolidVoxels {
    type Prep = TrianglePrep;

    #[inline]
    fn len(&self) -> u32 {
        2 * self.0.faces.len() as u32
    }

    fn bounds(&self, prim: u32) -> Aabb {
        Aabb::of_points(&self.0.corners(prim))
    }

    #[inline]
    fn prepare(&self, ray: &Ray) -> TrianglePrep {
        TrianglePrep::new(ray)
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        triangle::test(self, prim, &self.0.corners(prim), ray, prep, best);
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) => triangle::round(&self.0.corners(prim), ray, best),
            None => best.t() as f32,
        }
    }

    #[inline]
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        Some(self.0.corners(prim))
    }

    #[inline]
    fn solid(&self) -> Option<&SolidVoxels> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_lie_around_their_voxels_and_look_outwards() {
        // Solid: (0, 0, 0), (1, 0, 0) and (2, 1, 1) of 3 x 2 x 2.
        let mut materials = vec![0; 12];
        (materials[0], materials[1], materials[11]) = (1, 2, 3);
        let voxels = SolidVoxels::new([3, 2, 2], materials, Vec3::new(-1.0, 2.0, 5.0), 0.5).expect("voxels");
        assert_eq!((voxels.solid_voxels(), voxels.exposed_faces()), (3, 10 + 6));
        assert_eq!(voxels.solid_bounds(), Aabb { min: Vec3::new(-1.0, 2.0, 5.0), max: Vec3::new(0.5, 3.0, 6.0) });
        let triangles: Vec<Triangle> = voxels.triangles().collect();
        for (prim, &[a, b, c]) in (0..).zip(&triangles) {
            let (voxel, face) = voxels.face_of(prim);
            assert!(voxels.material(voxel) > 0);
            assert_eq!(voxels.prim_of(voxel, face), Some(prim - prim % 2));
            // A right triangle with legs of an edge, half an edge from the voxel's centre on the side of the normal.
            assert_eq!((b - a).cross(c - a), 0.25 * face.normal(), "{prim}");
            let centre = Vec3::new(-1.0, 2.0, 5.0) + 0.5 * (Vec3::from(voxel.map(|i| i as f32)) + 0.5);
            assert_eq!((a - centre).dot(face.normal()), 0.25, "{prim}");
            assert!((a - centre).abs().max_element() == 0.25 && (c - centre).abs().max_element() == 0.25, "{prim}");
        }
        // The face between the two neighbours is not exposed, nor is any of an empty voxel.
        assert_eq!(voxels.prim_of([0, 0, 0], Face::PosX), None);
        assert_eq!(voxels.prim_of([1, 0, 0], Face::NegX), None);
        assert!(Face::ALL.iter().all(|&face| voxels.prim_of([2, 0, 0], face).is_none()));
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let full = |n: usize| vec![1; n];
        for (resolution, materials, origin, edge, word) in [
            ([0, 1, 1], vec![], Vec3::ZERO, 1.0, "0 along an axis"),
            ([4097, 1, 1], full(4097), Vec3::ZERO, 1.0, "4097 along an axis"),
            ([4096, 4096, 64], vec![], Vec3::ZERO, 1.0, "1073741824 voxels"),
            ([2, 2, 2], full(7), Vec3::ZERO, 1.0, "need 8 materials, 7 are given"),
            ([1, 1, 1], full(1), Vec3::NAN, 1.0, "must be finite"),
            ([1, 1, 1], full(1), Vec3::ZERO, 0.0, "edge 0"),
            ([1, 1, 1], full(1), Vec3::ZERO, f32::NAN, "edge NaN"),
            ([4, 1, 1], full(4), Vec3::ZERO, 1e38, "plane 4 along x"),
            // Single precision has steps of 2 there: odd planes lie a whole edge off.
            ([3, 1, 1], full(3), Vec3::new(16_777_216.0, 0.0, 0.0), 1.0, "plane 1 along x"),
        ] {
            let error = SolidVoxels::new(resolution, materials, origin, edge).expect_err(word).to_string();
            assert!(error.contains(word), "{word}: {error}");
        }
        // The least edge there is.
        assert!(SolidVoxels::new([4, 4, 4], full(64), Vec3::ZERO, f32::from_bits(1)).is_ok());
    }
}
