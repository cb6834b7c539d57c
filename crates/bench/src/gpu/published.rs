//! What the thesis says of its own GPU.

/// A row of the thesis' tables 5.1 to 5.3: means of three runs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Published {
    /// Seconds of the first pass, the second and both.
    pub(super) seconds: [f64; 3],
    /// Absent without lightcuts.
    pub(super) light_ratio_percent: Option<f64>,
    pub(super) vpl_count: u64,
}

/// The means that `experiments/thesis_tables.csv` has for a scene and a configuration, such as `gpu-lightcuts`.
pub(super) fn published(csv: &str, scene: &str, configuration: &str) -> Option<Published> {
    csv.lines().find_map(|line| match line.split(',').collect::<Vec<_>>()[..] {
        [_, of, "average", with, first, second, total, ratio, vpls] if of == scene && with == configuration => {
            let seconds = [first.parse().ok()?, second.parse().ok()?, total.parse().ok()?];
            Some(Published { seconds, light_ratio_percent: ratio.parse().ok(), vpl_count: vpls.parse().ok()? })
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_gpu_is_found() {
        let csv = std::fs::read_to_string(crate::place::root().join("experiments/thesis_tables.csv")).unwrap();
        let plain = published(&csv, "galleon", "gpu").unwrap();
        assert_eq!(plain, Published { seconds: [28.345, 816.96, 845.34], light_ratio_percent: None, vpl_count: 146 });
        let lightcuts = published(&csv, "simple", "gpu-lightcuts").unwrap();
        assert_eq!((lightcuts.light_ratio_percent, lightcuts.vpl_count), (Some(64.035), 253));
        assert_eq!(published(&csv, "ship", "gpu"), None);
    }
}
