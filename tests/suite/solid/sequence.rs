//! The article's own forms: every solid voxel on the way, and the first; and its listings, mended, on the same rays.

use super::voxels;
use crate::random::Random;
use glam::{DVec2, IVec2, Vec2, Vec3};
use skipgrid::grid::{Face, SolidSequence, VoxelGrid};
use skipgrid::scene::SceneGeometry;
use skipgrid::{Aabb, Ray};

#[test]
fn the_first_solid_voxel_is_the_one_that_is_hit() {
    let mut random = Random::new(61);
    let set = voxels([20, 17, 23], Vec3::new(-5.0, 3.0, 0.0), 1.0, |_| random.below(30) == 0);
    let sequence = SolidSequence::new(&set).expect("a box");
    let accel = SceneGeometry::Voxels(set.clone()).accel("voxels").expect("solid voxels");
    let (mut hits, mut within) = (0, 0);
    for _ in 0..4000 {
        let origin = Vec3::new(5.0, 11.5, 11.5) + 16.0 * random.in_cube();
        let ray = Ray::new(origin, random.in_cube());
        let first = sequence.first_solid(&ray);
        let all: Vec<_> = sequence.crossings(&ray).collect();
        assert_eq!(first, all.first().copied());
        assert!(all.windows(2).all(|w| w[0].exit <= w[1].entry));
        assert!(all.iter().all(|visit| set.material(visit.voxel) == 1));
        let hit = accel.closest_hit(&ray);
        match first {
            Some(visit) if visit.face.is_some() => {
                hits += 1;
                let hit = hit.expect("the ray enters a solid voxel");
                assert_eq!((set.face_of(hit.prim)), (visit.voxel, visit.face.expect("entered")), "{ray:?}");
                // Planes are whole numbers: both parameters are the exact one, rounded to f32 and to f64.
                assert!((f64::from(hit.t) - visit.entry).abs() <= visit.entry * 6.1e-8, "{ray:?} {hit:?} {visit:?}");
            }
            Some(visit) => {
                within += 1;
                assert_eq!((visit.entry, visit.face), (0.0, None));
                // The accelerator hits the far side, of this voxel or of the last one in a row.
                let (voxel, face) = set.face_of(hit.expect("a way out").prim);
                let out = all.windows(2).position(|w| w[0].exit < w[1].entry).map_or(all[all.len() - 1], |i| all[i]);
                assert_eq!(voxel, out.voxel, "{ray:?}");
                assert!(ray.direction[face.axis()] * face.normal()[face.axis()] > 0.0);
            }
            None => assert_eq!(hit, None, "{ray:?}"),
        }
    }
    assert!(hits > 400 && within > 10, "{hits} hits, {within} from within");
}

#[test]
fn every_solid_voxel_of_a_row_is_crossed() {
    let set = voxels([9, 1, 1], Vec3::ZERO, 1.0, |[x, ..]| x % 3 != 0);
    let sequence = SolidSequence::new(&set).expect("a box");
    let crossed = |ray: Ray| sequence.crossings(&ray).map(|v| (v.voxel[0], v.face)).collect::<Vec<_>>();
    let (up, down) = (Some(Face::NegX), Some(Face::PosX));
    let there = Ray::new(Vec3::new(-2.0, 0.5, 0.5), Vec3::X);
    assert_eq!(crossed(there), [(1, up), (2, up), (4, up), (5, up), (7, up), (8, up)]);
    // From within, backwards, up to the last point of the range: within a voxel, or on the plane before the next.
    let back = |end: f32| crossed(Ray::new(Vec3::new(5.5, 0.5, 0.5), Vec3::NEG_X).with_range(0.0, end));
    assert_eq!(back(3.25), [(5, None), (4, down), (2, down)]);
    assert_eq!(back(3.5), [(5, None), (4, down), (2, down), (1, down)]);
    assert_eq!(crossed(Ray::new(Vec3::new(5.5, 2.0, 0.5), Vec3::X)), []);
}

/// The article's walks in two dimensions as they are meant: what moves them is a relative or an absolute distance.
struct Mended {
    origin: DVec2,
    direction: DVec2,
    next: DVec2,
    voxel: IVec2,
    position: DVec2,
    normal: IVec2,
}

impl Mended {
    /// The set-up without branches, with plus infinity along an axis of no movement.
    fn new(origin: DVec2, direction: DVec2) -> Self {
        let set_up = |axis: usize| {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 { f64::INFINITY } else { (d.signum() * 0.5 + 0.5 - (o - o.floor())) / d }
        };
        let next = DVec2::new(set_up(0), set_up(1));
        Self { origin, direction, next, voxel: origin.floor().as_ivec2(), position: origin, normal: IVec2::ZERO }
    }

    /// The loop with branches: distances are relative to the position, so that a step is subtracted from the other axis.
    fn step_relative(&mut self) {
        let axis = usize::from(self.next.y < self.next.x);
        let step = self.next[axis];
        self.position += self.direction * step;
        self.next[1 - axis] -= step;
        self.next[axis] = 1.0 / self.direction[axis].abs();
        self.turn(axis);
    }

    /// The loop without: distances are from the origin; a mask with one axis, and a choice instead of a product.
    fn step_absolute(&mut self) {
        let closest = self.next.min_element();
        let mask = [self.next.x <= closest, self.next.x > closest];
        self.position = self.origin + self.direction * closest;
        for (axis, on) in mask.into_iter().enumerate() {
            let further = self.next[axis] + 1.0 / self.direction[axis].abs();
            self.next[axis] = if on { further } else { self.next[axis] };
        }
        self.turn(usize::from(mask[1]));
    }

    fn turn(&mut self, axis: usize) {
        let step = if self.direction[axis] > 0.0 { 1 } else { -1 };
        self.voxel[axis] += step;
        self.normal = IVec2::ZERO;
        self.normal[axis] = -step;
    }
}

#[test]
fn both_mended_forms_walk_as_the_exact_sequence_does() {
    let bounds = Aabb { min: Vec3::new(-32.0, -32.0, 0.0), max: Vec3::new(32.0, 32.0, 1.0) };
    let grid = VoxelGrid::new(bounds, [64, 64, 1]).expect("a box");
    let mut random = Random::new(62);
    for i in 0..500 {
        let origin = 4.0 * Vec2::new(random.signed(), random.signed());
        let mut direction = Vec2::new(random.signed(), random.signed());
        if i % 5 == 0 {
            // What stalls the printed form.
            direction[i / 5 % 2] = 0.0;
        }
        let exact: Vec<_> = grid.voxels(&Ray::new(origin.extend(0.5), direction.extend(0.0))).collect();
        for relative in [true, false] {
            let mut walk = Mended::new(origin.as_dvec2(), direction.as_dvec2());
            // Not to the border: rounding grows with the relative form.
            for visit in &exact[1..exact.len().min(20)] {
                if relative {
                    walk.step_relative()
                } else {
                    walk.step_absolute()
                }
                let voxel = IVec2::new(visit.voxel[0] as i32 - 32, visit.voxel[1] as i32 - 32);
                assert_eq!(walk.voxel, voxel, "{origin} {direction} relative: {relative}");
                let normal = visit.face.expect("entered").normal();
                assert_eq!(walk.normal, normal.truncate().as_ivec2());
                let right = origin.as_dvec2() + direction.as_dvec2() * visit.entry;
                assert!((walk.position - right).abs().max_element() < 1e-10, "{origin} {direction} {relative}");
            }
        }
    }
    // The steps of the example that the printed forms get wrong: 2 and 6.
    for relative in [true, false] {
        let mut walk = Mended::new(DVec2::new(0.3, 0.6), DVec2::new(0.8, 0.6));
        for (step, right) in
            [(1, None), (2, Some((1.0, 1.125))), (3, None), (4, None), (5, None), (6, Some((3.5, 3.0)))]
        {
            if relative {
                walk.step_relative()
            } else {
                walk.step_absolute()
            }
            let off = right.map_or(0.0, |right| walk.position.distance(DVec2::from(right)));
            assert!(off < 1e-12, "step {step}: {}", walk.position);
        }
    }
}
