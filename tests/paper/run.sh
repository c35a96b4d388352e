#!/usr/bin/env bash
# The study of the paper's evaluation on our data: bash tests/paper/run.sh [--quick] [--out DIR] [--only PART]... [--threads
# N]
#
#   --quick      two poses only (human_pair, creature), few weights
#   --out DIR    where tables, plots and assets go (default: build/paper/results)
#   --only PART  bar, times, subspace, standin, cubature, sheets, manifold or rivals; may be repeated (default: all)
#   --threads N  threads of each program (default: all cores)
#   --build DIR  an existing build folder to use (default: build/paper, configured if it is not there)
#
# Data: $PLIANT_DATA, else ../shared/data beside the checkout; sets that are not there are skipped. Plots and sheets need
#   apt-get install python3-numpy python3-pil python3-matplotlib
# Assets newer than the program are not baked again. README.md in this folder tells what is written.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
data=${PLIANT_DATA:-$root/../shared/data}
python=/usr/bin/python3
quick=0 out= build= threads=() parts=()
while (($#)); do
    case $1 in
        --quick) quick=1 ;;
        --out | --only | --threads | --build)
            (($# > 1)) || { echo "run.sh: $1 needs a value" >&2; exit 2; }
            case $1 in
                --out) out=$2 ;;
                --only) parts+=("$2") ;;
                --threads) threads=(--threads "$2") ;;
                --build) build=$2 ;;
            esac
            shift
            ;;
        -h | --help) sed -n '2,13s/^#  \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 0 ;;
        *) echo "run.sh: unknown option '$1'" >&2; exit 2 ;;
    esac
    shift
done
((${#parts[@]})) || parts=(bar times subspace standin cubature sheets manifold rivals)
for part in "${parts[@]}"; do
    case $part in
        bar | times | subspace | standin | cubature | sheets | manifold | rivals) ;;
        *) echo "run.sh: unknown part '$part'" >&2; exit 2 ;;
    esac
done
"$python" -c 'import numpy, PIL' 2> /dev/null || { echo "run.sh: apt-get install python3-numpy python3-pil" >&2; exit 1; }
"$python" -c 'import matplotlib' 2> /dev/null \
    || echo "run.sh: no plots, only tables: apt-get install python3-matplotlib" >&2

build=${build:-$root/build/paper}
out=${out:-$build/results}
[[ -e $build/CMakeCache.txt ]] || cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release > /dev/null
cmake --build "$build" --target pliant_tool pliant_study pliant_bar pliant_rivals creature > /dev/null
tool=$build/baker/pliant study=$build/tests/paper/pliant_study
mkdir -p "$out/assets" "$out/creature" "$out/bars"
out=$(cd "$out" && pwd)
"$build/samples/creature/creature" -o "$out/creature" > /dev/null

wants() { [[ " ${parts[*]} " == *" $1 "* ]]; }
say() { printf '%s  %s\n' "$(date +%T)" "$*" | tee -a "$out/log.txt"; }

# poses_of SET: sets the array `poses`; false, with a word, if the data is not there.
poses_of() {
    local creature=$out/creature/creature pose cow=$data/tet_mid/spot.msh
    case $1 in
        human_pair) poses=("$data"/human_pair/{man,woman}.ply) ;;
        creature2) poses=("${creature}"_{rest,curl}.ply) ;;
        creature5) poses=("${creature}"_{rest,reach,curl,leap,twist}.ply) ;;
        makehuman4) poses=("$data"/makehuman_body/{tpose,dance1_f00,walk1_f03,zombieWalk1_f20}.ply) ;;
        ict_face7) poses=("$data"/ict_face/{neutral,jaw_open,smile,pucker,cheek_puff,sneer_frown,blink_brow_down}.ply) ;;
        bar*) poses=("$out"/bars/bar_{straight,180}.msh) ;;
        cow*) poses=("$cow" "$out/spot_leap.msh") ;;
    esac
    if [[ $1 == cow* && -e $cow && ! -e $out/spot_leap.msh ]]; then
        "$tool" pose "$cow" "$root/samples/pose_scripts/spot_leap.txt" -o "$out/spot_leap.msh" >> "$out/bakes.log" 2>&1
    fi
    for pose in "${poses[@]}"; do
        [[ -e $pose ]] || { say "skipping $1: $pose is not there"; return 1; }
    done
}

# The tolerance says how accurate snapshots are to be; --dim says how many dimensions, whatever error that gives.
adaptive=(--subspace adaptive --tolerance 1e-4)

# asset_of NAME OPTION...: bakes assets/NAME.pliant from `poses` unless it is there and newer than the tool. Exit code 4, a
# missed tolerance, is a result of the study and no failure of it.
asset_of() {
    local asset=$out/assets/$1.pliant start=$SECONDS code=0
    shift
    [[ $asset -nt $tool ]] && return
    "$tool" bake "${poses[@]}" -o "$asset" --position-error 0 --check-samples 0 --fresh-samples 0 --best-effort --quiet \
        --continuity off \
        --report "${asset%.pliant}.json" "${threads[@]}" "$@" 2>> "$out/bakes.log" || code=$?
    ((code == 0 || code == 4)) || { say "baking $asset failed, exit code $code: $out/bakes.log"; return 1; }
    say "baked ${asset##*/} in $((SECONDS - start)) s"
}

# subspace SET DIMS TRAIN FRESH: errors over d and over w, and the averages for the manifold experiment.
subspace() {
    local poses start=$SECONDS
    poses_of "$1" || return 0
    asset_of "$1" "${adaptive[@]}" --dim "${2##*,}" || return 0
    "$study" -o "$out/$1" --dims "$2" --train "$3" --fresh "$4" --basis "adaptive=$out/assets/$1.pliant" --snapshots \
        "${threads[@]}" "${poses[@]}" 2>> "$out/study.log"
    say "subspace $1: $((SECONDS - start)) s"
}

# energy SET MATERIAL DIMS FRESH: Algorithm 1 and Barbic et al. over d for another energy.
energy() {
    local poses start=$SECONDS
    poses_of "$1" || return 0
    "$study" -o "$out/$1_$2" --material "$2" --dims "$3" --kinds krylov,barbic --train 1 --fresh "$4" "${threads[@]}" \
        "${poses[@]}" 2>> "$out/study.log"
    say "subspace $1, $2: $((SECONDS - start)) s"
}

# cubature SET DIM FRESH: the paper's cubature beside ours.
cubature() {
    local poses start=$SECONDS
    poses_of "$1" || return 0
    mkdir -p "$out/cubature"
    "$study" -o "$out/cubature/$1" --dims 1 --kinds none --train 1 --fresh "$3" --cubatures "$2" "${threads[@]}" \
        "${poses[@]}" 2>> "$out/study.log"
    mv "$out/cubature/$1_cubatures.csv" "$out/"
    say "cubature $1: $((SECONDS - start)) s"
}

# standin SET DIM FRESH "COUNTS" "GHOSTS": cubature with COUNTS elements per dimension, ghosts with GHOSTS vertices.
standin() {
    local poses start=$SECONDS assets=() count
    poses_of "$1" || return 0
    for count in $4; do
        asset_of "$1_cubature$count" "${adaptive[@]}" --dim "$2" --elements "$((count * $2))" || continue
        assets+=(--asset "cubature ${count}d=$out/assets/$1_cubature$count.pliant")
    done
    for count in $5; do
        asset_of "$1_ghost$count" "${adaptive[@]}" --dim "$2" --energy ghost --ghost-vertices "$count" || continue
        assets+=(--asset "ghost $count=$out/assets/$1_ghost$count.pliant")
    done
    # One snapshot and no bases: the parts of the assets' errors are wanted alone.
    mkdir -p "$out/standin"
    "$study" -o "$out/standin/$1" --dims 1 --kinds none --train 1 --fresh "$3" "${assets[@]}" "${threads[@]}" "${poses[@]}" \
        2>> "$out/study.log"
    mv "$out/standin/$1_assets.csv" "$out/$1_assets.csv"
    say "surrogate energy $1: $((SECONDS - start)) s"
}

# sheet SET DIM OPTION...: pictures side by side. The paper's method is Algorithm 1 with a ghost.
sheet() {
    local poses start=$SECONDS set=$1 dim=$2
    poses_of "$set" || return 0
    shift 2
    asset_of "$set" "${adaptive[@]}" --dim "$dim" || return 0
    asset_of "${set}_krylov" --subspace krylov --dim "$dim" || return 0
    asset_of "${set}_krylov_ghost" --subspace krylov --dim "$dim" --energy ghost || return 0
    "$python" "$here/sheet.py" --tool "$tool" -o "$out/${set}_sheet.png" --title "$set, d = $dim" \
        --asset "Algorithm 1, cubature=$out/assets/${set}_krylov.pliant" \
        --asset "Algorithm 1, ghost=$out/assets/${set}_krylov_ghost.pliant" \
        --asset "adaptive, cubature=$out/assets/$set.pliant" --continuity off "$@" "${poses[@]}" 2>> "$out/sheets.log"
    say "sheet $set: $((SECONDS - start)) s"
}

# bases SET OPTION...: pictures of the bases side by side, as the paper's Figures 5 and 7.
bases() {
    local poses start=$SECONDS set=$1 dim assets=()
    poses_of "$set" || return 0
    shift
    asset_of "${set}_barbic17" --subspace barbic --dim 17 || return 0
    assets+=(--asset "Barbic et al., d 17=$out/assets/${set}_barbic17.pliant")
    for dim in 3 9 17; do
        asset_of "${set}_krylov$dim" --subspace krylov --dim "$dim" || return 0
        assets+=(--asset "Algorithm 1, d $dim=$out/assets/${set}_krylov$dim.pliant")
    done
    asset_of "${set}17" "${adaptive[@]}" --dim 17 || return 0
    "$python" "$here/sheet.py" --tool "$tool" -o "$out/${set}_bases.png" --title "$set, bases" "${assets[@]}" \
        --asset "adaptive, d 17=$out/assets/${set}17.pliant" --continuity off "$@" "${poses[@]}" 2>> "$out/sheets.log"
    say "bases $set: $((SECONDS - start)) s"
}

# rivals SET [OPTION...]: other ways to blend beside the elastic average and the runtime.
rivals() {
    local poses start=$SECONDS set=$1
    poses_of "$set" || return 0
    shift
    asset_of "${set}_rival" --tolerance 2e-3 || return 0
    "$build/tests/paper/pliant_rivals" -o "$out/rivals/$set" --fresh 1 --asset "$out/assets/${set}_rival.pliant" "$@" \
        "${poses[@]}" 2>> "$out/study.log" || return 0
    ways+=("$set=$out/rivals/$set")
    say "rivals $set: $((SECONDS - start)) s"
}

say "study of $("$tool" --version 2> /dev/null || echo pliant), $(nproc) cores"
if wants bar; then
    start=$SECONDS sizes=()
    ((quick)) && sizes=(--cells 4 --length-cells 24 --samples 21)
    "$build/tests/paper/pliant_bar" -o "$out/bar.csv" "${sizes[@]}" "${threads[@]}" 2>> "$out/study.log"
    say "bar: $((SECONDS - start)) s"
fi
if wants times; then
    start=$SECONDS sizes=()
    ((quick)) && sizes=(--quick)
    "$python" "$here/table1.py" --build "$build" --data "$data" -o "$out" "${sizes[@]}" "${threads[@]}" 2>> "$out/study.log"
    say "times: $((SECONDS - start)) s"
fi
if wants subspace; then
    if ((quick)); then
        subspace human_pair 3,5,9 7 7
        subspace creature2 3,5,9,17 15 7
    else
        subspace human_pair 3,5,9,17 17 19
        subspace creature2 3,9,17 15 7
        subspace ict_face7 8,16 16 5
        subspace makehuman4 12,36 12 6
        subspace creature5 16,48 36 9
        "$build/tests/paper/pliant_bar" --write "$out/bars" --degrees 180 2>> "$out/study.log"
        energy bar mooney-rivlin 3,9,17 7
        energy cow stvk 3,9,17 3
        energy cow mooney-rivlin 3,9,17 3
        energy human_pair arap 3,9,17 7
        energy creature2 arap 3,9,17 7
    fi
fi
if wants standin; then
    if ((quick)); then
        standin human_pair 5 7 "2 4 8" "200 1000"
    else
        standin human_pair 9 15 "1 2 4 6 8 12" "200 500 1000"
        standin creature2 17 15 "1 2 4 6 8 12" "200 500 1000"
    fi
fi
if wants cubature; then
    cubature human_pair 9 7
    if ((!quick)); then
        cubature creature5 16 7
        cubature ict_face7 16 7
    fi
fi
if wants sheets; then
    bases creature2 --weights 0.5,0.5 --weights 0.25,0.75 --up z
    if ((quick)); then
        sheet creature2 17 --weights 0.5,0.5 --weights 0.25,0.75 --up z
    else
        sheet makehuman4 36 --weights 1,1,1,1 --weights 1,1,0,0 --weights 0,1,0,1 --weights 1,0,2,1 --up y
    fi
fi
if wants manifold; then
    sets=()
    for set in creature2 creature5; do
        [[ -e $out/${set}_train.npy ]] && sets+=("$set")
    done
    if ((${#sets[@]})); then
        "$python" "$here/manifold.py" "$out" "${sets[@]}"
        say "manifolds: ${sets[*]}"
    else
        say "manifolds need the averages that the part 'subspace' writes"
    fi
fi
if wants rivals; then
    mkdir -p "$out/rivals"
    ways=()
    for bar in bend120 twist180 twist360; do
        "$build/tests/paper/pliant_rivals" -o "$out/rivals/$bar" --bar "$bar" 2>> "$out/study.log"
        ways+=("$bar=$out/rivals/$bar")
    done
    rivals human_pair
    if ((!quick)); then
        rivals creature5
        rivals makehuman4
        rivals ict_face7
    fi
    "$python" "$here/rivals/table.py" -o "$out/rivals".md --pictures "$out/rivals" \
        --z-up bend120 --z-up twist180 --z-up twist360 --z-up creature5 "${ways[@]}"
fi
"$python" "$here/tables.py" "$out"
say "tables and plots: $out"
