!> Springs on slip: what slip loses to them, and that opening and pressures lose nothing.
program test_coarse_damping
   use testing_checks, only: checks_t
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_tips, only: dampers, jumps_of
   use coarse_layout, only: condensed_layout_t
   implicit none(type, external)

   real(rk), parameter :: length(3) = [1.5_rk, 0.5_rk, 2.0_rk]  ! of the cells [m]
   real(rk), parameter :: stiffness = 4.0e6_rk  ! eta/dt [Pa/m]
   !> (component, end, cell) opening and slip at start and end [m]
   real(rk), parameter :: jump(2, 2, 3) = reshape([1.0_rk, 2.0_rk, 3.0_rk, 5.0_rk, 7.0_rk, &
                                                   11.0_rk, 13.0_rk, 17.0_rk, 19.0_rk, 23.0_rk, &
                                                   29.0_rk, 31.0_rk], [2, 2, 3])
   type(checks_t) :: checks
   type(condensed_t) :: condensed
   real(rk), allocatable :: q(:), spring(:)
   real(rk) :: lost, opening(2, 2, 3)
   integer(ik) :: i

   condensed%n = 3
   condensed%layout = condensed_layout_t(3_ik)
   condensed%length = length
   spring = dampers(condensed, stiffness)
   q = jumps_of(condensed, jump)
   ! eta/dt times the integral of the square of the slip, by the trapezoidal rule
   lost = stiffness*(0.75_rk*(2.0_rk**2 + 5.0_rk**2) + 0.25_rk*(11.0_rk**2 + 17.0_rk**2) &
                     + 1.0_rk*(23.0_rk**2 + 31.0_rk**2))
   call checks%is_close(sum(spring*q**2), lost, 1.0e-12_rk*lost, "what slip loses [N]")
   opening = jump
   opening(2, :, :) = 0.0_rk
   q = jumps_of(condensed, opening)
   call checks%is_close(sum(q), 72.0_rk, 0.0_rk, "1 + 3 + 7 + 13 + 19 + 29")
   call checks%is_true(.not. any(abs(spring*q) > 0.0_rk), "opening loses nothing")
   do i = 1, 3
      associate (at => condensed%layout%at_face_pressure(i, [1_ik, 2_ik]))
         call checks%is_true(.not. any(abs(spring(at)) > 0.0_rk), "pressures lose nothing")
      end associate
   end do
   call checks%finish()
end program test_coarse_damping
