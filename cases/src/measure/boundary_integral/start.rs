//! Surfaces to start from.

use super::flow::Flow;
use super::surface::{End, Surface};
use std::f64::consts::PI;

/// Nodes before they are spread.
const NODES: usize = 200;

/// Nodes (radius, height, potential) at places x from 0 to 1.
fn curve(ends: [End; 2], node: impl Fn(f64) -> [f64; 3]) -> Surface {
    let mut nodes: Vec<[f64; 3]> = (0..=NODES).map(|k| node(k as f64 / NODES as f64)).collect();
    for (k, end) in [(0, ends[0]), (NODES, ends[1])] {
        if end == End::Axis {
            nodes[k][0] = 0.0;
        }
    }
    Surface { nodes, ends }
}

impl Flow {
    /// A spheroid of the volume of the unit sphere, whose half-axis along the axis of symmetry is `aspect_ratio`
    /// times the other one, with the flow (-r, 2 z) times half the `speed`.
    pub fn spheroid(aspect_ratio: f64, speed: f64, fineness: f64) -> Self {
        let radial = aspect_ratio.cbrt().recip();
        let node = |x: f64| {
            let (sine, cosine) = (PI * x).sin_cos();
            let (r, z) = (radial * sine, -aspect_ratio * radial * cosine);
            [r, z, 0.5 * speed * (z * z - 0.5 * r * r)]
        };
        Flow::new(curve([End::Axis; 2], node), fineness)
    }

    /// A jet of the radius 1, half a wave of it: z from 0 to pi/`wavenumber`. A liquid that is given the velocity w =
    /// `speed` sin(k z) along the axis cannot keep it, for that is not free of divergence. The pressure that makes
    /// it so at once vanishes at the surface; w is the gradient of -(`speed`/k) cos(k z), so this stays the
    /// potential there.
    pub fn jet(wavenumber: f64, speed: f64, fineness: f64) -> Self {
        let node = |x: f64| [1.0, PI * x / wavenumber, -speed / wavenumber * (PI * x).cos()];
        Flow::new(curve([End::Mirror; 2], node), fineness)
    }

    /// Two spheres at rest, the lower one of the radius 1, the upper one `ratio` times as large, that touch at z =
    /// 0 and are joined by a bridge of about the radius `bridge`. The surface is where the distances a and b to
    /// both spheres have a smooth least one of zero, -s ln(e^(-a/s) + e^(-b/s)): beside the bridge the gap between
    /// the spheres is rounded.
    pub fn bridge(ratio: f64, bridge: f64, fineness: f64) -> Self {
        // Where a = b = s ln 2: half the gap between the spheres, r^2 (1 + 1/ratio)/4.
        let smooth = 0.25 * bridge * bridge * (1.0 + 1.0 / ratio) / 2f64.ln();
        let outside = |r: f64, z: f64| {
            let (one, other) = (r.hypot(z + 1.0) - 1.0, r.hypot(z - ratio) - ratio);
            one.min(other) - smooth * (-(one - other).abs() / smooth).exp().ln_1p()
        };
        // By the angle seen from the point where the spheres touch, most nodes near the bridge.
        let steep = (0.5 * PI / bridge).asinh();
        let node = |x: f64| {
            let (sine, cosine) = (bridge * ((2.0 * x - 1.0) * steep).sinh()).sin_cos();
            let (mut inner, mut outer) = (0.0, 2.1 * ratio.max(1.0));
            // Halved until no number lies between.
            for _ in 0..60 {
                let middle = 0.5 * (inner + outer);
                if outside(middle * cosine, middle * sine) > 0.0 { outer = middle } else { inner = middle }
            }
            [inner * cosine, inner * sine, 0.0]
        };
        Flow::new(curve([End::Axis; 2], node), fineness)
    }
}
