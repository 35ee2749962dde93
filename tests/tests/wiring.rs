//! Every choice of the method can be assembled, and steps without reading what nobody wrote.

use meniscus_cases::assemble::{Equation, Physics, assemble};
use meniscus_cases::scene::{
    AxisTreatment, Curvature, Flux, Method, Recoil, ReferencePressure, Scheme, TimeIntegration,
};
use meniscus_stages::liquids::MieGrueneisen;
use meniscus_tests::liquid::{self, Block, Random, SIZE};

const FLAGS: u32 = 14;

/// The block's liquid with shocks and the energy equation.
const SHOCKED: Equation = Equation::MieGrueneisen(MieGrueneisen {
    reference_density: liquid::DENSITY,
    sound_speed: liquid::SOUND_SPEED,
    slope: 2.0,
    grueneisen: 2.0,
});

/// The choices that the bits of a number stand for.
fn physics(number: u32) -> Physics {
    let bit = |k: u32| number >> k & 1 == 1;
    let method = Method {
        scheme: [Scheme::HarmonicMean, Scheme::Parshikov][usize::from(bit(0))],
        axis: [AxisTreatment::Conservative, AxisTreatment::Parshikov][usize::from(bit(1))],
        flux: [Flux::Reconstructed, Flux::FirstOrder][usize::from(bit(2))],
        time_integration: [TimeIntegration::AdamsBashforth, TimeIntegration::Euler][usize::from(bit(3))],
        curvature: [Curvature::ColourField, Curvature::NormalDivergence][usize::from(bit(4))],
        shifting: Some(if bit(5) { 0.5 } else { 0.0 }),
        kernel_correction: bit(7),
        tangential_pressure: bit(8),
        strain_correction: bit(9),
        colour_guard: if bit(10) { 0.85 } else { 0.0 },
        momentum_correction: [Recoil::Drop, Recoil::Whole][usize::from(bit(11))],
        reference_pressure: [ReferencePressure::Drop, ReferencePressure::None][usize::from(bit(12))],
        ..Method::defaults()
    };
    let surface_tension = if bit(6) { 0.074 } else { 0.0 };
    // Every second combination is viscous, whatever any one choice.
    let viscosity = if number.count_ones().is_multiple_of(2) { 1e-3 } else { 0.0 };
    let physics = Physics { surface_tension, viscosity, ..liquid::physics(method) };
    if bit(13) { Physics { equation: SHOCKED, ..physics } } else { physics }
}

#[test]
fn every_combination_is_wired_soundly() {
    let mut mistakes = Vec::new();
    for number in 0..1 << FLAGS {
        let physics = physics(number);
        if let Err(error) = assemble(&physics) {
            mistakes.push(format!("{physics:?}: {error}"));
        }
    }
    assert!(mistakes.is_empty(), "{} fail, first: {}", mistakes.len(), mistakes[0]);
}

#[test]
fn a_step_of_every_combination_is_finite() {
    for number in 0..1 << FLAGS {
        let physics = physics(number);
        let mut particles = liquid::block([7, 9], 0.5, 0.05, &mut Random::new(31));
        for p in &mut particles {
            p.velocity = [0.1, -0.2].map(|speed| speed * p.position[1] / (9.0 * SIZE));
        }
        let mut block = Block::new(&physics, &particles);
        block.begin();
        for _ in 0..2 {
            // What a stage reads before any has written it is then no number.
            block.world.store.poison_derived();
            block.step();
        }
        for name in ["radius", "axial", "velocity_r", "velocity_z", "density"] {
            let column = block.column(name);
            assert!(column.iter().all(|v| v.is_finite()), "`{name}`: {physics:?}");
        }
    }
}
