#!/usr/bin/env bash
# Every test: the default build, the lean library without features, and the examples in the documentation.
#
# The real meshes are looked for in $UMBRAGE_MESHES, or in ../shared/meshes; without them their tests say aloud that
# they are skipped. Arguments go to the test binaries (for example a part of a test's name).
set -euo pipefail
cd "$(dirname "$0")/.."

cargo test --all-targets -- "$@"
cargo test --doc -- "$@"
cargo test --no-default-features --lib -- "$@"
