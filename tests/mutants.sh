#!/usr/bin/env bash
# Mutation testing of the code that decides: tests/mutants.sh [PART…] [options]. mutants.md has the record.
#
# Every mutant is in one test binary, built without optimization; each meets the tests of its part that come by, and what
# another part's tests would catch counts as missed here. mutants/parts.txt lists the parts, --help the options. Results
# stay in target/mutants/results.tsv: a run that is stopped goes on where it was. Exit code 1 if a mutant is missed.
set -euo pipefail
cd "$(dirname "$0")/.."

# Apart from the tree's own builds, which have other options.
CARGO_TARGET_DIR=target/mutants/tool cargo build --quiet --locked --manifest-path tests/mutants/Cargo.toml
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}" CARGO_INCREMENTAL=1
exec target/mutants/tool/debug/umbrage-mutants "$@" --cargo=--no-default-features \
    --cargo=--features=testing,files,serde --cargo=--config=profile.test.package.umbrage.opt-level=0
