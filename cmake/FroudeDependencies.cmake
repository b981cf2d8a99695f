# Every library that Froude is built with, found in one place. Versions are those of Debian 12; THIRD_PARTY.md lists the licences.

# oneTBB first and by its own package file: another project's FindTBB module may shadow it.
find_package(TBB 2021 CONFIG REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(PkgConfig REQUIRED)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
find_package(Boost 1.74 REQUIRED)

if(FROUDE_OPENVDB)
  # In a function, since OpenVDB's module sets BUILD_SHARED_LIBS and other variables of ours; its folder is looked into for this
  # alone, since it has modules for other libraries too. TBB stays the one found above, whatever FindTBB.cmake lies there.
  function(froude_find_openvdb)
    find_path(FROUDE_OPENVDB_MODULES FindOpenVDB.cmake PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB
      lib/cmake/OpenVDB lib64/cmake/OpenVDB DOC "Folder of FindOpenVDB.cmake")
    mark_as_advanced(FROUDE_OPENVDB_MODULES)
    if(NOT FROUDE_OPENVDB_MODULES)
      message(FATAL_ERROR "OpenVDB was not found (Debian: libopenvdb-dev libboost-iostreams-dev). Set FROUDE_OPENVDB_MODULES "
        "to the folder of its FindOpenVDB.cmake, or build without it: -DFROUDE_OPENVDB=OFF")
    endif()
    list(APPEND CMAKE_MODULE_PATH ${FROUDE_OPENVDB_MODULES})
    set(CMAKE_FIND_PACKAGE_PREFER_CONFIG ON)
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    find_package(OpenVDB 10 REQUIRED QUIET)
  endfunction()
  froude_find_openvdb()
endif()

if(FROUDE_PROGRAM)
  find_package(fmt 9 REQUIRED)
  find_package(nlohmann_json 3.11 REQUIRED)
  find_package(CLI11 REQUIRED)
  pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
  pkg_check_modules(muparser REQUIRED IMPORTED_TARGET muparser)
  pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)
  find_package(HDF5 REQUIRED COMPONENTS C HL)
  find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)
  find_package(LibXml2 2.9 REQUIRED)
  pkg_check_modules(polyclipping REQUIRED IMPORTED_TARGET polyclipping)
  find_path(SVGPP_INCLUDE_DIR svgpp/svgpp.hpp REQUIRED)
endif()
if(FROUDE_TESTS)
  find_package(GTest 1.12 REQUIRED)
endif()
if(FROUDE_BENCH)
  find_package(benchmark REQUIRED)
  find_package(box2d 2.4 REQUIRED)
  find_package(ccd 2 REQUIRED)
endif()
