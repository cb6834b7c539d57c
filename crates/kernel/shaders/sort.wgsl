// A stable radix sort of pairs (key, index), four bits at a time.
struct SortParams {
    count: u32,
    shift: u32,
    groups: u32,
    first_group: u32,
}

const SORT_THREADS: u32 = 256u;
const DIGITS: u32 = 16u;

var<workgroup> local_keys: array<vec2<u32>, SORT_THREADS>;
var<workgroup> zeros: array<u32, SORT_THREADS>;
var<workgroup> digit_counts: array<atomic<u32>, DIGITS>;
var<workgroup> digit_starts: array<u32, DIGITS>;

fn digit_of(key: u32) -> u32 {
    return (key >> params.shift) & (DIGITS - 1u);
}

// How often each digit occurs in each group's part, digit by digit.
@compute @workgroup_size(256)
fn count_digits(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let part = params.first_group + group.x;
    let n = part * SORT_THREADS + lane;
    if (lane < DIGITS) {
        atomicStore(&digit_counts[lane], 0u);
    }
    workgroupBarrier();
    if (n < params.count) {
        atomicAdd(&digit_counts[digit_of(pairs_in[n].x)], 1u);
    }
    workgroupBarrier();
    if (lane < DIGITS) {
        words[lane * params.groups + part] = atomicLoad(&digit_counts[lane]);
    }
}

// Sorts each group's part by its digit, bit by bit, and puts it where `words`, now prefix sums, say.
@compute @workgroup_size(256)
fn scatter(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let part = params.first_group + group.x;
    let n = part * SORT_THREADS + lane;
    let size = min(SORT_THREADS, params.count - part * SORT_THREADS);
    var pair = vec2<u32>(0xffffffffu);
    if (n < params.count) {
        pair = pairs_in[n];
    }
    for (var bit = 0u; bit < 4u; bit++) {
        // Pairs past the end count as ones, so that they stay last.
        let is_zero = lane < size && ((pair.x >> (params.shift + bit)) & 1u) == 0u;
        zeros[lane] = select(0u, 1u, is_zero);
        for (var reach = 1u; reach < SORT_THREADS; reach *= 2u) {
            workgroupBarrier();
            var left = 0u;
            if (lane >= reach) {
                left = zeros[lane - reach];
            }
            workgroupBarrier();
            zeros[lane] += left;
        }
        workgroupBarrier();
        let zeros_before = zeros[lane] - select(0u, 1u, is_zero);
        let all_zeros = zeros[SORT_THREADS - 1u];
        let place = select(all_zeros + lane - zeros_before, zeros_before, is_zero);
        local_keys[place] = pair;
        workgroupBarrier();
        pair = local_keys[lane];
        workgroupBarrier();
    }
    let digit = digit_of(pair.x);
    let is_here = lane < size;
    if (is_here) {
        if (lane == 0u || digit_of(local_keys[lane - 1u].x) != digit) {
            digit_starts[digit] = lane;
        }
    }
    workgroupBarrier();
    if (is_here) {
        pairs_out[words[digit * params.groups + part] + lane - digit_starts[digit]] = pair;
    }
}
