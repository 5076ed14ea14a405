"""Hits against closed forms, exact arithmetic and Embree; every accelerator, and any number of threads, alike."""

import unittest

import numpy as np

import skipgrid
from meshes import bumpy, rays_around, square

try:
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector
except ImportError:
    RayMeshIntersector = None

INF = np.float32(np.inf)


def exact_names():
    """Accelerators that can be built over triangles and promise exact answers."""
    return [e["name"] for e in skipgrid.accelerators() if e["exact"] and e["name"] != "voxels"]


class ClosedForms(unittest.TestCase):
    def test_a_square_is_hit_where_it_is(self):
        for name in exact_names():
            mesh = skipgrid.Accel(*square(), name)
            t, prim = mesh.closest_hit([[0.75, 0.25, 3, 0, 0, -1], [0.25, 0.75, -4, 0, 0, 2], [2, 0, 3, 0, 0, -1]])
            self.assertEqual((t.dtype, prim.dtype), (np.float32, np.uint32))
            self.assertEqual(t.tolist(), [3, 2, INF], name)
            self.assertEqual(prim.tolist(), [0, 1, skipgrid.MISS], name)
            # On the diagonal that both share: the first one.
            self.assertEqual(mesh.closest_hit([[0.5, 0.5, 1, 0, 0, -1]])[1].tolist(), [0], name)

    def test_ranges_have_both_ends(self):
        mesh = skipgrid.Accel(*square())
        ranges = [(0, 3), (3, 9), (3.1, 9), (0, 2.9), (-9, -1), (5, 1), (np.nan, 9), (-np.inf, np.inf)]
        rays = np.array([[0.75, 0.25, 3, low, 0, 0, -1, high] for low, high in ranges], np.float32)
        expected = [True, True, False, False, False, False, False, True]
        self.assertEqual(mesh.any_hit(rays).tolist(), expected)
        self.assertEqual((mesh.closest_hit(rays)[1] != skipgrid.MISS).tolist(), expected)

    def test_spheres_are_hit_from_outside_and_inside(self):
        balls = skipgrid.spheres([[0, 0, 0], [5, 0, 0], [0, 0, 0]], [1, 2, -1])
        t, prim = balls.closest_hit([[-3, 0, 0, 1, 0, 0], [0, 0, 0, 1, 0, 0], [5, 0, 0, 0, 0.5, 0], [0, 9, 0, 1, 0, 0]])
        self.assertEqual(t.tolist(), [2, 1, 4, INF])
        self.assertEqual(prim.tolist(), [0, 0, 1, skipgrid.MISS])
        self.assertEqual(balls.bounds.tolist(), [[-1, -2, -2], [7, 2, 2]])

    def test_what_is_not_finite_is_never_hit_and_keeps_its_index(self):
        vertices, faces = square()
        vertices = np.concatenate([vertices, [[np.nan, 0, 0]]]).astype(np.float32)
        mesh = skipgrid.Accel(vertices, [[0, 1, 4], *faces.tolist()])
        self.assertEqual(mesh.closest_hit([[0.75, 0.25, 3, 0, 0, -1]])[1].tolist(), [1])
        bad = np.array([[np.nan, 0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 0], [0.7, 0.2, 3, 0, 0, -np.inf]], np.float32)
        self.assertFalse(mesh.any_hit(bad).any())

    def test_nothing_hits_nothing(self):
        empty = skipgrid.Accel(np.zeros((0, 3)), np.zeros((0, 3), int))
        self.assertEqual(len(empty), 0)
        self.assertFalse(empty.any_hit([[0, 0, 0, 0, 0, 1]]).any())
        self.assertEqual(empty.bounds.tolist(), [[INF] * 3, [-INF] * 3])
        t, prim = skipgrid.Accel(*square()).closest_hit(np.zeros((0, 6)))
        self.assertEqual((t.shape, prim.shape), ((0,), (0,)))


class Alike(unittest.TestCase):
    def test_accelerators_threads_and_forms_of_rays_give_the_same_bits(self):
        vertices, faces = bumpy(20)
        origins, directions = rays_around(vertices, 5000)
        six = np.hstack([origins, directions])
        zeros, infs = np.zeros((len(six), 1), np.float32), np.full((len(six), 1), INF)
        eight = np.hstack([origins, zeros, directions, infs])
        t, prim = skipgrid.Accel(vertices, faces, "brute").closest_hit(six)
        self.assertGreater((prim != skipgrid.MISS).mean(), 0.4)
        for name in exact_names():
            mesh = skipgrid.Accel(vertices, faces, name, threads=2)
            for rays in [(six,), (eight,), (origins, directions)]:
                for threads in [None, 1, 3]:
                    ours = mesh.closest_hit(*rays, threads=threads)
                    self.assertEqual(ours[0].tobytes(), t.tobytes(), name)
                    self.assertEqual(ours[1].tobytes(), prim.tobytes(), name)
            self.assertEqual(mesh.any_hit(six, threads=2).tolist(), (prim != skipgrid.MISS).tolist(), name)

    def test_hits_are_those_of_exact_arithmetic(self):
        vertices, faces = bumpy(20)
        mesh = skipgrid.Accel(vertices, faces)
        rays = np.hstack(rays_around(vertices, 5000))
        (t, prim), (truth, exact) = mesh.closest_hit(rays), mesh.exact_hit(rays)
        self.assertEqual(truth.dtype, np.float64)
        self.assertEqual(prim.tobytes(), exact.tobytes())
        # The nearest f32; of f64 that are rounded twice half a unit and next to nothing.
        hit = prim != skipgrid.MISS
        self.assertLessEqual((np.abs(t[hit] - truth[hit]) / np.spacing(t[hit])).max(), 0.5 + 1e-6)

    def test_scenes_are_loaded(self):
        scene = skipgrid.load("bumpy:n=20", "grid-octant")
        mesh = skipgrid.Accel(scene.triangles.reshape(-1, 3), np.arange(3 * len(scene)).reshape(-1, 3))
        rays = np.hstack(rays_around(scene.triangles.reshape(-1, 3), 2000))
        for ours, theirs in zip(scene.closest_hit(rays), mesh.closest_hit(rays)):
            self.assertEqual(ours.tobytes(), theirs.tobytes())
        self.assertEqual(scene.bounds.tobytes(), mesh.bounds.tobytes())

    def test_scenes_of_every_kind_have_an_exact_truth(self):
        """Voxels, triangles with spheres, and triangles."""
        for name in ["voxel-terrain", "flakes", "cornell"]:
            scene = skipgrid.load(name)
            rays = np.hstack(rays_around(scene.bounds, 400))
            (t, prim), (truth, exact) = scene.closest_hit(rays), scene.exact_hit(rays)
            self.assertTrue(0.1 < (prim != skipgrid.MISS).mean() < 0.9, name)
            self.assertEqual(prim.tolist(), exact.tolist(), name)
            hit = prim != skipgrid.MISS
            self.assertLessEqual((np.abs(t[hit] - truth[hit]) / np.spacing(t[hit])).max(), 0.5 + 1e-6, name)


@unittest.skipIf(RayMeshIntersector is None, "trimesh and embreex are not installed")
class Embree(unittest.TestCase):
    def test_primitives_are_those_of_embree_or_embree_is_wrong(self):
        vertices, faces = bumpy(60)
        theirs = RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False), scale_to_box=False)
        mesh = skipgrid.Accel(vertices, faces)
        origins, directions = rays_around(vertices, 200_000)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        rays = np.hstack([origins, directions])
        prim = mesh.closest_hit(rays)[1].astype(np.int64)
        prim[prim == skipgrid.MISS] = -1
        embree = theirs.intersects_first(origins, directions)
        self.assertGreater((prim >= 0).mean(), 0.4)
        differ = np.flatnonzero(prim != embree)
        # Every other ray is aimed at a vertex, where six triangles are hit at times that f32 cannot tell apart.
        self.assertLess(np.count_nonzero(differ % 2), len(rays) // 1000)
        _, exact = mesh.exact_hit(rays[differ])
        exact = exact.astype(np.int64)
        exact[exact == skipgrid.MISS] = -1
        self.assertEqual(prim[differ].tolist(), exact.tolist(), "where Embree differs, exact arithmetic agrees with us")
        print(
            f"\n  of {len(rays) // 2} rays at random and {len(rays) // 2} towards vertices, {np.count_nonzero(differ % 2)} and "
            f"{np.count_nonzero(differ % 2 == 0)} have another primitive from Embree; exact arithmetic says ours"
        )


if __name__ == "__main__":
    unittest.main()
