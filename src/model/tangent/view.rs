//! How what the camera sees moves.

use super::{Aim, WallRate, material_of, met};
use crate::geometry::DVec3;
use crate::model::wall_point::WallPoint;
use crate::scene::{Scene, Velocity};

/// The view as it moves.
#[derive(Debug)]
pub(in crate::model) struct ViewRate<'a> {
    scene: &'a Scene,
    velocity: &'a Velocity,
    aim: Aim,
}

impl<'a> ViewRate<'a> {
    /// None where no wall lies below the middle of the view.
    pub(in crate::model) fn new(scene: &'a Scene, velocity: &'a Velocity) -> Option<Self> {
        let view = &scene.camera.view;
        let middle = view.at([0.5; 2]).position;
        let wall = scene.relays().flat_map(|(id, s)| {
            let points = s.shape.at_xy(middle.x, middle.y).into_iter();
            points.map(move |p| (id, (p.position - middle).length_squared()))
        });
        let (id, _) = wall.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let normal = view.normal();
        Some(Self {
            aim: Aim::new(scene, velocity, id, middle, normal, velocity.view),
            scene,
            velocity,
        })
    }

    /// Of a point that the camera sees: E ∝ (n·(τ − o))²/|τ − o|⁴ · area.
    pub(in crate::model) fn seen(&self, point: &WallPoint) -> WallRate<'a> {
        let (camera, aim) = (&self.scene.camera, &self.aim);
        let device = [camera.position, self.velocity.camera];
        let target = aim.target(camera.position, point.position);
        let growth = self.velocity.view_growth;
        let [dx, dy] = [0, 1].map(|k| aim.at_rate[k] + growth * (target[k] - aim.at[k]));
        let away = target - aim.at;
        let level = aim.normal.dot(aim.at_rate) - aim.normal_rate.dot(away);
        let dz = (level - aim.normal.x * dx - aim.normal.y * dy) / aim.normal.z;
        let target_rate = DVec3::new(dx, dy, dz);
        let line = target - device[0];
        let line_rate = target_rate - device[1];
        let height = aim.normal_rate.dot(line) + aim.normal.dot(line_rate);
        // The area of a rectangle in x and y is that over |n_z|.
        let area = 2.0 * growth - aim.normal_rate.z / aim.normal.z;
        WallRate {
            weight: 2.0 * height / aim.normal.dot(line)
                - 4.0 * line.dot(line_rate) / line.length_squared()
                + area,
            ..met(
                self.scene,
                self.velocity,
                point,
                device,
                [target, target_rate],
            )
        }
    }

    /// Of a piece of a flat wall that the camera sees
    /// ([`seen_piece`](crate::model::wall_point::seen_piece)), where its middle moves by
    /// `position` and its area grows by `grown`, relatively: E ∝ (n·l)(n′·l)/l⁴ · area, l from the
    /// camera. An albedo that varies moves with the middle.
    pub(in crate::model) fn piece(
        &self,
        point: &WallPoint,
        position: DVec3,
        grown: f64,
    ) -> WallRate<'a> {
        let camera = &self.scene.camera;
        let line = point.position - camera.position;
        let rate = position - self.velocity.camera;
        let d2 = line.length_squared();
        let of = |n: DVec3, n_rate: DVec3| (n_rate.dot(line) + n.dot(rate)) / n.dot(line);
        let turned = point.surface.map_or(DVec3::ZERO, |id| {
            let twist = &self.velocity.surfaces[id as usize];
            twist.angular.cross(point.normal)
        });
        let length = d2.sqrt();
        let unit = -line / length;
        WallRate {
            position,
            normal: turned,
            device: (unit * unit.dot(rate) - rate) / length,
            weight: grown
                + of(camera.view.normal(), self.aim.normal_rate)
                + of(point.normal, turned)
                - 4.0 * line.dot(rate) / d2,
            material: material_of(self.velocity, point),
        }
    }
}
