# A component is a library whose modules can be used only by those that name it: the module files of
# each component are in a folder of their own, and USES is not transitive, so a `use` that USES does
# not list fails to compile. tools/components.py finds entries that are not used.
#
#   add_component(coarse USES mesh)              every .f90 file of the calling folder
#   add_component(coarse THREADS USES mesh)      whose loops run on OMP_NUM_THREADS threads
#   add_component_samples(coarse sample_bodies USES coarse)   tests/sample_bodies.f90, for several tests
#   add_component_test(test_x USES coarse)       test_x.f90 of the component's tests/ folder, run by CTest
#   add_component_test(test_x OPTIMIZED USES ..) in the release build too, where optimization, threads or
#                                                speed can change what is tested
function(add_component name)
  cmake_parse_arguments(ARG "THREADS" "" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.f90)
  add_library(${name} STATIC ${sources})
  component_modules(${name} mod)
  target_link_libraries(${name} PRIVATE ${ARG_USES})
  component_compile_options(${name})
  if(ARG_THREADS)
    component_threads(${name})
  endif()
endfunction()

# Loops marked `!$omp parallel do` run on threads. Results must not depend on their number: each
# iteration writes its own values, and sums are taken outside. Without this the marks are comments.
function(component_threads name)
  target_compile_options(${name} PRIVATE ${OpenMP_Fortran_FLAGS})
  target_link_libraries(${name} PRIVATE OpenMP::OpenMP_Fortran)
endfunction()

# A library of small bodies, meshes or closed solutions that tests share: NAME_samples.
function(add_component_samples name)
  cmake_parse_arguments(ARG "" "" "USES" ${ARGN})
  list(TRANSFORM ARG_UNPARSED_ARGUMENTS REPLACE "(.+)" "tests/\\1.f90" OUTPUT_VARIABLE sources)
  add_library(${name}_samples STATIC ${sources})
  component_modules(${name}_samples mod_samples)
  target_link_libraries(${name}_samples PRIVATE ${ARG_USES})
  component_compile_options(${name}_samples)
endfunction()

function(add_component_test name)
  cmake_parse_arguments(ARG "OPTIMIZED" "" "USES" ${ARGN})
  if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT ARG_OPTIMIZED)
    return()
  endif()
  add_executable(${name} ${CMAKE_CURRENT_SOURCE_DIR}/tests/${name}.f90)
  set_target_properties(
    ${name} PROPERTIES Fortran_MODULE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/mod_tests/${name}
  )
  target_link_libraries(${name} PRIVATE ${ARG_USES})
  component_compile_options(${name})
  soon_built(${name})
  add_test(NAME ${name} COMMAND ${name})
endfunction()

include(CheckLinkerFlag)
# A test's own code is run once: it is not worth optimizing, which takes four times as long and
# changes nothing in what is tested. gold links in a third of the time, where it is there. Simulations
# in procedures that a test calls once are `save`: at the end of a procedure gfortran writes out the
# deallocation of each component, which takes half a second per simulation to compile.
check_linker_flag(CXX -fuse-ld=gold WINGCRACK_HAS_GOLD)
function(soon_built name)
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O0>)
  if(WINGCRACK_HAS_GOLD)
    target_link_options(${name} PRIVATE -fuse-ld=gold)
  endif()
endfunction()

function(component_modules name folder)
  set(mod_dir ${CMAKE_CURRENT_BINARY_DIR}/${folder})
  set_target_properties(${name} PROPERTIES Fortran_MODULE_DIRECTORY ${mod_dir})
  target_include_directories(${name} PUBLIC ${mod_dir})
endfunction()

# The debug build checks C and C++ as -fcheck=all does Fortran.
check_linker_flag(CXX -fsanitize=undefined WINGCRACK_HAS_SANITIZER)
if(WINGCRACK_HAS_SANITIZER)
  add_compile_options(
    "$<$<AND:$<CONFIG:Debug>,$<COMPILE_LANGUAGE:C,CXX>>:-fsanitize=undefined;-fno-sanitize-recover=all;-D_GLIBCXX_ASSERTIONS>"
  )
  add_link_options($<$<CONFIG:Debug>:-fsanitize=undefined>)
endif()

# -frecursive: procedures may run on several threads at once, so that no local array is static,
# whatever its size. The check of recursion that -fcheck=all contains would take two threads in one
# procedure for a recursion; -frecursive switches it off.
# gfortran 12 takes the descriptors of allocatable arrays (their `offset` and `dim` before the first
# allocation) for uninitialized, in procedures without that check and where it optimizes: hence
# neither -Wuninitialized nor -Wmaybe-uninitialized. The debug build has signalling NaNs instead.
function(component_compile_options name)
  target_compile_options(
    ${name}
    PRIVATE
      -Wall
      -Wextra
      $<$<BOOL:${WINGCRACK_WARNINGS_ARE_ERRORS}>:-Werror>
      $<$<CONFIG:Debug>:-g1>
      $<$<COMPILE_LANG_AND_ID:Fortran,GNU>:-std=f2018
      -Wimplicit-interface
      -fimplicit-none
      $<$<CONFIG:Release>:-O3>
      -frecursive
      $<$<CONFIG:Release>:${WINGCRACK_PROCESSOR}>
      -Wno-uninitialized
      -Wno-maybe-uninitialized
      $<$<CONFIG:Debug>:-fcheck=all,no-array-temps
      -fbacktrace
      -finit-real=snan>>
  )
endfunction()
