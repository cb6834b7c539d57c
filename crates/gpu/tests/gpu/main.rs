//! The GPU against the CPU, on whatever adapter is there.

mod functions;
mod images;
mod light_tree;
mod recovery;
mod stations;
mod support;
mod symbols;
mod twins;
