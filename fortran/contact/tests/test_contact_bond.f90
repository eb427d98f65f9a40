!> Bonds: derivatives, states, history, the energy that breaking takes, and bodies that a bond lets
!! go of at once.
program test_contact_bond
   use base_kinds, only: rk
   use contact_law, only: contact_law_t, state_open, state_slip, state_stick
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, outcome_converged
   use contact_pairs, only: contact_pairs_t
   use contact_point, only: contact_residual
   use sample_points, only: checks, compare_slopes, expect, point_on_springs, stiffness
   implicit none(type, external)

   real(rk), parameter :: mpa = 1.0e6_rk, um = 1.0e-6_rk
   !> 2 MPa of tension over 10 um, 4 MPa of shear over 20 um.
   type(contact_law_t), parameter :: bonded = contact_law_t(friction=0.5_rk, tension=2.0_rk*mpa, &
                                                            cohesion=4.0_rk*mpa, &
                                                            wear_by_opening=1.0e5_rk, &
                                                            wear_by_slip=5.0e4_rk)

   call test_derivatives()
   call test_admissible()
   call test_violations()
   call test_age()
   call test_tension()
   call test_shear()
   call test_sudden()
   call checks%finish()

contains

   subroutine test_derivatives()
      type(contact_law_t) :: dilating, joint, opened, tough

      call compare_slopes(bonded, [-5.0_rk, 1.0_rk]*mpa, [0.3_rk, 2.0_rk]*um, 2.0_rk*um, &
                          state_stick)
      call compare_slopes(bonded, [1.0_rk, 1.0_rk]*mpa, [0.1_rk, 2.0_rk]*um, 2.0_rk*um, state_stick)
      call compare_slopes(bonded, [-5.0_rk, 7.0_rk]*mpa, [0.3_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
      call compare_slopes(bonded, [1.0_rk, -7.0_rk]*mpa, [-0.3_rk, -4.0_rk]*um, -2.0_rk*um, &
                          state_slip)
      call compare_slopes(bonded, [1.5_rk, 1.0_rk]*mpa, [3.0_rk, 2.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(bonded, [1.5_rk, 5.0_rk]*mpa, [3.0_rk, 4.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(bonded, [1.5_rk, -5.0_rk]*mpa, [13.0_rk, -4.0_rk]*um, 2.0_rk*um, &
                          state_open)
      opened = bonded%aged(1.0_rk*um, 4.0_rk*um)
      call compare_slopes(opened, [0.5_rk, 4.0_rk]*mpa, [3.0_rk, 4.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(opened, [0.5_rk, 4.0_rk]*mpa, [5.0_rk, 4.0_rk]*um, 2.0_rk*um, state_open)
      call compare_slopes(opened, [-1.5_rk, 6.0_rk]*mpa, [0.1_rk, 4.0_rk]*um, 2.0_rk*um, state_slip)
      joint = bonded
      joint%compliance = 1.0e-11_rk
      joint%closure_end = 1.0e4_rk
      call compare_slopes(joint, [-5.0_rk, 7.5_rk]*mpa, [-30.0_rk, 4.0_rk]*um, 2.0_rk*um, &
                          state_slip)
      call compare_slopes(joint, [1.0_rk, 6.5_rk]*mpa, [20.0_rk, 4.0_rk]*um, 2.0_rk*um, state_open)
      dilating = bonded
      dilating%dilation = 0.1_rk
      dilating%weakening = 4.0e4_rk
      dilating%weakening_slip = 1.0e-5_rk
      call compare_slopes(dilating, [-5.0_rk, 7.5_rk]*mpa, [0.3_rk, 4.0_rk]*um, 2.0_rk*um, &
                          state_slip)
      call compare_slopes(dilating, [1.5_rk, 5.0_rk]*mpa, [3.0_rk, 4.0_rk]*um, 2.0_rk*um, &
                          state_open)
      tough = bonded
      tough%wears = .false.
      call compare_slopes(tough, [1.5_rk, 5.0_rk]*mpa, [3.0_rk, 4.0_rk]*um, 2.0_rk*um, state_open)
   end subroutine test_derivatives

   !> What fulfils the law: b = 0.7 after 3 um of opening, 0.9 after 2 um of slip.
   subroutine test_admissible()
      call expect(bonded, [2.0_rk, 0.0_rk]*mpa, [0.0_rk, 0.0_rk]*um, 0.0_rk, state_open)
      call expect(bonded, [1.9_rk, 3.0_rk]*mpa, [0.0_rk, 0.0_rk]*um, 0.0_rk, state_stick)
      call expect(bonded, [-4.0_rk, -5.9_rk]*mpa, [0.0_rk, 3.0_rk]*um, 3.0_rk*um, state_stick)
      call expect(bonded, [-4.0_rk, 5.6_rk]*mpa, [0.0_rk, 3.0_rk]*um, 1.0_rk*um, state_slip)
      call expect(bonded, [1.4_rk, 0.0_rk]*mpa, [3.0_rk, 0.0_rk]*um, 0.0_rk, state_open)
      call expect(bonded, [1.0_rk, 1.5_rk]*mpa, [3.0_rk, 4.0_rk]*um, 0.0_rk, state_open)
      call expect(bonded, [0.0_rk, 0.0_rk]*mpa, [10.0_rk, 0.0_rk]*um, 0.0_rk, state_open)
      ! Broken by slip: friction is left.
      call expect(bonded, [-4.0_rk, 2.0_rk]*mpa, [0.0_rk, 30.0_rk]*um, 5.0_rk*um, state_slip)
      ! Half open, and back by half of that.
      call expect(bonded%aged(0.0_rk, 5.0_rk*um), [0.5_rk, 0.0_rk]*mpa, [2.5_rk, 0.0_rk]*um, &
                  0.0_rk, state_open)
      call expect(bonded%aged(0.0_rk, 5.0_rk*um), [-1.0_rk, 0.0_rk]*mpa, [0.0_rk, 0.0_rk]*um, &
                  0.0_rk, state_stick)
   end subroutine test_admissible

   !> Beyond what the bond bears.
   subroutine test_violations()
      call checks%is_close(contact_residual(bonded, stiffness, [3.0_rk, 0.0_rk]*mpa, &
                                            [0.0_rk, 0.0_rk], 0.0_rk), 1.0_rk*mpa, 1.0_rk, &
                           "more tension")
      call checks%is_close(contact_residual(bonded, stiffness, [2.0_rk, 0.0_rk]*mpa, &
                                            [5.0_rk*um, 0.0_rk], 0.0_rk), 1.0_rk*mpa, 1.0_rk, &
                           "more than is left")
      call checks%is_close(contact_residual(bonded, stiffness, [-4.0_rk, 7.0_rk]*mpa, &
                                            [0.0_rk, 0.0_rk], 0.0_rk), 1.0_rk*mpa, 1.0_rk, &
                           "more shear")
   end subroutine test_violations

   !> Both ways of breaking count, for good, and an opening that is rounding does not.
   subroutine test_age()
      type(contact_law_t) :: law

      law = bonded%aged(5.0_rk*um, 5.0_rk*um)
      call checks%is_close(law%bond, 0.25_rk, 1.0e-15_rk, "worn by both")
      law = bonded%aged(0.0_rk, 10.1_rk*um)
      call checks%is_true(.not. law%is_bonded(), "broken by opening")
      law = bonded%aged(20.1_rk*um, 0.0_rk)
      call checks%is_true(.not. law%is_bonded(), "broken by slip")
      law = bonded%aged(0.0_rk, 1.0e-13_rk*um)
      call checks%is_close(law%opened, 0.0_rk, 0.0_rk, "hardly open")
      law = bonded%as_grown()
      call checks%is_true(.not. law%is_bonded(), "faces that grow are broken")
      call checks%is_true(bonded%ages() .and. .not. law%ages(), "history counts")
   end subroutine test_age

   !> Opened in steps, against a spring that can hold the softening: the strength, and the energy
   !! 2 MPa 10 um/2; on the way back to zero and forth again none.
   subroutine test_tension()
      type(contact_law_t) :: law
      real(rk) :: before, first, jump(2), traction(2), work
      integer :: k
      integer, parameter :: n = 24

      work = 0.0_rk
      before = 0.0_rk
      first = 0.0_rk
      do k = 0, n
         law = bonded%aged(0.0_rk, max(0.0_rk, (k - 1)*0.5_rk*um))
         call pull(law, [k*0.5_rk*um*1.0e12_rk + 2.0_rk*mpa*max(0.0_rk, 1.0_rk - 0.05_rk*k), &
                         0.0_rk], 1.0e12_rk, 0.0_rk, jump, traction)
         call checks%is_close(jump(1), k*0.5_rk*um, 1.0e-12_rk, "opened by the load")
         if (k == 0) first = traction(1)
         if (k > 0) work = work + 0.5_rk*(before + traction(1))*0.5_rk*um
         before = traction(1)
      end do
      call checks%is_close(first, 2.0_rk*mpa, 1.0_rk, "its strength")
      call checks%is_close(work, 10.0_rk, 1.0e-5_rk, "energy of opening")
      law = bonded%aged(0.0_rk, 5.0_rk*um)
      call pull(law, [2.0_rk*um*1.0e12_rk + 0.4_rk*mpa, 0.0_rk], 1.0e12_rk, 0.0_rk, jump, traction)
      call checks%is_close(jump(1), 2.0_rk*um, 1.0e-12_rk, "closes again")
      call checks%is_close(traction(1), 0.4_rk*mpa, 1.0_rk, "towards the origin")
   end subroutine test_tension

   !> The same by slip under 4 MPa: 6 MPa at first, 4 MPa 20 um/2 of energy above friction.
   subroutine test_shear()
      type(contact_law_t) :: law
      real(rk) :: before, jump(2), strength, traction(2), work
      integer :: k
      integer, parameter :: n = 24

      work = 0.0_rk
      before = 4.0_rk*mpa
      do k = 1, n
         law = bonded%aged((k - 1)*um, 0.0_rk)
         strength = 2.0_rk*mpa + 4.0_rk*mpa*max(0.0_rk, 1.0_rk - 0.05_rk*k)
         call pull(law, [-4.0_rk*mpa, k*um*1.0e12_rk + strength], 1.0e12_rk, (k - 1)*um, jump, &
                   traction)
         call checks%is_close(jump(2), k*um, 1.0e-12_rk, "slips by the load")
         call checks%is_close(traction(2), strength, 1.0_rk, "shear that is left")
         work = work + 0.5_rk*(before + traction(2) - 2.0_rk*mpa)*um
         before = traction(2) - 2.0_rk*mpa
      end do
      call checks%is_close(work, 40.0_rk, 1.0e-5_rk, "energy of slip")
      call pull(bonded, [-4.0_rk*mpa, 5.999_rk*mpa], 1.0e12_rk, 0.0_rk, jump, traction)
      call checks%is_close(jump(2), 0.0_rk, 1.0e-15_rk, "holds below its strength")
   end subroutine test_shear

   !> Springs too soft to hold it: it lets go altogether, on whatever length, and ends where the
   !! spring alone is in equilibrium. Below its strength it holds.
   subroutine test_sudden()
      type(contact_law_t) :: law
      real(rk) :: jump(2), traction(2)
      real(rk), parameter :: springs(3) = [1.9e11_rk, 1.0e10_rk, 1.0e8_rk]
      integer :: i, k

      do i = 1, size(springs)
         do k = 0, 6, 2
            law = bonded
            law%wear_by_opening = bonded%wear_by_opening*10.0_rk**k
            law%wear_by_slip = bonded%wear_by_slip*10.0_rk**k
            call pull(law, [2.0001_rk*mpa, 0.0_rk], springs(i), 0.0_rk, jump, traction)
            call checks%is_close(jump(1), 2.0001_rk*mpa/springs(i), 1.0e-9_rk*mpa/springs(i), &
                                 "lets go")
            call pull(law, [1.9999_rk*mpa, 0.0_rk], springs(i), 0.0_rk, jump, traction)
            call checks%is_close(jump(1), 0.0_rk, 1.0e-9_rk*mpa/springs(i), "holds")
            call pull(law, [-4.0_rk*mpa, 6.0001_rk*mpa], springs(i), 0.0_rk, jump, traction)
            call checks%is_close(jump(2), 4.0001_rk*mpa/springs(i), 1.0e-9_rk*mpa/springs(i), &
                                 "slips away")
            call checks%is_close(traction(2), 2.0_rk*mpa, 1.0_rk, "down to friction")
         end do
      end do
   end subroutine test_sudden

   !> A point on springs under a load, which tension on the faces bears with them.
   subroutine pull(law, load, spring, slip_before, jump, traction)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: load(2)  !< n, tau [Pa]
      real(rk), intent(in) :: spring  !< [Pa/m]
      real(rk), intent(in) :: slip_before  !< [m]
      real(rk), intent(out) :: jump(2), traction(2)
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: x(2)

      pairs = point_on_springs(law, load, spring, slip_before, 1.0_rk)
      x = stiffness*[0.0_rk, slip_before]
      call iterate(pairs, x, iteration_settings_t(), report)
      call checks%is_true(report%outcome == outcome_converged, "converges")
      call checks%is_close(pairs%law_residual(x), 0.0_rk, 1.0e-8_rk, "law")
      jump = x/stiffness
      traction = pairs%traction(:, 1)
   end subroutine pull

end program test_contact_bond
