//! How often the surface is looked for.
//!
//! Between two looks the Laplace pressure and its slope along the surface are carried on at their last rates. (A slope that
//! is held instead lags by half of the time between two looks, and drives a wave by as much of omega t.) A bump of height x, a few
//! particles wide, has a pressure of up to sigma x/D^2. To a pressure that changes too fast for anything but sound a
//! liquid yields at the speed P/(rho C), so the bump is gone after the time rho C D^2/sigma. Carried on for
//! much longer, its pressure shoots past zero by more than it was: it changes its sign from look to look and grows,
//! until particles are thrown out of the surface.
//!
//! Where sound is faster the liquid doesn't yield, and the bump swings, with about the capillary time of a particle,
//! sqrt(rho D^3/sigma), and no faster than sound passes one, D/C. Carried on for longer its pressure drives it.
//!
//! A wave that the particles resolve does not yield: carried on for the time t its pressure is wrong by 5/12 of
//! (omega t)^2 in the mean, which raises its frequency by half of that. So t is limited to a part of the capillary time, too.

use meniscus_engine::clock::Clock;

/// The mark of the clock for when the curvature was last computed.
pub const COMPUTED: &str = "curvature";
/// The mark for how long that holds.
pub const HOLDS_UNTIL: &str = "curvature holds";

/// Part of the capillary time for which a Laplace pressure may be carried on: a drop's mode 2 is .006 % faster.
const LAG: f64 = 0.006;

/// How many times as long as a bump takes to yield: a jet with 60 particles to the radius is as quiet with two as with one (every
/// fourth step and every second); with four single particles have 1.6 m/s where the flow has .6.
const YIELDING: f64 = 2.0;

/// How many times as long as a bump swings: drops with 110, 120, 140 and 160 particles to the radius that looked for the surface after
/// 1.26, 1.35, 1.47 and 1.53 of these times had particles 1.1, 1.4, 2.3 and 180 times as fast as the flow in the first half of a period. A drop
/// with 100, and 1.3, is calm.
const SWINGING: f64 = 1.32;

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
        clock.restore_mark(HOLDS_UNTIL, until);
    }

    /// Rate (Pa/s) of a Laplace pressure that was another one `elapsed` seconds before, of a particle of the given size
    /// (m). Where a particle lost the surface or has just found it there is none.
    pub(crate) fn rate(&self, [before, now]: [f64; 2], elapsed: f64, size: f64) -> f64 {
        if before == 0.0 || now == 0.0 || elapsed <= 0.0 {
            return 0.0;
        }
        let most = FASTEST * self.surface_tension / size / self.particle_time(size);
        ((now - before) / elapsed).clamp(-most, most)
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
    let until = clock.marks().iter().find(|(name, _)| *name == HOLDS_UNTIL);
    let holds = until.map_or(f64::INFINITY, |(_, until)| until - clock.mark(COMPUTED));
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
                clock.restore_mark(HOLDS_UNTIL, holds);
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

    #[test]
    fn without_a_mark_the_interval_counts() {
        let clock = Clock::at(4, 0.0, 1.0);
        assert!(is_due(&clock, 4) && !is_due(&Clock::at(5, 0.0, 1.0), 4));
    }
}
