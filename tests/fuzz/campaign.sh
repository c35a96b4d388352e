#!/bin/bash
# Fuzzes everything that reads bytes from outside, on all cores, and prints executions, coverage and findings.
#
#   tests/fuzz/campaign.sh --minutes N [--only NAME,...] [--keep]
#
# Builds the libFuzzer targets (clang) into build/fuzz and divides the N minutes among them, one process a core. Crashes lie
# in build/fuzz/found/NAME; the exit code is 1 if there are any. --keep replaces the corpora of the tree (corpus/NAME) by
# what reaches the same coverage with the fewest bytes; files named seed_* stay.
set -euo pipefail
cd "$(dirname "$0")/../.."

readonly all=(asset obj ply off msh medit vega vtk gltf json)
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
cmake -S . -B $build -G Ninja -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DPLIANT_BUILD_FUZZERS=ON \
    -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPLIANT_BUILD_SAMPLES=OFF > $build.configure.log 2>&1 || {
    cat $build.configure.log >&2; exit 1; }
ninja -C $build "${targets[@]/#/pliant_fuzz_}" > $build/build.log || { tail -30 $build/build.log >&2; exit 1; }

# Seconds for each target, so that all of them take the minutes asked for on all cores.
readonly seconds=$(( (minutes * 60 * cores + ${#targets[@]} - 1) / ${#targets[@]} ))

options_of() { # of one target: the length of inputs, tokens
    case $1 in
    asset) echo -max_len=17000 -dict=tests/fuzz/pliant.dict ;;
    gltf) echo -max_len=12000 -dict=tests/fuzz/text.dict ;;
    *) echo -max_len=2000 -dict=tests/fuzz/text.dict ;;
    esac
}

fuzz() { # runs one target; never fails, the table tells
    local name=$1 work=$build/work/$1 found=$build/found/$1
    mkdir -p "$work" "$found" "$corpus/$name"
    # shellcheck disable=SC2046
    ASAN_OPTIONS=quarantine_size_mb=16 $build/tests/fuzz/pliant_fuzz_"$name" $(options_of "$name") \
        -timeout=10 -rss_limit_mb=2048 -max_total_time="$seconds" -print_final_stats=1 -artifact_prefix="$found/" \
        "$work" "$corpus/$name" > "$build/$name.log" 2>&1 || true
}
export -f fuzz options_of
export build corpus seconds
find $build/found -type f -delete 2> /dev/null || true
printf '%s\n' "${targets[@]}" | xargs -P "$cores" -I{} bash -c 'fuzz {}'

smaller() { # the corpus of one target that reaches what its corpus and the work did
    local name=$1 folder=$corpus/$1 merged=$build/merged/$1 file
    rm -rf "$merged" && mkdir -p "$merged"
    # shellcheck disable=SC2046
    $build/tests/fuzz/pliant_fuzz_"$name" $(options_of "$name") -merge=1 "$merged" "$folder" "$build/work/$name" \
        > "$build/$name.merge.log" 2>&1
    find "$folder" -name 'found_*' -delete
    for file in "$merged"/*; do
        file_is_seed=no
        for seed in "$folder"/seed_*; do cmp -s "$file" "$seed" && file_is_seed=yes; done
        [ $file_is_seed = yes ] || cp "$file" "$folder/found_$(sha256sum < "$file" | cut -c 1-12)"
    done
}

[ $keep = no ] || for name in "${targets[@]}"; do smaller "$name"; done

number() { grep -oP "$2\s*\K[0-9]+" "$build/$1.log" | "$3" -1 || true; } # of a log: behind a word, the first or last
printf '%-8s %12s %10s %8s %8s %8s\n' target executions 'a second' blocks new findings
total=0
for name in "${targets[@]}"; do
    found=$(find "$build/found/$name" -type f | wc -l)
    before=$(number "$name" 'INITED cov:' head)
    after=$(grep -oP 'cov: \K[0-9]+' "$build/$name.log" | tail -1 || true)
    runs=$(number "$name" 'number_of_executed_units:' tail)
    speed=$(number "$name" 'average_exec_per_sec:' tail)
    printf '%-8s %12s %10s %8s %8s %8s\n' "$name" "${runs:--}" "${speed:--}" "${after:--}" \
        "$(( ${after:-0} - ${before:-0} ))" "$found"
    total=$((total + found))
done
echo "corpora: $(du -sb --apparent-size $corpus | cut -f 1) bytes"
if [ $total -gt 0 ]; then
    echo "findings, each with a report in $build/NAME.log:"
    find $build/found -type f
    exit 1
fi
