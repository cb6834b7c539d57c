//! Pictures: development, tone mapping, bloom, EXR and PNG written atomically.
//!
//! A picture is a [`Plane`] of pixels, row 0 at the TOP; [`Image`] is a plane of linear RGB. A finished render with its
//! AOVs and its job is a set of [`Layers`], stored as one EXR file ([`write_exr`], [`read_exr`]); a picture for eyes is
//! a PNG ([`write_png`]) after [`bloom`] and [`ToneMapping`]. Every file is written atomically ([`write_atomic`]).
//!
//! How far two pictures differ is what [`metrics`] measure.
//!
//! Everything here is deterministic: same input, same bits, on any number of threads.

mod atomic;
mod bloom;
mod color_map;
mod error;
mod exposure;
mod exr_color;
mod exr_decode;
mod exr_file;
mod exr_header;
mod exr_layout;
mod exr_picture;
mod frame;
mod hdr;
mod heat_map;
mod inventory;
mod layers;
mod light;
mod limits;
pub mod metrics;
mod pfm;
mod picture;
mod plane;
mod png;
mod primaries;
mod read_picture;
mod tone_mapping;

pub use atomic::write_atomic;
pub use bloom::bloom;
pub use color_map::ColorMap;
pub use error::ImageError;
pub use exposure::Exposure;
pub use exr_file::{read_exr, read_exr_attributes, write_exr};
pub use frame::{Frame, Window};
pub use heat_map::{HeatMap, heat_map};
pub use inventory::{Inventory, PictureLayer, picture_inventory};
pub use layers::{LayerData, Layers};
pub use light::{Light, LightOptions, PictureFormat, decode_light, read_light};
pub use limits::{MAX_DECODED_BYTES, MAX_PIXELS, PictureLimits};
pub use metrics::difference::{fraction_within, max_abs_difference};
pub use picture::Picture;
pub use plane::{Image, Plane, luminance};
pub use png::{Transfer, read_png, read_png_text, write_png, write_png_with_text};
pub use read_picture::{Channels, PictureFile, read_picture};
pub use tone_mapping::{GlobalToneMapping, LocalToneMapping, ToneMapping};
