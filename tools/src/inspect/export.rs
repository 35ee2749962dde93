//! `meniscus inspect export`: all fields for other programs.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use meniscus_engine::checkpoint::ColumnView;

use super::columns::values;
use super::failure::{Failure, Verdict};
use super::open::{open, particles};
use super::print;
use crate::output::atomic::write_atomic;
use crate::output::units::labelled;
use crate::output::vtk::{Field, FieldData, write_vtp};

/// What to write, and where.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect export runs/drop drop.vtp      for ParaView: opens with all fields
  meniscus inspect export runs/drop drop.csv      a table with units in its head
  meniscus inspect export runs/drop drop.npy      numpy.load('drop.npy')['density']")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The file; its ending says what it becomes: .vtp, .csv or .npy
    #[arg(value_name = "FILE")]
    output: PathBuf,
    /// Replace a file of that name
    #[arg(long)]
    overwrite: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Refuses to write into no folder, or over a file that the user did not give up.
pub fn check_target(path: &Path, overwrite: bool) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        return Err(Failure::NoFolder { path: path.to_path_buf(), folder: folder.to_path_buf() });
    }
    match path.exists() && !overwrite {
        _ if path.is_dir() => Err(Failure::IsFolder { path: path.to_path_buf() }),
        true => Err(Failure::Exists { path: path.to_path_buf() }),
        false => Ok(()),
    }
}

/// Says where the result lies.
pub fn tell_written(path: &Path, as_json: bool, output: &mut dyn Write) -> io::Result<()> {
    match as_json {
        true => print::json(&serde_json::json!({ "file": path.display().to_string() }), output),
        false => writeln!(output, "{}", path.display()),
    }
}

type WriteColumns = fn(&Path, &[ColumnView<'_>]) -> Result<(), Failure>;

/// Writes the file.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let path = &arguments.output;
    let write: WriteColumns = match path.extension().and_then(|ending| ending.to_str()) {
        Some("vtp") => write_frame,
        Some("csv") => write_table,
        Some("npy") => write_array,
        _ => return Err(Failure::UnknownEnding { path: path.clone(), expected: ".vtp, .csv, .npy" }),
    };
    check_target(path, arguments.overwrite)?;
    let mapped = open(&arguments.checkpoint)?;
    write(path, &mapped.columns()?)?;
    tell_written(path, arguments.json, output)?;
    Ok(Verdict::Good)
}

fn write_frame(path: &Path, columns: &[ColumnView<'_>]) -> Result<(), Failure> {
    let (r, z) = (values(columns, "radius")?, values(columns, "axial")?);
    let mut reals: Vec<(ColumnView<'_>, Vec<f64>)> = Vec::new();
    let mut indices: Vec<(ColumnView<'_>, Vec<u32>)> = Vec::new();
    for column in columns {
        match column.is_integer() {
            true => indices.push((*column, column.values().map(|value| value as u32).collect())),
            false => reals.push((*column, column.values().collect())),
        }
    }
    let reals_of = |name: &str| reals.iter().find(|(column, _)| column.name() == name).map(|(_, v)| &v[..]);
    let mut fields: Vec<Field<'_>> = Vec::new();
    if let (Some(radial), Some(axial)) = (reals_of("velocity_r"), reals_of("velocity_z")) {
        fields.push(Field { name: "velocity", unit: "m/s", data: FieldData::Vector(radial, axial) });
    }
    let scalars = reals.iter().map(|(column, values)| (column, FieldData::Scalar(values)));
    let marks = indices.iter().map(|(column, values)| (column, FieldData::Index(values)));
    let all = scalars.chain(marks);
    fields.extend(all.map(|(column, data)| Field { name: column.name(), unit: column.unit(), data }));
    Ok(write_vtp(path, (&r, &z), &fields)?)
}

fn write_table(path: &Path, columns: &[ColumnView<'_>]) -> Result<(), Failure> {
    let write = |file: &mut dyn Write| -> io::Result<()> {
        let mut writer = csv::Writer::from_writer(file);
        let unit = |column: &ColumnView<'_>| if column.unit() == "1" { "" } else { column.unit() }.to_owned();
        writer.write_record(columns.iter().map(|column| labelled(column.name(), &unit(column))))?;
        for particle in 0..particles(columns) {
            let row = columns.iter().map(|column| match column.value(particle) {
                // All digits: what is read back is the same number.
                Some(value) if !column.is_integer() => format!("{value:?}"),
                Some(value) => format!("{value}"),
                None => String::new(),
            });
            writer.write_record(row)?;
        }
        writer.flush()
    };
    Ok(write_atomic(path, |file| write(file))?)
}

/// One record a particle, in numpy's own format (version 1.0): magic, length of the head, the head as a
/// Python literal padded to 64 bytes, then the records without gaps.
fn write_array(path: &Path, columns: &[ColumnView<'_>]) -> Result<(), Failure> {
    let names = columns.iter().map(|column| {
        let kind = if column.is_integer() { "<u4" } else { "<f8" };
        format!("('{}', '{kind}')", column.name())
    });
    let (names, count): (Vec<String>, _) = (names.collect(), particles(columns));
    let head = format!("{{'descr': [{}], 'fortran_order': False, 'shape': ({count},), }}", names.join(", "));
    let start = 10 + head.len() + 1;
    let padded = start.next_multiple_of(64) - 10;
    let Ok(length) = u16::try_from(padded) else {
        let problem = "its fields have too long names for this format";
        return Err(crate::output::OutputError::data(path, problem).into());
    };
    Ok(write_atomic(path, |file| {
        file.write_all(b"\x93NUMPY\x01\x00")?;
        file.write_all(&length.to_le_bytes())?;
        writeln!(file, "{head:<width$}", width = padded - 1)?;
        for particle in 0..count {
            for column in columns {
                let value = column.value(particle).unwrap_or(f64::NAN);
                match column.is_integer() {
                    true => file.write_all(&(value as u32).to_le_bytes())?,
                    false => file.write_all(&value.to_le_bytes())?,
                }
            }
        }
        Ok(())
    })?)
}
