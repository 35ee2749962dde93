//! Writing a checkpoint so that a crash at any moment leaves either the old file or the new one.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use rkyv::api::high::HighSerializer;
use rkyv::rancor::BoxedError;
use rkyv::ser::allocator::ArenaHandle;
use rkyv::ser::writer::IoWriter;
use rkyv::{Serialize, api::high::to_bytes_in};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::contents::check_columns;
use super::error::CheckpointError;
use super::header::{HEADER_LENGTH, Header, Section};
use super::types::{Checkpoint, Preface};

/// Ending of the names of files not yet finished.
pub(super) const UNFINISHED: &str = ".unfinished";

/// A checkpoint that is written, but may not yet lie on the disk, under a name that nobody reads. Unless it is
/// finished it vanishes.
#[derive(Debug)]
pub struct Unfinished {
    file: tempfile::NamedTempFile,
    path: PathBuf,
}

/// Writes a checkpoint: into a temporary file of the same folder, which takes the name `path` only
/// when it lies complete on the disk. The columns are streamed, so hardly any memory is needed.
///
/// # Errors
/// Columns of unequal length or equal name, and whatever the file system refuses; a file that
/// `path` named before is then still there, unchanged.
pub fn write(path: &Path, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
    begin(path, checkpoint)?.finish()
}

/// Hands a checkpoint to the system, which is quick, without waiting for the disk. Then the particles may go on.
///
/// # Errors
/// As for [`write()`].
pub fn begin(path: &Path, checkpoint: &Checkpoint) -> Result<Unfinished, CheckpointError> {
    let lengths = checkpoint.columns.iter();
    check_columns(path, lengths.map(|column| (column.name.as_str(), column.data.len())))?;
    let folder = folder_of(path);
    let mut file =
        temporary_file(folder).map_err(CheckpointError::io(folder, "create a file in the folder"))?;
    fill(file.as_file_mut(), checkpoint).map_err(CheckpointError::io(path, "write the checkpoint"))?;
    Ok(Unfinished { file, path: path.to_path_buf() })
}

impl Unfinished {
    /// Waits until the checkpoint lies on the disk and gives it its name.
    ///
    /// # Errors
    /// Whatever the file system refuses.
    pub fn finish(self) -> Result<(), CheckpointError> {
        let Unfinished { file, path } = self;
        file.as_file().sync_all().map_err(CheckpointError::io(&path, "write the checkpoint"))?;
        file.persist(&path)
            .map_err(|error| CheckpointError::io(&path, "rename the finished file")(error.error))?;
        let folder = folder_of(&path);
        flush_folder(folder).map_err(CheckpointError::io(folder, "flush the folder to the disk"))
    }
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(UNFINISHED);
    // Results are for colleagues too: the usual permissions, not the private ones of a temporary
    // file.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

fn fill(file: &mut File, checkpoint: &Checkpoint) -> io::Result<()> {
    let Checkpoint { clock, scene, revision, columns } = checkpoint;
    let preface = Preface { clock: clock.clone(), scene: scene.clone(), revision: revision.clone() };
    let mut output = BufWriter::new(&mut *file);
    // Zeros hold the header's place until the checksums are known.
    output.write_all(&[0; HEADER_LENGTH])?;
    let header = Header {
        preface: write_section(&mut output, &preface)?,
        columns: write_section(&mut output, columns)?,
        scene_hash: xxh3_64(scene.as_bytes()),
        step: clock.step,
        time: clock.time,
        step_size: clock.step_size,
        revision: revision.clone(),
    };
    output.flush()?;
    drop(output);
    file.rewind()?;
    file.write_all(&header.encode())
}

/// Streams one archive and its padding.
fn write_section<W: Write>(
    output: W,
    value: &impl for<'a> Serialize<HighSerializer<IoWriter<Hashed<W>>, ArenaHandle<'a>, BoxedError>>,
) -> io::Result<Section> {
    let hashed = Hashed { inner: output, hasher: Xxh3::new(), length: 0 };
    let mut hashed =
        to_bytes_in::<_, BoxedError>(value, IoWriter::new(hashed)).map_err(io::Error::other)?.into_inner();
    let length = hashed.length;
    let padding = length.next_multiple_of(HEADER_LENGTH as u64) - length;
    hashed.write_all(&[0; HEADER_LENGTH][..padding as usize])?;
    Ok(Section { length, checksum: hashed.hasher.digest() })
}

/// Passes bytes on, counting and hashing them.
struct Hashed<W> {
    inner: W,
    hasher: Xxh3,
    length: u64,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = self.inner.write(bytes)?;
        self.hasher.update(&bytes[..taken]);
        self.length += taken as u64;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(unix)]
fn flush_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn flush_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}
