!> What all ranks but the first one do: take part in MUMPS' work on the matrices that are shared.
!! The first one has the matrices, right-hand sides and settings; these have nothing but their part
!! of the factors.
module algebra_parts
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none(type, external)
   private

   public :: serve

   include "dmumps_struc.h"

   interface
      subroutine dmumps(id)
         import :: dmumps_struc
         implicit none(type, external)
         type(dmumps_struc), intent(inout) :: id
      end subroutine dmumps

      integer(c_int) function communicator_of(share) bind(c, name="algebra_communicator")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: share
      end function communicator_of

      !> What the first rank announces next; 0 once there is no more.
      integer(c_int) function await(share, kind, job) bind(c, name="algebra_await")
         import :: c_int
         implicit none(type, external)
         integer(c_int), intent(out) :: share, kind, job
      end function await
   end interface

   !> This rank's part of a matrix.
   type :: part_t
      integer(c_int) :: share = 0  !< the matrix' number; 0: the place is free
      type(dmumps_struc), pointer :: id => null()
   end type part_t

   integer(c_int), parameter :: job_begin = -1, job_end = -2  ! of MUMPS

contains

   !> Take part until the first rank ends.
   subroutine serve() bind(c, name="algebra_serve")
      type(part_t), allocatable :: parts(:)
      integer(c_int) :: job, kind, share
      integer :: at

      allocate (parts(0))
      do while (await(share, kind, job) /= 0)
         if (job == job_begin) call begin_part(parts, share, kind)
         at = findloc(parts%share, share, dim=1)
         if (at == 0) cycle
         associate (part => parts(at))
            part%id%job = job
            call dmumps(part%id)
            if (job == job_begin) then
               part%id%icntl(1:3) = -1  ! no printing
               part%id%icntl(4) = 0
            else if (job == job_end) then
               deallocate (part%id)
               part%share = 0
            end if
         end associate
      end do
   end subroutine serve

   !> A place for the part of a new matrix.
   subroutine begin_part(parts, share, kind)
      type(part_t), allocatable, intent(inout) :: parts(:)
      integer(c_int), intent(in) :: share
      integer(c_int), intent(in) :: kind  !< SYM of MUMPS
      integer :: at

      at = findloc(parts%share, 0_c_int, dim=1)
      if (at == 0) then
         parts = [parts, part_t()]
         at = size(parts)
      end if
      associate (part => parts(at))
         part%share = share
         allocate (part%id)
         part%id%comm = communicator_of(share)
         part%id%par = 1
         part%id%sym = kind
      end associate
   end subroutine begin_part

end module algebra_parts
