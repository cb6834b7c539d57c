const FARTHEST_CELL: f32 = 1e9;
const PI: f32 = 3.14159265358979323846;

fn photon_cell(point: vec3<f32>, radius: f32) -> vec3<i32> {
    let cell = floor(point / radius);
    return vec3<i32>(clamp(cell, vec3<f32>(-FARTHEST_CELL), vec3<f32>(FARTHEST_CELL)));
}

fn cell_before(a: vec3<i32>, b: vec3<i32>) -> bool {
    if (a.x != b.x) {
        return a.x < b.x;
    }
    if (a.y != b.y) {
        return a.y < b.y;
    }
    return a.z < b.z;
}

fn first_photon(cell: vec3<i32>) -> u32 {
    var start = 0u;
    var end = arrayLength(&photons);
    while (start < end) {
        let middle = start + (end - start) / 2u;
        let photon = photons[middle];
        if (cell_before(vec3<i32>(photon.cell_x, photon.cell_y, photon.cell_z), cell)) {
            start = middle + 1u;
        } else {
            end = middle;
        }
    }
    return start;
}

fn gather_photons(point: vec3<f32>, normal: vec3<f32>, radius: f32, min_photons: u32) -> vec3<f32> {
    let cell = photon_cell(point, radius);
    var sum = vec3<f32>(0.0);
    var count = 0u;
    for (var x = -1; x <= 1; x++) {
        for (var y = -1; y <= 1; y++) {
            let last = cell + vec3<i32>(x, y, 1);
            for (var index = first_photon(cell + vec3<i32>(x, y, -1)); index < arrayLength(&photons); index++) {
                let photon = photons[index];
                if (cell_before(last, vec3<i32>(photon.cell_x, photon.cell_y, photon.cell_z))) {
                    break;
                }
                let offset = photon.position - point;
                if (dot3(offset, offset) <= radius * radius && dot3(photon.normal, normal) > 0.5) {
                    sum += photon.power;
                    count += 1u;
                }
            }
        }
    }
    if (count < min_photons) {
        return vec3<f32>(0.0);
    }
    return sum / (PI * radius * radius);
}
