//! Whether a scene's particles fit into the machine's memory.

use meniscus_cases::scene::Scene;

use crate::failure::Failure;
use crate::output::units::significant;

/// What a run takes for each particle, by `benches/README.md`.
const BYTES: f64 = 400.0;

/// Refuses a scene that takes more memory than there is: the system would end the process without a word.
///
/// # Errors
/// Bad input, with the size of particles that would fit.
pub(crate) fn check(scene: &Scene) -> Result<(), Failure> {
    physical().map_or(Ok(()), |there| compare(scene, there))
}

fn compare(scene: &Scene, there: f64) -> Result<(), Failure> {
    let particles = scene.expected_particles();
    let needed = BYTES * particles;
    if needed <= there {
        return Ok(());
    }
    let gigabytes = |bytes: f64| significant(bytes / 1e9, 3);
    Err(Failure::input(format!(
        "the scene takes {} particles and some {} GB of memory, but the machine has {} GB; choose a particle size \
         of {} m or more in `{}`, or a machine with more memory",
        significant(particles, 3),
        gigabytes(needed),
        gigabytes(there),
        // The next larger one of three digits.
        significant(1.005 * scene.particle_size * (needed / there).sqrt(), 3),
        scene.source_name,
    )))
}

/// Bytes of memory of the machine, where the system tells.
#[cfg(target_os = "linux")]
fn physical() -> Option<f64> {
    let system = rustix::system::sysinfo();
    Some(system.totalram as f64 * f64::from(system.mem_unit))
}

#[cfg(not(target_os = "linux"))]
fn physical() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_cases::scene::parse;

    #[test]
    fn what_does_not_fit_is_refused_with_a_size_that_does() {
        const DROP: &str = r#"format = 1
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
[particles]
size = "1 nm"
[run]
until = "1 us"
"#;
        let scene = parse("drop.toml", DROP, &[]).unwrap();
        assert!(compare(&scene, 1e9).is_ok());
        let told = format!("{:?}", compare(&scene, 1e8).unwrap_err());
        // Without the line breaks of the terminal.
        let told = told.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(told.contains("1.57e6 particles") && told.contains("0.628 GB"), "{told}");
        assert!(told.contains("0.100 GB") && told.contains("2.52e-9 m or more"), "{told}");
        let larger = parse("drop.toml", DROP, &["particles.size=2.52e-9 m".to_owned()]).unwrap();
        assert!(compare(&larger, 1e8).is_ok());
    }
}
