//! The order in which the samples of a pixel are summed: a fixed tree, so that ranges of them can be summed apart.
//!
//! Sums of f64 are rounded, so the order of the additions is part of the picture. Samples `0..n` are the leaves of a binary
//! tree: a range is the sum of its first `2^k` samples, `2^k` the greatest power of two below its length, and of the rest.
//! Whoever knows the sums of some nodes goes on from there and gets the same bits, in whatever order they came. Rounding
//! errors grow with the logarithm of the number of samples (Higham 1993, "The accuracy of floating point summation", section
//! 3: pairwise summation).

use super::film::Film;
use super::tiles::Sums;
use crate::error::{Error, Result};
use glam::DVec3;
use std::ops::Range;

/// The two ranges whose sums are added to that of `range`, which has more than one sample.
fn halves(range: &Range<u32>) -> [Range<u32>; 2] {
    let middle = range.start + (1 << (range.end - range.start - 1).ilog2());
    [range.start..middle, middle..range.end]
}

/// The sums of the samples of a node of the tree, or `None` as soon as one sample is `None`.
pub(super) fn of(node: Range<u32>, sample: &mut impl FnMut(u32) -> Option<DVec3>) -> Option<Sums> {
    if node.end - node.start == 1 {
        // A zero has no sign in a sum.
        return sample(node.start).map(|value| (DVec3::ZERO + value, value * value));
    }
    let [first, rest] = halves(&node);
    let ((a, squares_a), (b, squares_b)) = (of(first, sample)?, of(rest, sample)?);
    Some((a + b, squares_a + squares_b))
}

/// The greatest nodes of the tree over `0..total` that lie in `range`, from first to last: the least sums from which
/// those of all samples can be made to the bit. At most two for each binary digit of `total`; one for all samples, none
/// for an empty range.
///
/// ```
/// use skipgrid::render::nodes;
/// assert_eq!(nodes(0..10, 10), [0..10]);
/// assert_eq!(nodes(4..8, 10), [4..8]);
/// assert_eq!(nodes(3..10, 10), [3..4, 4..8, 8..10]);
/// ```
pub fn nodes(range: Range<u32>, total: u32) -> Vec<Range<u32>> {
    fn collect(node: Range<u32>, range: &Range<u32>, found: &mut Vec<Range<u32>>) {
        if node.start >= range.end || node.end <= range.start {
            return;
        }
        if range.start <= node.start && node.end <= range.end {
            found.push(node);
            return;
        }
        // A node of one sample lies in the range or outside.
        let [first, rest] = halves(&node);
        collect(first, range, found);
        collect(rest, range, found);
    }
    let mut found = Vec::new();
    if total > 0 && range.start < range.end {
        collect(0..total, &range, &mut found);
    }
    found
}

/// One film of all samples from films of nodes, in any order.
///
/// # Errors
/// The nodes are not all leaves below one root `0..total`: a range is missing, there twice, or no node of that tree; or
/// the films differ in size.
pub fn join(total: u32, mut films: Vec<(Range<u32>, Film)>) -> Result<Film> {
    // The next one at the end.
    films.sort_by_key(|(node, _)| std::cmp::Reverse((node.start, node.end)));
    let film = joined(0..total, &mut films)?;
    match films.last() {
        Some((node, _)) => Err(Error::invalid(format!("samples {}..{} are there twice", node.start, node.end))),
        None => Ok(film),
    }
}

fn joined(node: Range<u32>, films: &mut Vec<(Range<u32>, Film)>) -> Result<Film> {
    match films.pop_if(|(next, _)| *next == node) {
        Some((_, film)) => Ok(film),
        None if node.end - node.start < 2 => {
            Err(Error::invalid(format!("the sum of samples {}..{} is missing", node.start, node.end)))
        }
        None => {
            let [first, rest] = halves(&node);
            let mut film = joined(first, films)?;
            film.merge(&joined(rest, films)?)?;
            Ok(film)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_cover_their_range_once_and_are_few() {
        for total in 1..70 {
            for start in 0..total {
                for end in start + 1..=total {
                    let found = nodes(start..end, total);
                    let samples: Vec<u32> = found.iter().cloned().flatten().collect();
                    assert!(samples.iter().copied().eq(start..end), "{start}..{end} of {total}: {found:?}");
                    assert!(found.len() <= 2 * total.ilog2().max(1) as usize, "{start}..{end} of {total}: {found:?}");
                }
            }
            assert_eq!(nodes(0..total, total), std::slice::from_ref(&(0..total)));
        }
        assert_eq!(nodes(0..0, 5), []);
        assert_eq!(nodes(3..9, 16), [3..4, 4..8, 8..9]);
    }

    /// Samples of very different size, so that every other order gives another sum.
    fn sample(i: u32) -> DVec3 {
        let bits = super::super::sampler::mix(u64::from(i));
        DVec3::new(1.0, 3.7, 0.2) * (bits as f64).powi((bits % 5) as i32)
    }

    fn film(node: Range<u32>) -> (Range<u32>, Film) {
        let mut film = Film::new(1, 1, node.end - node.start).expect("one pixel");
        (film.sum[0], film.sum_squares[0]) = of(node.clone(), &mut |i| Some(sample(i))).expect("all samples");
        (node, film)
    }

    #[test]
    fn parts_in_any_order_give_the_bits_of_the_whole() {
        for total in [1, 2, 3, 16, 23, 100] {
            let (_, whole) = film(0..total);
            for cut in 0..total {
                for other in cut..total {
                    let parts = [other..total, 0..cut, cut..other];
                    let films = parts.into_iter().flat_map(|part| nodes(part, total)).map(film).collect();
                    assert_eq!(join(total, films).expect("complete"), whole, "{cut} {other} of {total}");
                }
            }
        }
        let in_turn = (0..100).fold(DVec3::ZERO, |sum, i| sum + sample(i));
        assert_ne!(film(0..100).1.sum[0], in_turn, "these samples do not tell one order from another");
    }

    #[test]
    fn what_is_missing_or_there_twice_is_named() {
        for (ranges, words) in [
            (vec![0..4, 8..10], "samples 4..5 is missing"),
            (vec![0..4, 4..8, 4..8, 8..10], "is missing"),
            (vec![0..8, 8..10, 8..10], "8..10 are there twice"),
            (vec![0..3, 3..10], "0..1 is missing"),
        ] {
            let error = join(10, ranges.into_iter().map(film).collect()).expect_err(words).to_string();
            assert!(error.contains(words), "{error} does not say {words}");
        }
    }
}
