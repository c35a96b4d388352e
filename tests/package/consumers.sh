#!/usr/bin/env bash
# Outside projects use the runtime: consumers.sh SOURCE WORK find_package|shared|pkg_config|subdirectory
#
# SOURCE is the checkout, WORK a folder of this test alone, emptied first. No C++ compiler is to be had: CXX is /bin/false.
set -euo pipefail
source_dir=$1 work_dir=$2 way=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
export CXX=/bin/false
unset CFLAGS LDFLAGS

rm -rf "$work_dir"
mkdir -p "$work_dir"

# install_runtime [<cmake option>...]: to $work_dir/prefix
install_runtime() {
    cmake -S "$source_dir" -B "$work_dir/pliant" -DPLIANT_RUNTIME_ONLY=ON -DCMAKE_INSTALL_PREFIX="$work_dir/first" "$@"
    cmake --build "$work_dir/pliant"
    cmake --install "$work_dir/pliant"
    # An installed tree may be moved; paths of the build must not be in it.
    mv "$work_dir/first" "$work_dir/prefix"
    if grep -rIl -e "$source_dir" -e "$work_dir" "$work_dir/prefix" > "$work_dir/leaks.txt"; then
        echo "these installed files name folders of the build:"
        cat "$work_dir/leaks.txt"
        exit 1
    fi
    if find "$work_dir/prefix" -name '*internal.h' | grep .; then
        echo "these headers are not part of the interface"
        exit 1
    fi
}

# build_and_run [<cmake option>...]
build_and_run() {
    cmake -S "$here/consumer" -B "$work_dir/consumer" -DCMAKE_BUILD_TYPE=Debug "$@"
    cmake --build "$work_dir/consumer"
    "$work_dir/consumer/consumer"
    "$work_dir/consumer/gl_consumer"
}

case $way in
    find_package)
        install_runtime
        build_and_run -DCMAKE_PREFIX_PATH="$work_dir/prefix"
        ;;
    shared)
        install_runtime -DBUILD_SHARED_LIBS=ON
        build_and_run -DCMAKE_PREFIX_PATH="$work_dir/prefix"
        ;;
    pkg_config)
        if ! command -v pkg-config > /dev/null; then
            echo "skipped: pkg-config is not installed"
            exit 77
        fi
        install_runtime
        folder=$(dirname "$(find "$work_dir/prefix" -name pliant.pc)")
        export PKG_CONFIG_PATH=$folder
        pkg-config --print-errors --exists 'pliant'
        # Word splitting wanted: the flags are words.
        # shellcheck disable=SC2046
        "${CC:-cc}" -std=c99 "$here/consumer/main.c" -o "$work_dir/consumer" $(pkg-config --cflags --libs pliant)
        "$work_dir/consumer"
        # shellcheck disable=SC2046
        "${CC:-cc}" -std=c99 "$here/consumer/gl_main.c" -o "$work_dir/gl_consumer" $(pkg-config --cflags --libs pliant_gl)
        "$work_dir/gl_consumer"
        ;;
    subdirectory)
        # The runtime takes back the fast-math of the other project: its sources refuse it.
        build_and_run -DPLIANT_SOURCE="$source_dir" -DCMAKE_C_FLAGS=-ffast-math
        # The licence lies beside that of the other project, whose folder has another name.
        cmake --install "$work_dir/consumer" --prefix "$work_dir/prefix"
        test -f "$work_dir/prefix/share/doc/pliant/LICENSE"
        ;;
    *)
        echo "consumers.sh: unknown way '$way'"
        exit 2
        ;;
esac
