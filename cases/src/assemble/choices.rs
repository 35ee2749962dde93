//! What a scene's physics and method ask of its pipeline.

use super::builder::Builder;
use crate::scene::{
    AxisTreatment, Curvature, FREE_SHIFTING, FREE_SHIFTING_THETA, Flux, Recoil, ReferencePressure, SHIFTING,
    SHIFTING_INTERVAL, Scheme, TimeIntegration,
};
use meniscus_stages::equation_of_state::Besides;

impl Builder<'_> {
    pub(super) fn with_tension(&self) -> bool {
        self.physics.surface_tension > 0.0
    }

    /// A reference pressure belongs to a drop under surface tension: elsewhere none builds up.
    pub(super) fn with_reference(&self) -> bool {
        let asked = self.physics.method.reference_pressure == ReferencePressure::Drop;
        asked && self.with_tension()
    }

    pub(super) fn with_drops(&self) -> bool {
        let recoil = self.physics.method.momentum_correction == Recoil::Drop;
        self.with_reference() || (self.with_tension() && (recoil || self.colour_curvature()))
    }

    pub(super) fn with_energy(&self) -> bool {
        self.physics.equation.with_energy()
    }

    pub(super) fn shifting(&self) -> f64 {
        self.physics.method.shifting.unwrap_or(match (self.with_tension(), self.with_energy()) {
            (true, _) => SHIFTING,
            (false, false) => {
                let [full, none] = FREE_SHIFTING_THETA;
                FREE_SHIFTING * ((none - self.physics.method.theta) / (none - full)).clamp(0.0, 1.0)
            }
            // It makes a plane shock in water a quarter worse, and costs two thirds more.
            (false, true) => 0.0,
        })
    }

    /// Steps from one shift to the next.
    pub(super) fn shifting_interval(&self) -> u64 {
        let default = if self.with_tension() { SHIFTING_INTERVAL } else { 1 };
        self.physics.method.shifting_interval.unwrap_or(default)
    }

    /// Shifting must know the surface, too.
    pub(super) fn with_surface(&self) -> bool {
        self.with_tension() || self.shifting() > 0.0
    }

    pub(super) fn with_viscosity(&self) -> bool {
        self.physics.viscosity > 0.0
    }

    /// The reconstruction and viscosity start from the rate of deformation of the step before.
    pub(super) fn predicts_deformation(&self) -> bool {
        self.reconstructs() || self.with_viscosity()
    }

    /// These and the strain's correction need the velocity gradient.
    pub(super) fn with_gradient(&self) -> bool {
        self.predicts_deformation() || self.corrects_strain()
    }

    /// Whether particles shift everywhere, not only where it is needed.
    pub(super) fn shifts_everywhere(&self) -> bool {
        self.shifting() > 0.0 && !self.with_tension()
    }

    /// Whether velocities are carried along the shifts. The energy equation knows nothing of a velocity that changes
    /// so.
    pub(super) fn with_carrying(&self) -> bool {
        self.shifts_everywhere() && self.reconstructs() && !self.with_energy()
    }

    /// Whether the dissipative force is summed apart: two-step schemes treat it in another way, and that of viscosity joins it.
    pub(super) fn with_dissipation(&self) -> bool {
        self.is_two_step() || self.with_viscosity()
    }

    /// Whether coordinates begin at the axis and pairs know of no images beyond it.
    pub(super) fn without_images(&self) -> bool {
        let method = &self.physics.method;
        let conservative =
            (method.scheme, method.axis) == (Scheme::HarmonicMean, AxisTreatment::Conservative);
        self.physics.domain.origin == 0.0 && conservative
    }

    pub(super) fn is_two_step(&self) -> bool {
        self.physics.method.time_integration == TimeIntegration::AdamsBashforth
    }

    pub(super) fn reconstructs(&self) -> bool {
        self.physics.method.flux == Flux::Reconstructed
    }

    /// Shocks run where the pressure depends on the energy; the first-order flux resolves them. A viscous
    /// liquid's rows hold its rate of deformation where those of shocks have the density.
    pub(super) fn with_shocks(&self) -> bool {
        let asked = self.physics.method.shock_contacts && !self.with_viscosity();
        asked && self.with_energy() && !self.reconstructs()
    }

    /// What the rows of the flux pass hold besides the flow state.
    pub(super) fn besides(&self) -> Besides {
        if self.with_shocks() {
            Besides::Density
        } else if self.predicts_deformation() {
            Besides::Deformation
        } else if self.physics.method.kernel_correction {
            Besides::KernelScale
        } else {
            Besides::Nothing
        }
    }

    /// Under surface tension for its own sake, elsewhere where the gradient is known all the same.
    pub(super) fn corrects_strain(&self) -> bool {
        let asks_for_gradient = self.with_tension() || self.predicts_deformation();
        self.physics.method.strain_correction && asks_for_gradient
    }

    pub(super) fn colour_curvature(&self) -> bool {
        self.with_tension() && self.physics.method.curvature == Curvature::ColourField
    }

    pub(super) fn with_slope(&self) -> bool {
        self.colour_curvature() && self.physics.method.tangential_pressure
    }
}
