//! What a scene compares with exact solutions.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::{Kind, LENGTH, NUMBER, RATE, SQUARED_RATE, Short, TIME, VELOCITY};
use super::section::Section;

/// What is compared with an exact solution at the end of a run. Lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// The pressure inside a drop at rest.
    LaplacePressure {
        /// Radius of the drop.
        radius: f64,
        /// Height z of its centre.
        centre: f64,
    },
    /// The period of an oscillating drop.
    Oscillation {
        /// Degree of the Legendre polynomial, at least 2.
        mode: u32,
        /// Radius of the sphere it oscillates about.
        radius: f64,
        /// Height z of its centre.
        centre: f64,
        /// Time in s from which on it is fitted.
        from: f64,
    },
    /// The speed of a drop that should rest.
    SpuriousVelocity {
        /// Radius of the drop.
        radius: f64,
    },
    /// Growth of a wave on a jet, and its break-up.
    GrowthRate {
        /// Wavenumber times the jet's radius.
        wavenumber: f64,
        /// Radius of the jet.
        radius: f64,
    },
    /// A film about a plane z = const whose two edges draw back.
    FilmRetraction {
        /// Thickness of the film.
        thickness: f64,
    },
    /// Largest change of the axial momentum.
    MomentumDrift,
    /// Largest change of the energy, relative to the kinetic energy at the start.
    EnergyDrift,
    /// Largest rise of the energy above the least that it had before, relative to that at the start.
    EnergyGain,
    /// The oscillation of a drop of an inviscid liquid that starts as a spheroid.
    LargeOscillation {
        /// Semi-axis across the axis of symmetry at the start.
        radial: f64,
        /// Semi-axis along it at the start.
        axial: f64,
        /// Speed in m/s of its flow (-r, 2 z) v/(2 R) at the pole of the sphere of the same volume.
        speed: f64,
    },
    /// How far two equal drops spread that meet head on.
    Spread {
        /// Radius of each of them.
        radius: f64,
        /// Speed of each of them in m/s.
        speed: f64,
    },
    /// The bridge between two drops that touch at z = 0.
    Coalescence {
        /// Radius of one.
        radius: f64,
        /// Radius of the other.
        other: f64,
    },
    /// How a jet of an inviscid liquid tears.
    PinchOff {
        /// Radius of the jet.
        radius: f64,
        /// Wavenumber k of its disturbance times that.
        wavenumber: f64,
        /// Speed v in m/s of the disturbance v sin(k z).
        speed: f64,
    },
    /// A spheroid that stretches and shrinks.
    SemiAxis {
        /// Semi-axis across the axis of symmetry at the start.
        radial: f64,
        /// Semi-axis along it at the start.
        axial: f64,
        /// Rate of axial strain at the start in 1/s.
        shear: f64,
        /// B^2 of the central force in 1/s2.
        stiffness: f64,
    },
    /// The density behind the shock of a converging stream of gas (Noh).
    PlateauDensity {
        /// 2 for a cylinder, 3 for a sphere.
        dimensions: u32,
        /// Speed of the stream in m/s.
        speed: f64,
    },
    /// The shock of two equal layers that meet at r = 0 of the scene.
    ShockSpeed {
        /// Speed of each of them in m/s.
        speed: f64,
        /// Thickness of each of them.
        length: f64,
    },
}

const KINDS: [(&str, &[&str]); 15] = [
    ("laplace-pressure", &["radius", "centre"]),
    ("oscillation", &["mode", "radius", "centre", "from"]),
    ("spurious-velocity", &["radius"]),
    ("growth-rate", &["wavenumber", "radius"]),
    ("film-retraction", &["thickness"]),
    ("momentum-drift", &[]),
    ("energy-drift", &[]),
    ("energy-gain", &[]),
    ("large-oscillation", &["radial", "axial", "speed"]),
    ("spread", &["radius", "speed"]),
    ("coalescence", &["radius", "other"]),
    ("pinch-off", &["radius", "wavenumber", "speed"]),
    ("semi-axis", &["radial", "axial", "shear", "stiffness"]),
    ("plateau-density", &["dimensions", "speed"]),
    ("shock-speed", &["speed", "length"]),
];

impl Measure {
    /// Whether it is about motion that surface tension drives.
    pub(super) fn needs_tension(&self) -> bool {
        matches!(
            self,
            Measure::Oscillation { .. }
                | Measure::SpuriousVelocity { .. }
                | Measure::GrowthRate { .. }
                | Measure::FilmRetraction { .. }
                | Measure::LargeOscillation { .. }
                | Measure::Spread { .. }
                | Measure::Coalescence { .. }
                | Measure::PinchOff { .. }
        )
    }

    pub(super) fn read(entry: Entry<'_>) -> Result<Self, Fault> {
        const EXAMPLE: &str = "laplace-pressure = { radius = \"2.5 um\" }";
        let entry = entry.variant(&KINDS.map(|(kind, _)| kind), EXAMPLE)?;
        let kind = entry.key().to_owned();
        let keys = KINDS.iter().find(|(name, _)| *name == kind).map_or(&[] as &[&str], |(_, keys)| keys);
        let table = Section::new(entry, keys)?;
        let positive = |key: &str, kind: Kind| {
            table.required(key, &format!("{key} = \"{}\"", kind.example))?.positive(kind)
        };
        let size = |key: &str| positive(key, LENGTH);
        let centre = || table.read_or("centre", 0.0, |entry| entry.quantity(LENGTH));
        let whole = |key: &str, least: f64, most: f64| {
            let number = Kind { example: "2", ..NUMBER };
            let rule = format!("must be a whole number from {least} to {most}");
            let accept = |value: f64| value.fract() == 0.0 && (least..=most).contains(&value);
            let entry = table.required(key, &format!("{key} = {least}"))?;
            Ok(entry.checked(number, &rule, accept)? as u32)
        };
        Ok(match kind.as_str() {
            "oscillation" => {
                let (radius, centre) = (size("radius")?, centre()?);
                let from = table.read_or("from", 0.0, |entry| entry.not_negative(TIME))?;
                Measure::Oscillation { mode: whole("mode", 2.0, 1000.0)?, radius, centre, from }
            }
            "laplace-pressure" => Measure::LaplacePressure { radius: size("radius")?, centre: centre()? },
            "growth-rate" => {
                Measure::GrowthRate { wavenumber: positive("wavenumber", NUMBER)?, radius: size("radius")? }
            }
            "film-retraction" => Measure::FilmRetraction { thickness: size("thickness")? },
            "momentum-drift" => Measure::MomentumDrift,
            "energy-drift" => Measure::EnergyDrift,
            "energy-gain" => Measure::EnergyGain,
            "large-oscillation" => {
                let radial = size("radial")?;
                let place = table.required("axial", "axial = \"3 um\"")?;
                let axial = place.quantity(LENGTH)?;
                if !(0.6..=1.6).contains(&(axial / radial)) {
                    let message = "`axial` must be 0.6 to 1.6 times `radial`: the exact motion of longer drops is not known";
                    let (least, most) = (Short(0.6 * radial), Short(1.6 * radial));
                    return Err(place.fault(message, format!("choose {least} to {most} m")));
                }
                let speed = table.read_or("speed", 0.0, |entry| entry.quantity(VELOCITY))?;
                Measure::LargeOscillation { radial, axial, speed }
            }
            "spread" => Measure::Spread { radius: size("radius")?, speed: positive("speed", VELOCITY)? },
            "coalescence" => Measure::Coalescence { radius: size("radius")?, other: size("other")? },
            "pinch-off" => Measure::PinchOff {
                radius: size("radius")?,
                wavenumber: positive("wavenumber", NUMBER)?,
                speed: positive("speed", VELOCITY)?,
            },
            "semi-axis" => Measure::SemiAxis {
                radial: size("radial")?,
                axial: size("axial")?,
                shear: table.required("shear", "shear = \"1 Hz\"")?.quantity(RATE)?,
                stiffness: table.read_or("stiffness", 0.0, |entry| entry.not_negative(SQUARED_RATE))?,
            },
            "plateau-density" => Measure::PlateauDensity {
                dimensions: whole("dimensions", 2.0, 3.0)?,
                speed: positive("speed", VELOCITY)?,
            },
            "shock-speed" => {
                Measure::ShockSpeed { speed: positive("speed", VELOCITY)?, length: size("length")? }
            }
            _ => Measure::SpuriousVelocity { radius: size("radius")? },
        })
    }
}
