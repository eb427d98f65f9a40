!> Pieces that a mesh has cells for before the tip has gone along them: found by where they begin,
!> each with the tip as it was then, and how long the rest of the path is.
program test_growth_prepared
   use base_kinds, only: ik, rk
   use growth_front, only: prepared_t
   use growth_tip, only: tip_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: within = 1.0e-9_rk
   !> A bent path: pieces of 5, 13 and 2.
   real(rk), parameter :: corner(2, 4) = reshape([0.0_rk, 0.0_rk, 3.0_rk, 4.0_rk, 8.0_rk, 16.0_rk, &
                                                  8.0_rk, 18.0_rk], [2, 4])
   type(checks_t) :: checks
   type(prepared_t) :: prepared
   type(tip_t) :: tip
   integer(ik) :: k

   call checks%is_true(prepared%find(corner(:, 1), within) == 0, "nothing yet")
   call checks%is_close(prepared%length_from(1_ik), 0.0_rk, 0.0_rk, "no length")
   do k = 1, 3
      tip%origin = corner(:, k)
      tip%fracture = 10*k
      call prepared%add(tip, corner(:, k + 1))
   end do
   do k = 1, 3
      call checks%is_true(prepared%find(corner(:, k), within) == k, "where it begins")
      tip = prepared%tip_of(k)
      call checks%is_true(tip%fracture == 10*k, "its tip")
      call checks%is_true(all(abs(prepared%end_of(k) - corner(:, k + 1)) <= 0.0_rk), "its end")
   end do
   call checks%is_true(prepared%find(corner(:, 4), within) == 0, "none at the end")
   call checks%is_close(prepared%length_from(1_ik), 20.0_rk, 1.0e-12_rk, "the whole path")
   call checks%is_close(prepared%length_from(3_ik), 2.0_rk, 1.0e-12_rk, "the last piece")
   call checks%is_close(prepared%length_from(4_ik), 0.0_rk, 0.0_rk, "nothing beyond")
   ! The path is begun anew from a place where it has been before: the later piece counts.
   tip%origin = corner(:, 2)
   call prepared%add(tip, corner(:, 4))
   call checks%is_true(prepared%find(corner(:, 2), within) == 4, "the last that begins there")
   call checks%finish()
end program test_growth_prepared
