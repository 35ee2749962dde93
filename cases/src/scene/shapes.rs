//! Reading shapes.

use super::body::{SAMPLES, not_finite};
use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::{LENGTH, Short};
use super::section::Section;
use crate::shape::{LevelSet, Polygon, Shape};
use std::sync::Arc;

const KINDS: [&str; 10] = [
    "sphere",
    "spheroid",
    "cylinder",
    "annulus",
    "torus",
    "polygon",
    "expression",
    "union",
    "intersection",
    "difference",
];

/// Reads a shape; `origin` is the radius of the scene's r = 0.
///
/// # Errors
/// Mistakes in its values, and a shape without area.
pub(super) fn read(entry: Entry<'_>, origin: f64) -> Result<Shape, Fault> {
    let whole = entry.clone();
    let entry = entry.variant(&KINDS, "{ sphere = { radius = \"2.5 um\", centre = \"0 m\" } }")?;
    let kind = entry.key().to_owned();
    if origin > 0.0 && matches!(kind.as_str(), "sphere" | "spheroid" | "cylinder") {
        let message = format!("a {kind} sits on the axis, which here is at r = -{origin} m");
        return Err(
            entry.fault(message, "with an `origin` in [domain] use annulus, torus, polygon or expression")
        );
    }
    let shape = match kind.as_str() {
        "polygon" => polygon(entry, origin)?,
        "expression" => expression(entry, origin)?,
        "union" => Shape::Union(parts(&entry, origin)?),
        "intersection" => Shape::Intersection(parts(&entry, origin)?),
        "difference" => Shape::Difference(parts(&entry, origin)?),
        _ => primitive(entry, origin)?,
    };
    if shape.moments()[0] > 0.0 {
        return Ok(shape);
    }
    let help = match kind.as_str() {
        "intersection" => "its parts have nothing in common: move them together",
        "difference" => "the first part is taken away entirely by the others",
        "expression" => "the expression must be negative inside the body, somewhere within the bounds",
        _ => "give it an area at r >= 0",
    };
    Err(whole.fault(format!("the {kind} is empty"), help))
}

fn parts(entry: &Entry<'_>, origin: f64) -> Result<Vec<Shape>, Fault> {
    let example = "[{ sphere = { radius = \"2 um\" } }, { torus = { major = \"3 um\", minor = \"1 um\" } }]";
    let listed = entry.elements(example)?;
    if listed.is_empty() {
        let message = format!("the {} lists no shapes", entry.key());
        return Err(entry.fault(message, format!("write it like {example}")));
    }
    listed.into_iter().map(|part| read(part, origin)).collect()
}

fn primitive(entry: Entry<'_>, origin: f64) -> Result<Shape, Fault> {
    let kind = entry.key().to_owned();
    let keys: &[&str] = match kind.as_str() {
        "sphere" => &["radius", "centre"],
        "spheroid" => &["radial", "axial", "centre"],
        "cylinder" => &["radius", "bottom", "top"],
        "annulus" => &["inner", "outer", "bottom", "top"],
        _ => &["major", "minor", "centre"],
    };
    let table = Section::new(entry, keys)?;
    let find = |key: &str| table.required(key, &format!("{key} = \"2.5 um\""));
    let size = |key: &str| find(key)?.positive(LENGTH);
    let position = |key: &str| find(key)?.quantity(LENGTH);
    let centre = || table.read_or("centre", 0.0, |entry| entry.quantity(LENGTH));
    let above = |key: &str, low: &str| {
        let (least, place) = (position(low)?, find(key)?);
        let value = place.quantity(LENGTH)?;
        if value > least {
            return Ok((least, value));
        }
        let message = format!("`{key}` is {} m: it must lie above `{low}`", Short(value));
        Err(place.fault(message, format!("`{low}` is {} m: choose more, or a lower `{low}`", Short(least))))
    };
    Ok(match kind.as_str() {
        "sphere" => Shape::Sphere { radius: size("radius")?, centre: centre()? },
        "spheroid" => Shape::Spheroid { radial: size("radial")?, axial: size("axial")?, centre: centre()? },
        "cylinder" => {
            let (radius, (bottom, top)) = (size("radius")?, above("top", "bottom")?);
            Shape::Cylinder { radius, bottom, top }
        }
        "annulus" => {
            if origin == 0.0 {
                find("inner")?.not_negative(LENGTH)?;
            }
            let ((inner, outer), (bottom, top)) = (above("outer", "inner")?, above("top", "bottom")?);
            match origin == 0.0 && inner == 0.0 {
                true => Shape::Cylinder { radius: outer, bottom, top },
                false => Shape::Annulus { inner, outer, bottom, top },
            }
        }
        _ => {
            let (major, minor, centre) = (position("major")?, size("minor")?, centre()?);
            let torus = Shape::Torus { major, minor, centre };
            if origin > 0.0 || major >= minor {
                return Ok(torus);
            }
            if major < 0.0 {
                return find("major")?.not_negative(LENGTH).map(|_| torus);
            }
            // The part at r >= 0 of a disc that reaches across the axis.
            let half = Shape::Cylinder { radius: major + minor, bottom: centre - minor, top: centre + minor };
            Shape::Intersection(vec![torus, half])
        }
    })
}

fn polygon(entry: Entry<'_>, origin: f64) -> Result<Shape, Fault> {
    const EXAMPLE: &str = "points = [[\"0 um\", \"0 um\"], [\"1 um\", \"0 um\"], [\"0 um\", \"2 um\"]]";
    let place = Section::new(entry, &["points"])?.required("points", EXAMPLE)?;
    let point = |corner: Entry<'_>| match corner.elements("[\"1 um\", \"0 um\"]")?.as_slice() {
        [r, z] => Ok([r.quantity(LENGTH)?, z.quantity(LENGTH)?]),
        _ => Err(corner.fault("a point has two coordinates, r and z", "write it like [\"1 um\", \"0 um\"]")),
    };
    let points = place.elements(EXAMPLE)?.into_iter().map(point).collect::<Result<Vec<_>, _>>()?;
    if points.len() < 3 {
        return Err(place.fault("a polygon has at least three points", format!("write it like {EXAMPLE}")));
    }
    if let Some([first, second]) = Polygon::crossing(&points) {
        let message = format!("the polygon crosses itself: its edges {} and {} meet", first + 1, second + 1);
        return Err(place.fault(message, "list the points in order around the outline, the first one once"));
    }
    Ok(Shape::Polygon(if origin > 0.0 { Polygon::new(points) } else { Polygon::cut_at_axis(&points) }))
}

fn expression(entry: Entry<'_>, origin: f64) -> Result<Shape, Fault> {
    const BOUNDS: &str = "bounds = [\"0 um\", \"3 um\", \"-3 um\", \"3 um\"]";
    let table = Section::new(entry, &["inside", "bounds"])?;
    let inside = table.required("inside", "inside = \"r^2 + z^2 - radius^2\"")?;
    let formula = inside.field(None)?;
    let place = table.required("bounds", BOUNDS)?;
    let limits =
        place.elements(BOUNDS)?.iter().map(|limit| limit.quantity(LENGTH)).collect::<Result<Vec<_>, _>>()?;
    let &[r_min, r_max, z_min, z_max] = limits.as_slice() else {
        return Err(place.fault(
            "bounds are four lengths: lowest and highest r, lowest and highest z",
            format!("write {BOUNDS}"),
        ));
    };
    let r_min = if origin > 0.0 { r_min } else { r_min.max(0.0) };
    if r_min >= r_max || z_min >= z_max {
        return Err(place.fault("the bounds are empty: the lower one comes first", format!("write {BOUNDS}")));
    }
    let frame = Shape::Annulus { inner: r_min, outer: r_max, bottom: z_min, top: z_max };
    if let Some(point) = frame.interior_points(SAMPLES).find(|[r, z]| formula.at(*r, *z).is_nan()) {
        return Err(not_finite(&inside, &formula, point));
    }
    let field = Arc::new(move |r: f64, z: f64| formula.at(r, z));
    Ok(Shape::Expression(LevelSet::new(field, [r_min, r_max, z_min, z_max], origin == 0.0)))
}
