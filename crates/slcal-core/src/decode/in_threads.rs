//! The same work on every part of an image, on one thread or on many.

/// Calls `work` with the number of every item and the item, on the threads of the caller's pool if requested and compiled in.
pub(super) fn for_each<T: Send>(
    items: &mut [T],
    parallel: bool,
    work: impl Fn((usize, &mut T)) + Sync + Send,
) {
    #[cfg(feature = "rayon")]
    if parallel {
        use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};
        items.par_iter_mut().enumerate().for_each(work);
        return;
    }
    #[cfg(not(feature = "rayon"))]
    let _ = parallel;
    items.iter_mut().enumerate().for_each(work);
}
