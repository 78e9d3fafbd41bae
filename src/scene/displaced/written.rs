//! A displaced scene as a file.

use glam::DAffine3;

use super::reflection::write_material;
use super::size_of_spots;
use crate::geometry::{DQuat, DVec3, Shape};
use crate::scene::file::{Layout, MeshTable, RotationTable, SceneFile, SpotsTable, SurfaceTable};
use crate::scene::parameter::Parameter;
use crate::scene::surface::Surface;
use crate::scene::{Scene, SceneError, parse};

impl Scene {
    /// The file of a scene that is that of [`Scene::displaced`]; known answers are gone.
    ///
    /// # Errors
    /// [`SceneError`] where the text of the scene is not that of a file.
    pub fn displaced_file(
        &self,
        parameters: &[Parameter],
        values: &[f64],
    ) -> Result<SceneFile, SceneError> {
        let to = self.displacement(parameters, values);
        let (mut file, _): (SceneFile, _) = parse::parse(&self.name, &self.text)?;
        file.known.clear();
        let each = file.surface.iter_mut().zip(&self.surfaces);
        for (id, ((table, surface), motion)) in each.zip(&to.surfaces).enumerate() {
            write_material(&mut table.material, id, parameters, values);
            if *motion != DAffine3::IDENTITY {
                write_moved(table, surface, motion, &self.axes);
            }
        }
        let in_file = |p| self.to_file().transform_point3(p).to_array();
        let spots_move = parameters.iter().any(|p| p.kind.is_of_spots());
        if let Some(laser) = &mut file.laser {
            laser.position = in_file(to.laser);
            laser.spot_diameter *= size_of_spots(parameters, values);
            if spots_move {
                laser.spots = SpotsTable {
                    layout: Layout::List,
                    points: Some(to.spots),
                    ..SpotsTable::default()
                };
            }
        }
        file.camera.position = in_file(to.camera);
        [file.camera.view.x, file.camera.view.y] = to.view;
        Ok(file)
    }
}

/// Moves the shape of a surface in its table, whose coordinates are those of the file.
fn write_moved(table: &mut SurfaceTable, surface: &Surface, motion: &DAffine3, axes: &DAffine3) {
    let placed = axes.inverse() * *motion;
    let motion = &(placed * *axes);
    let point = |p: [f64; 3]| motion.transform_point3(DVec3::from_array(p)).to_array();
    let vector = |v: [f64; 3]| motion.transform_vector3(DVec3::from_array(v)).to_array();
    if let Some(r) = &mut table.rectangle {
        (r.corner, r.u, r.v) = (point(r.corner), vector(r.u), vector(r.v));
    }
    if let Some(s) = &mut table.sphere {
        s.centre = point(s.centre);
    }
    if let Some(d) = &mut table.disc {
        (d.centre, d.normal) = (point(d.centre), vector(d.normal));
    }
    if let (Some(m), Shape::Instance(body)) = (&mut table.mesh, &surface.shape) {
        write_moved_mesh(m, &(placed * *body.placement()), motion);
    }
}

/// A mesh that stood on a surface stands where it is then.
fn write_moved_mesh(table: &mut MeshTable, placement: &DAffine3, motion: &DAffine3) {
    let (axis, angle) = DQuat::from_mat3(&motion.matrix3).to_axis_angle();
    if angle != 0.0 {
        table.rotate.get_or_insert_default().push(RotationTable {
            axis: axis.to_array(),
            angle: angle.to_degrees(),
        });
    }
    table.translate = Some(placement.translation.to_array());
    table.on = None;
}
