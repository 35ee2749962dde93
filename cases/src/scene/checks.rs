//! What must hold between the parts of a scene.

use super::body::LIGHT;
use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::Short;
use super::suggest;
use super::{Body, EquationOfState, FOLLOWING, Flux, Measure, Scene, TimeIntegration};
use crate::assemble::{Physics, assemble};
use crate::packing::MOST_PARTICLES;
use crate::region::Region;
use std::f64::consts::PI;

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
    /// What colours the pictures, if the scene says so.
    pub(super) colour: Option<Entry<'a>>,
    /// The period, if the domain has one.
    pub(super) period: Option<Entry<'a>>,
    /// The measures.
    pub(super) measures: &'a [Entry<'a>],
    /// The time integration, or the flux that does not fit it, if the scene names one.
    pub(super) integration: Option<Entry<'a>>,
}

/// Particles that must fit into the smallest extent of every body.
const FEWEST_PARTICLES: f64 = 10.0;

/// Smallest extent of a body over its largest coordinate: so many digits are left for its particles. With less its volume
/// is off by more than a packing may be.
const FINEST: f64 = 1e-10;

/// Numerical over physical viscosity that is worth a warning.
const NOTABLE: f64 = 0.1;

/// Keeps advice on the safe side of its limit after rounding to five digits.
const ROUNDING: f64 = 0.9999;

/// Shortest period over the widest support at the start: particles grow, and their supports with them.
const PERIOD_SUPPORTS: f64 = 1.5;

/// How far the number of a jet's waves in a period may be from a whole one.
const WHOLE_WAVES: f64 = 1e-3;

/// Heights at which two bodies are compared.
const LINES: usize = 256;

/// Checks a scene as a whole and hands back the doubts about it.
pub(super) fn check(scene: &Scene, places: &Places<'_>) -> Result<Vec<Fault>, Fault> {
    check_colour(scene, places.colour.as_ref())?;
    check_period_support(scene, places.period.as_ref())?;
    for (body, place) in scene.bodies.iter().zip(places.shapes) {
        check_place(body, place)?;
        check_resolution(scene, body, places.size)?;
        check_period(scene, body, place)?;
    }
    for (index, first) in scene.bodies.iter().enumerate() {
        for (second, place) in scene.bodies.iter().zip(places.shapes).skip(index + 1) {
            for shift in shifts(scene, first, second) {
                if let Some([r, z]) = common_point(first, second, shift) {
                    let across = if shift == 0.0 { "" } else { ", across the period" };
                    let place_of = format!("at r = {r:.3e} m, z = {z:.3e} m{across}");
                    let help = match shift == 0.0 {
                        true => "move the bodies apart, or make them one body with a `union`",
                        false => "move the bodies apart, or choose a longer `period` in [domain]",
                    };
                    return Err(place.fault(format!("this body overlaps another one {place_of}"), help));
                }
            }
        }
    }
    let mut doubts = check_sound_speed(scene, &places.sound_speed)?;
    check_measures(scene, places.measures)?;
    doubts.extend(doubt_of_viscosity(scene, &places.viscosity));
    doubts.extend(places.integration.as_ref().and_then(|place| doubt_of_integration(scene, place)));
    Ok(doubts)
}

/// Pictures are coloured by what the scene's run has: a field of one of its stages, or what follows from fields.
fn check_colour(scene: &Scene, place: Option<&Entry<'_>>) -> Result<(), Fault> {
    // A pipeline that cannot be wired is told of where it is needed.
    let (Some(place), Ok(assembly)) = (place, assemble(&Physics::of(scene))) else {
        return Ok(());
    };
    let mut names: Vec<&str> = assembly.wiring.uses().iter().map(|used| used.field.name).collect();
    names.extend(FOLLOWING.map(|(name, _)| name));
    names.sort_unstable();
    names.dedup();
    let asked = scene.output.colour_by.as_str();
    if names.contains(&asked) {
        return Ok(());
    }
    let message = format!("`{}` knows no `{asked}`", place.path);
    Err(place.fault(message, suggest::help("fields of this scene", asked, &names)))
}

/// Far from z = 0 the numbers are too coarse for the body.
fn check_place(body: &Body, place: &Entry<'_>) -> Result<(), Fault> {
    let [_, farthest, bottom, top] = body.shape.bounds();
    let farthest = farthest.max(bottom.abs()).max(top.abs());
    if body.shape.smallest_extent() > FINEST * farthest {
        return Ok(());
    }
    let message = format!("the body lies too far from z = 0 for its size, at {} m", Short(farthest));
    Err(place.fault(message, "a number has sixteen digits: move the body nearer"))
}

fn check_resolution(scene: &Scene, body: &Body, size: &Entry<'_>) -> Result<(), Fault> {
    let extent = body.shape.smallest_extent();
    let fitting = extent / scene.particle_size;
    // A tenth, but for the rounding of the division.
    if fitting > FEWEST_PARTICLES * (1.0 - 1e-12) {
        return check_count(scene, body, size);
    }
    let message = format!(
        "the particles are too large: fewer than {FEWEST_PARTICLES} ({}) fit across the body's smallest extent, {} m",
        Short(fitting),
        Short(extent)
    );
    let help = format!("choose a particle size of {} m or less", Short(ROUNDING * extent / FEWEST_PARTICLES));
    Err(size.fault(message, help))
}

fn check_count(scene: &Scene, body: &Body, size: &Entry<'_>) -> Result<(), Fault> {
    let [area, _] = body.shape.moments();
    let count = area / scene.particle_size.powi(2);
    if count <= MOST_PARTICLES {
        return Ok(());
    }
    let message = format!(
        "the particles are too small: the body takes {} of them, more than {MOST_PARTICLES:e}",
        Short(count)
    );
    let least = (area / MOST_PARTICLES).sqrt() / ROUNDING;
    Err(size.fault(message, format!("choose a particle size of {} m or more", Short(least))))
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

/// A particle has one image at most to either side: sums over wide supports would miss the second ones.
fn check_period_support(scene: &Scene, place: Option<&Entry<'_>>) -> Result<(), Fault> {
    let (Some(period), Some(place)) = (scene.domain.period, place) else { return Ok(()) };
    let support = scene.method.widest_support(scene.liquid.surface_tension > 0.0);
    let reach = PERIOD_SUPPORTS * support * scene.particle_size;
    if period > reach * (1.0 - 1e-12) {
        return Ok(());
    }
    let message = format!(
        "the period of {} m is too short: it must be {PERIOD_SUPPORTS} times as long as the widest support, \
         {} particle sizes",
        Short(period),
        Short(support)
    );
    let help = format!("make it {} m or more, or choose smaller particles", Short(reach / ROUNDING));
    Err(place.fault(message, help))
}

/// How much higher the images of a second body stand that can overlap a first one.
fn shifts(scene: &Scene, first: &Body, second: &Body) -> Vec<f64> {
    let Some(period) = scene.domain.period else { return vec![0.0] };
    // Neither is higher than a period.
    let below = ((first.shape.bounds()[2] - second.shape.bounds()[2]) / period).floor();
    vec![below * period, (below + 1.0) * period]
}

/// A point inside both bodies, the second one so much higher, if a line of the grid finds one.
fn common_point(first: &Body, second: &Body, shift: f64) -> Option<[f64; 2]> {
    let ([_, _, low, high], [_, _, other_low, other_high]) = (first.shape.bounds(), second.shape.bounds());
    let (bottom, top) = (low.max(other_low + shift), high.min(other_high + shift));
    let least = 1e-9 * first.shape.smallest_extent().min(second.shape.smallest_extent());
    if top - bottom <= least {
        return None;
    }
    (0..LINES).find_map(|line| {
        let z = bottom + (top - bottom) * (line as f64 + 0.5) / LINES as f64;
        let common = first.shape.chords(z).intersection(&second.shape.chords(z - shift));
        common.iter().find(|[low, high]| high - low > least).map(|[low, high]| [0.5 * (low + high), z])
    })
}

/// What a run can never tell is not the fault of its length.
fn check_measures(scene: &Scene, places: &[Entry<'_>]) -> Result<(), Fault> {
    for (measure, place) in scene.measures.iter().zip(places) {
        if measure.needs_tension() && scene.liquid.surface_tension == 0.0 {
            let message = "this measure is about motion that surface tension drives, and there is none";
            return Err(place.fault(message, "give [liquid] a surface_tension, or leave the measure out"));
        }
        if let Some((message, help)) = never_told(scene, measure) {
            return Err(place.fault(message, help));
        }
    }
    Ok(())
}

/// Why a measure can't be told of a scene, and what to do.
fn never_told(scene: &Scene, measure: &Measure) -> Option<(String, &'static str)> {
    let period = scene.domain.period;
    let is_gas = matches!(scene.liquid.equation_of_state, EquationOfState::IdealGas { .. });
    let (message, help) = match *measure {
        Measure::Oscillation { from, .. } if from >= scene.until => {
            let (from, until) = (Short(from), Short(scene.until));
            let message =
                format!("the oscillation is to be fitted from {from} s on, but the run ends at {until} s");
            return Some((message, "choose an earlier `from`, or a later `until` in [run]"));
        }
        Measure::GrowthRate { wavenumber, radius } => {
            if wavenumber >= 1.0 {
                let message = format!("a wave of the wavenumber {} does not grow", Short(wavenumber));
                return Some((
                    message,
                    "choose a `wavenumber` below 1: a wave longer than the jet's circumference",
                ));
            }
            let waves = wavenumber * period? / (2.0 * PI * radius);
            if waves > 0.5 && (waves - waves.round()).abs() < WHOLE_WAVES {
                return None;
            }
            let message = format!("{} waves fit into the period of {} m", Short(waves), Short(period?));
            return Some((message, "make it a whole number: `wavenumber` times period/(2 pi radius)"));
        }
        Measure::EnergyDrift if scene.fastest_initial_speed() == 0.0 => (
            "`energy-drift` is relative to the kinetic energy at the start, and nothing moves then",
            "take `energy-gain`, or give a body a velocity",
        ),
        Measure::PinchOff { .. } if period.is_none() => (
            "`pinch-off` is about the thread of an endless jet, and this scene has no period",
            "give [domain] the period of the jet's wave",
        ),
        Measure::PlateauDensity { .. } if !is_gas => (
            "`plateau-density` is about the shock in a gas",
            "choose equation_of_state = \"ideal-gas\" in [liquid]",
        ),
        Measure::PlateauDensity { dimensions: 2, .. } if period.is_none() => (
            "`plateau-density` of a cylinder is that of an endless one, and this scene has no period",
            "give [domain] a period, the cylinder's height",
        ),
        _ => return None,
    };
    Some((message.to_owned(), help))
}

fn check_sound_speed(scene: &Scene, place: &Entry<'_>) -> Result<Vec<Fault>, Fault> {
    let speed = scene.derived_sound_speed();
    if speed > LIGHT {
        let message = format!("the sound speed is {} m/s: faster than light", Short(speed));
        let help = if scene.liquid.sound_speed.is_some() {
            "check its number and unit"
        } else {
            "it follows from the fastest motion, the surface tension and the internal energy: check their numbers and \
             units, or give [liquid] a sound_speed"
        };
        return Err(place.fault(message, help));
    }
    if scene.liquid.equation_of_state != EquationOfState::Linear {
        if speed == 0.0 {
            let message = "this gas has no heat and is at rest: nothing happens";
            return Err(place.fault(message, "give a body a velocity or an internal_energy"));
        }
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
            // "auto" looks ahead: it is ten times what waves can become.
            let help = format!(
                "choose {} m/s or more, or \"auto\", which is {} m/s here",
                Short(10.0 * speed / ROUNDING),
                Short(scene.automatic_sound_speed())
            );
            Ok(vec![place.fault(message, help)])
        }
        _ => Ok(Vec::new()),
    }
}

/// Euler's method makes waves grow, unless the first-order flux damps them.
fn doubt_of_integration(scene: &Scene, place: &Entry<'_>) -> Option<Fault> {
    let method = &scene.method;
    let undamped = method.time_integration == TimeIntegration::Euler && method.flux != Flux::FirstOrder;
    undamped.then(|| {
        let message =
            "the time integration \"euler\" needs the damping of the first-order flux: motion may grow";
        let help = "choose flux = \"first-order\", or time_integration = \"adams-bashforth\"";
        place.fault(message, help)
    })
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
