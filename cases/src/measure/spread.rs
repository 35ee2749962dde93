//! How far two equal drops spread that meet head on.

use super::evaluate::Outcome;
use super::history::History;
use super::observe::Particles;
use crate::scene::Liquid;

/// Radius of the disc that the drops become.
pub(super) const COLUMNS: [(&str, &str); 1] = [("disc radius", "m")];

/// Part of the largest radius at which the disc counts as drawing back.
const DRAWN_BACK: f64 = 0.98;

/// The largest radius of the surface; of the outermost particle's centre where nothing tells of a surface.
pub(super) fn observe(particles: &Particles) -> Vec<f64> {
    let radii = particles.surface.as_ref().map_or(particles.r, |(r, _)| r.as_slice());
    vec![radii.iter().copied().fold(0.0, f64::max)]
}

/// The largest diameter over that of a drop, against the estimate for one drop on a wall without friction: half
/// of the kinetic energy becomes surface (Wildeman, Visser, Sun and Lohse 2016). A disc with two faces then
/// has D^2/D_0^2 = 2 + We/12. Each of two drops that have become one is left with a single face, and the same
/// energy makes twice that: `spread-merged` is against sqrt(4 + We/6). We = rho D_0 U^2/sigma with the speed U
/// (m/s) of each drop.
pub(super) fn evaluate(
    history: &History,
    column: &str,
    liquid: &Liquid,
    (radius, speed): (f64, f64),
) -> Vec<Outcome> {
    let weber = liquid.density * 2.0 * radius * speed * speed / liquid.surface_tension;
    let (mut largest, mut turned) = (0.0f64, false);
    for r in history.of(column) {
        largest = largest.max(r);
        turned = r < DRAWN_BACK * largest;
        // Later it may tear, and its drops fly farther.
        if turned {
            break;
        }
    }
    let ratio = turned.then_some(largest / radius);
    let wall = (weber / 12.0 + 2.0).sqrt();
    let outcome = |name: &str| Outcome::of(name.to_owned(), ratio, "1").lacking("the disc still grows");
    vec![outcome("spread").against(wall), outcome("spread-merged").against(wall * 2f64.sqrt())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Quantity;
    use crate::scene::EquationOfState;

    #[test]
    fn the_widest_disc_counts() {
        let quantity = |name: &str| Quantity { name: name.to_owned(), unit: "1" };
        let mut history = History::new(vec![quantity("time"), quantity("disc radius")]);
        let liquid = Liquid {
            density: 1000.0,
            surface_tension: 0.05,
            viscosity: 0.0,
            sound_speed: None,
            equation_of_state: EquationOfState::Linear,
        };
        for (time, radius) in [(0.0, 1.0), (1.0, 2.5)] {
            history.push(vec![time, radius]);
        }
        // We = 24: sqrt(4) and sqrt(8).
        let evaluate = |history: &History| evaluate(history, "disc radius", &liquid, (1.0, 6e-4f64.sqrt()));
        assert!(evaluate(&history)[0].value.is_nan());
        for (time, radius) in [(2.0, 2.49), (3.0, 2.2), (4.0, 9.0)] {
            history.push(vec![time, radius]);
        }
        let outcomes = evaluate(&history);
        assert_eq!([outcomes[0].value, outcomes[1].value], [2.5, 2.5]);
        assert!((outcomes[0].reference.unwrap() - 2.0).abs() < 1e-12);
        assert!((outcomes[1].reference.unwrap() - 8f64.sqrt()).abs() < 1e-12);
    }
}
