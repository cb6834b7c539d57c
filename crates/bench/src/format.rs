//! Numbers as tables show them.

/// Seconds, to three figures where they are few.
pub(crate) fn seconds(s: f64) -> String {
    if s < 0.1 { format!("{s:.4}") } else { format!("{s:.3}") }
}

/// Seconds in milliseconds.
pub(crate) fn milliseconds(s: f64) -> String {
    format!("{:.1}", s * 1e3)
}

/// Millions of something per second; a dash where no time was taken.
pub(crate) fn millions_per_second(count: u64, s: f64) -> String {
    if s > 0.0 { format!("{:.2}", count as f64 / s * 1e-6) } else { "-".to_owned() }
}

/// Bytes in MiB.
pub(crate) fn mebibytes(bytes: u64) -> String {
    format!("{:.1} MiB", bytes as f64 / f64::from(1 << 20))
}

/// A whole number in groups of three digits.
pub(crate) fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let starts_group = |i: usize| i > 0 && (digits.len() - i).is_multiple_of(3);
    let digit = |(i, digit)| if starts_group(i) { format!(" {digit}") } else { format!("{digit}") };
    digits.chars().enumerate().map(digit).collect()
}

/// A block of lines as they are.
pub(crate) fn block(lines: &[String]) -> String {
    format!("```text\n{}\n```\n", lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown() {
        assert_eq!([0, 999, 1_000, 1_002_252].map(grouped), ["0", "999", "1 000", "1 002 252"]);
        assert_eq!([0.012_34, 1.5].map(seconds), ["0.0123", "1.500"]);
        assert_eq!(milliseconds(0.030_06), "30.1");
        assert_eq!(mebibytes(3 << 19), "1.5 MiB");
        assert_eq!((millions_per_second(3_000_000, 2.0), millions_per_second(1, 0.0)), ("1.50".into(), "-".into()));
    }
}
