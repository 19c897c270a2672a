# Reading Eigen and GoogleTest takes as long as compiling most of our sources: it is done once for all of them.
# A source must include what it uses all the same: `make tidy` reads it without them, and so does who builds with -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON (as with ccache).
# fluxpact_precompiled(NAME HEADERS ... LIBRARIES ...): a precompiled header. Who shares it is compiled with the same options,
# and with all definitions of the LIBRARIES, of which there should be few; more definitions do no harm.
function(fluxpact_precompiled name)
  cmake_parse_arguments(arg "" "" "HEADERS;LIBRARIES" ${ARGN})
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES})
  target_precompile_headers(${name} PRIVATE ${arg_HEADERS})
endfunction()

# fluxpact_library(NAME SOURCE ...): a static library with what base/vector.hpp and base/errors.hpp include, precompiled.
function(fluxpact_library name)
  add_library(${name} STATIC ${ARGN})
  target_precompile_headers(${name} REUSE_FROM fluxpact_headers)
endfunction()

set(fluxpact_headers <Eigen/Core> <Eigen/Geometry> <fmt/format.h>)
fluxpact_precompiled(fluxpact_headers HEADERS ${fluxpact_headers} LIBRARIES fluxpact_options fluxpact_eigen fmt::fmt)
