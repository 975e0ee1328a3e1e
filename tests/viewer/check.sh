#!/usr/bin/env bash
# Whether the window of `umbrage view` opens, follows the pointer and the keys, and closes: in a real window of a virtual
# display. Builds the command with the feature viewer, unless UMBRAGE_VIEWER names one that was built with it:
#
#   tests/viewer/check.sh [FOLDER]
#
# Pictures of the window are kept in FOLDER, if it is named. A command of its own, and no part of tests/run.sh: the feature
# brings about 80 crates. Needs Linux, Xvfb, xdotool, ImageMagick (Debian and Ubuntu: xvfb xdotool imagemagick) and a Vulkan
# driver, a software one included; says what is missing, and skips. What needs no window is tested by `cargo test`.
set -euo pipefail
cd "$(dirname "$0")/../.."

for tool in Xvfb xdotool import compare convert; do
    command -v "$tool" >/dev/null || { echo "SKIPPED viewer: no $tool"; exit 0; }
done

viewer="${UMBRAGE_VIEWER:-}"
if [ -z "$viewer" ]; then
    cargo build --locked --features viewer --bin umbrage
    viewer="${CARGO_TARGET_DIR:-target}/debug/umbrage"
fi
viewer="$(realpath "$viewer")"

scratch="$(mktemp -d)"
pictures="${1:-$scratch}"
mkdir -p "$pictures"
display_job="" window_job=""
clean_up() {
    for job in $window_job $display_job; do kill "$job" 2>/dev/null || true; done
    rm -rf "$scratch"
}
trap clean_up EXIT
fail() {
    echo "viewer: $*" >&2
    [ ! -s "$scratch/said" ] || sed 's/^/  it said: /' "$scratch/said" >&2
    exit 1
}
# Mesa looks for a display server of its own.
export NODEVICE_SELECT=1 XDG_RUNTIME_DIR="$scratch"
unset WAYLAND_DISPLAY WAYLAND_SOCKET

# A box that lacks its top, above a floor.
cat >"$scratch/box.obj" <<'OBJ'
v -1 0 -1
v 1 0 -1
v 1 0 1
v -1 0 1
v -1 2 -1
v 1 2 -1
v 1 2 1
v -1 2 1
v -5 -0.5 -5
v 5 -0.5 -5
v 5 -0.5 5
v -5 -0.5 5
f 1 2 3 4
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
f 12 11 10 9
OBJ

# Without a display: exit code 2, and one line with what to do.
code=0
env -u DISPLAY "$viewer" view "$scratch/box.obj" 2>"$scratch/said" || code=$?
[ "$code" = 2 ] || fail "without a display the exit code is $code, not 2"
grep -q "there is no display for a window; run it on a desktop" "$scratch/said" || fail "no remedy without a display"
code=0
DISPLAY=:77 "$viewer" view "$scratch/box.obj" 2>"$scratch/said" || code=$?
[ "$code" = 2 ] || fail "with a display that is not there the exit code is $code, not 2"

Xvfb -displayfd 3 -screen 0 1000x700x24 -nolisten tcp 3>"$scratch/display" 2>/dev/null &
display_job=$!
for _ in $(seq 50); do [ -s "$scratch/display" ] && break; sleep 0.1; done
[ -s "$scratch/display" ] || { echo "SKIPPED viewer: Xvfb does not start"; exit 0; }
DISPLAY=":$(cat "$scratch/display")"
export DISPLAY

# A file that is no mesh is an error before any window.
code=0
"$viewer" view "$0" 2>"$scratch/said" || code=$?
[ "$code" = 2 ] || fail "for a file that is no mesh the exit code is $code, not 2"

open() {
    "$viewer" view "$scratch/box.obj" --light point:4,7,3 --size 900x600 --theme light "$@" 2>"$scratch/said" &
    window_job=$!
}
# Waits for the window to close by itself, with exit code 0 and without a word from the graphics driver's checks.
closed() {
    local code=0
    for _ in $(seq 300); do kill -0 "$window_job" 2>/dev/null || break; sleep 0.1; done
    kill -0 "$window_job" 2>/dev/null && fail "$1: the window does not close"
    wait "$window_job" || code=$?
    window_job=""
    [ "$code" = 0 ] || fail "$1: exit code $code"
    ! grep -qiE "validation|panicked|error" "$scratch/said" || fail "$1: complaints"
}
take() { import -silent -window root "$pictures/$1.png"; }
# How many pixels of two pictures of the window differ.
differing() { compare -metric AE "$pictures/$1.png" "$pictures/$2.png" null: 2>&1 | sed 's/ .*//' || true; }
# Takes pictures until two are equal, so that all is drawn.
settle() {
    take "$1"
    for _ in $(seq 100); do
        sleep 0.4
        mv "$pictures/$1.png" "$pictures/before.png"
        take "$1"
        [ "$(differing before "$1")" != 0 ] || { rm "$pictures/before.png"; return 0; }
    done
    fail "$1: the picture never rests"
}
differ() {
    local count
    count="$(differing "$1" "$2")"
    awk -v n="$count" 'BEGIN { exit !(n > 500) }' || fail "$1 and $2 should differ, and do in $count pixels"
}

# A picture of the window by itself, with every layer.
open --shadow map:size=64 --mode difference --show truth,silhouette,volume,caps,defects,lights --screenshot "$pictures/all.png"
closed "screenshot"
[ -s "$pictures/all.png" ] || fail "no screenshot was written"

# By hand.
open --shadow rays
for _ in $(seq 100); do xdotool search --name "box.obj" >/dev/null 2>&1 && break; sleep 0.1; done
window="$(xdotool search --name "box.obj" | head -1)"
[ -n "$window" ] || fail "there is no window"
eval "$(xdotool getwindowgeometry --shell "$window")"
drag() { # from x, y to x, y of the window
    xdotool mousemove "$((X + $1))" "$((Y + $2))" mousedown 1
    for i in 1 2 3 4; do
        xdotool mousemove "$((X + $1 + ($3 - $1) * i / 4))" "$((Y + $2 + ($4 - $2) * i / 4))"
        sleep 0.05
    done
    xdotool mouseup 1
}
settle start
# There is no window manager that would do it.
xdotool windowfocus --sync "$window"
# The light by its handle: its numbers in the panel change. Then the view: they do not.
numbers() { convert "$pictures/$1.png" -crop "300x24+$((X + 570))+$((Y + 86))" +repage "$pictures/$2.png"; }
drag 363 71 310 120
settle light
numbers start numbers-start
numbers light numbers-light
[ "$(differing numbers-start numbers-light)" != 0 ] || fail "the light does not follow its handle"
drag 200 450 330 420
settle turned
differ light turned
numbers turned numbers-turned
[ "$(differing numbers-light numbers-turned)" = 0 ] || fail "turning the view moves the light"
xdotool key t
xdotool key t
settle technique
differ turned technique
xdotool key 1
settle truth
differ technique truth
drag 280 500 140 500
settle divider
differ truth divider
xdotool key n
sleep 1
settle defect
differ divider defect
xdotool key q
closed "by hand"
echo "the window opens, follows drags and keys, and closes"
