//! The voxels that a ray visits: where it enters and leaves each, and through which face.

use glam::Vec3;
use skipgrid::grid::VoxelGrid;
use skipgrid::{Aabb, Ray};

fn main() -> skipgrid::Result<()> {
    // A room of 8 x 4 x 2 voxels of edge 0.5, seen from outside.
    let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(4.0, 2.0, 1.0) };
    let grid = VoxelGrid::new(bounds, [8, 4, 2])?;
    let ray = Ray::new(Vec3::new(-1.0, 1.8, 0.15), Vec3::new(1.0, -0.3, 0.2));

    let mut length = 0.0;
    for visit in grid.voxels(&ray) {
        let face = visit.face.map_or("starts here".into(), |face| format!("through {face:?}"));
        println!("{:?} from t = {:.4} to {:.4}, {face}", visit.voxel, visit.entry, visit.exit);
        length += visit.exit - visit.entry;
    }
    println!("{length:.4} of t in the box");

    // The first voxel beyond x = 2 that a shorter ray reaches: an iterator stops where its user does.
    let beyond = grid.voxels(&ray.with_range(0.0, 4.5)).find(|visit| visit.voxel[0] >= 4);
    println!("{beyond:?}");
    assert_eq!(beyond.map(|visit| visit.entry), Some(3.0));

    // Corner to corner every third voxel is met in more than a point; the others lead from face to face.
    let diagonal = Ray::new(Vec3::splat(-1.0), Vec3::ONE);
    let cube = VoxelGrid::new(Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [4; 3])?;
    let (crossed, touched): (Vec<_>, Vec<_>) = cube.voxels(&diagonal).partition(|visit| visit.exit > visit.entry);
    println!("{} voxels crossed, {} touched", crossed.len(), touched.len());
    assert_eq!((crossed.len(), touched.len()), (4, 6));
    Ok(())
}
