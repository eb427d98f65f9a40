!> Radiation damping (Rice 1993): faces that slip at the velocity V send off shear waves, which take
!! eta V from the shear traction, eta = G/(2 c_s) with the velocity of shear waves c_s. So slip that
!! no quasi-static equilibrium holds has a velocity, and an end.
!!
!! In a step of length dt it is a spring of eta/dt on the slip, from where that was before.
module coarse_damping
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   implicit none(type, external)
   private

   public :: dampers, jumps_of

contains

   !> Springs on the slip of the ends of the fracture cells, zero on all else [Pa] (and for the
   !! pressures [m2/Pa]).
   pure function dampers(condensed, stiffness) result(spring)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: stiffness  !< eta/dt [Pa/m]
      real(rk) :: spring(condensed%layout%count())
      integer(ik) :: end, i

      spring = 0.0_rk
      do i = 1, condensed%n
         do end = 1, 2
            spring(condensed%layout%at_jump(i, end) + 1) = 0.5_rk*condensed%length(i)*stiffness
         end do
      end do
   end function dampers

   !> Jumps in the order of the condensed unknowns, zero in the places of the pressures [m].
   pure function jumps_of(condensed, jump) result(q)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: jump(:, :, :)  !< (2, 2, n) [u]_n, [u]_tau at start, end [m]
      real(rk) :: q(condensed%layout%count())
      integer(ik) :: at, end, i

      q = 0.0_rk
      do i = 1, condensed%n
         do end = 1, 2
            at = condensed%layout%at_jump(i, end)
            q(at:at + 1) = jump(:, end, i)
         end do
      end do
   end function jumps_of

end module coarse_damping
