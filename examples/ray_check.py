#!/usr/bin/env python3
"""Crack reports of many mesh files by Ray Data, as Parquet: examples/ray_check.py FOLDER -o REPORTS

When it pays: one `umbrage check --json-lines` does some thousand small files a second on one machine, and Ray takes
about 6 seconds to start. Below some 10,000 files, or on one machine, use the command alone. Ray is for files that
crash or hang a process, for runs that are interrupted, and for more machines than one: there REPORTS and the files
have to lie where every machine sees them.

- A batch of files is one process. If it ends by a signal, or takes too long, its files are asked one by one, and one
  that does so again gets a row that says so: `error` is never silence.
- A worker that is killed is started again by Ray. A block of files that still fails is left out, and counted; at
  most --max-errored-blocks of them are accepted.
- A second run asks only about files without a row, or whose size or time has changed since. The old rows stay: the
  one with the latest time counts. A row is there twice if a worker died just after it was written.

Columns: path, size, mtime_ns; sound, and the numbers of the report's total (null where the file was not read); error;
report, which is the line of JSON. Needs `pip install "ray[data]" pyarrow`.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
import uuid
from pathlib import Path

EXTENSIONS = {".obj", ".gltf", ".glb", ".stl", ".ply", ".off", ".md2", ".3mf"}
NUMBERS = [
    "faces", "edges", "shells", "closed_shells", "boundary_edges", "boundary_loops", "non_manifold_edges",
    "misoriented_edges", "non_manifold_vertices", "collapsed_faces", "zero_area_faces", "duplicate_faces",
    "t_junctions", "inside_out_shells",
]  # fmt: skip


def schema():
    import pyarrow as pa

    fields = [("path", pa.string()), ("size", pa.int64()), ("mtime_ns", pa.int64()), ("sound", pa.bool_())]
    fields += [(name, pa.int64()) for name in NUMBERS]
    return pa.schema(fields + [("error", pa.string()), ("report", pa.string())])


def mesh_files(folders):
    """The mesh files in folders, and files by name: path, size and time of each."""
    for folder in map(Path, folders):
        paths = [folder] if folder.is_file() else sorted(path for path in folder.rglob("*") if path.is_file())
        for path in paths:
            if path.suffix.lower() in EXTENSIONS or path == folder:
                stat = path.stat()
                yield {"path": str(path.resolve()), "size": stat.st_size, "mtime_ns": stat.st_mtime_ns}


def finished(reports):
    """The files that have a row, as they were then."""
    import pyarrow.dataset as dataset

    parts = [str(part) for part in sorted(Path(reports).glob("*.parquet"))]
    if not parts:
        return set()
    table = dataset.dataset(parts, format="parquet", schema=schema()).to_table(["path", "size", "mtime_ns"])
    return set(zip(*(table[name].to_pylist() for name in table.column_names)))


def ask(command, paths, seconds, memory):
    """The reports of files by one process, and why it failed, if it did."""

    def limited():
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

    line = [*command, "check", "--json-lines", "--limit", "0", "--threads", "1", *paths]
    try:
        run = subprocess.run(line, capture_output=True, timeout=seconds, preexec_fn=limited, check=False)
    except subprocess.TimeoutExpired:
        return {}, f"not done after {seconds} seconds"
    reports = {}
    for text in run.stdout.decode(errors="replace").splitlines():
        try:
            report = json.loads(text)
            reports[report["file"]] = (report, text)
        except (ValueError, KeyError, TypeError):
            pass  # the last line of a process that was ended
    if run.returncode < 0:
        return reports, f"ended by signal {-run.returncode}"
    if len(reports) != len(paths):
        said = run.stderr.decode(errors="replace").strip().splitlines()
        return reports, f"exit code {run.returncode}: {said[-1] if said else 'no report'}"
    return reports, None


def row(file, found, failed):
    """The row of a file."""
    report, text = found if found else ({}, None)
    total = report.get("total") or {}
    read = bool(total)
    # Sound as `check` has it: watertight, and nothing inside out.
    sound = bool(total["watertight"] and total["inside_out_shells"] == 0 and total["faces"] > 0) if read else None
    return {
        **file,
        "sound": sound,
        **{name: total.get(name) for name in NUMBERS},
        "error": report.get("error") if found else failed or "no report",
        "report": text,
    }


def check(files, command, seconds, memory):
    """The rows of a batch of files: by one process, and one by one where that does not end well."""
    reports, failed = ask(command, [file["path"] for file in files], seconds * max(1, len(files) // 8), memory)
    rows = []
    for file in files:
        path = file["path"]
        why = failed
        if path not in reports and failed and len(files) > 1:
            alone, why = ask(command, [path], seconds, memory)
            reports.update(alone)
        rows.append(row(file, reports.get(path), why))
    return rows


def write(rows, reports):
    """A part of the table, complete or not there."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    name = f"{uuid.uuid4()}.parquet"
    unfinished = Path(reports) / f".{name}.tmp"
    parquet.write_table(pa.Table.from_pylist(rows, schema=schema()), unfinished)
    unfinished.rename(Path(reports) / name)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", help="folders of mesh files, or files")
    parser.add_argument("-o", "--output", required=True, help="the folder of the Parquet files")
    parser.add_argument("--umbrage", default="umbrage", help="the command [default: umbrage]")
    parser.add_argument("--batch", type=int, default=64, help="files of one process, and of one part [default: 64]")
    parser.add_argument("--seconds", type=float, default=60, help="most seconds for one file alone [default: 60]")
    parser.add_argument("--memory", type=float, default=0, help="most GiB of a process [default: no limit]")
    parser.add_argument("--workers", type=int, help="local workers [default: those of the cluster, or of the machine]")
    parser.add_argument("--max-errored-blocks", type=int, default=10, help="-1 for any number [default: 10]")
    return parser.parse_args()


def main():
    options = arguments()
    reports = Path(options.output).resolve()
    reports.mkdir(parents=True, exist_ok=True)
    done = finished(reports)
    files = [file for file in mesh_files(options.files) if tuple(file.values()) not in done]
    print(f"{len(files)} files to check, {len(done)} rows there already", flush=True)
    if not files:
        return 0

    import ray

    start = time.perf_counter()
    ray.init(num_cpus=options.workers, include_dashboard=False, logging_level="ERROR", log_to_driver=False)
    context = ray.data.DataContext.get_current()
    context.max_errored_blocks = options.max_errored_blocks
    context.enable_progress_bars = False
    command, memory = options.umbrage.split(), int(options.memory * 2**30)

    def checked(batch):
        asked = [
            {"path": str(path), "size": int(size), "mtime_ns": int(mtime)}
            for path, size, mtime in zip(batch["path"], batch["size"], batch["mtime_ns"])
        ]
        rows = check(asked, command, options.seconds, memory)
        # Here rather than at the end, so that a run that is interrupted keeps what it has.
        write(rows, reports)
        return {"rows": [len(rows)], "errors": [sum(row["error"] is not None for row in rows)]}

    blocks = -(-len(files) // options.batch)
    data = ray.data.from_items(files, override_num_blocks=blocks)
    # By default Ray starts a task again for ever whose worker dies.
    counts = data.map_batches(checked, batch_size=options.batch, num_cpus=1, max_retries=2).take_all()
    written = sum(count["rows"] for count in counts)
    errors = sum(count["errors"] for count in counts)
    ray.shutdown()
    seconds = time.perf_counter() - start
    print(f"{written} rows written, {errors} with an error, {len(files) - written} files left out, {seconds:.1f} s")
    return 0 if written == len(files) else 1


if __name__ == "__main__":
    sys.exit(main())
