//! Faults on purpose, for tests: recovery that was never tried does not work.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU64, Ordering};

/// When a device is to fail. Counts continue over the devices that replace a failed one.
#[derive(Debug, Default)]
pub struct Sabotage {
    /// Numbers of submissions, from 0, before which the device is destroyed.
    pub lost_submissions: BTreeSet<u64>,
    /// Numbers of allocations, from 0, that are refused.
    pub refused_allocations: BTreeSet<u64>,
    submissions: AtomicU64,
    allocations: AtomicU64,
}

impl Sabotage {
    /// Fails at these submissions and allocations.
    pub fn new(lost_submissions: &[u64], refused_allocations: &[u64]) -> Self {
        Self {
            lost_submissions: lost_submissions.iter().copied().collect(),
            refused_allocations: refused_allocations.iter().copied().collect(),
            ..Self::default()
        }
    }

    /// Submissions so far.
    pub fn submissions(&self) -> u64 {
        self.submissions.load(Ordering::Relaxed)
    }

    /// Allocations so far.
    pub fn allocations(&self) -> u64 {
        self.allocations.load(Ordering::Relaxed)
    }

    pub(crate) fn loses_submission(&self) -> bool {
        self.lost_submissions.contains(&self.submissions.fetch_add(1, Ordering::Relaxed))
    }

    pub(crate) fn refuses_allocation(&self) -> bool {
        self.refused_allocations.contains(&self.allocations.fetch_add(1, Ordering::Relaxed))
    }
}
