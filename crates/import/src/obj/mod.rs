//! Wavefront OBJ models and their MTL materials.
//!
//! Written here and not taken from the `tobj` crate, because its errors name neither line nor column and it re-orders
//! faces by material; the renderer's results depend on the order of triangles.

mod face;
mod ignored;
mod libraries;
mod library_names;
mod map;
mod material;
mod parse;
mod statement;

pub(crate) use libraries::Libraries;
pub(crate) use map::MapPlacement;
pub(crate) use material::{Library, LibraryMaterial, Writer};
pub(crate) use parse::parse;
