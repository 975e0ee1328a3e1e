#!/usr/bin/env bash
# Mutation testing of the code that decides: tests/mutants.sh PART [options of cargo-mutants]. mutants.md has the record.
#
# Every mutant is built without optimization, and meets the unit tests of its part alone: what another part's tests
# would catch counts as missed here. Missed mutants are listed at the end. --shard 0/8 takes an eighth of a part.
set -euo pipefail
cd "$(dirname "$0")/.."

part=${1:?usage: tests/mutants.sh PART [options of cargo-mutants]; the parts are in this file}
shift
case $part in
    predicate) files=('src/geom/predicate/**') tests=(geom::) ;;
    segment) files=(src/geom/segment.rs) tests=(geom:: oracle::) ;;
    facing) files=('src/facing/**') tests=(facing:: caster::) ;;
    silhouette) files=('src/silhouette/**') tests=(silhouette::) ;;
    volume) files=('src/shadow/volume/**') tests=(shadow::volume:: caster::) ;;
    stencil) files=('src/shadow/stencil/*.rs') tests=(shadow::stencil:: shadow::tests caster::) ;;
    map) files=('src/shadow/map/*.rs') tests=(shadow::map::) ;;
    area) files=('src/oracle/area/*.rs') tests=(oracle::area::) ;;
    boundary) files=(src/check/boundary.rs) tests=(check::boundary::) ;;
    polygon) files=('src/read/polygon/**') tests=(read::polygon::) ;;
    topology) files=('src/topology/*.rs' 'src/check/**') tests=(topology:: check::) ;;
    *) echo "no such part: $part" >&2; exit 2 ;;
esac
features=testing
[ "$part" = polygon ] && features=testing,files

export PATH="$PWD/target/cargo-mutants/bin:$PATH"
command -v cargo-mutants >/dev/null || cargo install --locked --root target/cargo-mutants cargo-mutants

out=target/mutants/$part
mkdir -p "$out"
globs=()
for file in "${files[@]}"; do globs+=(-f "$file"); done
status=0
# In a copy of the working tree: no source file is changed, whatever happens.
cargo mutants -o "$out" "${globs[@]}" --timeout 240 --no-shuffle \
    -C=--config=profile.test.package.umbrage.opt-level=0 -C=--no-default-features -C="--features=$features" \
    "$@" -- --lib -- "${tests[@]}" || status=$?

count() { wc -l <"$out/mutants.out/$1.txt" | tr -d ' '; }
printf '\n%s: %s caught, %s missed, %s timed out, %s do not build\n' \
    "$part" "$(count caught)" "$(count missed)" "$(count timeout)" "$(count unviable)"
cat "$out/mutants.out/missed.txt"
exit "$status"
