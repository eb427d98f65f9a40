!> Elimination of two unknowns that two global ones act on, against the solution by hand.
program test_coarse_elimination
   use base_kinds, only: ik, rk
   use coarse_elimination, only: eliminate, fix_unknown, local_system_t, new_local_system, &
                                 response_t, share_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call eliminates()
   call fixes_unknown()
   call refuses_singular()
   call checks%finish()

contains

   !> M = (2 1; 1 1), C = (1 0; 0 4), R = C, b = (3, 0).
   pure subroutine some_system(local)
      type(local_system_t), intent(out) :: local

      call new_local_system(2_ik, 2_ik, local)
      local%equations(:2, :) = reshape([2.0_rk, 1.0_rk, 1.0_rk, 1.0_rk], [2, 2])
      local%coupling = reshape([1.0_rk, 0.0_rk, 0.0_rk, 4.0_rk], [2, 2])
      local%equations(3:4, :) = local%coupling
      local%equations(5, 1) = 3.0_rk
   end subroutine some_system

   !> The inverse of M is (1 -1; -1 2).
   subroutine eliminates()
      type(local_system_t) :: local
      type(response_t) :: response
      type(share_t) :: share
      integer(ik) :: info
      real(rk) :: y(2)

      call some_system(local)
      call eliminate(local, response, share, info)
      call checks%is_true(info == 0, "a regular system")
      call same(response%matrix, [1.0_rk, -4.0_rk, 3.0_rk, -1.0_rk, 8.0_rk, -3.0_rk], "response")
      call same(share%matrix, [-1.0_rk, 4.0_rk, 4.0_rk, -32.0_rk], "-C' inverse(M) C")
      call same(reshape(share%known, [2, 1]), [3.0_rk, -12.0_rk], "C' inverse(M) b")
      call response%apply([10.0_rk, 1.0_rk], y)
      call same(reshape(y, [2, 1]), [9.0_rk, -5.0_rk], "unknowns from the global ones")
   end subroutine eliminates

   !> With y_1 = 5 the second equation is y_2 = 4 d_2 - 5.
   subroutine fixes_unknown()
      type(local_system_t) :: local
      type(response_t) :: response
      type(share_t) :: share
      integer(ik) :: info

      call some_system(local)
      call fix_unknown(local, 1_ik, 5.0_rk)
      call eliminate(local, response, share, info)
      call same(response%matrix, [0.0_rk, 0.0_rk, 5.0_rk, 0.0_rk, 4.0_rk, -5.0_rk], "y_1 given")
      call same(share%matrix, [0.0_rk, 0.0_rk, 0.0_rk, -16.0_rk], "share with y_1 given")
      call same(reshape(share%known, [2, 1]), [5.0_rk, -20.0_rk], "known with y_1 given")
   end subroutine fixes_unknown

   subroutine refuses_singular()
      type(local_system_t) :: local
      type(response_t) :: response
      type(share_t) :: share
      integer(ik) :: info

      call some_system(local)
      local%equations(:2, :) = 1.0_rk
      call eliminate(local, response, share, info)
      call checks%is_true(info /= 0, "a singular system is reported")
   end subroutine refuses_singular

   subroutine same(matrix, expected, name)
      real(rk), intent(in) :: matrix(:, :)
      real(rk), intent(in) :: expected(:)  !< column by column
      character(len=*), intent(in) :: name

      call checks%is_true(size(matrix) == size(expected), name//": size")
      call checks%is_close(maxval(abs(reshape(matrix, [size(expected)]) - expected)), 0.0_rk, &
                           1.0e-13_rk, name)
   end subroutine same

end program test_coarse_elimination
