"""Hypothesis strategies: meshes, lights and points that are hard for shadows, and shrink well.

As those of the crate for proptest: sizes are small, coordinates are small integers unless scaled, and a failure
ends at few faces. A mesh is a pair of arrays, vertices (n, 3) float32 and faces (m, 3) uint32.

- meshes: `soups`, `closed`, `damaged`, any of them `meshes`; `at_scale` of one of these
- lights: `lights`, homogeneous coordinates, and for a given mesh `lights_at`
- points: `points`, and for a given mesh and light `points_at`
- all three together: `cases`

Your own shadows against the exact ray cast::

    @given(umbrage.strategies.cases(umbrage.strategies.closed()))
    def test_my_shadows(case):
        verdicts = umbrage.Oracle(case.vertices, case.faces).verdicts(case.points, case.light)
        mine = my_shadows(case.vertices, case.faces, case.points, case.light)
        decided = verdicts != umbrage.Verdict.GRAZING  # an exact tie: both answers are right
        assert (mine[decided] == (verdicts[decided] == umbrage.Verdict.SHADOWED)).all()
"""

from __future__ import annotations

from typing import Any, NamedTuple, Optional

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

__all__ = [
    "Case",
    "Damaged",
    "at_scale",
    "cases",
    "closed",
    "damaged",
    "lights",
    "lights_at",
    "meshes",
    "points",
    "points_at",
    "soups",
]

_Mesh = tuple[NDArray[np.float32], NDArray[np.uint32]]
_Light = tuple[float, float, float, float]

# Coordinates are integers up to this, and points lie at halves of them: many exact ties.
_LARGEST = 4


class Damaged(NamedTuple):
    """A mesh, and what was done to it."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    damage: list[str]
    """"removed", "turned", "doubled" a face, "moved" a vertex, "split" a corner from its vertex."""


class Case(NamedTuple):
    """A mesh, a light, and points that may see it."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]
    light: _Light
    """Homogeneous: (x, y, z, 1) a point, (x, y, z, 0) the direction towards the light."""
    points: NDArray[np.float32]
    """Shape (k, 3), k at least 1."""


def _mesh(vertices: list[Any], faces: list[Any]) -> _Mesh:
    return (
        np.array(vertices, np.float32).reshape(-1, 3),
        np.array(faces, np.uint32).reshape(-1, 3),
    )


def _places(largest: int = _LARGEST) -> st.SearchStrategy[tuple[int, int, int]]:
    number = st.integers(-largest, largest)
    return st.tuples(number, number, number)


@st.composite
def soups(draw: st.DrawFn, max_faces: int = 12) -> _Mesh:
    """Faces between few vertices, anyhow: open, non-manifold, collapsed, doubled. May be empty.

    >>> from hypothesis import find
    >>> vertices, faces = find(soups(), lambda mesh: len(mesh[1]) >= 2)
    >>> faces.tolist()
    [[0, 0, 0], [0, 0, 0]]
    """
    corner = st.integers(0, 9)
    drawn = draw(st.lists(st.tuples(corner, corner, corner), max_size=max_faces))
    # A place for each vertex that there is, so that fewer faces have fewer vertices; and some of no face.
    used = list(dict.fromkeys(corner for face in drawn for corner in face))
    vertices = [draw(_places()) for _ in used] + draw(st.lists(_places(), max_size=2))
    return _mesh(vertices, [[used.index(corner) for corner in face] for face in drawn])


# The four corners of a voxel's side, counter-clockwise seen from outside, for each direction.
_SIDES = (
    ((-1, 0, 0), ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0))),
    ((1, 0, 0), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))),
    ((0, -1, 0), ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1))),
    ((0, 1, 0), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0))),
    ((0, 0, -1), ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0))),
    ((0, 0, 1), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))),
)


@st.composite
def closed(draw: st.DrawFn, max_voxels: int = 6) -> _Mesh:
    """The surface of a solid of voxels, some of its vertices moved: every edge is balanced, wound outwards
    where nothing was moved. Voxels may meet in an edge or a corner. At least one voxel.

    >>> from hypothesis import find
    >>> vertices, faces = find(closed(), lambda mesh: True)
    >>> vertices.shape, faces.shape
    ((8, 3), (12, 3))
    """
    cell = st.tuples(*[st.integers(0, 2)] * 3)
    voxels = set(draw(st.lists(cell, min_size=1, max_size=max_voxels, unique=True)))
    numbers: dict[tuple[int, int, int], int] = {}
    faces = []
    for voxel in sorted(voxels):
        for step, corners in _SIDES:
            if tuple(a + b for a, b in zip(voxel, step)) in voxels:
                continue
            ids = []
            for corner in corners:
                place = tuple(a + b for a, b in zip(voxel, corner))
                ids.append(numbers.setdefault(place, len(numbers)))
            faces += [[ids[0], ids[1], ids[2]], [ids[0], ids[2], ids[3]]]
    vertices = [list(place) for place in numbers]
    for which, place in draw(st.lists(st.tuples(st.integers(0, 63), _places()), max_size=3)):
        vertices[which % len(vertices)] = list(place)
    return _mesh(vertices, faces)


@st.composite
def damaged(draw: st.DrawFn, of: Optional[st.SearchStrategy[_Mesh]] = None, max_damage: int = 3) -> Damaged:
    """A mesh (by default `closed`) to which 1 to ``max_damage`` things were done."""
    vertices, faces = draw(closed() if of is None else of)
    places, corners = vertices.tolist(), faces.tolist()
    kinds = st.sampled_from(["removed", "turned", "doubled", "moved", "split"])
    damage = []
    for kind, which in draw(st.lists(st.tuples(kinds, st.integers(0, 255)), min_size=1, max_size=max_damage)):
        if not corners:
            break
        face = which % len(corners)
        if kind == "removed":
            del corners[face]
        elif kind == "turned":
            corners[face] = corners[face][::-1]
        elif kind == "doubled":
            corners.append(list(corners[face]))
        elif kind == "moved":
            places[corners[face][0]][which % 3] += 1
        else:
            # Near its vertex, but not equal to it: a crack.
            places.append([x + 2.0**-10 for x in places[corners[face][0]]])
            corners[face] = [len(places) - 1, *corners[face][1:]]
        damage.append(kind)
    return Damaged(*_mesh(places, corners), damage)


def meshes() -> st.SearchStrategy[_Mesh]:
    """Any of `closed`, `damaged` and `soups`."""
    return st.one_of(closed(), damaged().map(lambda mesh: (mesh.vertices, mesh.faces)), soups())


def at_scale(of: st.SearchStrategy[_Mesh], largest: int = 30) -> st.SearchStrategy[_Mesh]:
    """Meshes scaled by a power of two, 2**-largest to 2**largest: exactly, below 90."""
    powers = st.integers(-largest, largest)
    return st.tuples(of, powers).map(lambda drawn: (np.ldexp(drawn[0][0], drawn[1]), drawn[0][1]))


def lights(largest: int = 8) -> st.SearchStrategy[_Light]:
    """Homogeneous lights: a point, or a direction that is not zero."""
    place = _places(largest)
    directions = place.filter(any).map(lambda xyz: (*map(float, xyz), 0.0))
    return st.one_of(place.map(lambda xyz: (*map(float, xyz), 1.0)), directions)


def _at(point: NDArray[np.float32]) -> _Light:
    """A light at a point."""
    x, y, z = map(float, point)
    return (x, y, z, 1.0)


@st.composite
def _spot(draw: st.DrawFn, mesh: _Mesh) -> NDArray[np.float32]:
    """A point at a vertex, at the middle of an edge or of a face, or anywhere."""
    vertices, faces = mesh
    kind = draw(st.sampled_from(["anywhere", "vertex", "edge", "face"]))
    if kind == "anywhere" or not len(faces):
        return np.array(draw(_places(2 * _LARGEST)), np.float32) / np.float32(2)
    a, b, c = vertices[faces[draw(st.integers(0, len(faces) - 1))]].astype(np.float64)
    corners = {"vertex": [a], "edge": [a, b], "face": [a, b, c]}[kind]
    return np.array(sum(corners) / len(corners), np.float32)


@st.composite
def lights_at(draw: st.DrawFn, mesh: _Mesh) -> _Light:
    """Lights for a mesh: anywhere, on it, in the plane of a face or within some ulps of it, far away."""
    vertices, faces = mesh
    kind = draw(st.sampled_from(["anywhere", "on", "plane", "far"]))
    if kind == "anywhere" or not len(faces):
        return draw(lights())
    if kind == "on":
        return _at(draw(_spot(mesh)))
    if kind == "far":
        power = draw(st.integers(10, 40))
        x, y, z, w = draw(lights())
        return (x * 2.0**power, y * 2.0**power, z * 2.0**power, w)
    a, b, c = vertices[faces[draw(st.integers(0, len(faces) - 1))]].astype(np.float64)
    u, v = draw(st.integers(-3, 3)), draw(st.integers(-3, 3))
    light = (a + u * (b - a) + v * (c - a)).astype(np.float32)
    axis, ulps = draw(st.integers(0, 2)), draw(st.integers(-2, 2))
    light[axis] += np.float32(ulps) * np.spacing(light[axis])
    return _at(light)


def points(max_points: int = 8) -> st.SearchStrategy[NDArray[np.float32]]:
    """Points anywhere around the meshes, shape (k, 3), k at least 1."""
    halves = st.lists(_places(2 * _LARGEST), min_size=1, max_size=max_points)
    return halves.map(lambda list: np.array(list, np.float32) / np.float32(2))


@st.composite
def points_at(draw: st.DrawFn, mesh: _Mesh, light: _Light, max_points: int = 8) -> NDArray[np.float32]:
    """Points for a mesh and a light: anywhere, on the mesh, or behind a point of it as seen from the light,
    where a shadow begins and ends. Shape (k, 3), k at least 1."""
    found = []
    for _ in range(draw(st.integers(1, max_points))):
        spot = draw(_spot(mesh)).astype(np.float64)
        times = draw(st.sampled_from([0.0, 0.5, 1.0, 2.0]))
        *xyz, w = light
        away = spot * w - np.array(xyz)
        # A light far away would take the point with it.
        away /= max(1.0, np.abs(away).max() / 8)
        found.append(spot + times * away)
    return np.array(found).astype(np.float32)


@st.composite
def cases(draw: st.DrawFn, of: Optional[st.SearchStrategy[_Mesh]] = None, max_points: int = 8) -> Case:
    """A mesh (by default any of `meshes`) with a light and points that are hard for it."""
    mesh = draw(meshes() if of is None else of)
    light = draw(lights_at(mesh))
    return Case(*mesh, light, draw(points_at(mesh, light, max_points)))
