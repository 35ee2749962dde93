//! What a flux pass knows of a particle: the packed record and its slots.

use meniscus_engine::lanes::{Lanes, Places, Scalar, Slots, WIDTH};
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
    /// Half the support radius of a pair of equals, 2 theta D, m.
    pub reach: T,
    /// Area V = m/(2 pi r rho), m2.
    pub area: T,
    /// Radial velocity, m/s.
    pub velocity_r: T,
    /// Axial velocity, m/s.
    pub velocity_z: T,
    /// Pressure less the reference pressure, Pa.
    pub pressure: T,
    /// Acoustic impedance rho C, kg/(m2 s).
    pub impedance: T,
}

/// Rate of deformation and kernel scale: the second row, where the flux needs it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deformation<T> {
    /// d U_r/d r, 1/s.
    pub rr: T,
    /// d U_r/d z + d U_z/d r, 1/s.
    pub shear: T,
    /// d U_z/d z, 1/s.
    pub zz: T,
    /// Factor of the kernel gradient.
    pub kernel_scale: T,
}

/// A flow state in lanes.
pub type FlowLanes<T> = Flow<Lanes<T>, Places<T>>;

/// A record of one row: the flow state alone.
#[derive(Clone, Copy, Debug)]
pub struct FlowRecord {
    flow: FlowLanes<f64>,
    coordinate: Lanes,
}

/// A record of a row and a half: flow state, rate of deformation and kernel scale.
#[derive(Clone, Copy, Debug)]
pub struct DeformationRecord<T: Scalar = f64> {
    flow: FlowLanes<T>,
    deformation: Deformation<Lanes<T>>,
    coordinate: Lanes<T>,
}

/// A record of a row and a half: flow state, density and kernel scale.
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
    type Scalar = f64;
    const SECOND: bool = false;
    #[inline(always)]
    fn from_slots(slots: Slots) -> Self {
        FlowRecord { flow: Flow::of_slots(slots.first), coordinate: slots.coordinate }
    }
}

impl FlowState for FlowRecord {
    #[inline(always)]
    fn flow(&self) -> &FlowLanes<f64> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes {
        Lanes::ONE
    }
    #[inline(always)]
    fn coordinate(&self) -> Lanes {
        self.coordinate
    }
}

impl<T: Scalar> Record for DeformationRecord<T> {
    type Scalar = T;
    const SECOND: bool = true;
    #[inline(always)]
    fn from_slots(slots: Slots<T>) -> Self {
        let [rr, shear, zz, kernel_scale] = slots.second;
        DeformationRecord {
            flow: Flow::of_slots(slots.first),
            deformation: Deformation { rr, shear, zz, kernel_scale },
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
        self.deformation.kernel_scale
    }
    #[inline(always)]
    fn coordinate(&self) -> Lanes<T> {
        self.coordinate
    }
}

impl<T: Scalar> Record for ShockRecord<T> {
    type Scalar = T;
    const SECOND: bool = true;
    #[inline(always)]
    fn from_slots(slots: Slots<T>) -> Self {
        ShockRecord {
            flow: Flow::of_slots(slots.first),
            density: slots.second[0],
            kernel_scale: slots.second[3],
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
    fn of_slots([r, z, reach, area, velocity_r, velocity_z, pressure, impedance]: [Lanes<T>; WIDTH]) -> Self {
        let (r, z) = (Places::of_slot(r), Places::of_slot(z));
        Flow { r, z, reach, area, velocity_r, velocity_z, pressure, impedance }
    }
}
