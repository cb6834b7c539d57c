//! Decimal numbers, the same in every text format.

/// Why a text is not a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NumberError {
    /// Not digits with an optional sign, point and exponent. Words such as `nan` and `inf` are not numbers either.
    Malformed,
    /// A number, but beyond the range of a 32-bit float.
    TooLarge,
}

impl NumberError {
    /// The message about `token`.
    pub(crate) fn message(self, token: &str) -> String {
        match self {
            Self::Malformed if token.is_empty() => "a number is missing".to_owned(),
            Self::Malformed => format!("`{token}` is not a number"),
            Self::TooLarge => format!("`{token}` is too large for a 32-bit number"),
        }
    }
}

/// What a number looks like, to follow the word "expected".
pub(crate) const NUMBER_EXAMPLE: &str = "a number such as 1, -0.5 or 1e-3";

/// Parses all of `token`: `1`, `-1`, `.5`, `2.`, `+2`, `1e-3`.
pub(crate) fn parse_number(token: &str) -> Result<f32, NumberError> {
    if token.is_empty() || number_length(token) != token.len() {
        return Err(NumberError::Malformed);
    }
    let value: f32 = token.parse().map_err(|_| NumberError::Malformed)?;
    if value.is_finite() { Ok(value) } else { Err(NumberError::TooLarge) }
}

/// The same with the precision of 64 bits.
pub(crate) fn parse_exact(token: &str) -> Result<f64, NumberError> {
    parse_number(token)?;
    token.parse().map_err(|_| NumberError::Malformed)
}

/// Length in bytes of the number that `text` starts with; 0 if it starts with none.
pub(crate) fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(sign);
    let mut end = sign + whole;
    let mut fraction = 0;
    if bytes.get(end) == Some(&b'.') {
        fraction = digits(end + 1);
        end += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let exponent_sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let start = end + 1 + exponent_sign;
        let count = bytes.get(start..).map_or(0, |_| digits(start));
        if count > 0 {
            end = start + count;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_of_a_number_is_read() {
        let cases = [
            ("1", 1.0),
            ("-1", -1.0),
            (".5", 0.5),
            ("2.", 2.0),
            ("+2", 2.0),
            ("1e-3", 1e-3),
            ("-.7E+02", -70.0),
            (".8e-001", 0.08),
        ];
        for (text, value) in cases {
            assert_eq!(parse_number(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn other_words_are_refused() {
        for text in
            ["", "-", ".", "e5", "1e", "1e+", "nan", "NaN", "inf", "-inf", "1.#IND", "1.2.3", "0x10", "1_0", "1 "]
        {
            assert_eq!(parse_number(text), Err(NumberError::Malformed), "{text}");
        }
        assert_eq!(parse_number("1e400"), Err(NumberError::TooLarge));
        assert_eq!(parse_number(&"9".repeat(60)), Err(NumberError::TooLarge));
    }

    #[test]
    fn numbers_end_where_names_start() {
        assert_eq!(number_length("400H400"), 3);
        assert_eq!(number_length("4e3H"), 3);
        assert_eq!(number_length("4eH"), 1);
        assert_eq!(number_length("H4"), 0);
    }
}
