//! What a flux pass knows of a particle: the packed record and its slots.

use meniscus_engine::lanes::{Lanes, Row, WIDTH};
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

/// Velocity gradient and kernel scale: the second row, where the flux needs it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Gradient<T> {
    /// d U_r/d r, 1/s.
    pub rr: T,
    /// d U_r/d z, 1/s.
    pub rz: T,
    /// d U_z/d r, 1/s.
    pub zr: T,
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

/// A record of two rows: flow state, velocity gradient and kernel scale.
#[derive(Clone, Copy, Debug)]
pub struct GradientRecord {
    flow: Flow<Lanes>,
    gradient: Gradient<Lanes>,
}

/// A record that holds a flow state.
pub trait FlowState: Record {
    /// The flow state.
    fn flow(&self) -> &Flow<Lanes>;
    /// Factor of the kernel gradient; one where the scene doesn't correct it.
    fn kernel_scale(&self) -> Lanes;
}

/// A record that holds the velocity gradient as well.
pub trait GradientState: FlowState {
    /// The velocity gradient.
    fn gradient(&self) -> &Gradient<Lanes>;
}

impl Record for FlowRecord {
    const ROWS: usize = 1;
    #[inline(always)]
    fn from_slots(first: [Lanes; WIDTH], _: [Lanes; WIDTH]) -> Self {
        FlowRecord {
            flow: Flow::unpack(first),
        }
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

impl Record for GradientRecord {
    const ROWS: usize = 2;
    #[inline(always)]
    fn from_slots(first: [Lanes; WIDTH], second: [Lanes; WIDTH]) -> Self {
        let [rr, rz, zr, zz, kernel_scale, ..] = second;
        GradientRecord {
            flow: Flow::unpack(first),
            gradient: Gradient {
                rr,
                rz,
                zr,
                zz,
                kernel_scale,
            },
        }
    }
}

impl FlowState for GradientRecord {
    #[inline(always)]
    fn flow(&self) -> &Flow<Lanes> {
        &self.flow
    }
    #[inline(always)]
    fn kernel_scale(&self) -> Lanes {
        self.gradient.kernel_scale
    }
}

impl GradientState for GradientRecord {
    #[inline(always)]
    fn gradient(&self) -> &Gradient<Lanes> {
        &self.gradient
    }
}

impl<T> Flow<T> {
    #[inline(always)]
    fn unpack(
        [
            r,
            z,
            reach,
            area,
            velocity_r,
            velocity_z,
            pressure,
            impedance,
        ]: [T; WIDTH],
    ) -> Self {
        Flow {
            r,
            z,
            reach,
            area,
            velocity_r,
            velocity_z,
            pressure,
            impedance,
        }
    }
}

impl Flow<f64> {
    /// The state as a row.
    #[inline]
    pub fn pack(&self) -> Row {
        let Flow {
            r,
            z,
            reach,
            area,
            velocity_r,
            velocity_z,
            pressure,
            impedance,
        } = *self;
        Row([
            r, z, reach, area, velocity_r, velocity_z, pressure, impedance,
        ])
    }
}

impl Gradient<f64> {
    /// Gradient and scale as a row.
    #[inline]
    pub fn pack(&self) -> Row {
        Row([
            self.rr,
            self.rz,
            self.zr,
            self.zz,
            self.kernel_scale,
            0.0,
            0.0,
            0.0,
        ])
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

/// The second row of an image from that of its particle: a mirror changes the sign of mixed gradients.
pub fn image_of_gradient(image: &Image, row: &Row) -> Row {
    let [rr, rz, zr, zz, kernel_scale, ..] = row.0;
    let sign = if image.mirrored { -1.0 } else { 1.0 };
    Gradient {
        rr,
        rz: sign * rz,
        zr: sign * zr,
        zz,
        kernel_scale,
    }
    .pack()
}
