# Every library that Froude is built with, found in one place. Versions are those of Debian 12; THIRD_PARTY.md lists the licences.

# oneTBB first and by its own package file: another project's FindTBB module may shadow it.
find_package(TBB 2021 CONFIG REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(PkgConfig REQUIRED)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)

if(FROUDE_PROGRAM)
  find_package(fmt 9 REQUIRED)
  find_package(nlohmann_json 3.11 REQUIRED)
  find_package(CLI11 REQUIRED)
  pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
  pkg_check_modules(muparser REQUIRED IMPORTED_TARGET muparser)
  pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)
  find_package(HDF5 REQUIRED COMPONENTS C HL)
  find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)
endif()
if(FROUDE_TESTS)
  find_package(GTest 1.12 REQUIRED)
endif()
if(FROUDE_BENCH)
  find_package(benchmark REQUIRED)
endif()
