#!/usr/bin/env bash
# Errors of shadow maps and soft shadows on three meshes: benches/table10.sh [FOLDER OF THE MESHES] [FOLDER OF THE RECORD]
#
# Camera and square lamp of each mesh are below: the eye is 1.5 diagonals of the bounding box away from its center
# towards (0.5, 0.575, 0.65), the lamp 1.5 diagonals towards the sun, with sides of 0.24 diagonals across the way to
# the center. The sun travels along (0.7, -1, 0.2). Everything stands on a ground, but for GROUND=no.
#
# Hard shadows: 640x480 under the sun. Soft ones: 320x240 under the lamp. The errors do not depend on the machine; the
# times of one round say little. UMBRAGE names a built command, otherwise one is built.
set -euo pipefail
meshes=$(realpath "${1:-../shared/meshes}") record=$(realpath "${2:-.}")
cd "$(dirname "$0")/.."

#      file                eye                         target         corner and edges of the lamp
scenes="
igea.glb           0.117116,0.134684,0.152251 0,0,0         rect:-0.149878,0.181385,-0.0194114:0.0307504,0.0215253,0:0.00348044,-0.00497205,-0.0370418
menger_sponge3.glb 1.29701,1.49157,1.68612    0,0,0         rect:-1.65984,2.00876,-0.214973:0.340548,0.238384,0:0.0385444,-0.0550634,-0.410222
teapot.obj         6.36101,8.64061,7.98722    0.217,1.575,0 rect:-7.64574,11.0906,-1.01834:1.61319,1.12924,0:0.182587,-0.260838,-1.94324
"
hard=(
    map:bias=constant map:bias=offset,depth=interpolated pcf:bias=offset,depth=interpolated
    map:bias=receiver pcf:bias=receiver map:bias=texel pcf:bias=texel map:bias=normal map:bias=second
    map-ids hybrid-3x3 hybrid-3x3:size=512
)
soft=(
    rays pcf:kernel=box3 pcf:kernel=tent5 single-sample:literal=yes single-sample single-sample:adaptive=4
    pcss:blockers=16,taps=16 pcss:blockers=all,taps=all msm vsm penumbra-map:profile=full penumbra-map
    contact-blur soft-hybrid:certain=pcss soft-hybrid samples:n=16 samples:n=64
)
ground=(--ground)
[ "${GROUND:-yes}" = yes ] || ground=()
if [ -z "${UMBRAGE:-}" ]; then
    cargo build --locked --release --quiet
    UMBRAGE=$(realpath target/release/umbrage)
fi
# From the folder of the meshes, so that the record names no other.
cd "$meshes"
measure() { # SIZE LAMP TECHNIQUE...
    local size=$1 lamp=$2
    shift 2
    "$UMBRAGE" accuracy shadow "$file" "${ground[@]}" --eye "$eye" --target "$target" --fov 40 --size "$size" --rounds 1 \
        --light "$lamp" "${@/#/--shadow=}" --json | python3 -c "$rows" "$file"
}
# A line for each row, without times.
rows='
import json, sys
keys = "judged wrong acne leak alias_dark alias_lit asked_exactly mean_error p99_error penumbra_mean_error reads".split()
document = json.load(sys.stdin)
for found in document if isinstance(document, list) else [document]:
    for light in found["lights"]:
        for row in light["rows"]:
            options = ",".join(f"{key}={value}" for key, value in (row["parameters"] or {}).items())
            values = ["" if row[key] is None else row[key] for key in keys]
            print(sys.argv[1], light["name"].split(":")[0], (row["technique"] + " " + options).strip(), *values, sep=";")
'
{
    echo "file;lamp;technique;judged;wrong;acne;leak;alias_dark;alias_lit;asked_exactly;mean_error;p99_error;penumbra_mean_error;reads"
    while read -r file eye target lamp; do
        [ -n "$file" ] || continue
        [ -f "$file" ] || { echo "no such mesh: $meshes/$file; name the folder of the three meshes" >&2; exit 2; }
        measure 640x480 directional:0.7,-1,0.2 "${hard[@]}"
        measure 320x240 "$lamp" "${soft[@]}"
    done <<<"$scenes"
} >"$record/table10.csv"
