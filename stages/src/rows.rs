//! How states become the packed rows of the flux pass, and rows those of images.

use crate::record::{Deformation, Flow};
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::lanes::{COORDINATE, HalfRow, Lanes, Row, RowPart, RowTable, SingleRow, WIDTH, place};

/// A row that takes up flow states.
pub trait FirstPart: Send + Sized {
    /// The rows of that kind.
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [Self];

    /// Turns the states of eight particles into as many rows as are asked for, with `unit` metres as the unit
    /// of length in single precision.
    fn pack(flow: &Flow<[f64; WIDTH]>, rows: &mut [Self], unit: f64);

    /// No more than the reach, m, that was packed.
    fn least_reach(&self, unit: f64) -> f64;
}

/// A row that takes up what follows the flow state.
pub trait SecondPart: Send + Sized {
    /// The rows of that kind.
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [Self];

    /// Takes up rate of deformation and kernel scale, with `unit` metres as the unit of length in single
    /// precision.
    fn set_deformation(&mut self, deformation: &Deformation<f64>, unit: f64);

    /// Takes up density in kg/m3 and kernel scale.
    fn set_density(&mut self, density: f64, kernel_scale: f64);
}

impl FirstPart for Row {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [Row] {
        rows.first
    }

    #[inline(always)]
    fn pack(flow: &Flow<[f64; WIDTH]>, rows: &mut [Row], _: f64) {
        let Flow { r, z, reach, area, velocity_r, velocity_z, pressure, impedance } = *flow;
        let slots = [r, z, reach, area, velocity_r, velocity_z, pressure, impedance].map(Row);
        let eight = Lanes::transpose(std::array::from_fn(|slot| &slots[slot]));
        for (row, lanes) in rows.iter_mut().zip(eight) {
            *row = Row(lanes.to_array());
        }
    }

    #[inline(always)]
    fn least_reach(&self, _: f64) -> f64 {
        self.0[2]
    }
}

impl FirstPart for SingleRow {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [SingleRow] {
        rows.single
    }

    #[inline(always)]
    fn pack(flow: &Flow<[f64; WIDTH]>, rows: &mut [SingleRow], unit: f64) {
        let inverse = 1.0 / unit;
        let single = |values: &[f64; WIDTH], factor: f64| values.map(|value| (value * factor) as f32);
        let slots = [
            flow.r.map(|r| place(r * inverse)),
            flow.z.map(|z| place(z * inverse)),
            single(&flow.reach, inverse),
            single(&flow.area, inverse * inverse),
            single(&flow.velocity_r, 1.0),
            single(&flow.velocity_z, 1.0),
            single(&flow.pressure, 1.0),
            single(&flow.impedance, 1.0),
        ];
        SingleRow::set_first(rows, slots);
        for (SingleRow(slots), r) in rows.iter_mut().zip(single(&flow.r, inverse)) {
            slots[COORDINATE] = r;
        }
    }

    #[inline(always)]
    fn least_reach(&self, unit: f64) -> f64 {
        f64::from(self.0[2] * (1.0 - f32::EPSILON)) * unit
    }
}

impl SecondPart for HalfRow {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [HalfRow] {
        rows.second
    }

    #[inline(always)]
    fn set_deformation(&mut self, deformation: &Deformation<f64>, _: f64) {
        let Deformation { rr, shear, zz, kernel_scale } = *deformation;
        *self = HalfRow([rr, shear, zz, kernel_scale]);
    }

    #[inline(always)]
    fn set_density(&mut self, density: f64, kernel_scale: f64) {
        *self = HalfRow([density, 0.0, 0.0, kernel_scale]);
    }
}

impl SecondPart for SingleRow {
    fn of<'a>(rows: &'a mut RowPart<'_>) -> &'a mut [SingleRow] {
        rows.single
    }

    #[inline(always)]
    fn set_deformation(&mut self, deformation: &Deformation<f64>, unit: f64) {
        let Deformation { rr, shear, zz, kernel_scale } = *deformation;
        let second = [rr * unit, shear * unit, zz * unit, kernel_scale];
        self.0[WIDTH..COORDINATE].copy_from_slice(&second.map(|value| value as f32));
    }

    #[inline(always)]
    fn set_density(&mut self, density: f64, kernel_scale: f64) {
        self.0[WIDTH..COORDINATE].copy_from_slice(&[density as f32, 0.0, 0.0, kernel_scale as f32]);
    }
}

/// What the rows tell of particles as they are at the beginning of the step: no columns hold it.
#[derive(Clone, Copy, Debug)]
pub struct PackedState<'a>(pub &'a RowTable);

impl PackedState<'_> {
    /// Half the support radius of a pair of equals, m.
    #[inline(always)]
    pub fn reach(self, particle: usize) -> f64 {
        let [_, _, reach, ..] = self.slots(particle);
        reach * self.unit()
    }

    /// Area, m2.
    #[inline(always)]
    pub fn area(self, particle: usize) -> f64 {
        let [_, _, _, area, ..] = self.slots(particle);
        area * (self.unit() * self.unit())
    }

    /// The areas of the eight particles from `first` on, m2.
    #[inline(always)]
    pub fn areas(self, first: usize) -> Lanes {
        match self.0.first.get(first..first + WIDTH) {
            Some(rows) => Lanes::load(&std::array::from_fn::<f64, WIDTH, _>(|lane| rows[lane].0[3])),
            None => Lanes::load(&std::array::from_fn::<f64, WIDTH, _>(|lane| self.area(first + lane))),
        }
    }

    /// D, the root of the area, m.
    #[inline(always)]
    pub fn size(self, particle: usize) -> f64 {
        self.area(particle).sqrt()
    }

    /// Pressure less the reference pressure, Pa.
    #[inline(always)]
    pub fn pressure(self, particle: usize) -> f64 {
        let [.., pressure, _] = self.slots(particle);
        pressure
    }

    #[inline(always)]
    fn slots(self, particle: usize) -> [f64; WIDTH] {
        match self.0.first.get(particle) {
            Some(Row(slots)) => *slots,
            None => std::array::from_fn(|slot| f64::from(self.0.single[particle].0[slot])),
        }
    }

    /// In double precision the unit is the metre.
    #[inline(always)]
    fn unit(self) -> f64 {
        if self.0.single.is_empty() { 1.0 } else { self.0.unit }
    }
}

/// The first row of an image from that of its particle (method.md, section 4).
pub fn image_of_first(image: &Image, domain: &Domain, Row(slots): &Row) -> Row {
    let [r, z, reach, area, velocity_r, velocity_z, pressure, impedance] = *slots;
    let (r, z) = domain.place(image, r, z);
    let velocity_r = if image.mirrored { -velocity_r } else { velocity_r };
    Row([r, z, reach, area, velocity_r, velocity_z, pressure, impedance])
}

/// The second row of an image from that of its particle: a mirror changes the sign of the shear, whose slot
/// a row without one leaves zero.
pub fn image_of_second(image: &Image, HalfRow([rr, shear, zz, kernel_scale]): &HalfRow) -> HalfRow {
    HalfRow([*rr, if image.mirrored { -shear } else { *shear }, *zz, *kernel_scale])
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
        slots[4] = -slots[4];
        slots[9] = -slots[9];
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
        let flow = Flow {
            reach: of(|k| 1.1 + k),
            area: of(|k| 2.0 + k),
            pressure: of(|k| 3.0 - k),
            ..Flow::default()
        };
        let mut double = RowTable { first: vec![Row::default(); WIDTH], ..RowTable::default() };
        Row::pack(&flow, &mut double.first, unit);
        let mut mixed = RowTable { single: vec![SingleRow::default(); WIDTH], unit, ..RowTable::default() };
        SingleRow::pack(&flow, &mut mixed.single, unit);
        for k in 0..WIDTH {
            for packed in [PackedState(&double), PackedState(&mixed)] {
                let close =
                    |found: f64, expected: f64| (found - expected).abs() < 1e-6 * expected.abs().max(1.0);
                assert!(close(packed.reach(k), flow.reach[k]) && close(packed.area(k), flow.area[k]));
                assert_eq!(packed.areas(0).to_array()[k], packed.area(k));
                assert!(
                    close(packed.size(k), flow.area[k].sqrt()) && close(packed.pressure(k), flow.pressure[k])
                );
            }
            assert_eq!(double.first[k].least_reach(unit), flow.reach[k]);
            assert!(mixed.single[k].least_reach(unit) <= flow.reach[k], "whatever was rounded");
        }
    }
}
