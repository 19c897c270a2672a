#!/bin/sh
# Builds Debian's hypre from its source package with OpenMP, which the binary package lacks: then the multigrid
# cycles of the fluid server run on threads, too. Installs into the folder given and prints how to use it.
#
#   tests/tools/build_threaded_hypre.sh FOLDER
set -eu
folder=$(realpath -m "${1:?usage: build_threaded_hypre.sh FOLDER}")
version=$(dpkg-query -W -f '${Version}' libhypre-dev)
apt="$folder/apt"
mkdir -p "$apt/etc" "$apt/lists/partial" "$apt/cache/archives/partial"
sed 's/^Types:.*/Types: deb-src/' /etc/apt/sources.list.d/debian.sources > "$apt/etc/debian.sources"
options="-o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts=$apt/etc -o Dir::State::lists=$apt/lists
  -o Dir::Cache=$apt/cache -o APT::Sandbox::User=root"
cd "$folder"
# shellcheck disable=SC2086  # several options
apt-get $options update -qq
# shellcheck disable=SC2086
apt-get $options --download-only source "hypre=$version"
tar xzf "hypre_${version%-*}.orig.tar.gz"
cmake -S "hypre-${version%-*}/src" -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DHYPRE_WITH_OPENMP=ON \
  -DHYPRE_INSTALL_PREFIX="$folder/prefix" -DCMAKE_INSTALL_PREFIX="$folder/prefix"
ninja -C build install
echo "configure fluxpact with -Dhypre_include=$folder/prefix/include -Dhypre_library=$folder/prefix/lib/libHYPRE.a"
