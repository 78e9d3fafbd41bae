//! The elements of a PLY file that make a mesh.

use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

/// An element that is read over.
pub(super) struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

/// A vertex, its coordinates of any type of number.
#[derive(Default)]
pub(super) struct Vertex {
    pub position: [f64; 3],
    pub uv: [Option<f64>; 2],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
            Property::Char(v) => f64::from(v),
            Property::UChar(v) => f64::from(v),
            Property::Short(v) => f64::from(v),
            Property::UShort(v) => f64::from(v),
            Property::Int(v) => f64::from(v),
            Property::UInt(v) => f64::from(v),
            Property::Float(v) => f64::from(v),
            Property::Double(v) => v,
            _ => match name {
                "x" | "y" | "z" => return PropertyAccessResult::UnsupportedType,
                _ => return PropertyAccessResult::Ignored,
            },
        };
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            "z" => self.position[2] = value,
            "s" | "u" | "texture_u" => self.uv[0] = Some(value),
            "t" | "v" | "texture_v" => self.uv[1] = Some(value),
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

/// A face with any number of corners.
#[derive(Default)]
pub(super) struct Face {
    pub corners: Option<Vec<i64>>,
    /// u and v by corner, or nothing.
    pub uv: Vec<f64>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        match (name, property) {
            ("vertex_indices" | "vertex_index", list) => match integers(list) {
                Some(corners) => self.corners = Some(corners),
                None => return PropertyAccessResult::UnsupportedType,
            },
            ("texcoord", Property::ListFloat(list)) => {
                self.uv = list.into_iter().map(f64::from).collect();
            }
            ("texcoord", Property::ListDouble(list)) => self.uv = list,
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

fn integers(list: Property) -> Option<Vec<i64>> {
    fn wide<T: Into<i64>>(list: Vec<T>) -> Vec<i64> {
        list.into_iter().map(Into::into).collect()
    }
    Some(match list {
        Property::ListChar(l) => wide(l),
        Property::ListUChar(l) => wide(l),
        Property::ListShort(l) => wide(l),
        Property::ListUShort(l) => wide(l),
        Property::ListInt(l) => wide(l),
        Property::ListUInt(l) => wide(l),
        _ => return None,
    })
}
