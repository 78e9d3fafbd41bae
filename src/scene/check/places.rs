//! Spots and hidden surfaces where nobody puts them.

use crate::geometry::Shape;
use crate::scene::Scene;
use crate::scene::warning::Warning;

/// Places closer than this part of the view are one.
const SAME_PLACE: f64 = 1e-6;

/// Spots closer to an earlier one than a millionth of the view, where half of them are: lines that
/// meet share their corners.
pub(super) fn together(scene: &Scene, found: &mut Vec<Warning>) {
    let view = &scene.camera.view;
    let apart = SAME_PLACE * view.u().length().min(view.v().length());
    let laser = &scene.laser;
    if laser.is_shining() {
        return;
    }
    let place = |l: usize| laser.spots[l].target.position;
    let mut order: Vec<usize> = (0..laser.spots.len()).collect();
    order.sort_by(|a, b| place(*a).x.total_cmp(&place(*b).x));
    let mut is_again = vec![false; order.len()];
    for (k, a) in order.iter().enumerate() {
        let near = order[k + 1..].iter();
        let near = near.take_while(|b| place(**b).x - place(*a).x <= apart);
        for b in near.filter(|b| (place(**b) - place(*a)).length() <= apart) {
            is_again[*a.max(b)] = true;
        }
    }
    let again: Vec<usize> = (0..order.len()).filter(|l| is_again[*l]).collect();
    if 2 * again.len() >= order.len() && !again.is_empty() {
        found.push(Warning::SpotsTogether(again));
    }
}

/// Distance behind a wall, over its side, that rounding of a contact leaves.
const CONTACT: f64 = 1e-6;
/// Points a side of a hidden surface, its edges among them.
const ACROSS: usize = 9;

/// Hidden surfaces of which a point lies behind a flat wall, its foot on that.
pub(super) fn behind_walls(scene: &Scene, found: &mut Vec<Warning>) {
    for (_, surface) in scene.hidden() {
        for (_, wall) in scene.relays() {
            let Shape::Parallelogram(flat) = &wall.shape else {
                continue;
            };
            let contact = CONTACT * flat.u().length();
            let is_behind = |k: usize| {
                let uv = [k % ACROSS, k / ACROSS].map(|i| i as f64 / (ACROSS - 1) as f64);
                let point = surface.shape.at(uv).position;
                let height = flat.normal().dot(point - flat.corner());
                let foot = flat.coordinates(point);
                height < -contact && foot.iter().all(|x| (0.0..=1.0).contains(x))
            };
            if (0..ACROSS * ACROSS).any(is_behind) {
                let [hidden, wall] = [surface, wall].map(|s| s.name.clone());
                found.push(Warning::BehindWall(hidden, wall));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The warnings of the bench with one line of it changed.
    fn told(from: &str, to: &str) -> Vec<Warning> {
        let text = Scene::load("bench").unwrap().text;
        assert!(text.contains(from), "{from}");
        let scene = Scene::from_toml("changed", &text.replacen(from, to, 1)).unwrap();
        let mut all = scene.warnings();
        all.retain(|w| matches!(w, Warning::SpotsTogether(_) | Warning::BehindWall(..)));
        all
    }

    /// A spot half a millionth of the view (3.25 in.) beside the only other one is told, one four
    /// millionths away is not; of a layout without extent all but the first are.
    #[test]
    fn spots_at_one_place_are_told() {
        let square = "layout = \"square\"\ncentre = [5.0, 4.373476808130942]\nhalf_width = 3.0\n\
            per_side = 30\nstagger = [-1.0, 1.0, 0.0]";
        let two = |x: f64| format!("layout = \"list\"\npoints = [[2, 2], [{x:?}, 2]]");
        let list = |x: f64| told(square, &two(x));
        assert_eq!(list(2.0 + 1.6e-6), [Warning::SpotsTogether(vec![1])]);
        assert_eq!(list(2.0 + 1.3e-5), []);
        let point = square.replace("half_width = 3.0", "half_width = 1e-20");
        let point = point.replace("-1.0, 1.0, 0.0", "0.0");
        let all = (1..120).collect();
        assert_eq!(told(square, &point), [Warning::SpotsTogether(all)]);
    }

    /// The board touches the wall along its hinge, and is told where it is turned into it.
    #[test]
    fn a_surface_behind_the_wall_is_told() {
        let edge = "v = [0, -2.82842712474619, 2.82842712474619]";
        assert_eq!(told(edge, edge), []);
        let into = told(edge, "v = [0, -2.82842712474619, -4.2]");
        let names = ["object", "wall"].map(str::to_owned);
        assert_eq!(
            into,
            [Warning::BehindWall(names[0].clone(), names[1].clone())]
        );
        // On the wall itself, along its upper edge.
        let at = "corner = [3, 11.350951966438567, 4.149048033561433]";
        let hinged = "corner = [3, 15.5, 0]";
        assert_eq!(told(at, hinged), []);
    }
}
