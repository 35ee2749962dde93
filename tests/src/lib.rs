//! Helpers of the integration tests: scenes as text, a disordered block of liquid, and the method's
//! equations written down a second time.

pub mod curvature;
pub mod drops;
pub mod harmonics;
pub mod liquid;
pub mod reference;
