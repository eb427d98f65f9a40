# MUMPS without MPI, as Debian's libmumps-seq-5.x and libmumps-headers-dev bring it (no -dev package,
# which would pull in OpenMPI). Target: Mumps::seq. Where Debian's libmumps-5.x, libopenmpi-dev and
# openmpi-bin are there too, Mumps::mpi: the same for ranks.
include(FindPackageHandleStandardArgs)

# Without a -dev package there is no plain libdmumps_seq.so: the names carry the version.
foreach(minor RANGE 9 4 -1)
  list(APPEND Mumps_versioned libdmumps_seq-5.${minor}.so)
  list(APPEND Mumps_stub_versioned libmpiseq_seq-5.${minor}.so)
  list(APPEND Mumps_mpi_versioned libdmumps-5.${minor}.so)
endforeach()

find_path(Mumps_INCLUDE_DIR dmumps_struc.h)
find_library(Mumps_LIBRARY NAMES dmumps_seq ${Mumps_versioned})
find_library(Mumps_STUB_LIBRARY NAMES mpiseq_seq ${Mumps_stub_versioned})
find_library(Metis_LIBRARY NAMES metis)
find_package_handle_standard_args(
  Mumps REQUIRED_VARS Mumps_LIBRARY Mumps_STUB_LIBRARY Mumps_INCLUDE_DIR Metis_LIBRARY
)

function(add_mumps name)
  add_library(Mumps::${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(Mumps::${name} INTERFACE ${Mumps_INCLUDE_DIR})
  target_link_libraries(Mumps::${name} INTERFACE ${ARGN} ${Metis_LIBRARY})
endfunction()

if(Mumps_FOUND AND NOT TARGET Mumps::seq)
  add_mumps(seq ${Mumps_LIBRARY} ${Mumps_STUB_LIBRARY})
endif()

find_library(Mumps_RANKS_LIBRARY NAMES ${Mumps_mpi_versioned})
if(Mumps_FOUND AND Mumps_RANKS_LIBRARY AND NOT TARGET Mumps::mpi)
  # The one that Debian's MUMPS is made for, whatever other MPI there is.
  set(MPI_EXECUTABLE_SUFFIX .openmpi)
  find_package(MPI QUIET COMPONENTS C)
  if(MPI_C_FOUND)
    add_mumps(mpi ${Mumps_RANKS_LIBRARY})
  endif()
endif()
