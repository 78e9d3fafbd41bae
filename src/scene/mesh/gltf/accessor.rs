//! The numbers that a glTF accessor stands for.

use super::super::{MeshFileError, malformed, unsupported};
use super::buffer::{Buffers, Bytes};
use super::missing;
use gltf_json::Root;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;

/// The elements of an accessor, known to lie within their buffer.
pub(super) struct Elements<'a> {
    bytes: Bytes<'a>,
    start: usize,
    stride: usize,
    component: ComponentType,
    normalized: bool,
    /// How many there are.
    pub count: usize,
}

impl<'a> Elements<'a> {
    /// Accessor `at`, which must have elements of the given kind.
    pub(super) fn new(
        root: &Root,
        buffers: &mut Buffers<'a>,
        at: usize,
        kind: Type,
    ) -> Result<Self, MeshFileError> {
        let place = || format!("accessor {at}");
        let Some(accessor) = root.accessors.get(at) else {
            return Err(missing(place(), root.accessors.len()));
        };
        if accessor.sparse.is_some() {
            return Err(unsupported(format!("the sparse accessor {at}")));
        }
        let (Checked::Valid(found), Checked::Valid(component)) =
            (accessor.type_, accessor.component_type)
        else {
            return Err(malformed(place(), "its type is none of glTF 2.0"));
        };
        if found != kind {
            let cause = format!("its elements are {found:?} where {kind:?} are needed");
            return Err(malformed(place(), cause));
        }
        let Some(view_at) = accessor.buffer_view else {
            return Err(malformed(place(), "it has no data"));
        };
        let Some(view) = root.buffer_views.get(view_at.value()) else {
            let what = format!("buffer view {}", view_at.value());
            return Err(missing(what, root.buffer_views.len()));
        };
        let (bytes, length) = buffers.get(view.buffer.value())?;
        let view_start = view.byte_offset.map_or(0, |o| o.0);
        let within = view_start.checked_add(view.byte_length.0);
        if within.is_none_or(|end| end > length as u64) {
            return Err(MeshFileError::CutShort {
                what: format!("buffer view {}", view_at.value()),
                least: u128::from(view_start) + u128::from(view.byte_length.0),
                left: length,
            });
        }
        let element = component.0.size() * kind.multiplicity();
        let stride = match view.byte_stride {
            None => element,
            Some(stride) if stride.0 >= element => stride.0,
            Some(stride) => {
                let cause = format!("a stride of {} for elements of {element} bytes", stride.0);
                return Err(malformed(place(), cause));
            }
        };
        let offset = accessor.byte_offset.map_or(0, |o| o.0);
        let (count, offset_wide) = (u128::from(accessor.count.0), u128::from(offset));
        let least = match count {
            0 => 0,
            _ => offset_wide + (count - 1) * stride as u128 + element as u128,
        };
        if least > u128::from(view.byte_length.0) {
            return Err(MeshFileError::CutShort {
                what: format!("accessor {at} with {count} elements"),
                least,
                left: view.byte_length.0 as usize,
            });
        }
        Ok(Self {
            bytes,
            start: (view_start as usize).saturating_add(offset as usize),
            stride,
            component: component.0,
            normalized: accessor.normalized,
            count: accessor.count.0 as usize,
        })
    }

    /// Element `i` of an accessor of vectors.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f64; N] {
        let at = self.start + i * self.stride;
        std::array::from_fn(|k| self.number(at + k * self.component.size()))
    }

    /// The elements of an accessor of scalars, which must be unsigned integers.
    pub(super) fn indices(&self, at: usize) -> Result<Vec<u32>, MeshFileError> {
        let starts = (0..self.count).map(|i| self.start + i * self.stride);
        match self.component {
            ComponentType::U8 => Ok(starts.map(|s| u32::from(self.bytes[s])).collect()),
            ComponentType::U16 => Ok(starts
                .map(|s| u32::from(u16::from_le_bytes(self.raw(s))))
                .collect()),
            ComponentType::U32 => Ok(starts.map(|s| u32::from_le_bytes(self.raw(s))).collect()),
            other => {
                let cause = format!("indices of type {other:?}");
                Err(malformed(format!("accessor {at}"), cause))
            }
        }
    }

    fn raw<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut raw = [0; N];
        raw.copy_from_slice(&self.bytes[at..at + N]);
        raw
    }

    /// The component at a byte; normalised integers as section 3.11 of glTF 2.0 says.
    fn number(&self, at: usize) -> f64 {
        let (value, largest) = match self.component {
            ComponentType::I8 => (f64::from(i8::from_le_bytes(self.raw(at))), 127.0),
            ComponentType::U8 => (f64::from(self.bytes[at]), 255.0),
            ComponentType::I16 => (f64::from(i16::from_le_bytes(self.raw(at))), 32767.0),
            ComponentType::U16 => (f64::from(u16::from_le_bytes(self.raw(at))), 65535.0),
            ComponentType::U32 => (f64::from(u32::from_le_bytes(self.raw(at))), 4294967295.0),
            ComponentType::F32 => return f64::from(f32::from_le_bytes(self.raw(at))),
        };
        if self.normalized {
            (value / largest).max(-1.0)
        } else {
            value
        }
    }
}
