//! The half plane in which particles lie: its axis and its period, and the images of particles across them.

use arrayvec::ArrayVec;

/// Where the half plane ends or repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Domain {
    /// Distance in metres of the coordinates' origin from the axis of symmetry.
    pub origin: f64,
    /// Lower end and length in metres of a period in z.
    pub period: Option<(f64, f64)>,
}

/// A copy of a particle across the axis or a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Image {
    /// The particle that it copies.
    pub source: u32,
    /// Mirrored at the axis: the radius and the radial velocity change their sign.
    pub mirrored: bool,
    /// Added to z, in metres.
    pub shift: f64,
}

impl Domain {
    /// Lists the images of all particles that can lie within `reach` metres of a particle.
    pub fn images(&self, r: &[f64], z: &[f64], reach: f64, images: &mut Vec<Image>) {
        images.clear();
        for (source, (&r, &z)) in r.iter().zip(z).enumerate() {
            images.extend(
                self.images_of(r, z, reach).into_iter().map(|image| Image { source: source as u32, ..image }),
            );
        }
    }

    /// The images of a particle, the zeroth one, that can lie within `reach` metres of another particle.
    pub fn images_of(&self, r: f64, z: f64, reach: f64) -> ArrayVec<Image, 5> {
        let mut images = ArrayVec::new();
        let near_axis = r + self.origin < reach;
        let mut add = |mirrored, shift| images.push(Image { source: 0, mirrored, shift });
        if near_axis {
            add(true, 0.0);
        }
        if let Some((bottom, length)) = self.period {
            for (near, shift) in [(z - bottom < reach, length), (bottom + length - z < reach, -length)] {
                if near {
                    add(false, shift);
                    if near_axis {
                        add(true, shift);
                    }
                }
            }
        }
        images
    }

    /// Radial coordinate of a particle's mirror image.
    #[inline]
    pub fn mirror(&self, r: f64) -> f64 {
        -r - 2.0 * self.origin
    }

    /// Position of an image from that of its particle.
    #[inline]
    pub fn place(&self, image: &Image, r: f64, z: f64) -> (f64, f64) {
        (if image.mirrored { self.mirror(r) } else { r }, z + image.shift)
    }
}
