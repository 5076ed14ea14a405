//! Frames of a deforming mesh: how long each structure takes to be ready again, and to trace one primary ray a pixel.
//!
//! `cargo bench --bench animation [-- SCENE..]`: scenes of triangles, files or made by formula, through which a wave runs. Times
//! are of the processor, of all threads together, medians of the frames after the first two; contenders take turns, frame by frame.
//! What they are given is copied and deformed outside the time. Embree and obvhs are used natively, with their own tests in f32.

mod arguments;
mod clock;

use arguments::arguments;
use clock::seconds;
use glam::Vec3;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::{BvhBuildParams, ray::RayHit, rt_triangle::RtTriangle, triangle::Triangle as Native};
use skipgrid::adapters::{embree, soup::Given};
use skipgrid::grid::{Grid, GridOptions};
use skipgrid::nested::{Nested, NestedOptions, Quality};
use skipgrid::scene::{LoadOptions, SceneGeometry, load};
use skipgrid::{Accel, Ray, Result, Triangle};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Duration;

/// A structure that is made ready for each frame.
trait Contender {
    /// Takes what it wants of the frame, outside the time.
    fn take(&mut self, frame: &Arc<Vec<Triangle>>) -> Result<()>;
    /// Makes itself ready.
    fn ready(&mut self) -> Result<()>;
    /// How many rays hit something.
    fn trace(&self, rays: &[Ray]) -> usize;
}

/// One of ours: built once, then in its own memory.
struct Ours<A> {
    next: Arc<Vec<Triangle>>,
    built: Option<A>,
    build: fn(Arc<Vec<Triangle>>) -> Result<A>,
    rebuild: fn(&mut A, Arc<Vec<Triangle>>) -> Result<()>,
}

impl<A: Accel> Contender for Ours<A> {
    fn take(&mut self, frame: &Arc<Vec<Triangle>>) -> Result<()> {
        self.next = frame.clone();
        Ok(())
    }
    fn ready(&mut self) -> Result<()> {
        let next = self.next.clone();
        match &mut self.built {
            Some(built) => (self.rebuild)(built, next)?,
            None => self.built = Some((self.build)(next)?),
        }
        Ok(())
    }
    fn trace(&self, rays: &[Ray]) -> usize {
        self.built.as_ref().map_or(0, |accel| hits(accel, rays))
    }
}

fn ours<A: Accel + 'static>(
    build: fn(Arc<Vec<Triangle>>) -> Result<A>,
    rebuild: fn(&mut A, Arc<Vec<Triangle>>) -> Result<()>,
) -> Box<dyn Contender> {
    Box::new(Ours { next: Arc::default(), built: None, build, rebuild })
}

/// Embree, built anew for each frame.
struct Embree {
    quality: embree::Quality,
    given: Option<Given>,
    built: Option<Box<dyn Accel>>,
}

impl Contender for Embree {
    fn take(&mut self, frame: &Arc<Vec<Triangle>>) -> Result<()> {
        self.given = Some(Given::of(&**frame)?);
        self.built = None;
        Ok(())
    }
    fn ready(&mut self) -> Result<()> {
        if let Some(given) = self.given.take() {
            let options = embree::Options { quality: self.quality, ..embree::Options::default() };
            self.built = Some(embree::embree(given, options)?);
        }
        Ok(())
    }
    fn trace(&self, rays: &[Ray]) -> usize {
        self.built.as_ref().map_or(0, |accel| hits(&**accel, rays))
    }
}

/// obvhs' two-wide tree: its fastest build for each frame, or one build and new boxes.
#[derive(Default)]
struct Obvhs {
    refit: bool,
    given: Vec<Native>,
    tree: Option<Bvh2>,
    leaves: Vec<RtTriangle>,
}

impl Contender for Obvhs {
    fn take(&mut self, frame: &Arc<Vec<Triangle>>) -> Result<()> {
        self.given = frame.iter().map(|&[a, b, c]| Native { v0: a.into(), v1: b.into(), v2: c.into() }).collect();
        Ok(())
    }
    fn ready(&mut self) -> Result<()> {
        let given = &self.given;
        match &mut self.tree {
            Some(tree) if self.refit => {
                tree.init_primitives_to_nodes_if_uninit();
                for node in tree.nodes.iter_mut().filter(|node| node.is_leaf()) {
                    let first = node.first_index as usize;
                    let prims = &tree.primitive_indices[first..first + node.prim_count as usize];
                    let boxes = prims.iter().map(|&prim| given[prim as usize].aabb());
                    node.set_aabb(boxes.reduce(|all, aabb| all.union(&aabb)).unwrap_or(obvhs::aabb::Aabb::empty()));
                }
                tree.refit_all();
            }
            tree => {
                let params = BvhBuildParams::fastest_build();
                *tree = Some(build_bvh2_from_tris(given, params, &mut Duration::default()));
            }
        }
        if let Some(tree) = &self.tree {
            self.leaves.clear();
            self.leaves.extend(tree.primitive_indices.iter().map(|&prim| RtTriangle::from(&given[prim as usize])));
        }
        Ok(())
    }
    fn trace(&self, rays: &[Ray]) -> usize {
        let Some(tree) = &self.tree else { return 0 };
        let one = |ray: &&Ray| {
            let (origin, direction) = (ray.origin.into(), ray.direction.into());
            let ray = obvhs::ray::Ray::new(origin, direction, ray.t_min, ray.t_max);
            tree.ray_traverse(ray, &mut RayHit::none(), |ray, leaf| self.leaves[leaf].intersect(ray))
        };
        rays.iter().filter(one).count()
    }
}

fn hits<A: Accel + ?Sized>(accel: &A, rays: &[Ray]) -> usize {
    rays.iter().filter(|ray| accel.closest_hit(ray).is_some()).count()
}

/// The mesh at a moment: every corner goes up and down by a fiftieth of the mesh, as does what is beside it.
fn wave(mesh: &[Triangle], low: Vec3, size: f32, moment: f32) -> Vec<Triangle> {
    let moved = |p: Vec3| {
        let at = (p - low) / size;
        p + Vec3::Y * (0.02 * size * (9.0 * at.x + 5.0 * at.z + moment).sin())
    };
    mesh.iter().map(|corners| corners.map(moved)).collect()
}

/// A ray for each pixel of a square picture, from in front and above.
fn rays(low: Vec3, high: Vec3, side: usize) -> Vec<Ray> {
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let origin = middle + size * Vec3::new(0.2, 0.4, 1.0).normalize();
    let forwards = (middle - origin).normalize();
    let right = forwards.cross(Vec3::Y).normalize();
    let up = right.cross(forwards);
    let at = |i: usize| 1.1 * ((i as f32 + 0.5) / side as f32 - 0.5);
    let pixel = |i: usize| Ray::new(origin, forwards + right * at(i % side) - up * at(i / side));
    (0..side * side).map(pixel).collect()
}

fn run(spec: &str, frames: usize, side: usize) -> Result<()> {
    let scene = load(spec, &LoadOptions::default())?;
    let SceneGeometry::Triangles(mesh) = &scene.geometry else {
        println!("{spec}: not of triangles");
        return Ok(());
    };
    let points = || mesh.iter().flatten().copied().filter(|p| p.is_finite());
    let (low, high) = (points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max));
    let rays = rays(low, high, side);
    let mut contenders: Vec<(&str, Box<dyn Contender>)> = vec![
        ("nested:quality=fast", ours(|next| Nested::build(next, &quality(Quality::Fast)), Nested::rebuild)),
        ("nested", ours(|next| Nested::build(next, &quality(Quality::Default)), Nested::rebuild)),
        ("grid", ours(|next| Grid::build(next, &GridOptions::default()), Grid::rebuild)),
        ("obvhs Bvh2 fastest", Box::new(Obvhs::default())),
        ("obvhs Bvh2 refitted", Box::new(Obvhs { refit: true, ..Obvhs::default() })),
    ];
    if embree::missing().is_none() {
        for (name, quality) in [("Embree low", embree::Quality::Low), ("Embree default", embree::Quality::Medium)] {
            contenders.push((name, Box::new(Embree { quality, given: None, built: None })));
        }
    }
    let mut times = vec![[Vec::new(), Vec::new(), Vec::new()]; contenders.len()];
    let mut found = vec![0; contenders.len()];
    for i in 0..frames + 2 {
        let frame = Arc::new(wave(mesh, low, (high - low).max_element(), 0.2 * i as f32));
        for turn in 0..contenders.len() {
            let which = (i + turn) % contenders.len();
            let contender = &mut contenders[which].1;
            contender.take(&frame)?;
            let begin = seconds();
            contender.ready()?;
            let middle = seconds();
            found[which] = contender.trace(&rays);
            let end = seconds();
            if i >= 2 {
                let spans = [middle - begin, end - middle, end - begin];
                times[which].iter_mut().zip(spans).for_each(|(times, span)| times.push(span * 1e3));
            }
        }
    }
    println!("\n{spec}, {} triangles, {} rays; milliseconds a frame", mesh.len(), rays.len());
    println!("structure\tready\ttrace\tframe\tframes a second\thits");
    for (((name, _), times), found) in contenders.iter().zip(&mut times).zip(found) {
        let [ready, trace, frame] = times.each_mut().map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        println!("{name}\t{ready:.2}\t{trace:.2}\t{frame:.2}\t{:.1}\t{found}", 1e3 / frame);
    }
    Ok(())
}

fn quality(quality: Quality) -> NestedOptions {
    NestedOptions { quality, ..NestedOptions::default() }
}

fn main() -> ExitCode {
    let (bench, mut scenes) = arguments();
    if scenes.is_empty() {
        scenes = if bench { vec!["bumpy:n=200".into(), "spd-tetra:n=8".into()] } else { vec!["bumpy:n=8".into()] };
    }
    let (frames, side) = if bench { (15, 256) } else { (1, 8) };
    for scene in &scenes {
        if let Err(error) = run(scene, frames, side) {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}
