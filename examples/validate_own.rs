//! A renderer of one's own, held against ours: here a dozen lines that know a ball, a floor and a lamp in closed form.
//!
//! The same goes for any program that writes EXR, PNG, PFM or HDR: `skipgrid validate --scene SCENE --theirs PICTURE`.

use glam::{DVec3, Vec3};
use skipgrid::picture::{Picture, io};
use skipgrid::render::Integrator;
use skipgrid::scene::{Bsdf, Camera, CameraSource, Light, Material, Mesh, Scene, SceneParts};
use skipgrid::validate::{self, Options, Theirs};
use skipgrid::{Result, Sphere};

const SIZE: u32 = 96;
const BALL: DVec3 = DVec3::new(0.0, 1.0, 0.0);
const LAMP: DVec3 = DVec3::new(2.0, 5.0, 3.0);
const EYE: DVec3 = DVec3::new(0.0, 3.0, 7.0);
/// Albedo of the ball and of the floor.
const BROWN: Vec3 = Vec3::new(0.7, 0.4, 0.2);
const GREY: Vec3 = Vec3::splat(0.5);

/// What the validator renders.
fn scene() -> Result<Scene> {
    let lambert = |name: &str, albedo| Material {
        name: name.into(),
        bsdf: Bsdf::Lambert { albedo, texture: None },
        emission: Vec3::ZERO,
    };
    let corner = |x: f32, z: f32| Vec3::new(50.0 * x, 0.0, 50.0 * z);
    Scene::new(SceneParts {
        name: "ball".into(),
        meshes: vec![Mesh {
            name: "floor".into(),
            positions: vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: vec![],
            uvs: vec![],
            material: 1,
        }],
        spheres: vec![(Sphere { centre: BALL.as_vec3(), radius: 1.0 }, 0)],
        materials: vec![lambert("ball", BROWN), lambert("floor", GREY)],
        lights: vec![Light::Point { position: LAMP, intensity: Vec3::splat(60.0) }],
        camera: Some(camera()),
        ..SceneParts::default()
    })
}

fn camera() -> Camera {
    Camera { origin: EYE, target: BALL, up: DVec3::Y, yfov: 40.0, source: CameraSource::File }
}

/// The renderer of one's own. Nothing of skipgrid's is in it but where the film is.
fn own_renderer(brown: Vec3) -> Picture {
    let mut picture = Picture::new(SIZE, SIZE);
    let ball = |from: DVec3, to: DVec3| {
        let (b, c) = ((from - BALL).dot(to), (from - BALL).length_squared() - 1.0);
        let root = (b * b - c).sqrt();
        (-b - root > 1e-6).then_some(-b - root)
    };
    for (i, pixel) in (0..).zip(&mut picture.pixels) {
        let (x, y) = (f64::from(i % SIZE) + 0.5, f64::from(i / SIZE) + 0.5);
        let direction = camera().direction(x, y, SIZE, SIZE);
        let floor = -EYE.y / direction.y;
        let (point, normal, albedo) = match ball(EYE, direction) {
            Some(t) => (EYE + t * direction, EYE + t * direction - BALL, brown),
            None if floor > 0.0 && (EYE + floor * direction).abs().max_element() < 50.0 => {
                (EYE + floor * direction, DVec3::Y, GREY)
            }
            None => continue,
        };
        let to_lamp = LAMP - point;
        let (distance, cosine) = (to_lamp.length(), normal.dot(to_lamp.normalize()));
        if cosine > 0.0 && ball(point + 1e-6 * normal, to_lamp / distance).is_none() {
            let light = 60.0 * cosine / (distance * distance) / std::f64::consts::PI;
            *pixel = (albedo * light as f32).to_array();
        }
    }
    picture
}

fn main() -> Result<()> {
    let scene = scene()?;
    let folder = std::env::temp_dir().join(format!("skipgrid-validate-own-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| skipgrid::Error::io(&folder, error))?;
    // As it should be, and with an albedo that is a hundredth too high.
    for (what, brown, expected) in [("right", BROWN, true), ("1 % too bright", BROWN * 1.01, false)] {
        let image = folder.join("own.exr");
        io::write(&image, &own_renderer(brown), &io::Attributes::default())?;
        let theirs = Theirs { images: vec![image], renders: 2, integrator: Integrator::Whitted, grid: 1, max_depth: 8 };
        let report = validate::against(&scene, &theirs, &["nested".into(), "grid".into()], &Options::default())?;
        println!("{what}: {}", report.summary());
        assert_eq!(report.passed(), expected, "{what}");
    }
    std::fs::remove_dir_all(&folder).map_err(|error| skipgrid::Error::io(&folder, error))
}
