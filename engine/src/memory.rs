//! The allocator of Meniscus: long columns get pages of their own, and begin at different places of them.
//!
//! A stage walks through up to forty columns side by side. If all began at the same place of a page, as blocks do
//! that the system's allocator maps, values of one particle would fall into the same few lines of the
//! first-level cache and displace each other; and sixteen bytes behind the start of a page, as it has them, every
//! load and store of eight numbers crosses a cache line. Pages that were never written take no memory, and
//! all of them go back at once.

use rustix::mm::{MapFlags, ProtFlags, mmap_anonymous, munmap};
use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes from which on a block has pages of its own.
const LONG: usize = 32 << 10;
/// Bytes of a page.
const PAGE: usize = 4096;
/// Bytes of a cache line.
const LINE: usize = 64;
/// Blocks begin this many cache lines after each other; has no divisor in common with the lines of a page.
const STAGGER: usize = 5;

/// The system's allocator for short blocks, pages for long ones. To be a program's `#[global_allocator]`.
#[derive(Debug, Default)]
pub struct StaggeredMemory {
    blocks: AtomicUsize,
}

impl StaggeredMemory {
    /// One for a `static`.
    pub const fn new() -> Self {
        StaggeredMemory { blocks: AtomicUsize::new(0) }
    }
}

fn is_long(layout: Layout) -> bool {
    layout.size() >= LONG && layout.align() <= LINE
}

/// What is mapped for a block: a page more than it needs, for its start lies within the first one.
fn mapped(layout: Layout) -> usize {
    layout.size() + PAGE
}

// SAFETY: whether a block is long follows from its layout alone, so that it goes back to whom it came from. A long
// one lies within the pages mapped for it: it starts in the first one, on a cache line, and one more than it
// needs was mapped. Fresh anonymous pages are zero.
unsafe impl GlobalAlloc for StaggeredMemory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !is_long(layout) {
            // SAFETY: the caller's contract is the same.
            return unsafe { System.alloc(layout) };
        }
        let protection = ProtFlags::READ | ProtFlags::WRITE;
        // SAFETY: a new mapping that overlaps with nothing.
        let pages = unsafe { mmap_anonymous(null_mut(), mapped(layout), protection, MapFlags::PRIVATE) };
        let Ok(pages) = pages else { return null_mut() };
        let line = self.blocks.fetch_add(STAGGER, Ordering::Relaxed) % (PAGE / LINE);
        pages.cast::<u8>().wrapping_add(line * LINE)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract is the same; long blocks are zero as they are mapped.
        unsafe { if is_long(layout) { self.alloc(layout) } else { System.alloc_zeroed(layout) } }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if !is_long(layout) {
            // SAFETY: it came from there.
            return unsafe { System.dealloc(block, layout) };
        }
        let pages = block.wrapping_sub(block.addr() % PAGE);
        // SAFETY: exactly what `alloc` mapped for this layout, which nobody uses any longer.
        let unmapped = unsafe { munmap(pages.cast(), mapped(layout)) };
        debug_assert!(unmapped.is_ok(), "pages that were mapped can be given back");
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let Ok(new) = Layout::from_size_align(size, layout.align()) else { return null_mut() };
        if !is_long(layout) && !is_long(new) {
            // SAFETY: the caller's contract is the same, and the block came from there.
            return unsafe { System.realloc(block, layout, size) };
        }
        // SAFETY: both blocks hold what is copied, and they don't overlap; the old one came from this allocator.
        unsafe {
            let moved = self.alloc(new);
            if !moved.is_null() {
                block.copy_to_nonoverlapping(moved, layout.size().min(size));
                self.dealloc(block, layout);
            }
            moved
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_blocks_are_zero_start_on_lines_and_keep_their_content() {
        let memory = StaggeredMemory::new();
        let mut places = Vec::new();
        for words in [10, 5000, 100_000, 5000] {
            let layout = Layout::array::<f64>(words).unwrap();
            // SAFETY: every block is used within its layout, and given back once with the layout it has then.
            unsafe {
                let block = memory.alloc_zeroed(layout).cast::<f64>();
                let values = std::slice::from_raw_parts_mut(block, words);
                assert!(values.iter().all(|value| *value == 0.0));
                values.iter_mut().enumerate().for_each(|(k, value)| *value = k as f64);
                let longer = memory.realloc(block.cast(), layout, 2 * layout.size()).cast::<f64>();
                let kept = std::slice::from_raw_parts(longer, words);
                assert!(kept.iter().enumerate().all(|(k, value)| *value == k as f64));
                let long = Layout::array::<f64>(2 * words).unwrap();
                if is_long(long) {
                    assert_eq!(longer.addr() % LINE, 0);
                    places.push(longer.addr() % PAGE);
                }
                memory.dealloc(longer.cast(), long);
            }
        }
        places.dedup();
        assert_eq!(places.len(), 3, "blocks start at different places of their pages");
    }
}
