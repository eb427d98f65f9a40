# MUMPS without MPI, as Debian's libmumps-seq-5.x and libmumps-headers-dev bring it (no -dev package,
# which would pull in OpenMPI). Target: Mumps::seq.
include(FindPackageHandleStandardArgs)

# Without a -dev package there is no plain libdmumps_seq.so: the names carry the version.
foreach(minor RANGE 9 4 -1)
  list(APPEND Mumps_versioned libdmumps_seq-5.${minor}.so)
  list(APPEND Mumps_MPI_versioned libmpiseq_seq-5.${minor}.so)
endforeach()

find_path(Mumps_INCLUDE_DIR dmumps_struc.h)
find_path(Mumps_MPI_INCLUDE_DIR mpif.h PATH_SUFFIXES mumps_seq)
find_library(Mumps_LIBRARY NAMES dmumps_seq ${Mumps_versioned})
find_library(Mumps_MPI_LIBRARY NAMES mpiseq_seq ${Mumps_MPI_versioned})
find_library(Metis_LIBRARY NAMES metis)
find_package_handle_standard_args(
  Mumps
  REQUIRED_VARS
    Mumps_LIBRARY
    Mumps_MPI_LIBRARY
    Mumps_INCLUDE_DIR
    Mumps_MPI_INCLUDE_DIR
    Metis_LIBRARY
)

if(Mumps_FOUND AND NOT TARGET Mumps::seq)
  add_library(Mumps::seq INTERFACE IMPORTED)
  target_include_directories(
    Mumps::seq INTERFACE ${Mumps_INCLUDE_DIR} ${Mumps_MPI_INCLUDE_DIR}
  )
  target_link_libraries(
    Mumps::seq INTERFACE ${Mumps_LIBRARY} ${Mumps_MPI_LIBRARY} ${Metis_LIBRARY}
  )
endif()
