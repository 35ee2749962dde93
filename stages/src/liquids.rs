//! Equations of state: pressure and sound speed from density and internal energy.

/// A liquid or gas.
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// Whether the pressure depends on the internal energy; only then is it computed.
    const WITH_ENERGY: bool;
    /// Pressure in Pa at a density in kg/m3 and a specific internal energy in J/kg.
    fn pressure(&self, density: f64, energy: f64) -> f64;
    /// Speed of sound in m/s at a density in kg/m3 and a specific internal energy in J/kg.
    fn sound_speed(&self, density: f64, energy: f64) -> f64;
    /// The speed of sound in m/s if it is the same whatever the state.
    fn constant_sound_speed(&self) -> Option<f64> {
        None
    }
    /// s of D = C + s u, by which a shock of speed D outruns sound where it sets the liquid before it in
    /// motion with the speed u; zero for a liquid whose flow has no shocks.
    fn shock_slope(&self) -> f64;
}

/// P = C_0^2 (rho - rho_0) (method.md, section 5).
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// C_0 in m/s.
    pub sound_speed: f64,
    /// rho_0 in kg/m3.
    pub reference_density: f64,
}

impl EquationOfState for Linear {
    const WITH_ENERGY: bool = false;

    fn pressure(&self, density: f64, _: f64) -> f64 {
        self.sound_speed * self.sound_speed * (density - self.reference_density)
    }

    fn sound_speed(&self, _: f64, _: f64) -> f64 {
        self.sound_speed
    }

    fn constant_sound_speed(&self) -> Option<f64> {
        Some(self.sound_speed)
    }

    fn shock_slope(&self) -> f64 {
        0.0
    }
}

/// Mie-Grueneisen with two reference curves: P = P_ref + gamma rho (e - e_ref); in compression the
/// shock adiabat D = c_a + s_a u, in expansion a straight line (method.md, section 5).
#[derive(Clone, Copy, Debug)]
pub struct MieGrueneisen {
    /// rho_0 in kg/m3.
    pub reference_density: f64,
    /// c_a in m/s.
    pub sound_speed: f64,
    /// s_a.
    pub slope: f64,
    /// gamma.
    pub grueneisen: f64,
}

impl MieGrueneisen {
    /// P_ref, e_ref and their derivatives by y = 1 - rho_0/rho.
    fn reference(&self, y: f64) -> [f64; 4] {
        let square = self.sound_speed * self.sound_speed;
        let scale = self.reference_density * square;
        if y < 0.0 {
            return [scale * y, 0.5 * square * y * y, scale, square * y];
        }
        let nearness = 1.0 - self.slope * y;
        let cube = nearness * nearness * nearness;
        [
            scale * y / (nearness * nearness),
            0.5 * square * y * y / (nearness * nearness),
            scale * (1.0 + self.slope * y) / cube,
            square * y / cube,
        ]
    }
}

impl EquationOfState for MieGrueneisen {
    const WITH_ENERGY: bool = true;

    fn pressure(&self, density: f64, energy: f64) -> f64 {
        let [pressure, reference_energy, ..] = self.reference(1.0 - self.reference_density / density);
        pressure + self.grueneisen * density * (energy - reference_energy)
    }

    /// C^2 = (dP/d rho)_e + (P/rho^2) (dP/de)_rho.
    fn sound_speed(&self, density: f64, energy: f64) -> f64 {
        let x = self.reference_density / density;
        let [pressure, reference_energy, pressure_slope, energy_slope] = self.reference(1.0 - x);
        let excess = energy - reference_energy;
        let by_density = (pressure_slope - self.grueneisen * density * energy_slope) * x / density
            + self.grueneisen * excess;
        let pressure = pressure + self.grueneisen * density * excess;
        // In strong tension the square can fall to zero; waves then run at a tenth of c_a at least.
        let least = 0.01 * self.sound_speed * self.sound_speed;
        (by_density + self.grueneisen * pressure / density).max(least).sqrt()
    }

    fn shock_slope(&self) -> f64 {
        self.slope
    }
}

/// Least specific energy, J/kg, by which waves run in an ideal gas: one without heat would have no impedance.
const COLDEST: f64 = 1e-30;

/// P = (gamma - 1) rho e.
#[derive(Clone, Copy, Debug)]
pub struct IdealGas {
    /// Ratio of the specific heats, gamma.
    pub heat_ratio: f64,
}

impl EquationOfState for IdealGas {
    const WITH_ENERGY: bool = true;

    fn pressure(&self, density: f64, energy: f64) -> f64 {
        (self.heat_ratio - 1.0) * density * energy.max(0.0)
    }

    fn sound_speed(&self, _: f64, energy: f64) -> f64 {
        (self.heat_ratio * (self.heat_ratio - 1.0) * energy.max(COLDEST)).sqrt()
    }

    fn shock_slope(&self) -> f64 {
        // The limit of a strong shock, D = (gamma + 1) u/2.
        0.5 * (self.heat_ratio + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WATER: MieGrueneisen =
        MieGrueneisen { reference_density: 1000.0, sound_speed: 1483.0, slope: 2.0, grueneisen: 2.0 };

    #[test]
    fn a_shock_of_50_metres_per_second_lies_on_the_adiabat() {
        // Anchors: 50 + 50 m/s gives a shock speed of 1583 m/s and 79.15 MPa.
        let (shock, particle) = (1583.0, 50.0);
        let density = 1000.0 * shock / (shock - particle);
        let pressure = WATER.pressure(density, 0.5 * particle * particle);
        assert!((pressure - 79.15e6).abs() < 1.0, "{pressure}");
    }

    #[test]
    fn sound_speed_is_the_isentropic_slope() {
        for (density, energy) in [(1000.0, 0.0), (1080.0, 9000.0), (990.0, 300.0)] {
            let step = 1e-3;
            // Along an isentrope de = P/rho^2 d rho.
            let slope = WATER.pressure(density, energy) / (density * density);
            let up = WATER.pressure(density + step, energy + step * slope);
            let down = WATER.pressure(density - step, energy - step * slope);
            let expected = ((up - down) / (2.0 * step)).sqrt();
            let speed = WATER.sound_speed(density, energy);
            assert!((speed / expected - 1.0).abs() < 1e-5, "{density}: {speed} {expected}");
        }
        assert!((WATER.sound_speed(1000.0, 0.0) - 1483.0).abs() < 1e-9);
    }
}
