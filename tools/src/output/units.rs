//! Numbers with units, as people like to read them.

/// How values of one unit are best shown: multiply by `factor`, write `unit`.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    /// Multiplier from SI to the shown unit.
    pub factor: f64,
    /// The unit to write, with its prefix: "µs", "mm/s", "kg/m³".
    pub unit: String,
}

const PREFIXES: [(i32, &str); 13] = [
    (-18, "a"),
    (-15, "f"),
    (-12, "p"),
    (-9, "n"),
    (-6, "µ"),
    (-3, "m"),
    (0, ""),
    (3, "k"),
    (6, "M"),
    (9, "G"),
    (12, "T"),
    (15, "P"),
    (18, "E"),
];

/// Symbols that may take a prefix; a kilogram has one already.
const PREFIXABLE: [&str; 10] = ["s", "m", "N", "J", "W", "Pa", "Hz", "A", "V", "K"];

/// The scale at which a value of `magnitude` (in the SI `unit`) has one to
/// three digits before the point. Units that take no prefix ("", "%", "m^2",
/// "kg/m^3") stay as they are, and so do values so far beyond the prefixes
/// that they would need an exponent besides.
pub fn scale(magnitude: f64, unit: &str) -> Scale {
    let exponent = if takes_prefix(unit) && magnitude.is_finite() && magnitude != 0.0 {
        match decimal_exponent(magnitude, 4).div_euclid(3) * 3 {
            thousands @ -21..=21 => thousands.clamp(-18, 18),
            _ => 0,
        }
    } else {
        0
    };
    let prefix = PREFIXES.iter().find(|(power, _)| *power == exponent).map_or("", |(_, prefix)| prefix);
    Scale { factor: 10f64.powi(-exponent), unit: format!("{prefix}{}", typeset(unit)) }
}

/// `value` (SI) with its unit and a fitting prefix: "1.235 ms".
pub fn quantity(value: f64, unit: &str, digits: usize) -> String {
    let scale = scale(value, unit);
    let number = significant(value * scale.factor, digits);
    match scale.unit.as_str() {
        "" | "1" => number,
        unit => format!("{number} {unit}"),
    }
}

/// `value` rounded to so many significant digits; powers of ten outside
/// 1e-3 to 1e6 are written with an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    let digits = digits.max(1);
    let exponent = decimal_exponent(value, digits);
    if !(-3..6).contains(&exponent) {
        return format!("{value:.*e}", digits - 1);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// Seconds as people count them: "12.3 ms", "41.2 s", "3 min 05 s", "2 h 07 min", "3 d 04 h", "5.32 years".
pub fn duration(seconds: f64) -> String {
    const YEAR: f64 = 365.25 * 86_400.0;
    if seconds.is_nan() || seconds < 100.0 || seconds.is_infinite() {
        return quantity(seconds, "s", 3);
    }
    if seconds >= YEAR {
        return format!("{} years", significant(seconds / YEAR, 3));
    }
    let whole = seconds.round() as u64;
    match whole {
        0..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        3600..86_400 => format!("{} h {:02} min", whole / 3600, whole % 3600 / 60),
        _ => format!("{} d {:02} h", whole / 86_400, whole % 86_400 / 3600),
    }
}

/// A whole number with thin groups of three: "1 234 567".
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A number of things: "1 step", "1 234 steps".
pub fn counted(number: u64, thing: &str) -> String {
    format!("{} {thing}{}", grouped(number), if number == 1 { "" } else { "s" })
}

/// A label and its unit: "time \[µs\]"; no brackets where there is no unit.
pub fn labelled(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// Parts "name \[unit\]" into both; the unit is empty when there is none.
pub fn split_label(label: &str) -> (&str, &str) {
    label
        .strip_suffix(']')
        .and_then(|rest| rest.rsplit_once('['))
        .map_or((label, ""), |(name, unit)| (name.trim_end(), unit))
}

/// The largest of 1, 2 and 5 times a power of ten that is at most `length`.
/// `length` must be positive and finite.
pub fn round_below(length: f64) -> f64 {
    let power = 10f64.powf(length.log10().floor());
    let lead = length / power * (1.0 + 1e-9);
    let nice = [5.0, 2.0].into_iter().find(|nice| *nice <= lead);
    power * nice.unwrap_or(1.0)
}

/// Round values between `low` and `high`, about `count` of them.
pub fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let span = high - low;
    if !(span.is_finite() && span > 0.0) {
        return vec![low];
    }
    // Round steps lie up to 2.5 apart: this one misses the count by 1.7 at most.
    let step = round_below(1.5 * span / count.max(1) as f64);
    let tolerance = 1e-9 * span;
    let first = ((low - tolerance) / step).ceil() as i64;
    let last = ((high + tolerance) / step).floor() as i64;
    (first..=last).map(|index| index as f64 * step).collect()
}

/// Exponent of ten of `value` once rounded to so many digits.
pub(super) fn decimal_exponent(value: f64, digits: usize) -> i32 {
    let text = format!("{value:.*e}", digits - 1);
    text.rsplit_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0)
}

fn takes_prefix(unit: &str) -> bool {
    let symbol = unit.split(|letter: char| !letter.is_alphabetic()).next();
    let raised = |rest: &str| rest.starts_with(['^', '²', '³']);
    symbol.is_some_and(|symbol| PREFIXABLE.contains(&symbol) && !raised(&unit[symbol.len()..]))
}

fn typeset(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace('*', "·")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_get_the_fitting_prefix() {
        assert_eq!(quantity(1.2345e-6, "s", 4), "1.234 µs");
        assert_eq!(quantity(-2.5e-3, "m/s", 3), "-2.50 mm/s");
        assert_eq!(quantity(0.99999e-3, "s", 3), "1.00 ms");
        assert_eq!(quantity(101_325.0, "Pa", 4), "101.3 kPa");
        assert_eq!(quantity(0.0, "s", 3), "0 s");
        assert_eq!(quantity(1e283, "m/s", 4), "1.000e283 m/s");
        assert_eq!([quantity(2e22, "s", 2), quantity(2e-20, "J", 2)], ["20000 Es", "0.020 aJ"]);
        assert_eq!(quantity(2e-25, "J", 2), "2.0e-25 J");
        assert_eq!(quantity(998.2, "kg/m^3", 4), "998.2 kg/m³");
        assert_eq!(quantity(1.5e-7, "m^2", 2), "1.5e-7 m²");
        assert_eq!(quantity(3.25, "1", 3), "3.25");
        assert_eq!(quantity(f64::NAN, "s", 3), "NaN s");
    }

    #[test]
    fn digits_labels_and_groups() {
        assert_eq!(significant(1234.6, 3), "1235");
        assert_eq!(significant(0.012345, 3), "0.0123");
        assert_eq!(grouped(1_234_567), "1 234 567");
        assert_eq!(grouped(12), "12");
        assert_eq!([counted(1, "step"), counted(1200, "step")], ["1 step", "1 200 steps"]);
        assert_eq!(split_label("time [s]"), ("time", "s"));
        assert_eq!(split_label("cycles"), ("cycles", ""));
        assert_eq!(labelled("cycles", "1"), "cycles");
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let fifths = ticks(0.0, 1.0, 5);
        assert_eq!((fifths.len(), fifths[0], fifths[5]), (6, 0.0, 1.0));
        assert_eq!(ticks(-1.1, 1.1, 2), [-1.0, 0.0, 1.0]);
        assert_eq!(ticks(3.0, 3.0, 5), [3.0]);
        assert_eq!(round_below(4.9e-6), 2e-6);
        assert!((round_below(5e-6) - 5e-6).abs() < 1e-18);
    }

    #[test]
    fn durations() {
        assert_eq!(duration(0.0123), "12.3 ms");
        assert_eq!(duration(185.0), "3 min 05 s");
        assert_eq!(duration(7620.0), "2 h 07 min");
        assert_eq!(duration(86_399.9), "1 d 00 h");
        assert_eq!(duration(273_600.0), "3 d 04 h");
        assert_eq!(duration(8.05e9), "255 years");
        assert_eq!(duration(1e290), "3.17e282 years");
        assert_eq!(duration(f64::INFINITY), "inf s");
    }
}
