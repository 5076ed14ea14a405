//! rpt over its own kd-tree and over accelerators of skipgrid: speed in interleaved rounds, and pictures with their noise.
//!
//! `cargo run --release -p skipgrid-rpt --example compare -- [SCENE] [--pictures FOLDER]`; the scene is a file or a formula.

use glam::Vec3;
use rand::{Rng, SeedableRng, rngs::StdRng};
use rpt::image::RgbImage;
use rpt::{Camera, HitRecord, Light, Material, Mesh, Object, Ray, Renderer, Scene, SceneAdd, Shape, Triangle, glm};
use skipgrid::scene::{LoadOptions, load};
use skipgrid::{Accel, registry};
use skipgrid_rpt::Accelerated;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

const RAYS: usize = 200_000;
const ROUNDS: usize = 7;
const SPECS: [&str; 4] = ["nested", "grid-octant", "obvhs-cwbvh", "obvhs-bvh2"];

/// A shape with its name and the milliseconds that its build took.
type Contender = (&'static str, f64, Arc<dyn Shape>);

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (mut scene, mut folder) = ("bumpy".to_string(), None);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), arguments.len()) {
            ("--pictures", 1..) => folder = arguments.next().map(PathBuf::from),
            (name, _) if !name.starts_with('-') => scene = argument,
            (other, _) => {
                eprintln!("error: `{other}` is not understood; arguments are [SCENE] [--pictures FOLDER]");
                return ExitCode::from(2);
            }
        }
    }
    match compare(&scene, folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn compare(scene: &str, folder: Option<PathBuf>) -> skipgrid::Result<()> {
    let corners = corners(scene)?;
    let double = |v: Vec3| glm::vec3(v.x.into(), v.y.into(), v.z.into());
    let list: Vec<Triangle> =
        corners.iter().map(|t| Triangle::from_vertices(double(t[0]), double(t[1]), double(t[2]))).collect();

    let start = Instant::now();
    let tree: Arc<dyn Shape> = Arc::new(Mesh::new(list.clone()));
    let mut shapes: Vec<Contender> = vec![("rpt's kd-tree", start.elapsed().as_secs_f64() * 1e3, tree)];
    for spec in SPECS {
        let start = Instant::now();
        let mesh = Accelerated::new(list.clone(), spec)?;
        shapes.push((spec, start.elapsed().as_secs_f64() * 1e3, Arc::new(mesh)));
    }

    let rays = rays(&corners);
    println!("{scene}: {} triangles, {} rays, {ROUNDS} interleaved rounds on one thread", list.len(), rays.len());
    speed(&shapes, &rays);
    holes(&corners, &shapes[0].2, &rays)?;
    pictures(&corners, &shapes[..2], folder)
}

/// Triangles that have an area: rpt gives the others normals that are no numbers.
fn corners(scene: &str) -> skipgrid::Result<Vec<[Vec3; 3]>> {
    let scene = load(scene, &LoadOptions::default())?;
    let all = scene.meshes.iter().flat_map(|m| m.triangles.iter().map(|t| t.map(|i| m.positions[i as usize])));
    let corners: Vec<_> = all.filter(|[a, b, c]| (b - a).as_dvec3().cross((c - a).as_dvec3()).length() > 0.0).collect();
    if corners.is_empty() {
        return Err(skipgrid::Error::Invalid { cause: format!("{}: no triangle with an area", scene.name) });
    }
    Ok(corners)
}

/// Half of them from around the mesh to a point of it, half from such a point into a random direction.
fn rays(corners: &[[Vec3; 3]]) -> Vec<skipgrid::Ray> {
    let mut random = StdRng::seed_from_u64(1);
    let (low, high) = bounds(corners);
    let mut unit = move || Vec3::from(random.r#gen::<[f32; 3]>());
    let ray = |i: usize| {
        let [a, b, c] = corners[(unit().x * corners.len() as f32) as usize % corners.len()];
        let (weights, other) = (unit(), unit());
        let point = (a * weights.x + b * weights.y + c * weights.z) / weights.element_sum();
        let around = low + (other * 3.0 - 1.0) * (high - low);
        let (origin, direction) =
            if i.is_multiple_of(2) { (around, point - around) } else { (point, other * 2.0 - 1.0) };
        skipgrid::Ray::new(origin, direction).with_range(1e-12, f32::INFINITY)
    };
    (0..RAYS).map(ray).collect()
}

fn bounds(corners: &[[Vec3; 3]]) -> (Vec3, Vec3) {
    let ends = |(low, high): (Vec3, Vec3), &p: &Vec3| (low.min(p), high.max(p));
    corners.iter().flatten().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), ends)
}

fn time(shape: &dyn Shape, ray: &skipgrid::Ray) -> f64 {
    let double = |v: Vec3| glm::vec3(v.x.into(), v.y.into(), v.z.into());
    let mut record = HitRecord::new();
    shape.intersect(&Ray { origin: double(ray.origin), dir: double(ray.direction) }, 1e-12, &mut record);
    record.time
}

fn speed(shapes: &[Contender], rays: &[skipgrid::Ray]) {
    let mut seconds = vec![Vec::new(); shapes.len()];
    let mut times = vec![Vec::new(); shapes.len()];
    for round in 0..ROUNDS {
        for turn in 0..shapes.len() {
            let i = (round + turn) % shapes.len();
            let start = Instant::now();
            times[i] = rays.iter().map(|ray| time(&*shapes[i].2, ray)).collect();
            seconds[i].push(start.elapsed().as_secs_f64());
        }
    }
    println!("{:14} {:>9} {:>8} {:>25} {:>15}", "", "build ms", "Mrays/s", "as fast as the kd-tree", "times differ");
    for i in 0..shapes.len() {
        let mut rates: Vec<f64> = seconds[i].iter().map(|s| RAYS as f64 / s / 1e6).collect();
        let mut ratios: Vec<f64> = seconds[0].iter().zip(&seconds[i]).map(|(theirs, ours)| theirs / ours).collect();
        rates.sort_by(f64::total_cmp);
        ratios.sort_by(f64::total_cmp);
        let ratio = format!("{:.2} ({:.2} to {:.2})", ratios[ROUNDS / 2], ratios[0], ratios[ROUNDS - 1]);
        let differ = times[i].iter().zip(&times[0]).filter(|(ours, theirs)| ours != theirs).count();
        println!("{:14} {:9.1} {:8.3} {ratio:>25} {differ:>15}", shapes[i].0, shapes[i].1, rates[ROUNDS / 2]);
    }
}

/// What rpt's triangle test, which rounds, gets wrong of the same rays, whatever the accelerator.
fn holes(corners: &[[Vec3; 3]], tree: &Arc<dyn Shape>, rays: &[skipgrid::Ray]) -> skipgrid::Result<()> {
    let exact = registry::build("nested", corners.to_vec())?;
    let (mut through, mut beside) = (0, 0);
    for ray in rays {
        match (exact.closest_hit(ray), time(&**tree, ray).is_finite()) {
            (Some(_), false) => through += 1,
            (None, true) => beside += 1,
            _ => {}
        }
    }
    println!(
        "rpt's test of triangles lets {through} rays through that hit something exactly, and stops {beside} that do not"
    );
    Ok(())
}

/// The same scene over the kd-tree and over the plug, each rendered twice: rpt cannot be seeded, so noise is compared with noise.
fn pictures(corners: &[[Vec3; 3]], shapes: &[Contender], folder: Option<PathBuf>) -> skipgrid::Result<()> {
    let (low, high) = bounds(corners);
    let (middle, size) = ((low + high) / 2.0, f64::from((high - low).max_element()));
    let middle = glm::vec3(middle.x.into(), middle.y.into(), middle.z.into());
    let mut renders: Vec<(String, RgbImage, f64)> = Vec::new();
    for copy in 1..=2 {
        for (name, _, shape) in shapes {
            let mut scene = Scene::new();
            scene.add(Object::new(Arc::clone(shape)).material(Material::diffuse(rpt::hex_color(0xBB_AA88))));
            let floor = rpt::plane(glm::vec3(0.0, 1.0, 0.0), f64::from(low.y));
            scene.add(Object::new(floor).material(Material::diffuse(rpt::hex_color(0x88_8888))));
            let above = middle + glm::vec3(1.5, 2.5, 1.5) * size;
            scene.add(Light::Point(glm::vec3(60.0, 60.0, 60.0) * size * size, above));
            let eye = middle + glm::vec3(0.5, 0.6, 2.0) * size;
            let camera = Camera::look_at(eye, middle, glm::vec3(0.0, 1.0, 0.0), 0.8);
            let renderer = Renderer::new(&scene, camera).width(240).height(180).max_bounces(3).num_samples(16);
            let start = Instant::now();
            renders.push((format!("{name} {copy}"), renderer.render(), start.elapsed().as_secs_f64()));
        }
    }
    for (name, _, seconds) in &renders {
        println!("{name:16} 240 x 180, 16 samples: {seconds:.2} s");
    }
    let [theirs, ours, theirs2, ours2] = [0, 1, 2, 3].map(|i| &renders[i].1);
    for (what, a, b) in
        [("kd-tree to kd-tree", theirs, theirs2), ("plug to plug", ours, ours2), ("kd-tree to plug", theirs, ours)]
    {
        let differences = || a.as_raw().iter().zip(b.as_raw()).map(|(&a, &b)| f64::from(a) - f64::from(b));
        let (count, mean) = (a.as_raw().len() as f64, differences().sum::<f64>() / a.as_raw().len() as f64);
        let rmse = (differences().map(|d| d * d).sum::<f64>() / count).sqrt();
        // Channels of a pixel share its noise.
        println!("{what}: RMSE {rmse:.3} of 255, mean difference {mean:+.4} +- {:.4}", rmse / (count / 3.0).sqrt());
    }
    let Some(folder) = folder else { return Ok(()) };
    for (name, picture, _) in &renders {
        let path = folder.join(format!("{}.png", name.replace([' ', '\''], "-")));
        picture.save(&path).map_err(|error| skipgrid::Error::io(&path, std::io::Error::other(error)))?;
    }
    Ok(())
}
