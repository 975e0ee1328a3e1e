#!/usr/bin/env python3
"""A thousand small files in one run: benches/corpus.py [--count N] [--umbrage COMMAND] [--corpus COMMAND]

Writes the corpus, checks it by one `umbrage check --json-lines`, compares the numbers with what was put in, and
prints the rate and the peak memory. Beside it, where it is installed, trimesh in a pool of as many processes: each
loads a file, welds it, and says whether it is watertight, which is compared too. COMMANDs default to cargo's release
build. Needs nothing beyond Python; trimesh by `pip install trimesh`.
"""

import argparse
import json
import multiprocessing
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
ROUNDS = 3


def cargo(*arguments):
    return ["cargo", "run", "--locked", "--release", "--quiet", *arguments, "--"]


def watertight(path):
    """What trimesh says of a file."""
    import trimesh

    mesh = trimesh.load(path, force="mesh", process=True)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    return bool(mesh.is_watertight and mesh.is_winding_consistent)


def quietly(path):
    try:
        return watertight(path)
    except Exception as error:  # a file that it cannot read is an answer too
        return f"{type(error).__name__}: {error}"


def measured(work):
    """The median seconds of some rounds, by the clock and of processors, and the last answer."""
    by_clock, of_processors = [], []
    for _ in range(ROUNDS):
        start, used = time.perf_counter(), processor_seconds()
        answer = work()
        by_clock.append(time.perf_counter() - start)
        of_processors.append(processor_seconds() - used)
    return statistics.median(by_clock), statistics.median(of_processors), answer


def processor_seconds():
    """Those of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def row(name, seconds, processor, files, size, peak, note):
    rate = f"{files / seconds:7.0f} files/s {size / seconds / 1e6:6.1f} MB/s"
    times = f"{seconds * 1e3:7.0f} ms, of processors {processor * 1e3:7.0f} ms"
    print(f"{name:<28} {times} {rate} {peak / 1024:5.0f} MiB  {note}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=1000, help="how many files [default: 1000]")
    parser.add_argument("--umbrage", help="the command [default: cargo's release build]")
    parser.add_argument("--corpus", help="the example `corpus` [default: cargo's release build]")
    arguments = parser.parse_args()
    umbrage = arguments.umbrage.split() if arguments.umbrage else cargo("--bin", "umbrage")
    corpus = arguments.corpus.split() if arguments.corpus else cargo("--example", "corpus", "--features", "testing")
    processes = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()

    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*corpus, folder, str(arguments.count)], check=True, cwd=ROOT)
        files = sorted((Path(folder) / "files").iterdir())
        size = sum(path.stat().st_size for path in files)
        injected = {entry["file"]: entry for entry in map(json.loads, (Path(folder) / "injected.jsonl").open())}
        if len(injected) != arguments.count or len(files) != arguments.count:
            sys.exit(f"{len(files)} files and {len(injected)} entries; {arguments.count} were asked for")
        print(f"{len(files)} files, {size / 1e6:.1f} MB, {processes} processors")

        command = [*umbrage, "check", str(Path(folder) / "files"), "--json-lines", "--limit", "0"]

        def check():
            return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT, text=True)

        check()  # builds it, where cargo does
        seconds, processor, run = measured(check)
        if run.returncode > 1:
            sys.exit(run.stderr)
        reports = {Path(report["file"]).name: report for report in map(json.loads, run.stdout.splitlines())}
        wrong = [
            f"{name}: {key} is {reports[name]['total'][key]}, and {number} were put in"
            for name, entry in injected.items()
            for key, number in entry.items()
            if key != "file" and reports[name]["total"][key] != number
        ]
        for line in wrong:
            print(line, file=sys.stderr)
        peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        numbers = sum(len(entry) - 1 for entry in injected.values())
        row("umbrage check --json-lines", seconds, processor, len(files), size, peak, f"{len(wrong)} of {numbers} numbers wrong")

        try:
            import trimesh
        except ImportError:
            print("SKIPPED trimesh: not installed (pip install trimesh)")
            return 1 if wrong else 0

        def pool():
            with multiprocessing.Pool(processes) as workers:
                answers = workers.map(quietly, map(str, files), chunksize=16)
                # Of one worker; they are alike.
                peak = workers.apply(own_peak)
                workers.close()
                workers.join()
            return answers, peak

        seconds, processor, (answers, peak) = measured(pool)
        failed = sum(not isinstance(answer, bool) for answer in answers)
        other = sum(
            isinstance(answer, bool) and answer != reports[path.name]["total"]["watertight"]
            for path, answer in zip(files, answers)
        )
        note = f"watertight: {other} answers differ, {failed} files not read"
        row(f"trimesh {trimesh.__version__}, {processes} processes", seconds, processor, len(files), size, processes * peak, note)
        return 1 if wrong else 0


def own_peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


if __name__ == "__main__":
    sys.exit(main())
