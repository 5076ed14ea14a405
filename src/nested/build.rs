//! Building a part: the grid on top by sorting references into its cells, then what is below, cell by cell, then the packs.
//!
//! Every step is done in chunks that threads share, of primitives first and of cells then; what comes of them is put together in
//! the order of the grid, so that it does not depend on how many threads there are.

use super::boxes::Boxes;
use super::cut::{Cutter, Fill, Piece};
use super::fill;
use super::frame::Frame;
use super::limit::Limit;
use super::options::Settings;
use super::place::{Place, Placed, Placements};
use super::shape::{Node, Part, Slot, Top};
use super::simd::Isa;
use super::source::Source;
use crate::error::Result;
use crate::grid::{lists, skip::free_cubes};
use crate::parallel;
use crate::ray::Aabb;
use std::ops::Range;

/// Memory of a build that the next one uses again; `L` is a primitive in a part's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Shop<L> {
    placed: Vec<Placed<L>>,
    start: Vec<u32>,
    list: Vec<u32>,
    pieces: Vec<Piece<L>>,
}

impl<L> Default for Shop<L> {
    fn default() -> Self {
        Self { placed: Vec::new(), start: Vec::new(), list: Vec::new(), pieces: Vec::new() }
    }
}

/// What to build a part of.
pub(super) struct Plan<'a, Src> {
    pub source: &'a Src,
    /// By index in the geometry, ascending.
    pub members: &'a [u32],
    /// Boxes by index in the geometry.
    pub boxes: &'a [Aabb],
    pub frame: Frame,
    pub settings: Settings,
    /// Bytes that it may take.
    pub memory: u64,
    pub isa: Isa,
}

impl<Src: Source> Plan<'_, Src> {
    /// Builds the part in the memory of another.
    ///
    /// # Errors
    /// It would take more than `memory` bytes.
    pub fn build(&self, part: &mut Part<Src::Pack>, shop: &mut Shop<Src::Local>) -> Result<()> {
        part.frame = self.frame;
        let Part { top, .. } = part;
        let half = self.frame.half;
        let density = self.settings.density.unwrap_or_else(|| fill::density(self.boxes, self.members));
        top.cut(half, fill::resolution(half.to_array(), density * self.members.len() as f64));
        self.place(top, shop)?;
        let occupied = shop.start.windows(2).map(|pair| pair[0] < pair[1]);
        free_cubes(top.cells.map(|n| n as usize), occupied, &mut top.free);
        self.cut(top, shop)?;
        join(part, &mut shop.pieces);

        let ends: Vec<usize> = ends(shop.pieces.iter().map(Piece::packs)).collect();
        parallel::fill(&mut part.packs, ends.last().copied().unwrap_or(0), |pack| {
            let piece = ends.partition_point(|&end| end <= pack);
            let first = if piece == 0 { 0 } else { ends[piece - 1] };
            let lanes = &shop.pieces[piece].lanes[8 * (pack - first)..][..8];
            self.isa.run(Fill { source: self.source, lanes })
        });
        Ok(())
    }

    /// Lists of the primitives that each cell of the grid meets, in `shop.start` and `shop.list`.
    fn place(&self, top: &Top, shop: &mut Shop<Src::Local>) -> Result<()> {
        const LEAST: usize = 2048;
        // Skip bytes for eight octants, a slot, and where its list begins.
        const CELL: u64 = 8 + size_of::<Slot>() as u64 + 4;
        // With four bytes for each reference, they can be counted in 32 bits.
        let mut limit = Limit::new(self.memory.min(16 << 30));
        if !limit.take(CELL * top.cells.iter().map(|&n| u64::from(n)).product::<u64>()) {
            return limit.check(&top.cells);
        }
        let ranges: Vec<Range<usize>> = parallel::chunks(self.members.len(), LEAST).collect();
        shop.placed.resize_with(ranges.len(), Placed::default);
        parallel::each(shop.placed.iter_mut().zip(ranges), |(placed, range)| {
            placed.range = range;
            let Self { source, members, boxes, ref frame, .. } = *self;
            self.isa.run(Place { source, frame, top, members, boxes, limit: &limit, placed });
        });
        limit.check(&top.cells)?;
        let count = top.cells.iter().map(|&n| n as usize).product::<usize>();
        let references = Placements { members: self.members, placed: &shop.placed, cells: &top.cells };
        lists::sort(&references, count, &mut shop.start, &mut shop.list);
        Ok(())
    }

    /// Cuts the cells of the grid, in pieces.
    fn cut(&self, top: &mut Top, shop: &mut Shop<Src::Local>) -> Result<()> {
        const LEAST: usize = 4096;
        let Shop { start, list, pieces, .. } = shop;
        let Top { half, cell, cells, slots, .. } = top;
        let count = start.len() - 1;
        slots.clear();
        slots.resize(count, Slot::EMPTY);

        // Pieces of about as many references.
        let (mut work, mut rest, mut first) = (Vec::new(), slots.as_mut_slice(), 0);
        for chunk in parallel::chunks(list.len(), LEAST) {
            let end = start.partition_point(|&begin| (begin as usize) < chunk.end).min(count);
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(end.saturating_sub(first));
            work.push((first, mine));
            (rest, first) = (others, end.max(first));
        }
        pieces.resize_with(work.len(), Piece::default);

        let mut limit = Limit::new(self.memory.min(1 << 40));
        let cutter = Cutter {
            source: self.source,
            settings: &self.settings,
            frame: &self.frame,
            boxes: self.boxes,
            isa: self.isa,
            limit: &limit,
        };
        let [nx, ny, _] = cells.map(|n| n as usize);
        parallel::each(pieces.iter_mut().zip(work), |(piece, (first, slots))| {
            piece.clear(first..first + slots.len());
            for (i, slot) in (first..).zip(slots) {
                let list = &list[start[i] as usize..start[i + 1] as usize];
                if !list.is_empty() {
                    let at = [i % nx, i / nx % ny, i / (nx * ny)];
                    let low = [0, 1, 2].map(|a| at[a] as f32 * cell[a] - half[a]);
                    *slot = cutter.top(list, low, cell.to_array(), piece);
                }
            }
        });
        limit.check(cells)
    }
}

/// Puts pieces together: what they number from their own begin, the part numbers from its.
fn join<K, L>(part: &mut Part<K>, pieces: &mut [Piece<L>]) {
    if let [piece] = pieces {
        std::mem::swap(&mut part.nodes, &mut piece.nodes);
        std::mem::swap(&mut part.slots, &mut piece.slots);
        std::mem::swap(&mut part.boxes, &mut piece.boxes);
        return;
    }
    let Part { nodes, slots, boxes, top, .. } = part;
    nodes.clear();
    slots.clear();
    boxes.clear();
    nodes.reserve_exact(pieces.iter().map(|piece| piece.nodes.len()).sum());
    slots.reserve_exact(pieces.iter().map(|piece| piece.slots.len()).sum());
    boxes.reserve_exact(pieces.iter().map(|piece| piece.boxes.len()).sum());
    let mut packs = 0;
    for piece in pieces {
        let [first_node, first_slot, first_box] = [nodes.len(), slots.len(), boxes.len()].map(|len| len as u32);
        let moved = |slot: &Slot| match slot {
            slot if slot.is_node() => Slot::node(slot.first + first_node),
            slot if slot.is_boxed() => Slot { first: slot.first + first_box, ..*slot },
            slot => Slot { first: slot.first + packs, ..*slot },
        };
        nodes.extend(piece.nodes.iter().map(|node| Node { base: node.base + first_slot, ..*node }));
        slots.extend(piece.slots.iter().map(moved));
        boxes.extend(piece.boxes.iter().map(|boxes| Boxes {
            first: boxes.first.wrapping_add(packs),
            below: boxes.below + first_box,
            ..*boxes
        }));
        for slot in top.slots[piece.cells.clone()].iter_mut().filter(|slot| slot.count > 0) {
            *slot = moved(slot);
        }
        packs += piece.packs() as u32;
    }
}

/// Running totals.
fn ends(lengths: impl Iterator<Item = usize>) -> impl Iterator<Item = usize> {
    lengths.scan(0, |end, length| {
        *end += length;
        Some(*end)
    })
}

#[cfg(test)]
mod tests {
    use super::super::shape::AnyPart;
    use super::super::{Below, Nested, NestedOptions};
    use crate::accel::{Accel, BruteForce};
    use crate::geometry::tests::Random;
    use crate::geometry::{Geometry, Mixed, Sphere, Triangle};
    use crate::ray::Ray;
    use glam::Vec3;

    /// Small and long triangles, spheres, and copies of some, those of a later moment a bit further on.
    fn scene(moment: f32) -> Mixed {
        let mut random = Random::new(21);
        let mut triangles: Vec<Triangle> = (0..6000)
            .map(|i| {
                let (p, size) = (random.in_cube(), if i % 40 == 0 { 0.8 } else { 0.03 });
                let wave = Vec3::Y * 0.1 * (moment + 7.0 * p.x).sin();
                [p, p + size * random.in_cube(), p + size * random.in_cube()].map(|p| p + wave)
            })
            .collect();
        triangles.extend_from_within(100..200);
        let sphere = |i| Sphere { centre: random.in_cube() + Vec3::X * 0.01 * moment, radius: 0.001 * (i % 60) as f32 };
        Mixed { triangles, spheres: (0..5000).map(sphere).collect() }
    }

    /// Runs `work` on so many threads.
    #[cfg(feature = "parallel")]
    fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn threads_change_nothing() {
        use super::super::Quality;
        let scene = scene(0.0);
        let of = |quality, below| NestedOptions { quality, below, ..NestedOptions::default() };
        for options in
            [of(Quality::Fast, Below::Boxes), of(Quality::Default, Below::Boxes), of(Quality::Best, Below::Nodes)]
        {
            let built = |threads| {
                let nested = on(threads, || Nested::build(&scene, &options).expect("enough memory"));
                assert!(nested.describe().contains("100 copies"), "{}", nested.describe());
                format!("{:?}", nested.shape)
            };
            let alone = built(1);
            assert!(alone.len() > 1_000_000, "{}", alone.len());
            for threads in [2, 7] {
                assert!(built(threads) == alone, "{options:?} on {threads} threads");
            }
        }
    }

    /// Where the memory is that is to be used again: two lists swap theirs on one thread.
    fn places<G>(nested: &Nested<G>) -> Vec<(usize, usize)> {
        let mut places = Vec::new();
        for part in &nested.shape.parts {
            let (top, nodes, slots, packs) = match part {
                AnyPart::Triangles(part) => (&part.top, &part.nodes, &part.slots, part.packs.as_ptr() as usize),
                AnyPart::Spheres(part) => (&part.top, &part.nodes, &part.slots, part.packs.as_ptr() as usize),
                AnyPart::Lists(part) => (&part.top, &part.nodes, &part.slots, part.packs.as_ptr() as usize),
            };
            places.extend([(packs, 0), (top.free.as_ptr() as usize, 0), (top.slots.as_ptr() as usize, 0)]);
            places.extend([(nodes.as_ptr() as usize, 1), (slots.as_ptr() as usize, 2)]);
        }
        places
    }

    #[test]
    fn a_rebuild_is_a_fresh_build_in_the_same_place() {
        for below in [Below::Boxes, Below::Nodes] {
            let options = NestedOptions { below, ..NestedOptions::default() };
            let mut nested = Nested::build(scene(0.0), &options).expect("enough memory");
            for moment in [1.0, 2.0, 0.0, 1.0, 2.0, 0.0] {
                nested.rebuild(scene(moment)).expect("enough memory");
                let fresh = Nested::build(scene(moment), &options).expect("enough memory");
                assert!(format!("{:?}", nested.shape) == format!("{:?}", fresh.shape), "{below:?} at {moment}");
                assert_eq!(nested.describe(), fresh.describe());
                assert_eq!(nested.bounds(), fresh.bounds());
            }
            // All moments have been: whatever comes has its place.
            let before = places(&nested);
            nested.rebuild(scene(1.0)).expect("enough memory");
            nested.rebuild(scene(0.0)).expect("enough memory");
            assert_eq!(places(&nested), before, "{below:?}");
        }
    }

    #[test]
    fn a_rebuild_that_is_refused_still_answers() {
        let memory = 4 << 20;
        let options = NestedOptions { memory, ..NestedOptions::default() };
        let mut nested = Nested::build(scene(0.0), &options).expect("enough memory");
        let mut large = scene(0.0);
        let mut random = Random::new(22);
        large.triangles.extend((0..20_000).map(|_| [random.in_cube(), random.in_cube(), random.in_cube()]));
        let error = nested.rebuild(large.clone()).expect_err("more than 4 MiB").to_string();
        assert!(error.contains("allowed are"), "{error}");
        let brute = BruteForce::new(&large);
        for _ in 0..200 {
            let ray = Ray::new(random.in_cube() * 3.0, random.in_cube());
            assert_eq!(nested.closest_hit(&ray), brute.closest_hit(&ray), "{ray:?}");
            assert_eq!(nested.any_hit(&ray), brute.any_hit(&ray), "{ray:?}");
        }
        assert_eq!(nested.bounds(), brute.bounds());
        nested.rebuild(scene(0.0)).expect("enough memory again");
        assert!(nested.memory().total() < memory && large.len() > 0);
    }
}
