#!/usr/bin/env python3
"""Ambient occlusion of umbrage, libigl and MeshLab on the same mesh: error against the analytic form, and time.

    pip install numpy libigl pymeshlab
    benches/ambient_peers.py UMBRAGE FILE...        # UMBRAGE: the command, built with --release

All get the same vertices and faces. The truth is that of `umbrage ambient --method exact`, one value a vertex; points
inside another solid are left out. libigl gets the same kind of normals (each face by its angle), its directions count
alike where the others weight them by the cosine; MeshLab adds up cosines over all directions, a quarter of the rays
if nothing hides. So each row has a second error, that after the straight line which brings the values closest to the
truth: what is left is not a matter of definition. A row that fails says why.

Time is that of the processor, over all threads, so that other work on the machine does not count; for umbrage it includes
reading the mesh and writing the values.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy

RAYS = [16, 64, 256]


def read_ply(path):
    """Positions and `quality` of a PLY that umbrage wrote."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    lines = data[:end].decode().splitlines()
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    kinds = {"float": "<f4", "uchar": "u1", "int": "<i4", "uint": "<u4"}
    start = next(index for index, line in enumerate(lines) if line.startswith("element vertex")) + 1
    fields = []
    for line in lines[start:]:
        if not line.startswith("property"):
            break
        _, kind, name = line.split()
        fields.append((name, kinds[kind]))
    table = numpy.frombuffer(data, numpy.dtype(fields), count, end)
    positions = numpy.stack([table[axis] for axis in "xyz"], axis=1)
    return positions, table["quality"].astype(float)


class Umbrage:
    """The command on one mesh."""

    def __init__(self, command, mesh, folder):
        self.command, self.mesh, self.folder = command, mesh, folder

    def openness(self, *options):
        """A value for each position, and the seconds that the processor took."""
        out = os.path.join(self.folder, "out.ply")
        arguments = ["ambient", self.mesh, "-o", out, "--per", "vertex", *options]
        begun = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.command, *arguments], check=True, capture_output=True)
        ended = resource.getrusage(resource.RUSAGE_CHILDREN)
        positions, quality = read_ply(out)
        values = {position.tobytes(): value for position, value in zip(positions, quality)}
        return values, ended.ru_utime - begun.ru_utime + ended.ru_stime - begun.ru_stime


def libigl(vertices, faces, rays):
    import igl

    normals = igl.per_vertex_normals(vertices, faces, igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_ANGLE)
    begun = time.process_time()
    hidden = igl.ambient_occlusion(vertices, faces, vertices, normals, rays)
    return 1.0 - hidden, time.process_time() - begun


def meshlab(vertices, faces, rays):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(vertices, faces.astype(numpy.int32)))
    begun = time.process_time()
    meshes.apply_filter("compute_scalar_ambient_occlusion", rays=rays)
    seconds = time.process_time() - begun
    return meshes.current_mesh().vertex_scalar_array() / (rays / 4.0), seconds


def errors(values, truth):
    """Mean and root mean square of the difference, and the mean after the best straight line."""
    away = numpy.abs(values - truth)
    line = numpy.polyfit(values, truth, 1) if numpy.ptp(values) > 0 else [0.0, truth.mean()]
    fitted = numpy.abs(numpy.polyval(line, values) - truth)
    return away.mean(), numpy.sqrt((away**2).mean()), fitted.mean()


def compare(command, file):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(file)
    meshes.meshing_remove_duplicate_vertices()
    meshes.meshing_remove_unreferenced_vertices()
    mesh = meshes.current_mesh()
    vertices = mesh.vertex_matrix().astype(numpy.float32)
    faces = mesh.face_matrix().astype(numpy.int64)
    with tempfile.TemporaryDirectory() as folder:
        same = os.path.join(folder, "mesh.obj")
        with open(same, "w") as out:
            out.writelines("v {!s} {!s} {!s}\n".format(*map(numpy.format_float_positional, v)) for v in vertices)
            out.writelines("f {} {} {}\n".format(*(face + 1)) for face in faces)
        umbrage = Umbrage(command, same, folder)
        exact, seconds = umbrage.openness("--method", "exact")
        keys = [vertex.tobytes() for vertex in vertices]
        # What is exactly dark lies in another solid, or sees nothing; the others do not tell the two apart.
        judged = numpy.array([index for index, key in enumerate(keys) if exact.get(key, 0.0) > 0.0])
        truth = numpy.array([exact[keys[index]] for index in judged])
        wide = vertices.astype(numpy.float64)
        print(f"\n{os.path.basename(file)}: {len(faces)} faces, {len(judged)} of {len(vertices)} vertices judged")
        print(f"{'method':34}{'mean error':>12}{'rms error':>12}{'fitted':>12}{'cpu us':>13}")

        def row(name, work):
            try:
                values, seconds = work()
            except Exception as error:  # a peer that is missing, or gives up, is a row like others
                print(f"{name:34}{error!s:.60}")
                return
            mean, rms, fitted = errors(values[judged], truth)
            micro = 1e6 * seconds / len(vertices)
            print(f"{name:34}{mean:12.4f}{rms:12.4f}{fitted:12.4f}{micro:13.1f}", flush=True)

        def ours(*options):
            values, seconds = umbrage.openness(*options)
            return numpy.array([values.get(key, 0.0) for key in keys]), seconds

        for rays in RAYS:
            row(f"umbrage, {rays} rays", lambda: ours("--rays", str(rays)))
            row(f"libigl, {rays} rays", lambda: libigl(wide, faces, rays))
            row(f"MeshLab, {rays} rays", lambda: meshlab(wide, faces, rays))
        row("umbrage, disks", lambda: ours("--method", "disks"))
        print(f"{'umbrage, exact (the truth)':34}{0:12.4f}{0:12.4f}{0:12.4f}{1e6 * seconds / len(vertices):13.1f}")
        # A wrong answer must show: the truth of other vertices.
        mixed = errors(numpy.roll(truth, len(truth) // 2), truth)[0]
        print(f"{'the truth of other vertices':34}{mixed:12.4f}")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    versions = []
    for package in ["libigl", "pymeshlab", "numpy"]:
        try:
            from importlib.metadata import version

            versions.append(f"{package} {version(package)}")
        except Exception:
            versions.append(f"{package} missing")
    print(f"{', '.join(versions)}; cpu us: microseconds of the processor, per vertex")
    for file in sys.argv[2:]:
        compare(sys.argv[1], file)


main()
