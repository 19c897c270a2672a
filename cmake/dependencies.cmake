# Every library comes from a Debian 12 package; README.md has the table with the reasons.
find_package(PkgConfig REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(OpenMP REQUIRED COMPONENTS CXX)
find_package(Threads REQUIRED)
pkg_check_modules(zeromq REQUIRED IMPORTED_TARGET libzmq>=4.3.4)
pkg_check_modules(hdf5 REQUIRED IMPORTED_TARGET hdf5-serial)
pkg_check_modules(xxhash REQUIRED IMPORTED_TARGET libxxhash)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
# AVX-512, AVX2 and the baseline: what lies between costs minutes to compile and serves no processor
# of the last ten years.
target_compile_definitions(PkgConfig::hwy INTERFACE
  "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|HWY_AVX3_DL)")
pkg_check_modules(muparser REQUIRED IMPORTED_TARGET muparser)
find_path(eigen_include Eigen/Dense PATH_SUFFIXES eigen3 REQUIRED)
find_path(hypre_include HYPRE.h PATH_SUFFIXES hypre)
find_library(hypre_library HYPRE)

# Third-party headers are system headers: their warnings are not ours.
add_library(fluxpact_eigen INTERFACE)
target_include_directories(fluxpact_eigen SYSTEM INTERFACE ${eigen_include})
target_compile_definitions(fluxpact_eigen INTERFACE EIGEN_DONT_PARALLELIZE)
# cppzmq and msgpack-cxx are header-only.
add_library(fluxpact_msgpack INTERFACE)
target_compile_definitions(fluxpact_msgpack INTERFACE MSGPACK_NO_BOOST)
