//! The way through the nodes of a scene.

use super::super::{MeshFileError, malformed};
use super::missing;
use crate::geometry::DVec3;
use glam::{DMat4, DQuat};
use gltf_json::Root;
use gltf_json::scene::{Node, Scene};

/// The nodes that are still to be visited, each with its number and the transform of the node above
/// it. A node can be met once only, so the way ends.
pub(super) struct Walk<'a> {
    root: &'a Root,
    met: Vec<bool>,
    ahead: Vec<(usize, &'a Node, DMat4)>,
}

impl<'a> Walk<'a> {
    pub(super) fn new(root: &'a Root, scene: &Scene) -> Result<Self, MeshFileError> {
        let mut walk = Self {
            root,
            met: vec![false; root.nodes.len()],
            ahead: Vec::new(),
        };
        for node in scene.nodes.iter().rev() {
            walk.push(node.value(), DMat4::IDENTITY)?;
        }
        Ok(walk)
    }

    /// The next node and the transform that puts it in its place, if there is one left.
    pub(super) fn next(&mut self) -> Result<Option<(&'a Node, DMat4)>, MeshFileError> {
        let Some((at, node, outer)) = self.ahead.pop() else {
            return Ok(None);
        };
        let placed = outer * transform(at, node)?;
        for child in node.children.iter().flatten().rev() {
            self.push(child.value(), placed)?;
        }
        Ok(Some((node, placed)))
    }

    fn push(&mut self, at: usize, outer: DMat4) -> Result<(), MeshFileError> {
        let Some(node) = self.root.nodes.get(at) else {
            return Err(missing(format!("node {at}"), self.root.nodes.len()));
        };
        if std::mem::replace(&mut self.met[at], true) {
            return Err(malformed(
                format!("node {at}"),
                "it hangs below itself or below two nodes",
            ));
        }
        self.ahead.push((at, node, outer));
        Ok(())
    }
}

/// A node's own transform: its matrix, or scale, then rotation, then translation.
fn transform(at: usize, node: &Node) -> Result<DMat4, MeshFileError> {
    if let Some(matrix) = node.matrix {
        return Ok(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let vector = |v: Option<[f32; 3]>, or| v.map_or(or, |v| DVec3::from_array(v.map(f64::from)));
    let rotation = match node.rotation {
        None => DQuat::IDENTITY,
        Some(q) => DQuat::from_array(q.0.map(f64::from)),
    };
    let length = rotation.length();
    if !(0.99..=1.01).contains(&length) {
        let cause = format!("its rotation has length {length}, not 1");
        return Err(malformed(format!("node {at}"), cause));
    }
    Ok(DMat4::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation.normalize(),
        vector(node.translation, DVec3::ZERO),
    ))
}
