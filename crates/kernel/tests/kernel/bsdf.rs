//! Materials of the physical model: energy, densities, reciprocity.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::bsdf::{
    ALL_LOBES, Bsdf, CONDUCTOR, DIELECTRIC, DIFFUSE, GLOSSY, MIRROR, PHONG, PLASTIC, SPECULAR, Transport, bsdf_pdf,
    bsdf_value, lobes_of, sample_bsdf,
};
use lightcuts_kernel::energy::energy_tables;
use lightcuts_kernel::fresnel::fresnel_dielectric;
use lightcuts_kernel::rng::random4;
use lightcuts_testkit::chi_square::{ChiSquareTests, DirectionCells};

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

/// Directions are drawn with their density; where single ones are drawn as well, with what it leaves of their chance.
#[test]
fn samples_have_their_density() {
    let mut tests = ChiSquareTests::default();
    for (name, bsdf, tables) in white() {
        for wo in views(&bsdf) {
            let cells = DirectionCells::new(Vec3::Z, -1.0, 16, 24);
            let (n, mut single, mut none) = (400_000, 0.0, 0.0);
            let directions = (0..n).filter_map(|k| {
                let sample = sample_bsdf(&bsdf, &tables, ALL_LOBES, wo, random3(k, 1), Transport::Radiance);
                let Some(sample) = sample else {
                    none += 1.0;
                    return None;
                };
                if sample.lobe == SPECULAR {
                    single += 1.0;
                    return None;
                }
                let again = bsdf_pdf(&bsdf, &tables, ALL_LOBES, wo, sample.wi);
                assert!(sample.pdf > 0.0 && (again / sample.pdf - 1.0).abs() < 1e-3, "{name}: {again} {}", sample.pdf);
                Some(sample.wi)
            });
            let counts = cells.count(directions);
            let name = format!("{name} at {}", wo.z);
            if lobes_of(&bsdf) & (DIFFUSE | GLOSSY) == 0 {
                assert_eq!(single, f64::from(n), "{name}");
                continue;
            }
            let integrals = cells.integrals([250, 12], |wi| bsdf_pdf(&bsdf, &tables, ALL_LOBES, wo, wi));
            let expected: Vec<f64> = integrals.iter().map(|of| of * f64::from(n)).collect();
            // The quadrature has an error of its own, which sharp lobes show.
            tests.compare(&name, &counts, &expected, 0.01);
            if single > 0.0 {
                let rest = f64::from(n) - expected.iter().sum::<f64>() - none;
                tests.compare(
                    format!("{name}, lobes"),
                    &[single, counts.iter().sum()],
                    &[rest, f64::from(n) - rest],
                    0.0,
                );
            }
        }
    }
    tests.check();
}

/// Smooth glass reflects with the chance of Fresnel's equations and refracts with the rest.
#[test]
fn smooth_glass_chooses_by_fresnel() {
    let glass = Bsdf { kind: DIELECTRIC, specular: Vec3::ONE, ior: 1.5, ..Bsdf::zeroed() };
    let mut tests = ChiSquareTests::default();
    for wo in views(&glass) {
        let eta = if wo.z < 0.0 { 1.0 / glass.ior } else { glass.ior };
        let n = 100_000;
        let mut counts = [0.0; 2];
        for k in 0..n {
            let sample = sample_bsdf(&glass, &[], ALL_LOBES, wo, random3(k, 5), Transport::Radiance);
            let sample = sample.expect("smooth glass sends all light on");
            counts[usize::from(sample.wi.z * wo.z < 0.0)] += 1.0;
        }
        let reflected = f64::from(fresnel_dielectric(wo.z.abs(), eta));
        let expected = [reflected, 1.0 - reflected].map(|chance| chance * f64::from(n));
        if reflected == 1.0 {
            assert_eq!(counts, expected);
        } else {
            tests.compare(format!("glass at {}", wo.z), &counts, &expected, 0.0);
        }
    }
    tests.check();
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
            assert!((of(ALL_LOBES) - of(DIFFUSE) - of(GLOSSY)).length() <= 1e-5 * of(ALL_LOBES).length(), "{name}");
            for lobe in [DIFFUSE, GLOSSY] {
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
