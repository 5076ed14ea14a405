"""Compares accelerators on a scene: build time, memory, speed in interleaved rounds, and work for each ray.

    python compare.py [SCENE] [--accel A]... [--rays N] [--rounds N] [--threads N] [--plot FILE.png]

The scene is a file or a formula such as "random:n=100000". The first accelerator is the one that others are compared with.
Answers must be equal to the bit, or the exit code is 1; peers with a primitive test of their own are counted instead.
"""

import argparse
import sys
import time

import numpy as np

import skipgrid


def rays_through(bounds, count, seed=1):
    """Rays (n, 8) from around the scene towards random points of its box, as a camera that moves would send them."""
    random = np.random.default_rng(seed)
    low, high = bounds.astype(np.float64)
    centre, size = (low + high) / 2, np.linalg.norm(high - low)
    outward = random.normal(size=(count, 3))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    rays = np.empty((count, 8), np.float32)
    rays[:, 0:3] = centre + outward * size
    rays[:, 3] = 0
    rays[:, 4:7] = low + random.random((count, 3)) * (high - low) - rays[:, 0:3]
    rays[:, 7] = np.inf
    return rays


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="bumpy")
    parser.add_argument("--accel", action="append")
    parser.add_argument("--rays", type=int, default=200_000)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--plot")
    options = parser.parse_args()
    if options.rays < 1 or options.rounds < 1:
        parser.error("--rays and --rounds are at least 1")
    names = options.accel or ["nested", "grid", "grid-octant", "obvhs-cwbvh", "obvhs-bvh2"]
    exact = {entry["name"]: entry["exact"] for entry in skipgrid.accelerators()}

    try:
        builds, accels = [], []
        for name in names:
            start = time.perf_counter()
            # With the time to read the scene, which is subtracted below.
            accels.append(skipgrid.load(options.scene, name))
            builds.append(time.perf_counter() - start)
        start = time.perf_counter()
        skipgrid.load(options.scene, "brute")
        reading = time.perf_counter() - start
        rays = rays_through(accels[0].bounds, options.rays)
        answers = [accel.closest_hit(rays, threads=options.threads) for accel in accels]
    except (ValueError, MemoryError) as error:
        parser.error(str(error))
    except OSError as error:
        print(f"error: {error}", file=sys.stderr)
        return 3

    seconds = np.empty((options.rounds, len(names)))
    for turn in range(options.rounds):
        for i in np.roll(np.arange(len(names)), -turn):
            start = time.perf_counter()
            accels[i].closest_hit(rays, threads=options.threads)
            seconds[turn, i] = time.perf_counter() - start
    rates = options.rays / seconds / 1e6
    ratios = seconds[:, :1] / seconds

    print(f"{options.scene}: {len(accels[0])} primitives, {options.rays} rays, {options.threads} threads")
    print(f"{'':20} {'build ms':>9} {'MiB':>8} {'Mrays/s':>8} {'ratio':>20} {'steps':>8} {'tests':>8} {'differ':>8}")
    failed = False
    for i, name in enumerate(names):
        counts = accels[i].statistics(rays)
        differ = int(np.count_nonzero((answers[i][0] != answers[0][0]) | (answers[i][1] != answers[0][1])))
        failed |= differ > 0 and exact[name.partition(":")[0]]
        ratio = f"{np.median(ratios[:, i]):.2f} ({ratios[:, i].min():.2f}, {ratios[:, i].max():.2f})"
        print(
            f"{name:20} {max(builds[i] - reading, 0) * 1e3:9.1f} {accels[i].memory['total'] / 2**20:8.1f} "
            f"{np.median(rates[:, i]):8.3f} {ratio:>20} {counts['steps'] / options.rays:8.2f} "
            f"{counts['tests'] / options.rays:8.2f} {differ:8}"
        )
    if options.plot:
        try:
            plot(options, names, rates)
        except (OSError, ValueError) as error:  # no such folder, or no such format
            print(f"error: {error}", file=sys.stderr)
            return 3
    return 1 if failed else 0


def plot(options, names, rates):
    """Bars of the medians, with the least and the greatest round."""
    try:
        import matplotlib
    except ImportError:
        print("no plot: matplotlib is not installed", file=sys.stderr)
        return
    matplotlib.use("Agg")
    from matplotlib import pyplot

    middle = np.median(rates, axis=0)
    figure, axes = pyplot.subplots(figsize=(7, 1 + 0.5 * len(names)), layout="constrained")
    axes.barh(names, middle, xerr=[middle - rates.min(0), rates.max(0) - middle], color="#4c72b0", capsize=3)
    axes.invert_yaxis()
    axes.set(xlabel="million rays a second", title=f"{options.scene}, {options.threads} threads")
    figure.savefig(options.plot, dpi=120)


if __name__ == "__main__":
    sys.exit(main())
