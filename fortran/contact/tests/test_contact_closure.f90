!> Joints that close under pressure: the hyperbola, derivatives, states with friction, and Newton's
!! method on one point between springs from far away, in any units.
program test_contact_closure
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t, is_same, is_valid, state_open, state_slip, state_stick
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, outcome_converged
   use contact_pairs, only: contact_pairs_t
   use contact_point, only: contact_residual
   use sample_points, only: checks, compare_slopes, expect, point_on_springs, stiffness
   implicit none(type, external)

   real(rk), parameter :: initial = 1.0e11_rk  !< k_ni [Pa/m]
   real(rk), parameter :: largest = 1.0e-4_rk  !< d_max [m]
   !> Soft against c, and stiff against it.
   type(contact_law_t), parameter :: joint = contact_law_t(friction=0.5_rk, dilation=0.1_rk, &
                                                           compliance=1.0_rk/initial, &
                                                           closure_end=1.0_rk/largest)
   type(contact_law_t), parameter :: stiff = contact_law_t(friction=0.5_rk, &
                                                           compliance=1.0e-14_rk, &
                                                           closure_end=1.0e6_rk)
   real(rk), parameter :: mpa = 1.0e6_rk, um = 1.0e-6_rk

   call test_hyperbola()
   call test_inverse()
   call test_derivatives()
   call test_admissible()
   call test_violations()
   call test_springs()
   call test_units()
   call test_fresh()
   call checks%finish()

contains

   !> s = k_ni d/(1 - d/d_max), solved for d; its slope by differences; tension; at rest.
   subroutine test_hyperbola()
      type(contact_law_t) :: law
      real(rk) :: after, before, closed, ignored, pressure, slope
      integer :: k

      do k = -3, 12
         pressure = 10.0_rk**k*1.0e3_rk
         call joint%closure(pressure, closed, slope)
         call checks%is_true(closed < largest, "never closes altogether")
         ! d_max - d = d_max/(1 + s/(k d_max)) as d loses digits near d_max.
         call checks%is_close(pressure*(1.0_rk - closed/largest), initial*closed, &
                              1.0e-15_rk*(pressure + initial*closed), "on the hyperbola")
         call joint%closure(pressure*(1.0_rk + 1.0e-4_rk), after, ignored)
         call joint%closure(pressure*(1.0_rk - 1.0e-4_rk), before, ignored)
         call checks%is_close((after - before)/(2.0e-4_rk*pressure), slope, &
                              1.0e-7_rk*slope + 1.0e-16_rk*largest/(1.0e-4_rk*pressure), "slope")
      end do
      call joint%closure(-2.0e6_rk, closed, slope)
      call checks%is_close(closed, -2.0e6_rk/initial, 1.0e-20_rk, "linear under tension")
      law = joint
      law%closure_at_rest = 3.0e-5_rk
      call law%closure(0.0_rk, closed, slope)
      call checks%is_close(closed, -3.0e-5_rk, 0.0_rk, "opens by what it was closed at rest")
   end subroutine test_hyperbola

   !> The pressure at a jump gives the closure that the jump leaves, with dilation and at rest; none
   !! where the faces are apart, beyond the pole, and without closure.
   subroutine test_inverse()
      type(contact_law_t) :: law
      real(rk) :: closed, ignored, pressure
      integer :: k

      law = joint
      law%closure_at_rest = 3.0e-5_rk
      do k = -3, 5
         pressure = 10.0_rk**k*1.0e3_rk
         call law%closure(pressure, closed, ignored)
         call checks%is_close(law%joint_pressure([-closed + 0.1_rk*5.0_rk*um, -5.0_rk*um]), &
                              pressure, 1.0e-13_rk*max(pressure*(1.0_rk + pressure/1.0e7_rk), &
                                                       initial*largest), "inverse of closure")
      end do
      call checks%is_true(.not. law%joint_pressure([3.1e-5_rk, 0.0_rk]) > 0.0_rk, "apart")
      call checks%is_true(.not. law%joint_pressure([-7.5e-5_rk, 0.0_rk]) > 0.0_rk, "beyond d_max")
      law%compliance = 0.0_rk
      call checks%is_true(.not. law%joint_pressure([-1.0e-5_rk, 0.0_rk]) > 0.0_rk, "no closure")
   end subroutine test_inverse

   subroutine test_derivatives()
      call compare_slopes(joint, [-5.0_rk, 1.0_rk]*mpa, [-30.0_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_stick)
      call compare_slopes(joint, [-5.0_rk, 3.0_rk]*mpa, [-30.0_rk, 4.0_rk]*um, 2.0_rk*um, &
                          state_slip)
      call compare_slopes(joint, [-5.0_rk, -3.0_rk]*mpa, [-30.0_rk, -4.0_rk]*um, -2.0_rk*um, &
                          state_slip)
      call compare_slopes(joint, [-1.0_rk, 0.3_rk]*mpa, [30.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(joint, [2.0_rk, 0.3_rk]*mpa, [-30.0_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_stick)
      call compare_slopes(stiff, [-5.0_rk, 1.0_rk]*mpa, [0.1_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare_slopes(stiff, [-5.0_rk, 3.0_rk]*mpa, [-0.1_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
   end subroutine test_derivatives

   !> Pressed with 4 MPa these faces are 4/(1e5 + 4e4) m nearer; with slip they dilate as ever.
   subroutine test_admissible()
      real(rk), parameter :: closed = 4.0e6_rk/(initial + 4.0e6_rk/largest)

      call expect(joint, [-4.0e6_rk, 1.9e6_rk], [-closed, 0.0_rk], 0.0_rk, state_stick)
      call expect(joint, [-4.0e6_rk, 1.9e6_rk], [0.25e-6_rk - closed, 2.5e-6_rk], 2.5e-6_rk, &
                  state_stick)
      call expect(joint, [-4.0e6_rk, 2.0e6_rk], [0.25e-6_rk - closed, 2.5e-6_rk], 1.0e-6_rk, &
                  state_slip)
      call expect(joint, [-4.0e6_rk, -2.0e6_rk], [0.25e-6_rk - closed, -2.5e-6_rk], 1.0e-6_rk, &
                  state_slip)
      call expect(joint, [0.0_rk, 0.0_rk], [0.3e-6_rk, -2.5e-6_rk], 1.0e-6_rk, state_open)
   end subroutine test_admissible

   !> Too far closed for the pressure, and not far enough, seen through two springs in a row.
   subroutine test_violations()
      real(rk), parameter :: closed = 4.0e6_rk/(initial + 4.0e6_rk/largest)
      real(rk), parameter :: row = stiffness/(1.0_rk + stiffness/initial)

      call checks%is_close(contact_residual(joint, stiffness, [-4.0e6_rk, 0.0_rk], &
                                            [-closed - um, 0.0_rk], 0.0_rk), row*um, 1.0e-3_rk, &
                           "overlap")
      call checks%is_close(contact_residual(joint, stiffness, [-4.0e6_rk, 0.0_rk], &
                                            [um - closed, 0.0_rk], 0.0_rk), row*um, 1.0e-3_rk, &
                           "pressure at a gap")
      call checks%is_close(contact_residual(joint, stiffness, [3.0e6_rk, 0.0_rk], &
                                            [100.0_rk*um, 0.0_rk], 0.0_rk), 3.0e6_rk, 1.0e-3_rk, &
                           "tension")
   end subroutine test_violations

   !> A point on a spring K under a load P: s = P + K u with u = -d(s), a quadratic equation for d,
   !! from next to no load to a thousand times k_ni d_max; shear below and at the bound of friction.
   subroutine test_springs()
      real(rk), parameter :: springs(4) = [1.0e8_rk, 1.0e10_rk, 1.0e12_rk, 1.0e15_rk]
      integer :: i, k

      do i = 1, size(springs)
         do k = -3, 3
            call solve(springs(i), 10.0_rk**k*initial*largest, 0.3_rk, 1.0_rk)
            call solve(springs(i), 10.0_rk**k*initial*largest, 0.9_rk, 1.0_rk)
            call solve(springs(i), -10.0_rk**k*initial*largest, 0.3_rk, 1.0_rk)
         end do
      end do
   end subroutine test_springs

   !> The same in units a million times larger and smaller: the same iterations.
   subroutine test_units()
      integer(ik) :: here, there

      call solve(1.0e11_rk, 30.0_rk*initial*largest, 0.9_rk, 1.0_rk, here)
      call solve(1.0e11_rk, 30.0_rk*initial*largest, 0.9_rk, 1.0e6_rk, there)
      call checks%is_true(here == there, "as many iterations in MPa")
      call solve(1.0e11_rk, 30.0_rk*initial*largest, 0.9_rk, 1.0e-6_rk, there)
      call checks%is_true(here == there, "as many iterations in uPa")
   end subroutine test_units

   subroutine solve(spring, load, shear, unit, iterations)
      real(rk), intent(in) :: spring  !< K [Pa/m]
      real(rk), intent(in) :: load  !< P, pressing the faces on each other [Pa]
      real(rk), intent(in) :: shear  !< over the load [-]
      real(rk), intent(in) :: unit  !< stresses are divided by it [Pa]
      integer(ik), intent(out), optional :: iterations
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: b, closed, x(2)

      pairs = point_on_springs(contact_law_t(friction=0.5_rk, compliance=unit/initial, &
                                             closure_end=1.0_rk/largest), &
                               load*[-1.0_rk, shear], spring, 0.0_rk, unit)
      x = 0.0_rk
      call iterate(pairs, x, iteration_settings_t(), report)
      call checks%is_true(report%outcome == outcome_converged, "converges")
      call checks%is_true(.not. report%was_restarted, "without another start")
      if (present(iterations)) iterations = report%iterations
      if (load > 0.0_rk) then
         ! (load - K d)(1 - d/d_max) = k d
         b = initial + spring + load/largest
         closed = 2.0_rk*load/(b + sqrt(b**2 - 4.0_rk*spring*load/largest))
         ! Residuals of 1e-10 of the load, over the springs in a row.
         call checks%is_close(x(1)/pairs%stiffness, -closed, 1.0e-9_rk*closed + &
                              1.0e-10_rk*load*(1.0_rk/initial + 1.0_rk/stiffness), "closure")
         call checks%is_close(pairs%law_residual(x), 0.0_rk, 1.0e-9_rk, "law")
      else
         call checks%is_close(x(1)/pairs%stiffness, -load/spring, -1.0e-9_rk*load/spring, "open")
      end if
   end subroutine solve

   !> Faces that grow from it are as rough but neither close nor hold.
   subroutine test_fresh()
      type(contact_law_t) :: grown

      grown = joint%as_grown()
      call checks%is_close(grown%spring(stiffness), stiffness, 0.0_rk, "rigid")
      call checks%is_close(grown%friction, joint%friction, 0.0_rk, "as rough")
      call checks%is_true(.not. is_same(grown, joint), "another law")
      call checks%is_true(.not. is_valid(contact_law_t(compliance=-1.0_rk)), "negative compliance")
      call checks%is_true(is_valid(joint), "a valid law")
   end subroutine test_fresh

end program test_contact_closure
