# What `cmake --install` puts where: the libraries with their public headers, a CMake package with one component a floor, files
# for pkg-config, and the program where it is built. All of it may be moved afterwards.
include(CMakePackageConfigHelpers)

set(froude_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/froude)
set(froude_pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
set(froude_parts base fields particles solver) # along the arrow: each needs those before it
set(froude_side_parts) # beside it: each needs base and fields
if(FROUDE_OPENVDB)
  list(APPEND froude_side_parts openvdb)
endif()

foreach(part IN LISTS froude_parts froude_side_parts)
  install(TARGETS froude_${part} EXPORT froude-${part}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
    RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(EXPORT froude-${part} NAMESPACE froude:: FILE froude-${part}-targets.cmake DESTINATION ${froude_package_dir})
  get_target_property(folder froude_${part} SOURCE_DIR)
  get_target_property(headers froude_${part} FROUDE_PUBLIC_HEADERS)
  list(TRANSFORM headers PREPEND ${folder}/)
  # Where the include root has them: src/base/api.h is <froude/base/api.h>, fields/openvdb/… <froude/fields/openvdb/…>.
  file(RELATIVE_PATH place ${PROJECT_SOURCE_DIR} ${folder})
  string(REGEX REPLACE "^src/" "" place ${place})
  install(FILES ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/froude/${place})
endforeach()
install(TARGETS froude_umbrella EXPORT froude-umbrella)
install(EXPORT froude-umbrella NAMESPACE froude:: FILE froude-umbrella-targets.cmake DESTINATION ${froude_package_dir})
install(FILES ${FROUDE_INCLUDE_ROOT}/froude/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/froude)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/froudeConfig.cmake.in ${PROJECT_BINARY_DIR}/froudeConfig.cmake
  INSTALL_DESTINATION ${froude_package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/froudeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/froudeConfig.cmake ${PROJECT_BINARY_DIR}/froudeConfigVersion.cmake
  DESTINATION ${froude_package_dir})

# froude_pkgconfig(name description libs requires): one .pc file, whose prefix follows the file.
function(froude_pkgconfig name description libs requires)
  file(RELATIVE_PATH to_prefix /${froude_pkgconfig_dir} /)
  string(REGEX REPLACE "/$" "" to_prefix "${to_prefix}")
  # Users of shared libraries do not link what these are made with.
  set(private "")
  if(name STREQUAL "froude-base")
    set(private "tbb >= 2021, libhwy")
    if(NOT BUILD_SHARED_LIBS)
      string(APPEND requires ", ${private}")
      set(private "")
    endif()
  endif()
  # OpenVDB has no file for pkg-config. Of a static library its users link what it is made with.
  if(name STREQUAL "froude-openvdb" AND NOT BUILD_SHARED_LIBS)
    string(APPEND libs " -lopenvdb -lImath")
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/froude.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${froude_pkgconfig_dir})
endfunction()
froude_pkgconfig(froude-base "numbers, transforms, parallel loops, random numbers, saved states" "-lfroude_base"
  "eigen3 >= 3.4")
froude_pkgconfig(froude-fields "polygons and their distance" "-lfroude_fields" "froude-base = ${PROJECT_VERSION}")
froude_pkgconfig(froude-particles "particle pools, cells, emitters, sinks" "-lfroude_particles"
  "froude-fields = ${PROJECT_VERSION}")
froude_pkgconfig(froude-solver "worlds of bullets and fluids among polygons" "-lfroude_solver"
  "froude-particles = ${PROJECT_VERSION}")
if(FROUDE_OPENVDB)
  froude_pkgconfig(froude-openvdb "the distance field against OpenVDB, and .vdb files" "-lfroude_openvdb"
    "froude-fields = ${PROJECT_VERSION}")
endif()
froude_pkgconfig(froude "2D particle simulation among rigid polygons" "" "froude-solver = ${PROJECT_VERSION}")

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/THIRD_PARTY.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
if(TARGET froude)
  file(RELATIVE_PATH to_libraries /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(froude PROPERTIES INSTALL_RPATH $ORIGIN/${to_libraries})
  install(TARGETS froude RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  # What `froude chart` runs and compares with.
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/froude)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/tests/data DESTINATION ${CMAKE_INSTALL_DATADIR}/froude/tests)
  # The manual page and the completion scripts are the program's own words about its command line.
  if(NOT CMAKE_CROSSCOMPILING)
    set(words ${PROJECT_BINARY_DIR}/share)
    file(MAKE_DIRECTORY ${words})
    add_custom_command(OUTPUT ${words}/froude.1 ${words}/froude ${words}/_froude ${words}/froude.fish
      COMMAND froude man > ${words}/froude.1
      COMMAND froude completion bash > ${words}/froude
      COMMAND froude completion zsh > ${words}/_froude
      COMMAND froude completion fish > ${words}/froude.fish
      DEPENDS froude VERBATIM)
    add_custom_target(froude_words ALL DEPENDS ${words}/froude.1)
    install(FILES ${words}/froude.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL)
    install(FILES ${words}/froude DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions OPTIONAL)
    install(FILES ${words}/_froude DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions OPTIONAL)
    install(FILES ${words}/froude.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d OPTIONAL)
  endif()
endif()
