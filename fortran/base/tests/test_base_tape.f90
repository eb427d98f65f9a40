!> Decisions are recorded, taken from a record, and both.
program test_base_tape
   use base_kinds, only: ik, rk
   use base_tape, only: tape_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(tape_t) :: recorder, follower
   logical :: moves(2)
   integer(ik) :: n
   real(rk) :: x(2), recorded(2)

   moves = [.true., .false.]
   n = 7
   x = [1.0_rk, 2.0_rk]
   call recorder%keep("moves", moves)
   call checks%is_true(size(recorder%bytes()) == 0, "a tape that is off records nothing")
   recorder%is_recording = .true.
   call recorder%begin()
   call recorder%keep("moves", moves)
   call recorder%mark()
   call recorder%keep("discarded", n)
   call recorder%rewind()
   call recorder%keep("n", n)
   call recorder%compare("x", x, recorded)
   call checks%is_true(all(abs(recorded - x) <= 0.0_rk), "without a record values are their own")

   follower%is_recording = .true.
   call follower%begin()
   call follower%follow(recorder%bytes())
   moves = .false.
   n = 0
   x = 3.0_rk
   call follower%keep("moves", moves)
   call follower%keep("n", n)
   call follower%compare("x", x, recorded)
   call checks%is_true(all(moves .eqv. [.true., .false.]) .and. n == 7, "decisions are taken")
   call checks%is_true(all(abs(recorded - [1.0_rk, 2.0_rk]) <= 0.0_rk) .and. &
                       all(abs(x - 3.0_rk) <= 0.0_rk), "compared values are kept")
   call checks%is_true(follower%is_at_end() .and. .not. follower%fault(), "the record has ended")

   call follower%follow(recorder%bytes())
   n = 5
   call follower%keep("joins", n)
   call checks%is_true(follower%fault() .and. n == 5, "another decision is a fault, and stays free")
   call checks%finish()
end program test_base_tape
