#!/usr/bin/env python3
"""Blender, unchanged, over our accelerators: Cycles renders the same picture as over its own Embree.

Renders one scene in Cycles on the processor, with the same seed: three instances of a subdivided monkey of which one is of glass, one
behind a leaf with holes (which Embree asks Cycles about by filters), on a plane. Proves that the pictures of all our accelerators are
equal to the last bit, and those of Blender's own Embree but for rounding: pixels that differ by more than 1e-3 are counted and must
be few.

Run: adapters/embree-abi/proof/blender_swap.py [--small] [--accel A].. [--rounds N] [--json FILE]; needs a Blender that links Embree as a
shared library, as Debian's does. Without it the script says so and ends with 0. Ends with 1 if a target is missed.
"""

import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MOST_DIFFERENT = 1e-3


def inside(out, width, height, samples):
    """What Blender does: makes the scene, renders it, writes the pixels."""
    from array import array

    import bpy

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.seed = "CPU", samples, 1
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    bpy.ops.mesh.primitive_plane_add(size=20, location=(0, 0, -1))

    def material(name, make):
        m = bpy.data.materials.new(name)
        m.use_nodes = True
        make(m.node_tree)
        return m

    def glass(tree):
        tree.links.new(tree.nodes.new("ShaderNodeBsdfGlass").outputs[0], tree.nodes["Material Output"].inputs[0])

    def holes(tree):
        checks = tree.nodes.new("ShaderNodeTexChecker")
        checks.inputs["Scale"].default_value = 9
        tree.links.new(checks.outputs["Fac"], tree.nodes["Principled BSDF"].inputs["Alpha"])

    bpy.ops.mesh.primitive_monkey_add(location=(0, 0, 0))
    monkey = bpy.context.object
    bpy.ops.object.modifier_add(type="SUBSURF")
    monkey.modifiers[0].levels = monkey.modifiers[0].render_levels = 2
    bpy.ops.object.modifier_apply(modifier=monkey.modifiers[0].name)
    for place in [(-2.2, 1.5, 0), (2.2, 0.5, 0.2)]:
        copy = bpy.data.objects.new("copy", monkey.data)
        copy.location, copy.rotation_euler, copy.scale = place, (0.3 * place[0], 0.2, 0.9), (0.9, 0.9, 0.9)
        scene.collection.objects.link(copy)
    copy.data = monkey.data
    bpy.ops.mesh.primitive_plane_add(size=1.5, location=(1.5, -1.5, 0.5), rotation=(1.2, 0, 0.4))
    bpy.context.object.data.materials.append(material("holes", holes))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.7, location=(-1, -2, -0.3))
    bpy.context.object.data.materials.append(material("glass", glass))
    scene.render.filepath = out + ".exr"
    start = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - start
    picture = bpy.data.images.load(out + ".exr")
    picture.colorspace_settings.name = "Non-Color"
    # Blender's Python need not have NumPy.
    with open(out, "wb") as file:
        array("f", picture.pixels[:]).tofile(file)
    Path(out + ".json").write_text(json.dumps({"seconds": seconds}))


def main(args):
    import numpy as np
    import swap

    blender = shutil.which("blender") or swap.skip("blender is not installed")
    width, height, samples = (80, 60, 8) if args.small else (160, 120, 32)
    folder = tempfile.TemporaryDirectory(prefix="skipgrid-proof-")
    report = Path(folder.name) / "report"

    def render(command, name):
        out = str(Path(folder.name) / f"{name}.f32")
        blend = [blender, "--background", "--factory-startup", "--python-exit-code", "1", "--python", str(Path(__file__).resolve()), "--", out]
        run = subprocess.run(command + blend + [str(n) for n in (width, height, samples)], capture_output=True, text=True)
        if run.returncode != 0:
            sys.exit(f"error: Blender ended with exit code {run.returncode}:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
        return np.fromfile(out, np.float32).reshape(height, width, 4), json.loads(Path(out + ".json").read_text())

    accels = args.accel or ["nested", "grid"]
    if subprocess.run(swap.under(args, accels[0]) + [blender, "--version"], capture_output=True).returncode == 2:
        swap.skip("this Blender does not link Embree as a shared library")
    pictures = {accel: render(swap.under(args, accel, report), "ours")[0] for accel in accels}
    reports = [json.loads(line) for line in report.read_text().splitlines()] if report.exists() else []
    own, _ = render([], "own")
    again, _ = render([], "own")
    sides = {"own": lambda: render([], "own")[1], "ours": lambda: render(swap.under(args, accels[0]), "ours")[1]}
    ratio = swap.ratio(*swap.in_turns(args.rounds, sides))
    difference = np.abs(own - pictures[accels[0]]).max(axis=-1)
    result = {"pixels": difference.size, "different": int((difference > 0).sum()), "above_1e-3": int((difference > 1e-3).sum()),
              "greatest": float(difference.max()), "mean": float(difference.mean()),
              "own_against_itself": int((own != again).any(axis=-1).sum()),
              "between_ours": {a: int((pictures[a] != pictures[accels[0]]).any(axis=-1).sum()) for a in accels[1:]}, "time": ratio}
    print(f"{result['pixels']} pixels, {samples} samples: {result['different']} differ, {result['above_1e-3']} by more than 1e-3, "
          f"greatest {result['greatest']:.2e}, mean {result['mean']:.2e}")
    print(f"Blender against itself: {result['own_against_itself']} differ; between our accelerators: {result['between_ours']}")
    print(f"time of rendering, with its build, against Embree: {swap.ratio_text(ratio)}")
    failures = []
    if len(reports) < len(accels) or any(r["errors"] or not r["closest_rays"] for r in reports):
        failures.append(f"errors, or nothing went through our library: {reports}")
    if result["above_1e-3"] > MOST_DIFFERENT * result["pixels"]:
        failures.append(f"{result['above_1e-3']} pixels differ by more than 1e-3")
    if any(result["between_ours"].values()) and not result["own_against_itself"]:
        failures.append("pictures of our accelerators differ from each other")
    folder.cleanup()
    swap.write_json(args, {"proof": "blender", "size": [width, height], "samples": samples, **result, "reports": reports, "passed": not failures})
    swap.finish(failures)


if __name__ == "__main__":
    if "bpy" in sys.modules or "--background" in sys.argv:
        out, *numbers = sys.argv[sys.argv.index("--") + 1:]
        inside(out, *map(int, numbers))
    else:
        sys.path.insert(0, str(Path(__file__).resolve().parent))
        import swap

        main(swap.arguments(__doc__).parse_args())
