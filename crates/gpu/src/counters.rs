//! Sums that programs count up, as `counters.wgsl` lays them out: 64 places of all counters, two words each.

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Counter {
    ShadowRays = 0,
    OcclusionRays = 1,
    TreeNodes = 2,
    TreeLights = 3,
    PhotonRays = 4,
}

/// Number of counters.
const COUNTERS: usize = 5;
/// Places of each, so that invocations seldom meet.
const PLACES: usize = 64;
/// Bytes of all of them.
pub(crate) const BYTES: u64 = (COUNTERS * PLACES * 8) as u64;

/// The sum of a counter, from the bytes of all.
pub(crate) fn sum(bytes: &[u8], counter: Counter) -> u64 {
    let words: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(bytes);
    let places = words.iter().skip(counter as usize).step_by(COUNTERS);
    places.map(|[low, high]| u64::from(*low) | u64::from(*high) << 32).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::wgsl::shaders;

    #[test]
    fn places_are_added_up_with_their_carries() {
        let mut words = vec![[0_u32; 2]; COUNTERS * PLACES];
        words[Counter::TreeNodes as usize] = [7, 1];
        words[63 * COUNTERS + Counter::TreeNodes as usize] = [1, 0];
        words[Counter::TreeLights as usize] = [5, 0];
        assert_eq!(sum(bytemuck::cast_slice(&words), Counter::TreeNodes), (1 << 32) + 8);
        assert_eq!(sum(bytemuck::cast_slice(&words), Counter::PhotonRays), 0);
    }

    #[test]
    fn counters_have_the_numbers_of_the_shader() {
        for (name, number) in [
            ("COUNTER_SHADOW_RAYS", Counter::ShadowRays as usize),
            ("COUNTER_OCCLUSION_RAYS", Counter::OcclusionRays as usize),
            ("COUNTER_TREE_NODES", Counter::TreeNodes as usize),
            ("COUNTER_TREE_LIGHTS", Counter::TreeLights as usize),
            ("COUNTER_PHOTON_RAYS", Counter::PhotonRays as usize),
            ("COUNTERS", COUNTERS),
            ("COUNTER_PLACES", PLACES),
        ] {
            let line = format!("const {name}: u32 = {number}u;");
            assert!(shaders::COUNTERS.text.contains(&line), "{line}");
        }
    }
}
