"""The strategies find what is wrong with a textbook shadow ray, and shrink it."""

import numpy as np
import pytest
from hypothesis import Phase, find, given, settings
from hypothesis.errors import NoSuchExample

import umbrage
from umbrage import Verdict, strategies

SEARCH = settings(max_examples=2000, derandomize=True, database=None, phases=[Phase.generate, Phase.shrink])


def textbook(case, epsilon=1e-3):
    """Shadow rays as they are often written (Möller and Trumbore 1997), with an epsilon against self-shadowing."""
    a, b, c = case.vertices.astype("f8")[case.faces].swapaxes(0, 1)
    *xyz, w = case.light
    shadowed = []
    for point in case.points.astype("f8"):
        ray = np.array(xyz) - point * w
        e1, e2, s = b - a, c - a, point - a
        h, k = np.cross(ray, e2), np.cross(s, e1)
        with np.errstate(all="ignore"):
            det = (e1 * h).sum(axis=1)
            u, v, t = (s * h).sum(axis=1) / det, (k @ ray) / det, (e2 * k).sum(axis=1) / det
            hit = (det != 0) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > epsilon)
        shadowed.append((hit & (t < 1) if w else hit).any())
    return np.array(shadowed)


def exact(case):
    return umbrage.Oracle(case.vertices, case.faces).verdicts(case.points, case.light)


def is_wrong(case):
    verdicts = exact(case)
    decided = verdicts != Verdict.GRAZING
    return bool((textbook(case) != (verdicts == Verdict.SHADOWED))[decided].any())


def test_textbook_shadow_ray_is_found_wrong_and_shrunk():
    case = find(strategies.cases(strategies.closed()), is_wrong, settings=SEARCH)
    assert len(case.faces) == 12 and len(case.points) == 1  # one voxel
    # Fault injected: what is not there is not found.
    with pytest.raises(NoSuchExample):
        find(
            strategies.cases(strategies.closed()),
            lambda case: len(exact(case)) != len(case.points),
            settings=settings(SEARCH, max_examples=100),
        )


def test_soups_shrink_to_their_defect():
    def has(key):
        return lambda mesh: umbrage.check_arrays(*mesh)[key] > 0

    # A face of one vertex, and the three edges of an open face.
    _, faces = find(strategies.soups(), has("collapsed_faces"), settings=SEARCH)
    assert faces.tolist() == [[0, 0, 0]]
    vertices, faces = find(strategies.soups(), has("boundary_edges"), settings=SEARCH)
    assert (len(vertices), len(faces)) == (3, 1)
    assert np.abs(vertices).max() <= 1


def test_everything_that_strategies_speak_of_comes_up():
    seen = dict.fromkeys([*Verdict, "point", "direction", "far", "empty", "sound", "cracked"], 0)
    damage = set()

    @given(strategies.cases(), strategies.damaged(), strategies.lights(), strategies.points())
    def look(case, damaged, light, points):
        for verdict in exact(case):
            seen[Verdict(verdict)] += 1
        *xyz, w = case.light
        seen["point" if w else "direction"] += 1
        seen["far"] += max(map(abs, xyz)) > 100
        seen["empty"] += not len(case.faces)
        report = umbrage.check_arrays(case.vertices, case.faces)
        seen["sound"] += report["verdict"] == "sound"
        seen["cracked"] += report["verdict"] == "cracked"
        assert 1 <= len(damaged.damage) <= 3
        damage.update(damaged.damage)
        assert points.dtype == case.points.dtype == np.float32 and points.shape[1:] == (3,)
        assert light[3] in (0, 1) and (light[3] or any(light[:3]))

    look()
    assert min(seen.values()) > 0, seen
    assert damage == {"removed", "turned", "doubled", "moved", "split"}


@given(strategies.closed())
def test_closed_meshes_are_balanced(mesh):
    assert umbrage.check_arrays(*mesh, require=["balanced"])["verdict"] == "sound"
    # Fault injected: without a face, unless that has collapsed.
    vertices, faces = mesh
    corners = vertices[faces[0]]
    if len(np.unique(corners, axis=0)) == 3:
        assert umbrage.check_arrays(vertices, faces[1:], require=["balanced"])["verdict"] == "cracked"
