//! The CPU device: traversal and gathering, with SIMD where the machine has it.
//!
//! The plain functions of `lightcuts-kernel` say what is meant; the AVX2 versions replace them bit for bit and are
//! tested against them.

/// A value whose code is made for each form of triangles: what stands behind the arrow, where the constant of that name
/// says whether triangles are held by their corners.
#[cfg(target_arch = "x86_64")]
macro_rules! by_form {
    ($form:expr, $corners:ident => $value:expr) => {
        match $form {
            lightcuts_world::bvh::TriangleForm::Edges => {
                const $corners: bool = false;
                $value
            }
            lightcuts_world::bvh::TriangleForm::Corners => {
                const $corners: bool = true;
                $value
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod avx2_bundle;
#[cfg(target_arch = "x86_64")]
mod avx2_fan;
#[cfg(target_arch = "x86_64")]
mod avx2_gather;
#[cfg(target_arch = "x86_64")]
mod avx2_packet;
#[cfg(target_arch = "x86_64")]
mod avx2_shadows;
#[cfg(target_arch = "x86_64")]
mod avx2_together;
#[cfg(target_arch = "x86_64")]
mod avx2_trace;
#[cfg(target_arch = "x86_64")]
mod avx2_watertight;
mod device;
mod enclosure;
mod gather;
mod half_spaces;
mod lanes;
#[cfg(target_arch = "x86_64")]
mod stack;
mod tracer;

pub use device::{CpuDevice, processor_name};
#[cfg(test)]
pub(crate) use gather::tests::chosen;
pub(crate) use gather::{
    Blocks, Candidates, Gathered, Receiver, evaluate, evaluate_together, select, select_exhaustively,
};
pub(crate) use half_spaces::HalfSpaces;
#[cfg(target_arch = "x86_64")]
pub(crate) use lanes::Wide;
pub(crate) use lanes::{Lanes, Plain};
pub(crate) use tracer::RayLanes;
pub use tracer::Tracer;
#[cfg(test)]
pub(crate) use tracer::tests::brute_force;

/// Whether SIMD instructions are used. Never changes the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Simd {
    /// Where the machine has them.
    #[default]
    Auto,
    /// Never: the plain functions only.
    Off,
}

impl Simd {
    /// Whether AVX2 is to be used on this machine, with what processors have had beside it from the first on.
    pub(crate) fn has_avx2(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return self == Self::Auto
            && std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma")
            && std::arch::is_x86_feature_detected!("bmi1")
            && std::arch::is_x86_feature_detected!("popcnt");
        #[cfg(not(target_arch = "x86_64"))]
        false
    }
}
