//! Why triangles make no mesh.

/// Why triangles make no mesh.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum MeshError {
    /// A vertex is not finite or far outside any bench.
    #[error(
        "vertex {vertex} reaches to {reach:e}: coordinates must be finite and below 1e12 (choose a larger unit)"
    )]
    Unbounded {
        /// Its place in the list.
        vertex: usize,
        /// Largest coordinate.
        reach: f64,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex} of {count}: vertices are counted from 0")]
    NoVertex {
        /// The triangle's place in the list.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// No triangle has an area.
    #[error("none of the {count} triangles has an area: give a mesh at least one proper triangle")]
    Empty {
        /// Number of triangles.
        count: usize,
    },
    /// Texture coordinates for another number of triangles.
    #[error("{given} triples of texture coordinates for {triangles} triangles: give one to each")]
    Coordinates {
        /// Triples given.
        given: usize,
        /// Number of triangles.
        triangles: usize,
    },
    /// More triangles than can be numbered.
    #[error("{count} triangles are more than 2³⁰: split the mesh")]
    TooMany {
        /// Number of triangles.
        count: usize,
    },
}
