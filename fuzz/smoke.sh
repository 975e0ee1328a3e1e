#!/usr/bin/env bash
# Every fuzz target for some seconds: fuzz/smoke.sh [SECONDS A TARGET]. Without a nightly toolchain or cargo-fuzz it
# says so and passes; a find fails.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-10}

skip() {
    printf '\nSKIPPED, no fuzzing: %s\n' "$*" >&2
    exit 0
}

cargo +nightly --version >/dev/null 2>&1 || skip "there is no nightly toolchain (rustup toolchain install nightly)"
export PATH="$PWD/target/cargo-fuzz/bin:$PATH"
if ! command -v cargo-fuzz >/dev/null; then
    cargo install --locked --root target/cargo-fuzz cargo-fuzz || skip "cargo-fuzz could not be installed"
fi
fetch() { cargo +nightly fetch --manifest-path fuzz/Cargo.toml "$@"; }
if ! fetch --locked; then
    fetch || skip "the targets' dependencies could not be fetched"
    echo "fuzz/Cargo.lock was out of date, and is not any more: commit it" >&2
    exit 1
fi

cargo fmt --manifest-path fuzz/Cargo.toml --check
cargo +nightly fuzz build

# Runs one target, and prints what came of it in one piece.
one() {
    local log
    log=$(mktemp)
    if fuzz/run.sh "$1" "$2" >"$log" 2>&1; then
        printf '\n-- %s\n%s\n' "$1" "$(grep -E 'stat::number_of_executed_units|DONE ' "$log")"
        rm -f "$log"
    else
        printf '\n-- %s\n%s\n' "$1" "$(tail -n 60 "$log")" >&2
        return 1
    fi
}
export -f one
# A target has one thread: as many at a time as there are cores.
cargo +nightly fuzz list | xargs -P "$(getconf _NPROCESSORS_ONLN)" -I {} bash -c 'one "$@"' one {} "$seconds"
