#!/usr/bin/env bash
# Builds the wheel of the Python package and tests it, in a virtual environment of its own: python/test.sh [ARGUMENTS]
#
# Needs Python 3.9 or newer ($PYTHON, or python3) with venv, and the packages of requirements.txt, which pip brings.
# Where they cannot be had, the last line says "SKIPPED python: " and why, and that is no failure. Arguments go to
# pytest. Reports are compared with those of the command where $UMBRAGE_COMMAND names it.
set -euo pipefail

# Paths are those of the caller.
absolute() { case "$1" in /*) echo "$1" ;; *) echo "$PWD/$1" ;; esac; }
[ -z "${UMBRAGE_COMMAND:-}" ] || UMBRAGE_COMMAND="$(absolute "$UMBRAGE_COMMAND")"
[ -z "${CARGO_TARGET_DIR:-}" ] || CARGO_TARGET_DIR="$(absolute "$CARGO_TARGET_DIR")/python"
cd "$(dirname "$0")"
export UMBRAGE_COMMAND CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"

skip() {
    echo "SKIPPED python: $1"
    exit 0
}
python="${PYTHON:-python3}"
command -v "$python" >/dev/null || skip "no $python"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 9))' || skip "$("$python" -V) is older than 3.9"

venv="$CARGO_TARGET_DIR/venv"
pip=("$venv/bin/python" -m pip --disable-pip-version-check --quiet)
if ! "$venv/bin/python" -c 'import hypothesis, maturin, numpy, pytest, rtree, trimesh' 2>/dev/null; then
    rm -rf "$venv"
    "$python" -m venv "$venv" || skip "$python has no venv (Debian and Ubuntu: python3-venv)"
    "${pip[@]}" install --retries 1 --timeout 10 --only-binary :all: --requirement requirements.txt ||
        skip "pip cannot install its packages"
fi
# A lock file that is out of date is a failure; a network that is not there is none.
fetched="$(cargo fetch --locked 2>&1)" || case "$fetched" in
*--locked*) printf '%s\n' "$fetched" >&2 && exit 1 ;;
*) skip "cargo cannot fetch its crates" ;;
esac

wheels="$CARGO_TARGET_DIR/wheels"
rm -rf "$wheels"
"$venv/bin/maturin" build --quiet --locked --profile quick --out "$wheels"
"${pip[@]}" install --force-reinstall --no-deps "$wheels"/*.whl
# Nothing is left among the sources.
export HYPOTHESIS_STORAGE_DIRECTORY="$CARGO_TARGET_DIR/hypothesis" PYTHONDONTWRITEBYTECODE=1
# Without python -m, which would find the sources beside the tests before the wheel.
"$venv/bin/pytest" -p no:cacheprovider --quiet "$@"
