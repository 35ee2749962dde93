//! Every field of Meniscus, declared once. Storage, sorting, checkpoints, inspection and export follow.

use meniscus_engine::field::Field;

type Real = Field<f64>;
type Index = Field<u32>;

// Kept from step to step.

/// Which particle it is, whatever its place in memory.
pub static IDENTITY: Index = Field::state("identity", "i", "1", "Number of the particle, kept for life.");
/// Distance from the axis less the origin of the scene.
pub static RADIUS: Real = Field::state("radius", "r", "m", "Distance from the axis less the scene's origin.");
/// Position along the axis.
pub static AXIAL: Real = Field::state("axial", "z", "m", "Position along the axis.");
/// Radial velocity.
pub static VELOCITY_R: Real = Field::state("velocity_r", "U_r", "m/s", "Radial velocity.");
/// Axial velocity.
pub static VELOCITY_Z: Real = Field::state("velocity_z", "U_z", "m/s", "Axial velocity.");
/// Density.
pub static DENSITY: Real = Field::state("density", "rho", "kg/m3", "Density.");
/// Mass of the torus that a particle is.
pub static MASS: Real = Field::state("mass", "m", "kg", "Mass of the particle's torus.");
/// Total specific energy, kinetic and internal.
pub static TOTAL_ENERGY: Real =
    Field::state("total_energy", "E", "J/kg", "Specific kinetic and internal energy.");
/// Which drop it belongs to.
pub static DROP: Index =
    Field::state("drop", "d", "1", "Number of the connected body of liquid that the particle belongs to.");
/// Constant that is subtracted from pressures, less that of the first drop.
pub static REFERENCE_PRESSURE: Real = Field::state(
    "reference_pressure",
    "P_ref",
    "Pa",
    "Pressure subtracted from the particle's own and its ghost's, the same within one drop, less that of the first \
     drop, a number of the clock.",
);
/// Radius at which the neighbour list was built.
pub static LIST_RADIUS: Real =
    Field::state("list_radius", "r_l", "m", "Radius when the neighbour list was built.");
/// Axial position at which the neighbour list was built.
pub static LIST_AXIAL: Real =
    Field::state("list_axial", "z_l", "m", "Axial position when the neighbour list was built.");
/// Half of the support radius for which the neighbour list was built.
pub static LIST_REACH: Real =
    Field::state("list_reach", "h_l", "m", "Half support radius when the neighbour list was built.");
/// Factor of the kernel gradient.
pub static KERNEL_SCALE: Real = Field::state(
    "kernel_scale",
    "s",
    "1",
    "Factor of the kernel gradient that makes the discrete gradient exact in the mean.",
);
/// Where the particle lies relative to the surface.
pub static SURFACE: Index =
    Field::state("surface", "b", "1", "0 inside, 1 near the boundary, 2 at the boundary.");
/// Laplace pressure when the curvature was last computed.
pub static LAPLACE_PRESSURE: Real = Field::state(
    "laplace_pressure",
    "P_L",
    "Pa",
    "Surface tension times curvature when the curvature was last computed; zero inside.",
);
/// Rate at which the Laplace pressure is carried on.
pub static LAPLACE_PRESSURE_RATE: Real = Field::state(
    "laplace_pressure_rate",
    "dP_L/dt",
    "Pa/s",
    "Rate at which the Laplace pressure is carried on until the curvature is computed anew.",
);
/// Rate of the Laplace pressure between the last two computations of the curvature.
pub static LAPLACE_PRESSURE_LAST_RATE: Real = Field::state(
    "laplace_pressure_last_rate",
    "dP_L/dt",
    "Pa/s",
    "Rate of the Laplace pressure between the last two computations of the curvature.",
);
/// The way from the particle to the surface, radial component.
pub static SURFACE_OFFSET_R: Real = Field::state(
    "surface_offset_r",
    "x_s - x",
    "m",
    "The way to the surface when the curvature was last computed, radial component; zero inside.",
);
/// The way from the particle to the surface, axial component.
pub static SURFACE_OFFSET_Z: Real = Field::state(
    "surface_offset_z",
    "x_s - x",
    "m",
    "The way to the surface when the curvature was last computed, axial component; zero inside.",
);
/// What of a particle's area at the start is not wanted where it is.
pub static REFINEMENT: Real = Field::state(
    "refinement",
    "1 - V_w/V_0",
    "1",
    "What of the area at the start is not wanted: zero but where a thread is thin.",
);
/// Unit tangent of the surface, radial component.
pub static SURFACE_TANGENT_R: Real = Field::state(
    "surface_tangent_r",
    "t_r",
    "1",
    "Unit tangent of the surface when the curvature was last computed, radial component; zero inside.",
);
/// Unit tangent of the surface, axial component.
pub static SURFACE_TANGENT_Z: Real = Field::state(
    "surface_tangent_z",
    "t_z",
    "1",
    "Unit tangent of the surface when the curvature was last computed, axial component; zero inside.",
);
/// Tension deficit, radial component.
pub static TENSION_DEFICIT_R: Real = Field::state(
    "tension_deficit_r",
    "f_r",
    "Pa",
    "What surface forces lack of the tension's pull, over the length of the ghost's area, radial component.",
);
/// Tension deficit, axial component.
pub static TENSION_DEFICIT_Z: Real = Field::state(
    "tension_deficit_z",
    "f_z",
    "Pa",
    "What surface forces lack of the tension's pull, over the length of the ghost's area, axial component.",
);
/// Slope of the tension deficit across the surface.
pub static TENSION_DEFICIT_SLOPE: Real = Field::state(
    "tension_deficit_slope",
    "df_n/ds",
    "Pa/m",
    "Slope along the surface of what ghosts lack of pressure, in the direction of the tangent.",
);
/// Void fraction around a particle.
pub static VOID_FRACTION: Real = Field::state(
    "void_fraction",
    "1 - c",
    "1",
    "Void fraction: the part of the room around a particle that others leave empty, when it was last looked at.",
);
/// Slope of the Laplace pressure along the surface's tangent.
pub static LAPLACE_SLOPE: Real = Field::state(
    "laplace_slope",
    "dP_L/ds",
    "Pa/m",
    "Slope of the Laplace pressure along the surface's tangent when the curvature was last computed; zero inside.",
);
/// Rate at which that slope is carried on.
pub static LAPLACE_SLOPE_RATE: Real = Field::state(
    "laplace_slope_rate",
    "d2P_L/ds dt",
    "Pa/m/s",
    "Rate at which the Laplace pressure's slope is carried on until the curvature is computed anew.",
);
/// Rate of that slope between the last two computations of the curvature.
pub static LAPLACE_SLOPE_LAST_RATE: Real = Field::state(
    "laplace_slope_last_rate",
    "d2P_L/ds dt",
    "Pa/m/s",
    "Rate of the Laplace pressure's slope between the last two computations of the curvature.",
);
/// Non-dissipative acceleration of the step before, radial component.
pub static PREVIOUS_ACCELERATION_R: Real = Field::state(
    "previous_acceleration_r",
    "a_w",
    "m/s2",
    "Acceleration of the step before without the velocity jump's part, radial component.",
);
/// Non-dissipative acceleration of the step before, axial component.
pub static PREVIOUS_ACCELERATION_Z: Real = Field::state(
    "previous_acceleration_z",
    "a_w",
    "m/s2",
    "Acceleration of the step before without the velocity jump's part, axial component.",
);
/// d U_r / d r of the step before.
pub static DEFORMATION_RR: Real =
    Field::state("deformation_rr", "dU_r/dr", "1/s", "Rate of deformation of the step before.");
/// d U_r / d z + d U_z / d r of the step before.
pub static DEFORMATION_SHEAR: Real =
    Field::state("deformation_shear", "dU_r/dz + dU_z/dr", "1/s", "Rate of deformation of the step before.");
/// d U_z / d z of the step before.
pub static DEFORMATION_ZZ: Real =
    Field::state("deformation_zz", "dU_z/dz", "1/s", "Rate of deformation of the step before.");
/// Smoothed rate of change of d U_r / d r.
pub static DEFORMATION_CHANGE_RR: Real =
    Field::state("deformation_change_rr", "s_rr", "1/s2", "Smoothed change of the rate of deformation.");
/// Smoothed rate of change of the shear.
pub static DEFORMATION_CHANGE_SHEAR: Real =
    Field::state("deformation_change_shear", "s_rz", "1/s2", "Smoothed change of the rate of deformation.");
/// Smoothed rate of change of d U_z / d z.
pub static DEFORMATION_CHANGE_ZZ: Real =
    Field::state("deformation_change_zz", "s_zz", "1/s2", "Smoothed change of the rate of deformation.");

// Computed anew in every step.

/// Sound speed.
pub static SOUND_SPEED: Real = Field::derived("sound_speed", "C", "m/s", "Speed of sound.");
/// Volumetric strain rate d eps / dt.
pub static STRAIN_RATE: Real =
    Field::derived("strain_rate", "deps/dt", "1/s", "Volumetric strain rate, -(1/rho) d rho/dt.");
/// Force density without the velocity jump's part, radial.
pub static FORCE_R: Real = Field::derived(
    "force_r",
    "rho a_w",
    "N/m3",
    "Density times acceleration without the velocity jump's part, radial component.",
);
/// Force density without the velocity jump's part, axial.
pub static FORCE_Z: Real = Field::derived(
    "force_z",
    "rho a_w",
    "N/m3",
    "Density times acceleration without the velocity jump's part, axial component.",
);
/// Dissipative force density, radial.
pub static DISSIPATION_R: Real = Field::derived(
    "dissipation_r",
    "rho a_d",
    "N/m3",
    "Density times acceleration by the velocity jumps of the Riemann states, radial component.",
);
/// Dissipative force density, axial.
pub static DISSIPATION_Z: Real = Field::derived(
    "dissipation_z",
    "rho a_d",
    "N/m3",
    "Density times acceleration by the velocity jumps of the Riemann states, axial component.",
);
/// Density times the rate of the total specific energy.
pub static POWER: Real =
    Field::derived("power", "rho dE/dt", "W/m3", "Density times the rate of the total specific energy.");
/// Force density that acts through the free surface, radial.
pub static SURFACE_FORCE_R: Real = Field::derived(
    "surface_force_r",
    "f_s",
    "N/m3",
    "Force density that acts through the free surface, radial component.",
);
/// Force density that acts through the free surface, axial.
pub static SURFACE_FORCE_Z: Real = Field::derived(
    "surface_force_z",
    "f_s",
    "N/m3",
    "Force density that acts through the free surface, axial component.",
);
/// Support deficiency I - L, component rr.
pub static SUPPORT_DEFICIENCY_RR: Real = Field::derived(
    "support_deficiency_rr",
    "1 - L_rr",
    "1",
    "What the moment matrix lacks of one; zero away from the surface.",
);
/// Support deficiency I - L, component rz.
pub static SUPPORT_DEFICIENCY_RZ: Real = Field::derived(
    "support_deficiency_rz",
    "-L_rz",
    "1",
    "What the moment matrix lacks of one; zero away from the surface.",
);
/// Support deficiency I - L, component zz.
pub static SUPPORT_DEFICIENCY_ZZ: Real = Field::derived(
    "support_deficiency_zz",
    "1 - L_zz",
    "1",
    "What the moment matrix lacks of one; zero away from the surface.",
);
/// Weight vector of the ghost particle, radial.
pub static GHOST_WEIGHT_R: Real = Field::derived(
    "ghost_weight_r",
    "bw_r",
    "1/m",
    "Weight vector of the particle's ghost, outward, radial component; zero away from the surface.",
);
/// Weight vector of the ghost particle, axial.
pub static GHOST_WEIGHT_Z: Real = Field::derived(
    "ghost_weight_z",
    "bw_z",
    "1/m",
    "Weight vector of the particle's ghost, outward, axial component; zero away from the surface.",
);
/// d U_r / d z - d U_z / d r.
pub static ROTATION: Real =
    Field::derived("rotation", "dU_r/dz - dU_z/dr", "1/s", "Rotation of the velocity.");
/// What a shift brings of axial velocity.
pub static CARRIED_Z: Real = Field::derived(
    "carried_z",
    "dx . grad U_z",
    "m/s",
    "What a particle takes up of the flow's axial velocity at the place to which it was shifted.",
);

// Handed on within a step, from one stage to those that follow it.

/// Viscous force density, radial.
pub static VISCOUS_FORCE_R: Real =
    Field::transient("viscous_force_r", "f_v", "N/m3", "Viscous force density, radial component.");
/// Viscous force density, axial.
pub static VISCOUS_FORCE_Z: Real =
    Field::transient("viscous_force_z", "f_v", "N/m3", "Viscous force density, axial component.");
/// Power density of the viscous stress.
pub static VISCOUS_POWER: Real = Field::transient(
    "viscous_power",
    "rho dE_v/dt",
    "W/m3",
    "Density times the rate of the total specific energy by the viscous stress.",
);
/// Moment matrix L_rr.
pub static MOMENT_RR: Real =
    Field::transient("moment_rr", "L_rr", "1", "Moment matrix, one inside and less at the surface.");
/// Moment matrix L_rz.
pub static MOMENT_RZ: Real = Field::transient("moment_rz", "L_rz", "1", "Moment matrix, zero inside.");
/// Moment matrix L_zz.
pub static MOMENT_ZZ: Real =
    Field::transient("moment_zz", "L_zz", "1", "Moment matrix, one inside and less at the surface.");
/// Velocity differences summed for the gradient: radial velocity, radial direction.
pub static VELOCITY_SUM_RR: Real =
    Field::transient("velocity_sum_rr", "T_rr", "1/s", "Velocity gradient before division by L.");
/// Velocity differences summed for the gradient: radial velocity, axial direction.
pub static VELOCITY_SUM_RZ: Real =
    Field::transient("velocity_sum_rz", "T_rz", "1/s", "Velocity gradient before division by L.");
/// Velocity differences summed for the gradient: axial velocity, radial direction.
pub static VELOCITY_SUM_ZR: Real =
    Field::transient("velocity_sum_zr", "T_zr", "1/s", "Velocity gradient before division by L.");
/// Velocity differences summed for the gradient: axial velocity, axial direction.
pub static VELOCITY_SUM_ZZ: Real =
    Field::transient("velocity_sum_zz", "T_zz", "1/s", "Velocity gradient before division by L.");
/// The sum that becomes the weight vector of the ghost, radial.
pub static GHOST_WEIGHT_SUM_R: Real =
    Field::transient("ghost_weight_sum_r", "bw_r", "1/m", "Weight vector of a ghost, radial component.");
/// The sum that becomes the weight vector of the ghost, axial.
pub static GHOST_WEIGHT_SUM_Z: Real =
    Field::transient("ghost_weight_sum_z", "bw_z", "1/m", "Weight vector of a ghost, axial component.");
/// Gradient of the particle concentration, radial.
pub static CONCENTRATION_GRADIENT_R: Real = Field::transient(
    "concentration_gradient_r",
    "grad C_r",
    "1/m",
    "Gradient of the particle concentration, from which shifting moves away, radial component.",
);
/// Gradient of the particle concentration, axial.
pub static CONCENTRATION_GRADIENT_Z: Real = Field::transient(
    "concentration_gradient_z",
    "grad C_z",
    "1/m",
    "Gradient of the particle concentration, from which shifting moves away, axial component.",
);

// Vectors and tensors, their components in the order in which stages take them.

/// r and z.
pub static POSITION: [&Real; 2] = [&RADIUS, &AXIAL];
/// U_r and U_z.
pub static VELOCITY: [&Real; 2] = [&VELOCITY_R, &VELOCITY_Z];
/// r, z and reach for which the list was built.
pub static LISTED: [&Real; 3] = [&LIST_RADIUS, &LIST_AXIAL, &LIST_REACH];
/// The way to the surface.
pub static SURFACE_OFFSET: [&Real; 2] = [&SURFACE_OFFSET_R, &SURFACE_OFFSET_Z];
/// The tangent of the surface.
pub static SURFACE_TANGENT: [&Real; 2] = [&SURFACE_TANGENT_R, &SURFACE_TANGENT_Z];
/// The acceleration of the step before.
pub static PREVIOUS_ACCELERATION: [&Real; 2] = [&PREVIOUS_ACCELERATION_R, &PREVIOUS_ACCELERATION_Z];
/// The rate of deformation.
pub static DEFORMATION: [&Real; 3] = [&DEFORMATION_RR, &DEFORMATION_SHEAR, &DEFORMATION_ZZ];
/// The change of the rate of deformation.
pub static DEFORMATION_CHANGE: [&Real; 3] =
    [&DEFORMATION_CHANGE_RR, &DEFORMATION_CHANGE_SHEAR, &DEFORMATION_CHANGE_ZZ];
/// The force.
pub static FORCE: [&Real; 2] = [&FORCE_R, &FORCE_Z];
/// The dissipative part of the force.
pub static DISSIPATION: [&Real; 2] = [&DISSIPATION_R, &DISSIPATION_Z];
/// The force of the surface.
pub static SURFACE_FORCE: [&Real; 2] = [&SURFACE_FORCE_R, &SURFACE_FORCE_Z];
/// What the moment matrix lacks.
pub static SUPPORT_DEFICIENCY: [&Real; 3] =
    [&SUPPORT_DEFICIENCY_RR, &SUPPORT_DEFICIENCY_RZ, &SUPPORT_DEFICIENCY_ZZ];
/// The weight of the ghosts.
pub static GHOST_WEIGHT: [&Real; 2] = [&GHOST_WEIGHT_R, &GHOST_WEIGHT_Z];
/// The moment matrix.
pub static MOMENT: [&Real; 3] = [&MOMENT_RR, &MOMENT_RZ, &MOMENT_ZZ];
/// The viscous force.
pub static VISCOUS_FORCE: [&Real; 2] = [&VISCOUS_FORCE_R, &VISCOUS_FORCE_Z];
/// The sum of the ghosts' weights.
pub static GHOST_WEIGHT_SUM: [&Real; 2] = [&GHOST_WEIGHT_SUM_R, &GHOST_WEIGHT_SUM_Z];
/// The sum of velocities.
pub static VELOCITY_SUM: [&Real; 4] =
    [&VELOCITY_SUM_RR, &VELOCITY_SUM_RZ, &VELOCITY_SUM_ZR, &VELOCITY_SUM_ZZ];
/// The gradient of the concentration.
pub static CONCENTRATION_GRADIENT: [&Real; 2] = [&CONCENTRATION_GRADIENT_R, &CONCENTRATION_GRADIENT_Z];
/// What the balance of tension lacks.
pub static TENSION_DEFICIT: [&Real; 2] = [&TENSION_DEFICIT_R, &TENSION_DEFICIT_Z];
