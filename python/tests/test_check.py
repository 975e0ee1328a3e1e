"""The crack report: against the command, against trimesh, and of files."""

import json
import os
import pathlib
import subprocess

import numpy as np
import pytest
import trimesh
from hypothesis import given

import umbrage
from umbrage import strategies

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
FILES = sorted(path for path in DATA.glob("*/*") if path.suffix in {".obj", ".glb", ".ply", ".stl"})
COMMAND = os.environ.get("UMBRAGE_COMMAND")


def by_command(path, *options):
    done = subprocess.run([COMMAND, "check", str(path), "--json", *options], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return json.loads(done.stdout)


@pytest.mark.skipif(not COMMAND, reason="UMBRAGE_COMMAND names no command")
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_report_has_the_keys_and_values_of_the_command(path):
    said = by_command(path, "--self-intersections", "--limit", "3")
    report = umbrage.check(path, self_intersections=True, limit=3)
    assert report["verdict"] == said["verdict"]
    assert isinstance(report.pop("notes"), list)
    assert report == said["files"][0]
    assert list(report) == list(said["files"][0])
    for mesh, expected in zip(report["meshes"], said["files"][0]["meshes"]):
        assert list(mesh) == list(expected)
    # Fault injected: another weld.
    if path.stem == "soup_of_octahedron":
        assert umbrage.check(path, weld="none")["total"] != report["total"]


@pytest.mark.skipif(not COMMAND, reason="UMBRAGE_COMMAND names no command")
@pytest.mark.parametrize("scope", ["primitive", "mesh", "scene"])
def test_report_of_a_placed_scene_is_that_of_the_command(scope, tmp_path):
    # Two nodes with one mesh, one of them mirrored and scaled.
    scene = trimesh.Scene()
    mesh = trimesh.Trimesh(*umbrage.shapes.cube(), process=False)
    mesh.update_faces(np.arange(12) != 4)
    scene.add_geometry(mesh, node_name="one", geom_name="mesh")
    placed = np.diag([-2.0, 3.0, 0.5, 1.0])
    placed[:3, 3] = [10, 20, 0.25]
    scene.graph.update("two", matrix=placed, geometry="mesh")
    path = tmp_path / "two.glb"
    path.write_bytes(scene.export(file_type="glb"))
    said = by_command(path, "--scope", scope)
    report = umbrage.check(path, scope=scope)
    assert report["verdict"] == said["verdict"] == "cracked"
    report.pop("notes")
    assert report == said["files"][0]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_arrays_of_a_file_have_the_report_of_the_file(path):
    report = umbrage.check(path)
    for mesh, expected in zip(umbrage.read(path), report["meshes"]):
        found = umbrage.check_arrays(mesh.vertices, mesh.faces)
        keys = set(expected) - {"name", "shell_origins", "defects"}
        assert {key: found[key] for key in keys} == {key: expected[key] for key in keys}
        assert [(d["kind"], d["count"]) for d in found["defects"]] == [
            (d["kind"], d["count"]) for d in expected["defects"]
        ]


@pytest.mark.parametrize(
    "name", ["icosphere", "box", "torus", "cylinder", "capsule", "annulus"]
)
def test_counts_of_sound_shapes_are_those_of_trimesh(name):
    arguments = {"torus": (2.0, 0.5), "cylinder": (1.0, 2.0), "annulus": (0.5, 1.0, 2.0)}.get(name, ())
    mesh = getattr(trimesh.creation, name)(*arguments)
    report = umbrage.check_arrays(mesh.vertices, mesh.faces)
    assert report["watertight"] == mesh.is_watertight is True
    assert report["verdict"] == "sound"
    assert report["edges"] == len(mesh.edges_unique)
    assert report["euler_characteristic"] == mesh.euler_number
    # trimesh adds up in double precision from unrounded positions: 2**-24 of each factor, of about 1 here.
    assert report["signed_volume"] == pytest.approx(mesh.volume, rel=2.0**-20)


def edges_by_direction(mesh):
    """For each edge, how often its faces run along it, and against it; faces without an own edge left out."""
    counts = {}
    for a, b in mesh.edges:
        pair = counts.setdefault((min(a, b), max(a, b)), [0, 0])
        pair[int(a > b)] += 1
    return counts


@given(strategies.meshes())
def test_edges_of_hard_meshes_are_those_that_trimesh_lists(mesh):
    vertices, faces = mesh
    report = umbrage.check_arrays(vertices, faces, weld="none")
    kept = [face for face in faces.tolist() if len(set(face)) == 3]
    assert report["collapsed_faces"] == len(faces) - len(kept)
    counts = edges_by_direction(trimesh.Trimesh(vertices, kept, process=False)) if kept else {}
    assert report["edges"] == len(counts)
    assert report["boundary_edges"] == sum(sum(pair) == 1 for pair in counts.values())
    assert report["non_manifold_edges"] == sum(sum(pair) > 2 for pair in counts.values())
    assert report["balanced"] == all(a == b for a, b in counts.values())
    # Fault injected: one more face. It turns up.
    if kept:
        more = umbrage.check_arrays(vertices, [*faces.tolist(), kept[0]], weld="none")
        assert (more["faces"], more["balanced"]) != (report["faces"], report["balanced"])


def test_unreadable_files_are_exceptions_with_fields(tmp_path):
    path = tmp_path / "bad.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 nine\n")
    with pytest.raises(umbrage.ReadError) as caught:
        umbrage.check(path)
    error = caught.value
    assert (error.file, error.format, error.place, error.line, error.byte) == (str(path), "obj", "line 4", 4, None)
    assert str(error) == f"{path}, line 4 (obj): {error.problem}; {error.remedy}"
    with pytest.raises(umbrage.ReadError, match="check the path") as caught:
        umbrage.check(str(tmp_path / "none.obj"))
    assert caught.value.line is None
    with pytest.raises(umbrage.ReadError, match="directory"):
        umbrage.read(tmp_path)
    with pytest.raises(TypeError, match="os.PathLike"):
        umbrage.check(7)


def test_requirements_are_judged_as_asked():
    vertices, faces = umbrage.shapes.cube()
    open_cube = umbrage.check_arrays(vertices, faces[2:], require=["manifold"])
    assert open_cube["verdict"] == "sound"
    holds = {asked["name"]: asked["holds"] for asked in open_cube["requirements"]}
    assert holds == {"manifold": True, "not-empty": True}
    assert umbrage.check_arrays(vertices, faces[2:], require=["watertight"])["verdict"] == "cracked"


def test_prepare_lists_its_changes():
    vertices, faces = umbrage.shapes.torus(9, 6)
    faces[5] = faces[5][::-1]
    faces = np.delete(faces, [0, 54], axis=0)  # the two halves of a quad
    soup, corners = vertices[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)
    prepared = umbrage.prepare(soup, corners, orient=True, fill=True)
    assert umbrage.check_arrays(prepared.vertices, prepared.faces, weld="none")["verdict"] == "sound"
    counts = {}
    for step in prepared.steps:
        counts[step["name"]] = counts.get(step["name"], 0) + step["count"]
        assert step["largest_move"] == 0
        assert len(step["changes"]) == step["count"] + step["left"]
    assert (counts["weld"], counts["orient"], counts["fill"]) == (len(soup) - 54, 1, 1)
    # Fault injected: without the step the hole stays, and with another limit too.
    left = umbrage.prepare(soup, corners, orient=True)
    assert umbrage.check_arrays(left.vertices, left.faces, weld="none")["verdict"] == "cracked"
    small = umbrage.prepare(soup, corners, orient=True, fill=3)
    assert [(step["count"], step["left"]) for step in small.steps if step["name"] == "fill"] == [(0, 1)]
