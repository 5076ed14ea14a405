//! The public voxel sequence against the oracle's, and printed walks that fail where it does not.

mod printed;

use crate::random::Random;
use glam::Vec3;
use skipgrid::grid::{Face, VoxelGrid, VoxelVisit};
use skipgrid::oracle::voxels::{End, Path, Visit, Voxels};
use skipgrid::{Aabb, Ray};

fn grid(min: [f32; 3], max: [f32; 3], resolution: [u32; 3]) -> VoxelGrid {
    VoxelGrid::new(Aabb { min: min.into(), max: max.into() }, resolution).expect("a box with an extent")
}

/// A number between the powers of ten, either sign.
fn power(random: &mut Random, low: f32, high: f32) -> f32 {
    let exponent = low + (high - low) * (0.5 * random.signed() + 0.5);
    10f32.powf(exponent).copysign(random.signed())
}

/// The nearest f32 to a point of the lattice that the voxels' corners form.
fn corner(random: &mut Random, grid: &VoxelGrid) -> Vec3 {
    let Aabb { min, max } = grid.bounds();
    Vec3::from([0, 1, 2].map(|a| {
        let (lo, hi, n) = (f64::from(min[a]), f64::from(max[a]), grid.resolution()[a]);
        let k = random.below(n as usize + 1) as f64 / f64::from(n);
        (lo * (1.0 - k) + hi * k) as f32
    }))
}

/// A point in the box, or up to half an extent outside with `reach` 2.
fn point(random: &mut Random, grid: &VoxelGrid, reach: f32) -> Vec3 {
    let Aabb { min, max } = grid.bounds();
    // Halves first: the extent of the greatest boxes is no f32.
    let (centre, half) = (min / 2.0 + max / 2.0, max / 2.0 - min / 2.0);
    (centre + reach * half * random.in_cube()).clamp(Vec3::splat(-f32::MAX), Vec3::splat(f32::MAX))
}

/// Turns one or two components into zeros of either sign.
fn flatten(random: &mut Random, v: &mut Vec3) {
    let first = random.below(3);
    let second = (first + random.below(3)) % 3; // the same in a third of the cases
    v[first] = 0f32.copysign(random.signed());
    v[second] = 0f32.copysign(random.signed());
}

const CLASSES: [&str; 16] = [
    "random",
    "axis-parallel",
    "in planes",
    "along edges",
    "through corners",
    "diagonal",
    "diagonal from a voxel's centre",
    "zero components",
    "tiny components",
    "from a face of the box",
    "from afar",
    "touching the box's edges",
    "of any length",
    "short",
    "ending on planes",
    "any bits",
];

/// A ray of a class.
fn ray(random: &mut Random, grid: &VoxelGrid, class: usize) -> Ray {
    let extent = grid.bounds().max / 2.0 - grid.bounds().min / 2.0;
    let signs = |random: &mut Random| random.in_cube().signum();
    let mut origin = point(random, grid, 2.0);
    let mut direction = point(random, grid, 1.0) - origin;
    let (mut t_min, mut t_max) = (0.0, f32::INFINITY);
    match CLASSES[class] {
        "random" => {}
        "axis-parallel" => {
            let axis = random.below(3);
            origin = point(random, grid, 1.0);
            direction = Vec3::from([(); 3].map(|()| 0f32.copysign(random.signed())));
            direction[axis] = random.signed();
            t_min = f32::NEG_INFINITY;
        }
        "in planes" => {
            let axis = random.below(3);
            origin[axis] = corner(random, grid)[axis];
            direction[axis] = 0f32.copysign(random.signed());
        }
        "along edges" => {
            origin = corner(random, grid);
            direction = Vec3::ZERO;
            direction[random.below(3)] = random.signed();
            t_min = if random.below(2) == 0 { 0.0 } else { f32::NEG_INFINITY };
        }
        "through corners" => {
            origin = corner(random, grid);
            direction = corner(random, grid) - origin;
            if random.below(2) == 0 {
                origin -= direction;
            }
        }
        "diagonal" => {
            origin = corner(random, grid);
            direction = signs(random);
            if random.below(2) == 0 {
                direction *= extent / Vec3::from(grid.resolution().map(|n| n as f32));
            }
            if random.below(3) == 0 {
                direction[random.below(3)] = 0.0;
            }
            t_min = if random.below(2) == 0 { 0.0 } else { f32::NEG_INFINITY };
        }
        "diagonal from a voxel's centre" => {
            let voxel = 2.0 * extent / Vec3::from(grid.resolution().map(|n| n as f32));
            origin = corner(random, grid) + 0.5 * voxel;
            direction = signs(random) * voxel;
            t_min = f32::NEG_INFINITY;
        }
        "zero components" => flatten(random, &mut direction),
        "tiny components" => {
            let axis = random.below(3);
            direction[axis] *= power(random, -38.0, -3.0);
            if random.below(2) == 0 {
                direction[(axis + 1) % 3] = f32::from_bits(random.below(1000) as u32);
            }
            origin = if random.below(2) == 0 { corner(random, grid) } else { origin };
        }
        "from a face of the box" => {
            let axis = random.below(3);
            let side = if random.below(2) == 0 { grid.bounds().min } else { grid.bounds().max };
            origin = if random.below(2) == 0 { corner(random, grid) } else { point(random, grid, 1.0) };
            origin[axis] = side[axis];
            if random.below(2) == 0 {
                direction = extent * random.in_cube();
            }
        }
        "from afar" => {
            let away = point(random, grid, 1.0);
            let far = random.in_cube() * power(random, 2.0, 30.0);
            origin = (away + far).clamp(Vec3::splat(-3e38), Vec3::splat(3e38));
            direction = point(random, grid, 1.0) / 2.0 - origin / 2.0;
            if random.below(2) == 0 {
                direction /= direction.abs().max_element();
            }
        }
        "touching the box's edges" => {
            // Through a point of an edge, mostly passing by.
            origin = corner(random, grid);
            let axis = random.below(3);
            for a in [(axis + 1) % 3, (axis + 2) % 3] {
                origin[a] = if random.below(2) == 0 { grid.bounds().min[a] } else { grid.bounds().max[a] };
            }
            direction = signs(random);
            if random.below(2) == 0 {
                direction[axis] = 0.0;
            }
            t_min = -1.0;
        }
        "of any length" => direction *= power(random, -38.0, 37.0),
        "short" => {
            t_min = random.signed();
            t_max = t_min + random.signed().abs() * power(random, -7.0, 0.0).abs();
        }
        "ending on planes" => {
            // Whole steps between lattice points, where those are f32.
            origin = corner(random, grid);
            direction = 2.0 * extent * signs(random) / Vec3::from(grid.resolution().map(|n| n as f32));
            t_min = random.below(8) as f32 - 4.0;
            t_max = t_min + random.below(8) as f32;
        }
        _ => {
            let mut bits = || f32::from_bits(random.next() as u32);
            origin = Vec3::new(bits(), bits(), bits());
            direction = Vec3::new(bits(), bits(), bits());
            (t_min, t_max) = (bits(), bits());
        }
    }
    Ray { origin, direction, t_min, t_max }
}

/// Checks one ray; returns how many voxels it visits.
fn check(grid: &VoxelGrid, ray: &Ray, what: &str) -> usize {
    let place = || format!("{what}: {ray:?} in {grid:?}");
    let visits: Vec<VoxelVisit> = {
        let mut voxels = grid.voxels(ray);
        let (least, most) = voxels.size_hint();
        let visits: Vec<_> = voxels.by_ref().collect();
        assert!(voxels.next().is_none(), "an end is an end: {}", place());
        assert!(least <= visits.len() && visits.len() <= most.expect("a bound"), "{}", place());
        visits
    };
    if ray.intake().is_none() {
        assert!(visits.is_empty(), "{}", place());
        return 0;
    }
    let exact = Voxels::of_box(&grid.bounds(), grid.resolution()).path(ray);
    let theirs = exact.as_ref().map_or(&[][..], Path::visits);
    assert_eq!(visits.len(), theirs.len(), "{}", place());
    let Some(exact) = &exact else { return 0 };
    // Where the ray is on its way towards lesser coordinates it crosses the upper face.
    let face = |visit: &Visit| visit.axis.map(|a| if ray.direction[a] > 0.0 { Face::LOWER[a] } else { Face::UPPER[a] });
    // Within 2^-52 (1 + 2^-48) of the exact parameter, relative.
    let is_close =
        |visit: &Visit, end: End, t: f64| exact.relative_error(visit, end, t) <= f64::EPSILON * (1.0 + 2f64.powi(-48));
    for (i, (ours, theirs)) in visits.iter().zip(theirs).enumerate() {
        assert_eq!((ours.voxel, ours.face), (theirs.voxel, face(theirs)), "voxel {i}, {}", place());
        assert!(is_close(theirs, End::Entry, ours.entry), "entry of voxel {i}, {ours:?}, {}", place());
        assert!(is_close(theirs, End::Exit, ours.exit), "exit of voxel {i}, {ours:?}, {}", place());
        assert!(ours.entry <= ours.exit, "voxel {i}, {ours:?}, {}", place());
        assert!(!theirs.is_touch() || ours.entry == ours.exit, "voxel {i}, {ours:?}, {}", place());
    }
    for pair in visits.windows(2) {
        assert_eq!(pair[0].exit, pair[1].entry, "{}", place());
        // The face that is crossed is the only difference.
        let face = pair[1].face.expect("crossed");
        let normal = face.normal().to_array().map(|x| x as i64);
        let step = [0, 1, 2].map(|a| i64::from(pair[0].voxel[a]) - i64::from(pair[1].voxel[a]));
        assert_eq!(step, normal, "{}", place());
    }
    visits.len()
}

/// `count` rays of each class; some of each class must meet the box.
fn check_classes(grids: &[VoxelGrid], count: usize, seed: u64) {
    let mut random = Random::new(seed);
    for (class, name) in CLASSES.iter().enumerate() {
        let mut voxels = 0;
        for i in 0..count {
            let grid = &grids[i % grids.len()];
            voxels += check(grid, &ray(&mut random, grid, class), name);
        }
        assert!(*name == "any bits" || voxels > count / 10, "{name}: {voxels} voxels, {count} rays");
    }
}

#[test]
fn sequences_are_exact_in_small_grids() {
    let thousand = [1000.0; 3];
    check_classes(
        &[
            grid([0.0; 3], [1.0; 3], [1; 3]),
            grid([0.0; 3], [2.0; 3], [2; 3]),
            grid([-8.0; 3], [8.0; 3], [16; 3]),
            grid([0.0; 3], [1.0; 3], [3, 5, 7]),
            grid([-0.3, 0.1, 2.7], [1.7, 0.2, 9.1], [10, 1, 4]),
            grid([0.0, -1.0, 5.0], [64.0, 99.0, 38.0], [64, 100, 33]),
            grid(thousand, [1000.01; 3], [33, 29, 31]),
            grid([1e7; 3], [1e7 + 1.0, 1e7 + 2.0, 1e7 + 3.0], [17, 3, 24]),
            grid([-1e-3, -1e5, -1.0], [1e-3, 1e5, 1.0], [8, 40, 9]),
        ],
        1800,
        1,
    );
}

#[test]
fn sequences_are_exact_at_the_ends_of_f32() {
    let least = f32::from_bits(1);
    check_classes(
        &[
            grid([-f32::MAX; 3], [f32::MAX; 3], [20, 21, 22]),
            grid([0.0; 3], [least; 3], [20, 21, 22]),
            grid([-3.0 * least; 3], [1e-38; 3], [7; 3]),
            grid([-f32::MAX, 0.0, 1.0], [f32::MAX, least, 1.0 + f32::EPSILON], [40, 41, 42]),
        ],
        400,
        2,
    );
}

#[test]
fn sequences_are_exact_in_grids_of_4096_voxels_an_axis() {
    check_classes(
        &[
            grid([0.0; 3], [1.0; 3], [4096; 3]),
            grid([0.0; 3], [4096.0; 3], [4096; 3]),
            grid([-0.3, 10.1, 2.7], [1.7, 13.3, 9.1], [4096; 3]),
            grid([0.0; 3], [1.0; 3], [4096, 1, 4096]),
            grid([0.0, -1.0, 0.0], [1.0, 1.0, 1e-4], [1000, 4096, 3]),
            grid([5e5; 3], [5e5 + 300.0; 3], [4095, 4001, 4096]),
        ],
        36,
        3,
    );
}

/// Voxels, faces, and where each is left.
fn visits(
    grid: &VoxelGrid,
    origin: [f32; 3],
    direction: [f32; 3],
    range: [f32; 2],
) -> Vec<([u32; 3], Option<Face>, f64)> {
    let ray = Ray::new(origin.into(), direction.into()).with_range(range[0], range[1]);
    grid.voxels(&ray).map(|v| (v.voxel, v.face, v.exit)).collect()
}

#[test]
fn ties_faces_and_ends_are_as_documented() {
    let unit = grid([0.0; 3], [2.0; 3], [2; 3]);
    let all = [0.0, f32::INFINITY];
    // Corner to corner: z before y before x, in no time; through the corner of the box the last face is x.
    assert_eq!(
        visits(&unit, [-1.0; 3], [1.0; 3], all),
        [
            ([0, 0, 0], Some(Face::NegX), 2.0),
            ([0, 0, 1], Some(Face::NegZ), 2.0),
            ([0, 1, 1], Some(Face::NegY), 2.0),
            ([1, 1, 1], Some(Face::NegX), 3.0),
        ]
    );
    // In the plane between: the upper side. In the box's own upper face: the last voxel.
    for sign in [0.0, -0.0] {
        let upper = [([1, 0, 0], None, 0.5), ([1, 1, 0], Some(Face::NegY), 1.5)];
        assert_eq!(visits(&unit, [1.0, 0.5, 0.5], [sign, 1.0, sign], all), upper);
        assert_eq!(visits(&unit, [2.0, 0.5, 0.5], [sign, 1.0, sign], all), upper);
    }
    // From a plane downwards and upwards; an origin on the box's face has not crossed it.
    let down = [([1, 0, 0], None, 0.0), ([0, 0, 0], Some(Face::PosX), 1.0)];
    assert_eq!(visits(&unit, [1.0, 0.5, 0.5], [-1.0, 0.0, 0.0], all), down);
    assert_eq!(visits(&unit, [1.0, 0.5, 0.5], [1.0, 0.0, 0.0], all), [([1, 0, 0], None, 1.0)]);
    let whole = [([0, 0, 0], None, 1.0), ([1, 0, 0], Some(Face::NegX), 2.0)];
    assert_eq!(visits(&unit, [0.0, 0.5, 0.5], [1.0, 0.0, 0.0], all), whole);
    assert_eq!(visits(&unit, [0.0, 0.5, 0.5], [-1.0, 0.0, 0.0], all), [([0, 0, 0], None, 0.0)]);
    // A last point on a plane counts, and nothing beyond it does.
    let closed = [([0, 0, 0], None, 1.0), ([1, 0, 0], Some(Face::NegX), 1.0)];
    assert_eq!(visits(&unit, [0.0, 0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0]), closed);
    let before = [([0, 0, 0], None, f64::from(1f32.next_down()))];
    assert_eq!(visits(&unit, [0.0, 0.5, 0.5], [1.0, 0.0, 0.0], [0.0, 1f32.next_down()]), before);
    // A point of an edge of the box, touched in passing.
    assert_eq!(visits(&unit, [1.0, -1.0, 0.5], [1.0, 1.0, 0.0], all), [([1, 0, 0], Some(Face::NegY), 1.0)]);
    // The box is left 2^-140 after the plane is crossed: both count.
    let tiny = 2f32.powi(-140);
    assert_eq!(visits(&unit, [1.0, tiny, 0.5], [-1.0, -1.0, 0.0], all).len(), 2);
}

#[test]
fn a_sequence_is_as_long_as_the_ray_in_the_box() {
    let grid = grid([-1.0; 3], [1.0; 3], [4096, 4001, 333]);
    let mut random = Random::new(5);
    for _ in 0..50 {
        let (from, to) = (0.99 * random.in_cube(), 0.99 * random.in_cube());
        let ray = Ray::new(from, to - from).with_range(0.25, 0.75);
        let sum: f64 = grid.voxels(&ray).map(|v| v.exit - v.entry).sum();
        // Each difference is off by 2^-52 at most, each of at most 8430 additions by 2^-54.
        assert!((sum - 0.5).abs() < 8430.0 * 2f64.powi(-51), "{ray:?}: {sum}");
    }
}

#[test]
fn boxes_without_extent_and_resolutions_out_of_range_are_refused() {
    let fine = ([0.0; 3], [1.0; 3], [8; 3]);
    for (min, max, resolution, word) in [
        ([f32::NAN, 0.0, 0.0], fine.1, fine.2, "x"),
        (fine.0, [1.0, f32::INFINITY, 1.0], fine.2, "y"),
        (fine.0, [1.0, 1.0, 0.0], fine.2, "z"),
        ([0.0, 2.0, 0.0], fine.1, fine.2, "between 2 and 1 along y"),
        (fine.0, fine.1, [8, 8, 0], "along z is 0"),
        (fine.0, fine.1, [4097, 8, 8], "along x is 4097"),
    ] {
        let error = VoxelGrid::new(Aabb { min: min.into(), max: max.into() }, resolution).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
    let made = grid(fine.0, fine.1, fine.2);
    assert_eq!((made.bounds().max, made.resolution()), (Vec3::ONE, [8; 3]));
}
