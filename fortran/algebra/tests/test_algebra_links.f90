!> Links: three of five unknowns leave, one after another, and what is left gives all of them.
program test_algebra_links
   use algebra_links, only: links_t, new_links
   use base_kinds, only: ik, rk
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call leaves_and_comes_back()
   call checks%finish()

contains

   !> Two equations in two unknowns are left of five, whose solution is (1, 2, 3, 4, 5): the first
   !! is linked to the second and third, the second to the third and fifth, the fourth to nothing.
   subroutine leaves_and_comes_back()
      real(rk), parameter :: solution(5) = [1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk]
      integer(ik), parameter :: none(0) = [integer(ik) ::]
      real(rk), parameter :: nothing(0) = [real(rk) ::]
      type(links_t) :: links
      real(rk) :: a(5, 5), residual(5), rows(2, 5), rest(2), left(2, 2), step(5), det
      integer(ik), allocatable :: equations(:), unknowns(:)

      ! Equations by columns. 3 and 4 hold nothing but the fourth unknown and, the third, the fifth.
      a(:, 1) = [4.0_rk, -2.0_rk, 1.0_rk, 0.0_rk, 0.0_rk]
      a(:, 2) = [1.0_rk, 3.0_rk, 7.0_rk, -2.0_rk, 1.0_rk]
      a(:, 3) = [0.0_rk, 5.0_rk, -1.0_rk, 0.0_rk, 2.0_rk]
      a(:, 4) = [0.0_rk, 0.0_rk, 0.0_rk, 8.0_rk, 0.0_rk]
      a(:, 5) = [2.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 9.0_rk]
      residual = -matmul(solution, a)
      links = new_links(5_ik)
      call links%link(1_ik, [1_ik, 0_ik], [-0.25_rk, 0.0_rk], [2_ik, 3_ik], [0.5_rk, -0.25_rk])
      call links%link(2_ik, [3_ik, 0_ik], [-0.2_rk, 0.0_rk], [3_ik, 5_ik], [0.2_rk, -0.4_rk])
      call links%link(4_ik, [4_ik, 3_ik], [-0.125_rk, 0.0_rk], none, nothing)
      equations = links%kept_equations()
      unknowns = links%kept_unknowns()
      call checks%is_true(size(equations) == 2 .and. all(equations == [2, 5]), "equations left")
      call checks%is_true(size(unknowns) == 2 .and. all(unknowns == [3, 5]), "unknowns left")
      call links%take_residual(residual)
      rows = transpose(a(:, equations))
      rest = residual(equations)
      call links%reduce(rows, rest)
      left = transpose(rows(:, unknowns))
      det = left(1, 1)*left(2, 2) - left(1, 2)*left(2, 1)
      step(3) = (-rest(1)*left(2, 2) + rest(2)*left(2, 1))/det
      step(5) = (-rest(2)*left(1, 1) + rest(1)*left(1, 2))/det
      call links%complete(step)
      ! The condition of the whole matrix is some tens.
      call checks%is_close(maxval(abs(step - solution)), 0.0_rk, 1.0e-13_rk, "all five")
   end subroutine leaves_and_comes_back

end program test_algebra_links
