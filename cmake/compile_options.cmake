# One interface target carries what every translation unit of ours is compiled with.
# No -ffast-math: the same bits for any number of threads is a promise.
# Contraction into fused multiply-adds is a fixed choice of the compiler for one binary, so it stays.
add_library(fluxpact_options INTERFACE)
# Whoever links the installed libraries includes by the same paths, and has warnings of their own.
target_include_directories(fluxpact_options INTERFACE
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/generated> $<INSTALL_INTERFACE:include/fluxpact>)
target_compile_features(fluxpact_options INTERFACE cxx_std_20)
target_compile_options(fluxpact_options INTERFACE
  "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Werror>"
  # False alarms on std::string in g++ 12 (GCC bug 105651).
  "$<BUILD_INTERFACE:$<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>>")
# Everywhere, not only where a pragma stands: a precompiled header serves only sources that are compiled with the same options.
target_link_libraries(fluxpact_options INTERFACE OpenMP::OpenMP_CXX)
if(FLUXPACT_SANITIZE)
  # The preset runs the tests with ASAN_OPTIONS=intercept_tls_get_addr=0: up to GCC 13 the interceptor
  # takes some thread-local blocks for what they are not, and now and then the search for leaks dies
  # of it at the program's end (google/sanitizers, issue 1267).
  target_compile_options(fluxpact_options INTERFACE -fsanitize=${FLUXPACT_SANITIZE} -fno-omit-frame-pointer)
  if(FLUXPACT_SANITIZE MATCHES "undefined")
    # With these three checks before every access the compiler takes twice as long. AddressSanitizer stops at null pointers
    # and beyond an object's end by itself; misaligned access is not looked for.
    target_compile_options(fluxpact_options INTERFACE -fno-sanitize=null,alignment,object-size)
  endif()
  target_link_options(fluxpact_options INTERFACE -fsanitize=${FLUXPACT_SANITIZE})
endif()
