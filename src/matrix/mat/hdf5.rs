//! The part of HDF5 that MATLAB writes: the members of the root group, and arrays of numbers.
//!
//! Superblocks 0 to 3, object headers 1 and 2 with continuations, groups by symbol table or by
//! links in the header, data in the header, in one piece, or in chunks that a B-tree of version 1
//! finds, with the filters deflate, shuffle and Fletcher-32. What is read is bounded by the bytes
//! of the file: no tree is longer than they allow, and no array larger than Deflate could make it
//! of them.
//!
//! Source: HDF5 File Format Specification, version 3.0, The HDF Group.

mod attribute;
mod chunks;
mod dataset;
mod datatype;
mod fault;
mod fields;
mod file;
mod filters;
mod group;
mod header;
mod layout;
mod tree;

pub(super) use attribute::Attribute;
pub(super) use dataset::Dataset;
pub(super) use datatype::Datatype;
pub(super) use fault::Fault;
pub(super) use file::File;
pub(super) use group::members;
pub(super) use header::Header;
