//! The walk against the cells that a ray of f64 goes through.

use super::super::exact::{Exact, Known};
use super::super::frame::{Frame, PADDING, Start};
use super::super::pack::List;
use super::super::shape::{AnyPart, Part, Shape, Slot, Top};
use super::{Outcome, trace};
use crate::geometry::tests::Random;
use crate::grid::skip::free_cubes;
use crate::nested::lanes::Portable;
use crate::ray::{Aabb, Ray};
use glam::{DVec3, Vec3};
use std::collections::HashSet;

/// Notes what is tested, and finds nothing.
#[derive(Default)]
struct Visited(HashSet<u32>);

impl Exact for Visited {
    fn test(&mut self, prim: u32) -> Option<Known> {
        self.0.insert(prim);
        None
    }
    fn settle(&mut self, prim: u32) -> Option<Known> {
        self.test(prim)
    }
    fn replace(&mut self, prim: u32, _: f64, _: f64) -> Option<Known> {
        self.test(prim)
    }
    fn rename(&mut self, _: u32) {}
    fn known(&self) -> Option<Known> {
        None
    }
}

/// A grid of `cells` in which each cell that is occupied holds one primitive, its own number.
fn grid(cells: [u32; 3], occupied: &[bool]) -> Part<List> {
    let mut part = Part::new(Frame::new(&Aabb { min: Vec3::new(-1.0, -0.7, -0.9), max: Vec3::new(1.3, 0.6, 1.1) }));
    let mut top = Top::default();
    top.cut(part.frame.half, cells);
    free_cubes(cells.map(|n| n as usize), occupied.iter().copied(), &mut top.free);
    top.slots =
        occupied.iter().enumerate().map(|(i, &o)| if o { pack(&mut part, i as u32) } else { Slot::EMPTY }).collect();
    part.top = top;
    part
}

fn pack(part: &mut Part<List>, prim: u32) -> Slot {
    part.packs.push(List::new([prim]));
    Slot { first: part.packs.len() as u32 - 1, count: 1 }
}

/// The cells that reach to `point` when they are padded, in the part's coordinates.
fn around(part: &Part<List>, point: DVec3) -> HashSet<u32> {
    let top = &part.top;
    let (half, cell) = (top.half.as_dvec3(), top.cell.as_dvec3());
    let reach = |a: usize, sign: f64| {
        let place = (point[a] + half[a] + sign * f64::from(PADDING)) / cell[a];
        (place.floor().max(0.0) as u32).min(top.cells[a] - 1)
    };
    let [x, y, z] = [0, 1, 2].map(|a| reach(a, -1.0)..=reach(a, 1.0));
    let row = |y: u32, z: u32| x.clone().map(move |x| (z * top.cells[1] + y) * top.cells[0] + x);
    z.flat_map(|z| y.clone().flat_map(move |y| row(y, z)).collect::<Vec<_>>()).collect()
}

#[test]
fn every_cell_around_a_point_of_a_ray_is_visited_or_those_beside_it() {
    let mut random = Random::new(41);
    let (mut points, mut beside) = (0_u32, 0_u32);
    for round in 0..40_usize {
        let cells = [[16, 9, 13], [1, 40, 3], [5, 5, 5], [64, 2, 31]][round % 4];
        let share = [0.02, 0.3, 1.0][round % 3];
        let count: u32 = cells.iter().product();
        let occupied: Vec<bool> = (0..count).map(|_| random.unit() < share).collect();
        let part = grid(cells, &occupied);
        let (frame, cell) = (part.frame, part.top.cell.as_dvec3());
        let shape = Shape { parts: vec![AnyPart::Lists(part.clone())] };
        for i in 0..500_usize {
            // Aimed at a corner, an edge or a face of a cell, or at none.
            let corner = DVec3::from([0, 1, 2].map(|a| f64::from(random.next() as u32 % (cells[a] + 1))));
            let mut target = corner * cell - part.top.half.as_dvec3();
            for a in (0..3).filter(|a| i >> a & 1 != 0) {
                target[a] = f64::from(random.in_cube()[a]) * f64::from(frame.half[a]);
            }
            let mut direction = random.in_cube();
            if i % 5 == 0 {
                direction[i % 3] *= [0.0, 1e-7, 1e-12][i % 4 % 3];
            }
            let distance = [0.0, 0.3, 2.0, 5.0, 30.0, 1e4][i % 6];
            let origin = frame.world(target).as_vec3() - direction * distance;
            let Some(ray) = Ray::new(origin, direction).intake() else { continue };
            let mut visited = Visited::default();
            assert_eq!(trace::<Portable, _, true>(&shape, &ray, false, &mut visited, &mut ()), Outcome::Done);
            if matches!(frame.enter(&ray, None), Start::Miss) {
                continue;
            }
            let length = 8.0 / f64::from(direction.length());
            let nearest = f64::from(distance);
            for step in 0..400 {
                // Points near the target are as close to one another as f64 can tell.
                let t = nearest + length * (f64::from(random.unit()) - 0.5) * 10.0_f64.powi(-(step % 12));
                let point = frame.local(ray.at(t));
                // What lies nearer to the faces of the box is no primitive's.
                if t < 0.0 || (point.abs() - frame.half.as_dvec3()).max_element() > -1.0 / 2048.0 {
                    continue;
                }
                let near = around(&part, point);
                if near.iter().all(|&cell| occupied[cell as usize]) {
                    points += 1;
                    beside += u32::from(near.len() > 1);
                    assert!(near.iter().any(|cell| visited.0.contains(cell)), "{point} of {ray:?}, {cells:?}");
                }
            }
        }
    }
    assert!(points > 200_000 && beside > 20_000, "{points} points, {beside} of them near a plane");
}
