# MUMPS without MPI, as Debian's libmumps-seq-5.5 and libmumps-headers-dev bring it (no -dev package,
# which would pull in OpenMPI). Target: Mumps::seq.
include(FindPackageHandleStandardArgs)

find_path(Mumps_INCLUDE_DIR dmumps_struc.h)
find_path(Mumps_MPI_INCLUDE_DIR mpif.h PATH_SUFFIXES mumps_seq)
find_library(Mumps_LIBRARY NAMES dmumps_seq libdmumps_seq-5.5.so libdmumps_seq-5.6.so)
find_library(Mumps_MPI_LIBRARY NAMES mpiseq_seq libmpiseq_seq-5.5.so libmpiseq_seq-5.6.so)
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
