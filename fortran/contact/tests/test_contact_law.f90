!> The law of contact and friction: derivatives, states, what fulfils the law and what does not.
program test_contact_law
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_quiet_nan, ieee_value
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t, is_same, is_valid, state_open, state_slip, state_stick
   use contact_point, only: contact_equations, contact_equations_t, contact_residual
   use sample_points, only: checks, compare_slopes, expect, stiffness
   implicit none(type, external)

   type(contact_law_t), parameter :: rough = contact_law_t(friction=0.5_rk, dilation=0.0_rk)
   type(contact_law_t), parameter :: dilating = contact_law_t(friction=0.5_rk, dilation=0.1_rk)
   type(contact_law_t), parameter :: smooth = contact_law_t(friction=0.0_rk, dilation=0.0_rk)
   type(contact_law_t), parameter :: smooth_dilating = &
                                     contact_law_t(friction=0.0_rk, dilation=0.1_rk)
   type(contact_law_t), parameter :: tied = &
                                     contact_law_t(friction=0.5_rk, dilation=0.1_rk, &
                                                   bilateral=.true.)
   !> From 0.6 to 0.2 over 10 um; dilation ends after 3 um.
   type(contact_law_t), parameter :: weakening = &
                                     contact_law_t(friction=0.6_rk, weakening=4.0e4_rk, &
                                                   weakening_slip=1.0e-5_rk, dilation=0.1_rk, &
                                                   dilation_end=1.0e6_rk/3.0_rk)

   call test_derivatives()
   call test_admissible()
   call test_violations()
   call test_way()
   call test_slip_of_rounding()
   call test_weakening()
   call test_friction_opposes_slip()
   call test_means()
   call test_validity()
   call checks%finish()

contains

   !> Every state with every kind of law, away from the changes of state.
   subroutine test_derivatives()
      real(rk), parameter :: mpa = 1.0e6_rk, um = 1.0e-6_rk

      call compare_slopes(rough, [-5.0_rk, 1.0_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare_slopes(rough, [-5.0_rk, 2.0_rk]*mpa, [0.3_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
      call compare_slopes(rough, [-5.0_rk, -2.0_rk]*mpa, [0.3_rk, -4.0_rk]*um, -2.0_rk*um, &
                          state_slip)
      call compare_slopes(rough, [-1.0_rk, 0.3_rk]*mpa, [9.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(rough, [2.0_rk, 0.3_rk]*mpa, [1.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(dilating, [-5.0_rk, 1.0_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_stick)
      call compare_slopes(dilating, [-5.0_rk, -1.0_rk]*mpa, [0.3_rk, -2.0_rk]*um, -2.0_rk*um, &
                          state_stick)
      call compare_slopes(dilating, [-5.0_rk, 2.0_rk]*mpa, [0.3_rk, 4.0_rk]*um, 2.0_rk*um, &
                          state_slip)
      call compare_slopes(dilating, [-5.0_rk, -2.0_rk]*mpa, [0.3_rk, -4.0_rk]*um, -2.0_rk*um, &
                          state_slip)
      ! Slipping back: the slip falls, the total slip keeps its sign.
      call compare_slopes(dilating, [-5.0_rk, -2.0_rk]*mpa, [0.3_rk, 4.0_rk]*um, 6.0_rk*um, &
                          state_slip)
      call compare_slopes(dilating, [-1.0_rk, 0.3_rk]*mpa, [9.0_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_open)
      call compare_slopes(smooth, [-5.0_rk, 0.1_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, state_slip)
      call compare_slopes(smooth, [-5.0_rk, -0.1_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_slip)
      call compare_slopes(smooth_dilating, [-5.0_rk, 0.1_rk]*mpa, [0.3_rk, -2.0_rk]*um, 0.0_rk, &
                          state_slip)
      call compare_slopes(smooth, [-1.0_rk, 0.1_rk]*mpa, [2.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      ! Weakened by 2 um and by -1 um of slip; with dilation, at its end; weakened out.
      call compare_slopes(weakening, [-5.0_rk, 4.0_rk]*mpa, [0.3_rk, 2.5_rk]*um, 0.5_rk*um, &
                          state_slip)
      call compare_slopes(weakening, [-5.0_rk, -4.0_rk]*mpa, [0.3_rk, -2.5_rk]*um, -1.5_rk*um, &
                          state_slip)
      call compare_slopes(weakening, [-5.0_rk, 4.0_rk]*mpa, [0.3_rk, 5.0_rk]*um, 3.0_rk*um, &
                          state_slip)
      call compare_slopes(weakening, [-5.0_rk, 4.0_rk]*mpa, [0.3_rk, 20.0_rk]*um, 3.0_rk*um, &
                          state_slip)
      call compare_slopes(weakening, [-5.0_rk, 0.1_rk]*mpa, [0.3_rk, 5.0_rk]*um, 5.0_rk*um, &
                          state_stick)
      call compare_slopes(weakening, [-1.0_rk, 0.1_rk]*mpa, [5.0_rk, 5.0_rk]*um, 5.0_rk*um, &
                          state_open)
      ! Faces that cannot part: as before under pressure; friction goes on under tension.
      call compare_slopes(tied, [-5.0_rk, 1.0_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare_slopes(tied, [-5.0_rk, 2.0_rk]*mpa, [0.3_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
      call compare_slopes(tied, [2.0_rk, 0.3_rk]*mpa, [1.0_rk, 3.0_rk]*um, 2.0_rk*um, state_slip)
      call compare_slopes(tied, [2.0_rk, 0.3_rk]*mpa, [1.0_rk, 1.0_rk]*um, 2.0_rk*um, state_slip)
   end subroutine test_derivatives

   !> States that fulfil the law: no residual of either kind, and the name that the law gives them.
   subroutine test_admissible()
      call expect(rough, [-4.0e6_rk, 1.9e6_rk], [0.0_rk, 3.0e-6_rk], 3.0e-6_rk, state_stick)
      call expect(rough, [-4.0e6_rk, -1.9e6_rk], [0.0_rk, 0.0_rk], 0.0_rk, state_stick)
      call expect(rough, [-4.0e6_rk, 0.0_rk], [0.0_rk, 0.0_rk], 0.0_rk, state_stick)
      call expect(rough, [-4.0e6_rk, 2.0e6_rk], [0.0_rk, 3.0e-6_rk], 1.0e-6_rk, state_slip)
      call expect(rough, [-4.0e6_rk, -2.0e6_rk], [0.0_rk, -3.0e-6_rk], 1.0e-6_rk, state_slip)
      call expect(rough, [0.0_rk, 0.0_rk], [2.0e-6_rk, 3.0e-6_rk], 1.0e-6_rk, state_open)
      call expect(dilating, [-4.0e6_rk, 1.9e6_rk], [0.25e-6_rk, 2.5e-6_rk], 2.5e-6_rk, state_stick)
      call expect(dilating, [-4.0e6_rk, 2.0e6_rk], [0.25e-6_rk, 2.5e-6_rk], 1.0e-6_rk, state_slip)
      call expect(dilating, [-4.0e6_rk, -2.0e6_rk], [0.25e-6_rk, -2.5e-6_rk], 1.0e-6_rk, state_slip)
      call expect(dilating, [-4.0e6_rk, -2.0e6_rk], [0.25e-6_rk, 2.5e-6_rk], 4.0e-6_rk, state_slip)
      call expect(dilating, [0.0_rk, 0.0_rk], [0.5e-6_rk, -2.5e-6_rk], 1.0e-6_rk, state_open)
      call expect(smooth, [-4.0e6_rk, 0.0_rk], [0.0_rk, 3.0e-6_rk], 1.0e-6_rk, state_slip)
      call expect(smooth_dilating, [-4.0e6_rk, 0.0_rk], [0.25e-6_rk, 2.5e-6_rk], 1.0e-6_rk, &
                  state_slip)
   end subroutine test_admissible

   !> Friction along a path: what one step weakens, and what several do, each on the law as it is
   !! then; energy: the area under mu(D) is (mu_s - mu_r) D_c/2 above mu_r.
   subroutine test_weakening()
      type(contact_law_t) :: law
      real(rk) :: at_once, friction, slope, work
      integer :: k
      integer, parameter :: n = 40

      call weakening%friction_at(4.0e-6_rk, at_once, slope)
      call checks%is_close(at_once, 0.44_rk, 1.0e-15_rk, "after 4 um")
      law = weakening%aged(1.0e-6_rk, 0.0_rk)
      call law%friction_at(-3.0e-6_rk, friction, slope)
      call checks%is_close(friction, at_once, 1.0e-15_rk, "after 1 um and 3 um back")
      call checks%is_close(slope, -4.0e4_rk, 1.0e-9_rk, "goes on falling")
      law = weakening%aged(2.0e-5_rk, 0.0_rk)
      call law%friction_at(1.0e-6_rk, friction, slope)
      call checks%is_close(friction, 0.2_rk, 1.0e-15_rk, "what is left")
      call checks%is_close(slope, 0.0_rk, 0.0_rk, "falls no more")
      work = 0.0_rk
      do k = 1, n
         law = weakening%aged((k - 1)*5.0e-7_rk, 0.0_rk)
         call law%friction_at(2.5e-7_rk, friction, slope)
         work = work + (friction - 0.2_rk)*5.0e-7_rk
      end do
      call checks%is_close(work, 0.5_rk*0.4_rk*1.0e-5_rk, 1.0e-20_rk, "work of weakening")
      call expect(weakening, [-4.0e6_rk, 4.0e6_rk*(0.6_rk - 4.0e4_rk*1.5e-6_rk)], &
                  [0.25e-6_rk, 2.5e-6_rk], 1.0e-6_rk, state_slip)
      call expect(weakening, [-4.0e6_rk, 0.0_rk], [0.3e-6_rk, 5.0e-6_rk], 5.0e-6_rk, state_stick)
   end subroutine test_weakening

   !> A point that sticks, but for the rounding of what was solved, and is to slip the other way. On
   !! springs kn, kt, pressed by F: with u_n = tan(psi) s and the slip -s, friction is
   !! F_t + kt s = mu (F_n - kn tan(psi) s).
   subroutine test_slip_of_rounding()
      type(contact_law_t), parameter :: law = contact_law_t(friction=1.9_rk, dilation=0.38_rk)
      real(rk), parameter :: spring(2) = [3.0e12_rk, 1.0e12_rk], force(2) = [-1.5e6_rk, -2.9e6_rk]
      real(rk), parameter :: rounding = 2.6e-22_rk  ! [m]
      real(rk), parameter :: slip = (law%friction*force(1) - force(2)) &
                             /(spring(2) + law%friction*spring(1)*law%dilation)
      real(rk) :: jump(2), slope(2, 2), step(2)
      integer(ik) :: way
      type(contact_equations_t) :: found
      integer :: k

      jump = [0.0_rk, rounding]
      way = 0
      do k = 1, 8
         call contact_equations(law, stiffness, force - spring*jump, jump, rounding, way, found)
         slope = found%by_jump
         slope(:, 1) = slope(:, 1) - found%by_traction(:, 1)*spring(1)
         slope(:, 2) = slope(:, 2) - found%by_traction(:, 2)*spring(2)
         step = [slope(2, 2)*found%residual(1) - slope(1, 2)*found%residual(2), &
                 slope(1, 1)*found%residual(2) - slope(2, 1)*found%residual(1)]
         jump = jump - step/(slope(1, 1)*slope(2, 2) - slope(1, 2)*slope(2, 1))
      end do
      call checks%is_true(found%state == state_slip, "slips")
      call checks%is_close(jump(2), -slip, 1.0e-9_rk*slip, "as far as the springs let it")
      call checks%is_close(jump(1), law%dilation*slip, 1.0e-9_rk*slip, "and opens")
   end subroutine test_slip_of_rounding

   !> Each way to break the law by itself: both measures see it, and contact_residual has its size.
   subroutine test_violations()
      call refuse(rough, [-4.0e6_rk, 1.0e6_rk], [-1.0e-6_rk, 0.0_rk], 0.0_rk, 2.0e6_rk, &
                  "penetration")
      call refuse(rough, [3.0e6_rk, 0.0_rk], [1.0e-5_rk, 0.0_rk], 0.0_rk, 3.0e6_rk, &
                  "tension on open faces")
      call refuse(rough, [3.0e6_rk, 0.0_rk], [0.0_rk, 0.0_rk], 0.0_rk, 3.0e6_rk, &
                  "tension on closed faces")
      call refuse(rough, [-4.0e6_rk, 0.0_rk], [1.0e-6_rk, 0.0_rk], 0.0_rk, 2.0e6_rk, &
                  "pressure at a gap")
      call refuse(rough, [-4.0e6_rk, 3.0e6_rk], [0.0_rk, 0.0_rk], 0.0_rk, 1.0e6_rk, &
                  "friction beyond its bound")
      call refuse(rough, [0.0_rk, 1.0e6_rk], [1.0e-6_rk, 0.0_rk], 0.0_rk, 1.0e6_rk, &
                  "shear on open faces")
      call refuse(rough, [-4.0e6_rk, -2.0e6_rk], [0.0_rk, 1.0e-6_rk], 0.0_rk, 2.0e6_rk, &
                  "friction that drives the slip")
      call refuse(rough, [-4.0e6_rk, 1.0e6_rk], [0.0_rk, 4.0e-7_rk], 0.0_rk, 0.8e6_rk, &
                  "slip below the bound")
      call refuse(dilating, [-4.0e6_rk, 2.0e6_rk], [0.0_rk, 5.0e-6_rk], 0.0_rk, 1.0e6_rk, &
                  "slip without dilation")
      call refuse(smooth, [-4.0e6_rk, 1.0e3_rk], [0.0_rk, 5.0e-6_rk], 0.0_rk, 1.0e3_rk, &
                  "shear without friction")
   end subroutine test_violations

   subroutine refuse(law, traction, jump, slip_before, size, name)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: traction(2), jump(2), slip_before
      real(rk), intent(in) :: size  !< by how much the law is broken [Pa]
      character(len=*), intent(in) :: name

      integer(ik) :: way
      type(contact_equations_t) :: found

      way = 0
      call contact_equations(law, stiffness, traction, jump, slip_before, way, found)
      call checks%is_true(maxval(abs(found%residual)) > 1.0_rk, name//" is not a solution")
      call checks%is_close(contact_residual(law, stiffness, traction, jump, slip_before), size, &
                           1.0e-8_rk*size, name)
   end subroutine refuse

   !> Slip that turns round within an iteration is tried as sticking first.
   subroutine test_way()
      call walk(rough, -1_ik, 0_ik, state_stick, "turned round: stick")
      call walk(rough, 0_ik, 1_ik, state_slip, "from rest: slip")
      call walk(rough, 1_ik, 1_ik, state_slip, "going on: slip")
      call walk(smooth, -1_ik, 1_ik, state_slip, "without friction nothing holds")
   end subroutine test_way

   subroutine walk(law, way_before, way_expected, expected, name)
      type(contact_law_t), intent(in) :: law
      integer(ik), intent(in) :: way_before, way_expected, expected
      character(len=*), intent(in) :: name

      integer(ik) :: way
      type(contact_equations_t) :: found

      way = way_before
      call contact_equations(law, stiffness, [-4.0e6_rk, 3.0e6_rk], [0.0_rk, 0.0_rk], 0.0_rk, &
                             way, found)
      call checks%is_true(found%state == expected .and. way == way_expected, name)
      way = way_before
      call contact_equations(law, stiffness, [1.0e6_rk, 3.0e6_rk], [0.0_rk, 0.0_rk], 0.0_rk, &
                             way, found)
      call checks%is_true(found%state == state_open .and. way == 0, "open faces forget their way")
   end subroutine walk

   !> The faces receive f on side + and -f on side -, which moves by the slip relative to side +.
   !! The work done on the faces, -f_tau*slip, is lost, not gained: f_tau has the sign of the
   !! slip.
   subroutine test_friction_opposes_slip()
      real(rk) :: slip, traction(2), work
      integer(ik) :: way
      type(contact_equations_t) :: found
      integer :: direction

      do direction = -1, 1, 2
         slip = direction*1.0e-6_rk
         way = 0
         traction = [-4.0e6_rk, 0.0_rk]
         ! The slip equation is linear in f_tau with slope 1: one step solves it.
         call contact_equations(rough, stiffness, traction, [0.0_rk, slip], 0.0_rk, way, found)
         call checks%is_true(found%state /= state_open, "pressed together")
         traction(2) = direction*5.0e6_rk
         way = 0
         call contact_equations(rough, stiffness, traction, [0.0_rk, slip], 0.0_rk, way, found)
         traction(2) = traction(2) - found%residual(2)
         work = -traction(2)*slip
         call checks%is_close(work, -0.5_rk*4.0e6_rk*1.0e-6_rk, 1.0e-12_rk, "friction dissipates")
      end do
   end subroutine test_friction_opposes_slip

   !> Three parts of one law and one of another.
   subroutine test_means()
      type(contact_law_t) :: mean

      call mean%add_share(dilating, 3.0_rk)
      call mean%add_share(smooth, 1.0_rk)
      call mean%divide(4.0_rk)
      call checks%is_close(mean%friction, 0.375_rk, 1.0e-15_rk, "mean friction")
      call checks%is_close(mean%dilation, 0.075_rk, 1.0e-15_rk, "mean dilation")
   end subroutine test_means

   !> Numbers that no law has, each by itself.
   subroutine test_validity()
      real(rk) :: infinite, nan

      infinite = ieee_value(infinite, ieee_positive_inf)
      nan = ieee_value(nan, ieee_quiet_nan)
      call checks%is_true(is_same(tied, tied) .and. .not. any(is_same(dilating, [rough, &
                                                                                 smooth_dilating, &
                                                                                 tied])), &
                          "laws that differ in one parameter")
      call checks%is_true(all(is_valid([rough, dilating, smooth, tied])), "valid laws")
      call checks%is_true(.not. is_valid(contact_law_t(friction=-0.1_rk)), "negative friction")
      call checks%is_true(.not. is_valid(contact_law_t(friction=nan)), "friction that is no number")
      call checks%is_true(.not. is_valid(contact_law_t(dilation=-0.1_rk)), "negative dilation")
      call checks%is_true(.not. is_valid(contact_law_t(dilation=infinite)), "infinite dilation")
   end subroutine test_validity

end program test_contact_law
