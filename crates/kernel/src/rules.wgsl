const RULES_ORIGINAL: u32 = 0u;
const RULES_REPAIRED: u32 = 1u;
