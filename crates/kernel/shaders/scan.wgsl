// Exclusive prefix sums: blocks are summed by themselves, then the sums of blocks, then these are added.
struct ScanParams {
    count: u32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

const SCAN_THREADS: u32 = 256u;
const SCAN_ITEMS: u32 = 4u;

var<workgroup> sums: array<u32, SCAN_THREADS>;

@compute @workgroup_size(256)
fn scan_blocks(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = (group.x * SCAN_THREADS + lane) * SCAN_ITEMS;
    var own = array<u32, SCAN_ITEMS>();
    var total = 0u;
    for (var k = 0u; k < SCAN_ITEMS; k++) {
        own[k] = total;
        if (first + k < params.count) {
            total += words[first + k];
        }
    }
    sums[lane] = total;
    for (var reach = 1u; reach < SCAN_THREADS; reach *= 2u) {
        workgroupBarrier();
        var left = 0u;
        if (lane >= reach) {
            left = sums[lane - reach];
        }
        workgroupBarrier();
        sums[lane] += left;
    }
    workgroupBarrier();
    let before = sums[lane] - total;
    for (var k = 0u; k < SCAN_ITEMS; k++) {
        if (first + k < params.count) {
            words[first + k] = before + own[k];
        }
    }
    if (lane == SCAN_THREADS - 1u) {
        block_sums[group.x] = sums[lane];
    }
}

@compute @workgroup_size(256)
fn add_block_sums(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = (group.x * SCAN_THREADS + lane) * SCAN_ITEMS;
    for (var k = 0u; k < SCAN_ITEMS; k++) {
        if (first + k < params.count) {
            words[first + k] += block_sums[group.x];
        }
    }
}
