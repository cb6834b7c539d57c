//! How numbers, points and directions are spread. A case's number chooses: most are ordinary, some are far apart in size,
//! some coincide, some are corners.

use crate::functions::case::Case;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::normalize_or_zero;
use std::f32::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Numbers that functions treat apart, or that are just beside such.
const CORNERS: [f32; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    -0.5,
    0.25,
    2.0,
    -2.0,
    3.0,
    0.1,
    -0.1,
    1e-6,
    -1e-6,
    1e6,
    -1e6,
    0.999_999_94,
    1.000_000_1,
    0.001,
    1e-3,
];

/// Whole numbers that functions treat apart.
const WHOLE_CORNERS: [u32; 10] = [0, 1, 2, 7, 8, 0x7fff_ffff, 0x8000_0000, 0xffff, 0xffff_fffe, u32::MAX];

/// A shift of a number by relative rounding errors.
const NUDGE: f32 = 1e-6;

impl Case<'_> {
    /// A number that is no argument.
    fn spread(&self) -> f32 {
        let sign = if self.random() < 0.5 { -1.0 } else { 1.0 };
        match self.number % 8 {
            0..=2 => 2.0 * self.random() - 1.0,
            3 => -self.random(),
            4 => sign * 10.0_f32.powf(12.0 * self.random() - 6.0),
            5 => (16.0 * self.random()).floor() * 0.5 - 4.0,
            6 => CORNERS[self.choice(CORNERS.len())],
            _ => [self.random(), sign * 100.0 * self.random(), CORNERS[self.choice(CORNERS.len())]][self.choice(3)],
        }
    }

    /// Any number from 1e-6 to 1e6 with either sign, zeros and corners.
    pub(crate) fn float(&self) -> f32 {
        self.take(|| self.spread())
    }

    /// A number of at least 0.
    pub(crate) fn positive(&self) -> f32 {
        self.take(|| self.spread().abs())
    }

    /// A number in 0..1, both included.
    pub(crate) fn fraction(&self) -> f32 {
        self.take(|| self.raw_fraction())
    }

    pub(crate) fn raw_fraction(&self) -> f32 {
        match self.number % 8 {
            5 => (self.random() * 5.0).floor() * 0.25,
            6 => [0.0, 1.0, 0.5, 1.0 / 16_777_216.0, 0.999_999_94][self.choice(5)],
            _ => self.random(),
        }
    }

    /// A number between two.
    pub(crate) fn between(&self, least: f32, greatest: f32) -> f32 {
        self.take(|| least + (greatest - least) * self.raw_fraction())
    }

    /// A float with any bits that make a normal number above 0.
    pub(crate) fn any_normal(&self) -> f32 {
        let corners = [f32::MIN_POSITIVE, f32::MAX, 1.0, FRAC_1_SQRT_2, SQRT_2.next_down()];
        let any = || f32::from_bits(0x0080_0000 + (self.random() * 2_130_706_432.0) as u32);
        self.take(|| if self.number % 8 == 6 { corners[self.choice(5)] } else { any() })
    }

    /// Any word.
    pub(crate) fn word(&self) -> u32 {
        let any = || (self.random() * 65_536.0) as u32 | ((self.random() * 65_536.0) as u32) << 16;
        self.take(|| if self.number % 8 == 6 { WHOLE_CORNERS[self.choice(10)] } else { any() })
    }

    /// A whole number below `count`.
    pub(crate) fn below(&self, count: u32) -> u32 {
        self.take(|| self.choice(count as usize) as u32)
    }

    pub(crate) fn flag(&self) -> bool {
        self.take(|| self.random() < 0.5)
    }

    pub(crate) fn rules(&self) -> Rules {
        self.take(|| [Rules::Original, Rules::Repaired][self.choice(2)])
    }

    /// A point, or a vector of any length.
    pub(crate) fn point(&self) -> Vec3 {
        self.take(|| self.raw_point())
    }

    pub(crate) fn raw_point(&self) -> Vec3 {
        let last = self.last[1].get();
        let point = match (self.number % 8, self.choice(16)) {
            (7, 0..4) => last,
            (_, 0) => last * (1.0 + NUDGE * (self.random() - 0.5)),
            _ => Vec3::new(self.spread(), self.spread(), self.spread()),
        };
        self.last[1].set(point);
        point
    }

    /// A unit vector.
    pub(crate) fn direction(&self) -> Vec3 {
        self.take(|| self.raw_direction())
    }

    /// Any direction, an axis, one in a plane of axes, or one that faces, is perpendicular to or almost is the last one.
    pub(crate) fn raw_direction(&self) -> Vec3 {
        const AXES: [Vec3; 6] = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
        let any = || Vec3::new(self.random(), self.random(), self.random()) - 0.5;
        let last = self.last[0].get();
        let direction = match (self.number % 8, self.choice(16)) {
            (5, 0..8) | (6, 0..12) => AXES[self.choice(6)],
            (5, _) => Vec3::new(0.6, -0.8, 0.0),
            (6, _) => Vec3::new(self.random() - 0.5, 0.0, -0.0),
            (_, 0) => last,
            (_, 1) => -last,
            (_, 2) => last.cross(any()),
            (_, 3) => last.cross(any()) + last * NUDGE,
            _ => any(),
        };
        let unit = normalize_or_zero(direction);
        self.last[0].set(unit);
        unit
    }

    /// Channels of at least 0, black and grey included.
    pub(crate) fn raw_color(&self) -> Vec3 {
        match self.choice(8) {
            0 => Vec3::ZERO,
            1 => Vec3::splat(self.random()),
            2 => Vec3::new(self.random(), 0.0, 10.0 * self.random()),
            _ => Vec3::new(self.random(), self.random(), self.random()),
        }
    }

    pub(crate) fn color(&self) -> Vec3 {
        self.take(|| self.raw_color())
    }
}
