//! How often the surface is looked for.
//!
//! Between two looks the Laplace pressure and its slope along the surface are carried on: along the parabola through the last
//! three looks, at the rate that keeps to it in the mean. (A slope that
//! is held instead lags by half of the time t between two looks, and drives a wave by as much of omega t.) Along the straight
//! line through two looks a wave's pressure lags by omega^2 t^3/3 in the mean and is wrong by 5/12 (omega t)^2. That drives the
//! waves that pass in some looks: at the poles of a drop with 200 particles to the radius one of ten particle sizes, which
//! swings in fifty-seven steps, grew until particles were three times as fast as the flow. Along the parabola the pressure is
//! ahead by 3/8 omega^2 t^3, which damps such waves, and those that take hundreds of looks feel neither. A bump of height x, a few
//! particles wide, has a pressure of up to sigma x/D^2. To a pressure that changes too fast for anything but sound a
//! liquid yields at the speed P/(rho C), so the bump is gone after the time rho C D^2/sigma. Carried on for
//! much longer, its pressure shoots past zero by more than it was: it changes its sign from look to look and grows,
//! until particles are thrown out of the surface.
//!
//! Where sound is faster the liquid doesn't yield, and the bump swings, with about the capillary time of a particle,
//! sqrt(rho D^3/sigma), and no faster than sound passes one, D/C. Carried on for longer its pressure drives it.
//!
//! A wave that the particles resolve does not yield, so t is limited to a part of the capillary time, too.

use meniscus_engine::clock::Clock;

/// The mark of the clock for when the curvature was last computed.
pub const COMPUTED: &str = "curvature";
/// The mark for how long that holds.
pub const HOLDS_UNTIL: &str = "curvature holds";

/// Part of the capillary time for which a Laplace pressure may be carried on: a drop's mode 2 is 2e-6 slower than with a third of it.
const LAG: f64 = 0.02;

/// How many times as long as a bump takes to yield: a jet with 60 particles to the radius is as quiet with two as with one (every
/// fourth step and every second); with four single particles have 1.6 m/s where the flow has .6.
const YIELDING: f64 = 2.0;

/// How many times as long as a bump swings: drops with 66, 200 and 340 particles to the radius that look for the surface after 1.97, 1.63
/// and 2.02 of these times have no particle more than 1.1 times as fast as the flow ever is (five periods, 8000 and 5000 steps). (Carried on along
/// straight lines, after 1.47 and 1.53, drops with 140 and 160 had particles 2.3 and 180 times as fast in the first half of a period.) A jet
/// with 60 particles to the radius that looks after 2.4 of them is torn up.
const SWINGING: f64 = 2.0;

/// The rate of a parabola through three looks differs from that of the straight line through the last two by this part of what that one
/// changed by, in the mean until the next look: the mean of s(s + t)/2 is 5/12 t^2, that of s t/2.
const BEND: f64 = 5.0 / 6.0;

/// The Laplace pressure changes no faster than by this part of sigma/D in a particle's capillary time
/// sqrt(rho D^3/sigma): what is faster is no motion of a resolved surface, but another place found for it.
const FASTEST: f64 = 0.25;

/// What a Laplace pressure depends on as it is carried on.
#[derive(Clone, Copy, Debug)]
pub struct Tension {
    /// sigma in N/m.
    pub surface_tension: f64,
    /// Density at rest in kg/m3.
    pub density: f64,
    /// Sound speed at rest in m/s.
    pub sound_speed: f64,
    /// The scene's capillary time in s.
    pub capillary_time: f64,
    /// Most steps between two computations; in between the Laplace pressure is extrapolated.
    pub interval: u64,
}

impl Tension {
    /// Whether the curvature is computed in this step.
    pub(crate) fn is_due(&self, clock: &Clock) -> bool {
        is_due(clock, self.interval)
    }

    /// Notes that the curvature was computed, and until when that holds where the smallest particle at the surface
    /// measures `size` metres.
    pub(crate) fn note(&self, clock: &mut Clock, size: f64) {
        let until = clock.time + self.holds(size);
        clock.set_mark(COMPUTED);
        clock.set_number(HOLDS_UNTIL, until);
    }

    /// Rate (Pa/s) of a Laplace pressure that was another one `elapsed` seconds before, of a particle of the given size
    /// (m). Where a particle lost the surface or has just found it there is none.
    pub(crate) fn rate(&self, [before, now]: [f64; 2], elapsed: f64, size: f64) -> f64 {
        if before == 0.0 || now == 0.0 || elapsed <= 0.0 {
            return 0.0;
        }
        let most = self.fastest(size);
        ((now - before) / elapsed).clamp(-most, most)
    }

    /// The rate at which a Laplace pressure is carried on whose rate was another one, if any, between the two looks before.
    pub(crate) fn carried_on(&self, [before, now]: [f64; 2], size: f64) -> f64 {
        if before == 0.0 || now == 0.0 {
            return now;
        }
        let most = self.fastest(size);
        (now + BEND * (now - before)).clamp(-most, most)
    }

    /// Largest rate of a Laplace pressure, Pa/s.
    fn fastest(&self, size: f64) -> f64 {
        FASTEST * self.surface_tension / size / self.particle_time(size)
    }

    fn holds(&self, size: f64) -> f64 {
        let yields = self.density * self.sound_speed * size * size / self.surface_tension;
        let swings = self.particle_time(size).hypot(size / self.sound_speed);
        (YIELDING * yields).min(SWINGING * swings).min(LAG * self.capillary_time)
    }

    /// The capillary time sqrt(rho D^3/sigma) of a particle, s.
    fn particle_time(&self, size: f64) -> f64 {
        (self.density * size.powi(3) / self.surface_tension).sqrt()
    }
}

/// Whether the surface is looked for in this step: every `interval` steps, or a half or a quarter of that and so
/// on where the curvature doesn't hold so long.
pub fn is_due(clock: &Clock, interval: u64) -> bool {
    let holds = clock.known(HOLDS_UNTIL).map_or(f64::INFINITY, |until| until - clock.mark(COMPUTED));
    let mut steps = interval;
    while steps > 1 && steps as f64 * clock.previous_step_size > holds {
        steps /= 2;
    }
    clock.step.is_multiple_of(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_as_often_as_the_curvature_holds() {
        let looks = |holds: f64| {
            let due = |step: u64| {
                let mut clock = Clock::at(step, 0.0, 1.0);
                clock.set_mark(COMPUTED);
                clock.set_number(HOLDS_UNTIL, holds);
                is_due(&clock, 4)
            };
            (0..8).filter(|&step| due(step)).collect::<Vec<_>>()
        };
        assert_eq!(looks(4.5), [0, 4]);
        assert_eq!(looks(3.5), [0, 2, 4, 6]);
        assert_eq!(looks(0.5), [0, 1, 2, 3, 4, 5, 6, 7]);
    }

    #[test]
    fn what_swings_fastest_bounds_the_time() {
        let tension = Tension {
            surface_tension: 1.0,
            density: 1.0,
            sound_speed: 10.0,
            capillary_time: 1e3,
            interval: 8,
        };
        // Bumps of large particles swing, those of small ones yield.
        let [swings, yields] = [1.0, 1e-3].map(|size| tension.holds(size) / size.powi(2));
        assert!((swings - SWINGING * 1.01_f64.sqrt()).abs() < 1e-12, "{swings}");
        assert!((yields - YIELDING * 10.0).abs() < 1e-12, "{yields}");
    }

    /// How much the amplitude grows in the time of a hundred looks if a swing of that omega t feels a pressure that is looked at
    /// after each t, and carried on in between.
    fn growth(omega: f64, carried_on: impl Fn([f64; 2]) -> f64) -> f64 {
        const STEPS: u32 = 64;
        let (mut place, mut speed, mut looks, mut last_rate) = (1.0, 0.0, [0.0, 0.0], 0.0);
        for step in 0..100 * STEPS {
            if step % STEPS == 0 {
                looks = [looks[1], place];
            }
            let rate = if step < STEPS { 0.0 } else { looks[1] - looks[0] };
            let pressure =
                looks[1] + f64::from(step % STEPS) / f64::from(STEPS) * carried_on([last_rate, rate]);
            if step % STEPS == STEPS - 1 {
                last_rate = rate;
            }
            speed -= omega * omega * pressure / f64::from(STEPS);
            place += speed / f64::from(STEPS);
        }
        place.hypot(speed / omega)
    }

    #[test]
    fn waves_of_some_looks_are_damped() {
        let tension = Tension {
            surface_tension: 1e9,
            density: 1.0,
            sound_speed: 10.0,
            capillary_time: 1e3,
            interval: 8,
        };
        for omega in [0.3, 0.44, 0.6, 0.9] {
            let line = growth(omega, |[_, rate]| rate);
            let parabola = growth(omega, |rates| tension.carried_on(rates, 1.0));
            assert!(line > 1.1 && parabola < 0.9, "{omega} {line} {parabola}");
        }
        // One that takes hundreds of looks is left alone.
        let slow = growth(0.01, |rates| tension.carried_on(rates, 1.0));
        assert!((slow - 1.0).abs() < 1e-3, "{slow}");
    }

    #[test]
    fn without_a_mark_the_interval_counts() {
        let clock = Clock::at(4, 0.0, 1.0);
        assert!(is_due(&clock, 4) && !is_due(&Clock::at(5, 0.0, 1.0), 4));
    }
}
