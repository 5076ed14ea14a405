//! The voxels of a ray, cell by cell and by hand.

use super::*;
use glam::Vec3;

/// SplitMix64 (Steele, Lea & Flood 2014).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Where a ray of whole numbers enters and leaves the closed cube at `low` with an edge of 4: clipping, in fractions with
/// the denominators of `range`, above zero.
fn clip(o: [i128; 3], d: [i128; 3], low: [i128; 3], range: [i128; 2]) -> Option<[(i128, i128); 2]> {
    let (mut start, mut end) = ((range[0], 1), (range[1], 1));
    for a in 0..3 {
        let (near, far) = (low[a] - o[a], low[a] + 4 - o[a]);
        if d[a] == 0 {
            if near > 0 || far < 0 {
                return None;
            }
            continue;
        }
        let (near, far) = if d[a] > 0 { ((near, d[a]), (far, d[a])) } else { ((-far, -d[a]), (-near, -d[a])) };
        if near.0 * start.1 > start.0 * near.1 {
            start = near;
        }
        if far.0 * end.1 < end.0 * far.1 {
            end = far;
        }
    }
    (start.0 * end.1 <= end.0 * start.1).then_some([start, end])
}

#[test]
fn each_voxel_has_the_part_that_clipping_gives_it() {
    let mut state = 1;
    let (mut parts, mut touches, mut shared) = (0, 0, 0);
    for i in 0..9000 {
        // Voxels with an edge of 4 around the origin of coordinates, and rays on a lattice of quarters.
        let resolution = [(); 3].map(|()| 1 + next(&mut state) % 4).map(|n| n as u32);
        let low = [(); 3].map(|()| -8 + 4 * (next(&mut state) % 3) as i128);
        let o = [(); 3].map(|()| (next(&mut state) % 25) as i128 - 12);
        let mut d = [(); 3].map(|()| (next(&mut state) % 9) as i128 - 4);
        if i % 2 == 0 {
            d[(next(&mut state) % 3) as usize] = 0;
        }
        if d == [0; 3] {
            d[1] = 1;
        }
        let range = if i % 3 == 0 { [-1, 2] } else { [-100, 100] };
        let vector = |v: [i128; 3]| Vec3::from(v.map(|x| x as f32));
        let high = [0, 1, 2].map(|a| low[a] + 4 * i128::from(resolution[a]));
        let ray = Ray::new(vector(o), vector(d)).with_range(range[0] as f32, range[1] as f32);
        let bounds = Aabb { min: vector(low), max: vector(high) };
        let grid = if i % 2 == 0 {
            Voxels::of_box(&bounds, resolution)
        } else {
            Voxels::of_map(bounds.min.as_dvec3(), DVec3::splat(0.25), resolution)
        };
        let path = grid.path(&ray);
        let place = format!("{i}: {ray:?} in {resolution:?} from {low:?}: {path:?}");
        let mut expected = Vec::new();
        let mut touched = 0;
        for x in 0..resolution[0] {
            for y in 0..resolution[1] {
                for z in 0..resolution[2] {
                    let voxel = [x, y, z];
                    let part = clip(o, d, [0, 1, 2].map(|a| low[a] + 4 * i128::from(voxel[a])), range);
                    assert_eq!(path.as_ref().is_some_and(|p| p.touches(voxel)), part.is_some(), "{voxel:?} {place}");
                    let Some([(n0, d0), (n1, d1)]) = part else { continue };
                    touched += 1;
                    if n0 * d1 < n1 * d0 {
                        expected.push((voxel, n0 as f64 / d0 as f64, n1 as f64 / d1 as f64));
                    }
                }
            }
        }
        assert_eq!(path.is_some(), touched > 0, "{place}");
        let Some(path) = path else { continue };
        // What is visited, and what lies below the planes that the ray runs in.
        let mut found = Vec::new();
        for visit in path.visits() {
            assert!(path.touches(visit.voxel), "{place}");
            if visit.is_touch() {
                touches += 1;
                continue;
            }
            for below in 0..8u32 {
                let of = |a: usize| below >> a & 1;
                if (0..3).all(|a| of(a) == 0 || path.shared()[a]) {
                    shared += u32::from(below > 0);
                    let voxel = [0, 1, 2].map(|a| visit.voxel[a] - of(a));
                    let ends = [End::Entry, End::Exit].map(|end| path.parameter(visit, end));
                    found.push((voxel, ends[0], ends[1]));
                    // A voxel holds its own part, and the one beside it does not unless it is inflated by one.
                    let v = voxel.map(i64::from);
                    assert!(path.lies_in(visit, v, v, 0.0), "{place}");
                    let beside = [v[0] + 2, v[1], v[2]];
                    assert!(!path.lies_in(visit, beside, beside, 0.5), "{place}");
                    assert!(path.lies_in(visit, beside, beside, 2.0), "{place}");
                }
            }
        }
        found.sort_by_key(|f| f.0);
        // Small whole numbers: the hardware's quotients are correctly rounded.
        assert_eq!(found, expected, "{place}");
        parts += expected.len();
    }
    assert!(parts > 3000 && touches > 500 && shared > 300, "{parts} parts, {touches} touches, {shared} shared");
}

#[test]
fn lengths_and_distances_are_those_of_the_hand() {
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(4.0, 2.0, 8.0) };
    let grid = Voxels::of_box(&bounds, [4; 3]);
    let ray = Ray::new(Vec3::new(-1.0, 0.5, 1.0), Vec3::new(2.0, 0.5, 0.0)).with_range(0.0, 2.0);
    let path = grid.path(&ray).expect("it meets the box");
    // In voxels it moves by 2, 1 and 0 along the axes for each unit of t, and is in the box from 0.5 to 2.
    assert_eq!(path.length(), 3.0);
    let voxels: Vec<_> = path.visits().iter().map(|v| (v.voxel, path.chord(v), v.axis)).collect();
    // Ties at t = 1 and at the last point: y before x.
    let expected = [
        ([0, 1, 0], 1.0, Some(0)),
        ([0, 2, 0], 0.0, Some(1)),
        ([1, 2, 0], 1.0, Some(0)),
        ([2, 2, 0], 1.0, Some(0)),
        ([2, 3, 0], 0.0, Some(1)),
        ([3, 3, 0], 0.0, Some(0)),
    ];
    assert_eq!(voxels, expected);
    assert_eq!(path.distance(0, 1, 1.0), 0.0);
    assert_eq!(path.distance(0, 1, 1.25), 0.5);
    assert_eq!(path.distance(1, 2, 0.5), 0.5);
    assert_eq!(path.relative_error(&path.visits()[0], End::Entry, 0.5), 0.0);
    assert_eq!(path.relative_error(&path.visits()[0], End::Entry, 0.75), 0.5);
    // Parameter 0 is where nothing is relative.
    let from = grid.path(&Ray::new(Vec3::ONE, Vec3::X)).expect("it starts inside");
    assert_eq!(from.relative_error(&from.visits()[0], End::Entry, 0.0), 0.0);
    assert_eq!(from.relative_error(&from.visits()[0], End::Entry, 1e-300), f64::INFINITY);
    assert!(grid.path(&Ray::new(Vec3::NAN, Vec3::X)).is_none());
    assert!(grid.path(&Ray::new(Vec3::ONE, Vec3::ZERO)).is_none());
}
