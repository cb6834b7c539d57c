// Parameters of programs that take a range of things and nothing else.
struct RangeParams {
    first: u32,
    count: u32,
    rules: u32,
    padding: u32,
}
