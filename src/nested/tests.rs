//! The nested grid against brute force, and its parts against what they promise.

use super::crowd::{Crowd, Known};
use super::frame::{Frame, Start};
use super::lanes::{Lanes, Portable, Row};
use super::pack::{Pack, PackRay, Seen, Verdict};
use super::sight::{Entry, Sight};
use super::simd::Work;
use super::spheres::SpherePack;
use super::triangles::TrianglePack;
use super::*;
use crate::accel::BruteForce;
use crate::geometry::tests::Random;
use crate::geometry::{Best, Mixed, NO_PRIM, Sphere, Triangle};
use glam::Vec3;

fn bits(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|h| (h.prim, h.t.to_bits()))
}

/// Rays at `targets` from near and far, along axes and with every length of direction.
fn rays(random: &mut Random, count: usize, targets: &[Vec3]) -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in 0..count {
        let target = targets[random.next() as usize % targets.len()] + random.in_cube() * [0.0, 1e-3][i % 2];
        let distance = [0.1, 2.0, 5.0, 1e3, 1e6, 1e9, 1e15][random.next() as usize % 7];
        let mut direction = random.in_cube();
        if i % 5 == 0 {
            direction[i % 3] = 0.0;
        }
        if i % 7 == 0 {
            direction[(i + 1) % 3] = 0.0;
        }
        direction *= [1.0, 1e-30, 1e18][random.next() as usize % 3];
        let origin = target - direction * (distance / direction.length().max(1e-38));
        let ray = Ray::new(origin, direction);
        rays.push(match i % 6 {
            0 => ray.with_range(f32::NEG_INFINITY, f32::INFINITY),
            1 => ray.with_range(-1.0, 0.5),
            _ => ray,
        });
    }
    rays
}

fn check<G: Geometry + Clone>(name: &str, geometry: &G, rays: &[Ray]) {
    let brute = BruteForce::new(geometry);
    let built = [
        (Quality::Fast, Below::Boxes),
        (Quality::Default, Below::Boxes),
        (Quality::Default, Below::Nodes),
        (Quality::Best, Below::Nodes),
    ];
    for (quality, below) in built {
        let options = NestedOptions { quality, below, ..NestedOptions::default() };
        let mut nested = Nested::build(geometry, &options).unwrap();
        assert!(!nested.describe().is_empty());
        for isa in [Isa::detect(), Isa::Portable] {
            nested.isa = isa;
            for ray in rays {
                let expected = bits(brute.closest_hit(ray));
                assert_eq!(bits(nested.closest_hit(ray)), expected, "{name}: {ray:?}");
                assert_eq!(nested.any_hit(ray), expected.is_some(), "{name}: any hit of {ray:?}");
            }
        }
    }
}

#[test]
fn answers_as_brute_force_does() {
    let mut random = Random::new(3);
    for (count, size) in [(1, 1.0), (7, 0.5), (300, 0.3), (3000, 0.05), (2000, 0.6)] {
        let triangles = random.soup(count, size);
        let targets: Vec<Vec3> = triangles.iter().flatten().copied().collect();
        let shots = rays(&mut random, 2000, &targets);
        check(&format!("{count} triangles of {size}"), &triangles, &shots);
        let flat: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p * Vec3::new(1.0, 0.0, 1.0))).collect();
        check(&format!("{count} flat triangles"), &flat, &shots);
        let spheres: Vec<Sphere> =
            targets.iter().take(count).map(|&centre| Sphere { centre, radius: random.unit() * size * 0.3 }).collect();
        check(&format!("{count} spheres"), &spheres, &shots);
        check(&format!("{count} of each"), &Mixed { triangles, spheres }, &shots);
    }
}

#[test]
fn large_and_small_at_once() {
    let mut random = Random::new(5);
    let mut triangles = random.soup(2000, 0.02);
    triangles.extend(random.soup(20, 1.0).iter().map(|t| t.map(|p| p * 1e6)));
    triangles.extend(random.soup(500, 0.02).iter().map(|t| t.map(|p| p * 10.0 + 1e4)));
    let targets: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let shots = rays(&mut random, 3000, &targets);
    check("large and small", &triangles, &shots);
}

/// A ray and primitives in a part's coordinates, with a part that has them.
fn entry(random: &mut Random, frame: &Frame) -> Option<(Ray, Entry)> {
    let mut direction = random.in_cube();
    if random.next().is_multiple_of(4) {
        direction[random.next() as usize % 3] *= 1e-9;
    }
    let distance = [0.0, 3.0, 1e4][random.next() as usize % 3];
    let ray = Ray::new(random.in_cube() * 0.9 - direction * distance, direction).intake()?;
    match frame.enter(&ray, None) {
        Start::Inside(entry) => Some((ray, entry)),
        _ => None,
    }
}

/// [`Pack::missed`] as work.
struct Missed<'a, K>(&'a K, &'a Sight);

impl<K: Pack> Work for Missed<'_, K> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Lanes>(self) -> u32 {
        self.0.missed(self.1, self.1.end[1])
    }
}

/// What packs say, in portable code, by the processor's instructions and in f64, against the exact tests one by one.
fn check_packs<K: Pack, G: Geometry>(random: &mut Random, geometry: &G, frame: &Frame, packs: &[K]) -> [usize; 5] {
    let mut seen = [0; 5];
    for _ in 0..1500 {
        let Some((ray, entry)) = entry(random, frame) else { continue };
        let sight = &entry.sight;
        for pack in packs {
            let portable = PackRay::<Portable>::new::<K>(sight);
            let Seen { survivors, certain, p, bound } = pack.look(&portable, Portable::splat(sight.end[1]));
            let mut answers = vec![(survivors, Portable::bits(certain) & survivors, p.row(), bound.row())];
            #[cfg(target_arch = "x86_64")]
            if let Isa::Avx2(present) = Isa::detect() {
                answers.push(simd::avx2::look(present, pack, sight));
            }
            let missed = Isa::Portable.run(Missed(pack, sight));
            assert_eq!(Isa::detect().run(Missed(pack, sight)), missed, "{ray:?}: f64 rounds alike everywhere");
            for (lane, &prim) in pack.prims().iter().enumerate().filter(|(_, prim)| **prim != NO_PRIM) {
                let mut best = Best::NONE;
                geometry.test(prim, &ray, &geometry.prepare(&ray), &mut best);
                let about = || format!("{ray:?}: {prim} at {} +- {}", best.t(), best.err());
                let ([lower, _], [_, upper]) =
                    (entry.around(best.t() - best.err()), entry.around(best.t() + best.err()));
                for (survivors, certain, Row(p), Row(bound)) in &answers {
                    let bit = |mask: &u32| mask >> lane & 1 != 0;
                    let (from, to) = (p[lane] - bound[lane], p[lane] + bound[lane]);
                    assert!(bit(survivors) || !best.is_hit(), "{} was rejected", about());
                    if bit(certain) && from > sight.begin[1] && to < sight.end[0] {
                        assert!(best.is_hit(), "{} is missed but was certain", about());
                        assert!(from <= upper && lower <= to, "{}, not in {from} to {to}", about());
                        seen[2] += 1;
                    }
                    seen[1] += usize::from(!bit(survivors));
                }
                seen[0] += usize::from(best.is_hit());
                assert!(missed >> lane & 1 == 0 || !best.is_hit(), "{} was thrown out with others", about());
                match pack.judge(lane, sight, sight.end[1]) {
                    Verdict::Miss => {
                        assert!(!best.is_hit(), "{} was rejected in f64", about());
                        seen[3] += 1;
                    }
                    Verdict::Hit { p, bound } => {
                        let (t, err) = entry.parameter(p, bound);
                        assert!(best.is_hit(), "{} is missed but was certain in f64", about());
                        assert!((t - best.t()).abs() <= err + best.err(), "{}, not at {t} +- {err}", about());
                        seen[4] += 1;
                    }
                    Verdict::Open => {}
                }
            }
        }
    }
    seen
}

#[test]
fn packs_reject_and_accept_only_what_is_certain() {
    let mut random = Random::new(11);
    for size in [1.0, 0.05, 1e-4] {
        let triangles = random.soup(64, size);
        let around = |bounds: &dyn Fn(u32) -> Aabb| (0..64).fold(Aabb::EMPTY, |all, i| all.union(&bounds(i)));
        let frame = Frame::new(&around(&|i| triangles.bounds(i)));
        let pack = |at: usize| {
            TrianglePack::new((at..(at + 8).min(61)).map(|i| (i as u32, triangles[i].map(|p| frame.sized(p)))))
        };
        let packs: Vec<_> = (0..8).map(|i| pack(8 * i)).collect();
        let [hits, rejected, certain, missed, met] = check_packs(&mut random, &triangles, &frame, &packs);
        assert!(
            rejected > 100_000 && missed > 10_000 && (size < 1.0 || (hits > 1000 && certain > 1000 && met > 500)),
            "{size}: {hits} {rejected} {certain} {missed} {met}"
        );

        let spheres: Vec<Sphere> =
            triangles.iter().map(|t| Sphere { centre: t[0], radius: random.unit() * size * 0.5 }).collect();
        let frame = Frame::new(&around(&|i| spheres.bounds(i)));
        let pack = |at: usize| {
            let radius = |i: usize| (f64::from(spheres[i].radius) * frame.scale) as f32;
            SpherePack::new((at..(at + 8).min(61)).map(|i| (i as u32, frame.sized(spheres[i].centre), radius(i))))
        };
        let packs: Vec<_> = (0..8).map(|i| pack(8 * i)).collect();
        let [hits, rejected, certain, missed, met] = check_packs(&mut random, &spheres, &frame, &packs);
        assert!(
            rejected > 100_000 && missed > 10_000 && (size < 1.0 || (hits > 1000 && certain > 1000 && met > 500)),
            "{size}: {hits} {rejected} {certain} {missed} {met}"
        );
    }
}

#[test]
fn crowds_throw_out_only_what_is_missed() {
    let mut random = Random::new(14);
    for (size, beside) in [(1.0, 0.0), (1.0, 1e-3), (1.0, 1e-5), (1.0, 1e-7), (1e-3, 1e-5)] {
        let apex = random.in_cube();
        let mut triangles: Vec<Triangle> =
            (0..64).map(|_| [apex, apex + size * random.in_cube(), apex + size * random.in_cube()]).collect();
        triangles.iter_mut().enumerate().for_each(|(i, corners)| corners.rotate_left(i % 3));
        // One in each pack is elsewhere.
        triangles[3..].iter_mut().step_by(8).for_each(|corners| *corners = [(); 3].map(|()| apex + random.in_cube()));
        let frame = Frame::new(&(0..64).fold(Aabb::EMPTY, |all, i| all.union(&triangles.bounds(i))));
        let pack =
            |at: usize| TrianglePack::new((at..at + 8).map(|i| (i as u32, triangles[i].map(|p| frame.sized(p)))));
        let packs: Vec<_> = (0..8).map(|i| pack(8 * i)).collect();
        let (mut asked, mut hits, mut by_wall, mut by_all) = (0, 0, 0, 0);
        for _ in 0..1000 {
            // Often differences are exact, and the ray meets the corner itself.
            let origin = apex + (random.in_cube() * 64.0).round() / [16.0, 1e-3][random.next() as usize % 2];
            let target = apex + random.in_cube() * beside;
            let Some(ray) = Ray::new(origin, target - origin).intake() else { continue };
            let Start::Inside(entry) = frame.enter(&ray, None) else { continue };
            let sight = &entry.sight;
            for isa in [Isa::Portable, Isa::detect()] {
                let mut known = Known::default();
                for pack in &packs {
                    let out =
                        isa.run(Crowd { pack, sight, end: sight.end[1], open: 0xff, winner: None, known: &mut known });
                    let wall = known.wall.map_or(0, |wall| pack.beside::<Portable>(&wall));
                    for (lane, &prim) in pack.prims().iter().enumerate() {
                        let mut best = Best::NONE;
                        triangles.test(prim, &ray, &triangles.prepare(&ray), &mut best);
                        assert!(
                            (out | wall) >> lane & 1 == 0 || !best.is_hit(),
                            "{ray:?}: {:?}",
                            triangles[prim as usize]
                        );
                        hits += u32::from(best.is_hit());
                    }
                    (asked, by_wall, by_all) = (asked + 8, by_wall + wall.count_ones(), by_all + out.count_ones());
                }
            }
        }
        let enough = hits > 1000 && (beside < 1e-6 || by_wall * 3 > asked && by_all * 2 > asked);
        assert!(enough, "{size}, {beside}: {hits} hits, {by_wall} and {by_all} of {asked} thrown out");
    }
}

#[test]
fn of_many_met_in_one_corner_the_first_wins() {
    let mut random = Random::new(15);
    for order in 0..3 {
        let apex = (random.in_cube() * 64.0).round() / 64.0;
        // Corners on a lattice: many triangles are in one plane with a ray.
        let mut triangles: Vec<Triangle> = (0..400)
            .map(|i| {
                let [p, q] = [(); 2].map(|()| (random.in_cube() * 4.0).round() / 4.0);
                let mut corners = [apex, apex + p + Vec3::X, apex + q + Vec3::Y];
                corners.rotate_left(i % 3);
                corners
            })
            .collect();
        let turn = |t: &Triangle| t.iter().map(|p| p.y - apex.y).sum::<f32>();
        match order {
            0 => triangles.sort_by(|a, b| turn(a).total_cmp(&turn(b))),
            1 => triangles.sort_by(|a, b| turn(b).total_cmp(&turn(a))),
            _ => {}
        }
        let rays: Vec<Ray> = (0..400)
            .map(|i| {
                let offset = (random.in_cube() * 8.0).round() / [8.0, 2.0][i % 2];
                let aside = if i % 5 == 0 { random.in_cube() * 1e-6 } else { Vec3::ZERO };
                Ray::new(apex - offset + aside, offset)
            })
            .collect();
        check(&format!("fan in order {order}"), &triangles, &rays);
    }
}

#[test]
fn instruction_sets_see_the_same_cells() {
    #[cfg(target_arch = "x86_64")]
    if let Isa::Avx2(present) = Isa::detect() {
        let mut random = Random::new(12);
        let mut in_all = 0;
        for _ in 0..20_000 {
            let mut axis = || {
                let mut ends: Vec<f32> = (0..5).map(|_| (random.unit() * 16.0).floor()).collect();
                ends.sort_by(f32::total_cmp);
                Row([ends[0], ends[1], ends[2], ends[3], ends[1], ends[2], ends[3], ends[4]])
            };
            let axes = [axis(), axis(), axis()];
            let cells = Portable::crossed(&axes);
            assert_eq!(simd::avx2::crossed(present, &axes), cells, "{axes:?}");
            let meet = |bit: usize| {
                let at = [bit & 3, bit >> 2 & 3, bit >> 4];
                let begin = (0..3).map(|a| axes[a].0[at[a]]).fold(f32::MIN, f32::max);
                let end = (0..3).map(|a| axes[a].0[at[a] + 4]).fold(f32::MAX, f32::min);
                begin <= end
            };
            assert!((0..64).all(|bit| meet(bit) == (cells >> bit & 1 != 0)), "{axes:?}");
            in_all += cells.count_ones();
        }
        assert!(in_all > 20_000, "{in_all}");
        for _ in 0..2000 {
            let mask = random.next();
            for octant in 0..8 {
                let turned = simd::avx2::mirrored(present, mask, octant);
                assert_eq!(turned, Portable::mirrored(mask, octant), "{mask:x}, {octant}");
                let flip = [0, 3, 12, 15, 48, 51, 60, 63][octant];
                assert!((0..64).all(|bit| turned >> bit & 1 == mask >> (bit ^ flip) & 1), "{mask:x}, {octant}");
            }
        }
    }
}

#[test]
fn primitives_are_in_all_cells_that_they_meet() {
    let mut random = Random::new(13);
    let (mut met, mut missed) = (0, 0);
    for i in 0..4000 {
        let size = [0.05, 0.5, 2.0][i % 3];
        let corners = random.soup(1, size)[0].map(|p| (p * [1.0, 0.2][i % 2]).to_array());
        let window = raster::Window::new([-0.25, -0.2, -0.15], [0.125, 0.1, 0.07]);
        let cells = window.triangle::<Portable>(&corners);
        let ball = window.sphere::<Portable>(&corners[0], size * 0.25);
        // Points of the triangle and of the sphere must be in cells that are listed.
        for _ in 0..60 {
            let (mut u, mut v) = (random.unit(), random.unit());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = corners.map(Vec3::from);
            let inside = a + (b - a) * u + (c - a) * v;
            let around = a + random.in_cube().normalize_or(Vec3::X) * (size * 0.25);
            for (cells, p) in [(cells, inside), (ball, around)] {
                let at = [0, 1, 2].map(|i| ((p[i] - window.low[i]) / window.cell[i]).floor() as i32);
                if at.iter().all(|i| (0..4).contains(i)) {
                    assert!(cells >> (at[0] + 4 * at[1] + 16 * at[2]) & 1 != 0, "{corners:?}: {p} in {at:?}");
                    met += 1;
                }
            }
        }
        missed += 64 - cells.count_ones();
    }
    assert!(met > 50_000 && missed > 50_000, "{met} points met, {missed} cells left out");
}
