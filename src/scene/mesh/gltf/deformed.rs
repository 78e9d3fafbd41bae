//! Meshes whose vertices the file moves.

use super::super::{MeshFileError, unsupported};
use gltf_json::mesh::{Mesh, Primitive};
use gltf_json::scene::Node;

const CURE: &str = "with the deformation applied";

/// Refuses mesh `at` where the node that shows it has a skin or a morph target moves its vertices:
/// p = p₀ + Σ_k w_k p_k, w the node's weights or else the mesh's (glTF 2.0, section 3.7.2.2).
pub(super) fn refuse(at: usize, mesh: &Mesh, node: &Node) -> Result<(), MeshFileError> {
    if node.skin.is_some() {
        return Err(unsupported(
            format!("mesh {at} that a skeleton moves (a skin)"),
            CURE,
        ));
    }
    let weights = node.weights.as_ref().or(mesh.weights.as_ref());
    let mut counted = weights.into_iter().flatten().enumerate();
    if counted.any(|(k, weight)| *weight != 0.0 && mesh.primitives.iter().any(|p| moves(p, k))) {
        let what = format!("mesh {at} that morph targets of non-zero weight move");
        return Err(unsupported(what, CURE));
    }
    Ok(())
}

/// Whether target k has places of vertices.
fn moves(primitive: &Primitive, k: usize) -> bool {
    let target = primitive.targets.as_ref().and_then(|all| all.get(k));
    target.is_some_and(|target| target.positions.is_some())
}
