"""Exact ray casting against triangles, spheres and voxels, with grids and BVHs that can be swapped.

    import numpy as np, skipgrid

    mesh = skipgrid.Accel(vertices, faces)            # or skipgrid.load("room.glb", "grid-octant")
    t, prim = mesh.closest_hit(origins, directions)   # t = inf and prim = skipgrid.MISS where nothing is hit
    dark = mesh.any_hit(rays)                         # (n, 8): ox oy oz tmin dx dy dz tmax

Answers are exact: every accelerator, on any number of threads, gives the same primitive and the same bits of t.
"""

from ._skipgrid import MISS, Accel, __version__, accelerators, load, spheres

__all__ = ["MISS", "Accel", "__version__", "accelerators", "load", "spheres"]
