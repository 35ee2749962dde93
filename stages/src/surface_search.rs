//! The way from a particle to the surface, where the colour field is one half, and the curvature there.

use crate::colour_field::{Colour, ColourField};
use crate::surface::length;

/// What a search finds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// Mean of the two principal curvatures times two, 1/m.
    pub curvature: f64,
    /// Unit tangent of the surface.
    pub tangent: [f64; 2],
    /// The way from the particle to the surface, m.
    pub offset: [f64; 2],
}

impl Found {
    /// Whether it tells a Laplace pressure: where no surface was found none is known, and spray has none.
    pub fn tells_pressure(&self) -> bool {
        self.curvature != 0.0
    }

    /// Curvature (1/m) of a particle of the given size (m) that juts out: it lies outside of the surface that was
    /// found for it, the contour c = 1/2, instead of half a size below. The colour field smooths so narrow a bump
    /// away (of a wave five particle sizes long it keeps a seventh of the height, of four a sixtieth), and with it
    /// what pulls the bump back: where the flow compresses the surface it squeezes particles out, and nothing else
    /// would stop them.
    pub fn bump(&self, size: f64) -> f64 {
        let [r, z] = self.tangent;
        let height = z * self.offset[0] - r * self.offset[1];
        BUMP * (height / size).clamp(0.0, 1.0) / size
    }
}

/// Part of a particle's own curvature, one over its size, that it has where it juts out by its size. With more, its
/// swinging would ask for shorter steps.
const BUMP: f64 = 0.25;

/// Depth below a flat surface over the support radius, from c - 1/2: an odd polynomial fitted to the
/// inverse of the colour kernel's half-plane integral, good to .0004 for |c - 1/2| < .51. These are its coefficients.
const DEPTH: [f64; 4] = [0.255_988_86, 0.142_692_53, -0.007_783_92, 0.882_506_95];

fn depth(excess: f64) -> f64 {
    let square = excess * excess;
    excess * (DEPTH[0] + square * (DEPTH[1] + square * (DEPTH[2] + square * DEPTH[3])))
}

/// Way over the support radius on which the colour would fall to one half if it stayed as steep as it is where it
/// exceeds that by so much below a flat surface: the excess times the slope of [`depth`].
pub(crate) fn reach(excess: f64) -> f64 {
    let square = excess * excess;
    excess * (DEPTH[0] + square * (3.0 * DEPTH[1] + square * (5.0 * DEPTH[2] + square * 7.0 * DEPTH[3])))
}

/// Most evaluations of the colour field for one particle, the one at its own place included.
const MOST_EVALUATIONS: usize = 5;
/// So close to the surface, in particle sizes, what is left of the way is a parallel shift.
const CLOSE: f64 = 0.1;

/// Largest principal curvature times the particle size: nothing smaller than a particle is resolved.
pub(crate) const SHARPEST: f64 = 1.0;

/// A surface that is farther from a particle than so many particle sizes is another one's.
pub(crate) const FARTHEST: f64 = 3.0;

/// Neighbours whose sizes differ by so small a part of the usual one look at the same smoothed liquid. With supports
/// in proportion to their own sizes each would see other disorder, and in a resting packing the error of the curvature
/// would be twice as large.
const EVEN: f64 = 0.1;

/// What the support is measured by for a particle of the given size (m), where particles have `usual` ones: up to
/// [`EVEN`] more or less doesn't count.
pub(crate) fn even(size: f64, usual: f64) -> f64 {
    let (least, most) = ((1.0 - EVEN) * usual, (1.0 + EVEN) * usual);
    usual + (size - size.clamp(least, most))
}

/// Where the search for the surface starts.
pub(crate) enum Start {
    /// At the particle, whose colour is known.
    Particle(Colour),
    /// Where the surface lay from the particle last time.
    Foot([f64; 2]),
}

/// From a particle, along grad c, to the surface c = 1/2; the curvature there. Where the surface was found
/// before, it is looked for there; else the first step takes the depth from the profile of a flat
/// surface. Further steps are Newton's. `support` is that of the colour field in m.
pub(crate) fn find(
    field: &ColourField,
    start: Start,
    at: [f64; 2],
    size: f64,
    support: f64,
    origin: f64,
) -> Found {
    let steepness = |colour: &Colour| length(colour.gradient);
    let is_far = |foot: [f64; 2]| length([foot[0] - at[0], foot[1] - at[1]]) > FARTHEST * size;
    let newton = |colour: &Colour| ((0.5 - colour.value) / steepness(colour)).clamp(-size, size);
    let (mut foot, mut colour, mut inward) = match start {
        Start::Particle(here) => (at, here, -support * depth((here.value - 0.5).clamp(-0.5, 0.5))),
        Start::Foot(offset) => {
            let foot = [at[0] + offset[0], at[1] + offset[1]];
            if is_far(foot) {
                return Found::default();
            }
            let colour = field.at(foot[0], foot[1], support);
            (foot, colour, newton(&colour))
        }
    };
    let mut evaluations = 1;
    let at_particle = matches!(start, Start::Particle(_));
    while (at_particle && evaluations == 1) || (inward.abs() > CLOSE * size && evaluations < MOST_EVALUATIONS)
    {
        let step = inward / steepness(&colour);
        foot = [foot[0] + step * colour.gradient[0], foot[1] + step * colour.gradient[1]];
        if is_far(foot) {
            return Found::default();
        }
        colour = field.at(foot[0], foot[1], support);
        inward = newton(&colour);
        evaluations += 1;
    }
    let steepest = steepness(&colour);
    // Spray is too small for the colour to rise to one half anywhere: it has no surface to find.
    if steepest.is_nan() || steepest <= 0.0 || inward.abs() >= size {
        return Found::default();
    }
    let [r, z] = colour.gradient.map(|component| component / steepest);
    let limit = |curvature: f64| match curvature.is_finite() {
        true => curvature.clamp(-SHARPEST / size, SHARPEST / size),
        false => 0.0,
    };
    // The level set lies `inward` outside of the surface: parallel surfaces' radii differ by that.
    let [meridional, hoop] = curvatures(&colour, foot[0] + origin, size).map(limit);
    let at_surface = |curvature: f64| limit(curvature / (1.0 - inward * curvature));
    Found {
        curvature: at_surface(meridional) + at_surface(hoop),
        tangent: [-z, r],
        offset: [foot[0] + inward * r - at[0], foot[1] + inward * z - at[1]],
    }
}

/// The principal curvatures of a level set: -(c_rr c_z^2 - 2 c_r c_z c_rz + c_zz c_r^2)/|grad c|^3 and
/// -c_r/(R |grad c|), with c_rr for c_r/R on the axis (method.md, section 9).
fn curvatures(colour: &Colour, radius: f64, size: f64) -> [f64; 2] {
    let [r, z] = colour.gradient;
    let [rr, rz, zz] = colour.second;
    let length = length([r, z]);
    let hoop = if radius.abs() > 1e-3 * size { r / radius } else { rr };
    [-(rr * z * z - 2.0 * r * z * rz + zz * r * r) / length.powi(3), -hoop / length]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_juts_out_is_a_bump() {
        // Outward is the direction of r.
        let bump =
            |way: f64| Found { tangent: [0.0, -1.0], offset: [way, 0.3], ..Found::default() }.bump(0.1);
        assert_eq!([bump(0.05), bump(0.0)], [0.0, 0.0]);
        assert!((bump(-0.05) - 0.5 * BUMP / 0.1).abs() < 1e-12);
        assert_eq!(bump(-0.3), BUMP / 0.1);
    }
}
