//! EXR files from outside the crate: round trips, other programs' files, damaged and hostile files, determinism.

// The helpers of tests are tests too, but clippy sees only `#[test]`.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use exr::prelude as exr_crate;
use exr_crate::{Encoding, WritableImage as _};
use lightcuts_image::{
    GlobalToneMapping, Image, ImageError, LayerData, Layers, LocalToneMapping, Plane, ToneMapping, Transfer, bloom,
    luminance, max_abs_difference, read_exr, read_exr_attributes, write_exr, write_png,
};
use proptest::prelude::*;

/// Files that stand beside the checkout and may be absent.
const SHARED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared");

fn scratch() -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("picture.exr");
    (directory, path)
}

/// Seeded numbers for tests: SplitMix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    fn float(&mut self) -> f32 {
        (self.next() >> 40) as f32 / 16_777_216.0
    }
}

fn noise(width: usize, height: usize, seed: u64) -> Image {
    let mut random = Random(seed);
    Image::from_fn(width, height, |_, _| [random.float(), 10.0 * random.float(), random.float() - 0.5])
}

/// Every kind of layer, the extremes of f32 and u32, and attributes that are awkward to store.
fn full_layers(width: usize, height: usize) -> Layers {
    let extremes =
        [0.0, -0.0, f32::MIN_POSITIVE, 1e-45, f32::MAX, f32::MIN, f32::INFINITY, f32::NEG_INFINITY, 1.0 / 3.0];
    let mut layers = Layers::new(noise(width, height, 1));
    let extreme = Image::from_fn(width, height, |x, y| std::array::from_fn(|c| extremes[(x + 3 * y + c) % 9]));
    let scalar = |seed| extreme.map(|rgb| rgb[seed]);
    layers.push("first_pass", LayerData::Color(extreme.clone())).unwrap();
    layers.push("normal", LayerData::Vector(noise(width, height, 2))).unwrap();
    layers.push("depth", LayerData::Depth(scalar(0))).unwrap();
    layers.push("lights_selected", LayerData::Scalar(scalar(1))).unwrap();
    let ids = Plane::from_fn(width, height, |x, y| [0, u32::MAX, 0x7fff_ffff, 0x7fc0_0000, 1][(x + y) % 5]);
    layers.push("object_id", LayerData::Id(ids)).unwrap();
    layers.push("Grüße.with.dots.and.a.name.of.more.than.31.bytes", LayerData::Scalar(scalar(2))).unwrap();
    layers.set_attribute("lightcuts:job", "scene = \"wörld 世界\"\r\n\tline\n".repeat(4_000)).unwrap();
    layers.set_attribute("lightcuts:version", "0.1.0").unwrap();
    layers.set_attribute("an attribute with a very long name and a Ü in it", "").unwrap();
    layers.set_attribute("comments", "a standard name").unwrap();
    layers
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels().iter().map(|rgb| rgb.map(f32::to_bits)).collect()
}

#[test]
fn layers_and_attributes_survive_bit_for_bit() {
    let (_directory, path) = scratch();
    let layers = full_layers(37, 41);
    write_exr(&path, &layers).unwrap();
    let read = read_exr(&path).unwrap();
    assert_eq!(read, layers);
    assert!(layers.attribute("lightcuts:job").unwrap().len() > 100_000);
    assert_eq!(&read_exr_attributes(&path).unwrap(), layers.attributes());
    let colour = |layers: &Layers| match layers.get("first_pass") {
        Some(LayerData::Color(image)) => bits(image), // bits, because -0.0 == 0.0
        other => panic!("{other:?}"),
    };
    assert_eq!(colour(&read), colour(&layers));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_size_and_any_bits_survive(width in 1_usize..70, height in 1_usize..70, seed: u64) {
        let (_directory, path) = scratch();
        let mut random = Random(seed);
        let image = Image::from_fn(width, height, |_, _| std::array::from_fn(|_| f32::from_bits(random.next() as u32)));
        write_exr(&path, &Layers::new(image.clone())).unwrap();
        prop_assert_eq!(bits(read_exr(&path).unwrap().beauty()), bits(&image));
    }
}

/// The exr crate, which wrote none of our headers, must agree with them in its strictest mode.
#[test]
fn the_file_is_valid_for_a_strict_reader() {
    let (_directory, path) = scratch();
    write_exr(&path, &full_layers(37, 41)).unwrap();
    let bytes = fs::read(&path).unwrap();
    let reader = exr::block::read(Cursor::new(&bytes), true).unwrap();
    exr::meta::MetaData::validate(reader.headers(), true).unwrap();
    let chunks = reader.all_chunks(true).unwrap();
    assert_eq!(chunks.map(|chunk| chunk.map(|_| 1).unwrap()).sum::<usize>(), 3);
}

#[test]
fn files_and_operators_are_the_same_on_any_number_of_threads() {
    let (directory, path) = scratch();
    let layers = full_layers(67, 129);
    let results = [1, 2, 7].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let exr = path.with_extension(format!("{threads}.exr"));
            write_exr(&exr, &layers).unwrap();
            assert_eq!(read_exr(&exr).unwrap(), layers);
            let png = directory.path().join("a.png");
            write_png(&png, layers.beauty(), Transfer::Srgb).unwrap();
            let local = ToneMapping::Local(LocalToneMapping::default()).apply(layers.beauty());
            let global = ToneMapping::Global(GlobalToneMapping::default()).apply(layers.beauty());
            let images = [bloom(layers.beauty(), 12.0, 0.7), local, global].map(|image| bits(&image));
            (fs::read(exr).unwrap(), fs::read(png).unwrap(), images)
        })
    });
    assert_eq!(results[0], results[1]);
    assert_eq!(results[0], results[2]);
}

#[test]
fn the_order_of_calls_does_not_change_the_file() {
    let (_directory, path) = scratch();
    let write = |names: &[&str]| {
        let mut layers = Layers::new(noise(5, 5, 3));
        for name in names {
            layers.push(*name, LayerData::Depth(Plane::new(5, 5))).unwrap();
            layers.set_attribute(format!("about {name}"), *name).unwrap();
        }
        write_exr(&path, &layers).unwrap();
        fs::read(&path).unwrap()
    };
    assert_eq!(write(&["a", "b", "c", "d"]), write(&["d", "b", "a", "c"]));
}

#[test]
fn a_picture_that_cannot_be_written_leaves_the_old_file() {
    let (directory, path) = scratch();
    fs::write(&path, b"old").unwrap();
    assert!(matches!(write_exr(&path, &Layers::new(Image::new(0, 3))), Err(ImageError::Encode { .. })));
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    let nowhere = directory.path().join("no/such/a.exr");
    let error = write_exr(&nowhere, &Layers::new(Image::new(1, 1))).unwrap_err().to_string();
    assert!(error.contains("no directory") && error.contains("no/such"), "{error}");
}

#[test]
fn errors_of_reading_name_the_file() {
    let (_directory, path) = scratch();
    assert!(matches!(read_exr(&path), Err(ImageError::Io { .. })));
    assert!(read_exr_attributes(&path).unwrap_err().to_string().contains("picture.exr"));
    fs::write(&path, b"not an exr file at all").unwrap();
    assert!(read_exr(&path).unwrap_err().to_string().contains("picture.exr"));
    assert!(matches!(read_exr_attributes(&path), Err(ImageError::Malformed { .. })));
}

#[test]
fn files_of_other_programs_are_read() {
    let files = [
        ("data/original/simple.exr", false),
        ("data/original/simple-pass1.exr", false),
        ("data/original/simple-lightcuts.exr", false),
        ("data/peers/cornell/reference.exr", false),
        ("data/metrics/pairs/tiny_8x8_ref.exr", false),
        ("data/metrics/pairs/cb_nan_inf_test.exr", true),
        ("scenes/bitterli/cornell-box/pbrt-v4/TungstenRender.exr", false),
        ("scenes/bitterli/veach-ajar/pbrt-v4/TungstenRender.exr", false),
        ("scenes/bitterli/veach-mis/pbrt-v4/TungstenRender.exr", false),
    ];
    for (name, has_nan) in files {
        let path = Path::new(SHARED).join(name);
        if !path.exists() {
            println!("skipped: {} is not here", path.display());
            continue;
        }
        let layers = read_exr(&path).unwrap();
        let pixels = layers.beauty().pixels();
        let mean = pixels.iter().map(|rgb| f64::from(luminance(*rgb))).sum::<f64>() / pixels.len() as f64;
        println!("{name}: {} x {}, mean luminance {mean}", layers.width(), layers.height());
        assert!(layers.width() >= 8 && layers.height() >= 8);
        assert!(has_nan || (mean.is_finite() && mean > 1e-3), "{name}: {mean}");
    }
}

/// The same halves and floats through every compression and block shape that the exr crate writes.
fn foreign_files(width: usize, height: usize) -> Vec<(String, Vec<u8>)> {
    use exr_crate::{
        AnyChannel, AnyChannels, Blocks, Compression as C, FlatSamples, Layer, LayerAttributes, LineOrder,
    };
    let ramp = |scale: f32| move |i: usize| scale * (i % width) as f32 / 64.0;
    let half =
        |scale| FlatSamples::F16((0..width * height).map(|i| exr_crate::f16::from_f32(ramp(scale)(i))).collect());
    let single = |scale| FlatSamples::F32((0..width * height).map(ramp(scale)).collect());
    let channels = [("A", single(1.0)), ("B", half(3.0)), ("G", single(2.0)), ("R", half(1.0))]
        .map(|(name, samples)| AnyChannel::new(name, samples));
    let encode = |compression, blocks| {
        let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
        let channels = AnyChannels::sort(channels.iter().cloned().collect());
        let layer = Layer::new((width, height), LayerAttributes::named("main"), encoding, channels);
        let mut bytes = Cursor::new(Vec::new());
        exr_crate::Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).unwrap();
        bytes.into_inner()
    };
    let compressions =
        [C::Uncompressed, C::RLE, C::ZIP1, C::ZIP16, C::PIZ, C::PXR24, C::B44, C::B44A, C::DWAA(None), C::DWAB(None)];
    let tiles = Blocks::Tiles(exr_crate::Vec2(16, 8));
    let shapes = [("lines", Blocks::ScanLines), ("tiles", tiles)];
    let pairs = compressions.iter().flat_map(|c| shapes.iter().map(move |s| (*c, s)));
    pairs.map(|(c, (shape, blocks))| (format!("{c:?} {shape}"), encode(c, *blocks))).collect()
}

#[test]
fn every_compression_and_tiles_are_read() {
    let (_directory, path) = scratch();
    for (width, height) in [(45, 39), (3, 2), (1, 1), (33, 70)] {
        let ramp = |x: usize| x as f32 / 64.0;
        let expected = Image::from_fn(width, height, |x, _| [ramp(x), 2.0 * ramp(x), 3.0 * ramp(x)]);
        for (name, bytes) in foreign_files(width, height) {
            fs::write(&path, bytes).unwrap();
            let read = read_exr(&path).unwrap_or_else(|error| panic!("{width} x {height} {name}: {error}"));
            let difference = max_abs_difference(read.beauty(), &expected).unwrap();
            let is_lossy = ["PXR", "B44", "DWA"].iter().any(|lossy| name.starts_with(lossy));
            assert!(difference <= if is_lossy { 0.05 } else { 0.0 }, "{name}: {difference}");
            assert!(matches!(read.get("A"), Some(LayerData::Scalar(_))));
        }
    }
}

#[test]
fn the_first_part_with_a_picture_is_read_with_its_attributes() {
    use exr_crate::{AnyChannel, AnyChannels, FlatSamples, Layer, LayerAttributes, Text};
    let (_directory, path) = scratch();
    let part = |name: &str, channels: &[&str], value: f32| {
        let samples = |name: &&str| AnyChannel::new(*name, FlatSamples::F32(vec![value; 6]));
        let mut attributes = LayerAttributes::named(name);
        attributes.owner = Some(Text::new_or_panic(name));
        let channels = AnyChannels::sort(channels.iter().map(samples).collect());
        Layer::new((3, 2), attributes, Encoding::SMALL_LOSSLESS, channels)
    };
    let parts = [part("depth", &["Z"], 9.0), part("main", &["R", "G", "B"], 0.5), part("more", &["R", "G", "B"], 2.0)];
    let window = exr_crate::ImageAttributes::with_size((3, 2));
    let file = exr_crate::Image::from_layers(window, parts.into_iter().collect::<exr_crate::SmallVec<_>>());
    file.write().to_file(&path).unwrap();
    let read = read_exr(&path).unwrap();
    assert_eq!(read.beauty(), &Image::filled(3, 2, [0.5; 3]));
    assert_eq!(read.attribute("owner"), Some("main"));
    assert_eq!(read_exr_attributes(&path).unwrap()["owner"], "depth");
}

/// Peak memory of this process so far, in MiB: resident and virtual. `None` off Linux.
fn peak_memory() -> Option<[u64; 2]> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let field = |name: &str| {
        let line = status.lines().find(|line| line.starts_with(name))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib / 1024)
    };
    Some([field("VmHWM:")?, field("VmPeak:")?])
}

/// Reads damaged bytes, which must end in pixels or in an error, and with little memory.
fn read_damaged(path: &Path, bytes: &[u8]) -> Result<Layers, ImageError> {
    fs::write(path, bytes).unwrap();
    let _ = read_exr_attributes(path);
    let before = peak_memory();
    let result = read_exr(path);
    if let (Some([resident_before, virtual_before]), Some([resident, virtual_])) = (before, peak_memory()) {
        // Saturating, because the kernel sums approximate counters: a "peak" can read lower than before.
        assert!(resident.saturating_sub(resident_before) < 256, "{resident} MiB for {} bytes", bytes.len());
        // Other tests' threads come with their stacks and arenas, hence the room.
        assert!(
            virtual_.saturating_sub(virtual_before) < 3 * 1024,
            "{virtual_} MiB of addresses for {} bytes",
            bytes.len()
        );
    }
    result
}

#[test]
fn truncated_files_are_errors() {
    let (_directory, path) = scratch();
    write_exr(&path, &Layers::new(noise(20, 40, 4))).unwrap();
    let whole = fs::read(&path).unwrap();
    for length in (0..whole.len()).step_by(7).chain(0..600).chain([whole.len() - 1]) {
        assert!(read_damaged(&path, &whole[..length]).is_err(), "{length} of {} bytes", whole.len());
    }
}

#[test]
fn flipped_bytes_never_end_the_program() {
    let (_directory, path) = scratch();
    let mut ours = Layers::new(noise(20, 40, 5));
    ours.push("id", LayerData::Id(Plane::filled(20, 40, 3))).unwrap();
    write_exr(&path, &ours).unwrap();
    let ours = fs::read(&path).unwrap();
    flip(&path, "ours", &ours, 1_000);
    for (name, bytes) in foreign_files(45, 39) {
        flip(&path, &name, &bytes, 100);
    }
}

/// Changes one byte, `count` times, half of them in the header, and reads the file.
fn flip(path: &Path, name: &str, whole: &[u8], count: usize) {
    let mut random = Random(count as u64);
    let (mut errors, mut panics) = (0, 0);
    for index in 0..count {
        let mut bytes = whole.to_vec();
        let limit = if index % 2 == 0 { 500.min(bytes.len()) } else { bytes.len() };
        bytes[random.below(limit)] ^= 1 + random.below(255) as u8;
        if let Err(error) = read_damaged(path, &bytes) {
            errors += 1;
            panics += usize::from(error.to_string().contains("decoder failed"));
        }
    }
    println!("{name}: {errors} errors in {count} flips, {panics} of them panics of the decoder");
}
