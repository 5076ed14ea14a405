//! Work on independent parts, on all cores where the feature `parallel` is on. The results do not depend on it.

use std::ops::Range;

/// Runs `work` on each item.
pub(crate) fn each<T: Send>(items: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if threads() > 1 {
        use rayon::prelude::*;
        let items: Vec<T> = items.into_iter().collect();
        return items.into_par_iter().for_each(work);
    }
    items.into_iter().for_each(work);
}

/// `make` of each item, in their order.
pub(crate) fn map<T: Send, R: Send>(items: impl IntoIterator<Item = T>, make: impl Fn(T) -> R + Sync + Send) -> Vec<R> {
    #[cfg(feature = "parallel")]
    if threads() > 1 {
        use rayon::prelude::*;
        let items: Vec<T> = items.into_iter().collect();
        return items.into_par_iter().map(make).collect();
    }
    items.into_iter().map(make).collect()
}

/// Fills `list`, whose old content is lost and whose memory is used again, with `make(0)` to `make(len - 1)`.
pub(crate) fn fill<T: Send>(list: &mut Vec<T>, len: usize, make: impl Fn(usize) -> T + Sync + Send) {
    #[cfg(feature = "parallel")]
    if threads() > 1 {
        use rayon::prelude::*;
        return (0..len).into_par_iter().with_min_len(64).map(make).collect_into_vec(list);
    }
    list.clear();
    list.reserve_exact(len);
    list.extend((0..len).map(make));
}

/// Threads that work here.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Cuts `0..len` into ranges of at least `least` for the threads to share: one range where there is one thread, else
/// some for each, so that no thread waits long for another. Nothing may depend on where the cuts are.
pub(crate) fn chunks(len: usize, least: usize) -> impl Iterator<Item = Range<usize>> + Clone {
    let wanted = if threads() == 1 { 1 } else { 4 * threads() };
    let size = len.div_ceil(wanted).max(least).max(1);
    (0..len.div_ceil(size)).map(move |i| i * size..((i + 1) * size).min(len))
}
