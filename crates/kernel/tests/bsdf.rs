//! Materials of the physical model: energy, densities, reciprocity.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::bsdf::{
    ALL_LOBES, Bsdf, CONDUCTOR, DIELECTRIC, GLOSSY, MATT, MIRROR, PHONG, PLASTIC, Transport, bsdf_pdf, bsdf_value,
    lobes_of, sample_bsdf,
};
use lightcuts_kernel::energy::energy_tables;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::sampling::sin_cos_turns;
use lightcuts_kernel::texture::arctangent;
use std::f32::consts::PI;

/// Materials of every kind that reflect or pass all light, each with its tables.
fn white() -> Vec<(&'static str, Bsdf, Vec<f32>)> {
    let base = Bsdf { diffuse: Vec3::ONE, specular: Vec3::ONE, ior: 1.5, exponent: 20.0, ..Bsdf::zeroed() };
    // So much absorption that nothing else than reflection is left.
    let metal = Bsdf { kind: CONDUCTOR, specular: Vec3::splat(0.1), absorption: Vec3::splat(1e4), ..base };
    let of = |name, bsdf: Bsdf| (name, bsdf, energy_tables(bsdf.kind, bsdf.alpha, bsdf.ior).to_vec());
    let half = Vec3::splat(0.5);
    vec![
        of("lambert", base),
        of("phong", Bsdf { kind: PHONG, diffuse: half, specular: half, ..base }),
        of("metal", metal),
        of("rough metal", Bsdf { alpha: 0.3, ..metal }),
        of("very rough metal", Bsdf { alpha: 1.0, ..metal }),
        of("glass", Bsdf { kind: DIELECTRIC, ..base }),
        of("rough glass", Bsdf { kind: DIELECTRIC, alpha: 0.2, ..base }),
        of("very rough glass", Bsdf { kind: DIELECTRIC, alpha: 0.8, ..base }),
        of("plastic", Bsdf { kind: PLASTIC, ..base }),
        of("rough plastic", Bsdf { kind: PLASTIC, alpha: 0.3, ..base }),
        of("very rough plastic", Bsdf { kind: PLASTIC, alpha: 0.9, ..base }),
        of("mirror", Bsdf { kind: MIRROR, ..base }),
    ]
}

/// Directions of both sides, from steep to grazing.
fn views(bsdf: &Bsdf) -> Vec<Vec3> {
    let cosines: &[f32] =
        if bsdf.kind == DIELECTRIC { &[1.0, 0.7, 0.3, 0.1, -0.1, -0.5, -0.9] } else { &[1.0, 0.7, 0.3, 0.1, -0.5] };
    cosines.iter().map(|&cos| Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)).collect()
}

fn random3(k: u32, purpose: u32) -> [f32; 3] {
    let [a, b, c, _] = random4(k, purpose, 0, 11);
    [a, b, c]
}

/// Under the same light from everywhere a white material shows just that light: nothing is lost or gained. A Phong lobe
/// loses what would leave below the horizon, so only its steep view is exact.
#[test]
fn white_furnace() {
    let mut complaints = 0;
    for (name, bsdf, tables) in white() {
        for wo in views(&bsdf) {
            let n = 200_000;
            let mut sum = glam::DVec3::ZERO;
            for k in 0..n {
                let sample = sample_bsdf(&bsdf, &tables, ALL_LOBES, wo, random3(k, 0), Transport::Importance);
                sum += sample.map_or(glam::DVec3::ZERO, |s| s.weight.as_dvec3());
            }
            let energy = (sum / f64::from(n)).x;
            println!("{name} at {:.1}: {energy:.4}", wo.z);
            let least = if bsdf.kind == PHONG && wo.z < 0.99 { 0.5 } else { 0.995 };
            complaints += u32::from(!(least..1.005).contains(&energy));
        }
    }
    assert_eq!(complaints, 0);
}

/// Counts of samples in cells of equal solid angle agree with the integral of the density over them (Pearson's chi-square
/// test at a significance of 1e-4 for all materials and views together).
#[test]
fn samples_have_their_density() {
    const RINGS: usize = 16;
    const SECTORS: usize = 24;
    for (name, bsdf, tables) in white() {
        if lobes_of(&bsdf) & (MATT | GLOSSY) == 0 {
            continue;
        }
        for wo in views(&bsdf) {
            let cell = |wi: Vec3| {
                let ring = (((wi.z * 0.5 + 0.5) * RINGS as f32) as usize).min(RINGS - 1);
                let turn = arctangent(wi.y, wi.x) / (2.0 * PI) + 0.5;
                ring * SECTORS + ((turn * SECTORS as f32) as usize).min(SECTORS - 1)
            };
            let n = 400_000;
            let mut counts = vec![0.0_f64; RINGS * SECTORS];
            for k in 0..n {
                if let Some(s) = sample_bsdf(&bsdf, &tables, ALL_LOBES, wo, random3(k, 1), Transport::Radiance)
                    && s.pdf > 0.0
                {
                    counts[cell(s.wi)] += 1.0;
                    let again = bsdf_pdf(&bsdf, &tables, ALL_LOBES, wo, s.wi);
                    assert!((again / s.pdf - 1.0).abs() < 1e-3, "{name}: {again} {}", s.pdf);
                }
            }
            // Integrals by midpoints, many in each cell.
            let mut expected = vec![0.0_f64; RINGS * SECTORS];
            let (rows, columns) = (RINGS * 250, SECTORS * 12);
            for row in 0..rows {
                for column in 0..columns {
                    let z = (row as f32 + 0.5) / rows as f32 * 2.0 - 1.0;
                    let (sin, cos) = sin_cos_turns((column as f32 + 0.5) / columns as f32);
                    let r = (1.0 - z * z).sqrt();
                    let wi = Vec3::new(r * cos, r * sin, z);
                    expected[cell(wi)] += f64::from(bsdf_pdf(&bsdf, &tables, ALL_LOBES, wo, wi))
                        * (4.0 * std::f64::consts::PI / (rows * columns) as f64)
                        * f64::from(n);
                }
            }
            let (mut statistic, mut freedom, mut few, mut few_expected) = (0.0, 0.0, 0.0, 0.0);
            for (&count, &wanted) in counts.iter().zip(&expected) {
                if wanted < 50.0 {
                    (few, few_expected) = (few + count, few_expected + wanted);
                } else {
                    // The quadrature has an error of its own, which sharp lobes show.
                    let slack = 0.01 * wanted;
                    statistic += ((count - wanted).abs() - slack).max(0.0).powi(2) / wanted;
                    freedom += 1.0;
                }
            }
            let slack = 6.0 * few_expected.max(100.0).sqrt() + 0.02 * few_expected;
            assert!((few - few_expected).abs() < slack, "{name} at {}: {few} {few_expected}", wo.z);
            // Wilson-Hilferty: a normal deviate of the chi-square variable.
            let deviate =
                ((statistic / freedom).cbrt() - (1.0 - 2.0 / (9.0 * freedom))) / (2.0_f64 / (9.0 * freedom)).sqrt();
            assert!(deviate < 5.0, "{name} at {}: chi-square {statistic:.0} of {freedom}", wo.z);
        }
    }
}

/// f(wo, wi) = f(wi, wo), in radiance times the square of the refractive index where light is refracted.
#[test]
fn values_are_reciprocal() {
    for (name, bsdf, tables) in white() {
        for k in 0..4000 {
            let direction = |purpose| {
                let [a, b, c] = random3(k, purpose);
                (Vec3::new(a, b, c) - 0.5).normalize_or_zero()
            };
            let (wo, wi) = (direction(2), direction(3));
            let of = |wo, wi, transport| bsdf_value(&bsdf, &tables, ALL_LOBES, wo, wi, transport).x;
            let (there, back) = (of(wo, wi, Transport::Radiance), of(wi, wo, Transport::Radiance));
            let eta_sq = if wo.z * wi.z > 0.0 || bsdf.kind != DIELECTRIC {
                1.0
            } else if wo.z > 0.0 {
                1.0 / (bsdf.ior * bsdf.ior)
            } else {
                bsdf.ior * bsdf.ior
            };
            assert!(there >= 0.0 && there.is_finite());
            let difference = (there - back * eta_sq).abs();
            assert!(difference < 2e-3 * there.max(1e-3), "{name}: {there} {back} {wo} {wi}");
            let importance = of(wo, wi, Transport::Importance);
            assert!((importance * eta_sq - there).abs() < 1e-4 * there.max(1.0), "{name}");
        }
    }
}

/// Lobes add up to the whole, and a lobe alone is sampled by itself.
#[test]
fn lobes_add_up() {
    for (name, bsdf, tables) in white() {
        for k in 0..500 {
            let [a, b, c] = random3(k, 4);
            let (wo, wi) = (Vec3::new(a - 0.5, b, 0.6).normalize(), Vec3::new(c - 0.5, a, 0.4).normalize());
            let of = |lobes| bsdf_value(&bsdf, &tables, lobes, wo, wi, Transport::Radiance);
            assert!((of(ALL_LOBES) - of(MATT) - of(GLOSSY)).length() <= 1e-5 * of(ALL_LOBES).length(), "{name}");
            for lobe in [MATT, GLOSSY] {
                if let Some(sample) = sample_bsdf(&bsdf, &tables, lobe, wo, [a, b, c], Transport::Radiance) {
                    assert_eq!(sample.lobe, lobe, "{name}");
                    let value = bsdf_value(&bsdf, &tables, lobe, wo, sample.wi, Transport::Radiance);
                    let again = value * (sample.wi.z.abs() / sample.pdf);
                    assert!((again - sample.weight).length() < 1e-4 * again.length().max(1e-3), "{name}");
                }
            }
        }
    }
}
