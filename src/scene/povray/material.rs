//! Materials in POV-Ray's language: textures with their pigment, finish and emission.

use crate::error::Result;
use crate::scene::export::{Assets, ExportSettings, Number, Triple, at_origin, plain};
use crate::scene::{Bsdf, Filter, Material, Scene};
use glam::Vec3;

/// The least albedo of an emissive surface: its emission is written as a multiple of its pigment.
const LEAST_PIGMENT: f32 = 1e-6;

/// A material as POV-Ray text.
pub(super) struct Declared {
    /// Declarations of the identifiers that `plain` and `textured` use.
    pub text: String,
    /// Modifiers of an object without texture coordinates.
    pub plain: String,
    /// Modifiers of an object with texture coordinates.
    pub textured: String,
    /// Blocks light although rays pass through it.
    pub glass: bool,
    /// What POV-Ray cannot show as we do, one sentence each.
    pub warnings: Vec<String>,
}

impl Declared {
    /// The material of that index; its texture is written to `assets`.
    pub fn new(
        scene: &Scene,
        index: usize,
        material: &Material,
        settings: &ExportSettings,
        assets: &mut Assets,
    ) -> Result<Self> {
        let mut this = Self {
            text: format!("// {}\n", plain(&material.name)),
            plain: format!("texture {{ Material{index} }}"),
            textured: String::new(),
            glass: false,
            warnings: Vec::new(),
        };
        let name = &material.name;
        let emits = material.emission.max_element() > 0.0;
        if emits {
            this.warnings.push(match settings.lamp_grid {
                0 => format!(
                    "material `{name}` emits: POV-Ray shows it but it lights nothing, as in the Whitted integrator"
                ),
                n => {
                    format!("material `{name}` emits: {n} x {n} spots for each triangle stand for its light in POV-Ray")
                }
            });
        }
        match &material.bsdf {
            Bsdf::Lambert { albedo, texture } => {
                let map = texture.and_then(|t| Some((t, scene.textures.get(t as usize)?)));
                let uniform = map.map_or(*albedo, |(_, t)| *albedo * at_origin(t));
                this.declare(index, uniform, "diffuse 1", material.emission);
                if let Some((t, texture)) = map {
                    let file = assets.texture(scene, t, *albedo)?;
                    let gamma = if file.srgb { "srgb" } else { "1.0" };
                    let filter = if texture.filter == Filter::Bilinear { " interpolate 2" } else { "" };
                    this.text += &format!(
                        "#declare Material{index}Map = texture {{ uv_mapping pigment {{ image_map {{ png \"{}\" gamma \
                         {gamma}{filter} }} }} finish {{ ambient 0 diffuse 1 }} }}\n",
                        file.name
                    );
                    this.textured = format!("texture {{ Material{index}Map }}");
                    if emits {
                        this.warnings.push(format!(
                            "material `{name}` has both a texture and emission: POV-Ray shows the texture alone"
                        ));
                    }
                }
            }
            Bsdf::Mirror { reflectance } => this.mirror(index, *reflectance, material.emission),
            Bsdf::Dielectric { ior } => {
                this.glass = true;
                this.text += &format!(
                    "#declare Material{index} = texture {{ pigment {{ rgbt <1, 1, 1, 1> }} finish {{ ambient 0 diffuse 0 \
                     reflection {{ 0, 1 fresnel on }} conserve_energy }} }}\n"
                );
                this.plain = format!("texture {{ Material{index} }} interior {{ ior {} }}", Number(f64::from(*ior)));
                if emits {
                    this.warnings.push(format!("material `{name}`: POV-Ray's glass does not emit"));
                }
            }
            Bsdf::Conductor { eta, k, reflectance, .. } => {
                this.warnings.push(format!(
                    "material `{name}` is a rough conductor: POV-Ray has no GGX, a mirror stands for it"
                ));
                this.mirror(index, *reflectance * head_on(*eta, *k), material.emission);
            }
        }
        if this.textured.is_empty() {
            this.textured.clone_from(&this.plain);
        }
        Ok(this)
    }

    fn mirror(&mut self, index: usize, reflectance: Vec3, emission: Vec3) {
        let finish = format!("diffuse 0 reflection {{ rgb <{}> }}", Triple::from(reflectance));
        self.declare(index, Vec3::ZERO, &finish, emission);
    }

    /// Declares `Material{index}`; emission, if any, is seen from the front side alone.
    fn declare(&mut self, index: usize, pigment: Vec3, finish: &str, emission: Vec3) {
        let texture = |name: &str, pigment: Vec3, emission: &str| {
            let pigment = Triple::from(pigment);
            format!(
                "#declare {name} = texture {{ pigment {{ rgb <{pigment}> }} finish {{ ambient 0{emission} {finish} }} }}\n"
            )
        };
        let name = format!("Material{index}");
        if emission.max_element() <= 0.0 {
            self.text += &texture(&name, pigment, "");
            return;
        }
        let bright = pigment.max(Vec3::splat(LEAST_PIGMENT));
        let factor = Triple(emission.as_dvec3() / bright.as_dvec3());
        self.text += &texture(&name, bright, &format!(" emission rgb <{factor}>"));
        self.text += &texture(&format!("{name}Back"), pigment, "");
        self.plain += &format!(" interior_texture {{ {name}Back }}");
    }
}

/// Reflected share at normal incidence of a conductor in vacuum.
fn head_on(eta: Vec3, k: Vec3) -> Vec3 {
    let k2 = k * k;
    let (below, above) = (eta - 1.0, eta + 1.0);
    (below * below + k2) / (above * above + k2)
}
