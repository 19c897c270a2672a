# find_package(fluxpact): the target fluxpact::particle_server, of which docs/new-backend.md tells.
include(${CMAKE_CURRENT_LIST_DIR}/packages.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/targets.cmake)
