//! The motion of an inviscid liquid below a free surface with surface tension, of any shape that a curve makes when
//! it turns about the axis: potential flow by boundary integrals.
//!
//! Nodes on the curve move with the liquid. At any time Green's third identity over the surface gives the outward
//! speed from the potential there, and Bernoulli's law the rate of the potential (as in Oguz and Prosperetti 1990,
//! J. Fluid Mech. 219; Duchemin, Eggers and Josserand 2003, J. Fluid Mech. 487). Between nodes everything is a
//! polynomial of fifth degree in the node's number; integrals are Gauss's, close to a node with a substitution for
//! the logarithm there. Nodes are spread anew after every step, close together where the surface is narrow or bent:
//! nothing else smooths it.
//!
//! Lengths, times and potentials are in units of a length R, sqrt(rho R^3/sigma) and sqrt(sigma R/rho).

mod element;
mod flow;
mod ring;
mod start;
mod surface;
#[cfg(test)]
mod tests;

pub use flow::Flow;
pub use surface::{End, Surface, weight};
