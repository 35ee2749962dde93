//! Particles for ParaView: `.vtp` frames (PolyData, appended raw binary,
//! little endian) and the `.pvd` file that lists them by time.
//!
//! The section lies in the plane of the screen: x is r, y is z, both in
//! metres. An array's name carries its unit, which ParaView then shows.

use std::io::{self, Write};
use std::path::Path;

use super::atomic::write_atomic;
use super::units::labelled;
use super::{OutputError, OutputResult};

/// The values of one field, one entry for each particle.
#[derive(Debug, Clone, Copy)]
pub enum FieldData<'a> {
    /// One number.
    Scalar(&'a [f64]),
    /// The radial and the axial component.
    Vector(&'a [f64], &'a [f64]),
    /// A whole number, such as a material or a flag.
    Index(&'a [u32]),
}

/// A field of the particles.
#[derive(Debug, Clone, Copy)]
pub struct Field<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its SI unit; empty for a plain number.
    pub unit: &'a str,
    /// Its values.
    pub data: FieldData<'a>,
}

/// One array of the file: a field, or one end of the numbering of the points.
#[derive(Clone, Copy)]
enum Content<'a> {
    Field(FieldData<'a>),
    /// The whole numbers from this one on, one for each particle.
    CountFrom(u32),
}

struct Array<'a> {
    name: String,
    content: Content<'a>,
}

/// Writes the particles as one frame, all of it or nothing.
///
/// `points` are the coordinates (r, z) in metres.
///
/// # Errors
/// When a field's length is not that of the points, or the file cannot be
/// written.
pub fn write_vtp(path: &Path, points: (&[f64], &[f64]), fields: &[Field<'_>]) -> OutputResult<()> {
    let count = points.0.len();
    let positions = FieldData::Vector(points.0, points.1);
    if u32::try_from(count).is_err() {
        return Err(OutputError::data(path, format!("{count} particles are too many")));
    }
    if !positions.has_length(count) {
        return Err(OutputError::data(path, "r and z differ in length"));
    }
    if let Some(field) = fields.iter().find(|field| !field.data.has_length(count)) {
        let problem = format!("`{}` has not one value for each of {count} particles", field.name);
        return Err(OutputError::data(path, problem));
    }
    let array = |name: String, content| Array { name, content };
    let fields: Vec<Array<'_>> = fields
        .iter()
        .map(|field| array(labelled(field.name, field.unit), Content::Field(field.data)))
        .collect();
    let positions = [array("position [m]".into(), Content::Field(positions))];
    let vertices =
        [array("connectivity".into(), Content::CountFrom(0)), array("offsets".into(), Content::CountFrom(1))];
    let sections = [("PointData", &fields[..]), ("Points", &positions[..]), ("Verts", &vertices[..])];
    write_atomic(path, |out| write_sections(out, count, &sections))
}

/// Writes the list of frames, all of it or nothing.
///
/// `frames` are (time in seconds, path of the frame relative to this file).
///
/// # Errors
/// When the file cannot be written.
pub fn write_pvd(path: &Path, frames: &[(f64, String)]) -> OutputResult<()> {
    write_atomic(path, |out| {
        writeln!(out, r#"<?xml version="1.0"?>"#)?;
        writeln!(out, r#"<VTKFile type="Collection" version="0.1">"#)?;
        writeln!(out, "  <Collection>")?;
        for (time, file) in frames {
            let file = escaped(file);
            writeln!(out, r#"    <DataSet timestep="{time:?}" file="{file}"/>"#)?;
        }
        writeln!(out, "  </Collection>\n</VTKFile>")
    })
}

fn write_sections(out: &mut impl Write, count: usize, sections: &[(&str, &[Array<'_>])]) -> io::Result<()> {
    write!(
        out,
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <PolyData>\n\
         <Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n"
    )?;
    let mut offset = 0;
    for (section, arrays) in sections {
        writeln!(out, "<{section}>")?;
        for array in *arrays {
            let (kind, components) = array.content.layout();
            let name = escaped(&array.name);
            writeln!(
                out,
                "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
                 format=\"appended\" offset=\"{offset}\"/>"
            )?;
            offset += size_of::<u64>() + array.content.bytes(count);
        }
        writeln!(out, "</{section}>")?;
    }
    write!(out, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_")?;
    for array in sections.iter().flat_map(|(_, arrays)| *arrays) {
        out.write_all(&(array.content.bytes(count) as u64).to_le_bytes())?;
        array.content.write(out, count)?;
    }
    writeln!(out, "\n</AppendedData>\n</VTKFile>")
}

impl FieldData<'_> {
    fn has_length(&self, count: usize) -> bool {
        match self {
            Self::Scalar(values) => values.len() == count,
            Self::Vector(radial, axial) => radial.len() == count && axial.len() == count,
            Self::Index(values) => values.len() == count,
        }
    }
}

impl Content<'_> {
    /// Type of a number and numbers per particle. ParaView knows vectors of
    /// three only; the third component is zero.
    fn layout(self) -> (&'static str, usize) {
        match self {
            Self::Field(FieldData::Scalar(_)) => ("Float64", 1),
            Self::Field(FieldData::Vector(..)) => ("Float64", 3),
            Self::Field(FieldData::Index(_)) | Self::CountFrom(_) => ("UInt32", 1),
        }
    }

    fn bytes(self, count: usize) -> usize {
        match self.layout() {
            ("Float64", components) => size_of::<f64>() * components * count,
            (_, components) => size_of::<u32>() * components * count,
        }
    }

    fn write(self, out: &mut impl Write, count: usize) -> io::Result<()> {
        match self {
            Self::Field(FieldData::Scalar(values)) => {
                values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
            }
            Self::Field(FieldData::Vector(radial, axial)) => {
                radial.iter().zip(axial).try_for_each(|(radial, axial)| {
                    out.write_all(&radial.to_le_bytes())?;
                    out.write_all(&axial.to_le_bytes())?;
                    out.write_all(&0f64.to_le_bytes())
                })
            }
            Self::Field(FieldData::Index(values)) => {
                values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))
            }
            Self::CountFrom(first) => {
                (0..count as u32).try_for_each(|index| out.write_all(&(first + index).to_le_bytes()))
            }
        }
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests;
