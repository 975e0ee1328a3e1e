#!/usr/bin/env bash
# Fuzzes one target: fuzz/run.sh TARGET [SECONDS] [more options of libFuzzer]. See fuzz/README.md.
# With SANITIZER=none about ten times as fast, for targets that only compute.
set -euo pipefail
target=${1:?usage: fuzz/run.sh TARGET [SECONDS] [libFuzzer options]}
seconds=${2:-60}
shift $(($# < 2 ? $# : 2))
cd "$(dirname "$0")/.."
export PATH="$PWD/target/cargo-fuzz/bin:$PATH" # where smoke.sh installs it
[ -f "fuzz/fuzz_targets/$target.rs" ] || { echo "no such target: $target; see fuzz/fuzz_targets" >&2; exit 2; }

# The largest input, and what one allocation and the whole process may take (MiB). Time is that of the wall.
largest=512 allocation=64 process=1024
case $target in
    # A glTF may claim 2²² elements without data, which is 50 MB as positions.
    read_gltf | read_meshopt) largest=16384 allocation=128 ;;
    read_*) largest=16384 ;;
esac
# Short inputs say little where the bytes are decisions.
control=100
case $target in
    polygon | topology | shadow | oracle) control=0 ;;
esac

corpus=fuzz/corpus/$target seeds=fuzz/corpus/$target.seeds
mkdir -p "$corpus" "$seeds" "fuzz/regressions/$target"
case $target in
    read_obj | read_ply | read_stl)
        find data -name "*.${target#read_}" -size -16k -exec cp {} "$seeds" \; ;;
    read_gltf) cp data/format/cube.glb "$seeds" ;;
esac
folders=("$corpus" "$seeds" "fuzz/regressions/$target")
[ -d "fuzz/seeds/$target" ] && folders+=("fuzz/seeds/$target")

options=(-max_total_time="$seconds" -max_len="$largest" -len_control=$control -timeout=60
    -malloc_limit_mb="$allocation" -rss_limit_mb="$process" -print_final_stats=1)
[ -f "fuzz/dictionaries/$target" ] && options+=(-dict="fuzz/dictionaries/$target")

# smoke.sh has built it already; where finds go, cargo-fuzz says otherwise.
if [ -n "${FUZZ_BUILT:-}" ]; then
    mkdir -p "fuzz/artifacts/$target"
    exec "$FUZZ_BUILT" "${folders[@]}" "${options[@]}" -artifact_prefix="fuzz/artifacts/$target/" "$@"
fi

build=()
[ "${SANITIZER:-address}" = none ] && build=(-s none --no-trace-compares --target-dir fuzz/target/none)

exec cargo +nightly fuzz run "${build[@]}" "$target" "${folders[@]}" -- "${options[@]}" "$@"
