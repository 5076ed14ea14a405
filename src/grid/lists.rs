//! References sorted into one list for each cell: a pass that counts them, then one that writes them.
//!
//! In parallel, each thread has a share of the cells and looks through all references for those of its share. That is more
//! reading, but of few bytes in a row; nothing is written by two threads, and lists keep the order of the references.

use crate::parallel;
use std::ops::Range;

/// References from cells to primitives, in any order of cells.
pub(crate) trait References: Sync {
    /// Calls `refer(cell, prim)` for each reference from a cell of `share`; a cell refers to each primitive once.
    fn each(&self, share: &Range<usize>, refer: impl FnMut(usize, u32));
}

/// Writes the lists of `cells` cells: that of cell `c` is `prims[start[c]..start[c + 1]]`, in the order of `references`, of which
/// there are less than 2^32. The old content of the vectors is lost and their memory used again.
pub(crate) fn sort(references: &impl References, cells: usize, start: &mut Vec<u32>, prims: &mut Vec<u32>) {
    start.clear();
    start.resize(cells + 1, 0);
    let shares: Vec<Range<usize>> = shares(cells).collect();
    let size = shares.first().map_or(1, |share| share.len());

    // Place c + 1 counts the references of cell c, then says where its list begins in what its share has.
    let work = shares.iter().zip(start[1..].chunks_mut(size));
    let totals = parallel::map(work, |(share, next)| {
        references.each(share, |cell, _| next[cell - share.start] += 1);
        let mut total = 0;
        for count in next {
            total += std::mem::replace(count, total);
        }
        total
    });
    prims.resize(totals.iter().map(|&total| total as usize).sum(), 0);

    let (mut work, mut rest, mut begin) = (Vec::new(), &mut prims[..], 0);
    for ((share, next), &total) in shares.iter().zip(start[1..].chunks_mut(size)).zip(&totals) {
        let (mine, others) = std::mem::take(&mut rest).split_at_mut(total as usize);
        work.push((share, next, mine, begin));
        (rest, begin) = (others, begin + total);
    }
    parallel::each(work, |(share, next, prims, begin)| {
        // Then place c + 1 runs from the begin of list c to its end, which is the begin of list c + 1.
        references.each(share, |cell, prim| {
            let place = &mut next[cell - share.start];
            prims[*place as usize] = prim;
            *place += 1;
        });
        if begin > 0 {
            next.iter_mut().for_each(|place| *place += begin);
        }
    });
}

/// A share of the cells for each thread.
fn shares(cells: usize) -> impl Iterator<Item = Range<usize>> {
    let size = cells.div_ceil(parallel::threads()).max(64);
    (0..cells.div_ceil(size)).map(move |i| i * size..((i + 1) * size).min(cells))
}
