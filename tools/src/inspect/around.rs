//! What lies around particles: neighbours, the surface; and why a run broke down.

use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::crash::Crash;
use meniscus_engine::checkpoint::{Clock, ColumnView};

use super::columns::{column, sizes, values};
use super::print::number;

/// Value of the field `surface` at the boundary.
pub const AT_BOUNDARY: f64 = 2.0;

/// Why the run of a crash checkpoint broke down, in sentences; none for a run that was well.
pub fn explain(clock: &Clock, columns: &[ColumnView<'_>], scene: Option<&Scene>) -> Option<String> {
    let Crash { stage, quantity, value, particle, place, step } = Crash::told_by(clock)?;
    let unit = column(columns, &quantity).map_or(String::new(), |column| format!(" {}", column.unit()));
    let unit = match unit.trim() {
        "1" => String::new(),
        _ if quantity.ends_with("time step") => " s".to_owned(),
        _ => unit,
    };
    let [r, z] = place.map(number);
    let became = match value {
        value if value.is_nan() => "became no number (NaN)".to_owned(),
        value if value.is_infinite() => "became infinite".to_owned(),
        value if value <= 0.0 && (quantity == "density" || quantity == "radius") => {
            format!("fell to {}{unit}, below 0", number(value))
        }
        value => format!("became {}{unit}", number(value)),
    };
    let mut text = format!(
        "{quantity} of particle {particle} at r = {r} m, z = {z} m {became} in stage {stage} at step {step}; \
         the last good step is {step}, t = {} s",
        number(clock.time)
    );
    if let Some(surroundings) = surroundings(columns, scene, particle) {
        text.push_str(&surroundings);
    }
    Some(text)
}

/// Neighbours and the nearest surface of a particle, as the neighbour list last saw them: where it was
/// before it went bad.
fn surroundings(columns: &[ColumnView<'_>], scene: Option<&Scene>, identity: u32) -> Option<String> {
    let index = column(columns, "identity")?.values().position(|other| other == f64::from(identity))?;
    let [r, z, reach] = ["list_radius", "list_axial", "list_reach"].map(|name| values(columns, name));
    let (r, z, reach) = (r.ok()?, z.ok()?, reach.ok()?);
    let distance = |other: usize| (r[other] - r[index]).hypot(z[other] - z[index]);
    let others = || (0..r.len()).filter(|&other| other != index);
    let neighbours = others().filter(|&other| distance(other) < reach[index] + reach[other]).count();
    let mut text = format!("; {neighbours} neighbours in its support");
    let size = sizes(columns, scene).ok()?;
    let mut sound: Vec<f64> = size.into_iter().filter(|size| size.is_finite()).collect();
    sound.sort_unstable_by(f64::total_cmp);
    let typical = sound.get(sound.len() / 2).copied()?;
    let surface = column(columns, "surface")?;
    if surface.value(index) == Some(AT_BOUNDARY) {
        text.push_str("; it lies at the surface");
    } else {
        let boundary = others().filter(|&other| surface.value(other) == Some(AT_BOUNDARY));
        if let Some(nearest) = boundary.map(distance).min_by(f64::total_cmp) {
            text.push_str(&format!(
                "; nearest surface particle {} particle sizes away",
                number(nearest / typical)
            ));
        }
    }
    let from_axis = (r[index] + scene.map_or(0.0, |scene| scene.domain.origin)) / typical;
    text.push_str(&format!("; {} particle sizes from the axis", number(from_axis)));
    Some(text)
}
