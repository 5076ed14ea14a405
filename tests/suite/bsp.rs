//! Binary space partitions: what the note of 1988 claims of them, and what its listings get wrong.

mod papers;
mod printed;
mod regular;

use crate::conformance::triangles as set;
use skipgrid::{Accel, Ray, Triangle};

/// The specifications of all walks over the same tree.
const WALKS: [&str; 5] = ["listing=segment", "listing=interval", "listing=midpoint", "walk=retraverse", "walk=climb"];

/// Every walk and every choice of planes answers as brute force does, to the bit; gives that answer's primitive.
fn answer(triangles: &[Triangle], ray: &Ray) -> Option<u32> {
    let triangles = set(triangles);
    let bits = |accel: &dyn Accel| accel.closest_hit(ray).map(|hit| (hit.prim, hit.t.to_bits()));
    let truth = bits(&triangles.accel("brute").expect("always there"));
    let more = ["planes=sah", "planes=oblique", "planes=sah,listing=segment", "planes=oblique,listing=segment"];
    for options in WALKS.iter().chain(&more) {
        let spec = format!("bsp:{options},leaf=1");
        let accel = triangles.accel(&spec).expect("a tree");
        assert_eq!(bits(&accel), truth, "{spec}: {ray:?}");
        assert_eq!(accel.any_hit(ray), truth.is_some(), "{spec}: {ray:?}");
    }
    truth.map(|(prim, _)| prim)
}

#[test]
fn trees_are_refused_beyond_their_budget_and_piles_are_left_in_one_list() {
    let mut random = crate::random::Random::new(31);
    let soup: Vec<Triangle> = (0..2000)
        .map(|_| {
            let p = random.in_cube();
            [p, p + 0.05 * random.in_cube(), p + 0.05 * random.in_cube()]
        })
        .collect();
    for planes in ["midpoint", "sah", "oblique"] {
        let build = |memory: &str| set(&soup).accel(&format!("bsp:planes={planes},memory={memory}"));
        let tree = build("64M").expect("there is room");
        assert!(tree.memory().total() < 64 << 20);
        // Room for the primitives, not for the nodes.
        let Err(error) = build("300K") else { panic!("{planes} was accepted") };
        assert!(error.to_string().contains("bsp tree of 2000 primitives"), "{error}");
        assert!(matches!(error, skipgrid::Error::TooLarge { allowed: 307_200, .. }), "{error}");
        // A thousand times the same triangle cannot be parted: no more than a few splits are tried.
        let pile = vec![soup[0]; 1000];
        let pile = set(&pile);
        let tree = pile.accel(&format!("bsp:planes={planes},leaf=1")).expect("there is room");
        let (bytes, line) = (tree.memory().total(), tree.describe());
        assert!(bytes < 1000 * 4 * 64, "{planes}: {bytes} bytes: {line}");
        let ray = Ray::new(random.in_cube(), soup[0][0] - soup[0][2]);
        assert_eq!(tree.any_hit(&ray), pile.accel("brute").expect("there").any_hit(&ray));
    }
}

#[test]
fn trees_say_what_was_built() {
    use glam::Vec3;
    let at = |x: f32| [Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.01, 0.0), Vec3::new(x, 0.0, 0.01)];
    let triangles = vec![at(0.0), at(1.0), [Vec3::NAN; 3]];
    let tree = set(&triangles).accel("bsp:leaf=1").expect("a tree");
    // The first plane, in the middle of x, parts the two: three nodes of 16 bytes, two references.
    assert_eq!(
        tree.describe(),
        "3 nodes, 2 leaves, 0.0 % of the children NIL, depth 1, 1.00 references a leaf, \
         1 primitives that no ray can hit left out"
    );
    assert_eq!((tree.memory().structure, tree.memory().references), (48, 8));
    let whole = set(&triangles).accel("bsp:depth=0").expect("a tree");
    assert!(whole.describe().starts_with("1 nodes, 1 leaves"), "{}", whole.describe());
    assert_eq!(set(&[]).accel("bsp").expect("a tree").memory().total(), 0);
}

#[test]
fn oblique_planes_are_chosen_where_they_part_what_axes_cannot() {
    use glam::Vec3;
    // Two sheets along the diagonal x = y, a hair apart: no plane across an axis has either on one side alone.
    let mut sheets = Vec::new();
    for i in 0..16 {
        for offset in [0.0, 0.01_f32] {
            let corner = |u: i32, z: f32| Vec3::new(u as f32 + offset, u as f32 - offset, z);
            sheets.push([corner(i, 0.0), corner(i + 1, 0.0), corner(i, 8.0)]);
            sheets.push([corner(i + 1, 0.0), corner(i + 1, 8.0), corner(i, 8.0)]);
        }
    }
    let tree = set(&sheets).accel("bsp:planes=oblique,leaf=1").expect("a tree");
    let line = tree.describe();
    assert!(line.contains("planes across no axis"), "{line}");
    let mut random = crate::random::Random::new(5);
    let mut hits = 0;
    for _ in 0..500 {
        let origin = Vec3::new(8.0, 8.0, 4.0) + 12.0 * random.in_cube();
        let target = Vec3::splat(8.0) + 8.0 * Vec3::new(1.0, 1.0, 0.0) * random.signed();
        hits += u32::from(answer(&sheets, &Ray::new(origin, target - origin)).is_some());
    }
    assert!(hits > 100, "{hits}");
}
