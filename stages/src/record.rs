//! What a flux pass knows of a particle: the packed record and its slots.

use meniscus_engine::lanes::{Double, Lanes, Places, Scalar, Slots};
use meniscus_engine::pairs::Record;

/// The precision of pair sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Double precision throughout.
    Double,
    /// Pairs in single precision, with places as integers; everything else in double precision.
    Mixed,
}

/// The flow state of one particle, as stages compute it and rows hold it. Units are those of double precision.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flow<T, P = T> {
    /// Radial coordinate, m.
    pub r: P,
    /// Axial coordinate, m.
    pub z: P,
    /// Size D, the root of the area V = m/(2 pi r rho), m.
    pub size: T,
    /// Radial velocity, m/s.
    pub velocity_r: T,
    /// Axial velocity, m/s.
    pub velocity_z: T,
    /// Pressure less the reference pressure, Pa.
    pub pressure: T,
    /// Acoustic impedance rho C, kg/(m2 s), of which six digits are kept. It weighs the states of a contact, and the
    /// same for both particles.
    pub impedance: T,
}

/// The rate of deformation from which velocities are reconstructed, of which three digits are kept: what the limiter makes of the
/// rest is a thousandth of the jump that a flow without a reconstruction has, now of one sign, now of the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deformation<T> {
    /// d U_r/d r, 1/s.
    pub rr: T,
    /// d U_r/d z + d U_z/d r, 1/s.
    pub shear: T,
    /// d U_z/d z, 1/s.
    pub zz: T,
}

/// A flow state in lanes.
pub type FlowLanes<T> = Flow<Lanes<T>, Places<T>>;

/// A record of the flow state alone.
#[derive(Clone, Copy, Debug)]
pub struct FlowRecord {
    flow: FlowLanes<Double>,
    coordinate: Lanes<Double>,
}

/// A record of flow state, kernel scale and rate of deformation.
#[derive(Clone, Copy, Debug)]
pub struct DeformationRecord<T: Scalar = f64> {
    flow: FlowLanes<T>,
    kernel_scale: Lanes<T>,
    deformation: Deformation<Lanes<T>>,
    coordinate: Lanes<T>,
}

/// A record of flow state, kernel scale and density.
#[derive(Clone, Copy, Debug)]
pub struct ShockRecord<T: Scalar = f64> {
    flow: FlowLanes<T>,
    /// Density, kg/m3.
    pub density: Lanes<T>,
    kernel_scale: Lanes<T>,
    coordinate: Lanes<T>,
}

/// A record that holds a flow state.
pub trait FlowState: Record {
    /// The flow state.
    fn flow(&self) -> &FlowLanes<Self::Scalar>;
    /// Factor of the kernel gradient; one where the scene doesn't correct it.
    fn kernel_scale(&self) -> Lanes<Self::Scalar>;
    /// The radial coordinate as a number; a neighbour's may be missing.
    fn coordinate(&self) -> Lanes<Self::Scalar>;

    /// Distance from the axis, which lies `origin` before that of the coordinates.
    #[inline(always)]
    fn radius(&self, origin: f64) -> Lanes<Self::Scalar> {
        self.coordinate() + Lanes::splat(origin)
    }

    /// The same for a neighbour of `near`.
    #[inline(always)]
    fn radius_near(&self, near: &Self, origin: f64) -> Lanes<Self::Scalar> {
        self.flow().r.coordinates(near.flow().r, near.coordinate()) + Lanes::splat(origin)
    }
}

/// A record that holds the rate of deformation as well.
pub trait DeformationState: FlowState {
    /// The rate of deformation.
    fn deformation(&self) -> &Deformation<Lanes<Self::Scalar>>;
}

impl Record for FlowRecord {
    type Scalar = Double;
    #[inline(always)]
    fn from_slots(slots: Slots<Double>) -> Self {
        FlowRecord { flow: Flow::of_slots(&slots), coordinate: slots.coordinate }
    }
}

impl FlowState for FlowRecord {
    #[inline(always)]
    fn flow(&self) -> &FlowLanes<Double> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes<Double> {
        Lanes::ONE
    }
    #[inline(always)]
    fn coordinate(&self) -> Lanes<Double> {
        self.coordinate
    }
}

impl<T: Scalar> Record for DeformationRecord<T> {
    type Scalar = T;
    #[inline(always)]
    fn from_slots(slots: Slots<T>) -> Self {
        let [rr, shear, zz] = slots.thirds;
        DeformationRecord {
            flow: Flow::of_slots(&slots),
            kernel_scale: slots.halves[1],
            deformation: Deformation { rr, shear, zz },
            coordinate: slots.coordinate,
        }
    }
}

impl<T: Scalar> FlowState for DeformationRecord<T> {
    #[inline(always)]
    fn flow(&self) -> &FlowLanes<T> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes<T> {
        self.kernel_scale
    }
    #[inline(always)]
    fn coordinate(&self) -> Lanes<T> {
        self.coordinate
    }
}

impl<T: Scalar> Record for ShockRecord<T> {
    type Scalar = T;
    #[inline(always)]
    fn from_slots(slots: Slots<T>) -> Self {
        ShockRecord {
            flow: Flow::of_slots(&slots),
            density: slots.last,
            kernel_scale: slots.halves[1],
            coordinate: slots.coordinate,
        }
    }
}

impl<T: Scalar> FlowState for ShockRecord<T> {
    #[inline(always)]
    fn flow(&self) -> &FlowLanes<T> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes<T> {
        self.kernel_scale
    }
    #[inline(always)]
    fn coordinate(&self) -> Lanes<T> {
        self.coordinate
    }
}

impl<T: Scalar> DeformationState for DeformationRecord<T> {
    #[inline(always)]
    fn deformation(&self) -> &Deformation<Lanes<T>> {
        &self.deformation
    }
}

impl<T: Scalar> FlowLanes<T> {
    #[inline(always)]
    fn of_slots(slots: &Slots<T>) -> Self {
        let ([r, z, size, velocity_r, velocity_z, pressure], [impedance, _]) = (slots.whole, slots.halves);
        let (r, z) = (Places::of_slot(r), Places::of_slot(z));
        Flow { r, z, size, velocity_r, velocity_z, pressure, impedance }
    }
}
