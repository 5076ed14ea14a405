//! Building a grid: the voxels of each primitive, in chunks of primitives; then these references sorted by voxels.

use super::Grid;
use super::cells::Cells;
use super::frame::Frame;
use super::lists::{self, References};
use super::options::GridOptions;
use super::seeds::Seeds;
use super::skip::{Method, NoSkip, SkipOptions, Slot, Table};
use super::voxelise::voxels_of;
use super::walk::{VoxelWalk, Walk};
use crate::accel::{LeftOut, Sieve};
use crate::error::{Error, Result};
use crate::geometry::Geometry;
use crate::parallel;
use crate::ray::Aabb;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

impl<G: Geometry> Grid<G, NoSkip, Walk> {
    /// Builds a grid over `geometry`. Primitives that no ray can hit are left out; an empty geometry is fine.
    ///
    /// # Errors
    /// An option is out of range; voxels and references, or they and the seeds of primitives whose tests iterate, would
    /// take more than `options.memory` bytes; or the system refuses the memory.
    ///
    /// ```
    /// use glam::Vec3;
    /// use skipgrid::grid::{Grid, GridOptions, skip};
    /// use skipgrid::{Accel, Ray};
    ///
    /// let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::X, Vec3::Y, Vec3::ONE * 9.0]];
    /// let options = GridOptions { resolution: Some([16; 3]), ..GridOptions::default() };
    /// let grid = Grid::build(&triangles, &options)?;
    /// let leaping = grid.clone().with_skip::<skip::Octants>(&skip::SkipOptions::default())?;
    /// let ray = Ray::new(Vec3::new(4.0, 0.0, 9.0), Vec3::new(0.0, 1.0, -1.5));
    /// assert_eq!(grid.closest_hit(&ray).map(|hit| hit.prim), Some(1));
    /// assert_eq!(leaping.closest_hit(&ray), grid.closest_hit(&ray));
    /// # Ok::<(), skipgrid::Error>(())
    /// ```
    pub fn build(geometry: G, options: &GridOptions) -> Result<Self> {
        options.check()?;
        let mut shop = Workshop::default();
        let Insides { frame, cells, seeds, bounds, left_out } =
            Insides::new(&geometry, options, &mut shop, Cells::default())?;
        Ok(Self {
            geometry,
            frame,
            voxels: NoSkip(cells),
            bounds,
            mailbox: options.mailbox && seeds.is_empty(),
            seeds,
            options: *options,
            shop: None,
            left_out,
            walk: PhantomData,
        })
    }

    /// Builds the grid anew, with the options that it was built with: as a fresh one, to the bit, in the memory of this
    /// one. From the second time on, nothing large is allocated for as many primitives and references. For that the grid
    /// keeps what it needs while it builds, some 50 bytes for each primitive, which
    /// [`Accel::memory`](crate::accel::Accel::memory) does not count, as rays do not use it; [`Clone`] does.
    ///
    /// # Errors
    /// As [`Grid::build`]. Then all primitives are in one voxel, and answers as always but slow.
    pub fn rebuild(&mut self, geometry: G) -> Result<()> {
        let mut shop = self.shop.take().unwrap_or_default();
        let NoSkip(cells) = &mut self.voxels;
        let cells = std::mem::take(cells);
        let made = Insides::new(&geometry, &self.options, &mut shop, cells);
        let (insides, result) = match made {
            Ok(insides) => (insides, Ok(())),
            Err(error) => (Insides::in_one_voxel(&geometry, &mut shop), Err(error)),
        };
        let Insides { frame, cells, seeds, bounds, left_out } = insides;
        let mailbox = self.options.mailbox && seeds.is_empty();
        let (options, shop) = (self.options, Some(shop));
        *self = Self {
            geometry,
            frame,
            voxels: NoSkip(cells),
            bounds,
            mailbox,
            seeds,
            options,
            shop,
            left_out,
            walk: PhantomData,
        };
        result
    }
}

/// What is made of a geometry.
struct Insides {
    frame: Frame,
    cells: Cells,
    seeds: Seeds,
    bounds: Aabb,
    left_out: LeftOut,
}

impl Insides {
    /// In the memory of `cells`.
    fn new<G: Geometry>(geometry: &G, options: &GridOptions, shop: &mut Workshop, cells: Cells) -> Result<Self> {
        let (bounds, left_out) = shop.sieve.sift(geometry);
        let prims = &shop.sieve.prims;
        let frame = Frame::new(&bounds, prims.len() as u32, options);
        let cells = fill(geometry, prims, &frame, options, &mut shop.chunks, cells)?;
        let left = options.memory.saturating_sub(cells.memory().total());
        // A test that begins in a voxel finds what is in that voxel only: it does not stand for the others.
        let seeds = Seeds::new(geometry, &frame, cells.references(), options, left)?;
        Ok(Self { frame, cells, seeds, bounds, left_out })
    }

    /// Takes four bytes for each primitive, whatever they are.
    fn in_one_voxel<G: Geometry>(geometry: &G, shop: &mut Workshop) -> Self {
        let (bounds, left_out) = shop.sieve.sift(geometry);
        let prims = shop.sieve.prims.clone();
        let options = GridOptions { resolution: Some([1; 3]), ..GridOptions::default() };
        let frame = Frame::new(&bounds, prims.len() as u32, &options);
        let cells = Cells::new(vec![0, prims.len() as u32], prims);
        Self { frame, cells, seeds: Seeds::default(), bounds, left_out }
    }
}

impl<G: Geometry, W: VoxelWalk> Grid<G, NoSkip, W> {
    /// The same grid with the distances of method `M`, in slots of its usual width.
    ///
    /// # Errors
    /// As [`Grid::with_table`].
    pub fn with_skip<M: Method>(self, options: &SkipOptions) -> Result<Grid<G, Table<M>>> {
        self.with_table(options)
    }

    /// The same grid with the distances of method `M` in slots `T`.
    ///
    /// # Errors
    /// An option is out of range, lists and distances would take more than the grid's budget of memory, or the lists are too
    /// long for the slots: 2^31 entries for [`super::skip::One`], 2^28 for [`super::skip::Packed`].
    pub fn with_table<M: Method, T: Slot>(self, options: &SkipOptions) -> Result<Grid<G, Table<M, T>>> {
        let Self { geometry, frame, voxels: NoSkip(cells), seeds, bounds, mailbox, options: built, left_out, .. } =
            self;
        let voxels = Table::new(cells, frame.resolution, options, built.memory)?;
        let (options, shop) = (built, None);
        Ok(Grid { geometry, frame, voxels, seeds, bounds, mailbox, options, shop, left_out, walk: PhantomData })
    }

    /// The same grid walked by `V`.
    pub fn with_walk<V: VoxelWalk>(self) -> Grid<G, NoSkip, V> {
        let Self { geometry, frame, voxels, seeds, bounds, mailbox, options, left_out, .. } = self;
        Grid { geometry, frame, voxels, seeds, bounds, mailbox, options, shop: None, left_out, walk: PhantomData }
    }
}

/// The voxels of some primitives in a row.
#[derive(Clone, Debug, Default)]
struct Chunk {
    prims: Range<usize>,
    /// Number of voxels of each primitive.
    counts: Vec<u32>,
    /// The voxels of all of them, one primitive behind the other.
    voxels: Vec<u32>,
}

/// The references of all chunks.
struct Chunks<'a> {
    candidates: &'a [u32],
    chunks: &'a [Chunk],
}

impl References for Chunks<'_> {
    #[inline]
    fn each(&self, share: &Range<usize>, mut refer: impl FnMut(usize, u32)) {
        for Chunk { prims, counts, voxels } in self.chunks {
            let mut rest = voxels.as_slice();
            for (&prim, &count) in self.candidates[prims.clone()].iter().zip(counts) {
                let (voxels, others) = rest.split_at(count as usize);
                rest = others;
                for voxel in voxels.iter().map(|&voxel| voxel as usize).filter(|voxel| share.contains(voxel)) {
                    refer(voxel, prim);
                }
            }
        }
    }
}

/// Memory of a build that the next one uses again.
#[derive(Clone, Debug, Default)]
pub(super) struct Workshop {
    sieve: Sieve,
    chunks: Vec<Chunk>,
}

/// Fills `cells`, whose memory is used again, with the lists of `candidates`.
fn fill<G: Geometry>(
    geometry: &G,
    candidates: &[u32],
    frame: &Frame,
    options: &GridOptions,
    chunks: &mut Vec<Chunk>,
    cells: Cells,
) -> Result<Cells> {
    let [x, y, z] = frame.resolution;
    // At most 4096^3: no overflow in u64. Below 2^32 of each where they are within the budget.
    let voxels = u64::from(x) * u64::from(y) * u64::from(z);
    let allowed = options.memory.min(u64::from(u32::MAX) * 4);
    let Some(most) = (allowed / 4).checked_sub(voxels + 1) else {
        let what = format!("grid of {x} x {y} x {z} voxels");
        return Err(Error::TooLarge { what, wanted: (voxels + 1) * 4, allowed });
    };
    let (mut start, mut prims) = cells.into_parts();
    reserve(&mut start, voxels as usize + 1, options)?;

    // Asked for each primitive, so that a hopeless grid is refused before it is counted to the end.
    let references = AtomicU64::new(0);
    let ranges: Vec<Range<usize>> = parallel::chunks(candidates.len(), 1024).collect();
    chunks.resize_with(ranges.len(), Chunk::default);
    parallel::each(chunks.iter_mut().zip(ranges), |(chunk, range)| {
        let Chunk { prims, counts, voxels } = chunk;
        *prims = range;
        counts.clear();
        voxels.clear();
        for &prim in &candidates[prims.clone()] {
            let before = voxels.len();
            // A voxel refers to a primitive once.
            voxels_of(geometry, prim, frame, &mut |voxel| voxels.push(voxel as u32));
            let count = voxels.len() - before;
            counts.push(count as u32);
            if references.fetch_add(count as u64, Relaxed) + count as u64 > most {
                return;
            }
        }
    });
    let references = references.into_inner();
    if references > most {
        let what = format!("grid of {x} x {y} x {z} voxels with more than {most} references");
        return Err(Error::TooLarge { what, wanted: (voxels + most + 2) * 4, allowed });
    }
    reserve(&mut prims, references as usize, options)?;
    lists::sort(&Chunks { candidates, chunks }, voxels as usize, &mut start, &mut prims);
    Ok(Cells::new(start, prims))
}

/// Room for `len` entries in all, or an error instead of an abort.
fn reserve(list: &mut Vec<u32>, len: usize, options: &GridOptions) -> Result<()> {
    list.try_reserve_exact(len.saturating_sub(list.len())).map_err(|_| Error::TooLarge {
        what: "grid (the system refuses the memory)".into(),
        wanted: len as u64 * 4,
        allowed: options.memory,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accel, BruteForce};
    use crate::geometry::Triangle;
    use crate::geometry::tests::Random;
    use crate::ray::Ray;

    fn soup(seed: u64, count: usize, size: f32) -> Vec<Triangle> {
        Random::new(seed).soup(count, size)
    }

    #[test]
    #[cfg(feature = "parallel")]
    fn threads_change_nothing() {
        let soup = soup(1, 5000, 0.1);
        let built = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let grid = pool.install(|| Grid::build(&soup, &GridOptions::default()).expect("enough memory"));
            format!("{:?}", grid.voxels)
        };
        let alone = built(1);
        assert!(alone.len() > 100_000, "{}", alone.len());
        assert!([2, 7].into_iter().all(|threads| built(threads) == alone));
    }

    #[test]
    fn a_rebuild_is_a_fresh_build_in_the_same_place() {
        let options = GridOptions::default();
        let mut grid = Grid::build(soup(1, 5000, 0.1), &options).expect("enough memory");
        for seed in [2, 3, 1, 2, 3] {
            grid.rebuild(soup(seed, 5000, 0.1)).expect("enough memory");
            let fresh = Grid::build(soup(seed, 5000, 0.1), &options).expect("enough memory");
            assert!(format!("{:?}", grid.voxels) == format!("{:?}", fresh.voxels), "{seed}");
            assert_eq!(grid.describe(), fresh.describe());
        }
        let place = |grid: &Grid<Vec<Triangle>>| grid.voxels.0.list(0).as_ptr();
        let before = place(&grid);
        grid.rebuild(soup(3, 5000, 0.1)).expect("enough memory");
        assert_eq!(place(&grid), before);
    }

    #[test]
    fn a_rebuild_that_is_refused_still_answers() {
        let options = GridOptions { memory: 50_000, ..GridOptions::default() };
        let mut grid = Grid::build(soup(1, 500, 0.1), &options).expect("enough memory");
        let large = soup(4, 2000, 1.0);
        let error = grid.rebuild(large.clone()).expect_err("more than 50 kB").to_string();
        assert!(error.contains("more than") && error.contains("allowed are 50000"), "{error}");
        let (brute, mut random) = (BruteForce::new(&large), Random::new(5));
        for _ in 0..100 {
            let ray = Ray::new(random.in_cube() * 3.0, random.in_cube());
            assert_eq!(grid.closest_hit(&ray), brute.closest_hit(&ray), "{ray:?}");
        }
        grid.rebuild(soup(1, 500, 0.1)).expect("enough memory again");
    }
}
