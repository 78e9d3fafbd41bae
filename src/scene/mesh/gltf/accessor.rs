//! The numbers that a glTF accessor stands for.

use super::super::{MeshFileError, malformed};
use super::buffer::{Buffers, Bytes};
use super::{MOST_SHARED, missing};
use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::buffer::View;
use gltf_json::validation::{Checked, USize64};
use gltf_json::{Index, Root};
use std::borrow::Cow;
use std::rc::Rc;

/// The elements of an accessor, known to lie within their buffer.
pub(super) struct Elements<'a> {
    bytes: Bytes<'a>,
    start: usize,
    stride: usize,
    component: ComponentType,
    /// Components of an element.
    width: usize,
    normalized: bool,
    /// How many there are.
    pub count: usize,
}

/// Where elements are stored one after the other.
struct Stored {
    /// `None`: zeros.
    view: Option<usize>,
    offset: u64,
    count: u64,
    component: ComponentType,
    width: usize,
}

impl Stored {
    /// Bytes of an element.
    fn size(&self) -> usize {
        self.component.size() * self.width
    }

    /// They, known to lie within their view; `what` they are.
    fn elements<'a>(
        &self,
        root: &Root,
        buffers: &mut Buffers<'a>,
        what: &str,
    ) -> Result<Elements<'a>, MeshFileError> {
        let size = self.size();
        let Some(at) = self.view else {
            // No bytes of the file stand for them.
            if self.count > MOST_SHARED {
                return Err(MeshFileError::TooMany {
                    what: "elements of a sparse accessor that starts from zeros",
                    count: self.count,
                    most: MOST_SHARED,
                });
            }
            let zeros = vec![0; size * self.count as usize];
            return Ok(self.within(Rc::new(Cow::Owned(zeros)), 0, size));
        };
        let Some(view) = root.buffer_views.get(at) else {
            return Err(missing(
                format!("buffer view {at}"),
                root.buffer_views.len(),
            ));
        };
        let (bytes, length) = buffers.get(view.buffer.value())?;
        let start = view.byte_offset.map_or(0, |o| o.0);
        let within = start.checked_add(view.byte_length.0);
        if within.is_none_or(|end| end > length as u64) {
            return Err(MeshFileError::CutShort {
                what: format!("buffer view {at}"),
                least: u128::from(start) + u128::from(view.byte_length.0),
                left: length,
            });
        }
        let stride = match view.byte_stride {
            None => size,
            Some(stride) if stride.0 >= size => stride.0,
            Some(stride) => {
                let cause = format!("a stride of {} for elements of {size} bytes", stride.0);
                return Err(malformed(what, cause));
            }
        };
        let count = u128::from(self.count);
        let least = match count {
            0 => 0,
            _ => u128::from(self.offset) + (count - 1) * stride as u128 + size as u128,
        };
        if least > u128::from(view.byte_length.0) {
            return Err(MeshFileError::CutShort {
                what: format!("{what} with {count} elements"),
                least,
                left: view.byte_length.0 as usize,
            });
        }
        let start = (start as usize).saturating_add(self.offset as usize);
        Ok(self.within(bytes, start, stride))
    }

    fn within<'a>(&self, bytes: Bytes<'a>, start: usize, stride: usize) -> Elements<'a> {
        Elements {
            bytes,
            start,
            stride,
            component: self.component,
            width: self.width,
            normalized: false,
            count: self.count as usize,
        }
    }
}

impl<'a> Elements<'a> {
    /// Accessor `at`, which must have elements of the given kind.
    pub(super) fn new(
        root: &Root,
        buffers: &mut Buffers<'a>,
        at: usize,
        kind: Type,
    ) -> Result<Self, MeshFileError> {
        let place = format!("accessor {at}");
        let Some(accessor) = root.accessors.get(at) else {
            return Err(missing(place, root.accessors.len()));
        };
        let (Checked::Valid(found), Checked::Valid(component)) =
            (accessor.type_, accessor.component_type)
        else {
            return Err(malformed(place, "its type is none of glTF 2.0"));
        };
        if found != kind {
            let cause = format!("its elements are {found:?} where {kind:?} are needed");
            return Err(malformed(place, cause));
        }
        if accessor.buffer_view.is_none() && accessor.sparse.is_none() {
            return Err(malformed(place, "it has no data"));
        }
        let stored = Stored {
            view: accessor.buffer_view.map(|view| view.value()),
            offset: accessor.byte_offset.map_or(0, |o| o.0),
            count: accessor.count.0,
            component: component.0,
            width: kind.multiplicity(),
        };
        let mut elements = stored.elements(root, buffers, &place)?;
        if let Some(sparse) = &accessor.sparse {
            elements = elements.replaced(root, buffers, sparse, &place)?;
        }
        Ok(Self {
            normalized: accessor.normalized,
            ..elements
        })
    }

    /// The elements with others in the places that a sparse accessor names (glTF 2.0, section
    /// 3.6.2.3).
    fn replaced(
        self,
        root: &Root,
        buffers: &mut Buffers<'a>,
        sparse: &Sparse,
        place: &str,
    ) -> Result<Self, MeshFileError> {
        let Checked::Valid(index) = sparse.indices.component_type else {
            return Err(malformed(place, "its sparse indices are no whole numbers"));
        };
        let stored = |view: Index<View>, offset: USize64, component, width| Stored {
            view: Some(view.value()),
            offset: offset.0,
            count: sparse.count.0,
            component,
            width,
        };
        let indices = &sparse.indices;
        let indices = stored(indices.buffer_view, indices.byte_offset, index.0, 1);
        let values = &sparse.values;
        let values = stored(
            values.buffer_view,
            values.byte_offset,
            self.component,
            self.width,
        );
        let size = values.size();
        let what = |of: &str| format!("the sparse {of} of {place}");
        let indices = indices.elements(root, buffers, &what("indices"))?;
        let indices = indices.indices(place)?;
        let values = values.elements(root, buffers, &what("values"))?;
        let grows = indices.windows(2).all(|pair| pair[0] < pair[1]);
        let is_inside = indices
            .last()
            .is_none_or(|last| (*last as usize) < self.count);
        if !(grows && is_inside) {
            let cause = format!(
                "its sparse indices do not grow from one to the next, up to {} elements",
                self.count
            );
            return Err(malformed(place, cause));
        }
        let each = (0..self.count).flat_map(|i| self.of(i, size));
        let mut bytes: Vec<u8> = each.copied().collect();
        for (k, i) in indices.iter().enumerate() {
            let at = *i as usize * size;
            bytes[at..at + size].copy_from_slice(values.of(k, size));
        }
        Ok(Self {
            bytes: Rc::new(Cow::Owned(bytes)),
            start: 0,
            stride: size,
            ..self
        })
    }

    /// The bytes of element `i`.
    fn of(&self, i: usize, size: usize) -> &[u8] {
        let at = self.start + i * self.stride;
        &self.bytes[at..at + size]
    }

    /// Element `i` of an accessor of vectors.
    pub(super) fn vector<const N: usize>(&self, i: usize) -> [f64; N] {
        let at = self.start + i * self.stride;
        std::array::from_fn(|k| self.number(at + k * self.component.size()))
    }

    /// The elements of an accessor of scalars, which must be unsigned integers.
    pub(super) fn indices(&self, place: &str) -> Result<Vec<u32>, MeshFileError> {
        let starts = (0..self.count).map(|i| self.start + i * self.stride);
        match self.component {
            ComponentType::U8 => Ok(starts.map(|s| u32::from(self.bytes[s])).collect()),
            ComponentType::U16 => Ok(starts
                .map(|s| u32::from(u16::from_le_bytes(self.raw(s))))
                .collect()),
            ComponentType::U32 => Ok(starts.map(|s| u32::from_le_bytes(self.raw(s))).collect()),
            other => {
                let cause = format!("indices of type {other:?}");
                Err(malformed(place, cause))
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
