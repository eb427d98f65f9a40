# CAMD, the orderings of SuiteSparse with constraints, as libsuitesparse-dev brings it. Target:
# Camd::camd. The program declares what it calls, so no header is needed.
include(FindPackageHandleStandardArgs)

find_library(Camd_LIBRARY NAMES camd)
find_library(SuiteSparseConfig_LIBRARY NAMES suitesparseconfig)
find_package_handle_standard_args(Camd REQUIRED_VARS Camd_LIBRARY SuiteSparseConfig_LIBRARY)

if(Camd_FOUND AND NOT TARGET Camd::camd)
  add_library(Camd::camd INTERFACE IMPORTED)
  target_link_libraries(Camd::camd INTERFACE ${Camd_LIBRARY} ${SuiteSparseConfig_LIBRARY})
endif()
