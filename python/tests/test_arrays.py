"""What is read of arrays, what rounding does to them, and how bad ones are refused."""

import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest

import umbrage

VERTICES, FACES = umbrage.shapes.cube()


def same(vertices, faces):
    return umbrage.check_arrays(vertices, faces) == umbrage.check_arrays(VERTICES, FACES)


@pytest.mark.parametrize("dtype", ["f4", "f8", ">f4", ">f8", "f2", "i1", "i2", "i4", "i8"])
def test_vertices_of_any_type_of_number_are_read(dtype):
    assert same(VERTICES.astype(dtype), FACES)
    assert not same(2 * VERTICES.astype(dtype), FACES)  # fault injected


@pytest.mark.parametrize("dtype", ["u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", ">u4", ">i8"])
def test_faces_of_any_type_of_integer_are_read(dtype):
    assert same(VERTICES, FACES.astype(dtype))
    assert not same(VERTICES, FACES.astype(dtype)[:, ::-1])  # fault injected


def test_any_steps_between_numbers_are_read():
    for dtype in ["f4", "f8"]:
        wide = np.full((16, 6), 7, dtype)
        wide[::2, ::2] = VERTICES
        backwards = VERTICES.astype(dtype)[::-1, ::-1].copy()[::-1, ::-1]
        packed = np.zeros(8, np.dtype([("flag", "u1"), ("place", dtype, 3)]))  # numbers at odd addresses
        packed["place"] = VERTICES
        columns = np.asfortranarray(VERTICES.astype(dtype))
        for vertices in [wide[::2, ::2], backwards, packed["place"], columns, VERTICES.tolist()]:
            assert same(vertices, FACES)
        assert not same(wide[::2, :3], FACES)  # fault injected
    assert same(VERTICES, np.asfortranarray(FACES))
    assert same(VERTICES, FACES[::-1].copy()[::-1])
    assert same(VERTICES, FACES.tolist())
    read_only = VERTICES.copy()
    read_only.flags.writeable = False
    assert same(read_only, FACES)


def test_rounding_is_measured():
    assert umbrage.check_arrays(VERTICES, FACES)["rounding"] == 0.0
    assert umbrage.check_arrays(VERTICES.astype("f8") / 4, FACES)["rounding"] == 0.0
    third = VERTICES.astype("f8") / 3
    expected = np.abs(third - third.astype("f4")).max()
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # not worth a warning
        assert umbrage.check_arrays(third, FACES)["rounding"] == expected > 0
        assert umbrage.Oracle(third, FACES).rounding == expected
    integers = VERTICES.astype("i8") + 2**24
    with pytest.warns(umbrage.RoundingWarning):
        assert umbrage.check_arrays(integers, FACES)["rounding"] == 1.0


def test_rounding_that_matters_is_warned_of():
    far = VERTICES.astype("f8") / 3 + 1e6
    with pytest.warns(umbrage.RoundingWarning, match="vertices: rounding to float32") as warned:
        umbrage.check_arrays(far, FACES)
    expected = np.abs(far - far.astype("f4")).max()
    assert (warned[0].message.argument, warned[0].message.largest) == ("vertices", expected)
    with pytest.warns(umbrage.RoundingWarning, match="points"):
        umbrage.Oracle(VERTICES, FACES).verdicts([[1e9 / 3, 0, 0]], "point:1,2,3")
    with warnings.catch_warnings():
        warnings.simplefilter("error", umbrage.RoundingWarning)
        with pytest.raises(umbrage.RoundingWarning):
            umbrage.check_arrays(far, FACES)


def spoiled(array, row, column, value, dtype=None):
    array = array.astype(dtype or array.dtype)
    array[row, column] = value
    return array


@pytest.mark.parametrize("dtype", ["f4", "f8"])
@pytest.mark.parametrize("value, said", [(np.nan, "nan"), (np.inf, "inf is not finite"), (-np.inf, "-inf")])
def test_coordinates_that_are_not_finite_are_refused_by_their_place(dtype, value, said):
    with pytest.raises(umbrage.ArgumentError, match=said) as caught:
        umbrage.check_arrays(spoiled(VERTICES, 5, 2, value, dtype), FACES)
    assert (caught.value.argument, caught.value.index) == ("vertices", (5, 2))
    assert str(caught.value).startswith("vertices, row 5, column 2: ")
    oracle = umbrage.Oracle(VERTICES, FACES)
    with pytest.raises(umbrage.ArgumentError) as caught:
        oracle.verdicts(spoiled(np.zeros((9, 3), dtype), 8, 1, value), "point:1,2,3")
    assert (caught.value.argument, caught.value.index) == ("points", (8, 1))


def test_coordinates_beyond_float32_are_refused_by_their_place():
    with pytest.raises(umbrage.ArgumentError, match="beyond the range of float32; scale") as caught:
        umbrage.check_arrays(spoiled(VERTICES, 0, 1, 1e300, "f8"), FACES)
    assert caught.value.index == (0, 1)


@pytest.mark.parametrize(
    "value, dtype", [(8, "u4"), (2**32 - 1, "u4"), (-1, "i4"), (2**32, "i8"), (-(2**63), "i8"), (2**63, "u8")]
)
def test_indices_out_of_range_are_refused_by_their_place(value, dtype):
    with pytest.raises(umbrage.ArgumentError) as caught:
        umbrage.check_arrays(VERTICES, spoiled(FACES, 7, 1, value, dtype))
    assert (caught.value.argument, caught.value.place) == ("faces", "row 7, column 1")
    assert caught.value.problem == f"names vertex {value}, but there are 8 vertices"


@pytest.mark.parametrize(
    "vertices, faces, argument, said",
    [
        (VERTICES.ravel(), FACES, "vertices", r"shape \(24,\), not \(n, 3\)"),
        (VERTICES[:, :2], FACES, "vertices", r"shape \(8, 2\)"),
        (VERTICES[None], FACES, "vertices", r"shape \(1, 8, 3\)"),
        (VERTICES, FACES.reshape(-1, 4), "faces", r"shape \(9, 4\).*triangles"),
        (VERTICES, FACES.astype("f8"), "faces", "float64"),
        (VERTICES, FACES.astype(bool), "faces", "bool"),
        (VERTICES.astype("c8"), FACES, "vertices", "complex64"),
        (VERTICES.astype(str), FACES, "vertices", "<U"),
        (VERTICES.astype(object), FACES, "vertices", "object"),
        (VERTICES.astype(np.longdouble), FACES, "vertices", "float|longdouble"),
        ([[0, 0, 0], [1, 1]], FACES, "vertices", "is no array"),
        (None, FACES, "vertices", r"shape \(\)"),
        ({}, FACES, "vertices", r"shape \(\)"),
        (np.broadcast_to(np.zeros(3, "f4"), (2**33, 3)), FACES, "vertices", "8589934592 rows"),
        (VERTICES, np.broadcast_to(np.zeros(3, "u4"), (2**31, 3)), "faces", "rows, and 715827882 are the most"),
    ],
)
def test_arrays_of_other_shapes_and_types_are_refused_by_name(vertices, faces, argument, said):
    if argument == "vertices" and getattr(vertices, "dtype", None) == np.float64:
        pytest.skip("a long double is a double here")
    with pytest.raises(umbrage.ArgumentError, match=said) as caught:
        umbrage.check_arrays(vertices, faces)
    assert caught.value.argument == argument
    assert caught.value.remedy


def test_nothing_is_a_mesh_too():
    nothing = np.empty((0, 3), "f4"), np.empty((0, 3), "u4")
    assert umbrage.check_arrays(*nothing)["verdict"] == "empty"
    assert umbrage.volume(*nothing, "point:1,2,3").triangles.shape == (0, 3)
    assert umbrage.silhouette(*nothing, "point:1,2,3").edges.shape == (0, 2)
    assert umbrage.prepare(*nothing, fill=True, orient=True, stitch=True, split=True).faces.shape == (0, 3)
    assert umbrage.ambient(*nothing).openness.shape == (0,)
    assert umbrage.ambient(*nothing, method="exact").openness.shape == (0,)
    oracle = umbrage.Oracle(*nothing)
    assert oracle.verdicts([[1, 2, 3]], "point:1,2,4").tolist() == [umbrage.Verdict.LIT]
    assert oracle.verdicts(nothing[0], "point:1,2,4").shape == (0,)
    assert oracle.visible_fraction([[1, 2, 3]], "point:1,2,9,radius=1").fraction.tolist() == [1.0]


@pytest.mark.parametrize(
    "call, argument",
    [
        (lambda: umbrage.check_arrays(VERTICES, FACES, weld="some"), "weld"),
        (lambda: umbrage.check_arrays(VERTICES, FACES, weld=-1.0), "weld"),
        (lambda: umbrage.check_arrays(VERTICES, FACES, weld=float("nan")), "weld"),
        (lambda: umbrage.check_arrays(VERTICES, FACES, require=["tight"]), "require"),
        (lambda: umbrage.check_arrays(VERTICES, FACES, limit=-1), "limit"),
        (lambda: umbrage.check("x.obj", scope="file"), "scope"),
        (lambda: umbrage.prepare(VERTICES, FACES, fill=2), "fill"),
        (lambda: umbrage.prepare(VERTICES, FACES, weld_within=0), "weld_within"),
        (lambda: umbrage.silhouette(VERTICES, FACES, "point:1,2"), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, (1, 2, 3)), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, (0, 0, 0, 0)), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, (1, 2, np.nan, 1)), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, (1, 2, 3, 0.5)), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, None), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, "point:1,2,3,radius=1"), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, "spot:0,5,0:0,-1,0:30"), "light"),
        (lambda: umbrage.silhouette(VERTICES, FACES, "point:1,2,3", casting="back"), "casting"),
        (lambda: umbrage.volume(VERTICES, FACES, "point:1,2,3", caps="one"), "caps"),
        (lambda: umbrage.visible_fraction(VERTICES, FACES, [[1, 2, 3]], "point:1,2,3"), "light"),
        (
            lambda: umbrage.visible_fraction(
                VERTICES, FACES, [[1, 2, 3]], "point:1,2,3,radius=1", normals=VERTICES
            ),
            "normals",
        ),
        (lambda: umbrage.ambient(VERTICES, FACES, rays=0), "rays"),
        (lambda: umbrage.ambient(VERTICES, FACES, rays=-1), "rays"),
        (lambda: umbrage.ambient(VERTICES, FACES, rays=2**21), "rays"),
        (lambda: umbrage.ambient(VERTICES, FACES, error=0), "error"),
        (lambda: umbrage.ambient(VERTICES, FACES, seed=-1), "seed"),
        (lambda: umbrage.ambient(VERTICES, FACES, distance=-1), "distance"),
        (lambda: umbrage.ambient(VERTICES, FACES, falloff="linear"), "falloff"),
        (lambda: umbrage.ambient(VERTICES, FACES, per="edge"), "per"),
        (lambda: umbrage.ambient(VERTICES, FACES, method="exact", bent=True), "bent"),
        (lambda: umbrage.ambient(VERTICES, FACES, method="disks"), "method"),
    ],
)
def test_options_that_there_are_not_are_refused_by_name(call, argument):
    with pytest.raises(umbrage.ArgumentError) as caught:
        call()
    assert caught.value.argument == argument
    assert f"; {caught.value.remedy}" in str(caught.value)


def test_exceptions_survive_pickling():
    with pytest.raises(umbrage.ArgumentError) as argument:
        umbrage.check_arrays(VERTICES, FACES + 9)
    with pytest.raises(umbrage.ReadError) as read:
        umbrage.read("no such file.obj")
    for error in [argument.value, read.value, umbrage.RoundingWarning("vertices", 0.5)]:
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert (str(again), vars(again)) == (str(error), vars(error))


def test_results_are_arrays_of_their_own_memory():
    volume = umbrage.volume(VERTICES, FACES, "point:2,5,3")
    for array in [volume.vertices, volume.triangles]:
        assert array.flags.c_contiguous and array.flags.writeable
    volume.vertices[:] = 0
    assert VERTICES.any()


# Prints by how many bytes a point the peak of memory rises; no point's segment meets the box of the mesh.
MEASURE = """
import re, sys
import numpy as np
import umbrage
oracle = umbrage.Oracle(*umbrage.shapes.cube())
count = 1_000_000
points = np.zeros((count, 3), sys.argv[1])
points[:] = 9
# Not that of getrusage, which begins with the peak of the process that started this one.
peak = lambda: 1024 * int(re.search(r"VmHWM:\\s*(\\d+) kB", open("/proc/self/status").read())[1])
oracle.verdicts(points[:1000], "point:9,9,10")
before = peak()
assert not oracle.verdicts(points, "point:9,9,10").any()
print((peak() - before) / count)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the peak is read from /proc")
def test_float32_points_in_order_are_not_copied(tmp_path):
    def bytes_per_point(dtype):
        # In another folder than that of the sources, which Python would find before the wheel.
        command = [sys.executable, "-c", MEASURE, dtype]
        done = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
        return float(done.stdout)

    assert bytes_per_point("f4") < 6  # a copy alone is 12
    assert bytes_per_point("f8") >= 6  # which is made where rounding is necessary
