#!/usr/bin/env bash
# Bakes and times the benchmark sets: bash tests/bench/run.sh [SET...]   (default: all that are there)
# bash tests/bench/run.sh converge: whether the unreduced averages of all sets converge instead.
# Sets: creature (generated), human_pair, makehuman, mhr, mhr_hi (data next to the checkout or in $PLIANT_DATA).
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
data=${PLIANT_DATA:-$root/../shared/data}
build=$root/build/bench
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build" --target pliant_bench pliant_converge creature >/dev/null

if [ "${1:-}" = converge ]; then
    exec "$build/tests/bench/pliant_converge" "$data"/human_pair/{man,woman}.ply \
        -- "$data"/mhr_body/{rest,pose0,pose1,pose2,pose3}.ply \
        -- "$data"/makehuman_body/{rest,benchmark,dance1_f00,tpose,walk1_f03,walk1_f10,zombieWalk1_f00,zombieWalk1_f20}.ply \
        -- "$data"/ict_face/{neutral,jaw_open,smile,pucker,blink_brow_down,cheek_puff,sneer_frown}.ply
fi

mkdir -p "$build/creature"
arguments=()
add() { # NAME POSE...
    local name=$1; shift
    local pose
    for pose in "$@"; do
        [ -e "$pose" ] || { echo "skipping $name: $pose is not there" >&2; return; }
    done
    [ ${#arguments[@]} -eq 0 ] || arguments+=(--)
    arguments+=("$name" "$@")
}
for set in "${@:-creature human_pair makehuman mhr mhr_hi}"; do
    for name in $set; do
        case $name in
        creature)
            "$(find "$build" -name creature -type f -perm -u+x | head -1)" -o "$build/creature" >/dev/null
            add creature "$build"/creature/creature_{rest,reach,curl,leap,twist}.ply ;;
        human_pair) add human_pair "$data"/human_pair/{man,woman}.ply ;;
        makehuman) add makehuman "$data"/makehuman_body/{tpose,dance1_f00,walk1_f03,zombieWalk1_f20}.ply ;;
        mhr) add mhr "$data"/mhr_body/{rest,pose0,pose1,pose2,pose3}.ply ;;
        mhr_hi) add mhr_hi "$data"/mhr_body_hi/{rest,pose0,pose1,pose2,pose3}.ply ;;
        *) echo "unknown set '$name'" >&2; exit 2 ;;
        esac
    done
done
[ ${#arguments[@]} -gt 0 ] || { echo "nothing to run" >&2; exit 1; }
exec "$build/tests/bench/pliant_bench" "${arguments[@]}" --csv "$build/bench.csv"
