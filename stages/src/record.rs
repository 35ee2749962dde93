//! What a flux pass knows of a particle: the packed record and its slots.

use meniscus_engine::lanes::{HalfRow, Lanes, Row, WIDTH};
use meniscus_engine::neighbours::{Domain, Image};
use meniscus_engine::pairs::Record;

/// The flow state of one particle, as stages compute it and rows hold it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flow<T> {
    /// Radial coordinate, m.
    pub r: T,
    /// Axial coordinate, m.
    pub z: T,
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

/// A record of one row: the flow state alone.
#[derive(Clone, Copy, Debug)]
pub struct FlowRecord {
    flow: Flow<Lanes>,
}

/// A record of a row and a half: flow state, rate of deformation and kernel scale.
#[derive(Clone, Copy, Debug)]
pub struct DeformationRecord {
    flow: Flow<Lanes>,
    deformation: Deformation<Lanes>,
}

/// A record of a row and a half: flow state, density and kernel scale.
#[derive(Clone, Copy, Debug)]
pub struct ShockRecord {
    flow: Flow<Lanes>,
    /// Density, kg/m3.
    pub density: Lanes,
    kernel_scale: Lanes,
}

/// A record that holds a flow state.
pub trait FlowState: Record {
    /// The flow state.
    fn flow(&self) -> &Flow<Lanes>;
    /// Factor of the kernel gradient; one where the scene doesn't correct it.
    fn kernel_scale(&self) -> Lanes;
}

/// A record that holds the rate of deformation as well.
pub trait DeformationState: FlowState {
    /// The rate of deformation.
    fn deformation(&self) -> &Deformation<Lanes>;
}

impl Record for FlowRecord {
    const SECOND: bool = false;
    #[inline(always)]
    fn from_slots(first: [Lanes; WIDTH], _: [Lanes; WIDTH / 2]) -> Self {
        FlowRecord { flow: Flow::unpack(first) }
    }
}

impl FlowState for FlowRecord {
    #[inline(always)]
    fn flow(&self) -> &Flow<Lanes> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes {
        Lanes::ONE
    }
}

impl Record for DeformationRecord {
    const SECOND: bool = true;
    #[inline(always)]
    fn from_slots(first: [Lanes; WIDTH], second: [Lanes; WIDTH / 2]) -> Self {
        DeformationRecord { flow: Flow::unpack(first), deformation: Deformation::unpack(second) }
    }
}

impl FlowState for DeformationRecord {
    #[inline(always)]
    fn flow(&self) -> &Flow<Lanes> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes {
        self.deformation.kernel_scale
    }
}

impl Record for ShockRecord {
    const SECOND: bool = true;
    #[inline(always)]
    fn from_slots(first: [Lanes; WIDTH], [density, _, _, kernel_scale]: [Lanes; WIDTH / 2]) -> Self {
        ShockRecord { flow: Flow::unpack(first), density, kernel_scale }
    }
}

impl FlowState for ShockRecord {
    #[inline(always)]
    fn flow(&self) -> &Flow<Lanes> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes {
        self.kernel_scale
    }
}

impl DeformationState for DeformationRecord {
    #[inline(always)]
    fn deformation(&self) -> &Deformation<Lanes> {
        &self.deformation
    }
}

impl<T> Flow<T> {
    #[inline(always)]
    fn unpack([r, z, reach, area, velocity_r, velocity_z, pressure, impedance]: [T; WIDTH]) -> Self {
        Flow { r, z, reach, area, velocity_r, velocity_z, pressure, impedance }
    }
}

impl Flow<f64> {
    /// The state as a row.
    #[inline]
    pub fn pack(&self) -> Row {
        let Flow { r, z, reach, area, velocity_r, velocity_z, pressure, impedance } = *self;
        Row([r, z, reach, area, velocity_r, velocity_z, pressure, impedance])
    }
}

impl Flow<[f64; WIDTH]> {
    /// Turns the states of eight particles into as many rows as are asked for.
    #[inline(always)]
    pub fn pack_into(&self, rows: &mut [Row]) {
        let Flow { r, z, reach, area, velocity_r, velocity_z, pressure, impedance } = *self;
        let slots = [r, z, reach, area, velocity_r, velocity_z, pressure, impedance].map(Row);
        let eight = Lanes::transpose(std::array::from_fn(|slot| &slots[slot]));
        for (row, lanes) in rows.iter_mut().zip(eight) {
            *row = Row(lanes.to_array());
        }
    }
}

impl<T> Deformation<T> {
    #[inline(always)]
    fn unpack([rr, shear, zz, kernel_scale]: [T; WIDTH / 2]) -> Self {
        Deformation { rr, shear, zz, kernel_scale }
    }
}

impl Deformation<f64> {
    /// Deformation and scale as half a row.
    #[inline]
    pub fn pack(&self) -> HalfRow {
        HalfRow([self.rr, self.shear, self.zz, self.kernel_scale])
    }
}

impl ShockRecord {
    /// Density in kg/m3 and scale as half a row.
    #[inline]
    pub fn pack_second(density: f64, kernel_scale: f64) -> HalfRow {
        HalfRow([density, 0.0, 0.0, kernel_scale])
    }
}

/// The first row of an image from that of its particle (method.md, section 4).
pub fn image_of_flow(image: &Image, domain: &Domain, row: &Row) -> Row {
    let mut flow = Flow::unpack(row.0);
    (flow.r, flow.z) = domain.place(image, flow.r, flow.z);
    if image.mirrored {
        flow.velocity_r = -flow.velocity_r;
    }
    flow.pack()
}

/// The second row of an image from that of its particle: a mirror changes the sign of the shear, whose slot
/// a row without one leaves zero.
pub fn image_of_second(image: &Image, row: &HalfRow) -> HalfRow {
    let mut deformation = Deformation::unpack(row.0);
    if image.mirrored {
        deformation.shear = -deformation.shear;
    }
    deformation.pack()
}
