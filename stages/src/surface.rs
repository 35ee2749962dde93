//! Where a particle lies relative to the free surface: the codes of the field `surface`.

/// Inside the liquid.
pub const INSIDE: u32 = 0;
/// It has a boundary particle among its neighbours.
pub const NEAR_BOUNDARY: u32 = 1;
/// It lies at the boundary.
pub const BOUNDARY: u32 = 2;

/// Length of a vector in the plane. (What is taken squares of here is far from the limits of numbers: the standard
/// library's `hypot` would take several times as long.)
#[inline(always)]
pub fn length([r, z]: [f64; 2]) -> f64 {
    (r * r + z * z).sqrt()
}

/// The part of a vector along the outward normal (-t_z, t_r) of a surface with the unit tangent t.
#[inline(always)]
pub(crate) fn outward([r, z]: [f64; 2], [tangent_r, tangent_z]: [f64; 2]) -> f64 {
    tangent_r * z - tangent_z * r
}

/// Particles that are looked at together.
const BLOCK: usize = 16;

/// Calls `at` for everyone near or at the boundary, in order. They are few: where a whole block lies inside it
/// is passed over at once.
#[inline(always)]
pub(crate) fn for_surface(surface: &[u32], mut at: impl FnMut(usize)) {
    for (k, block) in surface.chunks(BLOCK).enumerate() {
        if block.iter().fold(INSIDE, |any, code| any | code) != INSIDE {
            let members = block.iter().enumerate().filter(|(_, code)| **code != INSIDE);
            members.for_each(|(i, _)| at(k * BLOCK + i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_but_the_inside_are_visited() {
        let mut surface = vec![INSIDE; 100];
        let members = [0, 15, 16, 40, 41, 99];
        members.iter().for_each(|&i| surface[i] = if i % 2 == 0 { BOUNDARY } else { NEAR_BOUNDARY });
        let mut visited = Vec::new();
        for_surface(&surface, |i| visited.push(i));
        assert_eq!(visited, members);
    }
}
