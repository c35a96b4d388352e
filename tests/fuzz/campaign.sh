#!/bin/bash
# Fuzzes everything that reads bytes from outside, on all cores, and prints executions, coverage and findings.
#
#   tests/fuzz/campaign.sh --minutes N [--only NAME,...] [--keep]
#
# Builds the targets into build/fuzz and runs them for N minutes, one process a core: half of the time is the loader's of
# assets, the rest is divided among the others. Findings lie in build/fuzz/found/NAME; the exit code is 1 if there are any.
# --keep replaces the corpora of the tree (corpus/NAME) by the smallest inputs with the same coverage; files named seed_*
# stay. Needs clang, and for the target wasm node and zig (PyPI), without which that target does nothing.
set -euo pipefail
cd "$(dirname "$0")/../.."

readonly all=(asset obj ply off msh mesh veg vtk gltf config wasm)
targets=("${all[@]}")
minutes=0
keep=no
usage() { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
while [ $# -gt 0 ]; do
    case $1 in
    --minutes) minutes=${2:-}; shift 2 || usage ;;
    --only) IFS=, read -ra targets <<< "${2:-}"; shift 2 || usage ;;
    --keep) keep=yes; shift ;;
    *) usage ;;
    esac
done
[[ $minutes =~ ^[1-9][0-9]*$ ]] || usage
for name in "${targets[@]}"; do [[ " ${all[*]} " == *" $name "* ]] || usage; done

readonly build=build/fuzz corpus=tests/fuzz/corpus
cores=$(nproc)
readonly cores
mkdir -p $build
cmake -S . -B $build -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DPLIANT_BUILD_FUZZERS=ON \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPLIANT_BUILD_SAMPLES=OFF > $build.configure.log 2>&1 || {
    cat $build.configure.log >&2; exit 1; }
native=()
for name in "${targets[@]}"; do [ "$name" = wasm ] || native+=("pliant_fuzz_$name"); done
[ ${#native[@]} = 0 ] || ninja -C $build "${native[@]}" > $build/build.log || { tail -30 $build/build.log >&2; exit 1; }
[[ " ${targets[*]} " != *" wasm "* ]] || python3 runtime/bindings/web/build.py $build/package

# The loader's time goes to as many processes as it is longer than the minutes.
readonly all_seconds=$((minutes * 60 * cores)) others=$(printf "%s\n" "${targets[@]}" | grep -cvx asset || true)
loader_seconds=0
[[ " ${targets[*]} " != *" asset "* ]] || loader_seconds=$((others > 0 ? all_seconds / 2 : all_seconds))
readonly loader_processes=$(((loader_seconds + minutes * 60 - 1) / (minutes * 60)))
readonly other_seconds=$((others > 0 ? (all_seconds - loader_seconds + others - 1) / others : 0))

options_of() { # of one target: the length of inputs, tokens
    case $1 in
    asset) echo -max_len=17000 -dict=tests/fuzz/pliant.dict ;;
    gltf) echo -max_len=12000 -dict=tests/fuzz/text.dict ;;
    *) echo -max_len=2000 -dict=tests/fuzz/text.dict ;;
    esac
}

fuzz() { # fuzz NAME SECONDS LOG; never fails, the table tells
    local name=$1 seconds=$2 log=$3 work=$build/work/$1 found=$build/found/$1
    mkdir -p "$work" "$found" "$corpus/$name"
    if [ "$name" = wasm ]; then
        python3 -B tests/fuzz/wasm.py build/zig/bin/python $build/package "$found" "$seconds" $corpus/asset/* > "$log" 2>&1
        return 0
    fi
    # shellcheck disable=SC2046
    ASAN_OPTIONS=quarantine_size_mb=16 $build/tests/fuzz/pliant_fuzz_"$name" $(options_of "$name") \
        -timeout=10 -rss_limit_mb=2048 -max_total_time="$seconds" -print_final_stats=1 -artifact_prefix="$found/" \
        "$work" "$corpus/$name" > "$log" 2>&1 || true
}
export -f fuzz options_of
export build corpus
rm -rf $build/found $build/logs && mkdir -p $build/logs
{
    for ((i = 0; i < loader_processes; ++i)); do
        echo "asset $((loader_seconds / loader_processes)) $build/logs/asset.$i"
    done
    for name in "${targets[@]}"; do [ "$name" = asset ] || echo "$name $other_seconds $build/logs/$name.0"; done
} | xargs -P "$cores" -I{} bash -c 'fuzz {}'

smaller() { # the corpus of one target that reaches what its corpus and the work did
    local name=$1 folder=$corpus/$1 merged=$build/merged/$1 file
    rm -rf "$merged" && mkdir -p "$merged"
    # shellcheck disable=SC2046
    $build/tests/fuzz/pliant_fuzz_"$name" $(options_of "$name") -use_counters=0 -merge=1 "$merged" "$folder" \
        "$build/work/$name" > "$build/$name.merge.log" 2>&1
    find "$folder" -name 'found_*' -delete
    for file in "$merged"/*; do
        file_is_seed=no
        for seed in "$folder"/seed_*; do cmp -s "$file" "$seed" && file_is_seed=yes; done
        [ $file_is_seed = yes ] || cp "$file" "$folder/found_$(sha256sum < "$file" | cut -c 1-12)"
    done
}

[ $keep = no ] || for name in "${targets[@]}"; do [ "$name" = wasm ] || smaller "$name"; done

number() { grep -hoP "$2\s*\K[0-9]+" "$build/logs/$1".* | sort -n | $3 -1 || true; } # of logs: behind a word, least or most
sum() { grep -hoP "$2\s*\K[0-9]+" "$build/logs/$1".* | paste -sd+ | bc; }
printf '%-8s %12s %10s %8s %8s %8s\n' target executions 'a second' blocks new findings
all_runs=0 all_found=0
for name in "${targets[@]}"; do
    found=$(find "$build/found/$name" -type f | wc -l)
    before=$(number "$name" 'INITED cov:' head)
    after=$(number "$name" 'cov:' tail)
    runs=$(sum "$name" 'number_of_executed_units:')
    speed=$(sum "$name" 'average_exec_per_sec:')
    printf '%-8s %12s %10s %8s %8s %8s\n' "$name" "${runs:--}" "${speed:--}" "${after:--}" \
        "$(( ${after:-0} - ${before:-0} ))" "$found"
    all_runs=$((all_runs + ${runs:-0})) all_found=$((all_found + found))
done
printf '%-8s %12s %37s\n' all $all_runs $all_found
echo "corpora: $(du -sb --apparent-size $corpus | cut -f 1) bytes"
if [ $all_found -gt 0 ]; then
    echo "findings, each with a report in $build/logs:"
    find $build/found -type f
    exit 1
fi
