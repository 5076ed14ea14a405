//! Whether shards cover every sample of every pixel, and none twice.

use super::Place;
use crate::render::Crop;
use std::collections::BTreeSet;
use std::ops::Range;

/// How places cover a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cover {
    /// Pairs of places, by their index, that share samples of a pixel.
    pub twice: Vec<(usize, usize)>,
    /// What no place has, cut where other places are.
    pub missing: Vec<Place>,
}

/// How `places` cover all `total` samples of the pixels of `area`, inside which they lie. No coordinate goes beyond `u32`.
pub fn cover(area: Crop, total: u32, places: &[Place]) -> Cover {
    let blocks: Vec<Block> = places.iter().map(Block::of).collect();
    let mut order: Vec<usize> = (0..places.len()).collect();
    // In the order of a plan what is left stays in few pieces.
    order.sort_by_key(|&i| blocks[i].0.clone().map(|axis| (axis.start, axis.end)));
    let whole = Block::of(&Place { tile: area, samples: 0..total });
    let mut left = vec![whole.clone()];
    let mut twice = Vec::new();
    for (rank, &i) in order.iter().enumerate() {
        let block = &blocks[i];
        let mut found = 0;
        let mut pieces = Vec::with_capacity(left.len() + 2);
        for region in left {
            match region.intersection(block) {
                Some(common) => {
                    found += common.volume();
                    region.without(&common, &mut pieces);
                }
                None => pieces.push(region),
            }
        }
        left = pieces;
        if found < block.volume() {
            let other = order[..rank].iter().find(|&&j| blocks[j].intersection(block).is_some());
            twice.extend(other.map(|&j| (j, i)));
        }
    }
    let mut cuts: [BTreeSet<u32>; 3] = Default::default();
    for block in blocks.iter().chain([&whole]) {
        for (cuts, axis) in cuts.iter_mut().zip(&block.0) {
            cuts.extend([axis.start, axis.end]);
        }
    }
    let mut missing: Vec<Place> = left.iter().flat_map(|region| region.cut(&cuts)).collect();
    missing.sort_by_key(|place| (place.tile.y, place.tile.x, place.samples.start));
    Cover { twice, missing }
}

/// Rows, columns and samples.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Block([Range<u32>; 3]);

impl Block {
    fn of(place: &Place) -> Self {
        let Crop { x, y, width, height } = place.tile;
        Self([y..y + height, x..x + width, place.samples.clone()])
    }

    fn place(&self) -> Place {
        let [rows, columns, samples] = self.0.clone();
        let tile =
            Crop { x: columns.start, y: rows.start, width: columns.end - columns.start, height: rows.end - rows.start };
        Place { tile, samples }
    }

    fn volume(&self) -> u128 {
        self.0.iter().map(|axis| u128::from(axis.end - axis.start)).product()
    }

    fn intersection(&self, other: &Block) -> Option<Block> {
        let axis = |i: usize| self.0[i].start.max(other.0[i].start)..self.0[i].end.min(other.0[i].end);
        let common = [axis(0), axis(1), axis(2)];
        common.iter().all(|axis| !axis.is_empty()).then_some(Block(common))
    }

    /// Adds to `pieces` what remains without `inner`, which lies inside.
    fn without(mut self, inner: &Block, pieces: &mut Vec<Block>) {
        for i in 0..3 {
            let (axis, keep) = (self.0[i].clone(), &inner.0[i]);
            for side in [axis.start..keep.start, keep.end..axis.end] {
                if !side.is_empty() {
                    let mut piece = self.clone();
                    piece.0[i] = side;
                    pieces.push(piece);
                }
            }
            self.0[i] = keep.clone();
        }
    }

    /// The places in it between neighbouring `cuts`.
    fn cut(&self, cuts: &[BTreeSet<u32>; 3]) -> Vec<Place> {
        let mut pieces = vec![self.clone()];
        for (i, cuts) in cuts.iter().enumerate() {
            let axis = self.0[i].clone();
            let inner: Vec<u32> = cuts.range(axis.start + 1..axis.end).copied().collect();
            let starts = std::iter::once(axis.start).chain(inner.iter().copied());
            let ends = inner.iter().copied().chain([axis.end]);
            let ranges: Vec<Range<u32>> = starts.zip(ends).map(|(start, end)| start..end).collect();
            let along = |piece: &Block| {
                let piece = piece.clone();
                ranges.clone().into_iter().map(move |range| {
                    let mut piece = piece.clone();
                    piece.0[i] = range;
                    piece
                })
            };
            pieces = pieces.iter().flat_map(along).collect();
        }
        pieces.iter().map(Block::place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::places;
    use super::*;

    const AREA: Crop = Crop { x: 2, y: 1, width: 10, height: 7 };

    #[test]
    fn what_is_taken_out_of_a_plan_is_missing_and_nothing_else() {
        let all = places(AREA, (4, 3), 2, 5).expect("few");
        assert_eq!(cover(AREA, 5, &all), Cover { twice: vec![], missing: vec![] });
        for gone in 0..all.len() {
            for other in gone..all.len() {
                let there: Vec<Place> =
                    (0..all.len()).filter(|i| *i != gone && *i != other).map(|i| all[i].clone()).rev().collect();
                let mut expected = vec![all[gone].clone()];
                expected.extend((other != gone).then(|| all[other].clone()));
                assert_eq!(cover(AREA, 5, &there), Cover { twice: vec![], missing: expected }, "{gone} {other}");
            }
        }
        let whole = Place { tile: AREA, samples: 0..5 };
        assert_eq!(cover(AREA, 5, &[]).missing, [whole]);
    }

    #[test]
    fn what_is_there_twice_is_named() {
        let all = places(AREA, (4, 3), 2, 5).expect("few");
        let mut twice = all.clone();
        twice.push(all[4].clone());
        assert_eq!(cover(AREA, 5, &twice).twice, [(4, all.len())]);
        let mut overlapping = all.clone();
        overlapping.push(Place { tile: Crop { x: 2, y: 1, width: 1, height: 1 }, samples: 1..2 });
        let found = cover(AREA, 5, &overlapping);
        assert_eq!(found.twice.len(), 1);
        assert!([(0, all.len()), (all.len(), 0)].contains(&found.twice[0]), "{found:?}");
        assert!(found.missing.is_empty());
    }
}
