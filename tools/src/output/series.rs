//! `series.csv`: what was measured, row by row, as the run went on.
//!
//! The first column is `step`; every other column's header carries its unit,
//! as in `time [s]`. Numbers are printed with as many digits as they need to
//! be read back bit for bit. A row ends with its line feed: what follows the
//! last one was cut off and is no row.

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use super::atomic::{read_text, write_atomic};
use super::units::{labelled, split_label};
use super::{OutputError, OutputResult};

/// How every run's series begins.
const HEAD: &[u8] = b"step,time [s]";

/// A measured quantity and its unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// What is measured: "time".
    pub name: String,
    /// Its SI unit; empty for a plain number.
    pub unit: String,
}

/// The measured values of one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the step after which the values were taken.
    pub step: u64,
    /// One value for each column.
    pub values: Vec<f64>,
}

/// A whole series, read back.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// The columns after `step`.
    pub columns: Vec<Column>,
    /// The rows in the order in which they were written.
    pub rows: Vec<Row>,
}

impl Series {
    /// All values of the column called `name`.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.columns.iter().position(|column| column.name == name)?;
        Some(self.rows.iter().map(|row| row.values[index]).collect())
    }

    /// The steps before and after the first hole in what should be a row every so many steps, from the first row on to
    /// `last_step`. (A series may begin late: where its file was removed, the resumed run begins it anew.)
    pub fn hole(&self, every: u64, last_step: u64) -> Option<(u64, u64)> {
        let steps = self.rows.iter().map(|row| row.step).filter(|step| *step <= last_step);
        let next = (last_step - last_step % every).saturating_add(every);
        let steps: Vec<u64> = steps.chain([next]).collect();
        steps
            .windows(2)
            .map(|pair| (pair[0], pair[1]))
            .find(|(before, after)| before.checked_add(every) != Some(*after))
    }
}

/// Appends rows to `series.csv`; each is on its way to the disk at once.
#[derive(Debug)]
pub struct SeriesWriter {
    file: File,
    path: PathBuf,
    columns: usize,
}

impl SeriesWriter {
    /// Starts a new series with the given (name, unit) columns; `step` comes
    /// first by itself.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn create(path: &Path, columns: &[(&str, &str)]) -> OutputResult<Self> {
        let columns: Vec<Column> = columns
            .iter()
            .map(|(name, unit)| Column { name: (*name).to_owned(), unit: (*unit).to_owned() })
            .collect();
        rewrite(path, &columns, &[])?;
        Self::append_to(path, columns.len())
    }

    /// Continues a series after its row of `last_step`; later rows, which the
    /// resumed run will make again, are dropped.
    ///
    /// # Errors
    /// When the file is missing, unreadable or no series.
    pub fn open_for_resume(path: &Path, last_step: u64) -> OutputResult<Self> {
        let Series { columns, mut rows } = read(path)?;
        rows.retain(|row| row.step <= last_step);
        rewrite(path, &columns, &rows)?;
        Self::append_to(path, columns.len())
    }

    fn append_to(path: &Path, columns: usize) -> OutputResult<Self> {
        let file = OpenOptions::new().append(true).open(path).map_err(OutputError::file("open", path))?;
        Ok(Self { file, path: path.to_path_buf(), columns })
    }

    /// The file, to bring on the disk what was appended so far.
    ///
    /// # Errors
    /// When the system has no handle left.
    pub fn file(&self) -> OutputResult<File> {
        self.file.try_clone().map_err(OutputError::file("open", &self.path))
    }

    /// Appends one row.
    ///
    /// # Errors
    /// When the number of values is not that of the columns, or the file
    /// cannot be written.
    pub fn append(&mut self, step: u64, values: &[f64]) -> OutputResult<()> {
        if values.len() != self.columns {
            let problem = format!("a row of {} values for {} columns", values.len(), self.columns);
            return Err(OutputError::data(&self.path, problem));
        }
        // One write a row, so that rows are never torn between two of them.
        encode_row(step, values)
            .and_then(|line| self.file.write_all(&line))
            .map_err(OutputError::file("write", &self.path))
    }
}

/// Whether a file begins as a run's series does.
pub(super) fn begins(path: &Path) -> bool {
    let mut head = [0; HEAD.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok() && head == *HEAD
}

/// Reads a series back.
///
/// # Errors
/// When the file is missing or no series; the sentence names the row.
pub fn read(path: &Path) -> OutputResult<Series> {
    let mut text = read_text(path)?;
    text.truncate(text.rfind('\n').map_or(0, |end| end + 1));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let wrong = |error: csv::Error| OutputError::content(path, error.to_string());
    let headers = reader.headers().map_err(wrong)?.clone();
    if headers.get(0) != Some("step") {
        return Err(OutputError::content(path, "the first column is not `step`"));
    }
    let columns = headers.iter().skip(1).map(|header| {
        let (name, unit) = split_label(header);
        Column { name: name.to_owned(), unit: unit.to_owned() }
    });
    let columns = columns.collect();
    let rows = reader
        .records()
        .enumerate()
        .map(|(index, record)| {
            let record = record.map_err(wrong)?;
            decode_row(&record).ok_or_else(|| {
                let problem = format!("row {} is not all numbers", index + 1);
                OutputError::content(path, problem)
            })
        })
        .collect::<OutputResult<_>>()?;
    Ok(Series { columns, rows })
}

fn rewrite(path: &Path, columns: &[Column], rows: &[Row]) -> OutputResult<()> {
    write_atomic(path, |file| {
        let headers = columns.iter().map(|column| labelled(&column.name, &column.unit));
        let headers: Vec<String> = std::iter::once("step".to_owned()).chain(headers).collect();
        file.write_all(&encode(&headers)?)?;
        for row in rows {
            file.write_all(&encode_row(row.step, &row.values)?)?;
        }
        Ok(())
    })
}

fn encode_row(step: u64, values: &[f64]) -> std::io::Result<Vec<u8>> {
    let mut fields = vec![step.to_string()];
    // Debug formatting is the shortest that reads back bit for bit, with an
    // exponent where the plain digits would be many.
    fields.extend(values.iter().map(|value| format!("{value:?}")));
    encode(&fields)
}

fn encode(fields: &[String]) -> std::io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(fields)?;
    writer.into_inner().map_err(|error| std::io::Error::other(error.to_string()))
}

fn decode_row(record: &csv::StringRecord) -> Option<Row> {
    let step = record.get(0)?.parse().ok()?;
    let values = record.iter().skip(1).map(|field| field.parse().ok());
    Some(Row { step, values: values.collect::<Option<_>>()? })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const COLUMNS: [(&str, &str); 3] = [("time", "s"), ("kinetic energy", "J"), ("shape", "1")];

    fn values(step: u64) -> [f64; 3] {
        let time = step as f64 * 1.0e-7 / 3.0;
        [time, (time * 1e6).sin() * 1e-19, f64::MIN_POSITIVE / 7.0]
    }

    fn written(path: &Path, steps: u64) -> SeriesWriter {
        let mut writer = SeriesWriter::create(path, &COLUMNS).unwrap();
        for step in 0..steps {
            writer.append(step, &values(step)).unwrap();
        }
        writer
    }

    #[test]
    fn numbers_come_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let mut writer = written(&path, 50);
        let special = [f64::NAN, f64::INFINITY, -0.0];
        writer.append(50, &special).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.starts_with("step,time [s],kinetic energy [J],shape\n"), "{text}");
        let series = read(&path).unwrap();
        for (step, row) in series.rows.iter().enumerate().take(50) {
            assert_eq!((row.step, &row.values[..]), (step as u64, &values(step as u64)[..]));
        }
        let last = &series.rows[50].values;
        assert!(last[0].is_nan() && last[1] == f64::INFINITY && last[2].is_sign_negative());
        assert_eq!(series.columns[1], Column { name: "kinetic energy".into(), unit: "J".into() });
        assert_eq!(series.column("time").unwrap()[3], 1.0e-7);
        assert!(series.column("pressure").is_none());
    }

    #[test]
    fn a_resumed_series_equals_an_uninterrupted_one() {
        let folder = tempfile::tempdir().unwrap();
        let (whole, resumed) = (folder.path().join("whole"), folder.path().join("resumed"));
        drop(written(&whole, 40));
        drop(written(&resumed, 30));
        // A kill in the middle of a row leaves a number that is still one.
        let mut torn = OpenOptions::new().append(true).open(&resumed).unwrap();
        torn.write_all(b"30,1.0,2.").unwrap();
        let mut writer = SeriesWriter::open_for_resume(&resumed, 20).unwrap();
        assert_eq!(read(&resumed).unwrap().rows.last().unwrap().step, 20);
        for step in 21..40 {
            writer.append(step, &values(step)).unwrap();
        }
        assert_eq!(fs::read(&whole).unwrap(), fs::read(&resumed).unwrap());
    }

    #[test]
    fn holes_are_found() {
        let holes = |steps: &[u64], last| {
            let rows = steps.iter().map(|step| Row { step: *step, values: Vec::new() }).collect();
            Series { columns: Vec::new(), rows }.hole(10, last)
        };
        assert_eq!(holes(&[0, 10, 20], 25), None);
        assert_eq!(holes(&[0, 10, 20], 30), Some((20, 40)));
        assert_eq!(holes(&[0, 20, 30], 25), Some((0, 20)));
        assert_eq!(holes(&[90, 100], 100), None, "begun anew");
        assert_eq!(holes(&[90, 100], 85), None, "begun anew after the checkpoint");
    }

    #[test]
    fn mistakes_are_sentences() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        let mut writer = written(&path, 1);
        let error = writer.append(1, &[1.0]).unwrap_err().to_string();
        assert!(error.contains("1 values for 3 columns"), "{error}");
        for (text, expected) in [
            ("time [s],step\n0,1\n", "first column"),
            ("step,time [s]\n0,fast\n", "row 1"),
            ("step,time [s]\n0,1,2\n", "found record with 3 fields"),
            ("", "first column"),
        ] {
            fs::write(&path, text).unwrap();
            let error = read(&path).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        assert!(SeriesWriter::open_for_resume(&folder.path().join("none"), 0).is_err());
    }
}
