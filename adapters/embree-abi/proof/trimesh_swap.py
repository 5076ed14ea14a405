#!/usr/bin/env python3
"""trimesh, unchanged, over our accelerators: the triangles that it finds are those of its own Embree, except for ties.

Proves: `RayMeshIntersector.intersects_first` of trimesh with embreex (Embree 4) gives the same triangle for random rays through a
bumpy icosphere; through a mesh with T-joints, cracks and triangles given twice, with rays aimed at corners and edges, every
difference is judged by arithmetic with fractions, and ours must be right. Every accelerator gives the same triangles.

Run: adapters/embree-abi/proof/trimesh_swap.py [--small] [--accel A].. [--json FILE]; needs `pip install trimesh embreex`. Without them
it says so and ends with 0. Ends with 1 if a target is missed.
"""

import sys
import time

import swap


def bumpy(subdivisions):
    """An icosphere with bumps; corners are f32, the least of each coordinate 0, so that trimesh changes none of their bits."""
    import numpy as np
    import trimesh

    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    v = mesh.vertices
    v = v * (1 + 0.1 * np.sin(9 * v[:, :1]) * np.sin(8 * v[:, 1:2]) * np.sin(7 * v[:, 2:]))
    v = v.astype(np.float32)
    return v - v.min(axis=0), mesh.faces


def stiff(n):
    """A field of squares whose right neighbours are cut finer, so that corners lie in the midst of edges (T-joints, and cracks where the
    midpoint is rounded), with every fifth triangle given twice."""
    import numpy as np

    rng = np.random.default_rng(7)
    vertices, faces = [], []
    height = lambda x, y: np.sin(1.7 * x) + np.cos(2.3 * y) + 3
    for i in range(n):
        for j in range(n):
            k = 1 + (i + j) % 3
            base = len(vertices)
            corner = lambda u, v: sum(w * height(i + a, j + b) for a, b, w in
                                      [(0, 0, (1 - u) * (1 - v)), (1, 0, u * (1 - v)), (0, 1, (1 - u) * v), (1, 1, u * v)])
            for a in range(k + 1):
                for b in range(k + 1):
                    vertices.append([i + a / k, j + b / k, corner(a / k, b / k)])
            at = lambda a, b: base + a * (k + 1) + b
            for a in range(k):
                for b in range(k):
                    faces += [[at(a, b), at(a + 1, b), at(a + 1, b + 1)], [at(a, b), at(a + 1, b + 1), at(a, b + 1)]]
    faces = np.array(faces)
    vertices = np.array(vertices, dtype=np.float32)
    faces = np.concatenate([faces, faces[::5]])
    faces = faces[rng.permutation(len(faces))]
    return vertices - vertices.min(axis=0), faces


def rays(vertices, faces, count, aimed):
    """Random rays around the mesh; if `aimed`, at corners and middles of edges."""
    import numpy as np
    import trimesh

    rng = np.random.default_rng(3)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    on_sphere = lambda: trimesh.util.unitize(rng.standard_normal((count, 3)))
    origins = centre + 1.5 * radius * on_sphere()
    if aimed:
        corners = vertices[faces[rng.integers(len(faces), size=count)]].astype(float)
        weights = np.where(rng.random((count, 1)) < 0.5, [[1.0, 0.0, 0.0]], [[0.5, 0.5, 0.0]])
        targets = (corners * weights[:, :, None]).sum(axis=1)
    else:
        targets = centre + radius * rng.random((count, 1)) * on_sphere()
    origins = origins.astype(np.float32)
    return origins, (targets - origins).astype(np.float32)


def work(task, known={}):
    """A worker's task: the triangles that rays hit first, and the seconds of the query alone."""
    import numpy as np
    import trimesh
    from trimesh.ray.ray_pyembree import RayMeshIntersector

    data = np.load(task["input"])
    if task["input"] not in known:
        mesh = trimesh.Trimesh(data["vertices"], data["faces"], process=False)
        known[task["input"]] = RayMeshIntersector(mesh, scale_to_box=False)
        # The scene is built at the first question.
        known[task["input"]].intersects_first(data["origins"][:1], data["directions"][:1])
    start = time.perf_counter()
    hits = known[task["input"]].intersects_first(data["origins"], data["directions"])
    seconds = time.perf_counter() - start
    np.save(task["output"], hits)
    return {"seconds": seconds}


def judge(args, corners, origins, directions, own, ours, folder):
    """Who is right where the two differ, by fractions; and how many of ours differ from the exact answer by brute force."""
    import numpy as np

    verdicts = {"ties": 0, "own_farther": 0, "own_false": 0, "own_missed": 0, "ours_wrong": 0}
    differ = np.flatnonzero(own != ours)
    for i in differ:
        t = [swap.exact_hit(origins[i], directions[i], corners[p]) if p >= 0 else None for p in (own[i], ours[i])]
        # Hits are equal or not as f32: triangles at the same rounded distance are a tie.
        t = [np.float32(float(x)) if x is not None and x >= 0 else None for x in t]
        if own[i] >= 0 and t[0] is None:
            verdicts["own_false" if ours[i] < 0 or t[1] is not None else "ours_wrong"] += 1
        elif t[1] is None or (t[0] is not None and t[0] < t[1]):
            verdicts["ours_wrong"] += 1
        else:
            verdicts["own_missed" if t[0] is None else "ties" if t[0] == t[1] else "own_farther"] += 1
    # Where they differ, and a sample of the rest.
    sample = np.union1d(differ[:2000], np.random.default_rng(5).integers(len(own), size=500 if args.small else 2000))
    n = len(sample)
    full = np.concatenate([origins[sample], np.zeros((n, 1)), directions[sample], np.full((n, 1), np.inf)], axis=1)
    exact = swap.trace(args, corners, full, folder)["prim"].astype(np.int64)
    exact[exact == 0xFFFFFFFF] = -1
    return {"differ": len(differ), **verdicts, "checked": n, "not_exact": int((exact != ours[sample]).sum()),
            "own_not_exact": int((exact != own[sample]).sum())}


def main(args):
    import numpy as np
    import trimesh

    count = 20_000 if args.small else 200_000
    pair = swap.Pair(args, __file__)
    results, failures = [], []
    for name, (vertices, faces), aimed in [("bumpy icosphere", bumpy(3 if args.small else 5), False),
                                           ("T-joints and doubles", stiff(20 if args.small else 60), True)]:
        origins, directions = rays(vertices, faces, count, aimed)
        task = str(pair.path / f"{name}.npz")
        np.savez(task, vertices=vertices, faces=faces, origins=origins, directions=directions)
        answers = {}
        for who, worker in [("own", pair.own), *pair.ours.items()]:
            out = str(pair.path / "hits.npy")
            worker.ask(input=task, output=out)
            answers[who] = np.load(out)
        ask = lambda worker: lambda: worker.ask(input=task, output=str(pair.path / "hits.npy"))
        own, ours = swap.in_turns(args.rounds, {"own": ask(pair.own), "ours": ask(pair.ours[pair.first])})
        corners = vertices[faces]
        # As `intersects_first` hands them to Embree.
        directions = trimesh.util.unitize(directions).astype(np.float32)
        result = {"mesh": name, "triangles": len(faces), "rays": count, "hit": int((answers["own"] >= 0).sum())}
        result |= judge(args, corners, origins, directions, answers["own"], answers[pair.first], pair.path)
        result["others_differ"] = {a: int((answers[a] != answers[pair.first]).sum()) for a in list(pair.ours)[1:]}
        result |= {"time": swap.ratio(own, ours)}
        results.append(result)

        print(f"{name}: {len(faces)} triangles, {count} rays, {result['hit']} hit")
        print(f"  {result['differ']} differ from its own Embree: {result['ties']} ties, Embree's is farther {result['own_farther']}, "
              f"not hit at all {result['own_false']}, missed {result['own_missed']}; ours wrong {result['ours_wrong']}")
        print(f"  of {result['checked']} rays traced exactly, {result['not_exact']} of ours differ, {result['own_not_exact']} of Embree's")
        print(f"  other accelerators differ: {result['others_differ']}; time against Embree: {swap.ratio_text(result['time'])}")
        if result["ours_wrong"] or result["not_exact"] or any(result["others_differ"].values()):
            failures.append(f"{name}: an answer of ours is wrong")
        if not aimed and result["differ"] > result["ties"]:
            failures.append(f"{name}: a triangle differs that is no tie")
    reports = pair.end()
    if any(report["errors"] for report in reports.values()):
        failures.append("the library reported errors to the program")
    swap.write_json(args, {"proof": "trimesh", "meshes": results, "reports": reports, "passed": not failures})
    swap.finish(failures)


if __name__ == "__main__":
    options = swap.arguments(__doc__).parse_args()
    swap.need("numpy", "trimesh", "embreex")
    swap.serve(work) if options.worker else main(options)
