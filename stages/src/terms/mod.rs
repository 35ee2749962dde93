//! The pair terms: what a pass sums over neighbours, one file each.

mod concentration_gradient;
mod density_rate;
mod energy_rate;
mod ghost_weight;
mod moment_matrix;
mod pressure_riemann;
mod velocity_sum;
mod viscosity;

pub use concentration_gradient::ConcentrationGradient;
pub use density_rate::DensityRate;
pub use energy_rate::EnergyRate;
pub use ghost_weight::GhostWeight;
pub use moment_matrix::MomentMatrix;
pub use pressure_riemann::PressureRiemann;
pub use velocity_sum::VelocitySum;
pub use viscosity::Viscosity;
