# Every library comes from a Debian 12 package; README.md has the table with the reasons.
include(packages)
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
