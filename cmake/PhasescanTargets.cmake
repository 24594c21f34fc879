# Compile settings that every target of the project shares.

# phasescan_configure(<target>): C++20, warnings, sanitizers. No fast-math anywhere: the same input gives the same bytes.
function(phasescan_configure target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # gcc 12 sees overlapping copies in "literal" + std::string at -O2 and above (GCC bug 105651).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)")
    # The kernels keep vectors in structs, which vectors of no fixed size cannot be in: NEON, which every arm64 has.
    target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")
  endif()
  if(PHASESCAN_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(PHASESCAN_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${PHASESCAN_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${PHASESCAN_SANITIZE})
  endif()
endfunction()

# phasescan_compile_together(<target>): eight files at once where PHASESCAN_COMPILE_TOGETHER is on. From nothing that takes
# less than half the time; a changed file then costs its batch, about 10 s.
function(phasescan_compile_together target)
  if(NOT PHASESCAN_COMPILE_TOGETHER)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # gcc takes a type of a .cpp's own for one of a header there.
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# phasescan_internal(<target>): sees the headers in src/ that are not installed; for what is built with the libraries.
function(phasescan_internal target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/src)
endfunction()

# phasescan_library(<name> <folder>...): one library from the given folders of src/. Static where it is not installed.
function(phasescan_library name)
  set(sources)
  foreach(folder IN LISTS ARGN)
    file(GLOB found CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/${folder}/*.cpp")
    list(APPEND sources ${found})
  endforeach()
  set(kind STATIC)
  if(BUILD_SHARED_LIBS AND name MATCHES "^phasescan_(.+)$" AND CMAKE_MATCH_1 IN_LIST PHASESCAN_ALL_COMPONENTS)
    set(kind SHARED)
  endif()
  add_library(${name} ${kind} ${sources})
  phasescan_configure(${name})
  target_include_directories(${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  phasescan_internal(${name})
endfunction()

# phasescan_component(<component> <folder>...): a library that is installed, as phasescan::<component>.
function(phasescan_component component)
  phasescan_library(phasescan_${component} ${ARGN})
  add_library(phasescan::${component} ALIAS phasescan_${component})
  set_target_properties(phasescan_${component} PROPERTIES EXPORT_NAME ${component}
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR})
  target_link_libraries(phasescan INTERFACE phasescan_${component})
endfunction()
