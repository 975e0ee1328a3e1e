"""Small meshes to try things with: vertices (n, 3) float32 and faces (m, 3) uint32, wound outwards."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["cube", "tetrahedron", "torus"]

_Arrays = tuple[NDArray[np.float32], NDArray[np.uint32]]


def cube() -> _Arrays:
    """The cube from -1 to 1: 8 vertices, 12 faces.

    >>> vertices, faces = cube()
    >>> vertices.shape, faces.shape
    ((8, 3), (12, 3))
    """
    vertices = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    return vertices, quads[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3).astype(np.uint32)


def tetrahedron() -> _Arrays:
    """The corner of a unit cube: 4 vertices, 4 faces."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32)
    return vertices, np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.uint32)


def torus(around: int = 24, along: int = 12, major: float = 2.0, minor: float = 0.7) -> _Arrays:
    """A torus about the z axis: around * along vertices, twice as many faces; 3 or more each way.

    >>> vertices, faces = torus(6, 4)
    >>> len(vertices), len(faces)
    (24, 48)
    """
    if around < 3 or along < 3:
        raise ValueError(f"a torus needs 3 steps each way, not {around} and {along}")
    u, v = np.meshgrid(np.arange(around), np.arange(along), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / along
    radius = major + minor * np.cos(b)
    vertices = np.stack([radius * np.cos(a), radius * np.sin(a), minor * np.sin(b)], axis=-1).reshape(-1, 3)

    def at(du: int, dv: int) -> NDArray[np.int64]:
        return ((u + du) % around * along + (v + dv) % along).ravel()

    low = np.stack([at(0, 0), at(1, 0), at(1, 1)], axis=-1)
    high = np.stack([at(0, 0), at(1, 1), at(0, 1)], axis=-1)
    return vertices.astype(np.float32), np.concatenate([low, high]).astype(np.uint32)
