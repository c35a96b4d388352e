#!/usr/bin/env bash
# Builds and installs the runtime with the CMake of the environment: old_cmake.sh ENVIRONMENT SOURCE WORK
set -euo pipefail
cmake=$1/bin/cmake source_dir=$2 work_dir=$3
if [[ ! -f $1/is_complete ]]; then
    echo "skipped: the old CMake could not be fetched"
    exit 77
fi
rm -rf "$work_dir"
"$cmake" --version | head -n 1
"$cmake" -S "$source_dir" -B "$work_dir" -DPLIANT_RUNTIME_ONLY=ON -DPLIANT_BUILD_TESTS=OFF \
    -DCMAKE_INSTALL_PREFIX="$work_dir/prefix"
"$cmake" --build "$work_dir"
"$cmake" --install "$work_dir"
test -s "$work_dir/prefix/include/pliant.hpp"
test -n "$(find "$work_dir/prefix" -name LICENSE)"
