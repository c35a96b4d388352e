#!/usr/bin/env bash
# From a fresh clone to a character on the screen: bash samples/demo.sh
#
#   (no option)   installs what is missing, builds, makes the example poses, bakes them, opens the player
#   --headless    draws build/demo/*.png instead of opening a window; so do CI=true and a machine without a display
#   --truth       with --headless: also computes an unreduced average (some minutes) and draws it beside the blends
#   --no-install  does not touch the system's packages
#
# On Debian 12, as root or with sudo; the first run takes some minutes, the next ones seconds. Everything lands in build/.
# Exit code: 0 done, 1 something failed (the last lines say what), 2 wrong option.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source samples/install_packages.sh

headless=0 install=1 truth=0
[[ ${CI:-} == true || (-z ${DISPLAY:-} && -z ${WAYLAND_DISPLAY:-}) ]] && headless=1
while (($#)); do
    case $1 in
        --headless) headless=1 ;;
        --truth) truth=1 ;;
        --no-install) install=0 ;;
        -h | --help)
            sed -n '2,10s/^#  \{0,1\}//p' samples/demo.sh
            exit 0
            ;;
        *)
            echo "samples/demo.sh: error: unknown option '$1'" >&2
            echo "hint: bash samples/demo.sh --help" >&2
            exit 2
            ;;
    esac
    shift
done

readonly build=build/release demo=build/demo
readonly player=$build/samples/player/pliant-player asset=$demo/creature.pliant
# The first pose is the one that the others are compared with, so rest leads.
readonly poses=($demo/poses/creature_{rest,reach,curl,leap,twist}.ply)

step() { printf '\n== %s\n' "$*"; }

fail() {
    echo "samples/demo.sh: error: $*" >&2
    exit 1
}

# newer_than FILE OTHER...: FILE exists and none of the others is newer.
newer_than() {
    local file=$1 other
    shift
    [[ -e $file ]] || return 1
    for other in "$@"; do [[ ! $other -nt $file ]] || return 1; done
}

build_tools() {
    local command=(cmake --build --preset release --parallel "$(nproc)" --target pliant creature pliant-player) steps
    # A folder that was configured before the player's packages were there has no player.
    grep -qs '^build pliant-player:' "$build/build.ninja" \
        || cmake --preset release -DPLIANT_BUILD_TESTS=OFF > "$demo/configure.log" || {
        tail -n 20 "$demo/configure.log" >&2
        return 1
    }
    # The last line of a dry run holds the number of steps; [0/1] stands for a new configuration, after which ninja counts.
    steps=$(NINJA_STATUS='[%f/%t] ' "${command[@]}" -- -n | sed -n '$ { s|^\[0/1\].*|some|p; s|^\[.*/\([0-9]*\)\].*|\1|p }')
    [[ -z $steps ]] || echo "$steps steps; a first build takes about 3 minutes on two quick cores, up to 6 on slow ones"
    "${command[@]}"
}

make_poses() {
    mkdir -p "$demo/poses" && "$build/samples/creature/creature" -o "$demo/poses"
}

# The player draws without any display where the driver can; xvfb-run serves the machines where it cannot.
draw() {
    local out=$demo/$1
    shift
    if newer_than "$out" "$asset" "$player" samples/demo.sh; then
        echo "already there: $out"
        return
    fi
    echo "drawing $out"
    xvfb-run -a -s "-screen 0 1280x1024x24" "$player" "$asset" --up z "$@" "$out"
}

draw_pictures() {
    draw sheet.png --sheet \
        && draw player.png --weights 0,1,1,0,1 --both --hud --size 1440x810 --screenshot \
        && draw both.png --weights 0,1,1,0,1 --both --size 1600x800 --screenshot \
        && draw elastic.png --weights 0,1,1,0,1 --screenshot \
        && draw linear.png --weights 0,1,1,0,1 --linear --screenshot \
        && draw crowd.png --crowd 24 --size 1200x520 --screenshot
}

draw_truth() {
    echo 0,1,1,0,1 > $demo/truth.csv
    if ! newer_than $demo/truth_0.ply "${poses[@]}"; then
        "$build/baker/pliant" average "${poses[@]}" --path $demo/truth.csv -o $demo/truth_%d.ply || return 1
    fi
    draw truth.png --truth $demo/truth.csv $demo/truth_%d.ply --weights 0,1,1,0,1 --heat --size 1200x420 --screenshot
}

mkdir -p "$demo"
if ((install)); then
    step "packages"
    pliant_install_packages build player || fail "packages are missing"
    echo "all there"
fi
step "building the tool, the player and the generator of the example character"
build_tools || fail "the build failed, see above"
step "the example character: five poses of one mesh"
if newer_than "${poses[4]}" "$build/samples/creature/creature"; then
    echo "already there: $demo/poses"
else
    make_poses || fail "the example poses could not be made"
fi
step "baking the poses into $asset (once; about half a minute)"
if newer_than "$asset" "${poses[@]}" "$build/baker/pliant"; then
    echo "already there"
else
    "$build/baker/pliant" bake "${poses[@]}" -o "$asset" || fail "the bake failed, see above"
fi
step "measuring a thousand blends"
"$player" "$asset" --frames 1000 || fail "the player cannot use $asset"
if ((headless)); then
    step "pictures"
    draw_pictures || fail "a picture could not be drawn"
    if ((truth)); then draw_truth || fail "the unreduced average could not be made or drawn"; fi
    step "done: look at $demo/*.png"
else
    step "the player: drag the point in the polygon, H lists the keys, Esc quits"
    exec "$player" "$asset" --up z
fi
