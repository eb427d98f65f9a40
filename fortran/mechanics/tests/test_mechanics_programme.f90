!> The programme of the load: its pieces and steps, loads that fall on the way, what is done of it.
program test_mechanics_programme
   use base_kinds, only: ik, rk
   use mechanics_programme, only: programme_t, strongest
   use scene_types, only: load_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call check_straight()
   call check_cycle()
   call check_first_factor()
   call checks%is_close(strongest(load_t(factors=[0.5_rk, -2.0_rk]), 1.0_rk), -2.0_rk, 0.0_rk, &
                        "the largest factor, whatever its sign")
   call checks%is_close(strongest(load_t(), 1.5_rk), 1.5_rk, 0.0_rk, "no factors")
   call checks%finish()

contains

   !> From one factor to another one in steps; a factor that has fallen is taken up again.
   subroutine check_straight()
      type(programme_t) :: programme

      call programme%begin(load_t(from=1.0_rk, to=3.0_rk, steps=4_ik))
      call at(programme, 1.5_rk, [1.0_rk, 3.0_rk], 0.0_rk, 1.0_rk, "first step")
      call checks%is_true(programme%not_reached() == "", "straight: no table, no words")
      call programme%advance(1.5_rk)
      call at(programme, 2.0_rk, [1.0_rk, 3.0_rk], 0.25_rk, 1.5_rk, "second step")
      call programme%advance(2.7_rk)
      call at(programme, 3.0_rk, [1.0_rk, 3.0_rk], 0.85_rk, 2.7_rk, "beyond the third one")
      call programme%advance(1.2_rk)
      call at(programme, 1.5_rk, [1.0_rk, 3.0_rk], 0.1_rk, 1.2_rk, "it has fallen")
      call checks%is_true(.not. programme%is_over(), "straight: not over")
      call programme%advance(3.0_rk)
      call checks%is_true(programme%is_over(), "straight: over")
      call checks%is_close(programme%share_done(3.0_rk), 1.0_rk, 0.0_rk, "straight: all is done")
      call programme%advance(3.0_rk)
      call checks%is_true(programme%is_over(), "straight: over for good")
   end subroutine check_straight

   !> To and fro: each piece in steps of its own, its equilibria bounded by all before.
   subroutine check_cycle()
      type(programme_t) :: programme

      call programme%begin(load_t(factors=[1.0_rk, 0.4_rk, 1.2_rk, -0.5_rk], steps=2_ik))
      call at(programme, 0.5_rk, [0.0_rk, 1.0_rk], 0.0_rk, 0.0_rk, "up")
      call programme%advance(0.5_rk)
      call at(programme, 1.0_rk, [0.0_rk, 1.0_rk], 0.125_rk, 0.5_rk, "up, second step")
      call programme%advance(1.0_rk)
      call at(programme, 0.7_rk, [1.0_rk, 0.4_rk], 0.25_rk, 1.0_rk, "down")
      call checks%is_true(programme%not_reached() == ", and 3 of the scene's load factors "// &
                          "were not reached", "cycle: what is left")
      call programme%advance(0.4_rk)
      call at(programme, 0.8_rk, [0.0_rk, 1.2_rk], 0.5_rk, 0.4_rk, "up again")
      call programme%advance(1.2_rk)
      call at(programme, 0.35_rk, [1.2_rk, -0.5_rk], 0.75_rk, 1.2_rk, "down again")
      call checks%is_true(programme%not_reached() == ", and the scene's last load factor was "// &
                          "not reached", "cycle: the last one is left")
      call programme%advance(-0.5_rk)
      call checks%is_true(programme%not_reached() == "", "cycle: nothing is left")
      call checks%is_true(programme%is_over(), "cycle: over")
   end subroutine check_cycle

   !> A first factor that is the one before it is a state of its own, in one step.
   subroutine check_first_factor()
      type(programme_t) :: programme

      call programme%begin(load_t(factors=[0.0_rk, 1.0_rk], steps=3_ik))
      call at(programme, 0.0_rk, [0.0_rk, 0.0_rk], 0.0_rk, 0.0_rk, "where it begins")
      call programme%advance(0.0_rk)
      call at(programme, 1.0_rk/3.0_rk, [0.0_rk, 1.0_rk], 0.5_rk, 0.0_rk, "from there")
   end subroutine check_first_factor

   !> What a programme aims at, between which bounds, and what is done of it.
   subroutine at(programme, target, bounds, share, factor, name)
      type(programme_t), intent(in) :: programme
      real(rk), intent(in) :: target, bounds(2), share  !< [-]
      real(rk), intent(in) :: factor  !< of the state that it stands at [-]
      character(len=*), intent(in) :: name
      real(rk), parameter :: rounding = 1.0e-14_rk

      call checks%is_close(programme%target(), target, rounding, name//": target")
      call checks%is_close(maxval(abs(programme%bounds() - bounds)), 0.0_rk, 0.0_rk, &
                           name//": bounds")
      call checks%is_close(programme%share_done(factor), share, rounding, name//": share")
   end subroutine at

end program test_mechanics_programme
