# gmsh from the Python wheel (its own CMake configuration is broken). Set Gmsh_ROOT to the virtual
# environment that holds it, which the launcher does. Target: Gmsh::gmsh.
include(FindPackageHandleStandardArgs)

find_path(Gmsh_INCLUDE_DIR gmsh.h)
file(GLOB Gmsh_VERSIONED ${Gmsh_ROOT}/lib/libgmsh.so.*)
list(SORT Gmsh_VERSIONED)
if(Gmsh_VERSIONED)
  list(GET Gmsh_VERSIONED 0 Gmsh_WHEEL_LIBRARY)
  set(Gmsh_LIBRARY ${Gmsh_WHEEL_LIBRARY} CACHE FILEPATH "gmsh library")
endif()
find_library(Gmsh_LIBRARY NAMES gmsh)
find_package_handle_standard_args(Gmsh REQUIRED_VARS Gmsh_LIBRARY Gmsh_INCLUDE_DIR)

if(Gmsh_FOUND AND NOT TARGET Gmsh::gmsh)
  add_library(Gmsh::gmsh UNKNOWN IMPORTED)
  set_target_properties(
    Gmsh::gmsh
    PROPERTIES
      IMPORTED_LOCATION ${Gmsh_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${Gmsh_INCLUDE_DIR}
  )
endif()
