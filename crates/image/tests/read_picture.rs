//! Pictures to be measured: one picture in every format is one picture, and damaged files of every format are errors.

#![allow(clippy::unwrap_used)] // the helpers of tests are tests too, but clippy sees only `#[test]`

use std::fs;
use std::path::PathBuf;

use exr::prelude::{self as exr_crate, WritableImage as _};
use image::codecs::hdr::HdrEncoder;
use image::{DynamicImage, GrayAlphaImage, GrayImage, ImageBuffer, ImageFormat, Rgb, Rgba, RgbaImage};
use lightcuts_image::{
    Channels, Image, ImageError, LayerData, Layers, Picture, PictureFile, PictureFormat, Plane, Transfer,
    max_abs_difference, read_picture, write_exr, write_png,
};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, bytes).unwrap();
        path
    }

    fn write_exr(&self, channels: &[(&str, exr_crate::FlatSamples)]) -> PathBuf {
        use exr_crate::{AnyChannel, AnyChannels, Encoding, Layer, LayerAttributes};
        let channels = channels.iter().map(|(name, samples)| AnyChannel::new(*name, samples.clone())).collect();
        let layer =
            Layer::new((2, 1), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
        let path = self.0.path().join("foreign.exr");
        exr_crate::Image::from_layer(layer).write().to_file(&path).unwrap();
        path
    }

    fn write_png(&self, picture: impl Into<DynamicImage>) -> PathBuf {
        let path = self.0.path().join("a.png");
        picture.into().save_with_format(&path, ImageFormat::Png).unwrap();
        path
    }
}

/// A ramp whose rows and columns all differ, up to twice white.
fn ramp() -> Image {
    Image::from_fn(37, 23, |x, y| [x as f32 / 18.0, y as f32 / 23.0, (x + 37 * y) as f32 / 851.0])
}

fn pfm(image: &Image, little: bool) -> Vec<u8> {
    let scale = if little { "-1.0" } else { "1.0" };
    let mut bytes = format!("PF\n{} {}\n{scale}\n", image.width(), image.height()).into_bytes();
    for y in (0..image.height()).rev() {
        let samples = image.row(y).iter().flatten();
        bytes.extend(samples.flat_map(|value| if little { value.to_le_bytes() } else { value.to_be_bytes() }));
    }
    bytes
}

fn read(path: &PathBuf) -> (Picture, Channels) {
    let file = read_picture(path, Transfer::Srgb, None).unwrap();
    (file.picture, file.channels)
}

#[test]
fn precise_formats_give_the_same_light() {
    let (folder, light) = (Folder::new(), ramp());
    let exr = folder.0.path().join("a.exr");
    write_exr(&exr, &Layers::new(light.clone())).unwrap();
    let expected = (Picture::from_linear(light.clone(), Transfer::Srgb), Channels::Rgb);
    assert_eq!(read(&exr), expected);
    assert_eq!(read(&folder.write("little.pfm", pfm(&light, true))), expected);
    // The name does not matter.
    assert_eq!(read(&folder.write("big.png", pfm(&light, false))), expected);
}

#[test]
fn a_png_shows_what_an_exr_of_the_same_light_shows() {
    let (folder, light) = (Folder::new(), ramp());
    for transfer in [Transfer::Srgb, Transfer::Linear] {
        let shown = Picture::from_linear(light.clone(), transfer);
        let png = folder.0.path().join("8.png");
        write_png(&png, &light, transfer).unwrap();
        let file = read_picture(&png, transfer, None).unwrap();
        assert_eq!((file.picture.display(), file.channels), (shown.display(), Channels::Rgb));
        assert!(!file.holds_light && file.format == PictureFormat::Png);

        let codes = |value: f32| (65_535.0 * transfer.encode(value.min(1.0))).round() as u16;
        let pixels: Vec<u16> = light.pixels().iter().flatten().map(|value| codes(*value)).collect();
        let precise: ImageBuffer<Rgb<u16>, _> = ImageBuffer::from_raw(37, 23, pixels).unwrap();
        let PictureFile { picture, holds_light, .. } = read_picture(folder.write_png(precise), transfer, None).unwrap();
        assert!(holds_light);
        assert_eq!(picture.display(), shown.display(), "16 bits are shown as 8");
        let clamped = light.map(|pixel| pixel.map(|value| value.min(1.0)));
        let difference = max_abs_difference(picture.linear(), &clamped).unwrap();
        assert!(difference < 1.0 / 50_000.0, "{difference}: more precise than 8 bits");
    }
}

#[test]
fn a_radiance_picture_has_its_light() {
    let (folder, light) = (Folder::new(), ramp());
    let pixels: Vec<Rgb<f32>> = light.pixels().iter().map(|pixel| Rgb(*pixel)).collect();
    let mut bytes = Vec::new();
    HdrEncoder::new(&mut bytes).encode(&pixels, 37, 23).unwrap();
    let (picture, channels) = read(&folder.write("a.hdr", &bytes));
    assert_eq!(channels, Channels::Rgb);
    for (found, expected) in picture.linear().pixels().iter().zip(light.pixels()) {
        let step = expected.iter().fold(0.0, |greatest: f32, value| greatest.max(*value)) / 128.0;
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= step), "{found:?}, {expected:?}");
    }
}

#[test]
fn channels_are_those_of_the_file() {
    let folder = Folder::new();
    let of = |picture: DynamicImage| read(&folder.write_png(picture));
    let grey = Image::filled(3, 2, [51.0 / 255.0; 3]);
    let (picture, channels) = of(GrayImage::from_pixel(3, 2, [51].into()).into());
    assert_eq!((picture.display(), channels), (&grey, Channels::Grey));
    let (picture, channels) = of(GrayAlphaImage::from_pixel(3, 2, [51, 0].into()).into());
    assert_eq!((picture.display(), channels), (&grey, Channels::GreyAlpha), "colours as they are stored");
    let (picture, channels) = of(RgbaImage::from_pixel(3, 2, [51, 51, 51, 9].into()).into());
    assert_eq!((picture.display(), channels), (&grey, Channels::Rgba));
    let (_, channels) = of(ImageBuffer::<Rgba<u16>, _>::from_pixel(3, 2, [1, 2, 3, 4].into()).into());
    assert_eq!((channels, channels.to_string().as_str()), (Channels::Rgba, "R, G, B, A"));
    assert_eq!(channels.without_alpha(), Channels::Rgb);
}

/// Palettes are what other programs write, with and without transparency; made by hand from the PNG specification.
#[test]
fn a_palette_is_colour() {
    let folder = Folder::new();
    // 2 x 1 pixels of 1 bit: the colours 255 0 0 and 0 0 255.
    let palette: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x02\0\0\0\x01\x01\x03\0\0\0";
    let crc = |body: &[u8]| {
        let step = |crc: u32, _| if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
        !body.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
    };
    let chunk = |kind: &[u8], data: &[u8]| {
        let body = [kind, data].concat();
        [&(data.len() as u32).to_be_bytes()[..], &body, &crc(&body).to_be_bytes()].concat()
    };
    let colours = chunk(b"PLTE", &[255, 0, 0, 0, 0, 255]);
    // zlib without compression: filter 0, then the pixels 0 and 1 in the highest bits; Adler-32 at the end.
    let pixels = chunk(b"IDAT", &[0x78, 1, 1, 2, 0, 0xfd, 0xff, 0, 0x40, 0, 0x42, 0, 0x41]);
    let header = [palette, &crc(&palette[12..]).to_be_bytes()].concat();
    let opaque = [&header[..], &colours, &pixels, &chunk(b"IEND", b"")].concat();
    let (picture, channels) = read(&folder.write("p.png", opaque));
    assert_eq!((picture.display().pixels(), channels), (&[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]][..], Channels::Rgb));
    let see_through = [&header[..], &colours, &chunk(b"tRNS", &[0]), &pixels, &chunk(b"IEND", b"")].concat();
    assert_eq!(read(&folder.write("p.png", see_through)).1, Channels::Rgba);
}

#[test]
fn foreign_exr_files_are_read() {
    use exr_crate::FlatSamples::{F16, F32, U32};
    let folder = Folder::new();
    let half = |a: f32, b: f32| F16([a, b].map(exr_crate::f16::from_f32).to_vec());
    let colours = [("R", half(0.5, 8.0)), ("G", F32(vec![0.25, f32::NAN])), ("B", U32(vec![3, 16_777_216]))];
    let (picture, channels) = read(&folder.write_exr(&colours));
    assert_eq!(channels, Channels::Rgb);
    assert_eq!(picture.linear().get(0, 0), [0.5, 0.25, 3.0]);
    let last = picture.linear().get(1, 0);
    assert!(last[0] == 8.0 && last[1].is_nan() && last[2] == 16_777_216.0, "{last:?}");
    assert_eq!(picture.display().get(1, 0)[1], 0.0, "what is shown is finite");

    let (picture, channels) = read(&folder.write_exr(&[("Y", half(0.5, 0.75)), ("A", half(1.0, 1.0))]));
    assert_eq!((picture.linear().pixels(), channels), (&[[0.5; 3], [0.75; 3]][..], Channels::GreyAlpha));

    let path = folder.write_exr(&[("depth.Z", half(1.0, 2.0)), ("R", half(1.0, 2.0))]);
    let error = read_picture(&path, Transfer::Srgb, None).unwrap_err().to_string();
    assert!(error.contains("neither the channels R, G and B nor Y") && error.contains("R, depth.Z"), "{error}");
}

#[test]
fn layers_are_read_by_name() {
    let folder = Folder::new();
    let mut layers = Layers::new(Image::filled(2, 2, [0.1; 3]));
    layers.push("albedo", LayerData::Color(Image::filled(2, 2, [0.2, 0.3, 0.4]))).unwrap();
    layers.push("normal", LayerData::Vector(Image::filled(2, 2, [0.0, -1.0, 0.5]))).unwrap();
    layers.push("depth", LayerData::Depth(Plane::filled(2, 2, f32::INFINITY))).unwrap();
    layers.push("lights", LayerData::Scalar(Plane::filled(2, 2, 70.0))).unwrap();
    layers.push("id", LayerData::Id(Plane::filled(2, 2, 7))).unwrap();
    let path = folder.0.path().join("a.exr");
    write_exr(&path, &layers).unwrap();
    let of = |layer| {
        let file = read_picture(&path, Transfer::Srgb, Some(layer)).unwrap();
        (file.picture.linear().get(1, 1), file.channels)
    };
    assert_eq!(of("beauty"), ([0.1; 3], Channels::Rgb));
    assert_eq!(of("albedo"), ([0.2, 0.3, 0.4], Channels::Rgb));
    assert_eq!(of("normal"), ([0.0, -1.0, 0.5], Channels::Rgb));
    assert_eq!(of("depth"), ([f32::INFINITY; 3], Channels::Grey));
    assert_eq!(of("lights"), ([70.0; 3], Channels::Grey));
    assert_eq!(of("id"), ([7.0; 3], Channels::Grey));
    assert_eq!(of("id.ID"), ([7.0; 3], Channels::Grey));
    for layer in ["i", "none", "", "albedo."] {
        let error = read_picture(&path, Transfer::Srgb, Some(layer)).unwrap_err().to_string();
        assert!(error.contains("no layer") && error.contains("albedo.R"), "{error}");
    }
    let png = folder.write_png(GrayImage::new(1, 1));
    let error = read_picture(&png, Transfer::Srgb, Some("albedo")).unwrap_err().to_string();
    assert!(error.contains("only EXR files have layers"), "{error}");
}

#[test]
fn what_is_no_picture_is_an_error_that_names_the_file() {
    let folder = Folder::new();
    let contents: [&[u8]; 8] =
        [b"", b"P", b"PF", b"#?RAD", b"\xff\xd8\xff\xe0", b"GIF89a", b"\x89PNG", b"\x76\x2f\x31\x01"];
    for content in contents {
        let error = read_picture(folder.write("a.bin", content), Transfer::Srgb, None).unwrap_err();
        assert!(matches!(error, ImageError::Malformed { .. }) && error.to_string().contains("a.bin"), "{error}");
    }
    let absent = read_picture(folder.0.path().join("none.exr"), Transfer::Srgb, None);
    assert!(matches!(absent, Err(ImageError::Io { .. })));
}

/// Every truncation of every format, and a change of every byte, ends in a picture or in an error.
#[test]
fn damage_never_ends_the_program() {
    let (folder, light) = (Folder::new(), Image::from_fn(9, 5, |x, y| [x as f32, y as f32, 0.5]));
    let exr = folder.0.path().join("a.exr");
    write_exr(&exr, &Layers::new(light.clone())).unwrap();
    let png = folder.write_png(RgbaImage::from_pixel(9, 5, [51, 52, 53, 9].into()));
    let mut hdr = Vec::new();
    let pixels: Vec<Rgb<f32>> = light.pixels().iter().map(|pixel| Rgb(*pixel)).collect();
    HdrEncoder::new(&mut hdr).encode(&pixels, 9, 5).unwrap();
    for whole in [fs::read(exr).unwrap(), fs::read(png).unwrap(), hdr, pfm(&light, true)] {
        for length in 0..whole.len() - 1 {
            let cut = folder.write("damaged", &whole[..length]);
            let result = read_picture(cut, Transfer::Srgb, None);
            assert!(result.is_err() || length + 12 >= whole.len(), "{length} of {} bytes", whole.len());
        }
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 1 << (at % 8);
            if let Err(error) = read_picture(folder.write("damaged", bytes), Transfer::Srgb, None) {
                assert!(matches!(error, ImageError::Malformed { .. }), "{error}");
            }
        }
    }
}
