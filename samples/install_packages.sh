#!/usr/bin/env bash
# The Debian packages that Pliant is made with, and a way to install those that are missing.
#
#   bash samples/install_packages.sh GROUP...    installs what is missing of the groups: build, player, tests, engines
#   source samples/install_packages.sh           defines pliant_packages GROUP and pliant_install_packages GROUP...
#
# Root or sudo is needed only if something is missing. Without apt-get it says what to install and fails.

# pliant_packages GROUP: the group's packages, one a line.
pliant_packages() {
    case $1 in
        build)
            printf '%s\n' build-essential cmake ninja-build pkg-config libeigen3-dev libopenmesh-dev libsuitesparse-dev \
                libmetis-dev libopenblas-pthread-dev libtinyobjloader-dev libcli11-dev nlohmann-json3-dev libfmt-dev \
                zlib1g-dev libdraco-dev libmeshoptimizer-dev libstb-dev
            ;;
        player)
            # fonts-dejavu-core: for the captions of the moving pictures.
            printf '%s\n' libglfw3-dev libglm-dev libepoxy-dev libimgui-dev libpng-dev libjpeg-dev libtinygltf-dev xvfb \
                xauth libgl1-mesa-dri libegl1-mesa-dev libgl1-mesa-dev fonts-dejavu-core
            ;;
        tests)
            printf '%s\n' doctest-dev libbenchmark-dev python3-dev python3-venv python3-numpy python3-pil \
                python3-jsonschema clang libclang-rt-14-dev clang-format valgrind doxygen zsh fish \
                fonts-wqy-microhei
            ;;
        engines)
            # Programs that draw what `pliant export` writes, ffmpeg for the comparison clip, browsers for the page, other
            # processors with their C libraries and a Windows; the tests that ask them are skipped without. Large: 1.2 GB
            # with what they need.
            printf '%s\n' chromium firefox-esr godot3-server blender ffmpeg qemu-user libc6-arm64-cross \
                libc6-armhf-cross libc6-i386 wine wine64 mono-runtime mono-mcs
            # Node of other packagers brings npm along, and Debian's npm cannot be installed beside it.
            command -v npm > /dev/null || printf '%s\n' nodejs npm
            ;;
        *)
            echo "install_packages.sh: error: no package group '$1'" >&2
            echo "hint: the groups are build, player, tests and engines" >&2
            return 2
            ;;
    esac
}

# pliant_missing_packages GROUP...: what of the groups is not installed, one package a line.
pliant_missing_packages() {
    local group package wanted
    for group in "$@"; do
        wanted=$(pliant_packages "$group") || return
        for package in $wanted; do
            if [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2> /dev/null) != installed ]]; then
                echo "$package"
            fi
        done
    done
}

# pliant_install_packages GROUP...: installs what is missing. Quick when nothing is.
pliant_install_packages() {
    local groups=("$@") list sudo=() missing
    (($#)) || groups=(build player tests)
    if ! command -v apt-get > /dev/null || ! command -v dpkg-query > /dev/null; then
        for list in "${groups[@]}"; do pliant_packages "$list" > /dev/null || return; done
        echo "install_packages.sh: error: no apt-get here, so nothing can be checked or installed" >&2
        echo "hint: install what these Debian packages hold, then run CMake yourself (cmake --preset release):" >&2
        for list in "${groups[@]}"; do echo "  $list:" $(pliant_packages "$list") >&2; done
        return 1
    fi
    list=$(pliant_missing_packages "${groups[@]}") || return
    [[ -n $list ]] || return 0
    mapfile -t missing <<< "$list"
    if ((EUID != 0)); then
        if ! command -v sudo > /dev/null; then
            echo "install_packages.sh: error: packages are missing, and this is neither root nor is there sudo" >&2
            echo "hint: as root: apt-get install --no-install-recommends ${missing[*]}" >&2
            return 1
        fi
        sudo=(sudo)
    fi
    echo "installing ${#missing[@]} packages: ${missing[*]}"
    "${sudo[@]}" apt-get update -qq || return 1
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
        || return 1
}

if [[ ${BASH_SOURCE[0]} == "$0" ]]; then
    if [[ ${1:-} == -h || ${1:-} == --help ]]; then
        sed -n '2,7s/^#  \{0,1\}//p' "$0"
        exit 0
    fi
    pliant_install_packages "$@"
fi
