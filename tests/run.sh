#!/usr/bin/env bash
# Every test: the default build, the examples in the documentation, and the lean library without features; three.js and the
# Python package where what they need can be had.
#
# Tests on a graphics adapter run on whatever there is, a software driver included. Where Linux has neither a graphics
# card nor a software Vulkan driver, Mesa's is installed (Debian and Ubuntu, as root or with sudo). Without an adapter
# the tests fail; UMBRAGE_REQUIRE_GPU=0 lets them say aloud what they skip instead.
#
# The real meshes are looked for in $UMBRAGE_MESHES, or in ../shared/meshes, and inputs of public reports in
# $UMBRAGE_REPORTS, or in ../shared/reports. Without them their tests are skipped, which the last lines list;
# UMBRAGE_REQUIRE_MESHES=1 makes that a failure. Arguments go to the test binaries (for example a part of a test's name).
#
# The window of `umbrage view` is tested by tests/viewer/check.sh, a command of its own, since it has to be built first,
# for minutes. What it draws and how it answers is tested here, too.
set -euo pipefail
cd "$(dirname "$0")/.."

export UMBRAGE_REQUIRE_GPU="${UMBRAGE_REQUIRE_GPU:-1}"

# Whether anything here could be an adapter.
has_adapter() {
    [ "$(uname -s)" != Linux ] && return 0
    [ -n "${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-}" ] && return 0
    # ls fails if one of several is missing; what it finds is what counts.
    [ -n "$(ls /dev/dri/renderD* /usr/share/vulkan/icd.d/lvp_icd.*.json /etc/vulkan/icd.d/*.json 2>/dev/null)" ]
}

if [ "$UMBRAGE_REQUIRE_GPU" = 1 ] && ! has_adapter; then
    sudo=""
    [ "$(id -u)" = 0 ] || sudo="sudo -n"
    if command -v apt-get >/dev/null && { [ -z "$sudo" ] || $sudo true 2>/dev/null; }; then
        echo "no graphics adapter: installing Mesa's software Vulkan driver (mesa-vulkan-drivers)"
        $sudo apt-get update -qq
        $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends mesa-vulkan-drivers
    else
        echo "no graphics adapter: install a software Vulkan driver (Debian and Ubuntu: mesa-vulkan-drivers;" >&2
        echo "Fedora: mesa-vulkan-drivers; Arch: vulkan-swrast), or set UMBRAGE_REQUIRE_GPU=0 to skip its tests" >&2
        exit 2
    fi
fi

scratch="$(mktemp -d)"
# What was skipped, whether or not the tests pass: cargo shows nothing that a passing test says.
say_skipped() {
    if [ -s "$UMBRAGE_SKIPPED" ]; then
        printf '\nskipped, %s in all:\n' "$(sort -u "$UMBRAGE_SKIPPED" | wc -l)"
        sort -u "$UMBRAGE_SKIPPED" | sed 's/^/  /'
    else
        printf '\nno test was skipped\n'
    fi
    rm -rf "$scratch"
}
export UMBRAGE_SKIPPED="$scratch/skipped"
trap say_skipped EXIT

# Mesa looks for a display server, and complains on standard error where there is no folder for one.
export NODEVICE_SELECT=1
if [ ! -d "${XDG_RUNTIME_DIR:-}" ]; then
    export XDG_RUNTIME_DIR="$scratch"
fi

cargo test --locked --lib --bins --tests -- "$@"
cargo test --locked --doc -- "$@"
cargo test --locked --no-default-features --lib -- "$@"

# Whether three.js, in Chromium, shows the occlusion that `umbrage ambient` writes. Without node, Chromium or three.js
# it is skipped; not part of a run of some tests.
three_js() {
    command -v node >/dev/null || { echo "SKIPPED three.js: no node"; return; }
    local code=0
    TMPDIR="$scratch" timeout 30 node tests/three/check.mjs "${CARGO_TARGET_DIR:-target}/debug/umbrage" || code=$?
    # A machine under load, or a network that does not answer.
    [ "$code" != 124 ] || { echo "SKIPPED three.js: not done after 30 seconds"; return; }
    return "$code"
}
# Whether the page of `umbrage check --html` draws, and heeds its keys, in Chromium.
page() {
    command -v node >/dev/null || { echo "SKIPPED page: no node"; return; }
    local code=0
    TMPDIR="$scratch" timeout 60 node tests/page/check.mjs "${CARGO_TARGET_DIR:-target}/debug/umbrage" || code=$?
    [ "$code" != 124 ] || { echo "SKIPPED page: not done after 60 seconds"; return; }
    return "$code"
}
# What is tested beside the crate, where that can be: lines that begin with SKIPPED say what cannot.
beside() {
    local said
    said="$("$@")" || { echo "$said"; exit 1; }
    echo "$said"
    echo "$said" | sed -n 's/^SKIPPED //p' >>"$UMBRAGE_SKIPPED"
}
if [ $# = 0 ]; then
    beside three_js
    beside page
    beside env UMBRAGE_COMMAND="${CARGO_TARGET_DIR:-target}/debug/umbrage" bash python/test.sh # the Python package
fi
