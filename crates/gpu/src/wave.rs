//! A wave: the ray trees of some tiles' samples, traced layer by layer over flat buffers, lit, summed and developed.

use crate::counters;
use crate::engine::Engine;
use crate::records::{
    CameraSample, FilmParams, NodeColor, NodeLink, NodeRay, NodeSurface, NodeTotal, PixelRecord, Place, PlaceParams,
    RangeParams, SeenRecord, SpawnParams, StartParams, TileRecord,
};
use crate::wave_input::Input;
use crate::wave_output::empty_result;
use bytemuck::Zeroable;
use glam::Vec4;
use lightcuts_kernel::light::Vpl;
use lightcuts_render::Monitor;
use lightcuts_render::device::{DeviceFault, DeviceKind, Pass, Placement, Shifts, Tile, TileResult, Wants};

/// Nodes of ray trees at once on a card: 160 MB of memory.
const CARD_NODES: u32 = 1 << 20;
/// The same on a software driver, which gains nothing from more.
const SOFTWARE_NODES: u32 = 1 << 17;
/// Fewest nodes: the largest ray tree of the thesis' depth of 12 fits.
const FEWEST_NODES: u32 = 1 << 13;

/// How much fits on the device at once.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capacity {
    pub(crate) nodes: u32,
}

impl Capacity {
    pub(crate) fn new(asked: Option<u32>, kind: DeviceKind) -> Self {
        let usual = if kind == DeviceKind::Gpu { CARD_NODES } else { SOFTWARE_NODES };
        Self { nodes: asked.unwrap_or(usual).max(FEWEST_NODES) }
    }

    /// Numbers that prefix sums are made of: two children per node.
    pub(crate) fn words(self) -> u32 {
        2 * self.nodes
    }
}

/// How a wave ended.
enum Wave {
    Done(Vec<TileResult>),
    /// The ray trees do not fit.
    TooLarge,
    Cancelled,
}

/// A layer of the ray trees: a range of the nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Layer {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

impl Engine {
    /// Allocates what every wave needs.
    pub(crate) fn allocate_wave(&mut self) -> Result<(), DeviceFault> {
        let nodes = u64::from(self.capacity.nodes);
        for (name, size) in [
            ("samples", size_of::<CameraSample>()),
            ("node_rays", size_of::<NodeRay>()),
            ("node_surfaces", size_of::<NodeSurface>()),
            ("node_colors", size_of::<NodeColor>()),
            ("node_links", size_of::<NodeLink>()),
            ("node_totals", size_of::<NodeTotal>()),
            ("node_occlusion", size_of::<f32>()),
        ] {
            self.allocate(name, nodes * size as u64)?;
        }
        for name in ["tiles", "pixels", "film_places", "film_sums", "seen"] {
            self.allocate(name, 1 << 12)?;
        }
        self.allocate("counters", counters::BYTES)?;
        self.reserve_words(self.capacity.words())
    }

    /// Renders some tiles, in as many waves as it takes; `None` if the monitor cancelled.
    pub(crate) fn render_tiles(
        &mut self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<TileResult>>, DeviceFault> {
        let per_pixel = match pass.shifts {
            Shifts::Sampler(sampler) => u64::from(sampler.count()),
            Shifts::Given(_) => 1,
        };
        let samples: u64 = tiles.iter().map(|tile| u64::from(tile.width) * u64::from(tile.height) * per_pixel).sum();
        let reach = u64::from(2 * pass.view.filter.border() + 1);
        self.require_rounds(reach * reach * per_pixel, "so many samples in a pixel")?;
        // Children need room too.
        let room = if self.has_children { self.capacity.nodes / 2 } else { self.capacity.nodes };
        if samples <= u64::from(room) {
            match self.wave(pass, tiles, monitor)? {
                Wave::Done(results) => return Ok(Some(results)),
                Wave::Cancelled => return Ok(None),
                Wave::TooLarge => {}
            }
        }
        if let [tile] = tiles {
            return Ok(self.render_halves(pass, tile, monitor)?.map(|result| vec![result]));
        }
        let (left, right) = tiles.split_at(tiles.len() / 2);
        let Some(mut results) = self.render_tiles(pass, left, monitor)? else { return Ok(None) };
        let Some(others) = self.render_tiles(pass, right, monitor)? else { return Ok(None) };
        results.extend(others);
        Ok(Some(results))
    }

    /// Renders a tile that does not fit in two parts: its rows, or the pixels of one row.
    fn render_halves(
        &mut self,
        pass: &Pass<'_>,
        tile: &Tile,
        monitor: &dyn Monitor,
    ) -> Result<Option<TileResult>, DeviceFault> {
        let Tile { i, j, width, height } = *tile;
        let halves = if height > 1 {
            [Tile { height: height / 2, ..*tile }, Tile { j: j + height / 2, height: height - height / 2, ..*tile }]
        } else if width > 1 {
            [Tile { width: width / 2, ..*tile }, Tile { i: i + width / 2, width: width - width / 2, ..*tile }]
        } else {
            return Err(DeviceFault::OutOfMemory("the ray trees of one pixel".to_owned()));
        };
        let mut whole = empty_result(pass, *tile);
        for half in halves {
            let Some(mut parts) = self.render_tiles(pass, &[half], monitor)? else { return Ok(None) };
            let part = parts.remove(0);
            whole.film.merge(&part.film);
            // Whole rows, or parts of the only row, follow one another.
            whole.seen.extend(part.seen);
            whole.vpls.extend(part.vpls);
            whole.hits.extend(part.hits);
            whole.selections.extend(part.selections);
            whole.rays.add(&part.rays);
            whole.visits.add(&part.visits);
        }
        Ok(Some(whole))
    }

    /// Renders tiles as one wave.
    fn wave(&mut self, pass: &Pass<'_>, tiles: &[Tile], monitor: &dyn Monitor) -> Result<Wave, DeviceFault> {
        let input = Input::new(pass, tiles);
        let samples = input.samples.len() as u32;
        self.reserve("tiles", (input.tiles.len() * size_of::<TileRecord>()) as u64)?;
        self.reserve("pixels", (input.pixels.len() * size_of::<PixelRecord>()) as u64)?;
        self.reserve("film_places", (input.places.len() * size_of::<Place>()) as u64)?;
        self.reserve("film_sums", (input.places.len() * size_of::<Vec4>()) as u64)?;
        self.reserve("seen", (input.pixels.len() * size_of::<SeenRecord>()) as u64)?;
        self.write("samples", &input.samples);
        self.write("pixels", &input.pixels);
        self.write("tiles", &input.tiles);
        self.write("film_places", &input.places);
        let counters = self.buffer("counters");
        self.dispatcher.clear(&self.context, &counters);
        let Some(layers) = self.trace_trees(pass, samples, monitor)? else { return Ok(Wave::TooLarge) };
        if monitor.cancelled() {
            // Light is missing then: nothing of the wave can be used.
            return Ok(Wave::Cancelled);
        }
        for layer in layers.iter().rev() {
            self.over_layer("sum_layer", *layer, pass)?;
        }
        let placed = match pass.wants {
            Wants::SurfacesAndVpls(Some(placement)) => self.place_vpls(placement, &layers)?,
            Wants::SurfacesAndHits => {
                self.rank_hits(&PlaceParams::zeroed(), &layers)?;
                0
            }
            _ => 0,
        };
        self.develop(pass, &input)?;
        self.collect(pass, tiles, &input, &layers, placed).map(Wave::Done)
    }

    /// Traces all layers and lights their hits; `None` if they do not fit.
    fn trace_trees(
        &mut self,
        pass: &Pass<'_>,
        samples: u32,
        monitor: &dyn Monitor,
    ) -> Result<Option<Vec<Layer>>, DeviceFault> {
        let rules = pass.view.rules as u32;
        self.over("start", samples, 1.0, |engine, first, count| {
            let params = StartParams { camera: pass.view.camera, first, count, rules, padding: 0 };
            engine.run("start", &params, count, f64::from(count))
        })?;
        let mut layers = vec![Layer { first: 0, count: samples }];
        for depth in 1..=pass.view.max_depth {
            let Some(&layer) = layers.last() else { break };
            self.dispatcher.governor.is_deep = depth > 1;
            self.over_layer("trace", layer, pass)?;
            self.light(pass, layer, monitor)?;
            if depth == pass.view.max_depth || !self.has_children || monitor.cancelled() {
                break;
            }
            match self.spawn(layer, rules)? {
                None => {
                    self.dispatcher.governor.is_deep = false;
                    return Ok(None);
                }
                Some(next) if next.count == 0 => break,
                Some(next) => layers.push(next),
            }
        }
        self.dispatcher.governor.is_deep = false;
        Ok(Some(layers))
    }

    /// A program that takes a range of nodes and nothing else, over a layer.
    fn over_layer(&mut self, entry: &'static str, layer: Layer, pass: &Pass<'_>) -> Result<(), DeviceFault> {
        self.over(entry, layer.count, 1.0, |engine, first, count| {
            let params = RangeParams { first: layer.first + first, count, rules: pass.view.rules as u32, padding: 0 };
            engine.run(entry, &params, count, f64::from(count))
        })
    }

    /// Makes the layer of the children; `None` if they do not fit.
    fn spawn(&mut self, layer: Layer, rules: u32) -> Result<Option<Layer>, DeviceFault> {
        let next = layer.first + layer.count;
        let params = SpawnParams { rules, layer: layer.first, next, ..SpawnParams::zeroed() };
        self.over("count_children", layer.count, 1.0, |engine, first, count| {
            let params = SpawnParams { first: layer.first + first, count, ..params };
            engine.run("count_children", &params, count, f64::from(count))
        })?;
        let children = self.scan_words(2 * layer.count)?;
        if children > self.capacity.nodes - next {
            return Ok(None);
        }
        if children > 0 {
            self.over("spawn", layer.count, 1.0, |engine, first, count| {
                let params = SpawnParams { first: layer.first + first, count, ..params };
                engine.run("spawn", &params, count, f64::from(count))
            })?;
        }
        Ok(Some(Layer { first: next, count: children }))
    }

    /// Gives every hit its place in post-order; returns the number of hits.
    fn rank_hits(&mut self, params: &PlaceParams, layers: &[Layer]) -> Result<u32, DeviceFault> {
        let roots = layers[0].count;
        self.over_nodes("root_sizes", params, 0, roots)?;
        let hits = self.scan_words(roots)?;
        self.over_nodes("rank_roots", params, 0, roots)?;
        for layer in layers {
            self.over_nodes("rank_children", params, layer.first, layer.count)?;
        }
        Ok(hits)
    }

    /// Places VPLs at hits, in post-order; returns their number.
    fn place_vpls(&mut self, placement: &Placement, layers: &[Layer]) -> Result<u32, DeviceFault> {
        let Placement { probability, min_illumination, attenuation, stream } = *placement;
        let params = PlaceParams { probability, min_illumination, attenuation, stream, ..PlaceParams::zeroed() };
        let hits = self.rank_hits(&params, layers)?;
        let nodes: u32 = layers.iter().map(|layer| layer.count).sum();
        self.over_nodes("mark_vpls", &params, 0, nodes)?;
        let placed = self.scan_words(hits)?;
        self.reserve("placed", u64::from(placed) * size_of::<Vpl>() as u64)?;
        self.over_nodes("place_vpls", &params, 0, nodes)?;
        Ok(placed)
    }

    fn over_nodes(
        &mut self,
        entry: &'static str,
        params: &PlaceParams,
        start: u32,
        total: u32,
    ) -> Result<(), DeviceFault> {
        self.over(entry, total, 1.0, |engine, first, count| {
            let params = PlaceParams { first: start + first, count, ..*params };
            engine.run(entry, &params, count, f64::from(count))
        })
    }

    /// Turns samples into films and into what pixels saw.
    fn develop(&mut self, pass: &Pass<'_>, input: &Input) -> Result<(), DeviceFault> {
        let filter = pass.view.filter;
        let params = FilmParams {
            border: filter.border(),
            width: pass.view.camera.width,
            filter_: filter.pixel_filter(),
            ..FilmParams::zeroed()
        };
        let reach = f64::from(2 * filter.border() + 1);
        let samples_each = reach * reach * input.samples.len() as f64 / input.pixels.len().max(1) as f64;
        self.over("film", input.places.len() as u32, samples_each, |engine, first, count| {
            let params = FilmParams { first, count, ..params };
            engine.run("film", &params, count, f64::from(count) * samples_each)
        })?;
        self.over("see", input.pixels.len() as u32, 1.0, |engine, first, count| {
            let params = RangeParams { first, count, rules: 0, padding: 0 };
            engine.run("see", &params, count, f64::from(count))
        })
    }
}
