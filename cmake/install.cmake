# `cmake --install`: the programs, and what a program from outside needs to be a particle server with an engine of its own
# (docs/new-backend.md). The component `development` is the latter alone.
include(CMakePackageConfigHelpers)
set(package_folder lib/cmake/fluxpact)

foreach(program coordinator cfd_server dem_server dem_server_lammps dem_server_liggghts)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION bin COMPONENT programs)
  endif()
endforeach()
if(TARGET fluxpact_yade)
  install(FILES ${CMAKE_BINARY_DIR}/share/fluxpact/yade_adapter.py DESTINATION share/fluxpact COMPONENT programs)
endif()

# The one target that is meant to be linked, and the static libraries that it needs.
set_target_properties(fluxpact_dem_participant PROPERTIES EXPORT_NAME particle_server)
install(TARGETS fluxpact_options fluxpact_eigen fluxpact_msgpack
    fluxpact_base fluxpact_io fluxpact_mesh fluxpact_scene fluxpact_message fluxpact_session fluxpact_participant fluxpact_serve
    fluxpact_domain fluxpact_walls fluxpact_particles fluxpact_insertion fluxpact_interphase fluxpact_dem_participant
  EXPORT fluxpact_targets ARCHIVE DESTINATION lib COMPONENT development)
install(EXPORT fluxpact_targets FILE targets.cmake NAMESPACE fluxpact:: DESTINATION ${package_folder} COMPONENT development)

# What an engine and its main program may include: by the paths of the source tree, under include/fluxpact.
foreach(folder base mesh scene participant)
  install(DIRECTORY proto/${folder} DESTINATION include/fluxpact/proto COMPONENT development FILES_MATCHING PATTERN "*.hpp")
endforeach()
install(FILES dem_server/backends/domain.hpp dem_server/backends/engine_state.hpp dem_server/backends/particle_engine.hpp
    dem_server/backends/particle_rows.hpp
  DESTINATION include/fluxpact/dem_server/backends COMPONENT development)
install(FILES dem_server/participant/particle_server.hpp
  DESTINATION include/fluxpact/dem_server/participant COMPONENT development)

write_basic_package_version_file(${CMAKE_BINARY_DIR}/fluxpact-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES cmake/fluxpact-config.cmake cmake/packages.cmake ${CMAKE_BINARY_DIR}/fluxpact-config-version.cmake
  DESTINATION ${package_folder} COMPONENT development)
