!> Joints that close under pressure: the hyperbola, derivatives, states with friction, and Newton's
!! method on one point between springs from far away, in any units.
program test_contact_closure
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t, is_same, is_valid, state_name, state_open, state_slip, &
                          state_stick
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, outcome_converged
   use contact_pairs, only: contact_pairs_t
   use contact_point, only: contact_equations, contact_equations_t, contact_residual
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: stiffness = 2.0e12_rk  !< c [Pa/m]
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
   type(checks_t) :: checks

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
      call compare(joint, [-5.0_rk, 1.0_rk]*mpa, [-30.0_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare(joint, [-5.0_rk, 3.0_rk]*mpa, [-30.0_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
      call compare(joint, [-5.0_rk, -3.0_rk]*mpa, [-30.0_rk, -4.0_rk]*um, -2.0_rk*um, state_slip)
      call compare(joint, [-1.0_rk, 0.3_rk]*mpa, [30.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      call compare(joint, [2.0_rk, 0.3_rk]*mpa, [-30.0_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare(stiff, [-5.0_rk, 1.0_rk]*mpa, [0.1_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare(stiff, [-5.0_rk, 3.0_rk]*mpa, [-0.1_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
   end subroutine test_derivatives

   subroutine compare(law, traction, jump, slip_before, expected)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: traction(2), jump(2), slip_before
      integer(ik), intent(in) :: expected
      real(rk), parameter :: step(4) = [3.0e2_rk, 3.0e2_rk, 1.0e-10_rk, 1.0e-10_rk]
      real(rk) :: difference(2), ends(2, 2), slope(2, 4), x(4)
      integer(ik) :: way
      type(contact_equations_t) :: found
      integer :: k, side

      way = 0
      call contact_equations(law, stiffness, traction, jump, slip_before, way, found)
      slope = reshape([found%by_traction, found%by_jump], [2, 4])
      call checks%is_true(found%state == expected, "state: "//state_name(found%state)//" for " &
                          //state_name(expected))
      do k = 1, 4
         do side = 1, 2
            x = [traction, jump]
            x(k) = x(k) + step(k)*merge(-1.0_rk, 1.0_rk, side == 1)
            way = 0
            call contact_equations(law, stiffness, x(1:2), x(3:4), slip_before, way, found)
            ends(:, side) = found%residual
            call checks%is_true(found%state == expected, "difference within one state")
         end do
         difference = (ends(:, 2) - ends(:, 1))/(2.0_rk*step(k))
         call checks%is_close(maxval(abs(difference - slope(:, k)))*step(k), 0.0_rk, 1.0e-6_rk, &
                              "derivative in state "//state_name(expected))
      end do
   end subroutine compare

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

   subroutine expect(law, traction, jump, slip_before, expected)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: traction(2), jump(2), slip_before
      integer(ik), intent(in) :: expected
      integer(ik) :: way
      type(contact_equations_t) :: found

      way = 0
      call contact_equations(law, stiffness, traction, jump, slip_before, way, found)
      call checks%is_true(found%state == expected, "admissible: "//state_name(found%state) &
                          //" for "//state_name(expected))
      call checks%is_close(maxval(abs(found%residual)), 0.0_rk, 1.0e-8_rk, "equations")
      call checks%is_close(contact_residual(law, stiffness, traction, jump, slip_before), 0.0_rk, &
                           1.0e-8_rk, "law")
   end subroutine expect

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

      pairs%n = 1
      pairs%stiffness = stiffness/unit
      pairs%condensed = reshape([spring, 0.0_rk, 0.0_rk, spring], [2, 2])/unit
      pairs%length = [1.0_rk]
      pairs%law = [contact_law_t(friction=0.5_rk, compliance=unit/initial, &
                                 closure_end=1.0_rk/largest)]
      pairs%slip_given = [.false.]
      pairs%load = [-load, shear*load]/unit
      allocate (pairs%slip_before(1), pairs%given(1), pairs%traction(2, 1), source=0.0_rk)
      allocate (pairs%residual(2), source=0.0_rk)
      allocate (pairs%slip_sign(1), source=0_ik)
      allocate (pairs%state(1), source=-1_ik)
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
