//! Free functions and constants of a kernel module, found in its text: rustfmt puts each at the start of a line.

use lightcuts_testkit::project_root;

/// A free function.
#[derive(Debug)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) is_public: bool,
    /// Names and types.
    parameters: Vec<(String, String)>,
}

/// A constant.
#[derive(Debug)]
pub(crate) struct Constant {
    pub(crate) name: String,
    ty: String,
    value: String,
}

/// What a file declares.
pub(crate) struct RustSource {
    pub(crate) functions: Vec<Function>,
    pub(crate) constants: Vec<Constant>,
}

impl RustSource {
    /// Reads `crates/kernel/src/{stem}.rs` up to its tests.
    pub(crate) fn read(stem: &str) -> Self {
        let path = project_root().join("crates/kernel/src").join(stem).with_extension("rs");
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let code = text.split("#[cfg(test)]").next().unwrap_or_default();
        Self {
            functions: items(code).filter_map(function).collect(),
            constants: items(code).filter_map(constant).collect(),
        }
    }
}

/// Every place where a line starts without indentation, with all that follows.
fn items(code: &str) -> impl Iterator<Item = &str> {
    let starts = std::iter::once(0).chain(code.match_indices('\n').map(|(place, _)| place + 1));
    starts.map(|start| &code[start..])
}

fn without_pub(item: &str) -> (&str, bool) {
    item.strip_prefix("pub ").map_or((item, false), |rest| (rest, true))
}

fn function(item: &str) -> Option<Function> {
    let (item, is_public) = without_pub(item);
    let item = item.strip_prefix("const ").unwrap_or(item).strip_prefix("fn ")?;
    let (name, rest) = item.split_once('(')?;
    let parameters = split_outside_brackets(rest).into_iter().filter_map(|parameter| {
        let (name, ty) = parameter.split_once(':')?;
        Some((name.trim().to_owned(), ty.trim().to_owned()))
    });
    Some(Function { name: name.to_owned(), is_public, parameters: parameters.collect() })
}

/// Parts between commas up to the bracket that closes the list.
fn split_outside_brackets(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (place, c) in list.char_indices() {
        match c {
            '(' | '[' | '<' => depth += 1,
            ')' if depth == 0 => {
                parts.push(&list[start..place]);
                break;
            }
            ')' | ']' | '>' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&list[start..place]);
                start = place + 1;
            }
            _ => {}
        }
    }
    parts
}

fn constant(item: &str) -> Option<Constant> {
    let (name, rest) = without_pub(item).0.strip_prefix("const ")?.split_once(": ")?;
    let (ty, rest) = rest.split_once(" = ")?;
    let value = rest.split_once(';')?.0;
    let is_name = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    is_name.then(|| Constant { name: name.to_owned(), ty: ty.to_owned(), value: value.to_owned() })
}

impl Function {
    /// Names of the parameters that the twin must have. Slices and records of slices are bindings on devices. WGSL
    /// reserves some words, which get an underscore there.
    pub(crate) fn parameters_on_devices(&self) -> Vec<String> {
        const RESERVED: [&str; 2] = ["filter", "target"];
        let is_passed = |ty: &str| !ty.starts_with("&[") && !ty.ends_with("<'_>");
        let passed = self.parameters.iter().filter(|(_, ty)| is_passed(ty));
        let suffix = |name: &str| if RESERVED.contains(&name) { "_" } else { "" };
        passed.map(|(name, _)| format!("{name}{}", suffix(name))).collect()
    }
}

impl Constant {
    /// Bits of the value: a sum of numbers and of names from the library.
    pub(crate) fn bits(&self) -> u32 {
        let mut terms = self.value.split(" + ");
        match self.ty.as_str() {
            "f32" => terms.map(float).reduce(|sum, term| sum + term).unwrap_or_default().to_bits(),
            "u32" => terms.next().map(whole).unwrap_or_default(),
            other => panic!("`{}` has the type {other}", self.name),
        }
    }
}

fn float(term: &str) -> f32 {
    match term {
        "f32::MIN_POSITIVE" => f32::MIN_POSITIVE,
        number => number.replace('_', "").parse().unwrap_or_else(|_| panic!("`{number}` is no number")),
    }
}

fn whole(term: &str) -> u32 {
    let (digits, radix) = match term.split_at_checked(2) {
        Some(("0x", digits)) => (digits, 16),
        Some(("0b", digits)) => (digits, 2),
        _ => (term, 10),
    };
    match term {
        "u32::MAX" => u32::MAX,
        _ => u32::from_str_radix(&digits.replace('_', ""), radix).unwrap_or_else(|_| panic!("`{term}` is no number")),
    }
}
