//! The equations of the method, pair by pair, in the plainest form: no lists, no lanes, no packing.
//!
//! Written from the equations of method.md alone, so that an error in the engine or its stages cannot
//! stand here as well. Numbers in round brackets are the paper's equations.

use std::f64::consts::PI;

/// A vector of the half plane in the order r, z.
pub type Vector = [f64; 2];

/// A matrix; rows are velocity components, columns directions.
pub type Matrix = [[f64; 2]; 2];

/// One particle, in SI units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Particle {
    /// Position less the origin.
    pub position: Vector,
    /// Velocity.
    pub velocity: Vector,
    /// Density.
    pub density: f64,
    /// Mass of the torus.
    pub mass: f64,
    /// Pressure that is subtracted from its own.
    pub reference_pressure: f64,
    /// Velocity gradient from which a reconstruction starts.
    pub gradient: Matrix,
    /// Factor of the kernel gradient.
    pub kernel_scale: f64,
}

/// Weights of the pair sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Weights {
    /// Harmonic mean everywhere, without images.
    HarmonicMean,
    /// Harmonic mean where r > K h, Parshikov's nearer to the axis.
    NearAxis(f64),
    /// Parshikov's everywhere.
    Parshikov,
}

/// Everything that the particles share, in SI units.
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Sound speed of the linear equation of state.
    pub sound_speed: f64,
    /// Density at which the pressure is zero.
    pub rest_density: f64,
    /// Smoothing length over the sum of two sizes.
    pub theta: f64,
    /// Particle size beyond which the support grows no further.
    pub largest_size: f64,
    /// Distance of r = 0 from the axis.
    pub origin: f64,
    /// Length after which everything repeats in z.
    pub period: Option<f64>,
    /// Weights of the pair sums.
    pub weights: Weights,
    /// Whether velocities are reconstructed at the contact.
    pub reconstructed: bool,
    /// Viscosity.
    pub viscosity: f64,
}

/// What the pair sums give for one particle, in SI units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    /// Volumetric strain rate (16), without the ghost.
    pub strain_rate: f64,
    /// Force density (17) of the pressure part of P*, without the ghost.
    pub force: Vector,
    /// Force density of the velocity jump's part of P*.
    pub dissipation: Vector,
    /// Rate of total energy (18) between pairs, per volume.
    pub power: f64,
    /// Viscous force density.
    pub viscous_force: Vector,
    /// Rate of total energy by the viscous stress, per volume.
    pub viscous_power: f64,
    /// Moment matrix (21).
    pub moment: Matrix,
    /// Ghost weight (23).
    pub ghost_weight: Vector,
    /// Velocity differences before division by the moment matrix.
    pub velocity_sum: Matrix,
    /// Gradient of the particle concentration with the term against pairing.
    pub concentration_gradient: Vector,
}

impl Medium {
    /// Distance from the axis.
    pub fn radius(&self, a: &Particle) -> f64 {
        (a.position[0] + self.origin).abs()
    }

    /// V = m/(2 pi r rho).
    pub fn area(&self, a: &Particle) -> f64 {
        a.mass / (2.0 * PI * self.radius(a) * a.density)
    }

    /// D = sqrt(V), as far as supports grow with it.
    pub fn size(&self, a: &Particle) -> f64 {
        self.area(a).sqrt().min(self.largest_size)
    }

    /// H_ab = 2 h_ab with h_ab = theta (D_a + D_b).
    pub fn support(&self, a: &Particle, b: &Particle) -> f64 {
        2.0 * self.theta * (self.size(a) + self.size(b))
    }

    /// P = C^2 (rho - rho_0) less the reference.
    pub fn pressure(&self, a: &Particle) -> f64 {
        self.sound_speed.powi(2) * (a.density - self.rest_density) - a.reference_pressure
    }

    /// Z = rho C, as contacts know it: with 21 bits.
    pub fn impedance(&self, a: &Particle) -> f64 {
        rounded(a.density * self.sound_speed, 21)
    }

    /// Whether a particle is treated by Parshikov's scheme.
    pub fn near_axis(&self, a: &Particle) -> bool {
        match self.weights {
            Weights::HarmonicMean => false,
            Weights::NearAxis(factor) => self.radius(a) <= factor * 2.0 * self.theta * self.size(a),
            Weights::Parshikov => true,
        }
    }

    /// The sums of every particle over all others and all images.
    pub fn sums(&self, particles: &[Particle]) -> Vec<Sums> {
        (0..particles.len()).map(|a| self.sums_of(particles, a)).collect()
    }

    fn sums_of(&self, particles: &[Particle], index: usize) -> Sums {
        let shifts = self.shifts();
        let copies = |other: usize| {
            shifts.iter().flat_map(move |&shift| [false, true].map(|mirrored| (other, shift, mirrored)))
        };
        self.sums_over(particles, index, (0..particles.len()).flat_map(copies))
    }

    /// The sums of one particle over candidates, each with its shift along z and whether it is mirrored; those
    /// out of reach and the particle itself add nothing.
    pub fn sums_over(
        &self,
        particles: &[Particle],
        index: usize,
        candidates: impl Iterator<Item = (usize, f64, bool)>,
    ) -> Sums {
        let a = &particles[index];
        let mut sums = Sums::default();
        for (other, shift, mirrored) in candidates {
            let itself = other == index && shift == 0.0 && !mirrored;
            let b = self.image(&particles[other], shift, mirrored);
            let inside = distance(a, &b) < self.support(a, &b);
            if inside && !itself {
                self.add_pair(a, &b, mirrored, &mut sums);
            }
        }
        let radius = self.radius(a);
        sums.strain_rate += a.velocity[0] / radius;
        sums.viscous_force[0] -= 2.0 * self.viscosity * a.velocity[0] / radius.powi(2);
        if self.near_axis(a) {
            // Without the weights' r_b/r_a the divergence in the plane lacks tau . e_r/r.
            let open = scaled(1.0 / radius, self.traction(a, [1.0, 0.0]));
            add(&mut sums.viscous_force, 1.0, open);
            sums.viscous_power += dot(open, a.velocity);
        } else {
            sums.force[0] += self.pressure(a) / radius;
            sums.ghost_weight[0] += 0.5 / radius;
        }
        if self.weights == Weights::HarmonicMean && self.origin == 0.0 && self.reconstructed {
            sums.dissipation[0] += self.image_dissipation(a);
        }
        sums
    }

    /// Of the contact with the particle's own image: the hoop pressure less rho C J/2, as far as the image is in the support.
    /// J is what van Leer's limiter leaves of 2 U_r.
    fn image_dissipation(&self, a: &Particle) -> f64 {
        let radius = self.radius(a);
        let jump = 2.0 * a.velocity[0];
        let step = van_leer(4.0 * a.gradient[0][0] * radius - jump, jump);
        let inside = (1.0 - 2.0 * radius / self.support(a, a)).max(0.0);
        -0.5 * self.impedance(a) * (jump - step) * inside.powi(2) / radius
    }

    fn shifts(&self) -> Vec<f64> {
        self.period.map_or(vec![0.0], |length| vec![-length, 0.0, length])
    }

    /// The particle itself, or its copy across the period and the axis.
    fn image(&self, b: &Particle, shift: f64, mirrored: bool) -> Particle {
        let mut image = *b;
        image.position[1] += shift;
        if mirrored {
            image.position[0] = -b.position[0] - 2.0 * self.origin;
            image.velocity[0] = -b.velocity[0];
            image.gradient[0][1] = -b.gradient[0][1];
            image.gradient[1][0] = -b.gradient[1][0];
        }
        image
    }

    fn add_pair(&self, a: &Particle, b: &Particle, mirrored: bool, sums: &mut Sums) {
        let (d, length) = (difference(b.position, a.position), distance(a, b));
        let e = scaled(1.0 / length, d);
        let support = self.support(a, b);
        let q = length / support;
        let scale = 0.5 * (a.kernel_scale + b.kernel_scale);
        let g = scale * 140.0 / (PI * support.powi(3)) * q * (1.0 - q).powi(3);
        let area = self.area(b);

        let jump = difference(b.velocity, a.velocity);
        for i in 0..2 {
            for j in 0..2 {
                sums.moment[i][j] += area * g * e[i] * d[j];
                sums.velocity_sum[i][j] += area * jump[i] * g * e[j];
            }
        }
        let spacing = 0.5 * (self.size(a) + self.size(b));
        let nearness = (1.0 - q) / (1.0 - spacing / support);
        add(&mut sums.concentration_gradient, (1.0 + 0.2 * nearness.powi(12)) * area * g, e);

        let weight = if self.near_axis(a) {
            2.0 * area
        } else if mirrored {
            return;
        } else {
            let (r_a, r_b) = (self.radius(a), self.radius(b));
            b.mass / (PI * b.density) * (r_a + r_b) / (2.0 * r_a * r_b)
        };
        let star = self.riemann(a, b, d, e);
        add(&mut sums.force, -weight * star.pressure * g, e);
        add(&mut sums.dissipation, -weight * star.resistance * g, e);
        add(&mut sums.ghost_weight, -0.5 * weight * g, e);
        sums.strain_rate += weight * (star.velocity - dot(a.velocity, e)) * g;
        sums.power -= weight * (star.pressure + star.resistance) * star.velocity * g;
        let (own, other) = (self.traction(a, e), self.traction(b, e));
        add(&mut sums.viscous_force, 0.5 * weight * g, own);
        add(&mut sums.viscous_force, 0.5 * weight * g, other);
        sums.viscous_power += 0.5 * weight * g * (dot(own, b.velocity) + dot(other, a.velocity));
    }

    /// tau n with tau = mu (grad U + grad U^T).
    fn traction(&self, a: &Particle, normal: Vector) -> Vector {
        let [[rr, rz], [zr, zz]] = a.gradient;
        scaled(self.viscosity, apply([[2.0 * rr, rz + zr], [rz + zr, 2.0 * zz]], normal))
    }

    /// Equations (19) and (20), the velocities brought to the contact first if asked for.
    fn riemann(&self, a: &Particle, b: &Particle, d: Vector, e: Vector) -> Star {
        let (z_a, z_b) = (self.impedance(a), self.impedance(b));
        let (p_a, p_b) = (self.pressure(a), self.pressure(b));
        let (u_a, u_b) = (dot(a.velocity, e), dot(b.velocity, e));
        let plain = u_b - u_a;
        let (mut left, mut right, mut jump) = (u_a, u_b, plain);
        if self.reconstructed {
            left += 0.5 * van_leer(2.0 * dot(apply(a.gradient, d), e) - plain, plain);
            right -= 0.5 * van_leer(2.0 * dot(apply(b.gradient, d), e) - plain, plain);
            let reconstructed = right - left;
            let part = if plain == 0.0 { 1.0 } else { (reconstructed / plain).abs() };
            let smooth = reconstructed * (3.0 * part).min(1.0);
            let beta = (4000.0 * part * part * smooth.abs() / self.sound_speed).min(1.0);
            jump = smooth + beta * (plain - smooth);
        }
        Star {
            pressure: (p_b * z_a + p_a * z_b) / (z_a + z_b),
            resistance: -z_a * z_b * jump / (z_a + z_b),
            velocity: (z_a * left + z_b * right + p_a - p_b) / (z_a + z_b),
        }
    }
}

/// The state at the contact: both parts of P*, and U*.
struct Star {
    pressure: f64,
    resistance: f64,
    velocity: f64,
}

/// The nearest number of so many bits.
pub fn rounded(number: f64, bits: i32) -> f64 {
    let last = (number.abs().log2().floor() as i32 + 1 - bits) as f64;
    (number / last.exp2()).round() * last.exp2()
}

/// The harmonic mean where both have one sign, else zero.
pub fn van_leer(x: f64, y: f64) -> f64 {
    if x * y > 0.0 { 2.0 * x * y / (x + y) } else { 0.0 }
}

fn distance(a: &Particle, b: &Particle) -> f64 {
    let [r, z] = difference(b.position, a.position);
    r.hypot(z)
}

fn difference(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn scaled(factor: f64, a: Vector) -> Vector {
    [factor * a[0], factor * a[1]]
}

fn add(sum: &mut Vector, factor: f64, a: Vector) {
    sum[0] += factor * a[0];
    sum[1] += factor * a[1];
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn apply(matrix: Matrix, a: Vector) -> Vector {
    [dot(matrix[0], a), dot(matrix[1], a)]
}
