//! Why a run broke down, as numbers among those of its last checkpoint's clock.

use meniscus_engine::checkpoint::Clock;
use meniscus_engine::pipeline::Fault;

const STAGE: &str = "fault in stage ";
const QUANTITY: &str = "fault of quantity ";
const PARTICLE: &str = "fault of particle";
const RADIUS: &str = "fault at radius";
const AXIAL: &str = "fault at axial";

/// What went bad in the step that a run could not finish.
#[derive(Clone, Debug, PartialEq)]
pub struct Crash {
    /// The stage that found it.
    pub stage: String,
    /// The quantity that went bad.
    pub quantity: String,
    /// Its value, in the SI unit of the quantity.
    pub value: f64,
    /// Identity of the particle.
    pub particle: u32,
    /// Where the particle was, r and z in m.
    pub place: [f64; 2],
    /// Steps that were taken before the one that failed.
    pub step: u64,
}

/// The numbers that tell of a fault.
pub(super) fn written(fault: &Fault) -> [(String, f64); 5] {
    [
        (format!("{STAGE}{}", fault.stage), fault.step as f64),
        (format!("{QUANTITY}{}", fault.quantity), fault.value),
        (PARTICLE.to_owned(), f64::from(fault.particle)),
        (RADIUS.to_owned(), fault.r),
        (AXIAL.to_owned(), fault.z),
    ]
}

impl Crash {
    /// What a checkpoint's clock tells of a fault; none if it is of a run that was well.
    pub fn told_by(clock: &Clock) -> Option<Self> {
        let named = |start: &str| {
            let mut scalars = clock.scalars.iter();
            scalars.find_map(|(name, value)| Some((name.strip_prefix(start)?.to_owned(), *value)))
        };
        let ((stage, step), (quantity, value)) = (named(STAGE)?, named(QUANTITY)?);
        Some(Crash {
            stage,
            quantity,
            value,
            particle: clock.scalar(PARTICLE)? as u32,
            place: [clock.scalar(RADIUS)?, clock.scalar(AXIAL)?],
            step: step as u64,
        })
    }
}
