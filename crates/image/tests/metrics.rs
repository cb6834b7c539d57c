//! Every metric against other programs' figures: the pairs of the shared material with what reference implementations
//! printed for them.

// The helpers of tests are tests too, but clippy sees only `#[test]`.
#![allow(clippy::unwrap_used)]

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use lightcuts_image::metrics::flip::Exposures;
use lightcuts_image::metrics::{Comparison, Metric, MetricOptions, PerceptualDiff, compare};
use lightcuts_image::{Picture, Transfer, max_abs_difference, read_exr, read_png};
use lightcuts_testkit::shared;

/// A row of `expected.csv`: cells by column.
type Row = HashMap<String, String>;

fn rows(csv: &str) -> Vec<Row> {
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), columns.len(), "{line}");
        columns.iter().zip(cells).map(|(column, cell)| ((*column).to_owned(), cell.to_owned())).collect()
    };
    lines.map(row).collect()
}

/// The picture `name` as its EXR file has it; what it shows must be what its PNG file has.
fn picture(folder: &Path, name: &str) -> Picture {
    let linear = read_exr(folder.join(format!("{name}.exr"))).unwrap().into_beauty();
    let picture = Picture::from_linear(linear, Transfer::Srgb);
    let codes = read_png(folder.join(format!("{name}.png")), Transfer::Linear).unwrap();
    assert_eq!(max_abs_difference(picture.display(), &codes).unwrap(), 0.0, "{name}");
    picture
}

fn measure(reference: &Picture, test: &Picture, metrics: &[Metric], options: &MetricOptions) -> Comparison {
    compare(reference, test, metrics, options, &|_| ()).unwrap()
}

/// How far `found` may lie from what is expected.
#[derive(Clone, Copy)]
enum Within {
    Absolute(f64),
    Relative(f64),
}

/// Checks a cell unless it is empty (no such figure) or `refused` (the reference implementation gave none).
fn check(row: &Row, column: &str, found: Option<f64>, within: Within) {
    let cell = row[column].as_str();
    if cell.is_empty() || cell == "refused" {
        return;
    }
    let (expected, found) = (cell.parse::<f64>().unwrap(), found.unwrap());
    let close = match within {
        _ if expected.is_nan() => found.is_nan(),
        _ if expected.is_infinite() => expected == found,
        Within::Absolute(tolerance) => (found - expected).abs() <= tolerance,
        Within::Relative(tolerance) => (found - expected).abs() <= tolerance * expected.abs(),
    };
    assert!(close, "{} {column}: {found}, expected {expected}", row["pair"]);
}

fn check_pdiff(row: &Row, reference: &Picture, test: &Picture, all: &Comparison) {
    let pixels = |pdiff| {
        let options = MetricOptions { pdiff, ..Default::default() };
        measure(reference, test, &[Metric::PdiffPx], &options).value(Metric::PdiffPx)
    };
    let settings = PerceptualDiff::default();
    // The goal is max(2, 0.2 %); the same order of arithmetic gives the very counts.
    let exact = Within::Absolute(0.0);
    check(row, "pdiff_px", all.value(Metric::PdiffPx), exact);
    check(row, "pdiff_lum_px", pixels(PerceptualDiff { luminance_only: true, ..settings }), exact);
    check(row, "pdiff_fov27_px", pixels(PerceptualDiff { fov: 27.0, ..settings }), exact);
    check(row, "pdiff_fov85_px", pixels(PerceptualDiff { fov: 85.0, ..settings }), exact);
    assert_eq!(all.value(Metric::PdiffPass), Some(f64::from(u8::from(row["pdiff_verdict"] == "PASS"))));
    let outcome = all.pdiff.as_ref().unwrap();
    assert_eq!(outcome.mask.pixels().iter().filter(|seen| **seen).count(), outcome.pixels);
    check(row, "pdiff_errsum", Some(outcome.error_sum), Within::Relative(1e-5));
}

fn check_flip(row: &Row, reference: &Picture, test: &Picture, all: &Comparison) {
    check(row, "flip_ldr", all.value(Metric::FlipLdr), Within::Absolute(2e-4));
    check(row, "flip_hdr", all.value(Metric::FlipHdr), Within::Absolute(5e-4));
    let options =
        MetricOptions { exposures: Exposures::Fixed { start: -2.0, stop: 2.0, count: 5 }, ..Default::default() };
    let fixed = measure(reference, test, &[Metric::FlipHdr], &options);
    check(row, "flip_hdr_fixed", fixed.value(Metric::FlipHdr), Within::Absolute(5e-4));
}

fn check_errors(row: &Row, all: &Comparison) {
    let relative = Within::Relative(1e-4);
    check(row, "mse", all.value(Metric::Mse), relative);
    check(row, "relmse_1e2", all.value(Metric::RelMse), relative);
    check(row, "mrse_pbrt", all.value(Metric::Mrse), relative);
    check(row, "smape", all.value(Metric::Smape), relative);
    check(row, "ssim", all.value(Metric::Ssim), Within::Absolute(1e-4));
    check(row, "psnr_ldr", all.value(Metric::Psnr), relative);
    if row["mse"] != "nan" {
        // There the other program prints an infinity, which hides that a NaN is there as well.
        check(row, "idiff_exr_rms", all.value(Metric::Rmse), Within::Relative(1e-5));
        check(row, "idiff_exr_mean", all.value(Metric::Mae), Within::Relative(1e-5));
    }
}

#[test]
fn every_pair_has_the_figures_of_the_reference_implementations() {
    let Some(folder) = shared("data/metrics") else { return };
    let rows = rows(&fs::read_to_string(folder.join("expected.csv")).unwrap());
    assert!(rows.len() >= 26);
    for row in &rows {
        let pair = &row["pair"];
        let [reference, test] = ["ref", "test"].map(|side| picture(&folder.join("pairs"), &format!("{pair}_{side}")));
        let all = measure(&reference, &test, &Metric::ALL, &MetricOptions::default());
        let values: Vec<String> = all
            .measured
            .iter()
            .map(|m| format!("{} {}", m.metric, m.value.map_or("-".into(), |v| format!("{v:.6}"))))
            .collect();
        println!("{pair}: {}", values.join(", "));
        check_pdiff(row, &reference, &test, &all);
        check_flip(row, &reference, &test, &all);
        check_errors(row, &all);
    }
}

#[test]
fn counts_and_bias_of_pairs_whose_making_is_known() {
    let Some(folder) = shared("data/metrics/pairs") else { return };
    let metrics = [Metric::Fireflies, Metric::Bias];
    let found = |pair: &str| {
        let [reference, test] = ["ref", "test"].map(|side| picture(&folder, &format!("{pair}_{side}")));
        measure(&reference, &test, &metrics, &MetricOptions::default())
    };
    let fireflies = |pair| found(pair).value(Metric::Fireflies).unwrap();
    assert_eq!(fireflies("cb_fireflies20"), 20.0);
    for pair in ["cb_identical", "black_white", "cb_gain_1p1", "flat_128_144", "cb_nan_inf"] {
        assert_eq!(fireflies(pair), 0.0, "{pair}");
    }
    let broken = found("cb_nan_inf");
    assert_eq!((broken.non_finite.reference, broken.non_finite.test), (0, 2));
    for pair in ["cb_identical", "cb_s4", "cb_s64", "cb_s1024b"] {
        let bias = found(pair).bias.unwrap();
        assert!(bias.p > 0.1 && bias.significant == 0, "{pair} is noise alone: {bias:?}");
    }
    for (pair, sign) in [("cb_gain_1p005", 1.0), ("cb_gain_1p1", 1.0), ("cb_direct_only", -1.0)] {
        let bias = found(pair).bias.unwrap();
        assert!(bias.p < 0.01 && bias.mean * sign > 0.0, "{pair} is biased: {bias:?}");
        assert_eq!(bias.significant, 64, "{pair} is biased everywhere");
    }
}
