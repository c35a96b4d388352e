#!/usr/bin/env bash
# The whole project under sanitizers, a kind at a time: bash tests/sanitizers/run.sh KIND...
#
#   thread         ThreadSanitizer: the tool on several threads, and the runtime's; builds build/tsan
#   python         ThreadSanitizer: the Python module; builds build/tsan, and a wheel (PyPI)
#   memory         MemorySanitizer: the tests in C of the runtime, the fuzz corpus; builds build/msan with clang
#   address        address and undefined-behaviour sanitizers: the tool; builds build/asan
#   uninitialised  valgrind: uninitialised bytes that decide or are written, by the tool of build/dev
#   corpus         MemorySanitizer: the fuzz corpus alone, compiled in a temporary folder; the suite's slice
#
# `bash tests/run.sh --asan` runs the whole suite under address and undefined-behaviour sanitizers. Each kind begins with a
# planted fault, which must be reported. Exit code: 0 if nothing was found, 1 if something was, 2 for a wrong kind, 77 if a
# program is missing.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
cd "$here/../.."
readonly here python=/usr/bin/python3
work=$(mktemp -d "${TMPDIR:-/tmp}/pliant_sanitizers_XXXXXX")
readonly work
trap 'rm -rf "$work"' EXIT

export UBSAN_OPTIONS=print_stacktrace=1
export ASAN_OPTIONS=detect_stack_use_after_return=1:check_initialization_order=1:strict_init_order=1:strict_string_checks=1
export TSAN_OPTIONS='history_size=4 second_deadlock_stack=1'

need() {
    command -v "$1" > /dev/null || { echo "skipped: there is no $1 (bash samples/install_packages.sh tests)"; exit 77; }
}

# planted <text of the report> <program>...: a fault must be reported, or the sanitizer proves nothing.
planted() {
    local report=$1
    shift
    if "$@" > "$work/planted.log" 2>&1 || ! grep -q "$report" "$work/planted.log"; then
        echo "the planted fault is not reported as '$report':" >&2
        cat "$work/planted.log" >&2
        exit 1
    fi
    echo "planted: $report"
}

build() {
    local preset=$1
    shift
    cmake --preset "$preset" > "$work/configure.log" || { cat "$work/configure.log" >&2; return 1; }
    cmake --build --preset "$preset" --target "$@"
}

# Threads of the library as built, so that what they do is seen as well.
planted_race() {
    c++ -std=c++17 -fsanitize=thread -O1 -g1 -Ibaker -x c++ - -x none build/tsan/baker/libpliant_baker.a \
        -lfmt -o "$work/race" << 'END'
#include "base/common/parallel.h"
#include <unistd.h>
int main()
{
    int shared = 0;
    pliant::set_thread_count(4);
    pliant::for_each_task(100, [&](std::size_t, std::size_t) { ::usleep(1000), ++shared; });
}
END
    planted "ThreadSanitizer: data race" "$work/race"
}

run_thread() {
    build tsan pliant_tool runtime_threads runtime_endurance baker_io_write_file
    planted_race
    ctest --preset tsan -R '^(runtime_threads|runtime_endurance|baker_io_write_file)$'
    "$python" -B "$here/session.py" --rings 300 --threads 4 build/tsan/baker/pliant
}

# Debian's Python is not instrumented: what it shares is not seen, what the module shares is.
run_python() {
    build tsan pliant_baker pliant_runtime
    planted_race
    local folder=$PWD/build/tsan/tests/baker/python flags="-fsanitize=thread -g1" library
    mkdir -p "$folder"
    CFLAGS=$flags CXXFLAGS=$flags LDFLAGS=-fsanitize=thread SKBUILD_INSTALL_STRIP=false \
        SKBUILD_CMAKE_BUILD_TYPE=RelWithDebInfo "$python" -B tests/baker/python/package.py "$PWD" "$folder" build \
        "$PWD/build/tsan" c++
    library=$(cc -print-file-name=libtsan.so)
    # A shell ignores interrupts of what it starts in the background, and the tests send some. A daemon thread that Python
    # abandons when it ends joins no worker.
    env --default-signal=INT TSAN_OPTIONS="$TSAN_OPTIONS report_thread_leaks=0" OPENBLAS_NUM_THREADS=1 \
        LD_PRELOAD="$(readlink -f "$library")" "$folder/environment/bin/python" -B tests/baker/python/test_threads.py
}

planted_read() {
    clang -fsanitize=memory -O1 -g1 -x c - -o "$work/read" << 'END'
#include <stdlib.h>
int main(void) { volatile int* a = malloc(4 * sizeof *a); if (a[1] == 7) abort(); return 0; }
END
    planted "MemorySanitizer: use-of-uninitialized-value" "$work/read"
}

run_memory() {
    need clang
    planted_read
    build msan pliant_c_tests
    ctest --preset msan -L '^c_only$' --parallel 2
}

# As the preset msan, without its build folder. Where the compiler makes vectors of loops, MemorySanitizer reports masked
# stores whose lanes are masked out.
run_corpus() {
    need clang
    planted_read
    clang -O1 -g1 -ffp-contract=off -fsanitize=memory -fno-vectorize -fno-slp-vectorize -Iruntime -Iformats runtime/*.c \
        tests/fuzz/{fuzz_asset,mutate_asset,mutate_bytes,replay}.c -lm -o "$work/corpus"
    "$work/corpus" tests/fuzz/corpus/asset/*
}

run_address() {
    cc -fsanitize=address,undefined -O1 -g1 -x c - -o "$work/overflow" << 'END'
#include <stdlib.h>
int main(void) { volatile char* a = malloc(8); return a[8]; }
END
    planted "AddressSanitizer: heap-buffer-overflow" "$work/overflow"
    build asan pliant_tool
    "$python" -B "$here/session.py" build/asan/baker/pliant
}

run_uninitialised() {
    need valgrind
    cc -O1 -g1 -x c - -o "$work/write" << 'END'
#include <stdlib.h>
#include <unistd.h>
int main(void) { return write(1, malloc(16), 16) != 16; }
END
    planted "points to uninitialised byte" valgrind --error-exitcode=99 "$work/write"
    [[ -x build/dev/baker/pliant ]] || build dev pliant_tool
    "$python" -B "$here/session.py" --valgrind build/dev/baker/pliant "$@"
}

(($#)) || { sed -n '2,14s/^#  \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2; }
for kind in "$@"; do
    if [[ ! $kind =~ ^(thread|python|memory|address|uninitialised|corpus)$ ]]; then
        echo "tests/sanitizers/run.sh: error: there is no kind '$kind'" >&2
        exit 2
    fi
    printf '\n== %s\n' "$kind"
    "run_$kind"
done
echo "nothing was found by: $*"
