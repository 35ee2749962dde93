//! The operations that pair terms and contacts declare are those that they do: their own source, compiled
//! here with lanes that count.

// Of that source only what works on pairs is called.
#![allow(dead_code)]

extern crate meniscus_engine as engine;
// The source finds the lanes of this crate, and what else it asks of the engine.
extern crate self as meniscus_engine;

use engine::{field, store, wiring};

#[path = "../../src/contact.rs"]
mod contact;
#[path = "../../src/fields.rs"]
mod fields;
#[path = "../../src/geometry.rs"]
mod geometry;
#[path = "../../src/image_contact.rs"]
mod image_contact;
mod lanes;
#[path = "../../../engine/src/pairs/terms.rs"]
mod pairs;
#[path = "../../src/record.rs"]
mod record;
#[path = "../../src/terms/mod.rs"]
mod terms;

use contact::{Contact, ContactProblem, FirstOrder, Limited, Reconstruction, Shock};
use geometry::{Geometry, HarmonicMean, NearAxisParshikov, Parshikov, Support};
use lanes::{Slots, counted};
use pairs::{Interaction, PairTerm, Record};
use record::{DeformationRecord, FlowRecord, FlowState, ShockRecord};
use terms::{
    ConcentrationGradient, DensityRate, EnergyRate, GhostWeight, MomentMatrix, PressureRiemann, VelocitySum,
    Viscosity,
};
use wiring::Wiring;

const GEOMETRY: HarmonicMean = HarmonicMean { origin: 0.0 };
const SUPPORT: Support = Support { theta: 0.5, largest_size: 1.0 };

fn record<R: Record>() -> R {
    R::from_slots(Slots::default())
}

fn contact<R, G, F>(geometry: G, reconstruction: F) -> Contact<R::Scalar>
where
    R: FlowState,
    G: Geometry,
    F: Reconstruction<R>,
{
    let problem = ContactProblem { geometry, support: SUPPORT, reconstruction };
    let (a, b) = (record::<R>(), record::<R>());
    let own = Interaction::<R>::prepare(&problem, &a);
    let (operations, contact) = counted(|| {
        let approach = problem.approach(&a, &b);
        problem.evaluate(&a, &own, &b, &approach)
    });
    let declared = Interaction::<R>::operations(&problem);
    assert_eq!(declared, operations, "{}", std::any::type_name::<ContactProblem<G, F>>());
    contact
}

#[test]
fn contacts_do_what_they_declare() {
    contact::<FlowRecord, _, _>(GEOMETRY, FirstOrder);
    let near_axis = NearAxisParshikov { origin: 0.0, axis_factor: 2.0, support: SUPPORT };
    contact::<DeformationRecord, _, _>(near_axis, FirstOrder);
    contact::<DeformationRecord, _, _>(GEOMETRY, Limited { sharpness: 1.0 });
    contact::<ShockRecord, _, _>(Parshikov { origin: 0.0 }, Shock { slope: 2.0 });
}

fn term<T: PairTerm<DeformationRecord, Contact>>(name: &str, term: T) {
    let pair = contact::<DeformationRecord, _, _>(GEOMETRY, FirstOrder);
    let (a, b, mut sum) = (record(), record(), term.zero());
    let (operations, ()) = counted(|| term.add(&a, &b, &pair, &mut sum));
    assert!(operations > 0);
    assert_eq!(term.operations(), operations, "{name}");
}

#[test]
fn terms_do_what_they_declare() {
    let mut wiring = Wiring::new();
    let wiring = &mut wiring;
    wiring.stage("flux");
    term("concentration gradient", ConcentrationGradient::new(wiring, 0.5));
    term("density rate", DensityRate::new(wiring, GEOMETRY));
    term("energy rate", EnergyRate::new(wiring, GEOMETRY));
    term("ghost weight", GhostWeight::new(wiring, GEOMETRY));
    term("moment matrix", MomentMatrix::new(wiring));
    term("pressure", PressureRiemann::new(wiring, GEOMETRY, Some((SUPPORT, FirstOrder)), true));
    term("velocity sum", VelocitySum::new(wiring));
    term("viscosity", Viscosity::new(wiring, GEOMETRY, 1e-3, false));
    term("viscosity with its power", Viscosity::new(wiring, GEOMETRY, 1e-3, true));
    let fused = (MomentMatrix::new(wiring), Some(GhostWeight::new(wiring, GEOMETRY)), None::<VelocitySum>);
    term("fused terms", fused);
}
