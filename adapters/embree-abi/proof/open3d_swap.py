#!/usr/bin/env python3
"""Open3D, unchanged, over our accelerators: its RaycastingScene gives exactly what exact arithmetic gives.

Casts random rays, and rays at corners and edges, through a torus and counts answers (distance and triangle) that differ from the exact
ones, over Open3D's own Embree and over ours. Debian's build of the two gives no hit for many rays on some machines (rays whose mask is
0 in an Embree with masks), so Embree is no judge here.

Run: adapters/embree-abi/proof/open3d_swap.py [--small] [--accel A].. [--json FILE]; needs Debian's python3-open3d (the PyPI package has
Embree built in). Without it the script says so and ends with 0. Ends with 1 if a target is missed.
"""

import subprocess
import time

import swap

PYTHON = "/usr/bin/python3"


def torus(n, m):
    """Corners and faces of a torus of 2 n m triangles."""
    import numpy as np

    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(m) * 2 * np.pi / m, indexing="ij")
    ring = 2 + 0.7 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.7 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(n), np.arange(m), indexing="ij")
    at = lambda i, j: (i % n) * m + j % m
    quads = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    faces = [np.stack([quads[k] for k in t], axis=-1).reshape(-1, 3) for t in [(0, 1, 2), (0, 2, 3)]]
    return vertices.astype(np.float32), np.concatenate(faces).astype(np.uint32)


def work(task, known={}):
    """A worker's task: what rays hit, and the seconds of the query alone."""
    import numpy as np
    import open3d as o3d

    data = np.load(task["input"])
    tensor = o3d.core.Tensor
    if task["input"] not in known:
        known[task["input"]] = scene = o3d.t.geometry.RaycastingScene()
        scene.add_triangles(tensor(data["vertices"]), tensor(data["faces"]))
        scene.cast_rays(tensor(data["rays"][:1]))
    rays = tensor(data["rays"])
    start = time.perf_counter()
    hits = known[task["input"]].cast_rays(rays)
    seconds = time.perf_counter() - start
    np.savez(task["output"], t=hits["t_hit"].numpy(), prim=hits["primitive_ids"].numpy())
    return {"seconds": seconds}


def main(args):
    import numpy as np

    found = subprocess.run([PYTHON, "-c", "import open3d"], capture_output=True)
    if found.returncode != 0:
        swap.skip(f"{PYTHON} has no package open3d (Debian's python3-open3d)")
    count = 20_000 if args.small else 300_000
    vertices, faces = torus(40, 20) if args.small else torus(120, 60)
    corners = vertices[faces]
    rng = np.random.default_rng(9)
    on_sphere = lambda: (lambda v: v / np.linalg.norm(v, axis=1, keepdims=True))(rng.standard_normal((count, 3)))
    origins = 5 * on_sphere()
    aimed = (corners[rng.integers(len(faces), size=count)] * np.array([[1, 0, 0], [0.5, 0.5, 0]])[rng.integers(2, size=count)][:, :, None]).sum(axis=1)
    targets = np.where(rng.random((count, 1)) < 0.5, aimed, 2.7 * rng.random((count, 1)) * on_sphere())
    rays = np.concatenate([origins, targets - origins], axis=1).astype(np.float32)

    pair = swap.Pair(args, __file__, PYTHON)
    task = {"input": str(pair.path / "task.npz"), "output": str(pair.path / "hits.npz")}
    np.savez(task["input"], vertices=vertices, faces=faces, rays=rays)
    answers = {}
    for who, worker in [("own", pair.own), *pair.ours.items()]:
        worker.ask(**task)
        answers[who] = dict(np.load(task["output"]))
    ask = lambda worker: lambda: worker.ask(**task)
    ratio = swap.ratio(*swap.in_turns(args.rounds, {"own": ask(pair.own), "ours": ask(pair.ours[pair.first])}))

    # Brute force over a part, and the plain grid over all: two exact answers, of which the tests of this project prove that they are one.
    full = np.concatenate([rays[:, :3], np.zeros((count, 1)), rays[:, 3:], np.full((count, 1), np.inf)], axis=1)
    exact = swap.trace(args, corners, full, pair.path, "grid")
    brute = swap.trace(args, corners, full[:2000], pair.path)
    failures, results = [] if (brute == exact[:2000]).all() else ["the exact answers differ"], {}
    for who, answer in answers.items():
        wrong = (answer["prim"] != exact["prim"]) | (answer["t"] != exact["t"])
        results[who] = {"hits": int((answer["prim"] != 0xFFFFFFFF).sum()), "other_t": int((answer["t"] != exact["t"]).sum()), "wrong": int(wrong.sum()),
                        "missed": int(((answer["prim"] == 0xFFFFFFFF) & (exact["prim"] != 0xFFFFFFFF)).sum())}
        print(f"{who:10} {results[who]['hits']} hits of {count} rays; not exact: {wrong.sum()}, of these another t {results[who]['other_t']}, "
              f"missed {results[who]['missed']}")
        if who != "own" and wrong.any():
            failures.append(f"{who}: {wrong.sum()} answers are not exact")
    print(f"exact      {(exact['prim'] != 0xFFFFFFFF).sum()} hits")
    # An Embree that finds nothing is no measure.
    timed = results["own"]["hits"] > 0
    print(f"time against Embree: {swap.ratio_text(ratio)}" if timed else "no time against Embree, which finds nothing here")
    reports = pair.end()
    if any(report["errors"] for report in reports.values()):
        failures.append("the library reported errors to the program")
    swap.write_json(args, {"proof": "open3d", "triangles": len(faces), "rays": count, "answers": results, "time": ratio if timed else None, "reports": reports,
                           "passed": not failures})
    swap.finish(failures)


if __name__ == "__main__":
    options = swap.arguments(__doc__).parse_args()
    swap.serve(work) if options.worker else main(options)
