#!/usr/bin/env bash
# Installs what is missing, builds, runs the tests. From a fresh clone on Debian 12: bash tests/run.sh
#
#   (no option)      the whole suite (preset dev), with a tool by clang for the test that two compilers make the same bytes
#                    (preset clang), and the hostile-input and runtime part under sanitizers (preset asan)
#   --dev            only the whole suite
#   --asan           only the suite under address and undefined-behaviour sanitizers, all of it
#   --filter REGEX   only tests whose name matches
#   --only-build     configure and build, run nothing
#   --no-install     do not touch the system's packages
#
# The last line reads "N passed, N failed, N skipped"; a suite that does not build counts as one failure.
# Exit code: 0 if nothing failed and something ran, 1 if not, 2 for a wrong option.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
exec < /dev/null # nothing below may wait for an answer

# What runs under sanitizers by default, everything that bytes from outside reach; tests/CMakeLists.txt names the same
# labels.
readonly asan_labels='^(runtime|fuzz|bad_input|hostile)$'

usage() { sed -n '4,10s/^#  \{0,1\}//p' tests/run.sh; }

run_dev=1 run_asan=1 asan_everything=0 only_build=0 install=1
filter=()
while (($#)); do
    case $1 in
        --dev) run_asan=0 ;;
        --asan) run_dev=0 asan_everything=1 ;;
        --filter)
            (($# > 1)) || { echo "tests/run.sh: --filter needs a regular expression" >&2; exit 2; }
            filter=(-R "$2")
            shift
            ;;
        --only-build) only_build=1 ;;
        --no-install) install=0 ;;
        -h | --help) usage; exit 0 ;;
        *)
            echo "tests/run.sh: unknown option '$1'" >&2
            usage >&2
            exit 2
            ;;
    esac
    shift
done
((run_dev || run_asan)) || { echo "tests/run.sh: --dev and --asan exclude each other" >&2; exit 2; }

passed=0 failed=0 skipped=0

heading() { printf '\n== %s\n' "$*"; }

# build_suite <preset> <target> [<cmake option>...]: all of it, or one target.
build_suite() {
    local preset=$1 target=$2 launcher=()
    shift 2
    heading "$preset: build"
    if command -v ccache > /dev/null; then
        launcher=(-DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    fi
    cmake --preset "$preset" "${launcher[@]}" "$@" \
        && cmake --build --preset "$preset" --target "$target" --parallel "$(nproc)"
}

# test_suite <preset> [<ctest option>...]: runs it and adds to the counts. They come from ctest's own result file; a test
# that could not start is a failure there, not a skip. count_results.py also names the slowest tests and those that took
# longer than tests/budgets.txt allows.
test_suite() {
    local preset=$1 results=$PWD/build/$1/results.xml counts
    shift
    heading "$preset: test"
    rm -f "$results"
    ctest --preset "$preset" --parallel 2 --no-tests=ignore --output-junit "$results" "${filter[@]}" "$@" || true
    counts=$(python3 tests/count_results.py "$results") || counts="0 1 0"
    read -r suite_passed suite_failed suite_skipped <<< "$counts"
    ((passed += suite_passed, failed += suite_failed, skipped += suite_skipped)) || true
}

# suite <preset> <target> [<cmake option>...] -- [<ctest option>...]
suite() {
    local preset=$1 target=$2 options=()
    shift 2
    while [[ $1 != -- ]]; do
        options+=("$1")
        shift
    done
    shift
    if ! build_suite "$preset" "$target" "${options[@]}"; then
        echo "tests/run.sh: preset $preset does not build" >&2
        ((failed += 1))
    elif ((!only_build)); then
        test_suite "$preset" "$@"
    fi
}

if ((install)); then
    heading "packages"
    if ! bash samples/install_packages.sh build player tests; then
        echo "tests/run.sh: the packages cannot be installed; if they are here by other means, use --no-install" >&2
        run_dev=0 run_asan=0 failed=1
    elif ((!only_build)) && ! bash samples/install_packages.sh engines; then
        echo "tests/run.sh: warning: browsers, Godot, Blender, Wine or qemu cannot be installed;" \
            "the tests that ask them will be skipped" >&2
    fi
fi
second_tool=()
if ((run_dev && run_asan)) && command -v clang++ > /dev/null; then
    if build_suite clang pliant_tool -DPLIANT_BUILD_SAMPLES=OFF; then
        second_tool=(-DPLIANT_SECOND_TOOL="$PWD/build/clang/baker/pliant")
    else
        echo "tests/run.sh: preset clang does not build" >&2
        ((failed += 1))
    fi
fi
if ((run_dev)); then
    suite dev all -DPLIANT_BUILD_SAMPLES=ON "${second_tool[@]}" --
fi
if ((run_asan && asan_everything)); then
    suite asan all -DPLIANT_BUILD_SAMPLES=ON --
elif ((run_asan)); then
    shared=() # the reference takes most of a minute to compute them
    ((run_dev)) && shared=(-DPLIANT_TEST_ASSETS="$PWD/build/dev/tests/runtime/assets")
    suite asan pliant_sanitized_tests -DPLIANT_BUILD_SAMPLES=OFF "${shared[@]}" -- -L "$asan_labels"
fi

if ((!only_build && passed + failed == 0)); then
    echo "tests/run.sh: no test ran" >&2
    failed=1
fi
printf '\n%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
((failed == 0))
