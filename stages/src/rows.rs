//! How states become the packed rows of the flux pass, and rows those of images.

use crate::record::{Deformation, Flow};
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::lanes::{
    COORDINATE, Lanes, Row, RowPart, RowTable, SingleRow, THIRDS, WIDTH, place, with_second_third_turned,
};

/// What rows hold of eight particles.
pub struct RowState {
    /// What every flux needs.
    pub flow: Flow<[f64; WIDTH]>,
    /// Factors of the kernel gradient.
    pub kernel_scale: [f64; WIDTH],
    /// What only some need.
    pub rest: Rest,
}

/// What a row holds besides the flow state and the kernel scale.
pub enum Rest {
    /// Nothing.
    Nothing,
    /// The rate of deformation.
    Deformation(Deformation<[f64; WIDTH]>),
    /// Density, kg/m3.
    Density([f64; WIDTH]),
}

/// A row that takes up states.
pub trait StateRow: Send + Sized {
    /// The rows of that kind.
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [Self];

    /// Turns the states of eight particles into as many rows as are asked for, with `unit` metres as the unit
    /// of length in single precision.
    fn pack(state: &RowState, rows: &mut [Self], unit: f64);

    /// No more than the size, m, that was packed.
    fn least_size(&self, unit: f64) -> f64;
}

impl StateRow for Row {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [Row] {
        rows.double
    }

    #[inline(always)]
    fn pack(RowState { flow, kernel_scale, rest }: &RowState, rows: &mut [Row], _: f64) {
        let Flow { r, z, size, velocity_r, velocity_z, pressure, impedance } = *flow;
        let shared = Lanes::of_halves([&impedance, kernel_scale].map(|eight| Lanes::load(eight))).to_array();
        let last = match rest {
            Rest::Nothing => [0.0; WIDTH],
            Rest::Deformation(Deformation { rr, shear, zz }) => {
                Lanes::of_thirds([rr, shear, zz].map(|eight| Lanes::load(eight))).to_array()
            }
            Rest::Density(density) => *density,
        };
        let slots = [r, z, size, velocity_r, velocity_z, pressure, shared, last].map(Row);
        let eight = Lanes::transpose(std::array::from_fn(|slot| &slots[slot]));
        for (row, lanes) in rows.iter_mut().zip(eight) {
            *row = Row(lanes.to_array());
        }
    }

    #[inline(always)]
    fn least_size(&self, _: f64) -> f64 {
        self.0[SIZE]
    }
}

impl StateRow for SingleRow {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [SingleRow] {
        rows.single
    }

    #[inline(always)]
    fn pack(RowState { flow, kernel_scale, rest }: &RowState, rows: &mut [SingleRow], unit: f64) {
        let inverse = 1.0 / unit;
        let single = |values: &[f64; WIDTH], factor: f64| values.map(|value| (value * factor) as f32);
        let first = [
            flow.r.map(|r| place(r * inverse)),
            flow.z.map(|z| place(z * inverse)),
            single(&flow.size, inverse),
            single(&flow.velocity_r, 1.0),
            single(&flow.velocity_z, 1.0),
            single(&flow.pressure, 1.0),
            single(&flow.impedance, 1.0),
            single(kernel_scale, 1.0),
        ];
        SingleRow::set_first(rows, first);
        let coordinates = single(&flow.r, inverse);
        for (lane, SingleRow(slots)) in rows.iter_mut().enumerate() {
            let rest = match rest {
                Rest::Nothing => [0.0; 3],
                Rest::Deformation(Deformation { rr, shear, zz }) => {
                    [rr[lane] * unit, shear[lane] * unit, zz[lane] * unit]
                }
                Rest::Density(density) => [density[lane], 0.0, 0.0],
            };
            slots[THIRDS..THIRDS + 3].copy_from_slice(&rest.map(|value| value as f32));
            slots[COORDINATE] = coordinates[lane];
        }
    }

    #[inline(always)]
    fn least_size(&self, unit: f64) -> f64 {
        f64::from(self.0[SIZE] * (1.0 - f32::EPSILON)) * unit
    }
}

/// The slots of size and pressure.
const SIZE: usize = 2;
const PRESSURE: usize = 5;

/// What the rows tell of particles as they are at the beginning of the step: no columns hold it.
#[derive(Clone, Copy, Debug)]
pub struct PackedState<'a>(pub &'a RowTable);

impl PackedState<'_> {
    /// Size D, m.
    #[inline(always)]
    pub fn size(self, particle: usize) -> f64 {
        match self.0.double.get(particle) {
            Some(Row(slots)) => slots[SIZE],
            None => f64::from(self.0.single[particle].0[SIZE]) * self.0.unit,
        }
    }

    /// Area, the square of the size, m2.
    #[inline(always)]
    pub fn area(self, particle: usize) -> f64 {
        let size = self.size(particle);
        size * size
    }

    /// The sizes of the eight particles from `first` on, m.
    #[inline(always)]
    pub fn sizes(self, first: usize) -> Lanes {
        let sizes = match self.0.double.get(first..first + WIDTH) {
            Some(rows) => std::array::from_fn::<f64, WIDTH, _>(|lane| rows[lane].0[SIZE]),
            None => std::array::from_fn(|lane| self.size(first + lane)),
        };
        Lanes::load(&sizes)
    }

    /// Their areas, m2.
    #[inline(always)]
    pub fn areas(self, first: usize) -> Lanes {
        let sizes = self.sizes(first);
        sizes * sizes
    }

    /// Pressure less the reference pressure, Pa.
    #[inline(always)]
    pub fn pressure(self, particle: usize) -> f64 {
        match self.0.double.get(particle) {
            Some(Row(slots)) => slots[PRESSURE],
            None => f64::from(self.0.single[particle].0[PRESSURE]),
        }
    }
}

/// The row of an image from that of its particle (method.md, section 4): a mirror turns the radial velocity and
/// the shear, if the row `deforms`.
pub fn image_of_double(image: &Image, domain: &Domain, deforms: bool, Row(slots): &Row) -> Row {
    let mut slots = *slots;
    let (r, z) = domain.place(image, slots[0], slots[1]);
    slots[..2].copy_from_slice(&[r, z]);
    if image.mirrored {
        slots[3] = -slots[3];
        if deforms {
            slots[7] = with_second_third_turned(slots[7]);
        }
    }
    Row(slots)
}

/// The row of an image in single precision, with `unit` metres as the unit of length.
pub fn image_of_single(image: &Image, domain: &Domain, unit: f64, SingleRow(slots): &SingleRow) -> SingleRow {
    let mut slots = *slots;
    let moved = |steps: u32, by: f64| f32::from_bits(steps.wrapping_add(place(by / unit).to_bits()));
    slots[1] = moved(slots[1].to_bits(), image.shift);
    if image.mirrored {
        let mirror = domain.mirror(0.0);
        slots[0] = moved(slots[0].to_bits().wrapping_neg(), mirror);
        slots[COORDINATE] = (mirror / unit) as f32 - slots[COORDINATE];
        // The radial velocity and the shear.
        slots[3] = -slots[3];
        slots[THIRDS + 1] = -slots[THIRDS + 1];
    }
    SingleRow(slots)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_tell_sizes_and_pressures() {
        let unit = 0.25;
        let of = |of: fn(f64) -> f64| std::array::from_fn(|lane| of(lane as f64));
        let flow = Flow { size: of(|k| 1.1 + k), pressure: of(|k| 3.0 - k), ..Flow::default() };
        let state = RowState { flow, kernel_scale: [1.0; WIDTH], rest: Rest::Nothing };
        let mut double = RowTable { double: vec![Row::default(); WIDTH], ..RowTable::default() };
        Row::pack(&state, &mut double.double, unit);
        let mut mixed = RowTable { single: vec![SingleRow::default(); WIDTH], unit, ..RowTable::default() };
        SingleRow::pack(&state, &mut mixed.single, unit);
        for k in 0..WIDTH {
            for packed in [PackedState(&double), PackedState(&mixed)] {
                let close =
                    |found: f64, expected: f64| (found - expected).abs() < 1e-6 * expected.abs().max(1.0);
                assert!(close(packed.size(k), flow.size[k]) && close(packed.pressure(k), flow.pressure[k]));
                assert_eq!(packed.areas(0).to_array()[k], packed.area(k));
            }
            assert_eq!(double.double[k].least_size(unit), flow.size[k]);
            assert!(mixed.single[k].least_size(unit) <= flow.size[k], "whatever was rounded");
        }
    }
}
