#!/usr/bin/env python3
"""Embree's own test program over our accelerators: what passes, what fails, and what we do not have.

Runs Debian's `embree_verify` (package embree-tools, Embree 3.13) with our library in the place of Embree, group by group, and with --own
also over Embree itself. Proves that no ray slips through a watertight mesh, and that no test fails but those that ask for what we do
not have (subdivision surfaces, grids, curves, motion blur): during these the library says so, and they are counted apart.

Run: adapters/embree-abi/proof/embree_verify.py [--small] [--own] [--accel A] [--json FILE]. Without embree_verify it says so and ends
with 0. Ends with 1 if a test fails.
"""

import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import swap

# The tests are the same for every instruction set of Embree; ours has one answer to all.
PREFIX = "AVX2"

# Group; pattern of its tests; pattern for --small; True if tests of it must pass, or what we do not have that all of them ask for.
# (Patterns have no groups: the program's have none.) Left out are geometry_state_tests and scene_modified_geometry_tests, which reach
# through handles into Embree's own objects and mean nothing to another library; regression and benchmark tests, which take hours; and
# tests of Embree's allocator and threads, which use no library.
GROUPS = [
    ("empty_scene", "empty_scene\\..*", None, True),
    ("empty_geometry", "empty_geometry\\..*", None, False),
    ("get_bounds", "get_bounds\\..*", None, True),
    ("get_user_data", "get_user_data", None, False),
    ("multiple_devices", "multiple_devices", None, True),
    ("types_test", "types_test", None, True),
    ("buffer_stride", "buffer_stride\\..*", None, True),
    ("build", "build\\..*", None, False),
    ("new_delete_geometry", "new_delete_geometry\\..*", None, False),
    ("user_geometry_id", "user_geometry_id\\..*", None, True),
    ("enable_disable_geometry", "enable_disable_geometry\\..*", None, False),
    ("disable_detach_geometry", "disable_detach_geometry\\..*", None, False),
    ("garbage_geometry", "build_garbage_geom", None, False),
    ("overlapping_primitives", "overlapping_primitives\\..*", None, False),
    ("interpolate", "interpolate\\..*", None, False),
    ("update", "update\\..*", "update\\..*DynamicFast.*Intersect1", False),
    ("triangle_hit", "triangle_hit\\..*", "triangle_hit\\..*StaticRobust.*", True),
    ("quad_hit", "quad_hit\\..*", "quad_hit\\..*StaticRobust.*", True),
    ("ray_masks", "ray_masks\\..*", "ray_masks\\..*StaticRobust.*", False),
    ("intersection_filter", "intersection_filter\\..*", "intersection_filter\\..*StaticRobust.*", True),
    ("instancing", "instancing\\..*", "instancing\\..*StaticRobust.*", True),
    ("inactive_rays", "inactive_rays\\..*", "inactive_rays\\..*StaticRobust.*", True),
    ("ray_alignment", "ray_alignment_test\\..*", "ray_alignment_test\\..*StaticRobust.*1\\..*", True),
    ("watertight_triangles", "watertight_triangles\\..*", "watertight_triangles\\.StaticRobust.*", True),
    ("watertight_quads", "watertight_quads\\..*", "watertight_quads\\.StaticRobust.*", True),
    ("watertight_grids", "watertight_grids\\..*", "watertight_grids\\.StaticRobust.*", False),
    ("watertight_subdiv", "watertight_subdiv\\..*", "watertight_subdiv\\.StaticRobust.*", False),
    ("watertight_triangles_mb", "watertight_triangles_mb\\..*", "watertight_triangles_mb\\.StaticRobust.*", False),
    ("watertight_quads_mb", "watertight_quads_mb\\..*", "watertight_quads_mb\\.StaticRobust.*", False),
    ("point_query", "point_query\\..*", None, "rtcPointQuery"),
    ("sphere_filter_multi_hit", "sphere_filter_multi_hit_tests", None, False),
    ("memory", "embree_reported_memory\\.triangles_10k\\..*", None, False),
]

# A test's name, what was written during it, and its result, if it came to one.
TEST = re.compile(rf"({PREFIX}\.[^\s:]+):? ((?:(?!{PREFIX}\.).)*?)(\[PASSED|\[FAILED|\[SKIPPED|\Z)", re.DOTALL)

# What the library says when it is asked for what it does not have.
UNSUPPORTED = re.compile(r"does not support ([^\n(]*[^\n( ])")


def run(command, pattern, seconds, absent=None):
    """Runs one group: tests by result; those that ask for what is not supported, such as `absent`, are no failures."""
    started = time.monotonic()
    arguments = ["--no-colors", "--flatten", "--sequential", "--run", f"{PREFIX}\\.{pattern}"]
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen(command + arguments, stdout=out, stderr=subprocess.STDOUT)
        try:
            code = process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.terminate()
            process.wait()
            code = None
        out.seek(0)
        text = out.read()
    counts = {"passed": 0, "failed": 0, "unsupported": 0, "skipped": 0}
    failures, unsupported = [], set()
    for name, between, result in TEST.findall(text):
        lacking = UNSUPPORTED.findall(between)
        if result in ("[PASSED", "[SKIPPED"):
            counts[result[1:].lower()] += 1
        elif not result and code is None:
            # The time was over.
            continue
        elif lacking or absent:
            lacking = lacking or [absent]
            counts["unsupported"] += 1
            unsupported.update(lacking)
        else:
            counts["failed"] += 1
            said = [line for line in between.splitlines() if "skipgrid" in line]
            failures.append(name + ("" if result else f" (ended by exit code {code})") + (f": {said[0].strip(' .')}" if said else ""))
    return counts | {"failures": failures, "lacking": sorted(unsupported), "exit_code": code, "seconds": round(time.monotonic() - started, 1)}


def main(args):
    tool = shutil.which("embree_verify") or swap.skip("embree_verify is not installed (Debian's package embree-tools)")
    accel = (args.accel or ["nested"])[0]
    folder = tempfile.TemporaryDirectory(prefix="skipgrid-proof-")
    report = Path(folder.name) / "report"
    sides = {"ours": swap.under(args, accel, report) + [tool]} | ({"own": [tool]} if args.own else {})
    results, failures, lacking = {}, [], set()
    head = f"{'passed':>6} {'failed':>6} {'unsupported':>11} {'skipped':>7} {'seconds':>8}"
    print(f"{'group':24} {head}" + (f"   Embree's own: {head}" if args.own else ""))
    columns = lambda r: f"{r['passed']:6} {r['failed']:6} {r['unsupported']:11} {r['skipped']:7} {r['seconds']:8}"
    for name, pattern, small, must in GROUPS:
        if args.group and name not in args.group:
            continue
        absent = must if isinstance(must, str) else None
        chosen = small if args.small and small else pattern
        group = {who: run(command, chosen, args.seconds, absent if who == "ours" else None) for who, command in sides.items()}
        results[name] = group
        ours, own = group["ours"], group.get("own")
        lacking.update(ours["lacking"])
        print(f"{name:24} {columns(ours)}" + (f"                 {columns(own)}" if own else ""), flush=True)
        if ours["lacking"]:
            print(f"  unsupported: {', '.join(ours['lacking'])}")
        if ours["failures"]:
            print(f"  failed: {'; '.join(ours['failures'][:3])}" + (" ..." if ours["failed"] > 3 else ""))
        if ours["exit_code"] is None:
            print(f"  stopped after {args.seconds} s")
        if ours["failed"] > (own["failed"] if own else 0):
            failures.append(f"{name}: {ours['failed']} tests failed")
        if must is True and not ours["passed"]:
            failures.append(f"{name}: no test passed")
    totals = {key: sum(group["ours"][key] for group in results.values()) for key in ("passed", "failed", "unsupported", "skipped")}
    print(f"in all: " + ", ".join(f"{count} {key}" for key, count in totals.items()) + f"; not supported: {', '.join(sorted(lacking))}")
    if not report.exists() or not report.read_text():
        failures.append("nothing went through our library")
    folder.cleanup()
    swap.write_json(args, {"proof": "embree_verify", "accelerator": accel, "groups": results, "totals": totals, "passed": not failures})
    swap.finish(failures)


if __name__ == "__main__":
    parser = swap.arguments(__doc__)
    parser.add_argument("--own", action="store_true", help="run Embree itself, too")
    parser.add_argument("--group", action="append", help="only this group; may be repeated")
    parser.add_argument("--seconds", type=float, default=600, help="longest time of a group (600)")
    main(parser.parse_args())
