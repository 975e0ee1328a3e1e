#!/usr/bin/env bash
# Every test: the default build, the examples in the documentation, and the lean library without features.
#
# The real meshes are looked for in $UMBRAGE_MESHES, or in ../shared/meshes; without them their tests say aloud that
# they are skipped. Arguments go to the test binaries (for example a part of a test's name).
set -euo pipefail
cd "$(dirname "$0")/.."

cargo test --locked --lib --bins --tests -- "$@"
cargo test --locked --doc -- "$@"
cargo test --locked --no-default-features --lib -- "$@"
