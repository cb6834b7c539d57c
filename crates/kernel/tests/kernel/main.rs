//! The kernel's tests that need more than one module.

mod bsdf;
mod emitters;
mod environment;
mod samplers;
