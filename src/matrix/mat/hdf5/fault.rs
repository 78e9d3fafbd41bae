//! Why something of an HDF5 file cannot be read.

/// The reason, as what follows a subject: `it`, or the name of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum Fault {
    /// Cut short or altered.
    Damaged(&'static str),
    /// Of a kind that is not read.
    Unsupported(&'static str),
}

/// A part ends before its last field.
pub(super) const CUT: Fault = Fault::Damaged("is cut short");
