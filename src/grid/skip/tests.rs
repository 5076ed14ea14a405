//! Every method on random occupancies: distances against their definitions, relations between methods, and leaps against
//! the plain walk.

use super::distance::{chebyshev_octants, city_block, city_block_octants};
use super::*;
use crate::geometry::tests::Random;
use crate::grid::cells::Cells;
use crate::grid::frame::Frame;
use crate::grid::occupancy::Occupancy;
use crate::grid::options::GridOptions;
use crate::grid::walk::{Start, VoxelWalk, Walk};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

fn occupancy(random: &mut Random, resolution: [usize; 3], share: f32) -> Occupancy {
    let voxels = resolution.iter().product();
    Occupancy { resolution, filled: (0..voxels).map(|_| random.unit() < share).collect() }
}

/// Sizes and shares of filled voxels, from none to all.
fn cases() -> Vec<Occupancy> {
    let mut random = Random::new(1);
    let mut cases = Vec::new();
    for resolution in [[9, 7, 8], [1, 12, 5], [16, 1, 1], [6, 13, 2], [1, 1, 1]] {
        for share in [0.0, 0.01, 0.05, 0.3, 1.0] {
            cases.push(occupancy(&mut random, resolution, share));
        }
    }
    cases
}

fn place(o: &Occupancy, voxel: usize) -> [i32; 3] {
    let [nx, ny, _] = o.resolution;
    [voxel % nx, voxel / nx % ny, voxel / (nx * ny)].map(|i| i as i32)
}

/// From a voxel to each filled one.
fn offsets(o: &Occupancy, voxel: usize) -> impl Iterator<Item = [i32; 3]> + '_ {
    let from = place(o, voxel);
    let filled = (0..o.len()).filter(|&v| o.filled[v]).map(|v| place(o, v));
    filled.map(move |to| [to[0] - from[0], to[1] - from[1], to[2] - from[2]])
}

/// The least of some distances, 255 if there is none.
fn nearest(distances: impl Iterator<Item = i32>) -> u8 {
    distances.min().map_or(u8::MAX, |d| d.min(255) as u8)
}

/// The voxel beside `voxel` across `face`, or `None` beyond the grid.
fn neighbour(o: &Occupancy, voxel: usize, face: usize) -> Option<usize> {
    let (axis, stride) = (face / 2, o.stride(face / 2));
    let at = voxel / stride % o.resolution[axis];
    if face & 1 == 0 { (at + 1 < o.resolution[axis]).then(|| voxel + stride) } else { (at > 0).then(|| voxel - stride) }
}

fn l1(d: [i32; 3]) -> i32 {
    d.iter().map(|x| x.abs()).sum()
}

fn within(d: [i32; 3], octant: usize) -> bool {
    (0..3).all(|a| if octant >> a & 1 == 0 { d[a] >= 0 } else { d[a] <= 0 })
}

/// How far `d` is ahead across `face`.
fn ahead(d: [i32; 3], face: usize) -> i32 {
    if face & 1 == 0 { d[face / 2] } else { -d[face / 2] }
}

#[test]
fn distances_are_those_of_their_definitions() {
    for o in cases() {
        let linear = SkipOptions::default();
        let clouds = &ProximityClouds::distances(&o, &linear)[0];
        let zones = DirectedSafeZones::distances(&o, &linear);
        let octants = DirectedSafeZones24::distances(&o, &linear);
        let chess = &Chessboard::distances(&o, &linear)[0];
        let cubes = Octants::distances(&o, &linear);
        let largest = |d: [i32; 3]| d.iter().map(|x| x.abs()).max().unwrap_or(0);
        for v in 0..o.len() {
            let place = place(&o, v);
            assert_eq!(clouds[v], nearest(offsets(&o, v).map(l1)), "{place:?}");
            assert_eq!(chess[v], nearest(offsets(&o, v).map(largest)), "{place:?}");
            for (face, zone) in zones.iter().enumerate() {
                let beyond = offsets(&o, v).filter(|&d| ahead(d, face) > 0);
                assert_eq!(zone[v], nearest(beyond.map(l1)), "{place:?}, face {face}");
            }
            for octant in 0..8 {
                let inside = || offsets(&o, v).filter(|&d| within(d, octant));
                assert_eq!(octants[octant][v], nearest(inside().map(l1)), "{place:?}, octant {octant}");
                assert_eq!(cubes[octant][v], nearest(inside().map(largest)), "{place:?}, octant {octant}");
            }
        }
    }
}

#[test]
fn dual_extents_are_empty_and_as_long_as_they_can_be() {
    for o in cases() {
        for lane in [1, 3, 255] {
            let planes = DualExtents::distances(&o, &SkipOptions { lane, ..SkipOptions::default() });
            let (cloud, extents) = planes.split_first().expect("the cloud and six extents");
            for v in (0..o.len()).filter(|&v| !o.filled[v]) {
                assert_eq!(cloud[v], nearest(offsets(&o, v).map(l1)).min(lane));
                for (face, extent) in extents.iter().enumerate() {
                    let aside = |d: [i32; 3]| l1(d) - d[face / 2].abs();
                    let in_lane = |&d: &[i32; 3]| ahead(d, face) >= 0 && aside(d) < i32::from(cloud[v]);
                    // The first filled voxel of the lane ends it: exact, not merely safe.
                    assert_eq!(extent[v], nearest(offsets(&o, v).filter(in_lane).map(l1)), "face {face}, lane {lane}");
                    assert!(extent[v] >= cloud[v], "the dual extent contains the cloud");
                }
            }
        }
    }
}

#[test]
fn methods_relate_as_the_sources_say() {
    for o in cases() {
        let linear = SkipOptions::default();
        let clouds = city_block(&o);
        let zones = DirectedSafeZones::distances(&o, &linear);
        let octants = city_block_octants(&o);
        for v in (0..o.len()).filter(|&v| !o.filled[v]) {
            // The least of the six directed distances is the cloud's.
            assert_eq!(zones.iter().map(|zone| zone[v]).min(), Some(clouds[v]));
            assert_eq!(octants.iter().map(|octant| octant[v]).min(), Some(clouds[v]));
            for (face, zone) in zones.iter().enumerate() {
                // The 24 values: D_fo(v) = 1 + Q_o(v + f) is the distance to what lies beyond f in octant o; their least is
                // D_f, and none is less than Q_o(v).
                let four = (0..8).filter(|octant| octant >> (face / 2) & 1 == face % 2);
                let mut least = u8::MAX;
                for octant in four {
                    let beside = neighbour(&o, v, face);
                    let value = beside.map_or(u8::MAX, |beside| octants[octant][beside].saturating_add(1));
                    let beyond = offsets(&o, v).filter(|&d| within(d, octant) && ahead(d, face) > 0);
                    assert_eq!(value, nearest(beyond.map(l1)), "face {face}, octant {octant}");
                    assert!(value >= octants[octant][v]);
                    least = least.min(value);
                }
                assert_eq!(zone[v], least);
            }
        }
    }
}

/// The transform as it is printed: forward mask, backward mask, each voxel the least of its own value and its neighbours'
/// plus one.
fn two_masks(o: &Occupancy) -> Vec<u8> {
    let mut d: Vec<u8> = o.filled.iter().map(|&f| if f { 0 } else { u8::MAX }).collect();
    for faces in [[1, 3, 5], [0, 2, 4]] {
        let mut pass = |v: usize| {
            for face in faces {
                if let Some(beside) = neighbour(o, v, face) {
                    d[v] = d[v].min(d[beside].saturating_add(1));
                }
            }
        };
        if faces[0] == 1 { (0..o.len()).for_each(&mut pass) } else { (0..o.len()).rev().for_each(&mut pass) }
    }
    d
}

#[test]
fn sweeps_find_what_the_two_mask_passes_find() {
    let mut random = Random::new(2);
    for o in cases()
        .into_iter()
        .chain([occupancy(&mut random, [70, 40, 33], 1e-4), occupancy(&mut random, [300, 2, 3], 0.002)])
    {
        assert_eq!(city_block(&o), two_masks(&o), "{:?}", o.resolution);
    }
}

#[test]
fn distances_saturate() {
    let mut o = occupancy(&mut Random::new(3), [700, 1, 2], 0.0);
    o.filled[0] = true;
    let expected = |v: usize| nearest(offsets(&o, v).map(l1));
    let (clouds, cubes) = (city_block(&o), chebyshev_octants(&o));
    for v in [1, 254, 255, 256, 699, 700, 1399] {
        assert_eq!(clouds[v], expected(v));
        // Towards lesser coordinates along every axis.
        assert_eq!(cubes[7][v], (v % 700).max(v / 700).min(255) as u8);
    }
}

/// The filled voxels that a walk visits, and how many looks it took.
fn visited<S: Skip<Walk>>(voxels: &S, frame: &Frame, ray: &Ray) -> (Vec<usize>, usize) {
    let (mut filled, mut looks) = (Vec::new(), 0);
    let Some(ray) = ray.intake() else { return (filled, looks) };
    let Start::Inside(mut walk) = Walk::start(frame, &ray) else { return (filled, looks) };
    let shared = S::ray(&walk);
    loop {
        looks += 1;
        assert!(looks < 100_000, "the walk does not end: {ray:?}");
        let goes_on = match voxels.look(&walk, &shared) {
            Look::List(list) => {
                if !list.is_empty() {
                    filled.push(walk.voxel());
                }
                walk.step()
            }
            Look::Empty(safe_until) => {
                let t = safe_until.max(walk.exit());
                walk.leap(t)
            }
            Look::Near => walk.step(),
        };
        if !goes_on {
            return (filled, looks);
        }
    }
}

fn cells(o: &Occupancy) -> Cells {
    let mut start = vec![0];
    let mut prims = Vec::new();
    for (v, &filled) in o.filled.iter().enumerate() {
        if filled {
            prims.push(v as u32);
        }
        start.push(prims.len() as u32);
    }
    Cells::new(start, prims)
}

fn table<M: Method, T: Slot>(o: &Occupancy, options: &SkipOptions) -> Table<M, T> {
    Table::new(cells(o), o.resolution.map(|n| n as u32), options, 1 << 30).expect("a small table")
}

/// A frame whose voxels have the resolution of `o` and about unit size.
fn frame(o: &Occupancy) -> Frame {
    let resolution = o.resolution.map(|n| n as u32);
    let max = Vec3::from(resolution.map(|n| n as f32));
    Frame::new(
        &Aabb { min: Vec3::ZERO, max },
        1,
        &GridOptions { resolution: Some(resolution), ..GridOptions::default() },
    )
}

/// Rays of no special direction through the grid, from inside and outside.
fn rays(random: &mut Random, o: &Occupancy, count: usize) -> Vec<Ray> {
    let size = Vec3::from(o.resolution.map(|n| n as f32));
    let mut ray = || {
        let origin = size * (0.5 + random.in_cube() * if random.unit() < 0.5 { 0.5 } else { 3.0 });
        let target = size * (0.5 + random.in_cube() * 0.5);
        // Some nearly along an axis, where lanes are long.
        let mut direction = target - origin;
        if random.unit() < 0.3 {
            direction[random.next() as usize % 3] *= 50.0;
        }
        Ray::new(origin, direction)
    };
    (0..count).map(|_| ray()).collect()
}

/// Grids on which leaps are long and short.
fn scenes() -> Vec<Occupancy> {
    let mut random = Random::new(4);
    let mut scenes: Vec<Occupancy> =
        [0.0005, 0.01, 0.2].iter().map(|&s| occupancy(&mut random, [40, 30, 50], s)).collect();
    // A hollow ball: rays run inside and along it.
    let mut ball = occupancy(&mut random, [40; 3], 0.0);
    for v in 0..ball.len() {
        let r = place(&ball, v).iter().map(|&x| (f64::from(x) - 19.5).powi(2)).sum::<f64>().sqrt();
        ball.filled[v] = (17.0..18.0).contains(&r);
    }
    scenes.push(ball);
    scenes
}

fn leaps_are_safe<M: Method, T: Slot>(options: &SkipOptions) {
    let mut random = Random::new(5);
    let (mut walked, mut leapt) = (0, 0);
    for o in scenes() {
        let (frame, plain, table) = (frame(&o), NoSkip(cells(&o)), table::<M, T>(&o, options));
        for ray in rays(&mut random, &o, 3000) {
            let (expected, steps) = visited(&plain, &frame, &ray);
            let (found, looks) = visited(&table, &frame, &ray);
            assert_eq!(found, expected, "{} {options:?}: {ray:?}", M::NAME);
            walked += steps;
            leapt += looks;
        }
    }
    // Full grids allow no leap worth the name, the others many.
    assert!(4 * leapt < 3 * walked, "{} {options:?}: {leapt} looks, {walked} steps", M::NAME);
}

#[test]
fn leaps_pass_over_no_filled_voxel() {
    for (distances, threshold) in [(Distances::Log2, 1), (Distances::HalfLog2, 3)] {
        let options = SkipOptions { distances, threshold, ..SkipOptions::default() };
        leaps_are_safe::<ProximityClouds, Packed>(&options);
        leaps_are_safe::<DirectedSafeZones, Packed>(&options);
        leaps_are_safe::<DirectedSafeZones24, Packed>(&options);
        leaps_are_safe::<DualExtents, Packed>(&options);
        leaps_are_safe::<Chessboard, Packed>(&options);
        leaps_are_safe::<Octants, Packed>(&options);
    }
    for lane in [2, 16, 255] {
        leaps_are_safe::<DualExtents, Eight>(&SkipOptions { lane, ..SkipOptions::default() });
    }
    let linear = SkipOptions::default();
    leaps_are_safe::<ProximityClouds, One>(&linear);
    leaps_are_safe::<DirectedSafeZones, Eight>(&linear);
    leaps_are_safe::<DirectedSafeZones24, Eight>(&linear);
    leaps_are_safe::<Chessboard, One>(&linear);
    leaps_are_safe::<Octants, Eight>(&linear);
}

fn leaps_end<M: Method>() {
    let mut random = Random::new(8);
    for o in scenes() {
        // Around the origin, which rays from the far ends of f32 still meet.
        let resolution = o.resolution.map(|n| n as u32);
        let max = Vec3::from(resolution.map(|n| n as f32)) / 2.0;
        let options = GridOptions { resolution: Some(resolution), ..GridOptions::default() };
        let frame = Frame::new(&Aabb { min: -max, max }, 1, &options);
        let table = table::<M, M::Slot>(&o, &SkipOptions { threshold: 1, ..SkipOptions::default() });
        let mut farthest = 0;
        for far in 0..40 {
            for _ in 0..100 {
                // A power of two: the ray goes through the origin exactly.
                let direction = random.in_cube();
                let ray = Ray::new(-(far as f32).exp2() * direction, direction);
                if visited(&table, &frame, &ray).1 > 0 {
                    farthest = far;
                }
            }
        }
        assert!(farthest > 32, "{}: 2^{farthest}", M::NAME);
    }
}

/// Far origins round by more than a leap's slack: a leap to the exit must cross a plane all the same.
#[test]
fn leaps_from_far_origins_end() {
    leaps_end::<ProximityClouds>();
    leaps_end::<DirectedSafeZones>();
    leaps_end::<DirectedSafeZones24>();
    leaps_end::<DualExtents>();
    leaps_end::<Chessboard>();
    leaps_end::<Octants>();
}

/// Share of the rays whose first filled voxel is wrong by the printed rule.
fn printed_faults<M: PrintedRule>(threshold: u8) -> f64 {
    let mut random = Random::new(6);
    let (mut wrong, mut all) = (0, 0);
    for o in scenes() {
        let table = table::<M, M::Slot>(&o, &SkipOptions { threshold, ..SkipOptions::default() });
        let (frame, plain, printed) = (frame(&o), NoSkip(cells(&o)), printed::Printed(&table));
        for ray in rays(&mut random, &o, 3000) {
            let first = |(filled, _): (Vec<usize>, usize)| filled.first().copied();
            wrong += u32::from(first(visited(&printed, &frame, &ray)) != first(visited(&plain, &frame, &ray)));
            all += 1;
        }
    }
    f64::from(wrong) / f64::from(all)
}

#[test]
fn the_printed_landing_loses_voxels() {
    for (name, always, from_five) in [
        (ProximityClouds::NAME, printed_faults::<ProximityClouds>(1), printed_faults::<ProximityClouds>(5)),
        (DirectedSafeZones::NAME, printed_faults::<DirectedSafeZones>(1), printed_faults::<DirectedSafeZones>(5)),
        (DualExtents::NAME, printed_faults::<DualExtents>(1), printed_faults::<DualExtents>(5)),
    ] {
        // 0.18 %, 0.46 % and 0.51 % of these rays; from D = 5 on 0.02 % each.
        assert!(from_five > 0.0 && from_five < always && always < 0.2, "{name}: {always} {from_five}");
    }
}

#[test]
fn a_grid_without_an_empty_voxel_has_no_distances() {
    let o = occupancy(&mut Random::new(7), [5, 4, 3], 1.0);
    let full = table::<DirectedSafeZones, Eight>(&o, &SkipOptions::default());
    assert_eq!(full.describe(), "directed safe zones left out: no voxel is empty");
    assert_eq!((full.empty(), full.references()), (0, 60));
    // 8 bytes a voxel, of which 4 are a plain grid's; a length and a reference for each list.
    assert_eq!(full.memory(), Memory { structure: 60 * 8, references: 60 * 4, tables: 60 * 4 });
}
