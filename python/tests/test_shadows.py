"""Silhouettes, volumes, verdicts and visible fractions: against each other, trimesh and plain references."""

import sys
import threading
import warnings

import numpy as np
import pytest
import trimesh
from hypothesis import assume, given

import umbrage
from umbrage import Verdict, strategies


def winding_number(volume, point):
    """Of a closed volume around a point, by solid angles in double precision (Van Oosterom and Strackee 1983),
    with vertices at infinity; and whether the point is clearly off the surface."""
    v = volume.vertices.astype(np.float64)
    rays = v[:, :3] - v[:, 3:] * point
    length = np.linalg.norm(rays, axis=1)
    if (length == 0).any():
        return 0.0, False
    a, b, c = (rays / length[:, None])[volume.triangles].swapaxes(0, 1)
    dots = [np.einsum("ij,ij->i", p, q) for p, q in ((a, b), (b, c), (c, a))]
    volume6 = np.einsum("ij,ij->i", a, np.cross(b, c))
    rest = 1 + dots[0] + dots[1] + dots[2]
    angles = 2 * np.arctan2(volume6, rest)
    total = angles.sum() / (4 * np.pi)
    # Near a triangle its angle is half of all directions; near an edge it is undefined, 0 to 0.
    clear = (np.abs(np.abs(angles) - 2 * np.pi) > 1e-3).all() and (np.hypot(volume6, rest) > 1e-3).all()
    return total, clear


@given(strategies.cases())
def test_oracle_and_volume_agree(case):
    volume = umbrage.volume(case.vertices, case.faces, case.light)
    assert volume.closed
    verdicts = umbrage.Oracle(case.vertices, case.faces).verdicts(case.points, case.light)
    for point, verdict in zip(case.points.astype(np.float64), verdicts):
        number, clear = winding_number(volume, point)
        if clear and abs(number - round(number)) < 1e-6 and verdict != Verdict.GRAZING:
            assert (round(number) != 0) == (verdict == Verdict.SHADOWED)


def test_oracle_and_volume_would_not_agree_if_one_were_wrong():
    # Fault injected: the volume of another light.
    vertices, faces = umbrage.shapes.torus()
    points = np.random.default_rng(3).uniform(-4, 4, (300, 3)).astype("f4")
    verdicts = umbrage.Oracle(vertices, faces).verdicts(points, "point:1,2,5")
    right, wrong = (umbrage.volume(vertices, faces, light) for light in ["point:1,2,5", "point:3,2,5"])

    def disagree(volume):
        inside = np.array([round(winding_number(volume, point.astype("f8"))[0]) != 0 for point in points])
        return int((inside != (verdicts == Verdict.SHADOWED)).sum())

    assert disagree(right) == 0
    assert disagree(wrong) > 10


@given(strategies.cases(strategies.soups()))
def test_boundary_of_any_volume_cancels(case):
    volume = umbrage.volume(case.vertices, case.faces, case.light, casting="all")
    counts = {}
    for triangle in volume.triangles.tolist():
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            counts[a, b] = counts.get((a, b), 0) + 1
            counts[b, a] = counts.get((b, a), 0) - 1
    assert volume.closed and not any(counts.values())
    assert volume.light_cap + volume.sides + volume.dark_cap == len(volume.triangles)
    finite = volume.vertices[:, 3] == 1
    assert (finite[: len(volume.original)]).all() and not finite[len(volume.original) :].any()
    assert (volume.vertices[finite, :3] == case.vertices[volume.original]).all()


def test_volume_without_caps_is_open_and_says_so():
    volume = umbrage.volume(*umbrage.shapes.cube(), "point:2,5,3", caps="none")
    assert not volume.closed
    assert (volume.light_cap, volume.dark_cap) == (0, 0) and volume.sides > 0
    assert set(volume.choices[0]) == {"what", "why"}


@pytest.mark.parametrize("name, arguments", [("icosphere", (2,)), ("torus", (2.0, 0.7)), ("box", ())])
def test_outline_is_where_the_normals_of_trimesh_change_sides(name, arguments):
    mesh = getattr(trimesh.creation, name)(*arguments)
    mesh = trimesh.Trimesh(mesh.vertices.astype("f4"), mesh.faces, process=False)
    light = np.array([3.1, 4.7, 5.3])
    found = umbrage.silhouette(mesh.vertices, mesh.faces, (*light, 1), casting="front")
    centers = mesh.triangles_center
    front = np.einsum("ij,ij->i", mesh.face_normals, light - centers) > 0
    changes = front[mesh.face_adjacency[:, 0]] != front[mesh.face_adjacency[:, 1]]
    expected = {tuple(sorted(edge)) for edge in mesh.face_adjacency_edges[changes].tolist()}
    assert {tuple(sorted(edge)) for edge in found.edges.tolist()} == expected
    assert expected and (np.abs(found.multiplicity) == 1).all()
    # Fault injected: the light on the other side.
    other = umbrage.silhouette(mesh.vertices, mesh.faces, (*-light, 1), casting="front")
    assert name == "box" or {tuple(sorted(edge)) for edge in other.edges.tolist()} != expected
    # Every loop is closed: each vertex has an even number of its edges.
    for number in set(found.loop.tolist()):
        _, uses = np.unique(found.edges[found.loop == number], return_counts=True)
        assert (uses % 2 == 0).all()


def test_silhouette_names_vertices_of_the_caller():
    vertices, faces = umbrage.shapes.torus()
    soup, corners = vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    plain = umbrage.silhouette(vertices, faces, "point:3,4,5")
    of_soup = umbrage.silhouette(soup, corners, "point:3,4,5")

    def ends(positions, found):
        return sorted(sorted(map(tuple, positions[edge].tolist())) for edge in found.edges)

    assert ends(vertices, plain) == ends(soup, of_soup)
    assert len(umbrage.silhouette(soup, corners, "point:3,4,5", weld="none").edges) > len(plain.edges)


def test_verdicts_are_those_of_the_rays_of_trimesh():
    mesh = trimesh.Trimesh(*umbrage.shapes.torus(), process=False)
    points = np.random.default_rng(1).uniform(-4, 4, (1000, 3)).astype("f4")
    towards = np.array([0.3, 0.45, 0.84], "f4")
    verdicts = umbrage.Oracle(mesh.vertices, mesh.faces).verdicts(points, (*map(float, towards), 0))
    hits = mesh.ray.intersects_any(points, np.broadcast_to(towards, points.shape))
    # Random points: no ties.
    assert set(verdicts.tolist()) == {Verdict.LIT, Verdict.SHADOWED}
    assert (hits == (verdicts == Verdict.SHADOWED)).all()
    # Fault injected: the other direction.
    other = umbrage.Oracle(mesh.vertices, mesh.faces).verdicts(points, (*map(float, -towards), 0))
    assert (hits != (other == Verdict.SHADOWED)).sum() > 50


def test_lights_are_written_in_two_ways():
    oracle = umbrage.Oracle(*umbrage.shapes.torus())
    points = np.random.default_rng(2).uniform(-4, 4, (500, 3)).astype("f4")
    for text, numbers in [("point:1,2,5", (1, 2, 5, 1)), ("directional:-1,-2,-5", np.array([1, 2, 5, 0]))]:
        assert (oracle.verdicts(points, text) == oracle.verdicts(points, numbers)).all()
    assert (oracle.verdicts(points, "point:1,2,5") != oracle.verdicts(points, "directional:1,2,5")).any()


def test_ties_are_grazing():
    oracle = umbrage.Oracle(*umbrage.shapes.cube())
    # Along a side, through an edge, past a corner.
    points = [[-3, 0, 1], [-3, 1, 1], [-3, 0, 0.5]]
    verdicts = oracle.verdicts(points, "directional:-1,0,0")
    assert verdicts.tolist() == [Verdict.GRAZING, Verdict.GRAZING, Verdict.SHADOWED]
    assert verdicts.dtype == np.uint8


@given(strategies.cases())
def test_visible_fraction_is_within_its_bound_of_many_rays(case):
    x, y, z, w = case.light
    assume(w == 1)
    light = f"rect:{x},{y},{z}:1,0,0:0,1,0"
    seen = umbrage.visible_fraction(case.vertices, case.faces, case.points, light)
    oracle = umbrage.Oracle(case.vertices, case.faces)
    assert seen.form is None
    # The same rectangle as the middles of 12 x 12 cells.
    steps = (np.arange(12) + 0.5) / 12
    verdicts = np.array(
        [oracle.verdicts(case.points, (np.float32(x + u), np.float32(y + v), z, 1)) for u in steps for v in steps]
    )
    least, most = (verdicts == Verdict.LIT).mean(axis=0), (verdicts != Verdict.SHADOWED).mean(axis=0)
    known = ~np.isnan(seen.fraction)
    assert ((seen.fraction[known] >= 0) & (seen.fraction[known] <= 1) & (seen.bound[known] >= 0)).all()
    # A light of size 1, up to some faces before it: a straight edge is off by less than 2 cells in 12; the
    # outlines of at most 36 faces by more. Here only all or nothing is judged.
    for fraction, bound, low, high in zip(seen.fraction, seen.bound, least, most):
        if np.isnan(fraction) or bound > 1e-6 or max(map(abs, (x, y, z))) > 1e3:
            continue
        assert not (fraction == 0 and low > 0.5) and not (fraction == 1 and high < 0.5)


def test_visible_fraction_of_half_a_light_is_a_half():
    vertices, faces = umbrage.shapes.cube()
    points = [[1, 0, -5], [9, 9, -5], [0, 0, -5]]
    normals = [[0, 0, 1], [0, 0, 2], [0, 0, 1]]
    light = "point:1,0,5,radius=0.5"
    seen = umbrage.visible_fraction(vertices, faces, points, light, normals=normals)
    assert (np.abs(seen.fraction - [0.5, 1, 0]) <= seen.bound).all() and (seen.bound < 1e-9).all()
    assert seen.form[1] > seen.form[0] > seen.form[2] == 0 or seen.form[2] < 1e-12
    # By an oracle that is there already, the same.
    again = umbrage.Oracle(vertices, faces).visible_fraction(points, light)
    assert (again.fraction == seen.fraction).all() and again.form is None
    # Fault injected: the light moved aside.
    aside = umbrage.visible_fraction(vertices, faces, points, "point:1.1,0,5,radius=0.5")
    assert abs(aside.fraction[0] - 0.5) > 0.05
    in_plane = umbrage.visible_fraction(vertices, faces, [[3, 3, 5]], "rect:0,0,5:1,0,0:0,1,0")
    assert np.isnan(in_plane.fraction[0]) and np.isnan(in_plane.bound[0])


@given(strategies.at_scale(strategies.closed()))
def test_scale_by_a_power_of_two_changes_no_count(mesh):
    vertices, faces = mesh
    report = umbrage.check_arrays(vertices, faces)
    unit = umbrage.check_arrays(vertices / np.abs(vertices).max(), faces)
    assert report["balanced"]
    for key in ["edges", "shells", "max_faces_per_edge", "duplicate_faces"]:
        assert report[key] == unit[key]


@given(strategies.cases(strategies.at_scale(strategies.meshes(), 120)))
def test_any_mesh_has_an_answer(case):
    vertices, faces, light, points = case
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # points far from a small mesh
        assert umbrage.check_arrays(vertices, faces, self_intersections=True)["faces"] == len(faces)
        assert umbrage.volume(vertices, faces, light).closed
        prepared = umbrage.prepare(vertices, faces, orient=True, stitch=True, split=True, fill=True)
        assert np.isfinite(prepared.vertices).all()
        assert len(umbrage.Oracle(vertices, faces).verdicts(points, light)) == len(points)
        for method in ["rays", "exact"]:
            openness = umbrage.ambient(vertices, faces, method=method, rays=4).openness
            assert ((openness >= 0) & (openness <= 1)).all()


def other_thread_runs_during(work):
    """Whether another thread runs before a call returns, if threads are not switched otherwise."""
    started, done = threading.Event(), []

    def call():
        started.set()
        work()
        done.append(True)

    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    try:
        thread = threading.Thread(target=call)
        thread.start()
        started.wait()
        return not done
    finally:
        sys.setswitchinterval(interval)
        thread.join()


@pytest.mark.skipif(not getattr(sys, "_is_gil_enabled", lambda: True)(), reason="there is no lock")
def test_interpreter_is_not_locked_meanwhile():
    vertices, faces = umbrage.shapes.torus(60, 40)
    oracle = umbrage.Oracle(vertices, faces)
    points = np.random.default_rng(2).uniform(-3, 3, (50_000, 3)).astype("f4")
    calls = [
        lambda: oracle.verdicts(points, "point:1,2,5"),
        lambda: umbrage.ambient(vertices, faces, rays=16),
        lambda: umbrage.Oracle(vertices, faces),
        lambda: umbrage.check_arrays(vertices, faces, self_intersections=True),
        lambda: umbrage.volume(vertices, faces, "point:1,2,5"),
        lambda: umbrage.prepare(vertices, faces, stitch=True),
    ]
    for call in calls:
        # The other thread may not be scheduled in time, but not again and again.
        assert any(other_thread_runs_during(call) for _ in range(20))
    # Fault injected: work in Python.
    assert not any(other_thread_runs_during(lambda: sum(range(100_000))) for _ in range(20))


def test_ambient_by_rays_is_near_the_exact_form():
    vertices, faces = umbrage.shapes.torus(12, 8)
    exact = umbrage.ambient(vertices, faces, method="exact")
    rays = umbrage.ambient(vertices, faces, rays=256, bent=True)
    assert (exact.points == rays.points).all() and (exact.corners == rays.corners).all()
    assert exact.openness.dtype == np.float64 and rays.openness.dtype == np.float32
    assert exact.bound < 1e-6 and exact.standard_error is None and rays.bound is None
    # Ten standard errors, which the rays estimate themselves.
    off = np.abs(exact.openness - rays.openness).max()
    assert off < 10 * rays.standard_error < 0.1
    assert exact.openness.min() < 0.9  # the hole of the torus
    # Fault injected: faces that hide nothing.
    near = umbrage.ambient(vertices, faces, rays=256, distance=1e-3)
    assert np.abs(exact.openness - near.openness).max() > 10 * rays.standard_error
    assert np.linalg.norm(rays.bent, axis=1) == pytest.approx(1, abs=1e-6)
    assert exact.corners.shape == faces.shape and exact.corners.max() == len(exact.openness) - 1
    assert len(umbrage.ambient(vertices, faces, per="face", rays=1).openness) == len(faces)
    a, b = (umbrage.ambient(vertices, faces, seed=seed).openness for seed in (1, 2))
    assert (a != b).any() and (a == umbrage.ambient(vertices, faces).openness).all()
