"""Arrays of other kinds, and what is refused with which words."""

import os
import tempfile
import unittest

import numpy as np

import skipgrid
from meshes import bumpy, rays_around, square


class Kinds(unittest.TestCase):
    def setUp(self):
        vertices, faces = bumpy(12)
        self.vertices, self.faces = vertices, faces
        self.mesh = skipgrid.Accel(vertices, faces)
        self.rays = np.hstack(rays_around(vertices, 1000))
        self.hits = [a.tobytes() for a in self.mesh.closest_hit(self.rays)]

    def same(self, mesh, *rays):
        self.assertEqual([a.tobytes() for a in mesh.closest_hit(*rays)], self.hits)

    def test_rays_of_every_layout_and_type(self):
        rays = self.rays
        wide = np.zeros((1000, 12), np.float32)
        wide[:, ::2] = rays
        odd = np.frombuffer(b"x" + rays.tobytes(), np.float32, offset=1).reshape(-1, 6)
        self.assertFalse(odd.flags.aligned)
        read_only = rays.copy()
        read_only.flags.writeable = False
        for other in [
            rays.astype(np.float64),
            rays.astype(">f4"),
            np.asfortranarray(rays),
            wide[:, ::2],
            odd,
            read_only,
            rays.tolist(),
        ]:
            self.same(self.mesh, other)
        self.same(self.mesh, rays[:, :3], rays[:, 3:])
        self.same(self.mesh, rays[:, :3].astype(np.float64), np.asfortranarray(rays[:, 3:]))

    def test_meshes_of_every_layout_and_type(self):
        for dtype in [np.int32, np.int64, np.uint32, np.uint64, np.uint16, ">i4"]:
            self.same(skipgrid.Accel(self.vertices, self.faces.astype(dtype)), self.rays)
        self.same(skipgrid.Accel(self.vertices.astype(np.float64), np.asfortranarray(self.faces)), self.rays)
        self.same(skipgrid.Accel(self.vertices.tolist(), self.faces.tolist()), self.rays)

    def test_whole_numbers_and_halves_are_numbers(self):
        mesh = skipgrid.Accel(square()[0].astype(np.int8), square()[1])
        for dtype in [np.int64, np.float16]:
            rays = np.array([[0, 0, 2, 0, 0, -1]], dtype)
            self.assertEqual(mesh.closest_hit(rays)[0].tolist(), [2])

    def test_later_changes_of_the_mesh_change_nothing(self):
        self.vertices[:] = 0
        self.faces[:] = 0
        self.same(self.mesh, self.rays)


class Refused(unittest.TestCase):
    def refused(self, words, call, *arguments, error=ValueError, **options):
        with self.assertRaises(error) as caught:
            call(*arguments, **options)
        for word in words:
            self.assertIn(word, str(caught.exception))
        return caught.exception

    def test_shapes_and_types(self):
        mesh, (vertices, faces) = skipgrid.Accel(*square()), square()
        refused = self.refused
        refused(["rays", "(4,)", "float64", "(n, 6)", "(n, 8)"], mesh.closest_hit, np.zeros(4))
        refused(["(2, 7)", "float32"], mesh.any_hit, np.zeros((2, 7), np.float32))
        refused(["(2, 6)", "complex128"], mesh.statistics, np.zeros((2, 6), complex))
        refused(["(1, 6)", "bool"], mesh.closest_hit, np.zeros((1, 6), bool))
        refused(["object"], mesh.closest_hit, [[None] * 6])
        refused(["<U1"], mesh.closest_hit, [list("abcdef")])
        refused(["origins", "(2, 6)", "(n, 3)"], mesh.closest_hit, np.zeros((2, 6)), np.zeros((2, 3)))
        refused(["directions", "(2,)"], mesh.closest_hit, np.zeros((2, 3)), np.zeros(2))
        refused(["2 origins and 3 directions"], mesh.closest_hit, np.zeros((2, 3)), np.zeros((3, 3)))
        refused(["vertices", "(4, 2)", "float32"], skipgrid.Accel, vertices[:, :2], faces)
        refused(["faces", "(2, 3)", "float64", "whole"], skipgrid.Accel, vertices, faces.astype(float))
        refused(["faces", "(6,)"], skipgrid.Accel, vertices, faces.ravel())
        refused(["3 centres and 2 radii"], skipgrid.spheres, np.zeros((3, 3)), [1, 2])
        refused(["radii", "(1, 2)"], skipgrid.spheres, np.zeros((2, 3)), [[1, 2]])
        refused(["argument"], mesh.closest_hit, error=TypeError)

    def test_faces_name_vertices(self):
        vertices, _ = square()
        self.refused(["face 1 refers to vertex 4 of 4"], skipgrid.Accel, vertices, [[0, 1, 2], [0, 4, 1]])
        self.refused(["face 0 refers to vertex -1 of 4"], skipgrid.Accel, vertices, [[0, 1, -1]])

    def test_names_options_and_threads(self):
        mesh, (vertices, faces) = skipgrid.Accel(*square()), square()
        self.refused(["netsed", "did you mean `nested`"], skipgrid.Accel, vertices, faces, "netsed")
        self.refused(["density", "`x`"], skipgrid.Accel, vertices, faces, "grid:density=x")
        self.refused(["voxels"], skipgrid.Accel, vertices, faces, accel="voxels")
        self.refused(["bytes"], skipgrid.Accel, vertices, faces, "grid:resolution=4096", error=MemoryError)
        for threads in [0, 5000]:
            self.refused([f"threads: {threads}", "1 to 1024"], mesh.any_hit, np.zeros((1, 6)), threads=threads)
        self.refused([], mesh.any_hit, np.zeros((1, 6)), threads=-1, error=OverflowError)

    def test_files(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = os.path.join(folder, "none.obj")
            error = self.refused(["none.obj"], skipgrid.load, missing, error=FileNotFoundError)
            self.assertEqual((error.errno, error.filename), (2, missing))
            bad = os.path.join(folder, "bad.obj")
            with open(bad, "w") as file:
                file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n")
            self.refused([bad, "line 4"], skipgrid.load, bad)
            with open(bad, "w") as file:
                file.write("v 0 0 0\nv 1 0 0\nv nan 1 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n")
            self.refused([bad], skipgrid.load, bad)
            with self.assertWarnsRegex(UserWarning, "bad.obj"):
                self.assertEqual(len(skipgrid.load(bad, drop_invalid=True)), 1)
        self.refused(["did you mean `bumpy`"], skipgrid.load, "bumby")
        self.refused(["patches"], skipgrid.load("teapot-patches", "grid").exact_hit, [[0, 0, 9, 0, 0, -1]])
        self.refused(["not all"], lambda: skipgrid.load("flakes").triangles)


class Facts(unittest.TestCase):
    def test_what_an_accelerator_says_of_itself(self):
        vertices, faces = bumpy(12)
        mesh = skipgrid.Accel(vertices, faces, "grid:resolution=8")
        self.assertEqual((len(mesh), mesh.accel), (len(faces), "grid:resolution=8"))
        self.assertIn("8 x 8 x 8", mesh.describe())
        self.assertIn("grid:resolution=8", repr(mesh))
        self.assertEqual(mesh.bounds.tolist(), [vertices.min(0).tolist(), vertices.max(0).tolist()])
        self.assertEqual(mesh.triangles.tobytes(), vertices[faces].tobytes())
        memory = mesh.memory
        self.assertEqual(memory["total"], memory["structure"] + memory["references"] + memory["tables"])
        self.assertGreaterEqual(memory["total"], 4 * 8**3)

    def test_counts(self):
        vertices, faces = bumpy(12)
        brute, grid = skipgrid.Accel(vertices, faces, "brute"), skipgrid.Accel(vertices, faces, "grid")
        origins, directions = rays_around(vertices, 500)
        counts = brute.statistics(origins, directions)
        self.assertEqual((counts["rays"], counts["tests"]), (500, 500 * len(faces)))
        for threads in [1, 2]:
            counts = grid.statistics(origins, directions, threads=threads)
            self.assertEqual(counts, grid.statistics(origins, directions))
            self.assertLess(counts["tests"], 500 * len(faces) / 10)
            self.assertGreater(counts["steps"], 0)
        self.assertLess(brute.statistics(origins, directions, any=True)["tests"], 500 * len(faces))

    def test_accelerators_have_names_and_summaries(self):
        entries = {entry["name"]: entry for entry in skipgrid.accelerators()}
        self.assertIn("density", entries["grid"]["options"])
        self.assertTrue(entries["nested"]["exact"] and entries["nested"]["missing"] is None)
        self.assertTrue(all(entry["summary"] and entry["source"] for entry in entries.values()))

    def test_everything_is_documented(self):
        for name in skipgrid.__all__:
            thing = getattr(skipgrid, name)
            if callable(thing):
                self.assertTrue(thing.__doc__, name)
        for name in ["closest_hit", "any_hit", "exact_hit", "statistics", "describe", "bounds", "memory", "triangles"]:
            self.assertTrue(getattr(skipgrid.Accel, name).__doc__, name)


if __name__ == "__main__":
    unittest.main()
