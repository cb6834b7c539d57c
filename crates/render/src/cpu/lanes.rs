//! Eight numbers at once, plainly or with AVX2: what is written over [`Lanes`] computes the same bits either way.
//!
//! Functions over it are `#[inline(always)]`, so that within one that has the features they become its instructions.

#![allow(unsafe_code)]

use lightcuts_world::bvh::LANES;
use std::ops::{Add, Div, Mul, Sub};

/// Eight numbers, or masks: lanes of all bits or none.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    fn splat(value: f32) -> Self;
    fn load(values: &[f32; LANES]) -> Self;
    fn store(self) -> [f32; LANES];
    /// The second one where one is NaN.
    fn min(self, other: Self) -> Self;
    /// The second one where one is NaN.
    fn max(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    /// Mask of lanes that are greater than those of another.
    fn greater(self, other: Self) -> Self;
    /// Lanes of a mask from those of `self`, zeros elsewhere.
    fn and(self, mask: Self) -> Self;
    /// Lanes of a mask from `self`, others from `other`.
    fn select(mask: Self, from: Self, other: Self) -> Self;
    /// The mask of some lanes, a bit each.
    fn mask(bits: u32) -> Self;
    /// A mask's lanes, a bit each.
    fn bits(self) -> u32;
}

/// Numbers one by one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plain([f32; LANES]);

const SET: f32 = f32::from_bits(u32::MAX);

impl Plain {
    fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self(self.0.map(f))
    }

    fn zip(self, other: Self, f: impl Fn(f32, f32) -> f32) -> Self {
        Self(std::array::from_fn(|lane| f(self.0[lane], other.0[lane])))
    }
}

/// The four operations of a type of lanes.
macro_rules! operators {
    ($type:ty: $($trait:ident $name:ident |$a:ident, $b:ident| $result:expr;)*) => {$(
        impl $trait for $type {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self, other);
                $result
            }
        }
    )*};
}

operators! { Plain:
    Add add |a, b| a.zip(b, |a, b| a + b);
    Sub sub |a, b| a.zip(b, |a, b| a - b);
    Mul mul |a, b| a.zip(b, |a, b| a * b);
    Div div |a, b| a.zip(b, |a, b| a / b);
}

impl Lanes for Plain {
    fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    fn load(values: &[f32; LANES]) -> Self {
        Self(*values)
    }

    fn store(self) -> [f32; LANES] {
        self.0
    }

    fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }

    fn sqrt(self) -> Self {
        self.map(f32::sqrt)
    }

    fn abs(self) -> Self {
        self.map(f32::abs)
    }

    fn greater(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { SET } else { 0.0 })
    }

    fn and(self, mask: Self) -> Self {
        self.zip(mask, |a, b| f32::from_bits(a.to_bits() & b.to_bits()))
    }

    fn select(mask: Self, from: Self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| if mask.0[lane].to_bits() >> 31 == 1 { from.0[lane] } else { other.0[lane] }))
    }

    fn mask(bits: u32) -> Self {
        Self(std::array::from_fn(|lane| if bits >> lane & 1 == 1 { SET } else { 0.0 }))
    }

    fn bits(self) -> u32 {
        (0..LANES).fold(0, |bits, lane| bits | self.0[lane].to_bits() >> 31 << lane)
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use wide::Wide;

#[cfg(target_arch = "x86_64")]
#[allow(clippy::undocumented_unsafe_blocks)] // said once below for all of them
mod wide {
    use super::{Add, Div, LANES, Lanes, Mul, Sub};
    use std::arch::x86_64::{
        __m256, _CMP_GT_OQ, _mm256_add_ps, _mm256_and_ps, _mm256_and_si256, _mm256_andnot_ps, _mm256_blendv_ps,
        _mm256_castsi256_ps, _mm256_cmp_ps, _mm256_cmpeq_epi32, _mm256_div_ps, _mm256_loadu_ps, _mm256_max_ps,
        _mm256_min_ps, _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_epi32, _mm256_set1_ps, _mm256_setr_epi32,
        _mm256_sqrt_ps, _mm256_storeu_ps, _mm256_sub_ps,
    };

    /// Numbers in a register of AVX2. To be used only on machines that have it.
    #[derive(Debug, Clone, Copy)]
    pub(crate) struct Wide(__m256);

    // SAFETY, of every block here: what uses this type runs only where the machine has AVX2; loads and stores are of arrays
    // of eight numbers, at any address.
    operators! { Wide:
        Add add |a, b| Self(unsafe { _mm256_add_ps(a.0, b.0) });
        Sub sub |a, b| Self(unsafe { _mm256_sub_ps(a.0, b.0) });
        Mul mul |a, b| Self(unsafe { _mm256_mul_ps(a.0, b.0) });
        Div div |a, b| Self(unsafe { _mm256_div_ps(a.0, b.0) });
    }

    impl Lanes for Wide {
        #[inline(always)]
        fn splat(value: f32) -> Self {
            Self(unsafe { _mm256_set1_ps(value) })
        }

        #[inline(always)]
        fn load(values: &[f32; LANES]) -> Self {
            Self(unsafe { _mm256_loadu_ps(values.as_ptr()) })
        }

        #[inline(always)]
        fn store(self) -> [f32; LANES] {
            let mut values = [0.0; LANES];
            unsafe { _mm256_storeu_ps(values.as_mut_ptr(), self.0) };
            values
        }

        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_ps(self.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0) })
        }

        #[inline(always)]
        fn greater(self, other: Self) -> Self {
            Self(unsafe { _mm256_cmp_ps::<_CMP_GT_OQ>(self.0, other.0) })
        }

        #[inline(always)]
        fn and(self, mask: Self) -> Self {
            Self(unsafe { _mm256_and_ps(self.0, mask.0) })
        }

        #[inline(always)]
        fn select(mask: Self, from: Self, other: Self) -> Self {
            Self(unsafe { _mm256_blendv_ps(other.0, from.0, mask.0) })
        }

        #[inline(always)]
        fn mask(bits: u32) -> Self {
            unsafe {
                let places = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
                let chosen = _mm256_and_si256(_mm256_set1_epi32(bits as i32), places);
                Self(_mm256_castsi256_ps(_mm256_cmpeq_epi32(chosen, places)))
            }
        }

        #[inline(always)]
        fn bits(self) -> u32 {
            unsafe { _mm256_movemask_ps(self.0) as u32 }
        }
    }
}
