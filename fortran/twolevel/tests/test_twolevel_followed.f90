!> Errors in time of followed quantities, against exact solutions.
!!
!! Backward Euler of a decaying mode and of diffusion into a half-space at a constant flux, whose
!! exact solutions are exp(-l t) and 2 sqrt(t/pi); steps that are equal, and steps that grow by 1.5
!! and 2. Budget: the true error is at most the stated one from the second step on, and in the
!! median the stated one is at most 10 times larger; with equal steps the estimate of a mode is
!! exact up to l h of 0.1, within 25 %.
program test_twolevel_followed
   use base_kinds, only: pi, rk
   use testing_checks, only: checks_t
   use twolevel_followed, only: followed_step_t, followed_t
   implicit none(type, external)

   type(checks_t) :: checks
   real(rk), parameter :: growths(3) = [1.0_rk, 1.5_rk, 2.0_rk]

   call test_mode()
   call test_diffusion()
   call test_switch()
   call test_changes()
   call checks%finish()

contains

   !> A mode that decays.
   subroutine test_mode()
      type(followed_t) :: followed
      real(rk) :: error, step, time, value
      integer :: i, k, n_held, n_steps

      do k = 1, size(growths)
         call followed%begin(0.0_rk, [1.0_rk])
         time = 0.0_rk
         value = 1.0_rk
         step = 0.01_rk
         n_held = 0
         n_steps = 0
         do i = 1, 40
            if (time > 2.0_rk) exit
            time = time + step
            value = value/(1.0_rk + step)
            call followed%follow(followed_step_t(time), [value])
            error = abs(value - exp(-time))
            if (i > 1) then
               n_steps = n_steps + 1
               if (error <= followed%error(1)) n_held = n_held + 1
            end if
            if (i == 40 .and. k == 1) then
               call checks%is_close(followed%linear(1), error, 0.25_rk*error, "equal steps")
            end if
            step = step*growths(k)
         end do
         call checks%is_true(n_held == n_steps, "a mode: all hold")
      end do
   end subroutine test_mode

   !> Diffusion by volumes far finer than the steps let it advance, on which backward Euler has the
   !! only error.
   subroutine test_diffusion()
      integer, parameter :: n = 400
      real(rk) :: p(n), place, ratios(60), sizes(n), step, time, true
      type(followed_t) :: followed
      integer :: i, k, n_held

      sizes(1) = 0.002_rk
      do i = 2, n
         sizes(i) = min(sizes(i - 1)*1.03_rk, 0.3_rk)
      end do
      do k = 1, size(growths)
         p = 0.0_rk
         time = 0.0_rk
         step = 0.02_rk
         call followed%begin(0.0_rk, [0.0_rk])
         n_held = 0
         do i = 1, merge(60, 12, k == 1)
            time = time + step
            call advance(sizes, step, p)
            place = p(1) + 0.5_rk*sizes(1)
            call followed%follow(followed_step_t(time, is_first=i == 1), [place])
            true = abs(place - 2.0_rk*sqrt(time/pi))
            ratios(i) = followed%error(1)/true
            if (ratios(i) >= 1.0_rk) n_held = n_held + 1
            step = step*growths(k)
         end do
         i = merge(60, 12, k == 1)
         call checks%is_true(n_held >= nint(0.95_rk*i), "diffusion: 95 % hold")
         call checks%is_true(count(ratios(:i) <= 10.0_rk) > i/2, "diffusion: median factor")
      end do
   end subroutine test_diffusion

   !> A step of backward Euler with a unit flux into the first volume, storage and mobility 1.
   subroutine advance(sizes, step, p)
      real(rk), intent(in) :: sizes(:), step
      real(rk), intent(inout) :: p(:)
      real(rk) :: conductance(size(p) - 1), pivot(size(p)), rhs(size(p))
      integer :: i, n

      n = size(p)
      conductance = step*2.0_rk/(sizes(:n - 1) + sizes(2:))
      pivot = sizes
      pivot(:n - 1) = pivot(:n - 1) + conductance
      pivot(2:) = pivot(2:) + conductance
      rhs = sizes*p
      rhs(1) = rhs(1) + step
      do i = 2, n
         rhs(i) = rhs(i) + conductance(i - 1)/pivot(i - 1)*rhs(i - 1)
         pivot(i) = pivot(i) - conductance(i - 1)**2/pivot(i - 1)
      end do
      p(n) = rhs(n)/pivot(n)
      do i = n - 1, 1, -1
         p(i) = (rhs(i) + conductance(i)*p(i + 1))/pivot(i)
      end do
   end subroutine advance

   !> A quantity that is linear in time has no error, also after a switch, if nothing diffuses; a
   !! jump has none either.
   subroutine test_switch()
      type(followed_t) :: followed

      call followed%begin(0.0_rk, [1.0_rk])
      call followed%follow(followed_step_t(1.0_rk, diffusing=0.0_rk), [2.0_rk])
      call followed%follow(followed_step_t(3.0_rk, diffusing=0.0_rk), [4.0_rk])
      call checks%is_close(followed%error(1), 0.0_rk, 1.0e-15_rk, "linear")
      call followed%follow(followed_step_t(3.1_rk, is_jump=.true.), [9.0_rk])
      call checks%is_close(followed%error(1), 0.0_rk, 1.0e-15_rk, "jump")
      call followed%follow(followed_step_t(4.1_rk), [10.0_rk])
      call checks%is_close(followed%error(1), 0.0_rk, 1.0e-12_rk, "as before the jump")
   end subroutine test_switch

   !> Changes between switches add up; one that is taken back in a stage does not.
   subroutine test_changes()
      type(followed_t) :: followed
      real(rk) :: changes(1)

      call followed%begin(0.0_rk, [1.0_rk])
      call followed%follow(followed_step_t(1.0_rk, is_first=.true.), [3.0_rk])
      call followed%follow(followed_step_t(2.0_rk), [2.0_rk])
      changes = followed%changes()
      call checks%is_close(changes(1), 1.0_rk, 1.0e-15_rk, "first stage")
      call followed%follow(followed_step_t(3.0_rk, is_first=.true.), [-2.0_rk])
      changes = followed%changes()
      call checks%is_close(changes(1), 5.0_rk, 1.0e-15_rk, "two stages")
   end subroutine test_changes

end program test_twolevel_followed
