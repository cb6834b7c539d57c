//! What a WGSL text declares, as naga sees it.

use crate::twins::{joined, parse};
use lightcuts_gpu::records::Layout;
use naga::{Expression, Literal, TypeInner};

/// A parsed text.
pub(crate) struct WgslModule(naga::Module);

/// Bytes of an element of an array, and the offsets of all fields that carry something. How padding is divided into
/// fields is free: uniform buffers permit no arrays of numbers.
pub(crate) type Offsets = (usize, Vec<(String, usize)>);

/// What is compared of a layout.
pub(crate) fn without_padding(layout: &Layout) -> Offsets {
    let fields = layout.fields.iter().filter(|(name, _)| !name.starts_with("padding"));
    (layout.size, fields.map(|&(name, offset)| (name.to_owned(), offset)).collect())
}

impl WgslModule {
    pub(crate) fn new(wgsl: &str) -> Self {
        Self(parse(wgsl))
    }

    /// All twins.
    pub(crate) fn of_twins() -> Self {
        Self::new(&joined())
    }

    /// Names of a function's parameters.
    pub(crate) fn parameters(&self, function: &str) -> Vec<String> {
        let is_it = |candidate: &&naga::Function| candidate.name.as_deref() == Some(function);
        let found = self.0.functions.iter().map(|(_, candidate)| candidate).find(is_it);
        let arguments = &found.unwrap_or_else(|| panic!("`{function}` was not parsed")).arguments;
        arguments.iter().map(|argument| argument.name.clone().unwrap_or_default()).collect()
    }

    /// Bits of a constant.
    pub(crate) fn constant(&self, name: &str) -> u32 {
        let mut constants = self.0.constants.iter().map(|(_, constant)| constant);
        let found = constants.find(|constant| constant.name.as_deref() == Some(name));
        let init = found.unwrap_or_else(|| panic!("`{name}` was not parsed")).init;
        match self.0.global_expressions[init] {
            Expression::Literal(Literal::F32(value)) => value.to_bits(),
            Expression::Literal(Literal::U32(value)) => value,
            Expression::Literal(Literal::I32(value)) => value.cast_unsigned(),
            ref other => panic!("`{name}` is {other:?}"),
        }
    }

    /// The layout of a structure, or `None` if the text declares none of this name.
    pub(crate) fn layout(&self, name: &str) -> Option<Offsets> {
        let mut types = self.0.types.iter().map(|(_, ty)| ty);
        let TypeInner::Struct { members, span } = &types.find(|ty| ty.name.as_deref() == Some(name))?.inner else {
            return None;
        };
        let field = |member: &naga::StructMember| (member.name.clone().unwrap_or_default(), member.offset as usize);
        let fields = members.iter().map(field).filter(|(name, _)| !name.starts_with("padding"));
        Some((*span as usize, fields.collect()))
    }
}
