from os import PathLike
from typing import TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
__all__: list[str]

MISS: int
"""What prim is where nothing is hit: 0xffffffff."""

class Entry(TypedDict):
    name: str
    summary: str
    options: str
    source: str
    exact: bool
    missing: str | None

class Memory(TypedDict):
    structure: int
    references: int
    tables: int
    total: int

class Statistics(TypedDict):
    rays: int
    steps: int
    leaps: int
    leaves: int
    tests: int

class Accel:
    def __init__(
        self, vertices: ArrayLike, faces: ArrayLike, accel: str = "nested", *, threads: int | None = None
    ) -> None: ...
    def closest_hit(
        self, rays: ArrayLike, directions: ArrayLike | None = None, *, threads: int | None = None
    ) -> tuple[NDArray[np.float32], NDArray[np.uint32]]: ...
    def any_hit(
        self, rays: ArrayLike, directions: ArrayLike | None = None, *, threads: int | None = None
    ) -> NDArray[np.bool_]: ...
    def exact_hit(
        self, rays: ArrayLike, directions: ArrayLike | None = None, *, threads: int | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.uint32]]: ...
    def statistics(
        self, rays: ArrayLike, directions: ArrayLike | None = None, *, any: bool = False, threads: int | None = None
    ) -> Statistics: ...
    def describe(self) -> str: ...
    @property
    def accel(self) -> str: ...
    @property
    def bounds(self) -> NDArray[np.float32]: ...
    @property
    def memory(self) -> Memory: ...
    @property
    def triangles(self) -> NDArray[np.float32]: ...
    def __len__(self) -> int: ...

def spheres(
    centres: ArrayLike, radii: ArrayLike, accel: str = "nested", *, threads: int | None = None
) -> Accel: ...
def load(
    scene: str | PathLike[str], accel: str = "nested", *, drop_invalid: bool = False, threads: int | None = None
) -> Accel: ...
def accelerators() -> list[Entry]: ...
