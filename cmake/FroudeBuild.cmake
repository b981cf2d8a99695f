# Compiler settings, the include root and the helper that makes one library per floor of the house.

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)

# Assertions belong to FROUDE_ASSERTS, not to the build type, so that the tests run optimised code with assertions on.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")
string(REPLACE "-O3" "-O2" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")

add_library(froude_settings INTERFACE)
target_compile_features(froude_settings INTERFACE cxx_std_20)
target_compile_definitions(froude_settings INTERFACE EIGEN_MPL2_ONLY EIGEN_DONT_PARALLELIZE)
# No silent contraction: the same source gives the same bits wherever it is inlined.
target_compile_options(froude_settings INTERFACE -ffp-contract=off -Wall -Wextra -Wshadow -Wpedantic -Wnon-virtual-dtor)
if(FROUDE_WERROR)
  target_compile_options(froude_settings INTERFACE -Werror)
endif()
if(FROUDE_SANITIZE)
  # Whatever a sanitizer finds ends the program: a report that scrolls by is not a failed test.
  target_compile_options(froude_settings INTERFACE -fsanitize=${FROUDE_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  target_link_options(froude_settings INTERFACE -fsanitize=${FROUDE_SANITIZE})
endif()
if(NOT FROUDE_ASSERTS AND NOT CMAKE_BUILD_TYPE STREQUAL "Debug")
  target_compile_definitions(froude_settings INTERFACE NDEBUG)
endif()

set(FROUDE_INCLUDE_ROOT ${PROJECT_BINARY_DIR}/include)

# <froude/fields/polygon.h> in the tree is the very file in fields/, by one symbolic link a floor.
function(froude_include_root)
  file(MAKE_DIRECTORY ${FROUDE_INCLUDE_ROOT}/froude)
  foreach(pair "base;src/base" "fields;fields" "particles;particles" "solver;solver")
    list(GET pair 0 name)
    list(GET pair 1 folder)
    file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${FROUDE_INCLUDE_ROOT}/froude/${name} SYMBOLIC)
  endforeach()
  find_package(Git QUIET)
  set(FROUDE_COMMIT "unknown")
  if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -c safe.directory=* describe --always --dirty --abbrev=12 --exclude=*
      WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
    if(commit)
      set(FROUDE_COMMIT ${commit})
    endif()
  endif()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/version.h.in ${FROUDE_INCLUDE_ROOT}/froude/version.h)
endfunction()

# froude_floor(name [dependencies...] [PRIVATE headers...]): the library froude::name of all sources in the current folder
# and below, but for folders that are a library of their own. Its public headers are those of the folder itself without the private ones and *-inl.h; see FroudeInstall.cmake.
function(froude_floor name)
  cmake_parse_arguments(PARSE_ARGV 1 floor "" "" "PRIVATE")
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  file(GLOB libraries CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} */CMakeLists.txt)
  foreach(library IN LISTS libraries)
    get_filename_component(library ${library} DIRECTORY)
    list(FILTER sources EXCLUDE REGEX "^${CMAKE_CURRENT_SOURCE_DIR}/${library}/")
  endforeach()
  file(GLOB headers CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.h)
  list(FILTER headers EXCLUDE REGEX "-inl\\.h$")
  foreach(header IN LISTS floor_PRIVATE)
    if(NOT header IN_LIST headers)
      message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR} has no ${header} to keep private")
    endif()
  endforeach()
  list(REMOVE_ITEM headers ${floor_PRIVATE} "")
  add_library(froude_${name} ${sources})
  add_library(froude::${name} ALIAS froude_${name})
  # Until 1.0 a minor version may change interfaces, so it is part of a shared library's name.
  set_target_properties(froude_${name} PROPERTIES EXPORT_NAME ${name} VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH $ORIGIN FROUDE_PUBLIC_HEADERS "${headers}")
  target_compile_features(froude_${name} PUBLIC cxx_std_20)
  target_include_directories(froude_${name} PUBLIC
    $<BUILD_INTERFACE:${FROUDE_INCLUDE_ROOT}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(froude_${name} PUBLIC Eigen3::Eigen ${floor_UNPARSED_ARGUMENTS} PRIVATE $<BUILD_INTERFACE:froude_settings>)
endfunction()

# What Highway is called while Froude is built, and what an installed package calls it (froudeConfig.cmake).
set(FROUDE_HIGHWAY $<BUILD_INTERFACE:PkgConfig::hwy> $<INSTALL_INTERFACE:froude::highway>)

# The same of OpenVDB and what its headers call.
set(FROUDE_OPENVDB_LIBRARIES $<BUILD_INTERFACE:OpenVDB::openvdb> $<INSTALL_INTERFACE:froude::openvdb_library> TBB::tbb)

# Gives every test of a build with sanitizers their settings, however ctest is called: a file that ctest reads first.
function(froude_sanitizer_environment)
  if(NOT FROUDE_SANITIZE)
    return()
  endif()
  set(settings ${PROJECT_BINARY_DIR}/sanitizer_environment.cmake)
  file(CONFIGURE OUTPUT ${settings} @ONLY CONTENT [[
set(ENV{TSAN_OPTIONS} "suppressions=@PROJECT_SOURCE_DIR@/cmake/tsan.supp:halt_on_error=1:second_deadlock_stack=1:$ENV{TSAN_OPTIONS}")
set(ENV{ASAN_OPTIONS} "detect_stack_use_after_return=1:strict_string_checks=1:$ENV{ASAN_OPTIONS}")
set(ENV{UBSAN_OPTIONS} "print_stacktrace=1:$ENV{UBSAN_OPTIONS}")
]])
  set_property(DIRECTORY ${PROJECT_SOURCE_DIR} APPEND PROPERTY TEST_INCLUDE_FILES ${settings})
endfunction()
