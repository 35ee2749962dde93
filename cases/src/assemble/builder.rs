//! The stages of a step: one line a stage, with the reason why it is in or left out.

use super::{Equation, Physics, PlanLine};
use crate::scene::{
    AxisTreatment, Curvature, FREE_SHIFTING, FREE_SHIFTING_THETA, Flux, Recoil, ReferencePressure, SHIFTING,
    Scheme, TimeIntegration,
};
use meniscus_engine::pipeline::Stage;
use meniscus_engine::wiring::Wiring;
use meniscus_stages::axis_contact::AxisContact;
use meniscus_stages::boundary_detect::{BoundaryDetect, ColourGuard};
use meniscus_stages::central_force::CentralForce;
use meniscus_stages::colour_field::ColourField;
use meniscus_stages::correction::MomentumCorrection;
use meniscus_stages::curvature_colour::{ColourCurvature, CurvatureColour};
use meniscus_stages::curvature_normals::CurvatureNormals;
use meniscus_stages::drops::Drops;
use meniscus_stages::equation_of_state::{Packing, Second, State};
use meniscus_stages::fields;
use meniscus_stages::ghost_coupling::GhostCoupling;
use meniscus_stages::initial_pressure::InitialPressure;
use meniscus_stages::integrate::{self, Courant, Integrate};
use meniscus_stages::kernel_correction::KernelCorrection;
use meniscus_stages::liquids::EquationOfState;
use meniscus_stages::record::Precision;
use meniscus_stages::reference_pressure;
use meniscus_stages::shifting::{Shifting, Strength};
use meniscus_stages::sort_bin::SortBin;
use meniscus_stages::surface_corrections::{StrainCorrection, TangentialPressure};
use meniscus_stages::tension_balance::TensionBalance;
use meniscus_stages::velocity_gradient::VelocityGradient;
use meniscus_stages::viscosity::Viscosity;
use std::sync::{Arc, Mutex};

pub(super) type Stages = Vec<Box<dyn Stage>>;

/// A pipeline under way.
pub(super) struct Builder<'a> {
    pub physics: &'a Physics,
    pub packing: Packing,
    pub colour: Arc<Mutex<ColourField>>,
    pub wiring: Wiring,
    pub plan: Vec<PlanLine>,
}

impl Builder<'_> {
    /// Notes a stage in the plan; whether it is in.
    fn plan(&mut self, stage: &'static str, present: bool, reasons: (&str, &str)) -> bool {
        let reason = if present { reasons.0 } else { reasons.1 }.to_string();
        self.plan.push(PlanLine { stage, present, reason });
        present
    }

    fn with_tension(&self) -> bool {
        self.physics.surface_tension > 0.0
    }

    /// A reference pressure belongs to a drop under surface tension: elsewhere none builds up.
    fn with_reference(&self) -> bool {
        let asked = self.physics.method.reference_pressure == ReferencePressure::Drop;
        asked && self.with_tension()
    }

    fn with_drops(&self) -> bool {
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

    /// Shifting must know the surface, too.
    pub(super) fn with_surface(&self) -> bool {
        self.with_tension() || self.shifting() > 0.0
    }

    pub(super) fn with_viscosity(&self) -> bool {
        self.physics.viscosity > 0.0
    }

    /// The reconstruction and viscosity start from the velocity gradient.
    fn with_gradient(&self) -> bool {
        self.reconstructs() || self.with_viscosity()
    }

    /// The moment matrix and the velocity sums serve the gradient and the strain's correction.
    pub(super) fn with_sums(&self) -> bool {
        self.with_gradient() || self.corrects_strain()
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

    /// Rows of single precision have one length.
    pub(super) fn second_row(&self) -> Second {
        let method = &self.physics.method;
        if self.with_shocks() {
            Second::Density
        } else if self.with_gradient() || method.kernel_correction || method.precision == Precision::Mixed {
            Second::Deformation
        } else {
            Second::Nothing
        }
    }

    fn corrects_strain(&self) -> bool {
        self.with_tension() && self.physics.method.strain_correction
    }

    fn state(&mut self) -> Box<dyn Stage> {
        match self.physics.equation {
            Equation::Linear(equation) => self.state_of(equation),
            Equation::MieGrueneisen(equation) => self.state_of(equation),
            Equation::IdealGas(equation) => self.state_of(equation),
        }
    }

    fn state_of<E: EquationOfState>(&mut self, equation: E) -> Box<dyn Stage> {
        let (second, precision) = (self.second_row(), self.physics.method.precision);
        Box::new(State::new(&mut self.wiring, equation, self.packing, second, precision))
    }

    fn sort(&mut self) -> Box<dyn Stage> {
        Box::new(SortBin::new(&mut self.wiring, self.packing))
    }

    /// The stages of one time step, in their order.
    pub fn step(&mut self) -> Stages {
        let method = self.physics.method.clone();
        let mut stages = Stages::new();
        self.plan("sort-bin", true, ("neighbours and memory order, anew when the skin is used up", ""));
        stages.push(self.sort());
        self.plan("equation-of-state", true, ("pressure from density, packed rows", ""));
        stages.push(self.state());
        self.plan("flux", true, (&self.describe_flux(), ""));
        stages.push(self.flux());
        let reasons = ("drops have their own pressure and momentum", "nothing asks which drop is which");
        if self.plan("drops", self.with_drops(), reasons) {
            stages.push(Box::new(Drops::new(&mut self.wiring, self.packing)));
        }
        let reasons = ("surface tension or shifting must know the surface", "nothing acts at the surface");
        if self.plan("boundary-detect", self.with_surface(), reasons) {
            stages.push(self.boundary());
        }
        let reasons = ("surface tension is above zero", "there is no surface tension");
        if self.plan("curvature", self.with_tension(), reasons) {
            stages.push(self.curvature());
        }
        let reasons = ("ghosts bring the Laplace pressure to the surface", "there is no surface tension");
        if self.plan("ghost-coupling", self.with_tension(), reasons) {
            let with_energy = self.with_energy();
            stages.push(Box::new(GhostCoupling::new(&mut self.wiring, 0.0, true, with_energy)));
        }
        let reasons = ("ghosts carry no gradient along the surface", "not asked for, or no colour field");
        if self.plan("tangential-pressure", self.with_slope(), reasons) {
            stages.push(Box::new(TangentialPressure::new(&mut self.wiring)));
        }
        let reasons = ("surface forces must add up to tension's pull", "not asked for, or no colour field");
        if self.plan("tension-balance", self.with_slope(), reasons) {
            let (tension, with_energy) = (self.physics.surface_tension, self.with_energy());
            let stage = TensionBalance::new(&mut self.wiring, self.packing, tension, with_energy);
            stages.push(Box::new(stage));
        }
        let reasons = ("the pair sum of the strain is short at the surface", "not asked for, or no tension");
        if self.plan("strain-correction", self.corrects_strain(), reasons) {
            stages.push(Box::new(StrainCorrection::new(&mut self.wiring)));
        }
        let reasons = ("surface forces join; they must not move the whole", "there is no surface tension");
        if self.plan("correction", self.with_tension(), reasons) {
            let recoil = method.momentum_correction;
            stages.push(Box::new(MomentumCorrection::new(&mut self.wiring, recoil)));
        }
        let without_images =
            (method.scheme, method.axis) == (Scheme::HarmonicMean, AxisTreatment::Conservative);
        let at_axis = self.physics.domain.origin == 0.0 && without_images && self.with_shocks();
        let reasons = ("shocks may form on the axis", "no shocks, no axis, or images there");
        if self.plan("axis-contact", at_axis, reasons) {
            let (packing, slope) = (self.packing, self.physics.equation.shock_slope());
            stages.push(Box::new(AxisContact::new(&mut self.wiring, packing, slope)));
        }
        let reasons = ("the liquid is viscous", "the liquid has no viscosity");
        let (origin, with_energy) = (self.physics.domain.origin, self.with_energy());
        if self.plan("viscosity", self.with_viscosity(), reasons) {
            let viscosity = self.physics.viscosity;
            stages.push(Box::new(Viscosity::new(&mut self.wiring, viscosity, origin, with_energy)));
        }
        let stiffness = self.physics.central_force;
        let reasons = ("the scene has a central force", "the scene has none");
        if self.plan("central-force", stiffness > 0.0, reasons) {
            stages.push(Box::new(CentralForce::new(&mut self.wiring, stiffness, origin)));
        }
        let reasons = ("a constant pressure must not act on the packing's disorder", "not asked for");
        let reference = self.with_reference();
        if self.plan("reference-pressure", reference, reasons) {
            let stage = reference_pressure::ReferencePressure::new(&mut self.wiring);
            stages.push(Box::new(stage));
        }
        let reasons = ("the kernel sum is short", "not asked for");
        if self.plan("kernel-correction", method.kernel_correction, reasons) {
            let with_surface = self.with_surface();
            stages.push(Box::new(KernelCorrection::new(&mut self.wiring, with_surface)));
        }
        let reasons = match self.reconstructs() {
            true => ("the flux reconstructs velocities", ""),
            false => ("viscosity needs gradients", "the first-order flux needs no gradients"),
        };
        if self.plan("velocity-gradient", self.with_gradient(), reasons) {
            stages.push(Box::new(VelocityGradient::new(&mut self.wiring)));
        }
        self.plan("integrate", true, ("time moves on", ""));
        stages.push(self.integrate());
        // Pictures and files show the pressure: it counts as read.
        self.wiring.stage("outputs");
        self.wiring.read(&fields::PRESSURE);
        let reasons = ("flows draw particles out into rows", "its coefficient is zero");
        if self.plan("shifting", self.shifting() > 0.0, reasons) {
            let strength = Strength {
                coefficient: self.shifting(),
                speed: self.physics.shifting_speed,
                rate: self.physics.capillary_rate,
                theta: method.theta,
                origin: self.physics.domain.origin,
                everywhere: !self.with_tension(),
            };
            let with_deformation = self.reconstructs() && self.with_tension();
            // The energy equation knows nothing of a velocity that changes so.
            let carrying = self.reconstructs() && !self.with_tension() && !self.with_energy();
            stages.push(Box::new(Shifting::new(&mut self.wiring, strength, with_deformation, carrying)));
        }
        stages
    }

    /// The stages that run once before the first step: gradients to predict from, and the pressure.
    pub fn start(&mut self) -> Stages {
        let mut stages = vec![self.sort(), self.state(), self.flux()];
        if self.with_tension() {
            stages.push(self.boundary());
            stages.push(self.curvature());
            stages.push(match self.physics.equation {
                Equation::Linear(equation) => self.initial_pressure(equation),
                Equation::MieGrueneisen(equation) => self.initial_pressure(equation),
                Equation::IdealGas(equation) => self.initial_pressure(equation),
            });
        }
        if self.with_gradient() {
            stages.push(Box::new(VelocityGradient::new(&mut self.wiring)));
        }
        stages
    }

    fn initial_pressure<E: EquationOfState>(&mut self, equation: E) -> Box<dyn Stage> {
        let with_reference = self.with_reference();
        Box::new(InitialPressure::new(&mut self.wiring, equation, self.packing, with_reference))
    }

    fn boundary(&mut self) -> Box<dyn Stage> {
        let method = &self.physics.method;
        // The colour-field curvature takes its particles from the guard's look-up.
        let colour = method.colour_guard > 0.0 || self.colour_curvature();
        let guard = colour.then(|| ColourGuard {
            field: self.colour.clone(),
            highest: if method.colour_guard > 0.0 { method.colour_guard } else { f64::INFINITY },
            support: method.colour_support,
            with_offset: self.colour_curvature(),
        });
        let interval = method.curvature_interval;
        Box::new(BoundaryDetect::new(&mut self.wiring, self.packing, interval, guard))
    }

    fn colour_curvature(&self) -> bool {
        self.with_tension() && self.physics.method.curvature == Curvature::ColourField
    }

    fn with_slope(&self) -> bool {
        self.colour_curvature() && self.physics.method.tangential_pressure
    }

    fn curvature(&mut self) -> Box<dyn Stage> {
        let (method, surface_tension) = (&self.physics.method, self.physics.surface_tension);
        if method.curvature == Curvature::NormalDivergence {
            let theta = method.normal_theta;
            let density = self.physics.reference_density;
            let stage =
                CurvatureNormals::new(&mut self.wiring, self.packing, surface_tension, density, theta);
            return Box::new(stage);
        }
        let settings = ColourCurvature {
            surface_tension,
            density: self.physics.reference_density,
            support: method.colour_support,
            interval: method.curvature_interval,
            sound_speed: self.physics.sound_speed,
            with_slope: self.with_slope(),
        };
        Box::new(CurvatureColour::new(&mut self.wiring, self.packing, settings, self.colour.clone()))
    }

    fn integrate(&mut self) -> Box<dyn Stage> {
        let scheme = match self.physics.method.time_integration {
            TimeIntegration::AdamsBashforth => integrate::Scheme::AdamsBashforth,
            TimeIntegration::Euler => integrate::Scheme::Euler,
        };
        let courant = Courant {
            number: self.physics.method.cfl,
            speed: self.physics.sound_speed.max(self.physics.shifting_speed),
            particle_size: self.physics.particle_size,
            origin: self.physics.domain.origin,
        };
        let with_energy = self.with_energy();
        Box::new(Integrate::new(&mut self.wiring, scheme, courant, with_energy))
    }
}
