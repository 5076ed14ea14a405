//! Solid voxels: every accelerator against brute force, and the same faces as a mesh, to the bit.

mod scene;
mod sequence;
#[cfg(feature = "vox")]
mod vox;

use crate::conformance::{bits, check, rays};
use crate::random::Random;
use glam::Vec3;
use skipgrid::geometry::{Geometry, IndexedTriangles, SolidVoxels};
use skipgrid::grid::{Grid, GridOptions};
use skipgrid::scene::SceneGeometry;
use skipgrid::{Ray, Triangle};

/// Voxels from a rule.
pub fn voxels(resolution: [u32; 3], origin: Vec3, edge: f32, mut solid: impl FnMut([u32; 3]) -> bool) -> SolidVoxels {
    let [nx, ny, nz] = resolution;
    let mut materials = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            materials.extend((0..nx).map(|x| u8::from(solid([x, y, z]))));
        }
    }
    SolidVoxels::new(resolution, materials, origin, edge).expect("voxels that can be told apart")
}

/// Rays within planes, along edges and through corners: from points at whole and half voxels in few directions, forwards and
/// backwards, from inside and outside, ending and starting on planes.
fn lattice_rays(random: &mut Random, voxels: &SolidVoxels, count: usize) -> Vec<Ray> {
    let mut rays = Vec::new();
    let resolution = voxels.resolution();
    // Planes themselves, or the middle between two.
    let point = |random: &mut Random| {
        Vec3::from([0, 1, 2].map(|axis| {
            let planes = voxels.planes(axis);
            let at = random.below(resolution[axis] as usize + 1);
            match planes.get(at + 1) {
                Some(next) if random.below(2) == 0 => (planes[at] + next) / 2.0,
                _ => planes[at],
            }
        }))
    };
    for _ in 0..count {
        let origin = point(random);
        let signs = Vec3::from([0, 1, 2].map(|_| [0.0, -0.0, 1.0, -1.0, 2.0, -1.0][random.below(6)]));
        let direction = voxels.edge() * signs;
        let to = point(random) - origin;
        let back = [0.0, 1.0, 7.0][random.below(3)];
        rays.push(Ray::new(origin - back * direction, direction));
        rays.push(Ray::new(origin, direction).with_range(f32::NEG_INFINITY, f32::INFINITY));
        rays.push(Ray::new(origin, direction).with_range(random.below(3) as f32, random.below(5) as f32));
        rays.push(Ray::new(origin, to));
        rays.push(Ray::new(origin, to).with_range(0.0, 1.0));
        rays.push(Ray::new(origin - to, to).with_range(1.0, f32::INFINITY));
        // Next to a plane that is crossed far away.
        let mut flat = voxels.edge() * random.in_cube();
        flat[random.below(3)] *= [1e-3, 1e-6, 1e-12, 1e-30][random.below(4)];
        rays.push(Ray::new(origin, flat));
        rays.push(Ray::new(origin - 3.0 * flat, flat));
        // Next to an edge or corner, by few units in the last place.
        let mut beside = to;
        for axis in 0..3 {
            let ulps = random.below(3) as i32 - 1;
            beside[axis] = f32::from_bits(beside[axis].to_bits().wrapping_add_signed(ulps));
        }
        rays.push(Ray::new(origin, beside));
    }
    rays
}

fn check_voxels(name: &str, seed: u64, voxels: &SolidVoxels) {
    let mut random = Random::new(seed);
    let bounds = voxels.solid_bounds();
    let corners: Vec<Vec3> = match voxels.triangles().flatten().collect::<Vec<_>>() {
        empty if empty.is_empty() => vec![voxels.origin()],
        corners => corners,
    };
    let centre = if bounds.is_empty() { voxels.origin() } else { bounds.min * 0.5 + bounds.max * 0.5 };
    let size = bounds.extent().max_element().max(voxels.edge());
    // A quarter of these: there are many scenes, and every accelerator traces every ray four times.
    let mut shots: Vec<Ray> = rays(&mut random, centre, size, &corners).into_iter().step_by(4).collect();
    shots.extend(lattice_rays(&mut random, voxels, 50));
    let scene = SceneGeometry::Voxels(voxels.clone());
    check(name, &scene, &shots);

    // The same faces as triangles, with and without shared corners.
    let triangles: Vec<Triangle> = voxels.triangles().collect();
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect::<Vec<_>>();
    let indexed = IndexedTriangles::new(triangles.concat(), indices).expect("indices in range");
    let [ours, plain, indexed] = [
        scene.accel("voxels").expect("solid voxels"),
        crate::conformance::triangles(&triangles).accel("grid").expect("small"),
        Box::new(Grid::build(&indexed, &GridOptions::default()).expect("small")),
    ];
    let mut hits = 0;
    for ray in &shots {
        let hit = bits(ours.closest_hit(ray));
        assert_eq!(hit, bits(plain.closest_hit(ray)), "{name}: {ray:?}");
        assert_eq!(hit, bits(indexed.closest_hit(ray)), "{name}: {ray:?}");
        hits += usize::from(hit.is_some());
    }
    assert!(hits > shots.len() / 10 || triangles.is_empty(), "{name}: {hits} of {} rays hit", shots.len());
}

#[test]
fn random_voxels_agree() {
    let mut random = Random::new(31);
    for (i, (share, resolution)) in
        [(2, [12, 9, 7]), (8, [11, 12, 13]), (90, [24, 17, 20]), (900, [33, 40, 21])].into_iter().enumerate()
    {
        let voxels = voxels(resolution, Vec3::new(-3.0, 0.0, 2.0), 1.0, |_| random.below(share) == 0);
        check_voxels(&format!("one in {share}"), 32 + i as u64, &voxels);
    }
    let dense = voxels([9, 10, 11], Vec3::ZERO, 0.5, |_| random.below(8) != 0);
    check_voxels("seven in eight", 36, &dense);
}

#[test]
fn regular_voxels_agree() {
    let unit = |resolution, rule: fn([u32; 3]) -> bool| voxels(resolution, Vec3::ZERO, 1.0, rule);
    check_voxels("full", 41, &unit([6, 5, 7], |_| true));
    check_voxels("empty", 42, &unit([6, 5, 7], |_| false));
    check_voxels("checkerboard", 43, &unit([6, 6, 6], |[x, y, z]| (x + y + z) % 2 == 0));
    check_voxels("one voxel", 44, &unit([1, 1, 1], |_| true));
    check_voxels("one voxel in the middle", 45, &unit([15, 15, 15], |v| v == [7, 7, 7]));
    check_voxels("a stick", 46, &unit([1, 40, 1], |_| true));
    check_voxels("a broken stick", 47, &unit([1, 1, 60], |[_, _, z]| z % 9 != 4));
    check_voxels(
        "a hollow box",
        48,
        &unit([12, 10, 11], |[x, y, z]| x == 0 || y == 0 || z == 0 || x == 11 || y == 9 || z == 10),
    );
    check_voxels(
        "a ball with inner voxels",
        49,
        &unit([21, 21, 21], |v| v.iter().map(|&c| (i64::from(c) - 10).pow(2)).sum::<i64>() < 81),
    );
}

#[test]
fn voxels_of_any_scale_and_place_agree() {
    let mut random = Random::new(51);
    let tiny = f32::from_bits(1);
    for (i, (origin, edge)) in [
        (Vec3::ZERO, 0.1),
        (Vec3::new(0.3, -0.7, 1e-3), 1.0 / 3.0),
        (Vec3::splat(1e6), 1.0),
        // Steps of single precision are a sixteenth there: planes lie unevenly.
        (Vec3::splat(1e6), 0.3),
        (Vec3::new(-1e6, 0.0, 3.0), 0.77),
        (Vec3::splat(-5e-37), 1e-37),
        (Vec3::ZERO, tiny),
        (Vec3::new(3.0, 0.0, 0.0) * tiny, 3.0 * tiny),
        (Vec3::splat(-1e37), 1e36),
    ]
    .into_iter()
    .enumerate()
    {
        let voxels = voxels([9, 8, 7], origin, edge, |_| random.below(3) == 0);
        check_voxels(&format!("edge {edge:e} from {origin} on"), 52 + i as u64, &voxels);
    }
}

#[test]
fn wrong_specifications_say_what_is_wrong() {
    let one = voxels([2, 2, 2], Vec3::ZERO, 1.0, |_| true);
    let scene = SceneGeometry::Voxels(one.clone());
    for (spec, part) in [
        ("voxels:density=2", "unknown option `density`"),
        ("voxels:skip=far", "none|clouds|dsz"),
        ("voxels:skip=dsz,step=branchless", "step=branching"),
        ("voxels:threshold=3", "unknown option `threshold`"),
        ("voxels:skip=dsz,lane=3", "unknown option `lane`"),
        ("voxels:skip=octant,memory=100", "skip table of chessboard distances by octant over 64 voxels"),
        ("voxels:memory=15", "bits of 4 x 4 x 4 voxels: wants 16 bytes"),
    ] {
        let Err(error) = scene.accel(spec) else { panic!("{spec} was accepted") };
        assert!(error.to_string().contains(part), "{spec}: {error}");
    }
    assert!(scene.accel("voxels:skip=dual,lane=3,memory=1K").is_ok());
    let triangles: Vec<Triangle> = one.triangles().collect();
    let Err(error) = crate::conformance::triangles(&triangles).accel("voxels") else { panic!("accepted") };
    assert!(error.to_string().contains("accelerator `voxels`: needs a scene of solid voxels"), "{error}");
    // Through every wrapper the voxels are still seen.
    let boxed: Box<SolidVoxels> = Box::new(one);
    assert!(std::sync::Arc::new(&boxed).solid().is_some());
}
