#!/usr/bin/env python3
"""examples/ray_check.py with two local workers: tests/ray/check.py [UMBRAGE]

Among good files lie one that crashes its process, one that hangs it, one that kills its worker once, and one that
kills it every time. Not part of tests/run.sh: Ray alone takes about 6 seconds to start, and it is started four times.
Where Ray is not installed, it says so.
"""

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
OPEN = "\n".join(TETRAHEDRON.split("\n")[:-2]) + "\n"

# The command, but for names that make it do what broken programs do.
WRAPPER = """#!{python}
import os, signal, sys, time
paths = [path for path in sys.argv if path.endswith(".obj")]
asked = lambda word: [path for path in paths if os.path.basename(path).startswith(word)]
if asked("crash"):
    os.kill(os.getpid(), signal.SIGSEGV)
if asked("hang"):
    time.sleep(1000)
for path in asked("kill_once"):
    if not os.path.exists(path + ".killed"):
        open(path + ".killed", "w").close()
        os.kill(os.getppid(), signal.SIGKILL)
if asked("kill_always"):
    os.kill(os.getppid(), signal.SIGKILL)
os.execv({umbrage!r}, [{umbrage!r}, *sys.argv[1:]])
"""


def main():
    try:
        import pyarrow.dataset as dataset
        import ray.data  # noqa: F401
    except ImportError as error:
        print(f'SKIPPED ray: {error} (pip install "ray[data]" pyarrow)')
        return 0
    umbrage = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target/debug/umbrage").resolve()
    if not umbrage.exists():
        print(f"SKIPPED ray: there is no {umbrage}; build it, or name it")
        return 0
    start = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        files, reports = Path(folder) / "files", Path(folder) / "reports"
        files.mkdir()
        for index in range(60):
            (files / f"{index:02}.obj").write_text(OPEN if index % 5 == 0 else TETRAHEDRON)
        for name in ["crash", "hang", "kill_once"]:
            (files / f"{name}.obj").write_text(TETRAHEDRON)
        (files / "garbled.stl").write_text("solid\nfacet normal 0 0\n")
        wrapper = Path(folder) / "umbrage"
        wrapper.write_text(WRAPPER.format(python=sys.executable, umbrage=str(umbrage)))
        wrapper.chmod(0o755)

        def run(*more):
            command = [sys.executable, ROOT / "examples/ray_check.py", files, "-o", reports, "--workers", "2"]
            command += ["--umbrage", wrapper, "--batch", "8", "--seconds", "3", *more]
            done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
            assert done.returncode in (0, 1), done.stderr[-3000:]
            return done.returncode, done.stdout.strip().splitlines()

        def rows():
            parts = [str(part) for part in reports.glob("*.parquet")]
            return dataset.dataset(parts, format="parquet").to_table().to_pylist()

        # Every file has a row, and what a process died of is said.
        code, said = run()
        table = {Path(row["path"]).stem: row for row in rows()}
        assert code == 0 and len(rows()) == len(table) == 64, (code, said, len(rows()), len(table))
        assert table["crash"]["error"] == "ended by signal 11", table["crash"]
        assert table["hang"]["error"] == "not done after 3.0 seconds", table["hang"]
        assert "outer loop" in table["garbled"]["error"] and table["garbled"]["sound"] is None
        for name, row in table.items():
            if name.isdigit():
                is_open = int(name) % 5 == 0
                assert (row["sound"], row["boundary_edges"], row["error"]) == (not is_open, 3 * is_open, None), row
                assert json.loads(row["report"])["total"]["faces"] == row["faces"] == 4 - is_open
        assert table["kill_once"]["sound"] and (files / "kill_once.obj.killed").exists()

        # A second run has nothing to do, and a third only what has changed, or was lost.
        code, said = run()
        assert (code, said) == (0, ["0 files to check, 64 rows there already"]), said
        (files / "07.obj").write_text(OPEN)
        lost = next(reports.glob("*.parquet"))
        names = {Path(path).stem for path in dataset.dataset(str(lost)).to_table(["path"])["path"].to_pylist()}
        lost.unlink()
        code, said = run()
        assert code == 0 and said[0].startswith(f"{len(names | {'07'})} files to check"), (said, names)
        latest = [row for row in rows() if Path(row["path"]).stem == "07"]
        assert sorted(row["sound"] for row in latest) == ([False] if "07" in names else [False, True])
        assert len({row["path"] for row in rows()}) == 64

        # A file that always kills its worker costs its own block, no other, and is said.
        for index in range(60, 70):
            (files / f"{index}.obj").write_text(TETRAHEDRON)
        (files / "kill_always.obj").write_text(TETRAHEDRON)
        code, said = run("--batch", "1", "--max-errored-blocks", "2")
        assert code == 1 and "10 rows written, 0 with an error, 1 files left out" in said[-1], said
        # Fault injected: if none may be left out, the run fails.
        command = [sys.executable, ROOT / "examples/ray_check.py", files, "-o", reports, "--workers", "2"]
        command += ["--umbrage", wrapper, "--batch", "1", "--max-errored-blocks", "0"]
        failed = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=300)
        assert failed.returncode == 1 and "rows written" not in failed.stdout, failed.stdout
    print(f"ray: all as it should be, {time.perf_counter() - start:.0f} s")
    return 0


if __name__ == "__main__":
    sys.exit(main())
