//! Where one curve falls below another for good.

/// A curve: places in ascending order, both coordinates above 0.
pub(super) type Curve = [(f64, f64)];

/// What two curves do in the range that both cover.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Crossover {
    /// From this place on the second is the smaller one.
    At {
        /// x, interpolated between the logarithms.
        x: f64,
        /// y of both there.
        y: f64,
    },
    /// The second is the smaller one throughout.
    SecondThroughout,
    /// The second is nowhere smaller.
    FirstThroughout,
    /// The second is smaller somewhere, but not at the end.
    FirstAtTheEnd,
    /// There is no range that both cover.
    NoCommonRange,
}

/// Compares two curves, straight lines between the places in a plot with two logarithmic axes.
pub(super) fn crossover(first: &Curve, second: &Curve) -> Crossover {
    let differences = differences(first, second);
    let Some(&(_, last)) = differences.last() else { return Crossover::NoCommonRange };
    // Smaller means strictly: curves that lie on each other cross nowhere.
    let smaller = |&(_, difference): &(f64, f64)| difference < 0.0;
    if last >= 0.0 {
        return if differences.iter().any(smaller) { Crossover::FirstAtTheEnd } else { Crossover::FirstThroughout };
    }
    let Some(before) = differences.iter().rposition(|place| !smaller(place)) else {
        return Crossover::SecondThroughout;
    };
    let ((x0, d0), (x1, d1)) = (differences[before], differences[before + 1]);
    let x = (x0 + (x1 - x0) * d0 / (d0 - d1)).exp();
    Crossover::At { x, y: at(second, x.ln()).map_or(f64::NAN, f64::exp) }
}

/// ln second - ln first over ln x, at every place of either curve in the range that both cover. The difference is
/// linear between them.
fn differences(first: &Curve, second: &Curve) -> Vec<(f64, f64)> {
    let mut places: Vec<f64> = first.iter().chain(second).map(|&(x, _)| x.ln()).collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places.into_iter().filter_map(|x| Some((x, at(second, x)? - at(first, x)?))).collect()
}

/// ln y at ln x; `None` outside the curve.
fn at(curve: &Curve, x: f64) -> Option<f64> {
    if let Some((_, y)) = curve.iter().find(|(place, _)| place.ln() == x) {
        return Some(y.ln());
    }
    let [(x0, y0), (x1, y1)] =
        curve.windows(2).map(|pair| [pair[0], pair[1]]).find(|[a, b]| a.0.ln() <= x && x <= b.0.ln())?;
    let share = (x - x0.ln()) / (x1.ln() - x0.ln());
    Some(y0.ln() + share * (y1.ln() - y0.ln()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = factor * x^exponent at powers of two: straight in a plot with two logarithmic axes.
    fn power(factor: f64, exponent: f64, from: u32, to: u32) -> Vec<(f64, f64)> {
        (from..=to).map(|k| f64::from(1 << k)).map(|x| (x, factor * x.powf(exponent))).collect()
    }

    #[test]
    fn power_laws_cross_where_they_are_equal() {
        // 0.01 x = 3 x^0.4 at x = 300^(1 / 0.6).
        let (plain, cut) = (power(0.01, 1.0, 6, 16), power(3.0, 0.4, 6, 16));
        let expected = 300f64.powf(1.0 / 0.6);
        let Crossover::At { x, y } = crossover(&plain, &cut) else { panic!("they cross") };
        assert!((x / expected - 1.0).abs() < 1e-9, "{x} instead of {expected}");
        assert!((y / (0.01 * expected) - 1.0).abs() < 1e-9, "{y}");
        assert_eq!(crossover(&cut, &plain), Crossover::FirstAtTheEnd);
    }

    #[test]
    fn curves_of_other_places_are_compared_where_both_are() {
        let plain = power(0.01, 1.0, 6, 16);
        let cut: Vec<(f64, f64)> = (1..=9).map(|k| 50.0 * 3f64.powi(k)).map(|x| (x, 3.0 * x.powf(0.4))).collect();
        let Crossover::At { x, .. } = crossover(&plain, &cut) else { panic!("they cross") };
        assert!((x / 300f64.powf(1.0 / 0.6) - 1.0).abs() < 1e-9, "{x}");
        assert_eq!(crossover(&plain, &[(1e6, 1.0), (1e7, 1.0)]), Crossover::NoCommonRange);
        assert_eq!(crossover(&plain, &[]), Crossover::NoCommonRange);
    }

    #[test]
    fn without_a_crossing_the_smaller_one_is_told() {
        let (small, large) = (power(1.0, 0.5, 2, 8), power(2.0, 0.5, 2, 8));
        assert_eq!(crossover(&large, &small), Crossover::SecondThroughout);
        assert_eq!(crossover(&small, &large), Crossover::FirstThroughout);
        assert_eq!(crossover(&small, &small), Crossover::FirstThroughout);
    }

    #[test]
    fn only_the_last_crossing_counts() {
        let flat = [(1.0, 2.0), (10.0, 2.0), (100.0, 2.0), (1000.0, 2.0)];
        let wavy = [(1.0, 4.0), (10.0, 1.0), (100.0, 4.0), (1000.0, 1.0)];
        let Crossover::At { x, y } = crossover(&flat, &wavy) else { panic!("they cross") };
        // Half way from 4 to 1 in logarithms.
        assert!((x - 100.0 * 10f64.sqrt()).abs() < 1e-9 && (y - 2.0).abs() < 1e-9, "{x} {y}");
    }
}
