//! From a scene's choices to a pipeline: one line a stage, with the reason why it is in or left out.

use crate::scene::{
    AxisTreatment, Curvature, FREE_SHIFTING, Flux, Method, ReferencePressure, SHIFTING, Scheme,
    TimeIntegration,
};
use meniscus_engine::neighbours::Domain;
use meniscus_engine::pairs::{PairPass, PairTerm};
use meniscus_engine::pipeline::{Pipeline, Stage};
use meniscus_engine::wiring::{Wiring, WiringError};
use meniscus_stages::axis_contact::AxisContact;
use meniscus_stages::boundary_detect::{BoundaryDetect, ColourGuard};
use meniscus_stages::central_force::CentralForce;
use meniscus_stages::colour_field::ColourField;
use meniscus_stages::contact::{Contact, ContactProblem, FirstOrder, Limited, Reconstruction, Shock};
use meniscus_stages::correction::MomentumCorrection;
use meniscus_stages::curvature_colour::{ColourCurvature, CurvatureColour};
use meniscus_stages::curvature_normals::CurvatureNormals;
use meniscus_stages::equation_of_state::{Packing, Second, State};
use meniscus_stages::fields;
use meniscus_stages::geometry::{Geometry, HarmonicMean, NearAxisParshikov, Parshikov};
use meniscus_stages::ghost_coupling::GhostCoupling;
use meniscus_stages::initial_pressure::InitialPressure;
use meniscus_stages::integrate::{self, Courant, Integrate};
use meniscus_stages::kernel_correction::KernelCorrection;
use meniscus_stages::liquids::{EquationOfState, IdealGas, Linear, MieGrueneisen};
use meniscus_stages::record::{DeformationRecord, FlowRecord, FlowState, ShockRecord};
use meniscus_stages::reference_pressure;
use meniscus_stages::shifting::{Shifting, Strength};
use meniscus_stages::sort_bin::SortBin;
use meniscus_stages::surface_corrections::{StrainCorrection, TangentialPressure};
use meniscus_stages::terms::{
    Crowding, DensityRate, EnergyRate, GhostWeight, MomentMatrix, PressureRiemann, VelocitySum,
};
use meniscus_stages::velocity_gradient::VelocityGradient;
use std::sync::{Arc, Mutex};

/// The equations of state to choose from.
#[derive(Clone, Copy, Debug)]
pub enum Equation {
    /// Weakly compressible liquid.
    Linear(Linear),
    /// Liquid under shocks.
    MieGrueneisen(MieGrueneisen),
    /// Gas.
    IdealGas(IdealGas),
}

impl Equation {
    /// Pressure in Pa at a density in kg/m3 and a specific internal energy in J/kg.
    pub fn pressure(&self, density: f64, energy: f64) -> f64 {
        match self {
            Equation::Linear(equation) => equation.pressure(density, energy),
            Equation::MieGrueneisen(equation) => equation.pressure(density, energy),
            Equation::IdealGas(equation) => equation.pressure(density, energy),
        }
    }

    /// s of the shock adiabat D = C + s u.
    pub fn shock_slope(&self) -> f64 {
        match self {
            Equation::Linear(equation) => equation.shock_slope(),
            Equation::MieGrueneisen(equation) => equation.shock_slope(),
            Equation::IdealGas(equation) => equation.shock_slope(),
        }
    }

    /// Whether the energy equation is needed.
    pub fn with_energy(&self) -> bool {
        match self {
            Equation::Linear(_) => Linear::WITH_ENERGY,
            Equation::MieGrueneisen(_) => MieGrueneisen::WITH_ENERGY,
            Equation::IdealGas(_) => IdealGas::WITH_ENERGY,
        }
    }
}

/// What the pipeline models, in SI units.
#[derive(Clone, Debug)]
pub struct Physics {
    /// Numerical choices.
    pub method: Method,
    /// Equation of state.
    pub equation: Equation,
    /// Speed of sound at rest in m/s.
    pub sound_speed: f64,
    /// Density at rest in kg/m3.
    pub reference_density: f64,
    /// B^2 of a central force in 1/s2; zero for none.
    pub central_force: f64,
    /// Surface tension in N/m.
    pub surface_tension: f64,
    /// Axis and period.
    pub domain: Domain,
    /// Particle size at the start in m.
    pub particle_size: f64,
    /// Greatest speed that scales shifting, m/s.
    pub shifting_speed: f64,
    /// One over the capillary time, 1/s; zero without surface tension.
    pub capillary_rate: f64,
}

/// One stage that could be in the pipeline.
#[derive(Clone, Debug)]
pub struct PlanLine {
    /// Name of the stage.
    pub stage: &'static str,
    /// Whether it is in.
    pub present: bool,
    /// Why it is in or out.
    pub reason: String,
}

/// A checked pipeline with its wiring and plan.
pub struct Assembly {
    /// The fields and who touches them.
    pub wiring: Wiring,
    /// The stages.
    pub pipeline: Pipeline,
    /// Every stage, in or out, with the reason.
    pub plan: Vec<PlanLine>,
}

type Stages = Vec<Box<dyn Stage>>;

struct Builder<'a> {
    physics: &'a Physics,
    packing: Packing,
    colour: Arc<Mutex<ColourField>>,
    wiring: Wiring,
    plan: Vec<PlanLine>,
}

/// Builds the pipeline of the given physics.
///
/// # Errors
/// A mistake in the order or access of stages: a mistake here, not in the scene.
pub fn assemble(physics: &Physics) -> Result<Assembly, WiringError> {
    let packing = Packing {
        domain: physics.domain,
        theta: physics.method.theta,
        // D grows without bound as a particle nears the axis; its support must not.
        largest_size: 2.0 * physics.particle_size,
    };
    let colour = Arc::new(Mutex::new(ColourField::default()));
    let mut builder = Builder { physics, packing, colour, wiring: Wiring::new(), plan: Vec::new() };
    let stages = builder.step();
    builder.wiring.check()?;
    let plan = std::mem::take(&mut builder.plan);
    let start = builder.start();
    Ok(Assembly { wiring: builder.wiring, pipeline: Pipeline::new(start, stages), plan })
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
        let asked = self.physics.method.reference_pressure == ReferencePressure::Component;
        asked && self.with_tension()
    }

    fn with_energy(&self) -> bool {
        self.physics.equation.with_energy()
    }

    fn shifting(&self) -> f64 {
        self.physics.method.shifting.unwrap_or(match (self.with_tension(), self.with_energy()) {
            (true, _) => SHIFTING,
            (false, false) => FREE_SHIFTING,
            // It makes a plane shock in water a quarter worse, and costs two thirds more.
            (false, true) => 0.0,
        })
    }

    /// Shifting must know the surface, too.
    fn with_surface(&self) -> bool {
        self.with_tension() || self.shifting() > 0.0
    }

    /// The moment matrix and the velocity sums serve the reconstruction and the strain's correction.
    fn with_sums(&self) -> bool {
        self.reconstructs() || self.corrects_strain()
    }

    fn reconstructs(&self) -> bool {
        self.physics.method.flux == Flux::Reconstructed
    }

    /// Shocks run where the pressure depends on the energy; the first-order flux resolves them.
    fn with_shocks(&self) -> bool {
        self.physics.method.shock_contacts && self.with_energy() && !self.reconstructs()
    }

    fn second_row(&self) -> Second {
        if self.with_shocks() {
            Second::Density
        } else if self.reconstructs() || self.physics.method.kernel_correction {
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
        let second = self.second_row();
        Box::new(State::new(&mut self.wiring, equation, self.packing, second))
    }

    fn sort(&mut self) -> Box<dyn Stage> {
        Box::new(SortBin::new(&mut self.wiring, self.packing))
    }

    /// The stages of one time step, in their order.
    fn step(&mut self) -> Stages {
        let method = self.physics.method.clone();
        let mut stages = Stages::new();
        self.plan("sort-bin", true, ("neighbours and memory order, anew when the skin is used up", ""));
        stages.push(self.sort());
        self.plan("equation-of-state", true, ("pressure from density, packed rows", ""));
        stages.push(self.state());
        self.plan("flux", true, (&self.describe_flux(), ""));
        stages.push(self.flux());
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
        let reasons = ("the pair sum of the strain is short at the surface", "not asked for, or no tension");
        if self.plan("strain-correction", self.corrects_strain(), reasons) {
            stages.push(Box::new(StrainCorrection::new(&mut self.wiring)));
        }
        let reasons = ("surface forces join; they must not move the whole", "there is no surface tension");
        if self.plan("correction", self.with_tension(), reasons) {
            let conserve = method.momentum_correction;
            stages.push(Box::new(MomentumCorrection::new(&mut self.wiring, conserve)));
        }
        let without_images =
            (method.scheme, method.axis) == (Scheme::HarmonicMean, AxisTreatment::Conservative);
        let at_axis = self.physics.domain.origin == 0.0 && without_images && self.with_shocks();
        let reasons = ("shocks may form on the axis", "no shocks, no axis, or images there");
        if self.plan("axis-contact", at_axis, reasons) {
            let (packing, slope) = (self.packing, self.physics.equation.shock_slope());
            stages.push(Box::new(AxisContact::new(&mut self.wiring, packing, slope)));
        }
        let (stiffness, origin) = (self.physics.central_force, self.physics.domain.origin);
        let reasons = ("the scene has a central force", "the scene has none");
        if self.plan("central-force", stiffness > 0.0, reasons) {
            stages.push(Box::new(CentralForce::new(&mut self.wiring, stiffness, origin)));
        }
        let reasons = ("a constant pressure must not act on the packing's disorder", "not asked for");
        let reference = self.with_reference();
        if self.plan("reference-pressure", reference, reasons) {
            let stage = reference_pressure::ReferencePressure::new(&mut self.wiring, self.packing);
            stages.push(Box::new(stage));
        }
        let reasons = ("the kernel sum is short", "not asked for");
        if self.plan("kernel-correction", method.kernel_correction, reasons) {
            stages.push(Box::new(KernelCorrection::new(&mut self.wiring)));
        }
        let reasons = ("the flux reconstructs velocities", "the first-order flux needs no gradients");
        if self.plan("velocity-gradient", self.reconstructs(), reasons) {
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
            stages.push(Box::new(Shifting::new(&mut self.wiring, strength, with_deformation)));
        }
        stages
    }

    /// The stages that run once before the first step: gradients to predict from, and the pressure.
    fn start(&mut self) -> Stages {
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
        if self.reconstructs() {
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

    fn describe_flux(&self) -> String {
        let method = &self.physics.method;
        let weights = match (method.scheme, method.axis) {
            (Scheme::Parshikov, _) => "Parshikov's weights".to_string(),
            (_, AxisTreatment::Conservative) => "harmonic-mean weights".to_string(),
            (_, AxisTreatment::Parshikov) => {
                format!("harmonic-mean weights, Parshikov's within {} h of the axis", method.axis_factor)
            }
        };
        let flux = match (self.reconstructs(), self.with_shocks()) {
            (true, _) => "reconstructed velocities",
            (false, true) => "first-order flux with the contacts of shocks",
            (false, false) => "first-order flux",
        };
        format!("all pair sums in one traversal: {weights}, {flux}")
    }

    fn flux(&mut self) -> Box<dyn Stage> {
        let origin = self.physics.domain.origin;
        let axis_factor = self.physics.method.axis_factor;
        match (self.physics.method.scheme, self.physics.method.axis) {
            (Scheme::Parshikov, _) => self.flux_with(Parshikov { origin }),
            (_, AxisTreatment::Conservative) => self.flux_with(HarmonicMean { origin }),
            (_, AxisTreatment::Parshikov) => self.flux_with(NearAxisParshikov { origin, axis_factor }),
        }
    }

    fn flux_with<G: Geometry + 'static>(&mut self, geometry: G) -> Box<dyn Stage> {
        if self.with_shocks() {
            let slope = self.physics.equation.shock_slope();
            self.terms::<ShockRecord, _, _>(geometry, Shock { slope })
        } else if self.reconstructs() {
            // beta = min(1, 300 |J_r|/C) (method.md, section 10, "Coalescence, later").
            let sharpness = 300.0 / self.physics.sound_speed.max(self.physics.shifting_speed);
            self.terms::<DeformationRecord, _, _>(geometry, Limited { sharpness })
        } else if self.second_row() == Second::Deformation {
            self.terms::<DeformationRecord, _, _>(geometry, FirstOrder)
        } else {
            self.terms::<FlowRecord, _, _>(geometry, FirstOrder)
        }
    }

    fn terms<R, G, F>(&mut self, geometry: G, reconstruction: F) -> Box<dyn Stage>
    where
        R: FlowState + 'static,
        G: Geometry + 'static,
        F: Reconstruction<R> + 'static,
    {
        self.wiring.stage("flux");
        let problem = ContactProblem { geometry, reconstruction };
        let flow =
            (DensityRate::new(&mut self.wiring, geometry), PressureRiemann::new(&mut self.wiring, geometry));
        let moment = (self.with_surface() || self.with_sums() || self.physics.method.kernel_correction)
            .then(|| MomentMatrix::new(&mut self.wiring));
        let weight = self.with_surface().then(|| GhostWeight::new(&mut self.wiring, geometry));
        let sum = self.with_sums().then(|| VelocitySum::new(&mut self.wiring));
        let theta = self.physics.method.theta;
        let crowding = (self.shifting() > 0.0).then(|| Crowding::new(&mut self.wiring, theta));
        let energy = self.with_energy().then(|| EnergyRate::new(&mut self.wiring, geometry));
        // The sums of most scenes are fused without a question; the rest are options.
        match (moment, weight, sum) {
            (Some(moment), Some(weight), Some(sum)) => {
                pass::<R, _, _, _>(problem, (flow, (moment, weight, sum), (crowding, energy)))
            }
            (moment, weight, sum) => {
                pass::<R, _, _, _>(problem, (flow, (moment, weight, sum), (crowding, energy)))
            }
        }
    }
}

fn pass<R, G, F, T>(problem: ContactProblem<G, F>, terms: T) -> Box<dyn Stage>
where
    R: FlowState + 'static,
    G: Geometry + 'static,
    F: Reconstruction<R> + 'static,
    T: PairTerm<R, Contact> + 'static,
{
    Box::new(PairPass::<R, _, _>::new("flux", problem, terms))
}
