# The packages that our libraries link: found when they are built, and again by those who link the installed ones.
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
