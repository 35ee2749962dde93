//! Writing a file so that a reader sees the whole of it or nothing.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::{OutputError, OutputResult};

/// Start of the names of files that are being written; one that is left over
/// belongs to a run that was killed.
pub(super) const UNFINISHED_PREFIX: &str = ".meniscus-unfinished-";

/// Writes `path` through a temporary file in the same folder, which takes the
/// place of `path` only when everything has reached the disk.
///
/// # Errors
/// When the folder cannot be written or `content` fails; `path` is then as it
/// was before.
pub(crate) fn write_atomic(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> OutputResult<()> {
    replace(path, content).map_err(OutputError::file("write", path))
}

/// Reads a text.
///
/// # Errors
/// When the file cannot be read, or is no text.
pub(crate) fn read_text(path: &Path) -> OutputResult<String> {
    let bytes = std::fs::read(path).map_err(OutputError::file("read", path))?;
    String::from_utf8(bytes).map_err(|error| OutputError::content(path, format!("no text: {error}")))
}

fn replace(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED_PREFIX);
    // A temporary file is private by default; a result is as readable as any
    // other file of the user.
    #[cfg(unix)]
    let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o666);
    #[cfg(unix)]
    builder.permissions(permissions);
    // The error's own text names the temporary file, which is nobody's concern.
    let temporary = builder.tempfile_in(folder).map_err(|error| io::Error::from(error.kind()))?;
    let (file, temporary_path) = temporary.into_parts();
    let mut writer = BufWriter::with_capacity(1 << 18, file);
    content(&mut writer)?;
    writer.flush()?;
    writer.get_ref().sync_all()?;
    temporary_path.persist(path)?;
    // The rename itself survives a power cut only once the folder is synced;
    // not every file system allows that, and the content is safe either way.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_debris() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        write_atomic(&path, |writer| writer.write_all(b"old")).unwrap();
        let failed = write_atomic(&path, |writer| {
            writer.write_all(b"half of the new")?;
            Err(io::Error::other("no space"))
        });
        let sentence = failed.unwrap_err().to_string();
        assert!(sentence.contains("summary.json") && sentence.contains("no space"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_is_as_readable_as_an_ordinary_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (ours, ordinary) = (folder.path().join("a"), folder.path().join("b"));
        write_atomic(&ours, |writer| writer.write_all(b"x")).unwrap();
        std::fs::write(&ordinary, b"x").unwrap();
        let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&ordinary));
    }
}
