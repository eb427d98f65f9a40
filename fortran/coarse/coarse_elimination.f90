!> Elimination around one vertex, for stress and for flow: the local unknowns (tractions, fluxes)
!! are eliminated, which gives a contribution to the global matrix and the response of the local
!! unknowns to the global ones.
!!
!! The system of a vertex is M y = R d + b, with unknowns y and the global ones d around it; C' y
!! enters the balances of d. `eliminate` finds y = response (d, 1) and -C' response. M is symmetric
!! (not where scalars are offset, coarse_diffusion) but not definite: rows are exchanged for the
!! largest pivots.
!!
!! There are as many of these systems as vertices, each of some ten unknowns: too few for LAPACK,
!! whose calls cost more than its arithmetic there. All arrays contain one equation per column, so
!! that a row operation is contiguous in memory, and a system is used for one vertex after another.
module coarse_elimination
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: eliminate, fix_unknown, local_system_t, new_local_system, response_t, share_t

   !> The system of one vertex. Its units are those of its rows and unknowns, see coarse_matrix and
   !! coarse_diffusion. The arrays may be larger than the system.
   type :: local_system_t
      integer(ik) :: n = 0  !< unknowns to be eliminated
      integer(ik) :: m = 0  !< global unknowns around the vertex
      real(rk), allocatable :: equations(:, :)  !< (M, R, b)' (n + m + 1, n)
      real(rk), allocatable :: coupling(:, :)  !< C' (m, n)
   contains
      procedure :: last
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
      !> (m, m) what each global unknown adds to each balance, symmetric where M is
      real(rk), allocatable :: matrix(:, :)
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
      if (allocated(local%coupling)) room = shape(local%coupling)
      if (any(room < [m, n])) then
         if (allocated(local%coupling)) deallocate (local%equations, local%coupling)
         room = max(room, [m, n])
         allocate (local%equations(sum(room) + 1, room(2)), local%coupling(room(1), room(2)))
      end if
      local%n = n
      local%m = m
      local%equations(:local%last(), :n) = 0.0_rk
      local%coupling(:m, :n) = 0.0_rk
   end subroutine new_local_system

   !> Where b stands in an equation.
   pure integer(ik) function last(self)
      class(local_system_t), intent(in) :: self

      last = self%n + self%m + 1
   end function last

   !> Replace the equation of an unknown by: unknown = value.
   pure subroutine fix_unknown(local, i, value)
      type(local_system_t), intent(inout) :: local
      integer(ik), intent(in) :: i  !< the unknown
      real(rk), intent(in) :: value  !< [unit of the unknown]

      associate (n => local%n, last => local%last(), equations => local%equations)
         equations(last, :n) = equations(last, :n) - equations(:n, i)*value
         equations(:last, i) = 0.0_rk
         equations(i, :n) = 0.0_rk
         equations(i, i) = 1.0_rk
         equations(last, i) = value
      end associate
   end subroutine fix_unknown

   !> Solve the system, which is used up. `info` is 0, or it could not be solved (degenerate cells).
   pure subroutine eliminate(local, response, share, info)
      type(local_system_t), intent(inout) :: local
      type(response_t), intent(out) :: response
      type(share_t), intent(out) :: share
      integer(ik), intent(out) :: info
      integer(ik) :: a, b, first, i
      real(rk) :: c

      call solve(local%n, local%last(), local%equations, info)
      if (info /= 0) return
      allocate (share%matrix(local%m, local%m), share%known(local%m))
      share%matrix = 0.0_rk
      share%known = 0.0_rk
      first = local%n + 1
      response%matrix = local%equations(first:local%last(), :local%n)
      associate (y => response%matrix)
         do i = 1, local%n
            do b = 1, local%m
               c = local%coupling(b, i)
               if (.not. abs(c) > 0.0_rk) cycle  ! a cell has a part in few of the unknowns
               do a = 1, local%m
                  share%matrix(a, b) = share%matrix(a, b) - c*y(a, i)
               end do
               share%known(b) = share%known(b) + c*y(local%m + 1, i)
            end do
         end do
      end associate
   end subroutine eliminate

   !> Gauss elimination, an equation per column, by the largest pivots in a row of the array. What
   !! stands behind the n coefficients of the equations becomes that of the solutions.
   pure subroutine solve(n, last, equations, info)
      integer(ik), intent(in) :: n  !< equations
      integer(ik), intent(in) :: last  !< where they end
      real(rk), intent(inout), contiguous :: equations(:, :)  !< (last, n)
      integer(ik), intent(out) :: info  !< 0, or the first unknown without a pivot
      real(rk) :: factor, kept
      integer(ik) :: a, i, k, pivot

      info = 0
      do k = 1, n
         pivot = k
         do i = k + 1, n
            if (abs(equations(k, i)) > abs(equations(k, pivot))) pivot = i
         end do
         if (.not. abs(equations(k, pivot)) > 0.0_rk) then
            info = k
            return
         end if
         if (pivot /= k) then
            do a = k, last
               kept = equations(a, k)
               equations(a, k) = equations(a, pivot)
               equations(a, pivot) = kept
            end do
         end if
         do i = k + 1, n
            if (abs(equations(k, i)) > 0.0_rk) then
               factor = equations(k, i)/equations(k, k)
               call subtract(last - k, factor, equations(k + 1:last, k), equations(k + 1:last, i))
            end if
         end do
      end do
      do k = n, 1, -1
         equations(n + 1:last, k) = equations(n + 1:last, k)/equations(k, k)
         do i = 1, k - 1
            if (abs(equations(k, i)) > 0.0_rk) then
               call subtract(last - n, equations(k, i), equations(n + 1:last, k), &
                             equations(n + 1:last, i))
            end if
         end do
      end do
   end subroutine solve

   !> y - factor x instead of y.
   pure subroutine subtract(n, factor, x, y)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: factor, x(n)
      real(rk), intent(inout) :: y(n)
      integer(ik) :: i

      do i = 1, n
         y(i) = y(i) - factor*x(i)
      end do
   end subroutine subtract

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
