!> Sparse systems by MUMPS: analysed once per pattern, factorized once per set of values,
!! solved many times; on request condensed onto a few unknowns (Schur complement).
!!
!! Settings follow measurements on systems of this kind (docs/solvers.md): approximate minimum
!! degree unless the caller gives an order (algebra_ordering), 40 % spare workspace. MUMPS reports
!! an exactly singular matrix only with null-pivot detection, which is therefore on.
!!
!! Ranks: the processes of MPI among which MUMPS may share a matrix. A program is linked for one
!! process (`alone`), which is the rule and knows nothing of MPI, or for ranks (`ranks`); of these
!! the first runs the program, and the others take part in what MUMPS does with shared matrices.
module algebra_mumps
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: int64
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: are_shared, begin_ranks, mumps_definite, mumps_indefinite, mumps_minimum_fill
   public :: mumps_pord, mumps_t, mumps_unsymmetric

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

   include "dmumps_struc.h"

   integer(ik), parameter :: mumps_unsymmetric = 0  !< any matrix (SYM=0)
   integer(ik), parameter :: mumps_definite = 1  !< symmetric positive definite (SYM=1)
   integer(ik), parameter :: mumps_indefinite = 2  !< general symmetric (SYM=2)

   integer(ik), parameter :: mumps_minimum_degree = 0  !< approximate minimum degree
   integer(ik), parameter :: mumps_minimum_fill = 2  !< approximate minimum fill
   integer(ik), parameter :: mumps_pord = 4  !< a mixture of both kinds of bisection; repeatable

   ! JOB
   integer(ik), parameter :: job_begin = -1, job_analyse = 1, job_factorize = 2, job_solve = 3, &
                             job_end = -2

   interface
      subroutine dmumps(id)
         import :: dmumps_struc
         implicit none(type, external)
         type(dmumps_struc), intent(inout) :: id
      end subroutine dmumps
   end interface

   !> One matrix with its factors. Not to be copied: the factors belong to the original.
   type :: mumps_t
      type(dmumps_struc) :: id
      integer(ik) :: ordering = mumps_minimum_degree  !< of the next analysis
      logical :: active = .false.
      integer(ik) :: share = 0  !< its number among those that ranks share; 0: it is not shared
      integer(ik) :: n_schur = 0
   contains
      procedure :: analyse
      procedure :: factorize
      procedure, private :: solve_all
      procedure, private :: solve_one
      generic :: solve => solve_all, solve_one
      procedure :: get_entries
      procedure :: get_schur
      procedure :: condense
      procedure :: expand
      procedure :: release
      final :: finalize
   end type mumps_t

contains

   !> Order the unknowns and find the pattern of the factors.
   !!
   !! One triangle of the matrix as triplets, or all of one that is not symmetric; entries given
   !! twice are added.
   subroutine analyse(self, n, row, col, kind, error, schur, place)
      class(mumps_t), intent(inout) :: self
      integer(ik), intent(in) :: n  !< number of unknowns
      integer(ik), intent(in) :: row(:), col(:)  !< (n_entries) from 1
      integer(ik), intent(in) :: kind  !< mumps_definite, _indefinite or _unsymmetric
      type(error_t), allocatable, intent(out) :: error
      integer(ik), intent(in), optional :: schur(:)  !< unknowns to condense onto, in this order
      !> (n) place of each unknown in a given order, the unknowns to condense onto last; absent: as
      !! `ordering` says
      integer(ik), intent(in), optional :: place(:)

      call self%release()
      self%share = new_share(n)
      self%id%comm = communicator_of(self%share)
      self%id%par = 1
      self%id%sym = kind
      call perform(self, job_begin)
      self%active = .true.
      self%id%icntl(1:3) = -1  ! no printing
      self%id%icntl(4) = 0
      ! No permutation by values: they are not known yet when the order is chosen.
      self%id%icntl(6) = 0
      self%id%icntl(7) = self%ordering
      if (present(place)) then
         self%id%icntl(7) = 1
         allocate (self%id%perm_in(n))
         self%id%perm_in = place
      end if
      if (kind /= mumps_definite) self%id%icntl(8) = 0  ! callers scale: MUMPS takes an eighth
      self%id%icntl(14) = 40
      self%id%icntl(24) = 1
      self%id%n = n
      self%id%nnz = size(row)
      allocate (self%id%irn(size(row)), self%id%jcn(size(col)), self%id%a(size(row)))
      self%id%irn = row
      self%id%jcn = col
      self%n_schur = 0
      if (present(schur)) then
         self%n_schur = size(schur)
         if (self%n_schur > 0) then
            self%id%icntl(19) = 1
            self%id%icntl(24) = 0  ! not available together with a Schur complement
            self%id%size_schur = self%n_schur
            allocate (self%id%listvar_schur(self%n_schur))
            self%id%listvar_schur = schur
            allocate (self%id%redrhs(self%n_schur))
         end if
      end if
      call perform(self, job_analyse)
      if (associated(self%id%perm_in)) deallocate (self%id%perm_in)
      call check_status(self, "analysis", error)
   end subroutine analyse

   !> Factorize for new values, in the order of the triplets.
   subroutine factorize(self, values, error, schur)
      class(mumps_t), intent(inout) :: self
      real(rk), intent(in) :: values(:)
      type(error_t), allocatable, intent(out) :: error
      !> (n_schur, n_schur) the Schur complement, full and symmetric. Where this is not given it is
      !! kept until `get_schur`.
      real(rk), intent(inout), contiguous, target, optional :: schur(:, :)
      integer :: attempt

      if (.not. self%active .or. size(values) /= size(self%id%a)) then
         call raise_error(error, "mumps_t%factorize", &
                          "the matrix has not been analysed for these entries")
         return
      end if
      if (.not. sum(abs(values)) <= huge(1.0_rk)) then
         call raise_error(error, "mumps_t%factorize", &
                          "the matrix has an entry that is not a finite number")
         return
      end if
      if (self%n_schur > 0) then
         if (present(schur)) then
            if (associated(self%id%schur)) deallocate (self%id%schur)
            self%id%schur(1:size(schur, kind=int64)) => schur
         else if (.not. associated(self%id%schur)) then
            allocate (self%id%schur(int(self%n_schur, int64)**2))
         end if
      end if
      do attempt = 1, 3
         self%id%a = values
         call perform(self, job_factorize)
         if (self%id%infog(1) /= -9) exit
         self%id%icntl(14) = 2*self%id%icntl(14)  ! more delayed pivots than foreseen
      end do
      if (present(schur)) nullify (self%id%schur)
      call check_status(self, "factorization", error)
      if (allocated(error)) return
      if (present(schur)) call complete_lower(schur)
      if (self%id%infog(28) > 0) then
         call raise_error(error, "mumps_t%factorize", "the matrix is singular")
      end if
   end subroutine factorize

   !> Solve for one or more right-hand sides, which are overwritten by the solutions.
   subroutine solve_all(self, x, error, transposed)
      class(mumps_t), intent(inout) :: self
      real(rk), intent(inout), contiguous, target :: x(:, :)  !< (n, n_rhs)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: transposed  !< with the transpose of the matrix

      self%id%nrhs = size(x, 2)
      self%id%lrhs = size(x, 1)
      self%id%rhs(1:size(x)) => x
      self%id%icntl(26) = 0
      self%id%icntl(9) = 1
      if (present(transposed)) self%id%icntl(9) = merge(0, 1, transposed)
      call perform(self, job_solve)
      nullify (self%id%rhs)
      call check_status(self, "solution", error)
   end subroutine solve_all

   !> The same for one right-hand side.
   subroutine solve_one(self, x, error, transposed)
      class(mumps_t), intent(inout) :: self
      real(rk), intent(inout), contiguous, target :: x(:)  !< (n)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: transposed
      real(rk), pointer :: column(:, :)

      column(1:size(x), 1:1) => x
      call self%solve_all(column, error, transposed)
   end subroutine solve_one

   !> The entries of the matrix, as set by `factorize`.
   subroutine get_entries(self, row, col, values)
      class(mumps_t), intent(in) :: self
      integer(ik), allocatable, intent(out) :: row(:), col(:)
      real(rk), allocatable, intent(out) :: values(:)

      row = self%id%irn
      col = self%id%jcn
      values = self%id%a
   end subroutine get_entries

   !> The Schur complement, full and symmetric. It is handed over, not kept: once per factorization.
   subroutine get_schur(self, schur)
      class(mumps_t), intent(inout) :: self
      real(rk), intent(out) :: schur(:, :)  !< (n_schur, n_schur)
      integer(int64) :: j, n

      n = self%n_schur
      do j = 1, n
         schur(:j, j) = self%id%schur((j - 1)*n + 1:(j - 1)*n + j)
      end do
      deallocate (self%id%schur)
      call complete_lower(schur)
   end subroutine get_schur

   !> Forward elimination: the right-hand side of the condensed system. MUMPS keeps the rest of the
   !! result until `expand`; `rhs` may be changed.
   subroutine condense(self, rhs, reduced, error)
      class(mumps_t), intent(inout) :: self
      !> (n) entries of the condensed unknowns included
      real(rk), intent(inout), contiguous, target :: rhs(:)
      real(rk), intent(out) :: reduced(:)  !< (n_schur)
      type(error_t), allocatable, intent(out) :: error

      self%id%nrhs = 1
      self%id%lrhs = size(rhs)
      self%id%lredrhs = self%n_schur
      self%id%rhs => rhs
      self%id%icntl(26) = 1
      call perform(self, job_solve)
      nullify (self%id%rhs)
      call check_status(self, "condensation", error)
      reduced = self%id%redrhs
   end subroutine condense

   !> Back substitution after `condense`: all unknowns from the condensed ones.
   subroutine expand(self, condensed, x, error)
      class(mumps_t), intent(inout) :: self
      real(rk), intent(in) :: condensed(:)  !< (n_schur)
      real(rk), intent(out), contiguous, target :: x(:)  !< (n)
      type(error_t), allocatable, intent(out) :: error

      self%id%redrhs = condensed
      self%id%rhs => x
      self%id%icntl(26) = 2
      call perform(self, job_solve)
      nullify (self%id%rhs)
      call check_status(self, "expansion", error)
   end subroutine expand

   !> Release all memory.
   subroutine release(self)
      class(mumps_t), intent(inout) :: self

      if (.not. self%active) return
      if (associated(self%id%irn)) deallocate (self%id%irn, self%id%jcn, self%id%a)
      if (associated(self%id%listvar_schur)) then
         deallocate (self%id%listvar_schur, self%id%redrhs)
         if (associated(self%id%schur)) deallocate (self%id%schur)
      end if
      call perform(self, job_end)
      self%active = .false.
      self%n_schur = 0
   end subroutine release

   subroutine finalize(self)
      type(mumps_t), intent(inout) :: self

      call self%release()
   end subroutine finalize

   !> Call MUMPS, with the other ranks if the matrix is shared.
   subroutine perform(self, job)
      class(mumps_t), intent(inout) :: self
      integer(ik), intent(in) :: job

      call announce(self%share, self%id%sym, job)
      self%id%job = job
      call dmumps(self%id)
   end subroutine perform

   !> MUMPS gives the lower triangle of a Schur complement by rows, that is, the upper one by
   !! columns.
   pure subroutine complete_lower(schur)
      real(rk), intent(inout) :: schur(:, :)
      integer(ik) :: i, j

      do j = 2, size(schur, 2, kind=ik)
         do i = 1, j - 1
            schur(j, i) = schur(i, j)
         end do
      end do
   end subroutine complete_lower

   subroutine check_status(self, phase, error)
      class(mumps_t), intent(in) :: self
      character(len=*), intent(in) :: phase
      type(error_t), allocatable, intent(out) :: error
      character(len=120) :: text

      if (self%id%infog(1) >= 0) return
      select case (self%id%infog(1))
      case (-10)
         call raise_error(error, "mumps_t", "the matrix is singular (found in the "//phase//")")
      case (-13, -9)
         call raise_error(error, "mumps_t", "not enough memory for the "//phase//" of the matrix")
      case default
         write (text, "(a,i0,a,i0,a)") " failed (INFOG(1)=", self%id%infog(1), ", INFOG(2)=", &
            self%id%infog(2), ")"
         call raise_error(error, "mumps_t", phase//trim(text))
      end select
   end subroutine check_status

end module algebra_mumps
