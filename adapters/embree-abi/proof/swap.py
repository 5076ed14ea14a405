"""What the proofs share: the same work done by two copies of a program in turns, one over its own Embree and one over ours.

A proof script starts itself again as a worker, once plainly and once through `skipgrid run-under`. Workers read a line of JSON for
each task and answer with one, so that rounds of the two can be interleaved while nothing but the work itself is timed.
"""

import argparse
import importlib.util
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from fractions import Fraction
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def arguments(description):
    """The options that all proofs have."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--skipgrid", metavar="PROGRAM", help="the program skipgrid; default: target/release/skipgrid, then the search path")
    parser.add_argument("--library", metavar="FILE|FOLDER", help="as of `skipgrid run-under`; default: beside the program")
    parser.add_argument("--accel", metavar="A", action="append", help="accelerator; may be repeated, the first one is timed; default: nested and grid")
    parser.add_argument("--rounds", metavar="N", type=int, default=5, help="rounds, in which both work in turns (5)")
    parser.add_argument("--small", action="store_true", help="a smaller task, to be done within a minute or two")
    parser.add_argument("--json", metavar="FILE", help="where the numbers go")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser


def skip(reason):
    """Ends a proof that cannot be run here."""
    print(f"skipped: {reason}")
    sys.exit(0)


def need(*modules):
    """Skips if a Python package is missing."""
    for module in modules:
        if importlib.util.find_spec(module) is None:
            skip(f"the Python package {module} is not installed")


def program(args):
    """The program skipgrid."""
    built = ROOT / "target" / "release" / "skipgrid"
    found = args.skipgrid or (str(built) if built.exists() else shutil.which("skipgrid"))
    if not found or not Path(found).exists():
        sys.exit("error: no program skipgrid; build it by `cargo build --release`")
    return str(Path(found).resolve())


def under(args, accel, report=None, linked_by=None):
    """The command line that puts our library under what follows it."""
    command = [program(args), "run-under", "--accel", accel]
    for option, value in [("--library", args.library), ("--report", report), ("--linked-by", linked_by)]:
        command += [option, str(value)] if value else []
    return command + ["--"]


class Worker:
    """A copy of the calling script that does tasks."""

    def __init__(self, command, log):
        self.log = log
        with open(log, "w") as errors:
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, text=True)

    def ask(self, **task):
        """Does one task and gives its answer."""
        try:
            self.process.stdin.write(json.dumps(task) + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            code = self.process.wait()
            sys.exit(f"error: a worker ended with exit code {code}:\n{Path(self.log).read_text()}")
        return json.loads(line)

    def end(self):
        """Lets the worker end, and gives what it wrote to standard error."""
        self.process.stdin.close()
        code = self.process.wait()
        if code != 0:
            sys.exit(f"error: a worker ended with exit code {code}:\n{Path(self.log).read_text()}")
        return Path(self.log).read_text()


def serve(work):
    """What a worker does: a task a line, an answer a line; what else is printed goes to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        answers.write(json.dumps(work(json.loads(line))) + "\n")
        answers.flush()


class Pair:
    """One worker over the program's own Embree, and one over ours for each accelerator."""

    def __init__(self, args, script, python=sys.executable):
        self.folder = tempfile.TemporaryDirectory(prefix="skipgrid-proof-")
        self.path = Path(self.folder.name)
        self.reports = {}
        me = [python, str(Path(script).resolve()), "--worker"]
        self.own = Worker(me, self.path / "own.log")
        self.ours = {}
        for i, accel in enumerate(args.accel or ["nested", "grid"]):
            self.reports[accel] = self.path / f"report{i}"
            self.ours[accel] = Worker(under(args, accel, self.reports[accel]) + me, self.path / f"ours{i}.log")
        self.first = next(iter(self.ours))

    def end(self):
        """Ends all and gives, for each accelerator, what the library reported; a worker that it was not under ends the proof."""
        self.own.end()
        reports = {}
        for accel, worker in self.ours.items():
            log = worker.end()
            file = self.reports[accel]
            lines = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []
            if not lines:
                sys.exit(f"error: with {accel}, nothing went through our library:\n{log}")
            reports[accel] = lines[-1]
        self.folder.cleanup()
        return reports


def in_turns(rounds, sides):
    """Seconds of each side's task in each round; who begins changes, so that neither has the warmer machine."""
    seconds = {name: [] for name in sides}
    for turn in range(rounds):
        for name in sides if turn % 2 == 0 else reversed(sides):
            seconds[name].append(sides[name]()["seconds"])
    return list(seconds.values())


def ratio(own, ours):
    """Medians of seconds, and the median and spread of their ratio in each round."""
    ratios = [b / a for a, b in zip(own, ours)]
    return {
        "own_seconds": statistics.median(own),
        "our_seconds": statistics.median(ours),
        "ratio": statistics.median(ratios),
        "least": min(ratios),
        "greatest": max(ratios),
        "rounds": len(ratios),
    }


def ratio_text(r):
    return f"{r['ratio']:.2f} ({r['least']:.2f}..{r['greatest']:.2f})"


def write_triangles(path, corners):
    """A .tri file from an array of N x 3 x 3 f32."""
    with open(path, "wb") as file:
        file.write(b"TRI1" + len(corners).to_bytes(4, "little") + corners.astype("<f4").tobytes())


def trace(args, triangles, rays, folder, accel="brute"):
    """Exact answers: t and primitive of each ray, from `skipgrid trace`. Rays are N x 8: origin, tmin, direction, tmax."""
    import numpy as np

    files = [str(Path(folder) / name) for name in ["truth.tri", "truth-rays.npy", "truth-hits.npy"]]
    write_triangles(files[0], triangles)
    np.save(files[1], rays.astype("<f4"))
    command = [program(args), "--quiet", "trace", files[0], "--rays", files[1], "--hits", files[2], "--accel", accel]
    subprocess.run(command, check=True)
    return np.load(files[2])


def exact_hit(origin, direction, triangle):
    """The parameter of the ray at the closed triangle, as a fraction, or None: f32 numbers are fractions, and nothing is rounded."""
    o, d = ([Fraction(float(x)) for x in v] for v in (origin, direction))
    a, b, c = ([Fraction(float(x)) - o[k] for k, x in enumerate(v)] for v in triangle)
    cross = lambda u, v: [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    dot = lambda u, v: sum(x * y for x, y in zip(u, v))
    # Volumes of the ray's direction with each edge; the ray passes inside if none has the other sign.
    volumes = [dot(d, cross(u, v)) for u, v in [(b, c), (c, a), (a, b)]]
    if (min(volumes) < 0 < max(volumes)) or not any(volumes):
        return None
    return dot(a, cross([x - y for x, y in zip(b, a)], [x - y for x, y in zip(c, a)])) / sum(volumes)


def write_json(args, value):
    if args.json:
        Path(args.json).write_text(json.dumps(value, indent=1) + "\n")


def finish(failures):
    """Prints the verdict and ends."""
    for failure in failures:
        print(f"FAILED: {failure}")
    print("failed" if failures else "passed")
    sys.exit(1 if failures else 0)
