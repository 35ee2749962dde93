//! Where a particle lies relative to the free surface: the codes of the field `surface`.

/// Inside the liquid.
pub const INSIDE: u32 = 0;
/// It has a boundary particle among its neighbours.
pub const NEAR_BOUNDARY: u32 = 1;
/// It lies at the boundary.
pub const BOUNDARY: u32 = 2;
