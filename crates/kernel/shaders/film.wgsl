struct FilmParams {
    first: u32,
    count: u32,
    border: u32,
    // Of the picture.
    width: u32,
    filter_: PixelFilter,
}

// A tile of the wave. Its film's pixels are numbered from `film`, its own pixels from `pixel`, bottom row first.
struct TileRecord {
    i: u32,
    j: u32,
    width: u32,
    height: u32,
    film: u32,
    pixel: u32,
    padding0: u32,
    padding1: u32,
}

// A pixel of a film, within a tile; `x` and `y` count from the film's lower left corner.
struct Place {
    tile: u32,
    x: u32,
    y: u32,
}

// The weighted sum of the samples around some pixels of the tiles' films, in the order of pixels and samples.
@compute @workgroup_size(64)
fn film(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let place = film_places[params.first + id.x];
    let tile = tiles[place.tile];
    let border = i32(params.border);
    let x = i32(place.x) - border;
    let y = i32(place.y) - border;
    var sum = vec4<f32>(0.0);
    for (var j = max(y - border, 0); j <= min(y + border, i32(tile.height) - 1); j++) {
        for (var i = max(x - border, 0); i <= min(x + border, i32(tile.width) - 1); i++) {
            let pixel = pixels[tile.pixel + u32(j) * tile.width + u32(i)];
            for (var n = pixel.first; n < pixel.first + pixel.count; n++) {
                let shift = samples[n].shift;
                let weight = filter_weight(params.filter_, shift.x - f32(x - i), shift.y - f32(y - j));
                if (weight != 0.0) {
                    sum += vec4<f32>(node_colors[n].color * weight, weight);
                }
            }
        }
    }
    film_sums[params.first + id.x] = sum;
}
