//! The contract between shapes and whoever fills or measures them.

/// A region of the half plane r >= 0, bounded by a closed curve (and the axis). Lengths in metres.
pub trait Region: Sync {
    /// Signed distance to the boundary in metres, negative inside. For boolean combinations it is
    /// exact near smooth parts of the boundary and a bound elsewhere. The axis is no boundary: the
    /// distance is that of the revolved body.
    fn signed_distance(&self, r: f64, z: f64) -> f64;

    /// Bounding box `[r_min, r_max, z_min, z_max]` in metres, r_min >= 0.
    fn bounds(&self) -> [f64; 4];

    /// Volume of the revolved body in cubic metres (per full turn), exact where a closed form
    /// exists and otherwise by adaptive quadrature to a relative error of 1e-10 or better.
    fn volume(&self) -> f64;
}
