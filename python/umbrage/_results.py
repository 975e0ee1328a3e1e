"""The results that are more than one array: named tuples. Arrays are not copied on their way here."""

from __future__ import annotations

from enum import IntEnum
from typing import Any, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray


class Verdict(IntEnum):
    """Whether a point sees a light."""

    LIT = 0
    """The open segment to the light does not touch the surface."""
    SHADOWED = 1
    """It crosses a face."""
    GRAZING = 2
    """It touches the surface without crossing a face: both answers are right."""


class Mesh(NamedTuple):
    """A mesh of a file."""

    name: str
    """Its name in the file; may be empty."""
    vertices: NDArray[np.float32]
    """Positions, shape (n, 3)."""
    faces: NDArray[np.uint32]
    """Three vertices a face, shape (m, 3)."""


class Prepared(NamedTuple):
    """A repaired mesh."""

    vertices: NDArray[np.float32]
    """Positions, shape (k, 3)."""
    faces: NDArray[np.uint32]
    """Three vertices a face, shape (j, 3)."""
    steps: list[dict[str, Any]]
    """What each step did: name, count, left, changes, largest_move."""
    rounding: float
    """How far rounding to float32 moved a coordinate at most."""


class Silhouette(NamedTuple):
    """The silhouette edges of a mesh for a light."""

    edges: NDArray[np.uint32]
    """Two vertices an edge, shape (k, 2)."""
    multiplicity: NDArray[np.int32]
    """The signed sum of the sides of the edge's faces, shape (k,); never 0."""
    loop: NDArray[np.uint32]
    """The connected component of each edge, shape (k,)."""
    rounding: float
    """How far rounding to float32 moved a coordinate at most."""


class Volume(NamedTuple):
    """A shadow volume."""

    vertices: NDArray[np.float32]
    """Homogeneous positions, shape (k, 4): w is 1, or 0 at infinity."""
    triangles: NDArray[np.uint32]
    """Three vertices a triangle, shape (t, 3): light cap, sides, dark cap."""
    light_cap: int
    """Triangles of the light cap, which come first."""
    sides: int
    """Triangles of the sides, which come next."""
    dark_cap: int
    """Triangles of the dark cap, which come last; none for a directional light."""
    original: NDArray[np.uint32]
    """The vertex of the mesh behind each vertex with w = 1, shape (j,)."""
    closed: bool
    """The certificate: whether the boundary of the triangles cancels edge by edge."""
    choices: list[dict[str, str]]
    """For each shell, what casts ("general", "front", "back") and why."""
    rounding: float
    """How far rounding to float32 moved a coordinate at most."""


class Visible(NamedTuple):
    """How much of a light with an extent each point sees."""

    fraction: NDArray[np.float64]
    """The visible share of the light's area, 0 to 1, shape (k,); NaN where nothing can be told."""
    bound: NDArray[np.float64]
    """The truth differs from it by no more than this, shape (k,)."""
    form: Optional[NDArray[np.float64]]
    """The irradiance over pi times the radiance of the light, shape (k,); None without normals."""


class Ambient(NamedTuple):
    """Openness of a mesh's surface."""

    openness: NDArray[np.floating[Any]]
    """The share of the sky that is open, 0 to 1, shape (k,)."""
    points: NDArray[np.float32]
    """Where, shape (k, 3)."""
    normals: NDArray[np.float32]
    """The normals there, shape (k, 3); NaN where two sides of a sheet meet."""
    corners: NDArray[np.uint32]
    """For each corner of a face the index of its value, shape (m, 3)."""
    bent: Optional[NDArray[np.float32]]
    """The mean open direction, shape (k, 3); None unless asked for."""
    inside: NDArray[np.uint32]
    """Values inside the solid of another shell, ascending."""
    standard_error: Optional[float]
    """Of one value, estimated from its rays; None for exact values."""
    bound: Optional[float]
    """No exact value differs from the truth by more than this; None by rays."""
    rounding: float
    """How far rounding to float32 moved a coordinate at most."""
