//! The physics of Meniscus: every stage and every pair term in a small file of its own.

pub mod axis_contact;
pub mod boundary_detect;
pub mod central_force;
pub mod colour_field;
pub mod components;
pub mod contact;
pub mod correction;
pub mod curvature_colour;
pub mod curvature_normals;
pub mod equation_of_state;
pub mod fields;
pub mod geometry;
pub mod ghost_coupling;
pub mod initial_pressure;
pub mod integrate;
pub mod kernel_correction;
pub mod liquids;
pub mod moment;
pub mod record;
pub mod reference_pressure;
pub mod shifting;
pub mod sort_bin;
pub mod surface;
pub mod surface_corrections;
pub mod terms;
pub mod velocity_gradient;
