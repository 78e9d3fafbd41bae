//! The defects of a mesh, in words.

use std::fmt;

use super::Defects;

impl fmt::Display for Defects {
    /// One sentence for each kind that was found.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut sentences = Vec::new();
        let mut say = |count: usize, one: &str, many: &str, rest: &str| match count {
            0 => {}
            1 => sentences.push(format!("1 {one} {rest}.")),
            _ => sentences.push(format!("{count} {many} {rest}.")),
        };
        let (face, faces) = ("face", "faces");
        say(
            self.not_finite,
            face,
            faces,
            "with a vertex that is not finite left out",
        );
        say(self.degenerate, face, faces, "without area left out");
        say(self.duplicate, face, faces, "given before left out");
        say(
            self.reverse,
            face,
            faces,
            "left out, the back of one given before, which alone is the front (`flip = true` exchanges front and back, `sides = \"two\"` gives an occluder or a wall both)",
        );
        let (edge, edges) = ("edge", "edges");
        say(
            self.open_edges,
            edge,
            edges,
            "with one face only: the surface is open there",
        );
        say(
            self.turned_edges,
            edge,
            edges,
            "where the front of one face meets the back of the other",
        );
        say(self.crowded_edges, edge, edges, "with more than two faces");
        if self.is_inside_out() {
            sentences.push(String::from(
                "The closed body shows its back outwards: turn its faces around (`flip`).",
            ));
        }
        f.write_str(&sentences.join(" "))
    }
}
