//! Exact distance to an ellipse.

/// Signed distance, negative inside, from a point of the first quadrant to the ellipse around the
/// origin with the given semi-axes.
///
/// The nearest point is `semi² p / (t + semi²)` for the largest root t of
/// `(a x/(t + a²))² + (b y/(t + b²))² = 1`. Left of the root that function is convex and falls, so
/// Newton's iteration from a point where it is still positive climbs to the root and never passes it.
pub(super) fn signed_distance(semi: [f64; 2], point: [f64; 2]) -> f64 {
    // Scaled by the smaller semi-axis and ordered, the smaller one becomes 1 and the last.
    let swap = semi[0] < semi[1];
    let [[major, small], [x, y]] =
        if swap { [[semi[1], semi[0]], [point[1], point[0]]] } else { [semi, point] };
    let (ratio, x, y) = (major / small, x / small, y / small);
    let nearest = if y > 0.0 {
        let root = largest_root(ratio, x, y);
        [ratio * ratio * x / (root + ratio * ratio), y / (root + 1.0)]
    } else {
        on_long_axis(ratio, x)
    };
    let distance = small * (x - nearest[0]).hypot(y - nearest[1]);
    let inside = (x / ratio).powi(2) + y * y < 1.0;
    if inside { -distance } else { distance }
}

fn largest_root(ratio: f64, x: f64, y: f64) -> f64 {
    let square = ratio * ratio;
    let mut root = (y - 1.0).max(ratio * x - square);
    for _ in 0..200 {
        let (first, second) = (ratio * x / (root + square), y / (root + 1.0));
        let value = first * first + second * second - 1.0;
        let slope = -2.0 * (first * first / (root + square) + second * second / (root + 1.0));
        let next = root - value / slope;
        // A step that no longer climbs is rounding: the root is reached.
        if !next.is_finite() || next <= root {
            break;
        }
        root = next;
    }
    root
}

/// From a point of the long axis the nearest point leaves that axis when the point lies between the
/// ellipse's centres of curvature.
fn on_long_axis(ratio: f64, x: f64) -> [f64; 2] {
    let focus = ratio * ratio - 1.0;
    if ratio * x < focus {
        let share = ratio * x / focus;
        [ratio * share, (1.0 - share * share).max(0.0).sqrt()]
    } else {
        [ratio, 0.0]
    }
}
