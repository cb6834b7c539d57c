//! The compute shader around a function: reads its arguments from a buffer and writes its result to another.

use crate::twins::{BUFFERS, joined, parse};
use naga::{ArraySize, Handle, ScalarKind, Type, TypeInner};
use std::fmt::Write as _;

/// Reads and writes the simplest values; all others are made of them.
const BASE: &str = "
var<private> next_input: u32;
var<private> next_output: u32;
fn get_u32() -> u32 { next_input += 1u; return inputs[next_input - 1u]; }
fn get_f32() -> f32 { return bitcast<f32>(get_u32()); }
fn get_i32() -> i32 { return bitcast<i32>(get_u32()); }
fn get_bool() -> bool { return get_u32() != 0u; }
fn put_u32(value: u32) { outputs[next_output] = value; next_output += 1u; }
fn put_f32(value: f32) { put_u32(bitcast<u32>(value)); }
fn put_i32(value: i32) { put_u32(bitcast<u32>(value)); }
fn put_bool(value: bool) { put_u32(select(0u, 1u, value)); }
";

/// All twins with functions that read and write every type of theirs, `get_Ray` and `put_Ray`, for example.
pub(crate) struct Shaders {
    module: naga::Module,
    text: String,
}

impl Shaders {
    pub(crate) fn new() -> Self {
        let mut text = joined();
        let module = parse(&text);
        for (number, name, access) in [(0, "inputs", "read"), (1, "outputs", "read_write")] {
            let binding = BUFFERS.len() + number;
            let _ = writeln!(text, "@group(0) @binding({binding}) var<storage, {access}> {name}: array<u32>;");
        }
        text += BASE;
        for (handle, ty) in module.types.iter().filter(|(_, ty)| is_composite(&ty.inner)) {
            text += &composite(&module, handle, ty);
        }
        Self { module, text }
    }

    /// The statements that call a function with arguments from the input and write its result.
    pub(crate) fn call(&self, function: &str) -> String {
        let mut functions = self.module.functions.iter().map(|(_, candidate)| candidate);
        let found = functions.find(|candidate| candidate.name.as_deref() == Some(function));
        let found = found.unwrap_or_else(|| panic!("there is no function `{function}` in WGSL"));
        let name = |ty| name(&self.module, ty);
        let arguments: Vec<_> = found.arguments.iter().map(|argument| format!("get_{}()", name(argument.ty))).collect();
        let result = found.result.as_ref().unwrap_or_else(|| panic!("`{function}` gives nothing"));
        format!("put_{}({function}({}));", name(result.ty), arguments.join(", "))
    }

    /// The whole text with these statements, run once per case of so many words.
    pub(crate) fn text(&self, statements: &str, inputs: usize, outputs: usize) -> String {
        format!(
            "{}
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {{
    next_input = id.x * {inputs}u;
    next_output = id.x * {outputs}u;
    if (next_output >= arrayLength(&outputs)) {{ return; }}
    {statements}
}}
",
            self.text
        )
    }
}

/// Whether values are made of others, of a number known now.
fn is_composite(inner: &TypeInner) -> bool {
    match inner {
        TypeInner::Array { size, .. } => matches!(size, ArraySize::Constant(_)),
        TypeInner::Vector { .. } | TypeInner::Struct { .. } => true,
        _ => false,
    }
}

/// A type's name within a function's.
fn name(module: &naga::Module, ty: Handle<Type>) -> String {
    let kind = |scalar: naga::Scalar| match scalar.kind {
        ScalarKind::Float => "f32",
        ScalarKind::Uint => "u32",
        ScalarKind::Sint => "i32",
        _ => "bool",
    };
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) => kind(*scalar).to_owned(),
        TypeInner::Vector { size, scalar } => format!("vec{}_{}", *size as u32, kind(*scalar)),
        TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
            format!("array{size}_{}", name(module, *base))
        }
        _ => module.types[ty].name.clone().unwrap_or_default(),
    }
}

/// A type as WGSL spells it.
fn spelled(module: &naga::Module, ty: Handle<Type>) -> String {
    match &module.types[ty].inner {
        TypeInner::Vector { size, .. } => {
            let name = name(module, ty);
            format!("vec{}<{}>", *size as u32, name.rsplit('_').next().unwrap_or_default())
        }
        TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
            format!("array<{}, {size}>", spelled(module, *base))
        }
        _ => name(module, ty),
    }
}

/// The functions that read and write a composite type, part by part.
fn composite(module: &naga::Module, handle: Handle<Type>, ty: &Type) -> String {
    let parts: Vec<(String, String)> = match &ty.inner {
        TypeInner::Struct { members, .. } => members
            .iter()
            .map(|member| (format!(".{}", member.name.as_deref().unwrap_or_default()), name(module, member.ty)))
            .collect(),
        TypeInner::Array { base, size: ArraySize::Constant(size), .. } => {
            (0..size.get()).map(|place| (format!("[{place}]"), name(module, *base))).collect()
        }
        TypeInner::Vector { size, .. } => {
            let name = name(module, handle);
            let of = name.rsplit('_').next().unwrap_or_default();
            (0..*size as usize).map(|place| (format!(".{}", ["x", "y", "z", "w"][place]), of.to_owned())).collect()
        }
        _ => Vec::new(),
    };
    let (name, spelled) = (name(module, handle), spelled(module, handle));
    let gets: Vec<_> = parts.iter().map(|(_, part)| format!("get_{part}()")).collect();
    let puts: Vec<_> = parts.iter().map(|(place, part)| format!("put_{part}(value{place});")).collect();
    format!(
        "fn get_{name}() -> {spelled} {{ return {spelled}({}); }}\nfn put_{name}(value: {spelled}) {{ {} }}\n",
        gets.join(", "),
        puts.join(" ")
    )
}
