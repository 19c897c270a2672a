#!/usr/bin/env bash
# clang-tidy 14 over the sources of a configured build folder: check_tidy.sh BUILD [FILE...]. All of them take a while.
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$1
shift
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(git ls-files 'proto/*.cpp' 'coordinator/*.cpp' 'cfd_server/*.cpp' 'dem_server/*.cpp')
# The compile commands are those of g++; clang does not know all its warnings.
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy-14 -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
