//! A bumpy ball on a floor in rust-pathtracer, over an accelerator of choice; every answer is held against brute force.
//!
//! `cargo run --release -p skipgrid-rust-pathtracer --example render -- [ACCEL] [PICTURE.png]`

use glam::Vec3;
use rust_pathtracer::prelude::{
    AnalyticalLight, Camera3D, ColorBuffer, F, F3, LightSampleRec, Material, Pinhole, Ray, Scene, State, Tracer,
};
use skipgrid::picture::{Picture, io};
use skipgrid::scene::{LoadOptions, load};
use skipgrid::{Result, Triangle};
use skipgrid_rust_pathtracer::MeshScene;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (spec, path) = (arguments.next().unwrap_or("nested".into()), arguments.next());
    match render(&spec, path.as_deref()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(_) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

/// The number of answers that differ from those of brute force.
fn render(spec: &str, path: Option<&str>) -> Result<u64> {
    let triangles = triangles()?;
    let twins = Twins { fast: scene(spec, &triangles)?, brute: scene("brute", &triangles)?, counts: Arc::default() };
    let counts = Arc::clone(&twins.counts);
    let mut picture = ColorBuffer::new(160, 120);
    let mut tracer = Tracer::new(Box::new(twins));
    (0..8).for_each(|_| tracer.render(&mut picture));

    let [closest, any, differ] = [0, 1, 2].map(|i| counts[i].load(Relaxed));
    println!("{spec}, {} triangles: {closest} closest hits, {any} any hits; {differ} answers differ", triangles.len());
    if let Some(path) = path {
        let mut out = Picture::new(picture.width as u32, picture.height as u32);
        let pixels = picture.pixels.chunks_exact(4);
        out.pixels.iter_mut().zip(pixels).for_each(|(out, pixel)| out.copy_from_slice(&pixel[..3]));
        io::write(path, &out, &io::Attributes::default())?;
    }
    Ok(differ)
}

/// A ball with bumps, and two triangles of floor at the end.
fn triangles() -> Result<Vec<Triangle>> {
    let scene = load("bumpy:n=12", &LoadOptions::default())?;
    let ball = scene.meshes.iter().flat_map(|m| m.triangles.iter().map(|t| t.map(|i| m.positions[i as usize])));
    let corner = |x: f32, z: f32| Vec3::new(x, -1.1, z);
    let [a, b, c, d] = [corner(-9.0, -9.0), corner(-9.0, 9.0), corner(9.0, 9.0), corner(9.0, -9.0)];
    let floor = [[a, b, c], [a, c, d]];
    Ok(ball.chain(floor).collect())
}

fn scene(spec: &str, triangles: &[Triangle]) -> Result<MeshScene> {
    let floor = triangles.len() as u32 - 2;
    let material = move |prim: u32| match prim < floor {
        true => Material { rgb: F3::new(0.9, 0.5, 0.3), roughness: 0.2, ..Material::new() },
        false => Material { rgb: F3::new(0.6, 0.6, 0.6), ..Material::new() },
    };
    let mut camera = Pinhole::new();
    camera.set(F3::new(1.0, 1.0, 3.0), F3::new(0.0, -0.1, 0.0));
    camera.set_fov(60.0);
    Ok(MeshScene::build(spec, triangles.to_vec(), material)?
        .with_light(AnalyticalLight::spherical(F3::new(3.0, 4.0, 2.0), 0.7, F3::new(20.0, 20.0, 20.0)))
        .with_background(F3::new(0.3, 0.35, 0.4))
        .with_camera(camera))
}

/// A scene over two accelerators, which compares all answers.
struct Twins {
    fast: MeshScene,
    brute: MeshScene,
    /// Questions for the closest hit, for any, and answers that differ.
    counts: Arc<[AtomicU64; 3]>,
}

impl Twins {
    fn count(&self, question: usize, differ: bool) {
        self.counts[question].fetch_add(1, Relaxed);
        self.counts[2].fetch_add(u64::from(differ), Relaxed);
    }
}

impl Scene for Twins {
    fn new() -> Self {
        Self { fast: MeshScene::new(), brute: MeshScene::new(), counts: Arc::default() }
    }

    fn background(&self, ray: &Ray) -> F3 {
        self.fast.background(ray)
    }

    fn closest_hit(&self, ray: &Ray, state: &mut State, light: &mut LightSampleRec) -> bool {
        let (mut brute_state, mut brute_light) = (state.clone(), light.clone());
        let hit = self.fast.closest_hit(ray, state, light);
        let brute_hit = self.brute.closest_hit(ray, &mut brute_state, &mut brute_light);
        let seen = |hit: bool, state: &State| (hit, state.hit_dist.to_bits(), state.normal, state.material.rgb);
        self.count(0, seen(hit, state) != seen(brute_hit, &brute_state) || *light != brute_light);
        hit
    }

    fn any_hit(&self, ray: &Ray, max_dist: F) -> bool {
        let hit = self.fast.any_hit(ray, max_dist);
        self.count(1, hit != self.brute.any_hit(ray, max_dist));
        hit
    }

    fn camera(&self) -> &Box<dyn Camera3D> {
        self.fast.camera()
    }

    fn number_of_lights(&self) -> usize {
        self.fast.number_of_lights()
    }

    fn light_at(&self, index: usize) -> &AnalyticalLight {
        self.fast.light_at(index)
    }

    fn as_any(&mut self) -> &mut dyn std::any::Any {
        self
    }
}
