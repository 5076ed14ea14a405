"""While rays are traced: no copies, other Python threads run, Ctrl-C ends it."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import skipgrid
from meshes import bumpy, rays_around

# Prints by how much the peak memory grows, KiB, while `rays` of 256 MiB hit nothing: with the answers, a byte each.
MEMORY = """
import resource, sys
import numpy as np, skipgrid
rays = np.zeros((8 << 20, 8), np.float32)
if sys.argv[1] == "read":
    rays += 0  # every page is there before
else:
    rays = rays.astype(np.float64)
mesh = skipgrid.Accel(np.eye(3), [[0, 1, 2]])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
assert not mesh.any_hit(rays).any()
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""

# Traces for minutes; says when it begins.
ENDLESS = """
import numpy as np, skipgrid
mesh = skipgrid.load("bumpy:n=80", "brute")
rays = np.tile(np.array([[0, 0, 5, 0, 0, -1]], np.float32), (1 << 22, 1))
try:
    print("begins", flush=True)
    mesh.closest_hit(rays)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def python(code, *arguments):
    return subprocess.Popen([sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE, text=True)


class Running(unittest.TestCase):
    @unittest.skipUnless(sys.platform.startswith("linux"), "memory is read in KiB as Linux gives it")
    def test_float32_in_c_order_is_not_copied(self):
        grown = {}
        for how in ["read", "convert"]:
            out, _ = python(MEMORY, how).communicate(timeout=300)
            grown[how] = int(out)
        # A byte for each ray's answer, 8 MiB, and the threads; a copy of the rays would be 256 MiB.
        self.assertLess(grown["read"], 64 << 10)
        self.assertGreater(grown["convert"], 200 << 10)

    def test_another_thread_makes_progress(self):
        mesh = skipgrid.Accel(*bumpy(40), "brute")
        rays = np.hstack(rays_around(mesh.triangles.reshape(-1, 3), 20_000))
        turns, done = 0, threading.Event()

        def trace():
            mesh.closest_hit(rays, threads=1)
            done.set()

        # With Python's lock held all the way there would be one turn: the one that waits for it.
        tracer = threading.Thread(target=trace)
        tracer.start()
        while not done.wait(0.001):
            turns += 1
        tracer.join()
        self.assertGreater(turns, 20)

    def test_one_accelerator_serves_several_threads(self):
        mesh = skipgrid.Accel(*bumpy(20))
        rays = np.hstack(rays_around(mesh.triangles.reshape(-1, 3), 20_000))
        expected, answers = mesh.closest_hit(rays)[1].tobytes(), []
        threads = [threading.Thread(target=lambda: answers.append(mesh.closest_hit(rays)[1].tobytes())) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(answers, [expected] * 4)

    @unittest.skipIf(os.name == "nt", "signals are sent as POSIX has them")
    def test_ctrl_c_ends_a_long_call(self):
        traced = python(ENDLESS)
        self.assertEqual(traced.stdout.readline(), "begins\n")
        # So that it is in the call; were it not yet, it would be interrupted all the same.
        time.sleep(0.5)
        traced.send_signal(signal.SIGINT)
        out, _ = traced.communicate(timeout=60)
        self.assertEqual((out, traced.returncode), ("interrupted\n", 0))


def program():
    """The program skipgrid, if it is built or installed."""
    target = pathlib.Path(__file__).parents[3] / "target"
    built = [target / profile / "skipgrid" for profile in ["release", "debug"]]
    return next((str(path) for path in built if path.is_file()), None) or shutil.which("skipgrid")


@unittest.skipIf(program() is None, "the program skipgrid is not built")
class Program(unittest.TestCase):
    def test_rays_and_hits_are_those_of_the_program(self):
        scene = "bumpy:n=20"
        mesh = skipgrid.load(scene)
        rays = np.hstack(rays_around(mesh.triangles.reshape(-1, 3), 3000))
        low, high = np.zeros((3000, 1), np.float32), np.full((3000, 1), 4, np.float32)
        rays = np.hstack([rays[:, :3], low, rays[:, 3:], high])
        with tempfile.TemporaryDirectory() as folder:
            files = [os.path.join(folder, name) for name in ["rays.npy", "hits.npy"]]
            np.save(files[0], rays)
            command = [program(), "trace", scene, "--rays", files[0], "--hits", files[1], "--accel", "grid"]
            subprocess.run(command, check=True, capture_output=True)
            hits = np.load(files[1])
        t, prim = mesh.closest_hit(rays)
        self.assertEqual((t.tobytes(), prim.tobytes()), (hits["t"].tobytes(), hits["prim"].tobytes()))
        self.assertTrue(0.2 < (prim != skipgrid.MISS).mean() < 0.9)


if __name__ == "__main__":
    unittest.main()
