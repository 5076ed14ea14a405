#!/usr/bin/env python3
"""Mitsuba 3, unchanged, over our accelerators: the same pictures from the same seeds as over its own Embree.

Renders scenes that are made here without files (variant scalar_rgb, path tracing): a Cornell box with a glass sphere, instances, a
bumpy icosphere, masks by a bitmap, and shapes that Embree asks Mitsuba about. Proves that
- the pictures of all our accelerators are equal to the last bit, so that no accelerator misses or invents a hit;
- they are those of Mitsuba's own Embree but for rounding: pixels that differ by more than 1e-3 are counted, and must be few (Embree's
  fast and robust modes are compared in the same way, to show what rounding alone does);
- where rays hit something else than Embree says, ours is what exact arithmetic says (random rays through the meshes);
- curves, which we do not have, are refused aloud.

Run: adapters/embree-abi/proof/mitsuba_swap.py [--small] [--accel A].. [--rounds N] [--json FILE]; needs `pip install mitsuba`. Without
it the script says so and ends with 0. Ends with 1 if a target is missed.
"""

import subprocess
import sys
import time

import swap

# Of all pixels, those that may differ by more than 1e-3: a tie or a last bit that sends a whole path elsewhere.
MOST_DIFFERENT = 1e-3


def icosphere(subdivisions):
    """Corners and faces of a bumpy icosphere of 20 * 4^n triangles."""
    import numpy as np

    g = (1 + 5**0.5) / 2
    corners = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    faces = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
             [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1]]
    corners = [list(c) for c in corners]
    for _ in range(subdivisions):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(corners)
                corners.append([(x + y) / 2 for x, y in zip(corners[a], corners[b])])
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        faces = finer
    v = np.array(corners)
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    v *= 1 + 0.1 * np.sin(9 * v[:, :1]) * np.sin(8 * v[:, 1:2]) * np.sin(7 * v[:, 2:])
    return v.astype(np.float32), np.array(faces, dtype=np.uint32)


def scene(name, size, spp, robust):
    """A scene as a dictionary of Mitsuba; Embree in its robust mode or not."""
    import mitsuba as mi
    import numpy as np

    T = mi.ScalarTransform4f
    d = mi.cornell_box()
    d["integrator"] = {"type": "path", "max_depth": 8}
    d["embree_use_robust_intersections"] = robust
    d["sensor"]["film"].update(width=size, height=size, rfilter={"type": "box"})
    d["sensor"]["sampler"] = {"type": "independent", "sample_count": spp}
    boxes = [key for key in d if key.endswith("-box")]
    if name == "cornell":
        d["glass"] = {"type": "sphere", "center": [0.35, -0.1, 0.3], "radius": 0.3, "bsdf": {"type": "dielectric"}}
        return d
    for key in boxes:
        del d[key]
    if name == "instances":
        d["group"] = {"type": "shapegroup", "a": {"type": "cube"}, "b": {"type": "sphere", "center": [0, 1.5, 0], "radius": 0.7}}
        for i in range(8):
            place = T().translate([-0.6 + 0.4 * (i % 4), -0.6 + 0.7 * (i // 4), -0.3 + 0.1 * i]).rotate([0.6, 0, 0.8], 40 * i).scale(0.14)
            d[f"copy{i}"] = {"type": "instance", "to_world": place, "shape": {"type": "ref", "id": "group"}}
    elif name == "bumpy":
        vertices, faces = icosphere(4 if size < 128 else 6)
        mesh = mi.Mesh("bumpy", len(vertices), len(faces))
        params = mi.traverse(mesh)
        params["vertex_positions"], params["faces"] = (vertices * 0.6).ravel(), faces.ravel()
        params.update()
        d["bumpy"] = mesh
    elif name == "masks":
        squares = (np.indices((16, 16)).sum(axis=0) % 2).astype(np.float32)[:, :, None]
        holes = {"type": "bitmap", "bitmap": mi.Bitmap(squares), "raw": True, "filter_type": "nearest"}
        for i in range(4):
            place = T().translate([0, 0, -0.5 + 0.3 * i]).rotate([0, 0, 1], 20 * i).scale(0.6)
            d[f"mask{i}"] = {"type": "rectangle", "to_world": place,
                             "bsdf": {"type": "mask", "opacity": holes, "nested": {"type": "twosided", "bsdf": {"type": "diffuse"}}}}
    elif name == "shapes":
        two = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.8]}}}
        d["disk"] = {"type": "disk", "to_world": T().translate([-0.5, 0.2, 0]).rotate([0, 1, 0], 40).scale(0.4), "bsdf": two}
        d["cylinder"] = {"type": "cylinder", "p0": [0.4, -0.9, 0], "p1": [0.2, 0.3, 0.2], "radius": 0.2, "bsdf": two}
        d["ball"] = {"type": "sphere", "center": [-0.3, -0.6, 0.2], "radius": 0.35, "bsdf": {"type": "roughconductor"}}
    return d


SCENES = ["cornell", "instances", "bumpy", "masks", "shapes"]


def work(task, known={}):
    """A worker's task: a picture, and the seconds of rendering alone; or what rays hit."""
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_rgb")
    key = (task["scene"], task["size"], task["spp"], task.get("robust", False))
    if key not in known:
        known[key] = mi.load_dict(scene(*key))
    loaded = known[key]
    if task["what"] == "render":
        start = time.perf_counter()
        picture = mi.render(loaded, seed=task["seed"])
        seconds = time.perf_counter() - start
        np.save(task["output"], np.array(picture))
        return {"seconds": seconds}
    if task["what"] == "meshes":
        # Triangles of all shapes in the order of shapes, in world space, as Embree is given them.
        meshes = [s for s in loaded.shapes() if s.is_mesh()]
        assert len(meshes) == len(loaded.shapes()), "a shape is no mesh"
        parts = []
        for mesh in meshes:
            vertices, faces = np.array(mesh.vertex_positions_buffer(), np.float32), np.array(mesh.faces_buffer())
            parts.append(vertices.reshape(-1, 3)[faces.reshape(-1, 3)])
        np.savez(task["output"], triangles=np.concatenate(parts), first=np.cumsum([0] + [len(part) for part in parts]))
        return {}
    rays, first = np.load(task["rays"]), np.load(task["meshes"])["first"]
    hits = np.zeros(len(rays), dtype=[("t", "<f4"), ("prim", "<i8")])
    shapes = loaded.shapes()
    for i, (ox, oy, oz, _, dx, dy, dz, _) in enumerate(rays.tolist()):
        hit = loaded.ray_intersect_preliminary(mi.Ray3f([ox, oy, oz], [dx, dy, dz]), False)
        if hit.is_valid():
            hits[i] = (hit.t, first[shapes.index(hit.shape)] + hit.prim_index)
        else:
            hits[i] = (np.inf, -1)
    np.save(task["output"], hits)
    return {}


def compare(a, b):
    """Pixels in which two pictures differ."""
    import numpy as np

    difference = np.abs(a - b).max(axis=-1)
    return {
        "pixels": difference.size,
        "different": int((difference > 0).sum()),
        "above_1e-3": int((difference > 1e-3).sum()),
        "greatest": float(difference.max()),
        "mean": float(np.abs(a.astype(float) - b).mean()),
        "mean_of_picture": float(np.abs(a).mean()),
        "not_finite": int((~np.isfinite(b)).sum()),
    }


def rays_of_meshes(args, pair, failures):
    """Random rays through the two scenes of meshes alone: who is right where the hits differ."""
    import numpy as np

    count, results = 5_000 if args.small else 50_000, {}
    for name in ["bumpy"]:
        common = {"scene": name, "size": 64 if args.small else 128, "spp": 1}
        meshes = str(pair.path / "meshes.npz")
        pair.own.ask(what="meshes", output=meshes, **common)
        triangles = np.load(meshes)["triangles"]
        rng = np.random.default_rng(11)
        # From everywhere in the box to corners and middles of edges, and to anywhere.
        origins = rng.uniform(-0.95, 0.95, (count, 3)) + [0, 0, 1]
        corners = triangles[rng.integers(len(triangles), size=count)].astype(float)
        weights = np.array([[1, 0, 0], [0.5, 0.5, 0], [0.3, 0.3, 0.4]])[rng.integers(3, size=count)]
        targets = (corners * weights[:, :, None]).sum(axis=1)
        rays = np.concatenate([origins, np.zeros((count, 1)), targets - origins, np.full((count, 1), np.inf)], axis=1).astype(np.float32)
        files = {"rays": str(pair.path / "rays.npy"), "meshes": meshes}
        np.save(files["rays"], rays)
        answers = {}
        for who, worker in [("own", pair.own), *pair.ours.items()]:
            out = str(pair.path / "answers.npy")
            worker.ask(what="rays", output=out, **files, **common)
            answers[who] = np.load(out)
        exact = swap.trace(args, triangles, rays, pair.path, "grid" if len(rays) * len(triangles) > 1e9 else "brute")
        prim = exact["prim"].astype(np.int64)
        prim[prim == 0xFFFFFFFF] = -1
        results[name] = {"rays": count, "triangles": len(triangles)}
        for who, answer in answers.items():
            same_t = (answer["t"] == exact["t"]) | (np.isinf(answer["t"]) & np.isinf(exact["t"]))
            # At the same t another of several triangles is a tie.
            results[name][who] = {
                "other_triangle_at_same_t": int(((answer["prim"] != prim) & same_t).sum()),
                "other_triangle": int(((answer["prim"] != prim) & ~same_t).sum()),
                "other_t": int((~same_t).sum()),
                "missed": int(((answer["prim"] < 0) & (prim >= 0)).sum()),
                "false": int(((answer["prim"] >= 0) & (prim < 0)).sum()),
            }
            print(f"rays through {name}: {count}, over {who}: " + ", ".join(f"{k.replace('_', ' ')} {v}" for k, v in results[name][who].items()))
            if who != "own" and (results[name][who]["other_triangle"] or results[name][who]["other_t"]):
                failures.append(f"rays through {name}: {who} differs from the exact answers")
    return results


CURVES = """
import mitsuba as mi, tempfile, sys
mi.set_variant("scalar_rgb")
with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
    file.write("\\n".join(f"{i} 0 0 0.5" for i in range(6)))
    file.flush()
    scene = mi.load_dict({"type": "scene", "curve": {"type": "bsplinecurve", "filename": file.name}})
    hit = scene.ray_intersect_preliminary(mi.Ray3f([2.5, 0, -3], [0, 0, 1]), False).is_valid()
    print("hit" if hit else "nothing")
"""


def curves(args, failures):
    """Curves: our library says that it cannot, Mitsuba is told, and so is the user."""
    own = subprocess.run([sys.executable, "-c", CURVES], capture_output=True, text=True)
    if own.stdout.strip() != "hit":
        print(f"curves: not checked, since Mitsuba itself does not trace the test's curve: {own.stdout}{own.stderr}")
        return None
    command = swap.under(args, (args.accel or ["nested"])[0]) + [sys.executable, "-c", CURVES]
    ours = subprocess.run(command, capture_output=True, text=True)
    # Mitsuba's log goes to standard output.
    said = [line.strip() for line in (ours.stdout + ours.stderr).splitlines() if "does not support" in line and "curve" in line]
    warned = "reported to the program" in ours.stderr
    if ours.stdout.split()[-1:] == ["hit"] or not said or not warned:
        failures.append(f"curves: not refused aloud (exit code {ours.returncode}): {ours.stdout}{ours.stderr}")
    else:
        print(f"curves: refused aloud: {said[0]}")
    return {"exit_code": ours.returncode, "said": said}


def main(args):
    import numpy as np

    size, spp = (64, 8) if args.small else (128, 32)
    pair = swap.Pair(args, __file__)
    results, failures = {}, []
    print(f"{'scene':10} {'pixels':>6} {'differ':>6} {'>1e-3':>6} {'greatest':>9} {'mean':>9}  Embree's own robust mode: differ  >1e-3  between ours  time against Embree")
    for name in SCENES:
        out = str(pair.path / "picture.npy")
        common = {"what": "render", "scene": name, "size": size, "spp": spp, "output": out}
        pictures = {}
        for who, worker in [("own", pair.own), *pair.ours.items()]:
            worker.ask(seed=0, **common)
            pictures[who] = np.load(out)
        pair.own.ask(seed=0, robust=True, **common)
        robust = np.load(out)
        ask = lambda worker: lambda: worker.ask(seed=0, **common)
        own, ours = swap.in_turns(args.rounds, {"own": ask(pair.own), "ours": ask(pair.ours[pair.first])})
        result = compare(pictures["own"], pictures[pair.first])
        result["embree_robust"] = compare(pictures["own"], robust)
        result["between_ours"] = {a: int((pictures[a] != pictures[pair.first]).any(axis=-1).sum()) for a in list(pair.ours)[1:]}
        result["time"] = swap.ratio(own, ours)
        results[name] = result
        print(f"{name:10} {result['pixels']:6} {result['different']:6} {result['above_1e-3']:6} {result['greatest']:9.2e} {result['mean']:9.2e}  "
              f"{result['embree_robust']['different']:32} {result['embree_robust']['above_1e-3']:6}  "
              f"{sum(result['between_ours'].values()):12}  {swap.ratio_text(result['time'])}", flush=True)
        if result["above_1e-3"] > MOST_DIFFERENT * result["pixels"] or result["not_finite"]:
            failures.append(f"{name}: {result['above_1e-3']} pixels differ by more than 1e-3")
        if any(result["between_ours"].values()):
            failures.append(f"{name}: pictures of our accelerators differ from each other")
    exact = rays_of_meshes(args, pair, failures)
    reports = pair.end()
    if any(report["errors"] for report in reports.values()):
        failures.append("the library reported errors to Mitsuba")
    refused = curves(args, failures)
    swap.write_json(args, {"proof": "mitsuba", "size": size, "spp": spp, "scenes": results, "rays": exact, "curves": refused,
                           "reports": reports, "passed": not failures})
    swap.finish(failures)


if __name__ == "__main__":
    options = swap.arguments(__doc__).parse_args()
    swap.need("numpy", "mitsuba")
    swap.serve(work) if options.worker else main(options)
