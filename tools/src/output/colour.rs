//! Colour maps of even perceived steps.

/// A colour map from 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourMap {
    /// Dark violet over green to yellow, for quantities with a low and a high
    /// end; readable in grey and with any colour vision.
    #[default]
    Viridis,
    /// Blue over grey to red, for signed quantities around zero.
    BlueRed,
}

/// Red, green and blue.
pub(super) type Colour = [u8; 3];

/// Evenly spaced samples of the public-domain map of that name.
const VIRIDIS: [Colour; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// Evenly spaced samples of a diverging map with a light grey middle, which
/// stays visible on white.
const BLUE_RED: [Colour; 9] = [
    [59, 76, 192],
    [98, 130, 234],
    [141, 176, 254],
    [184, 208, 249],
    [221, 221, 221],
    [245, 196, 173],
    [244, 154, 123],
    [222, 96, 77],
    [180, 4, 38],
];

impl ColourMap {
    /// The colour (red, green, blue) at `fraction`; what lies beyond 0 to 1
    /// takes the colour of the nearer end, what is not a number is magenta.
    pub fn at(self, fraction: f64) -> [u8; 3] {
        if fraction.is_nan() {
            return [255, 0, 255];
        }
        let samples: &[Colour] = match self {
            Self::Viridis => &VIRIDIS,
            Self::BlueRed => &BLUE_RED,
        };
        let place = fraction.clamp(0.0, 1.0) * (samples.len() - 1) as f64;
        let index = (place as usize).min(samples.len() - 2);
        let weight = place - index as f64;
        let (from, to) = (samples[index], samples[index + 1]);
        std::array::from_fn(|channel| {
            let (from, to) = (f64::from(from[channel]), f64::from(to[channel]));
            (from + weight * (to - from)).round() as u8
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_middle_and_beyond() {
        assert_eq!(ColourMap::Viridis.at(0.0), [68, 1, 84]);
        assert_eq!(ColourMap::Viridis.at(7.0), [253, 231, 37]);
        assert_eq!(ColourMap::BlueRed.at(0.5), [221, 221, 221]);
        assert_eq!(ColourMap::BlueRed.at(f64::NAN), [255, 0, 255]);
    }

    #[test]
    fn viridis_grows_lighter_all_the_way() {
        let lightness = |index: i32| {
            let [red, green, blue] = ColourMap::Viridis.at(f64::from(index) / 100.0);
            0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue)
        };
        assert!((0..100).all(|index| lightness(index + 1) > lightness(index) - 0.5));
    }
}
