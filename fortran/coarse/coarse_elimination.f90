!> What happens around one vertex, whether stress or flow: its own unknowns (tractions, fluxes) are
!! eliminated, and leave a share of the global matrix and their responses to the global unknowns.
!!
!! The system of a vertex is M y = R d + b, with unknowns y and the global ones d around it; C' y
!! enters the balances of d. `eliminate` finds y = response (d, 1) and -C' response.
module coarse_elimination
   use algebra_lapack, only: dgesv
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: eliminate, fix_unknown, local_system_t, new_local_system, response_t, share_t

   !> The system of one vertex. Its units are those of its rows and unknowns, see coarse_stress and
   !! coarse_diffusion.
   type :: local_system_t
      real(rk), allocatable :: matrix(:, :)  !< M (n, n)
      real(rk), allocatable :: coupling(:, :)  !< C (n, m)
      real(rk), allocatable :: rhs(:, :)  !< (R, b) (n, m + 1)
   end type local_system_t

   !> The eliminated unknowns (n, m + 1) per unit of each global one around the vertex; the last
   !! column holds what the boundary data alone give.
   type :: response_t
      real(rk), allocatable :: matrix(:, :)
   contains
      procedure :: apply
   end type response_t

   !> What a vertex adds to the global system.
   type :: share_t
      real(rk), allocatable :: matrix(:, :)  !< (m, m)
      real(rk), allocatable :: known(:)  !< (m) right-hand side, from boundary data
   end type share_t

contains

   !> An empty system.
   pure subroutine new_local_system(n, m, local)
      integer(ik), intent(in) :: n  !< unknowns to be eliminated
      integer(ik), intent(in) :: m  !< global unknowns around the vertex
      type(local_system_t), intent(out) :: local

      allocate (local%matrix(n, n), local%coupling(n, m), local%rhs(n, m + 1), source=0.0_rk)
   end subroutine new_local_system

   !> Replace the equation of an unknown by: unknown = value.
   pure subroutine fix_unknown(local, i, value)
      type(local_system_t), intent(inout) :: local
      integer(ik), intent(in) :: i  !< the unknown
      real(rk), intent(in) :: value  !< [unit of the unknown]

      associate (b => local%rhs(:, size(local%rhs, 2)))
         b = b - local%matrix(:, i)*value
         local%matrix(:, i) = 0.0_rk
         local%matrix(i, :) = 0.0_rk
         local%matrix(i, i) = 1.0_rk
         local%rhs(i, :) = 0.0_rk
         b(i) = value
      end associate
   end subroutine fix_unknown

   !> Solve the system, which is used up. `info` is 0, or it could not be solved (degenerate cells).
   subroutine eliminate(local, response, share, info)
      type(local_system_t), intent(inout) :: local
      type(response_t), intent(out) :: response
      type(share_t), intent(out) :: share
      integer(ik), intent(out) :: info
      integer(ik) :: m, n, pivots(size(local%matrix, 1))

      n = size(local%matrix, 1)
      m = size(local%coupling, 2)
      call dgesv(n, m + 1, local%matrix, n, pivots, local%rhs, n, info)
      if (info /= 0) return
      share%matrix = -matmul(transpose(local%coupling), local%rhs(:, :m))
      share%known = matmul(local%rhs(:, m + 1), local%coupling)
      call move_alloc(local%rhs, response%matrix)
   end subroutine eliminate

   !> The eliminated unknowns from the global ones around the vertex, in their units.
   pure subroutine apply(self, d, y)
      class(response_t), intent(in) :: self
      real(rk), intent(in) :: d(:)  !< (m) [unit of each]
      real(rk), intent(out) :: y(:)  !< (n) [unit of each]

      y = matmul(self%matrix(:, :size(d)), d) + self%matrix(:, size(d) + 1)
   end subroutine apply

end module coarse_elimination
