//! Which of two meanings a function takes where the original program had a defect.

/// Value of [`Rules::Original`] on other devices.
pub const RULES_ORIGINAL: u32 = 0;
/// Value of [`Rules::Repaired`] on other devices.
pub const RULES_REPAIRED: u32 = 1;

/// Which of two meanings a function takes where the original program had a defect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum Rules {
    /// As the original computed, defects included, so that the thesis' own numbers come out.
    Original = RULES_ORIGINAL,
    /// With the defects that `docs/thesis-model.md` names repaired.
    #[default]
    Repaired = RULES_REPAIRED,
}
