!> Ranks: the processes of MPI among which MUMPS may share a matrix. A program is linked for one
!! process (`alone`), which is the rule and knows nothing of MPI, or for ranks (`ranks`); of these
!! the first runs the program, and the others take part in what MUMPS does with shared matrices.
module algebra_ranks
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none(type, external)
   private

   public :: announce, are_shared, begin_ranks, communicator_of, new_share

   interface
      !> To be called once, before anything is solved. Only the first rank comes back; the others
      !! end with it.
      subroutine begin_ranks() bind(c, name="algebra_begin_ranks")
         implicit none(type, external)
      end subroutine begin_ranks

      !> Whether the ranks would share a matrix of so many unknowns: 1, or 0.
      pure integer(c_int) function are_shared(n) bind(c, name="algebra_are_shared")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: n  !< number of unknowns
      end function are_shared

      !> A number for a new matrix if the ranks are to share it, or 0.
      integer(c_int) function new_share(n) bind(c, name="algebra_new_share")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: n  !< number of unknowns
      end function new_share

      !> The communicator that MUMPS is to use for a matrix.
      integer(c_int) function communicator_of(share) bind(c, name="algebra_communicator")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: share  !< number of the matrix, or 0
      end function communicator_of

      !> Tell the other ranks what MUMPS will be called for next; nothing of what is not shared.
      subroutine announce(share, kind, job) bind(c, name="algebra_announce")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: share  !< number of the matrix, or 0
         integer(c_int), value :: kind  !< SYM of MUMPS
         integer(c_int), value :: job  !< JOB of MUMPS
      end subroutine announce
   end interface

end module algebra_ranks
