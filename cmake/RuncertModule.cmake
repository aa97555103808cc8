# What every target of the project has in common.
add_library(runcert_options INTERFACE)
target_compile_options(runcert_options INTERFACE
  -Wall -Wextra -Wconversion -Wshadow
  # The same binary must give the same bytes on every machine: no fused multiply-add.
  -ffp-contract=off
  -ffile-prefix-map=${CMAKE_SOURCE_DIR}/=)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Sources compiled together are included, so that GCC takes them for headers.
  target_compile_options(runcert_options INTERFACE -Wno-subobject-linkage)
endif()
if(RUNCERT_SANITIZE)
  # GCC 12 takes std::regex for uninitialised when it instruments it (GCC bug 105562).
  target_compile_options(runcert_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(runcert_options INTERFACE -fsanitize=address,undefined)
endif()
if(RUNCERT_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    message(FATAL_ERROR "RUNCERT_FUZZ needs clang: cmake --preset fuzz")
  endif()
  target_compile_options(runcert_options INTERFACE
    -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_compile_definitions(runcert_options INTERFACE _GLIBCXX_ASSERTIONS)
  target_link_options(runcert_options INTERFACE -fsanitize=address,undefined)
endif()

# runcert_module(NAME core SOURCES a.cpp DEPENDS core PUBLIC Eigen3::Eigen PRIVATE fmt::fmt)
#
# A static library `runcert_NAME` of the sources in the calling folder. Its headers are included
# as "NAME/header.h", and only by targets that depend on it: each module has an include folder
# of its own that holds nothing but a link to it, so an include that the dependency list does
# not allow does not compile.
function(runcert_module)
  cmake_parse_arguments(M "" "NAME" "SOURCES;DEPENDS;PUBLIC;PRIVATE" ${ARGN})
  string(REPLACE "/" "_" target runcert_${M_NAME})
  set(include_dir ${CMAKE_BINARY_DIR}/include/${target})
  get_filename_component(parent ${include_dir}/${M_NAME} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include_dir}/${M_NAME} SYMBOLIC)
  add_library(${target} STATIC ${M_SOURCES})
  target_include_directories(${target} PUBLIC ${include_dir})
  list(TRANSFORM M_DEPENDS PREPEND runcert_)
  list(TRANSFORM M_DEPENDS REPLACE "/" "_")
  target_link_libraries(${target} PUBLIC ${M_DEPENDS} ${M_PUBLIC} PRIVATE runcert_options ${M_PRIVATE})
endfunction()

# runcert_embed(OUT_VAR NAMESPACE_FUNCTION file...)
#
# Generates a source that defines `std::string_view FUNCTION(std::string_view file_name)`: the
# text of the file of that name, empty where there is none; and `std::vector<std::string_view>
# FUNCTION_names()`: those that there are, in the order given.
function(runcert_embed out_var function)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  set(names)
  set(code "#include <string_view>\n#include <vector>\nnamespace runcert {\nstd::string_view ${function}(std::string_view name);\nstd::string_view ${function}(std::string_view name) {\n")
  foreach(file ${ARGN})
    get_filename_component(path ${file} ABSOLUTE)
    file(READ ${path} text)
    file(RELATIVE_PATH relative ${CMAKE_CURRENT_SOURCE_DIR} ${path})
    get_filename_component(base ${path} NAME)
    if(relative MATCHES "^\\.\\.")
      set(relative ${base})
    endif()
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${path})
    list(APPEND names "\"${relative}\"")
    string(APPEND code "    if (name == \"${relative}\")\n        return R\"runcert(${text})runcert\";\n")
  endforeach()
  list(JOIN names ", " names)
  string(APPEND code "    return {};\n}\nstd::vector<std::string_view> ${function}_names();\nstd::vector<std::string_view> ${function}_names() {\n    return {${names}};\n}\n}  // namespace runcert\n")
  file(CONFIGURE OUTPUT ${source} CONTENT "${code}" @ONLY)
  set(${out_var} ${source} PARENT_SCOPE)
endfunction()

# runcert_embed_yaml(OUT_VAR FUNCTION file)
#
# Generates a source that defines `YamlNode FUNCTION()`: the root of the YAML document in the file,
# parsed by the build, so that no program parses it whenever it starts.
function(runcert_embed_yaml out_var function file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${function}.cpp)
  get_filename_component(path ${file} ABSOLUTE)
  add_custom_command(OUTPUT ${source}
    COMMAND runcert_embed_yaml ${path} ${function} ${source}
    DEPENDS runcert_embed_yaml ${path} VERBATIM)
  set(${out_var} ${source} PARENT_SCOPE)
endfunction()

# runcert_estimates()
#
# The targets of the calling folder are optimised fully.
macro(runcert_estimates)
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    add_compile_options(-O3)
  endif()
endmacro()

# runcert_end_of_inner_ring(folder)
#
# Every target of the folder and of those below must link targets that are there by now alone: the
# outer ring, which is added afterwards, is out of its reach.
function(runcert_end_of_inner_ring folder)
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${subfolders})
    runcert_end_of_inner_ring(${subfolder})
  endforeach()
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(links ${target} LINK_LIBRARIES)
    foreach(link ${links})
      if(link MATCHES "^runcert_" AND NOT TARGET ${link})
        message(FATAL_ERROR "${target}, of the inner ring, links ${link}, which is of the outer one or nowhere")
      endif()
    endforeach()
  endforeach()
endfunction()

# runcert_precompile(folder)
#
# Compiles what most sources include of other projects once for each set of options that targets of
# the folder and of those below have. A source still includes all that it uses: the presets for
# sanitizers and clang build without.
function(runcert_precompile folder)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS)
    return()
  endif()
  get_property(subfolders DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  foreach(subfolder ${subfolders})
    runcert_precompile(${subfolder})
  endforeach()
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target ${targets})
    get_target_property(type ${target} TYPE)
    get_target_property(options ${target} COMPILE_OPTIONS)
    if(NOT options)
      set(options)
    endif()
    list(REMOVE_DUPLICATES options)
    get_target_property(links ${target} LINK_LIBRARIES)
    if(NOT type MATCHES "EXECUTABLE|STATIC_LIBRARY" OR NOT "fmt::fmt" IN_LIST links)
      continue()
    endif()
    set(framework)
    set(framework_header)
    if("GTest::gtest" IN_LIST links)
      set(framework GTest::gtest)
      set(framework_header <gtest/gtest.h> <fstream> <regex> <sstream>)
    endif()
    string(MAKE_C_IDENTIFIER "runcert_precompiled${options}${framework}" owner)
    if(NOT TARGET ${owner})
      file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/precompiled.cpp CONTENT "")
      add_library(${owner} OBJECT ${CMAKE_BINARY_DIR}/precompiled.cpp)
      set_target_properties(${owner} PROPERTIES COMPILE_OPTIONS "${options}")
      target_link_libraries(${owner} PRIVATE runcert_options fmt::fmt Eigen3::Eigen Threads::Threads
        ${framework})
      target_precompile_headers(${owner} PRIVATE <algorithm> <array> <cmath> <cstdint> <filesystem>
        <functional> <map> <optional> <set> <span> <string> <vector> <Eigen/Core> <fmt/format.h> <nlohmann/json.hpp>
        ${framework_header})
    endif()
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endforeach()
endfunction()
