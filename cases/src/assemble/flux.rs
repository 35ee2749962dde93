//! The flux pass: which weights, which contacts and which pair sums a scene needs.

use super::builder::Builder;
use crate::scene::{AxisTreatment, Scheme};
use meniscus_engine::lanes::{Double, Packed};
use meniscus_engine::pairs::{PairPass, PairTerm};
use meniscus_engine::pipeline::AnyStage;
use meniscus_stages::contact::{Contact, ContactProblem, FirstOrder, Limited, Reconstruction, Shock};
use meniscus_stages::equation_of_state::Besides;
use meniscus_stages::geometry::{Geometry, HarmonicMean, NearAxisParshikov, Parshikov};
use meniscus_stages::image_contact::ImageContact;
use meniscus_stages::record::{DeformationRecord, FlowRecord, FlowState, Precision, ShockRecord};
use meniscus_stages::terms::{
    ConcentrationGradient, DensityRate, EnergyRate, GhostWeight, MomentMatrix, PressureRiemann, VelocitySum,
    Viscosity,
};

/// The sums of any liquid: flow, surface and gradient, and energy.
type Sums<G, F> = (
    (DensityRate<G>, PressureRiemann<G, F>),
    (Option<MomentMatrix>, Option<GhostWeight<G>>, Option<VelocitySum>),
    Option<EnergyRate<G>>,
);

impl Builder<'_> {
    pub(super) fn describe_flux(&self) -> String {
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
        let images = match self.without_images() && (self.reconstructs() || self.with_shocks()) {
            true => ", rings' contacts with their images across the axis",
            false => "",
        };
        let precision = match method.precision {
            Precision::Double => "double precision",
            Precision::Mixed => "pairs in single precision",
        };
        format!("all pair sums in one traversal: {weights}, {flux}{images}, {precision}")
    }

    pub(super) fn flux(&mut self) -> AnyStage {
        let origin = self.physics.domain.origin;
        let axis_factor = self.physics.method.axis_factor;
        match (self.physics.method.scheme, self.physics.method.axis) {
            (Scheme::Parshikov, _) => self.flux_with::<Double, _>(Parshikov { origin }),
            (_, AxisTreatment::Conservative) => match self.physics.method.precision {
                Precision::Double => self.flux_with::<Double, _>(HarmonicMean { origin }),
                Precision::Mixed => self.flux_with::<f32, _>(HarmonicMean { origin: origin / self.unit() }),
            },
            (_, AxisTreatment::Parshikov) => {
                let support = self.packing.support(Precision::Double);
                self.flux_with::<Double, _>(NearAxisParshikov { origin, axis_factor, support })
            }
        }
    }

    fn unit(&self) -> f64 {
        self.packing.unit(self.physics.method.precision)
    }

    fn flux_with<T: Packed, G: Geometry + 'static>(&mut self, geometry: G) -> AnyStage {
        let shock = Shock { slope: self.physics.equation.shock_slope() };
        // The return of the plain jump (method.md, section 10, "Coalescence, later", has 300/C for J_r itself).
        let limited =
            Limited { sharpness: 4000.0 / self.physics.sound_speed.max(self.physics.shifting_speed) };
        match (self.with_viscosity(), self.with_shocks(), self.reconstructs(), self.besides()) {
            (true, _, true, _) => self.viscous::<T, _, _>(geometry, limited),
            (true, ..) => self.viscous::<T, _, _>(geometry, FirstOrder),
            (_, true, ..) => self.inviscid::<ShockRecord<T>, _, _>(geometry, shock),
            (_, _, true, _) => self.inviscid::<DeformationRecord<T>, _, _>(geometry, limited),
            (.., Besides::Nothing) if self.physics.method.precision == Precision::Double => {
                self.plain(geometry)
            }
            _ => self.inviscid::<DeformationRecord<T>, _, _>(geometry, FirstOrder),
        }
    }

    fn problem<G, F>(&self, geometry: G, reconstruction: F) -> ContactProblem<G, F> {
        let support = self.packing.support(self.physics.method.precision);
        ContactProblem { geometry, support, reconstruction }
    }

    fn inviscid<R, G, F>(&mut self, geometry: G, reconstruction: F) -> AnyStage
    where
        R: FlowState<Scalar: Packed> + 'static,
        G: Geometry + 'static,
        F: Reconstruction<R> + ImageContact<R> + 'static,
    {
        let problem = self.problem(geometry, reconstruction);
        let sums = self.sums(&problem);
        self.fused::<R, _, _>(problem, sums)
    }

    /// With rows that hold nothing but the flow state. The paper's sums are fused without a question.
    fn plain<G: Geometry + 'static>(&mut self, geometry: G) -> AnyStage {
        let problem = self.problem(geometry, FirstOrder);
        match self.sums(&problem) {
            (flow, (Some(moment), Some(weight), None), None) if self.shifting() == 0.0 => {
                self.pass::<FlowRecord, _, _, _, _>(problem, (flow, (moment, weight)), ())
            }
            sums => self.fused::<FlowRecord, _, _>(problem, sums),
        }
    }

    fn viscous<T, G, F>(&mut self, geometry: G, reconstruction: F) -> AnyStage
    where
        T: Packed,
        G: Geometry + 'static,
        F: Reconstruction<DeformationRecord<T>> + ImageContact<DeformationRecord<T>> + 'static,
    {
        let problem = self.problem(geometry, reconstruction);
        let sums = self.sums(&problem);
        let (viscosity, with_energy) = (self.physics.viscosity, self.with_energy());
        let viscosity = Viscosity::new(&mut self.wiring, geometry, viscosity, with_energy);
        let gradient = self.concentration_gradient();
        self.pass::<DeformationRecord<T>, _, _, _, _>(problem, (sums, viscosity), gradient)
    }

    fn sums<G: Geometry, F: Copy>(&mut self, problem: &ContactProblem<G, F>) -> Sums<G, F> {
        self.wiring.stage("flux");
        let &ContactProblem { geometry, support, reconstruction } = problem;
        let images = self.without_images().then_some((support, reconstruction));
        let apart = self.with_dissipation();
        let flow = (
            DensityRate::new(&mut self.wiring, geometry),
            PressureRiemann::new(&mut self.wiring, geometry, images, apart),
        );
        let moment = (self.with_surface() || self.with_gradient() || self.physics.method.kernel_correction)
            .then(|| MomentMatrix::new(&mut self.wiring));
        let weight = self.with_tension().then(|| GhostWeight::new(&mut self.wiring, geometry));
        let sum = self.with_gradient().then(|| VelocitySum::new(&mut self.wiring));
        let energy = self.with_energy().then(|| EnergyRate::new(&mut self.wiring, geometry));
        (flow, (moment, weight, sum), energy)
    }

    /// Only steps that shift need it.
    fn concentration_gradient(&mut self) -> Option<ConcentrationGradient> {
        let theta = self.physics.method.theta;
        (self.shifting() > 0.0).then(|| ConcentrationGradient::new(&mut self.wiring, theta))
    }

    /// The sums of most scenes are fused without a question; the rest are options.
    fn fused<R, G, F>(&mut self, problem: ContactProblem<G, F>, sums: Sums<G, F>) -> AnyStage
    where
        R: FlowState<Scalar: Packed> + 'static,
        G: Geometry + 'static,
        F: Reconstruction<R> + ImageContact<R> + 'static,
    {
        let gradient = self.concentration_gradient();
        match sums {
            (flow, (Some(moment), Some(weight), Some(sum)), energy) => {
                self.pass::<R, _, _, _, _>(problem, (flow, (moment, weight, sum), energy), gradient)
            }
            sums => self.pass::<R, _, _, _, _>(problem, sums, gradient),
        }
    }

    fn pass<R, G, F, T, S>(&self, problem: ContactProblem<G, F>, terms: T, seldom: S) -> AnyStage
    where
        R: FlowState<Scalar: Packed> + 'static,
        G: Geometry + 'static,
        F: Reconstruction<R> + 'static,
        T: PairTerm<R, Contact<R::Scalar>> + 'static,
        S: PairTerm<R, Contact<R::Scalar>> + 'static,
    {
        let seldom = (seldom, self.shifting_interval());
        AnyStage::chunks(PairPass::<R, _, _, _>::new("flux", problem, terms, seldom, self.unit()))
    }
}
