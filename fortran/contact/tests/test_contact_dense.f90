!> The linear step of a full matrix: equations of very different sizes, the condition of a matrix
!! that is known, one that is singular, and none at all; what a step leaves out of its matrix, and
!! flows that a condition leaves out.
program test_contact_dense
   use algebra_links, only: links_t, new_links
   use base_kinds, only: ik, rk
   use contact_dense, only: solve_by_parts, solve_full
   use contact_newton, only: step_quality_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call finds_step()
   call notices_singular_matrix()
   call has_nothing_to_solve()
   call leaves_flows_out_of_condition()
   call leaves_out_links()
   call solves_by_parts()
   call checks%finish()

contains

   !> x_1 + 3 x_2 = -8 and 1e12 (x_2 - x_1) = 4e12. Scaled, the matrix is (1/3 1; -1 1) and its
   !! inverse (3 -3; 3 1)/4: the largest row sums 2 and 3/2 give the condition 3.
   subroutine finds_step()
      real(rk), parameter :: large = 1.0e12_rk
      real(rk), parameter :: equations(2, 2) = reshape([1.0_rk, 3.0_rk, -large, large], [2, 2])
      type(step_quality_t) :: quality
      real(rk) :: matrix(2, 2), residual(2), step(2)

      matrix = equations
      residual = [8.0_rk, -4.0_rk*large]
      call solve_full(matrix, residual, .false., step, quality)
      call checks%is_true(.not. quality%is_singular, "regular")
      call checks%is_close(step(1), -5.0_rk, 1.0e-14_rk, "first component of the step")
      call checks%is_close(step(2), -1.0_rk, 1.0e-14_rk, "second component of the step")
      call checks%is_close(quality%condition, 0.0_rk, 0.0_rk, "no condition unless asked for")
      matrix = equations
      residual = [8.0_rk, -4.0_rk*large]
      call solve_full(matrix, residual, .true., step, quality)
      call checks%is_close(step(1), -5.0_rk, 1.0e-14_rk, "the same step with the condition")
      call checks%is_close(quality%condition, 3.0_rk, 1.0e-14_rk, "condition of two equations")
   end subroutine finds_step

   !> Equations 1 and 3, times -2 and -4, are (2 1; 1 3) in unknowns 1 and 3; 2 is any. The step is
   !! (1 2 3) by choice of the residual. Without equation 2; and where the part is not definite.
   subroutine solves_by_parts()
      real(rk), parameter :: factor(3) = [-2.0_rk, 0.0_rk, -4.0_rk]
      real(rk), parameter :: wanted(3) = [1.0_rk, 2.0_rk, 3.0_rk]
      real(rk), parameter :: equations(3, 3) = &
                             reshape([2.0_rk/factor(1), 7.0_rk, 1.0_rk/factor(1), &
                                      5.0_rk, 1.0_rk, -6.0_rk, &
                                      1.0_rk/factor(3), 4.0_rk, 3.0_rk/factor(3)], [3, 3])
      type(step_quality_t) :: quality
      real(rk) :: step(3)
      logical :: is_solved

      call solve_by_parts(equations, -matmul(wanted, equations), factor, step, quality, is_solved)
      call checks%is_true(is_solved .and. .not. quality%is_singular, "solved by parts")
      call checks%is_close(maxval(abs(step - wanted)), 0.0_rk, 1.0e-13_rk, "step by parts")
      associate (part => equations([1, 3], [1, 3]))
         call solve_by_parts(part, -matmul(wanted(:2), part), factor([1, 3]), step(:2), quality, &
                             is_solved)
         call checks%is_close(maxval(abs(step(:2) - wanted(:2))), 0.0_rk, 1.0e-14_rk, "one part")
      end associate
      call solve_by_parts(equations, wanted, -factor, step, quality, is_solved)
      call checks%is_true(.not. is_solved, "a part that is not definite")
   end subroutine solves_by_parts

   subroutine notices_singular_matrix()
      type(step_quality_t) :: quality
      real(rk) :: matrix(2, 2), residual(2), step(2)

      matrix = reshape([1.0_rk, 3.0_rk, 0.0_rk, 0.0_rk], [2, 2])
      residual = 1.0_rk
      call solve_full(matrix, residual, .true., step, quality)
      call checks%is_true(quality%is_singular, "an equation without unknowns")
   end subroutine notices_singular_matrix

   !> Where all points stick.
   subroutine has_nothing_to_solve()
      type(step_quality_t) :: quality
      real(rk) :: matrix(0, 0), residual(0), step(0)

      call solve_full(matrix, residual, .true., step, quality)
      call checks%is_true(.not. quality%is_singular, "no equation is not singular")
   end subroutine has_nothing_to_solve

   !> Three cells p in a ring and the flows q between them, against which there is hardly any
   !! resistance: p_k + q_k - q_(k-1) = f_k, r q_k - p_k + p_(k+1) = d_k. As r vanishes,
   !! p_1 = (f_1 + f_2 + f_3 + d_3 - d_1)/3, while the flow round the ring is (d_1 + d_2 + d_3)/3r.
   !! So the norm of the inverse is 5/3 for the cells, 1/r for all; that of the matrix is 3.
   subroutine leaves_flows_out_of_condition()
      real(rk), parameter :: resistance = 1.0e-10_rk
      logical, parameter :: is_flow(6) = [.false., .false., .false., .true., .true., .true.]
      type(step_quality_t) :: quality
      real(rk) :: matrix(6, 6), residual(6), step(6)

      call fill_ring(resistance, matrix)
      residual = [1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]
      call solve_full(matrix, residual, .true., step, quality)
      call checks%is_close(quality%condition*resistance, 3.0_rk, 1.0e-5_rk, "of the whole ring")
      call fill_ring(resistance, matrix)
      residual = [1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk]
      call solve_full(matrix, residual, .true., step, quality, left_out=is_flow)
      call checks%is_close(quality%condition, 5.0_rk, 1.0e-6_rk, "of the cells in the ring")
      call checks%is_close(step(1), -1.0_rk/3.0_rk, 1.0e-9_rk, "the cells are right")
   end subroutine leaves_flows_out_of_condition

   pure subroutine fill_ring(resistance, matrix)
      real(rk), intent(in) :: resistance
      real(rk), intent(out) :: matrix(6, 6)  !< an equation per column
      integer :: k, next

      matrix = 0.0_rk
      do k = 1, 3
         next = modulo(k, 3) + 1
         matrix(k, k) = 1.0_rk
         matrix(3 + k, k) = 1.0_rk
         matrix(3 + k, next) = -1.0_rk
         matrix(3 + k, 3 + k) = resistance
         matrix(k, 3 + k) = -1.0_rk
         matrix(next, 3 + k) = 1.0_rk
      end do
   end subroutine fill_ring

   !> Three points: one sticks, one opens with its slip, one is open. The step is that of the whole
   !! matrix.
   subroutine leaves_out_links()
      real(rk), parameter :: residual(6) = [1.0_rk, -2.0_rk, 3.0_rk, 4.0_rk, -5.0_rk, 6.0_rk]
      type(step_quality_t) :: quality
      type(links_t) :: links
      real(rk) :: matrix(6, 6), own(2, 2), rest(6), rows(3, 6), solution(3), step(6), whole(6)
      real(rk), allocatable :: small(:, :), left(:)
      integer(ik), allocatable :: kept(:)
      integer(ik) :: i, k, m

      do k = 1, 6  ! an equation per column
         do m = 1, 6
            matrix(m, k) = 1.0_rk/(m + 2*k) + merge(3.0_rk, 0.0_rk, m == k)
         end do
      end do
      matrix(3:, :2) = 0.0_rk  ! the first point's equations hold its own jumps
      matrix([1, 2, 5, 6], 3) = 0.0_rk  ! the second's opening follows its slip
      links = new_links(6)
      do i = 1, 5, 2
         own = transpose(matrix(i:i + 1, i:i + 1))
         call links%link_pair(i, own, [i < 5, i == 1])
      end do
      call links%take_residual(residual)
      kept = links%kept_unknowns()
      call checks%is_true(all(kept == [4, 5, 6]), "slip of one point and jumps of another are left")
      rows = transpose(matrix(:, kept))
      left = residual(kept)
      call links%reduce(rows, left)
      small = transpose(rows(:, kept))
      call solve_full(small, left, .false., solution, quality)
      step(kept) = solution
      call links%complete(step)
      rest = residual
      call solve_full(matrix, rest, .false., whole, quality)
      call checks%is_close(maxval(abs(step - whole)), 0.0_rk, 1.0e-14_rk, "the whole matrix's step")
   end subroutine leaves_out_links

end program test_contact_dense
