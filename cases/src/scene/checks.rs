//! What must hold between the parts of a scene.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::Short;
use super::{Body, EquationOfState, Flux, Scene};
use crate::region::Region;

/// Where the parts stand that may be to blame.
pub(super) struct Places<'a> {
    /// The bodies' shapes.
    pub(super) shapes: &'a [Entry<'a>],
    /// The particle size.
    pub(super) size: &'a Entry<'a>,
    /// The sound speed, or the table that lacks it.
    pub(super) sound_speed: Entry<'a>,
    /// The viscosity, or the table that lacks it.
    pub(super) viscosity: Entry<'a>,
}

/// Particles that must fit into the smallest extent of every body.
const FEWEST_PARTICLES: f64 = 10.0;

/// Numerical over physical viscosity that is worth a warning.
const NOTABLE: f64 = 0.1;

/// Keeps advice on the safe side of its limit after rounding to five digits.
const ROUNDING: f64 = 0.9999;

/// Heights at which two bodies are compared.
const LINES: usize = 256;

/// Checks a scene as a whole and hands back the doubts about it.
pub(super) fn check(scene: &Scene, places: &Places<'_>) -> Result<Vec<Fault>, Fault> {
    for (body, place) in scene.bodies.iter().zip(places.shapes) {
        check_resolution(scene, body, places.size)?;
        check_period(scene, body, place)?;
    }
    for (index, first) in scene.bodies.iter().enumerate() {
        for (second, place) in scene.bodies.iter().zip(places.shapes).skip(index + 1) {
            if let Some([r, z]) = common_point(first, second) {
                let message = format!("this body overlaps another one at r = {r:.3e} m, z = {z:.3e} m");
                return Err(
                    place.fault(message, "move the bodies apart, or make them one body with a `union`")
                );
            }
        }
    }
    let mut doubts = check_sound_speed(scene, &places.sound_speed)?;
    doubts.extend(doubt_of_viscosity(scene, &places.viscosity));
    Ok(doubts)
}

fn check_resolution(scene: &Scene, body: &Body, size: &Entry<'_>) -> Result<(), Fault> {
    let extent = body.shape.smallest_extent();
    let fitting = extent / scene.particle_size;
    // A tenth, but for the rounding of the division.
    if fitting > FEWEST_PARTICLES * (1.0 - 1e-12) {
        return Ok(());
    }
    let message = format!(
        "the particles are too large: fewer than {FEWEST_PARTICLES} ({}) fit across the body's smallest extent, {} m",
        Short(fitting),
        Short(extent)
    );
    let help = format!("choose a particle size of {} m or less", Short(ROUNDING * extent / FEWEST_PARTICLES));
    Err(size.fault(message, help))
}

fn check_period(scene: &Scene, body: &Body, place: &Entry<'_>) -> Result<(), Fault> {
    let [_, _, bottom, top] = body.shape.bounds();
    match scene.domain.period {
        Some(period) if top - bottom > period * (1.0 + 1e-12) => {
            let message = format!(
                "the body is {} m high, more than the period of {} m",
                Short(top - bottom),
                Short(period)
            );
            Err(place.fault(message, "a body must fit into one `period` of [domain]"))
        }
        _ => Ok(()),
    }
}

/// A point inside both bodies, if a line of the grid finds one.
fn common_point(first: &Body, second: &Body) -> Option<[f64; 2]> {
    let ([_, _, low, high], [_, _, other_low, other_high]) = (first.shape.bounds(), second.shape.bounds());
    let (bottom, top) = (low.max(other_low), high.min(other_high));
    let least = 1e-9 * first.shape.smallest_extent().min(second.shape.smallest_extent());
    if top - bottom <= least {
        return None;
    }
    (0..LINES).find_map(|line| {
        let z = bottom + (top - bottom) * (line as f64 + 0.5) / LINES as f64;
        let common = first.shape.chords(z).intersection(&second.shape.chords(z));
        common.iter().find(|[low, high]| high - low > least).map(|[low, high]| [0.5 * (low + high), z])
    })
}

fn check_sound_speed(scene: &Scene, place: &Entry<'_>) -> Result<Vec<Fault>, Fault> {
    if scene.liquid.equation_of_state != EquationOfState::Linear {
        // Shocks compress, and a gas knows its own speed.
        return Ok(Vec::new());
    }
    let (flow, capillary) = (scene.fastest_initial_speed(), scene.capillary_velocity());
    let help = "give [liquid] a sound_speed, at least ten times the fastest motion you expect";
    match scene.liquid.sound_speed {
        None if flow == 0.0 && capillary == 0.0 => {
            let message = "the sound speed cannot be derived: nothing moves and there is no surface tension";
            Err(place.fault(message, help))
        }
        Some(given) if given < 10.0 * flow.max(capillary) => {
            let (cause, speed) = if flow > capillary {
                ("fastest initial motion", flow)
            } else {
                ("capillary velocity", capillary)
            };
            let message = format!(
                "the sound speed of {} m/s is below ten times the {cause}, {} m/s: the liquid will be compressed",
                Short(given),
                Short(speed)
            );
            let help = format!("choose {} m/s or more, or \"auto\"", Short(10.0 * speed / ROUNDING));
            Ok(vec![place.fault(message, help)])
        }
        _ => Ok(Vec::new()),
    }
}

/// The first-order flux has a viscosity of its own, C H/16 with the support radius H = 4 theta D
/// (method.md, section 10, "Numerical viscosity of the first-order flux").
fn doubt_of_viscosity(scene: &Scene, place: &Entry<'_>) -> Option<Fault> {
    let physical = scene.liquid.viscosity;
    if physical == 0.0 || scene.method.flux != Flux::FirstOrder {
        return None;
    }
    let support = 4.0 * scene.method.theta * scene.particle_size;
    let numerical = scene.liquid.density * scene.derived_sound_speed() * support / 16.0;
    (numerical > NOTABLE * physical).then(|| {
        let (numerical, physical) = (Short(numerical), Short(physical));
        let message = format!(
            "the first-order flux adds a viscosity of {numerical} Pa s to the liquid's {physical} Pa s"
        );
        place.fault(message, "choose flux = \"reconstructed\" in [method], or smaller particles")
    })
}
