"""Meshes and rays made by formula, seeded."""

import numpy as np


def square():
    """The unit square at z = 0 in two triangles: (vertices, faces)."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    return vertices, np.array([[0, 1, 2], [0, 2, 3]])


def bumpy(n):
    """A closed ball of radius 1 with bumps of 0.1; 4 n (n - 1) triangles."""
    v, u = np.meshgrid(np.linspace(0, np.pi, n + 1)[1:-1], np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), indexing="ij")
    ball = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], -1).reshape(-1, 3)
    ball = np.concatenate([ball, [[0, 1, 0], [0, -1, 0]]])
    ball *= 1 + 0.1 * np.prod(np.sin(5 * ball), axis=1, keepdims=True)
    row, column = np.meshgrid(np.arange(n - 2), np.arange(2 * n), indexing="ij")
    a, b = row * 2 * n + column, row * 2 * n + (column + 1) % (2 * n)
    sides = np.stack([np.stack([a, b, a + 2 * n], -1), np.stack([b, b + 2 * n, a + 2 * n], -1)], 2).reshape(-1, 3)
    i, last, top = np.arange(2 * n), (n - 2) * 2 * n, len(ball) - 2
    caps = [np.stack([(i + 1) % (2 * n), i, np.full(2 * n, top)], -1)]
    caps.append(np.stack([last + i, last + (i + 1) % (2 * n), np.full(2 * n, top + 1)], -1))
    return ball.astype(np.float32), np.concatenate([sides, *caps])


def rays_around(vertices, count):
    """Rays from a box three times as large through it: half towards vertices, half into random directions."""
    random = np.random.default_rng(count)
    low, high = vertices.min(0), vertices.max(0)
    origins = (low + (3 * random.random((count, 3)) - 1) * (high - low)).astype(np.float32)
    directions = random.normal(size=(count, 3)).astype(np.float32)
    directions[::2] = vertices[random.integers(len(vertices), size=len(origins[::2]))] - origins[::2]
    return origins, directions
