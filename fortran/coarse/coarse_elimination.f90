!> What happens around one vertex, whether stress or flow: its own unknowns (tractions, fluxes) are
!! eliminated, and leave a share of the global matrix and their responses to the global unknowns.
!!
!! The system of a vertex is M y = R d + b, with unknowns y and the global ones d around it; C' y
!! enters the balances of d. `eliminate` finds y = response (d, 1) and -C' response. M is symmetric,
!! though not definite: rows are exchanged for the largest pivots.
!!
!! There are as many of these systems as vertices, each of some ten unknowns: too few for LAPACK,
!! whose calls cost more than its arithmetic there. All arrays hold an equation per column, so that
!! a row operation runs along memory, and a system is used for one vertex after another.
module coarse_elimination
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: eliminate, fix_unknown, local_system_t, new_local_system, response_t, share_t

   !> The system of one vertex. Its units are those of its rows and unknowns, see coarse_stress and
   !! coarse_diffusion. The arrays may be larger than the system.
   type :: local_system_t
      integer(ik) :: n = 0  !< unknowns to be eliminated
      integer(ik) :: m = 0  !< global unknowns around the vertex
      real(rk), allocatable :: matrix(:, :)  !< M (n, n)
      real(rk), allocatable :: coupling(:, :)  !< C' (m, n)
      real(rk), allocatable :: rhs(:, :)  !< (R, b)' (m + 1, n)
   end type local_system_t

   !> The eliminated unknowns, a column (m + 1) for each, per unit of each global one around the
   !! vertex; the last row holds what the boundary data alone give.
   type :: response_t
      real(rk), allocatable :: matrix(:, :)
   contains
      procedure :: apply
   end type response_t

   !> What a vertex adds to the global system.
   type :: share_t
      real(rk), allocatable :: matrix(:, :)  !< (m, m) symmetric
      real(rk), allocatable :: known(:)  !< (m) right-hand side, from boundary data
   end type share_t

contains

   !> An empty system, in the place of another one.
   pure subroutine new_local_system(n, m, local)
      integer(ik), intent(in) :: n  !< unknowns to be eliminated
      integer(ik), intent(in) :: m  !< global unknowns around the vertex
      type(local_system_t), intent(inout) :: local
      integer(ik) :: room(2)

      room = 0
      if (allocated(local%matrix)) room = [size(local%matrix, 1), size(local%coupling, 1)]
      if (any(room < [n, m])) then
         if (allocated(local%matrix)) deallocate (local%matrix, local%coupling, local%rhs)
         room = max(room, [n, m])
         allocate (local%matrix(room(1), room(1)), local%coupling(room(2), room(1)), &
                   local%rhs(room(2) + 1, room(1)))
      end if
      local%n = n
      local%m = m
      local%matrix(:n, :n) = 0.0_rk
      local%coupling(:m, :n) = 0.0_rk
      local%rhs(:m + 1, :n) = 0.0_rk
   end subroutine new_local_system

   !> Replace the equation of an unknown by: unknown = value.
   pure subroutine fix_unknown(local, i, value)
      type(local_system_t), intent(inout) :: local
      integer(ik), intent(in) :: i  !< the unknown
      real(rk), intent(in) :: value  !< [unit of the unknown]

      associate (n => local%n, last => local%m + 1)
         local%rhs(last, :n) = local%rhs(last, :n) - local%matrix(:n, i)*value
         local%matrix(:n, i) = 0.0_rk
         local%matrix(i, :n) = 0.0_rk
         local%matrix(i, i) = 1.0_rk
         local%rhs(:last, i) = 0.0_rk
         local%rhs(last, i) = value
      end associate
   end subroutine fix_unknown

   !> Solve the system, which is used up. `info` is 0, or it could not be solved (degenerate cells).
   pure subroutine eliminate(local, response, share, info)
      type(local_system_t), intent(inout) :: local
      type(response_t), intent(out) :: response
      type(share_t), intent(out) :: share
      integer(ik), intent(out) :: info
      integer(ik) :: a, b, i, last

      last = local%m + 1
      call solve(local%n, last, local%matrix, local%rhs, info)
      if (info /= 0) return
      allocate (share%matrix(local%m, local%m), share%known(local%m))
      share%matrix = 0.0_rk
      share%known = 0.0_rk
      do i = 1, local%n
         associate (c => local%coupling(:local%m, i), y => local%rhs(:last, i))
            do b = 1, local%m
               if (.not. abs(c(b)) > 0.0_rk) cycle  ! each cell has a part in few of the unknowns
               do a = 1, local%m
                  share%matrix(a, b) = share%matrix(a, b) - c(b)*y(a)
               end do
               share%known(b) = share%known(b) + c(b)*y(last)
            end do
         end associate
      end do
      response%matrix = local%rhs(:last, :local%n)
   end subroutine eliminate

   !> Gauss elimination, an equation per column, by the largest pivots in a column of the matrix.
   pure subroutine solve(n, m, matrix, rhs, info)
      integer(ik), intent(in) :: n  !< equations
      integer(ik), intent(in) :: m  !< right-hand sides
      real(rk), intent(inout), contiguous :: matrix(:, :)  !< (n, n); used up
      real(rk), intent(inout), contiguous :: rhs(:, :)  !< (m, n); the solutions afterwards
      integer(ik), intent(out) :: info  !< 0, or the first column without a pivot
      real(rk) :: factor, inverse
      integer(ik) :: a, i, k, pivot

      info = 0
      do k = 1, n
         pivot = k
         do i = k + 1, n
            if (abs(matrix(k, i)) > abs(matrix(k, pivot))) pivot = i
         end do
         if (.not. abs(matrix(k, pivot)) > 0.0_rk) then
            info = k
            return
         end if
         if (pivot /= k) then
            do a = k, n
               factor = matrix(a, k)
               matrix(a, k) = matrix(a, pivot)
               matrix(a, pivot) = factor
            end do
            do a = 1, m
               factor = rhs(a, k)
               rhs(a, k) = rhs(a, pivot)
               rhs(a, pivot) = factor
            end do
         end if
         inverse = 1.0_rk/matrix(k, k)
         do i = k + 1, n
            if (.not. abs(matrix(k, i)) > 0.0_rk) cycle
            factor = matrix(k, i)*inverse
            do a = k + 1, n
               matrix(a, i) = matrix(a, i) - factor*matrix(a, k)
            end do
            do a = 1, m
               rhs(a, i) = rhs(a, i) - factor*rhs(a, k)
            end do
         end do
      end do
      do k = n, 1, -1
         inverse = 1.0_rk/matrix(k, k)
         do a = 1, m
            rhs(a, k) = rhs(a, k)*inverse
         end do
         do i = 1, k - 1
            if (.not. abs(matrix(k, i)) > 0.0_rk) cycle
            factor = matrix(k, i)
            do a = 1, m
               rhs(a, i) = rhs(a, i) - factor*rhs(a, k)
            end do
         end do
      end do
   end subroutine solve

   !> The eliminated unknowns from the global ones around the vertex, in their units.
   pure subroutine apply(self, d, y)
      class(response_t), intent(in) :: self
      real(rk), intent(in) :: d(:)  !< (m) [unit of each]
      real(rk), intent(out) :: y(:)  !< (n) [unit of each]
      integer(ik) :: i, m

      m = size(d, kind=ik)
      do i = 1, size(y, kind=ik)
         y(i) = dot_product(self%matrix(:m, i), d) + self%matrix(m + 1, i)
      end do
   end subroutine apply

end module coarse_elimination
