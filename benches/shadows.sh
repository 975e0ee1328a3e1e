#!/usr/bin/env bash
# The table of shadow techniques: benches/shadows.sh [FOLDER OF THE MESHES] [FOLDER OF THE RECORD]
#
# Every technique, on the CPU and on a device, beside the truth: a teapot, a Menger sponge and a scanned head on a
# ground, each under a hard and a soft sun from the same side. The camera is the default one, which fits the scene.
# One round, since the errors are the same in every round; run it on a quiet machine for its times.
set -euo pipefail
meshes=$(realpath "${1:-../shared/meshes}") record=$(realpath "${2:-.}")
cd "$(dirname "$0")/.."

hard=directional:0.7,-1,0.2
files=(teapot.obj menger_sponge3.glb igea.glb)
for name in "${files[@]}"; do
    [ -f "$meshes/$name" ] || { echo "no such mesh: $meshes/$name; name the folder of the three meshes" >&2; exit 2; }
done
cargo build --locked --release --quiet
umbrage=$(realpath target/release/umbrage)
# From the folder of the meshes, so that the record names no other.
cd "$meshes"
"$umbrage" accuracy shadow "${files[@]}" --ground --size 320x240 --rounds 1 \
    --light "$hard" --light "$hard,angle=3" --csv "$record/shadows.csv" --svg "$record/shadows.svg" |
    tee "$record/shadows.txt"
