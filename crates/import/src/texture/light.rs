//! Images that hold light: EXR, Radiance HDR and portable float maps, as `lightcuts-image` decodes them for all who read them.

use super::{Bounds, Decoded, ImageUse, Texels, TextureError};
use lightcuts_image::{ImageError, Light, LightOptions, MAX_PIXELS, PictureLimits, decode_light};
use std::path::Path;

/// The light in `bytes`; `None` if they are in none of the formats.
pub(super) fn decode(bytes: &[u8], bounds: Bounds, wanted: ImageUse) -> Option<Result<Decoded, TextureError>> {
    let limits = PictureLimits {
        side: bounds.side as usize,
        pixels: MAX_PIXELS,
        bytes: usize::try_from(bounds.bytes).unwrap_or(usize::MAX),
    };
    let options = LightOptions { layer: None, is_data: wanted == ImageUse::Data, limits };
    let light = decode_light(Path::new(""), bytes, &options)?;
    Some(light.map(decoded).map_err(|error| match error {
        ImageError::Malformed { reason, .. } => TextureError::Malformed(reason),
        other => TextureError::Malformed(other.to_string()),
    }))
}

fn decoded(light: Light) -> Decoded {
    let Light { image, frame, has_other_primaries, mut remarks, .. } = light;
    if !frame.is_whole() {
        remarks.push(format!("its pixels are {frame}; they are taken as the whole image"));
    }
    Decoded {
        width: image.width() as u32, // the casts hold: the sides were checked
        height: image.height() as u32,
        texels: Texels::Light(image.into_pixels()),
        uses_differ: has_other_primaries,
        remarks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { side: 64, bytes: 1 << 14 };

    fn read(bytes: &[u8], wanted: ImageUse) -> Result<Decoded, String> {
        decode(bytes, BOUNDS, wanted).expect("the format is known").map_err(|error| error.to_string())
    }

    fn exr(change: impl FnOnce(&mut ::exr::prelude::ImageAttributes)) -> Vec<u8> {
        use ::exr::prelude::*;
        let pixels = SpecificChannels::rgb(|at: Vec2<usize>| (0.5_f32, if at.1 == 0 { 0.5_f32 } else { 0.1 }, 0.1_f32));
        let mut image = Image::from_channels((2, 2), pixels);
        change(&mut image.attributes);
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut bytes).expect("an image in memory can be encoded");
        bytes.into_inner()
    }

    #[test]
    fn each_format_is_read_top_row_first() {
        let hdr = [&b"#?RGBE\nEXPOSURE=0.5\n\n-Y 2 +X 1\n"[..], &[127, 63, 0, 129, 0, 0, 0, 0]].concat();
        let decoded = read(&hdr, ImageUse::Color).expect("it is sound");
        assert_eq!((decoded.width, decoded.height), (1, 2));
        assert_eq!(decoded.texels, Texels::Light(vec![[1.992_187_5, 0.992_187_5, 0.007_812_5], [0.0; 3]]));
        let samples: Vec<u8> = [1.0_f32, 2.0].iter().flat_map(|value| value.to_le_bytes()).collect();
        let pfm = [&b"Pf\n1 2\n-2\n"[..], &samples].concat();
        let decoded = read(&pfm, ImageUse::Color).expect("it is sound");
        assert_eq!(decoded.texels, Texels::Light(vec![[4.0; 3], [2.0; 3]]));
        assert!(decoded.remarks[0].contains("multiplied by 2"), "{:?}", decoded.remarks);
        let decoded = read(&exr(|_| ()), ImageUse::Color).expect("it is sound");
        assert_eq!(decoded.texels, Texels::Light([[[0.5, 0.5, 0.1]; 2], [[0.5, 0.1, 0.1]; 2]].concat()));
        assert!(!decoded.uses_differ && decoded.remarks.is_empty());
        assert!(decode(b"GIF89a", BOUNDS, ImageUse::Color).is_none());
    }

    #[test]
    fn colours_are_converted_and_data_are_not() {
        use ::exr::prelude::attribute::Chromaticities;
        let aces = exr(|attributes| {
            attributes.chromaticities = Some(Chromaticities {
                red: (0.7347, 0.2653).into(),
                green: (0.0, 1.0).into(),
                blue: (0.0001, -0.077).into(),
                white: (0.32168, 0.33767).into(),
            });
        });
        let color = read(&aces, ImageUse::Color).expect("it is sound");
        assert!(color.uses_differ && color.remarks[0].contains("chromaticities"), "{:?}", color.remarks);
        let Texels::Light(texels) = color.texels else { panic!("EXR holds light") };
        // Blender's figures for (0.5, 0.1, 0.1) of ACES.
        assert!(texels[2].iter().zip([1.109, -0.011, 0.094]).all(|(a, b)| (a - b).abs() < 1e-3), "{:?}", texels[2]);
        let data = read(&aces, ImageUse::Data).expect("it is sound");
        assert!(data.uses_differ && data.remarks.is_empty());
        assert_eq!(data.texels, Texels::Light([[[0.5, 0.5, 0.1]; 2], [[0.5, 0.1, 0.1]; 2]].concat()));
    }

    #[test]
    fn limits_and_damage_are_told() {
        let file = |header: &str| [header.as_bytes(), &[0; 12]].concat();
        for (header, expected) in [
            ("PF\n65 1\n-1\n", "65 x 1 pixels: at most 64 x 64 are possible"),
            ("PF\n60 60\n-1\n", "43200 bytes of memory, but there is room for 16384 only"),
            ("PF\n2 2\n-1\n", "cannot come from a file of 12 bytes"),
            ("PF\n1 1\nnan\n", "finite number other than 0"),
            ("#?RADIANCE\n\n-Y 65 +X 1\n", "at most 64 x 64"),
            ("#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n", "`EXPOSURE=nan`: expected a positive number"),
            ("#?RADIANCE\n\n-Y 1 +X 5\n", "the file ends too early"),
        ] {
            let found = read(&file(header), ImageUse::Color).expect_err(header);
            assert!(found.starts_with("cannot be decoded: ") && found.contains(expected), "{header}: {found}");
        }
    }

    #[test]
    fn no_damage_ends_the_program() {
        let bytes = exr(|_| ());
        for i in 4..bytes.len() {
            let _ = read(&bytes[..i], ImageUse::Color);
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[i] ^= flip;
                let _ = read(&damaged, ImageUse::Color);
            }
        }
    }
}
