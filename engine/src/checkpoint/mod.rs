//! Checkpoints: the whole state of a run in one file, safe against crashes and damage.
//!
//! `FORMAT.md` beside this file tells the layout byte by byte, `read_checkpoint.py` reads it in Python.
//!
//! A file is a header of 4096 bytes (own layout, see `header.rs`) and two sections, each starting
//! on a page of 4096 bytes and zero-padded to a whole number of pages:
//!
//! 1. the preface: clock, text of the effective scene and source revision;
//! 2. the columns: a list of named fields, one value a particle.
//!
//! Both are rkyv archives. Their types never follow the fields of a scene: a list of named columns
//! stays the same type whatever is stored, so old files stay readable. A change to the types in
//! `types.rs` is a new format version.
//!
//! rkyv's own validation makes an archive safe to walk, but lets half of all flipped bits pass;
//! so every byte of the file, padding included, stands under a checksum (xxh3, 64 bits). The
//! order of checks: length, magic and version, header checksum, section checksums, validation of
//! the archives, then meaning: unique names and equal lengths. What values make sense (a radius is
//! not negative, say) only the caller knows.
//!
//! Files are never changed in place: [`write()`] fills a temporary file beside the target, flushes it
//! to the disk and renames it.

mod contents;
mod error;
mod folder;
mod header;
mod mapped;
mod read;
#[cfg(test)]
mod tests;
mod types;
mod write;

pub use error::{CheckpointError, Skipped};
pub use folder::{
    check_name, crash_file_name, file_name, keep_last, list, list_crashes, newest_valid, set_aside,
};
pub use header::FORMAT_VERSION;
pub use mapped::{ColumnView, Mapped};
pub use read::{parse, read};
pub use types::{Checkpoint, Clock, Column, Data, Role};
pub use write::{Unfinished, begin, write};
