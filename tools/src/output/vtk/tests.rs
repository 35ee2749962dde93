use super::*;

/// The text after `marker`, up to the next quote.
fn attribute<'a>(text: &'a str, marker: &str) -> &'a str {
    let start = text.find(marker).unwrap() + marker.len();
    text[start..].split('"').next().unwrap()
}

/// The payload of the array of that name, found through its offset.
fn payload<'a>(file: &'a [u8], name: &str) -> &'a [u8] {
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let start = file.windows(marker.len()).position(|window| window == marker).unwrap();
    let header = std::str::from_utf8(&file[..start]).unwrap();
    let array = &header[header.find(&format!("Name=\"{name}\"")).unwrap()..];
    let offset: usize = attribute(array, "offset=\"").parse().unwrap();
    let block = &file[start + marker.len() + offset..];
    let length = u64::from_le_bytes(block[..8].try_into().unwrap()) as usize;
    &block[8..8 + length]
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap())).collect()
}

#[test]
fn every_array_is_where_its_offset_says() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frame.vtp");
    let (r, z) = ([0.5, 1.5, 2.5], [-1.0, 0.0, 1.0]);
    let (pressure, flag) = ([1e5, 2e5, 3e5], [0, 7, u32::MAX]);
    let field = |name, unit, data| Field { name, unit, data };
    let fields = [
        field("pressure", "Pa", FieldData::Scalar(&pressure)),
        field("velocity", "m/s", FieldData::Vector(&z, &r)),
        field("at <surface>", "", FieldData::Index(&flag)),
    ];
    write_vtp(&path, (&r, &z), &fields).unwrap();
    let file = std::fs::read(&path).unwrap();
    assert_eq!(numbers(payload(&file, "pressure [Pa]")), pressure);
    let velocity = [-1.0, 0.5, 0.0, 0.0, 1.5, 0.0, 1.0, 2.5, 0.0];
    assert_eq!(numbers(payload(&file, "velocity [m/s]")), velocity);
    assert_eq!(numbers(payload(&file, "position [m]"))[3..6], [1.5, 0.0, 0.0]);
    assert_eq!(payload(&file, "at &lt;surface&gt;")[8..], [0xff; 4]);
    assert_eq!(payload(&file, "offsets"), [1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0]);
    assert!(file.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
}

#[test]
fn a_field_of_another_length_is_named() {
    let path = Path::new("frame.vtp");
    let data = FieldData::Scalar(&[1.0]);
    let field = Field { name: "density", unit: "kg/m^3", data };
    let error = write_vtp(path, (&[0.0; 2], &[0.0; 2]), &[field]).unwrap_err();
    assert!(error.to_string().contains("`density`"), "{error}");
    let error = write_vtp(path, (&[0.0; 2], &[0.0; 3]), &[]).unwrap_err();
    assert!(error.to_string().contains("differ in length"), "{error}");
}

#[test]
fn frames_are_listed_by_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("particles.pvd");
    write_pvd(&path, &[(0.0, "frames/0.vtp".into()), (1e-7, "frames/a&b.vtp".into())]).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains(r#"timestep="0.0" file="frames/0.vtp""#), "{text}");
    assert!(text.contains(r#"timestep="1e-7" file="frames/a&amp;b.vtp""#), "{text}");
}
