!> The record of jumps: linear between its points, silent beyond them.
program test_twolevel_jumps
   use testing_checks, only: checks_t
   use base_kinds, only: ik, rk
   use twolevel_jumps, only: jump_record_t, recall_jump
   implicit none(type, external)

   type(checks_t) :: checks
   type(jump_record_t) :: record
   real(rk) :: ignored(2)
   logical :: found

   call recall_jump(record, 1_ik, 0.0_rk, ignored, found)
   call checks%is_true(.not. found, "nothing is on record")
   ! Out of order, each point twice as two cells report it; fracture 1 has grown at its start.
   record%fracture = [1_ik, 2_ik, 1_ik, 1_ik, 2_ik, 1_ik]
   record%s = [0.5_rk, 0.5_rk, -0.5_rk, 0.5_rk, 1.5_rk, 0.0_rk]
   record%jump = reshape([3.0_rk, 1.0_rk, 9.0_rk, 9.0_rk, 0.0_rk, 0.0_rk, 3.0_rk, 1.0_rk, &
                          8.0_rk, 8.0_rk, 2.0_rk, -1.0_rk], [2, 6])
   call recall(1_ik, 0.0_rk, [2.0_rk, -1.0_rk], "at a point")
   call recall(1_ik, 0.5_rk, [3.0_rk, 1.0_rk], "at a point on record twice")
   call recall(1_ik, 0.25_rk, [2.5_rk, 0.0_rk], "between points")
   call recall(1_ik, -0.4_rk, [0.4_rk, -0.2_rk], "below zero")
   call recall(2_ik, 1.0_rk, [8.5_rk, 8.5_rk], "on another fracture")
   call recall(1_ik, 0.5_rk + 1.0e-12_rk, [3.0_rk, 1.0_rk], "at the end, up to rounding")
   call is_unknown(1_ik, 0.51_rk, "beyond the end")
   call is_unknown(1_ik, -0.51_rk, "before the start")
   call is_unknown(2_ik, 0.0_rk, "before the start of the other one")
   call is_unknown(3_ik, 0.0_rk, "a fracture without record")
   call checks%finish()

contains

   subroutine recall(fracture, s, expected, name)
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s, expected(2)
      character(len=*), intent(in) :: name
      real(rk) :: jump(2)

      call recall_jump(record, fracture, s, jump, found)
      call checks%is_true(found, name//": found")
      call checks%is_close(maxval(abs(jump - expected)), 0.0_rk, 1.0e-14_rk, name)
   end subroutine recall

   subroutine is_unknown(fracture, s, name)
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s
      character(len=*), intent(in) :: name

      call recall_jump(record, fracture, s, ignored, found)
      call checks%is_true(.not. found, name//": not found")
   end subroutine is_unknown

end program test_twolevel_jumps
