!> Checks of the equations of contact at one point, and a point between springs, for several tests.
module sample_points
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t, state_name
   use contact_pairs, only: contact_pairs_t
   use contact_point, only: contact_equations, contact_equations_t, contact_residual
   use testing_checks, only: checks_t
   implicit none(type, external)
   private

   public :: checks, compare_slopes, expect, point_on_springs, stiffness

   real(rk), parameter :: stiffness = 2.0e12_rk  !< c [Pa/m]
   type(checks_t) :: checks  !< of the program

contains

   !> Derivatives by central differences within one state.
   subroutine compare_slopes(law, traction, jump, slip_before, expected)
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
   end subroutine compare_slopes

   !> A state that fulfils the law: no residual of either kind, and the name that the law gives it.
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
      call checks%is_close(maxval(abs(found%residual)), 0.0_rk, 1.0e-8_rk, "equations of " &
                           //state_name(expected))
      call checks%is_close(contact_residual(law, stiffness, traction, jump, slip_before), 0.0_rk, &
                           1.0e-8_rk, "law in state "//state_name(expected))
   end subroutine expect

   !> One point on two equal springs under a load, all stresses divided by a unit.
   pure function point_on_springs(law, load, spring, slip_before, unit) result(pairs)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: load(2)  !< n, tau [Pa]
      real(rk), intent(in) :: spring  !< [Pa/m]
      real(rk), intent(in) :: slip_before  !< [m]
      real(rk), intent(in) :: unit  !< [Pa]
      type(contact_pairs_t) :: pairs

      pairs%n = 1
      pairs%stiffness = stiffness/unit
      pairs%condensed = reshape([spring, 0.0_rk, 0.0_rk, spring], [2, 2])/unit
      pairs%length = [1.0_rk]
      pairs%law = [law]
      pairs%slip_given = [.false.]
      pairs%load = load/unit
      pairs%slip_before = [slip_before]
      allocate (pairs%given(1), pairs%traction(2, 1), pairs%residual(2), source=0.0_rk)
      allocate (pairs%slip_sign(1), source=0_ik)
      allocate (pairs%state(1), source=-1_ik)
   end function point_on_springs

end module sample_points
