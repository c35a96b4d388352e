#!/usr/bin/env bash
# install_packages.sh without installing anything: test_install_packages.sh SCRIPT
set -euo pipefail
script=$1

fail() {
    echo "failed: $*" >&2
    exit 1
}

source "$script"
[[ $(pliant_packages engines | wc -l) -ge 3 ]] || fail "group engines is short"
for group in build player tests; do
    [[ $(pliant_packages "$group" | wc -l) -ge 7 ]] || fail "group $group is short"
done
[[ -z $(for group in build player tests engines; do pliant_packages "$group"; done | sort | uniq -d) ]] \
    || fail "a package is in two groups"

code=0
pliant_packages nonsense 2> /dev/null || code=$?
[[ $code == 2 ]] || fail "an unknown group ends with $code"

# A machine without apt: the lists are printed, and the exit code says that nothing was done.
bash=$(command -v bash)
code=0
printed=$(PATH=/nowhere "$bash" "$script" build player 2>&1) || code=$?
[[ $code == 1 ]] || fail "without apt-get the exit code is $code"
[[ $printed == *libeigen3-dev* && $printed == *libglfw3-dev* && $printed == *hint:* ]] || fail "without apt-get: $printed"
