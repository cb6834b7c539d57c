// Sums over all invocations in 64 bits: a counter has 64 places, so that invocations seldom meet, each a low and a high
// word.
const COUNTER_SHADOW_RAYS: u32 = 0u;
const COUNTER_OCCLUSION_RAYS: u32 = 1u;
const COUNTER_TREE_NODES: u32 = 2u;
const COUNTER_TREE_LIGHTS: u32 = 3u;
const COUNTER_PHOTON_RAYS: u32 = 4u;
const COUNTERS: u32 = 5u;
const COUNTER_PLACES: u32 = 64u;

fn count_up(counter: u32, amount: u32, invocation: u32) {
    if (amount == 0u) {
        return;
    }
    let place = ((invocation / 64u % COUNTER_PLACES) * COUNTERS + counter) * 2u;
    let before = atomicAdd(&counters[place], amount);
    if (before + amount < before) {
        atomicAdd(&counters[place + 1u], 1u);
    }
}
