//! Scenes whose surfaces reflect in another way than those of a given one: what somebody assumes
//! who does not know their BRDF. Their hash and text remain the original's.

use super::{Material, Role, Scene, Surface};

impl Scene {
    /// Whether every relay surface is Lambertian.
    pub fn relay_is_lambertian(&self) -> bool {
        self.relays().all(|(_, s)| s.is_lambertian())
    }

    /// The same scene with each relay surface Lambertian and of the same white-sky albedo
    /// ([`Surface::lambertian_equivalent`]).
    pub fn with_lambertian_relay(&self) -> Self {
        self.with_matt(Role::Relay)
    }

    /// The same scene with each hidden surface Lambertian and of the same white-sky albedo
    /// ([`Surface::lambertian_equivalent`]): what the matrix model takes it for.
    pub fn with_lambertian_hidden(&self) -> Self {
        self.with_matt(Role::Hidden)
    }

    /// The same scene with `factor` times the roughness of each relay surface that has one
    /// ([`Material::with_roughness_times`]). `None` where none has, or one leaves its range.
    pub fn with_relay_roughness_times(&self, factor: f64) -> Option<Self> {
        self.with_relays(Material::has_roughness, |m| m.with_roughness_times(factor))
    }

    /// The same scene with the refractive index of each relay surface's coat off: 1 + `factor`·(n
    /// − 1) ([`Material::with_contrast_times`]). `None` where none is coated, or an index leaves
    /// its range.
    pub fn with_relay_contrast_times(&self, factor: f64) -> Option<Self> {
        self.with_relays(Material::has_coat, |m| m.with_contrast_times(factor))
    }

    fn with_matt(&self, role: Role) -> Self {
        self.with_each(role, |s| *s = s.lambertian_equivalent().into_owned())
    }

    /// The same scene with the materials of those relay surfaces changed that `concerned` picks;
    /// `None` where it picks none, or one cannot be changed.
    fn with_relays(
        &self,
        concerned: impl Fn(&Material) -> bool,
        change: impl Fn(&Material) -> Option<Material>,
    ) -> Option<Self> {
        let mut scene = self.clone();
        let is_one = |s: &&mut Surface| s.role == Role::Relay && concerned(&s.material);
        let mut any = false;
        for surface in scene.surfaces.iter_mut().filter(is_one) {
            surface.material = change(&surface.material)?;
            any = true;
        }
        any.then_some(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Cells, Texture};

    fn satin() -> Scene {
        Scene::load("satin").unwrap()
    }

    /// Its only surface that is not Lambertian is the wall. Below a smooth coat of index 1.5 a
    /// ground of ρ = 0.8 reflects R_e + (1 − R_e)(1 − R_i) ρ/(1 − ρ R_i) of light from everywhere,
    /// 0.653 with R_e = 0.0918 and R_i = 0.5963 = 1 − (1 − R_e)/η². A rough coat reflects less by
    /// its first facets, so that the sum lies between that and its value for R_e = 0, 0.640.
    #[test]
    fn a_lambertian_wall_reflects_as_much() {
        let satin = satin();
        let matt = satin.with_lambertian_relay();
        let wall = &satin.surfaces[0];
        let albedo = wall.material.white_sky_albedo(0.8);
        assert!(albedo > 0.640 && albedo < 0.653, "{albedo}");
        assert_eq!(matt.surfaces[0].albedo, Texture::Constant(albedo));
        assert!(matt.relay_is_lambertian() && !satin.relay_is_lambertian());
        assert_eq!(matt.surfaces[1], satin.surfaces[1]);
        assert_eq!(satin.with_lambertian_hidden().surfaces, satin.surfaces);
        let bench = Scene::load("bench").unwrap();
        assert_eq!(bench.with_lambertian_relay().surfaces, bench.surfaces);
    }

    /// A coat reflects over black too, and what varies over a surface does so afterwards.
    #[test]
    fn reflectance_follows_the_texture() {
        let text = satin().text.replace(
            "lambertian = { checkerboard = [2, 2], dark = 0.0, light = 1.0 }",
            "coated = { cells = [[0.0, 1.0, 0.5]] }, roughness = 0.3",
        );
        let scene = Scene::from_toml("glossy", &text).unwrap();
        let material = &scene.surfaces[1].material;
        let each = [0.0, 1.0, 0.5].map(|rho| material.white_sky_albedo(rho));
        assert!(each[0] > 0.02 && each[0] < each[2] && each[2] < each[1] && each[1] < 1.0);
        let matt = scene.with_lambertian_hidden();
        let cells = Cells {
            count: [3, 1],
            albedo: each.to_vec(),
        };
        assert_eq!(matt.surfaces[1].albedo, Texture::Cells(cells));
        let elements = scene.surfaces[1].divided([3, 2]);
        for (k, element) in elements.iter().enumerate() {
            assert!((element.albedo - each[k % 3]).abs() < 1e-15);
        }
    }

    #[test]
    fn walls_without_the_parameter_have_no_such_variant() {
        let satin = satin();
        let rough = satin.with_relay_roughness_times(2.0).unwrap();
        let own = satin.text.replace("roughness = 0.3", "roughness = 0.6");
        assert_eq!(
            rough.surfaces,
            Scene::from_toml("own", &own).unwrap().surfaces
        );
        assert!(satin.with_relay_roughness_times(4.0).is_none());
        assert!(satin.with_relay_contrast_times(0.8).is_some());
        let bench = Scene::load("bench").unwrap();
        assert!(bench.with_relay_roughness_times(0.5).is_none());
        assert!(bench.with_relay_contrast_times(0.8).is_none());
    }
}
