//! Tests of Perceptual Image Diff as a whole.

use super::vision::threshold_versus_intensity;
use super::*;

fn grey(code: u8) -> [f32; 3] {
    [f32::from(code) / 255.0; 3]
}

fn luminance_of(code: u8) -> f32 {
    (f32::from(code) / 255.0).powf(2.2) * 100.0
}

/// A busy picture of 8-bit codes.
fn texture(width: usize, height: usize) -> Image {
    Image::from_fn(width, height, |x, y| {
        std::array::from_fn(|c| ((x * 7919 + y * 104_729 + c * 1_299_709) % 241) as f32 / 255.0)
    })
}

fn pixels(settings: &PerceptualDiff, a: &Image, b: &Image) -> usize {
    settings.compare(a, b).unwrap().pixels
}

#[test]
fn flat_fields_differ_within_one_to_ten_thresholds() {
    let settings = PerceptualDiff::default();
    for code in [20, 60, 128, 200] {
        let flat = Image::filled(32, 32, grey(code));
        let seen: Vec<usize> =
            (0..=255).map(|other| pixels(&settings, &flat, &Image::filled(32, 32, grey(other)))).collect();
        for (other, seen) in (0..=255).zip(seen) {
            let difference = (luminance_of(code) - luminance_of(other)).abs();
            let threshold = threshold_versus_intensity(f32::midpoint(luminance_of(code), luminance_of(other)));
            if difference < 0.999 * threshold {
                assert_eq!(seen, 0, "{code} {other}");
            } else if difference > 10.01 * threshold {
                assert_eq!(seen, 1024, "{code} {other}");
            }
        }
    }
}

#[test]
fn the_verdict_follows_the_threshold() {
    let (a, b) = (Image::filled(10, 10, grey(10)), Image::filled(10, 10, grey(250)));
    let pass = |threshold, other| PerceptualDiff { threshold, ..Default::default() }.compare(&a, other).unwrap().pass;
    assert_eq!((pass(100, &b), pass(101, &b)), (false, true));
    assert!(pass(0, &a), "equal pictures pass whatever the threshold");
}

#[test]
fn texture_hides_what_is_seen_on_a_flat_field() {
    let settings = PerceptualDiff { luminance_only: true, ..Default::default() };
    let count = |base: &Image| {
        let brighter = base.map(|pixel| pixel.map(|value| ((value * 255.0).round() + 14.0) / 255.0));
        pixels(&settings, base, &brighter)
    };
    assert_eq!(count(&Image::filled(64, 64, grey(120))), 4096);
    assert!(count(&texture(64, 64)) < 400);
}

#[test]
fn colours_of_one_luminance_differ_in_colour_only() {
    let decoder = color::Decoder::new(2.2, false);
    let (red, target) = ([0.8, 0.4, 0.4], decoder.luminance([0.8, 0.4, 0.4]));
    let mut green = 0.4;
    while decoder.luminance([0.4, green, 0.4]) < target {
        green += 1e-4;
    }
    let (a, b) = (Image::filled(16, 16, red), Image::filled(16, 16, [0.4, green, 0.4]));
    let settings = PerceptualDiff { swap_red_blue: false, ..Default::default() };
    assert_eq!(pixels(&settings, &a, &b), 256);
    assert_eq!(pixels(&PerceptualDiff { luminance_only: true, ..settings }, &a, &b), 0);
    assert_eq!(pixels(&PerceptualDiff { color_factor: 0.0, ..settings }, &a, &b), 0);
    let dim = PerceptualDiff { luminance: 10.0, ..settings };
    assert_eq!(pixels(&dim, &a, &b), 0, "below 10 cd/m2 colour is not seen");
}

#[test]
fn swapping_is_reading_blue_for_red() {
    let (a, b) = (texture(40, 30), texture(41, 30));
    let b = Image::from_fn(40, 30, |x, y| b.get(x + 1, y));
    let swapped = |image: &Image| image.map(|[r, g, b]| [b, g, r]);
    let plain = PerceptualDiff { swap_red_blue: false, ..Default::default() };
    let found = PerceptualDiff::default().compare(&a, &b).unwrap();
    assert_eq!(plain.compare(&swapped(&a), &swapped(&b)).unwrap(), found);
    assert_ne!(plain.compare(&a, &b).unwrap().error_sum, found.error_sum);
}

#[test]
fn the_order_of_the_pictures_does_not_matter() {
    let (a, b) = (texture(33, 21), texture(33, 21).map(|pixel| pixel.map(|value| value * 0.7)));
    let settings = PerceptualDiff::default();
    assert_eq!(settings.compare(&a, &b).unwrap(), settings.compare(&b, &a).unwrap());
}

#[test]
fn halving_averages_what_is_finer() {
    let checker = Image::from_fn(21, 20, |x, y| [if (x + y) % 2 == 0 { 0.25 } else { 0.75 }; 3]);
    let flat = Image::filled(21, 20, [0.5; 3]);
    let halvings = |downsample| PerceptualDiff { downsample, ..Default::default() }.compare(&flat, &checker).unwrap();
    assert!(halvings(0).pixels > 200);
    let once = halvings(1);
    assert_eq!((once.pixels, once.error_sum), (0, 0.0));
    assert_eq!((once.mask.width(), once.mask.height()), (10, 10));
    let most = halvings(u32::MAX);
    assert_eq!((most.mask.width(), most.mask.height()), (1, 1));
}

#[test]
fn the_adaptation_level_follows_the_field_of_view() {
    let level = |fov| PerceptualDiff { fov, ..Default::default() }.adaptation_level();
    assert_eq!([0.1, 1.1, 27.0, 45.0, 85.0, 179.9].map(level), [0, 1, 5, 6, 7, 7]);
}

#[test]
fn settings_outside_their_range_are_refused() {
    let settings = PerceptualDiff::default();
    let image = Image::new(2, 2);
    for wrong in [
        PerceptualDiff { fov: 0.0, ..settings },
        PerceptualDiff { fov: 180.0, ..settings },
        PerceptualDiff { fov: f32::NAN, ..settings },
        PerceptualDiff { gamma: -1.0, ..settings },
        PerceptualDiff { luminance: f32::INFINITY, ..settings },
        PerceptualDiff { color_factor: -0.1, ..settings },
    ] {
        let error = wrong.compare(&image, &image).unwrap_err();
        assert!(matches!(error, ImageError::Parameter { .. }), "{error}");
    }
}

#[test]
fn extreme_settings_and_sizes_give_an_answer() {
    for (width, height) in [(0, 0), (1, 1), (3, 1), (1, 9), (2, 2)] {
        for fov in [1e-30, 1.0, 179.999] {
            for luminance in [1e-20, 100.0, 1e20] {
                let settings = PerceptualDiff { fov, luminance, ..Default::default() };
                let (black, white) = (Image::new(width, height), Image::filled(width, height, [1.0; 3]));
                let found = settings.compare(&black, &white).unwrap();
                assert!(!found.error_sum.is_nan());
                assert!(luminance < 1.0 || found.pixels == width * height, "{width} {height} {fov} {luminance}");
            }
        }
    }
}
