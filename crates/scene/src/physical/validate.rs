//! What must hold of a physical scene before it is rendered.

use super::{
    EmissionDesc, EmitterDesc, EmitterKind, ImageId, PhysicalCamera, PhysicalScene, PhysicalShape, Pixels, Scattering,
    SurfaceDesc, Tint, View,
};
use crate::validate::Check;
use crate::{Issue, Subject};
use glam::Vec3;

/// Materials that a mix may lead through before it comes to one that is no mix.
pub const MAX_MIX_DEPTH: usize = 8;

/// Range of refractive indices of dielectrics.
const IOR: (f32, f32) = (1.0 / 3.0, 3.0);
/// How near to 1 they may not be: nothing would be refracted.
const MIN_CONTRAST: f32 = 1e-3;
/// Greatest refractive and absorption index of a metal.
const MAX_METAL: f32 = 100.0;
/// Greatest Phong exponent.
const MAX_EXPONENT: f32 = 1e6;

impl PhysicalScene {
    /// Checks everything that rendering relies on and returns all issues, in scene order.
    pub fn validate(&self) -> Vec<Issue> {
        let mut check = Check::new();
        check.subject = Subject::Camera;
        camera(&self.camera, &mut check);
        for (i, light) in self.lights.iter().enumerate() {
            check.subject = Subject::Light(i);
            emitter(light, &mut check);
        }
        if let Some(environment) = &self.environment {
            check.subject = Subject::Environment;
            check.light("radiance", environment.radiance);
            self.image(environment.image, "image", &mut check);
            check.angle("degrees", environment.degrees, 360.0);
        }
        for (i, object) in self.objects.iter().enumerate() {
            check.subject = Subject::Object(i);
            check.index("material", object.material.0, self.materials.len());
            self.shape(&object.shape, &mut check);
        }
        for (i, material) in self.materials.iter().enumerate() {
            check.subject = Subject::Material(i);
            self.material(i, material, &mut check);
        }
        for (i, image) in self.images.iter().enumerate() {
            check.subject = Subject::Image(i);
            let count = u64::from(image.width) * u64::from(image.height);
            if count == 0 || count != image.pixels.len() as u64 {
                check.issue("pixels", format!("must be {} x {} and at least one", image.width, image.height));
            }
            if let Pixels::Float(pixels) = &image.pixels
                && let Some(bad) = pixels.iter().position(|p| !p.iter().all(|c| (0.0..=f32::MAX).contains(c)))
            {
                check.issue("pixels", format!("hold {:?} at pixel {}", pixels[bad], bad + 1));
            }
        }
        for (i, mesh) in self.meshes.iter().enumerate() {
            check.subject = Subject::Mesh(i);
            check.mesh(mesh, self.materials.len());
        }
        check.issues
    }

    fn image(&self, image: Option<ImageId>, field: &'static str, check: &mut Check) {
        if let Some(ImageId(index)) = image {
            check.index(field, index, self.images.len());
        }
    }

    fn shape(&self, shape: &PhysicalShape, check: &mut Check) {
        match *shape {
            PhysicalShape::Sphere { center, radius } => {
                check.point("center", center);
                check.length("radius", radius);
            }
            PhysicalShape::Rectangle { center, normal, head, width, height } => {
                check.point("center", center);
                check.frame(("normal", normal), ("head", head));
                check.length("width", width);
                check.length("height", height);
            }
            PhysicalShape::Mesh { mesh, placement, .. } => {
                check.index("mesh", mesh.0, self.meshes.len());
                for column in [placement.x_axis, placement.y_axis, placement.z_axis, placement.translation] {
                    check.point("placement", column);
                }
                if placement.matrix3.determinant().abs() < f64::from(f32::MIN_POSITIVE) {
                    check.issue("placement", "flattens the mesh; expected one that keeps its volume");
                }
            }
        }
    }

    fn material(&self, index: usize, material: &SurfaceDesc, check: &mut Check) {
        match &material.scattering {
            Scattering::Lambert { albedo } => self.tint("albedo", albedo, check),
            Scattering::Phong { diffuse, specular, exponent } => {
                self.tint("diffuse", diffuse, check);
                self.tint("specular", specular, check);
                if (diffuse.color + specular.color).max_element() > 1.0 + 1e-5 {
                    check.issue("specular", "and diffuse add up to more than 1: light would come from nowhere");
                }
                check.range("exponent", *exponent, (1.0, MAX_EXPONENT));
            }
            Scattering::Conductor { eta, k, roughness } => {
                for (field, value) in [("eta", eta), ("k", k)] {
                    value.to_array().into_iter().for_each(|c| check.range(field, c, (0.0, MAX_METAL)));
                }
                check.range("roughness", *roughness, (0.0, 1.0));
            }
            Scattering::Dielectric { ior, roughness, transmittance } => {
                check.ior(*ior, IOR);
                check.range("roughness", *roughness, (0.0, 1.0));
                check.share("transmittance", *transmittance);
            }
            Scattering::Plastic { albedo, ior, roughness } => {
                self.tint("albedo", albedo, check);
                check.ior(*ior, (1.0, IOR.1));
                check.range("roughness", *roughness, (0.0, 1.0));
            }
            Scattering::Mirror { reflectance } => self.tint("reflectance", reflectance, check),
            Scattering::Mix { first, second, weight, image } => {
                check.index("first", first.0, self.materials.len());
                check.index("second", second.0, self.materials.len());
                check.range("weight", *weight, (0.0, 1.0));
                self.image(*image, "image", check);
                if self.mix_depth(index, 0) > MAX_MIX_DEPTH {
                    check.issue("first", format!("leads through more than {MAX_MIX_DEPTH} mixes, or back to itself"));
                }
            }
        }
        if let Some(EmissionDesc { radiance, image, .. }) = material.emission {
            check.light("radiance", radiance);
            self.image(image, "emission", check);
        }
        self.image(material.normal_map, "normal_map", check);
        if let Some(alpha) = material.alpha {
            self.image(Some(alpha.image), "alpha", check);
            check.range("threshold", alpha.threshold, (0.0, 1.0));
        }
    }

    /// Mixes on the longest way from a material to one that is none, as far as it matters.
    fn mix_depth(&self, index: usize, depth: usize) -> usize {
        match self.materials.get(index).map(|material| &material.scattering) {
            Some(Scattering::Mix { first, second, .. }) if depth <= MAX_MIX_DEPTH => {
                self.mix_depth(first.0 as usize, depth + 1).max(self.mix_depth(second.0 as usize, depth + 1))
            }
            _ => depth,
        }
    }

    fn tint(&self, field: &'static str, tint: &Tint, check: &mut Check) {
        check.share(field, tint.color);
        self.image(tint.image, field, check);
    }
}

fn camera(camera: &PhysicalCamera, check: &mut Check) {
    check.point("position", camera.position);
    check.frame(("direction", camera.direction), ("up", camera.up));
    match camera.view {
        View::Perspective { degrees } => check.range("degrees", degrees, (0.01, 179.0)),
        View::Orthographic { height } => check.length("height", height),
    }
    if camera.near != 0.0 {
        check.length("near", camera.near);
    }
    if camera.lens_radius != 0.0 {
        check.length("lens_radius", camera.lens_radius);
    }
    check.length("focus_distance", camera.focus_distance);
}

fn emitter(light: &EmitterDesc, check: &mut Check) {
    match light.kind {
        EmitterKind::Point { position, intensity } => {
            check.point("position", position);
            check.light("intensity", intensity);
        }
        EmitterKind::Spot { position, direction, intensity, inner_degrees, outer_degrees } => {
            check.point("position", position);
            check.direction("direction", direction);
            check.light("intensity", intensity);
            check.range("inner_degrees", inner_degrees, (0.0, 180.0));
            check.range("outer_degrees", outer_degrees, (inner_degrees, 180.0));
        }
        EmitterKind::Directional { direction, irradiance } => {
            check.direction("direction", direction);
            check.light("irradiance", irradiance);
        }
    }
}

impl Check {
    fn range(&mut self, field: &'static str, value: f32, (least, greatest): (f32, f32)) {
        if !(least..=greatest).contains(&value) {
            self.issue(field, format!("is {value}; expected a number from {least} to {greatest}"));
        }
    }

    fn angle(&mut self, field: &'static str, value: f32, greatest: f32) {
        self.range(field, value, (-greatest, greatest));
    }

    fn ior(&mut self, value: f32, range: (f32, f32)) {
        self.range("ior", value, range);
        if (value - 1.0).abs() < MIN_CONTRAST {
            self.issue("ior", format!("is {value}, so near to 1 that nothing is refracted"));
        }
    }

    /// A share of light per channel.
    fn share(&mut self, field: &'static str, value: Vec3) {
        if !value.to_array().iter().all(|c| (0.0..=1.0).contains(c)) {
            self.issue(field, format!("is {value}; expected three numbers from 0 to 1"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::{PhysicalObject, SurfaceId};
    use crate::{Location, MeshId};
    use glam::{DAffine3, DVec3};

    fn scene(scattering: Scattering) -> PhysicalScene {
        let material = SurfaceDesc { scattering, ..SurfaceDesc::default() };
        let shape = PhysicalShape::Sphere { center: DVec3::ZERO, radius: 1.0 };
        let object =
            PhysicalObject { name: String::new(), shape, material: SurfaceId(0), location: Location::default() };
        PhysicalScene { materials: vec![material], objects: vec![object], ..PhysicalScene::default() }
    }

    fn fields(scene: &PhysicalScene) -> Vec<&'static str> {
        scene.validate().iter().map(|issue| issue.field).collect()
    }

    #[test]
    fn a_sound_scene_has_no_issues() {
        assert_eq!(scene(Scattering::default()).validate(), []);
    }

    #[test]
    fn materials_that_make_light_are_refused() {
        let white: Tint = Vec3::ONE.into();
        let phong = Scattering::Phong { diffuse: white, specular: white, exponent: 0.0 };
        assert_eq!(fields(&scene(phong)), ["specular", "exponent"]);
        assert_eq!(fields(&scene(Scattering::Lambert { albedo: (Vec3::ONE * 1.5).into() })), ["albedo"]);
        let glass = Scattering::Dielectric { ior: 1.0, roughness: 2.0, transmittance: Vec3::ONE };
        assert_eq!(fields(&scene(glass)), ["ior", "roughness"]);
    }

    #[test]
    fn a_mix_of_itself_is_refused() {
        let mix = |first, second| Scattering::Mix {
            first: SurfaceId(first),
            second: SurfaceId(second),
            weight: 0.5,
            image: None,
        };
        assert_eq!(fields(&scene(mix(0, 0))), ["first"]);
        assert_eq!(fields(&scene(mix(7, 0))), ["first", "first"]);
        let mut sound = scene(mix(1, 2));
        sound.materials.extend([SurfaceDesc::default(), SurfaceDesc::default()]);
        assert_eq!(fields(&sound), [""; 0]);
    }

    #[test]
    fn flat_instances_and_bad_cameras_are_named() {
        let mut flat = scene(Scattering::default());
        flat.objects[0].shape = PhysicalShape::Mesh {
            mesh: MeshId(0),
            placement: DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0)),
            smooth: true,
            override_material: false,
        };
        flat.camera.view = View::Perspective { degrees: 180.0 };
        flat.camera.focus_distance = 0.0;
        assert_eq!(fields(&flat), ["degrees", "focus_distance", "mesh", "placement"]);
    }
}
