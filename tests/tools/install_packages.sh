#!/usr/bin/env bash
# Install what is missing of the named groups (build, test) from Debian 12. README.md says why each is there.
set -euo pipefail
build=(g++ cmake ninja-build make git pkg-config libeigen3-dev libzmq3-dev cppzmq-dev libmsgpack-cxx-dev libhdf5-dev
  libyaml-cpp-dev libcli11-dev libspdlog-dev libfmt-dev libxxhash-dev libmuparser-dev libhypre-dev libhwy-dev
  liblammps-dev libliggghts-dev openmpi-bin)
test=(libgtest-dev libgmock-dev librapidcheck-dev clang-format-14 clang-tidy-14 python3 python3-h5py python3-zmq python3-msgpack python3-yaml
  python3-numpy python3-matplotlib yade)
wanted=()
for group in "$@"; do
  case $group in
    build) wanted+=("${build[@]}") ;;
    test) wanted+=("${test[@]}") ;;
    *) echo "unknown group '$group'; groups: build test" >&2; exit 2 ;;
  esac
done
missing=()
for package in "${wanted[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0
echo "installing: ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
