#!/usr/bin/env bash
# Every fuzz target for some seconds: fuzz/smoke.sh [SECONDS A TARGET]. A find fails.
#
# The short form of fuzz/run.sh: coverage as there, but built by the stable compiler, without a sanitizer and with
# little optimization, which takes a third of the time. Neither this crate nor its targets have unsafe code. The
# random numbers are the same in every run: what this run finds, the next one finds; longer runs look for more.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-10}

host=$(rustc -vV | sed -n 's/^host: //p')
cargo fmt --manifest-path fuzz/Cargo.toml --check
# What cargo-fuzz passes, without what needs a nightly compiler. With --target it reaches no build script.
RUSTFLAGS="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
-Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table" \
    cargo build --locked --manifest-path fuzz/Cargo.toml --profile smoke --target "$host" --bins

# Runs one target, and prints what came of it in one piece.
one() {
    local log
    log=$(mktemp)
    if FUZZ_BUILT="fuzz/target/$3/smoke/$1" fuzz/run.sh "$1" "$2" -seed=1 >"$log" 2>&1; then
        printf '\n-- %s\n%s\n' "$1" "$(grep -E 'stat::number_of_executed_units|DONE ' "$log")"
        rm -f "$log"
    else
        printf '\n-- %s\n%s\n' "$1" "$(tail -n 60 "$log")" >&2
        return 1
    fi
}
export -f one
# A target has one thread: as many at a time as there are cores.
for target in fuzz/fuzz_targets/*.rs; do basename "$target" .rs; done |
    xargs -P "$(getconf _NPROCESSORS_ONLN)" -I {} bash -c 'one "$@"' one {} "$seconds" "$host"
