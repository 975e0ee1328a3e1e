#!/usr/bin/env bash
# The long forms of tests, which cargo lists as ignored: tests/long.sh [PART OF A TEST'S NAME [SIZE]]
#
# Each has a short form among the tests of tests/run.sh. Without a name all run that take minutes at most;
# tests/long.sh light_grid_long takes hours for its 10^8 decided points, and an hour or less for a SIZE of 1e7.
set -euo pipefail
cd "$(dirname "$0")/.."
export UMBRAGE_REQUIRE_GPU="${UMBRAGE_REQUIRE_GPU:-0}"

if [ $# = 2 ]; then
    export UMBRAGE_LONG="$2"
fi
if [ $# = 0 ]; then
    cargo test --locked --lib --tests -- --ignored --nocapture --skip light_grid_long
else
    cargo test --locked --lib --tests -- --ignored --nocapture "$1"
fi
