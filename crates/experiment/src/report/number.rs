//! Numbers as people read them. Minus signs are hyphens here; the page shows true ones.

/// Digits of measured times, ratios and metrics: their noise is far above the rest.
const DIGITS: i32 = 3;

/// With three significant digits; very small numbers with a power of ten.
pub(super) fn significant(value: f64) -> String {
    if !value.is_finite() {
        return "none".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.abs() < 1e-4 {
        return format!("{value:.*e}", DIGITS as usize - 1);
    }
    let decimals = |value: f64| (DIGITS - 1 - value.abs().log10().floor() as i32).max(0) as usize;
    // Rounding may add a digit: 9.996 is 10.0, not 10.00.
    let rounded: f64 = format!("{value:.*}", decimals(value)).parse().unwrap_or(value);
    grouped(&format!("{value:.*}", decimals(rounded)))
}

/// Rounded to an integer.
pub(super) fn integer(value: f64) -> String {
    if value.is_finite() { grouped(&format!("{value:.0}")) } else { "none".to_owned() }
}

/// A mean of counts: an integer where it is one, else with a decimal.
pub(super) fn count(value: f64) -> String {
    if value.fract() == 0.0 { integer(value) } else { grouped(&format!("{value:.1}")) }
}

/// With a number of decimals.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if value.is_finite() { grouped(&format!("{value:.decimals$}")) } else { "none".to_owned() }
}

/// As it is written in a table of others: with the digits it needs.
pub(super) fn as_printed(value: f64) -> String {
    grouped(&format!("{value}"))
}

/// Commas between thousands, as in 65,536.
fn grouped(number: &str) -> String {
    let (sign, digits) = number.strip_prefix('-').map_or(("", number), |digits| ("-", digits));
    let (whole, rest) = digits.split_at(digits.find('.').unwrap_or(digits.len()));
    let mut text = sign.to_owned();
    for (i, digit) in whole.chars().enumerate() {
        if i > 0 && (whole.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text + rest
}

/// Half a unit of a number's last decimal: how far the number before rounding may lie from it.
///
/// Trailing zeros are lost, so that it is too large for some numbers, never too small.
pub(super) fn rounding(value: f64) -> f64 {
    let text = format!("{value}");
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    0.5 * 10f64.powi(-(decimals as i32))
}

/// The number of a table or figure: in Roman numerals, as publications that are cited have Arabic ones.
pub(super) fn roman(number: usize) -> String {
    const SIGNS: [(usize, &str); 13] = [
        (1000, "M"),
        (900, "CM"),
        (500, "D"),
        (400, "CD"),
        (100, "C"),
        (90, "XC"),
        (50, "L"),
        (40, "XL"),
        (10, "X"),
        (9, "IX"),
        (5, "V"),
        (4, "IV"),
        (1, "I"),
    ];
    let mut left = number;
    let mut text = String::new();
    for (value, sign) in SIGNS {
        text += &sign.repeat(left / value);
        left %= value;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_count() {
        let cases = [
            (0.0, "0"),
            (0.081_23, "0.0812"),
            (0.999_6, "1.00"),
            (9.996, "10.0"),
            (76.945, "76.9"),
            (1383.921, "1,384"),
            (-88.262, "-88.3"),
            (1_234_567.8, "1,234,568"),
            (0.000_1, "0.000100"),
            (0.000_012_34, "1.23e-5"),
            (f64::INFINITY, "none"),
        ];
        for (value, expected) in cases {
            assert_eq!(significant(value), expected);
        }
    }

    #[test]
    fn counts_have_commas_and_means_of_them_a_decimal() {
        assert_eq!([count(9569.0), count(131.5), count(65_536.0), count(999.0)], ["9,569", "131.5", "65,536", "999"]);
        assert_eq!([fixed(68.313_1, 3), fixed(-1234.5, 1), integer(1e6)], ["68.313", "-1,234.5", "1,000,000"]);
        assert_eq!([as_printed(4399.7), as_printed(-82.1)], ["4,399.7", "-82.1"]);
    }

    #[test]
    fn roman_numerals_subtract() {
        assert_eq!([1, 4, 9, 14, 40, 99].map(roman), ["I", "IV", "IX", "XIV", "XL", "XCIX"]);
    }

    #[test]
    fn rounding_is_half_a_unit_of_the_last_decimal() {
        for (value, expected) in [(0.808, 0.0005), (395.16, 0.005), (290.0, 0.5), (1e-7, 0.5e-7)] {
            assert!((rounding(value) - expected).abs() < 1e-12, "{value}");
        }
    }
}
