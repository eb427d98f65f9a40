!> Windows keep their meshes under small moves of tips that they contain but do not serve: the
!! intensities hardly change; they change as much as they should once the moves are noticeable.
!!
!! One crack of 0.1 m at 45 degrees, closed and slipping, in a body of 2 m; each of its two windows
!! contains all of it.
program test_twolevel_windows
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use growth_network, only: move_end
   use sample_scenes, only: add_fracture, evaluate_initial_state, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   real(rk), parameter :: length = 0.1_rk  !< length of the crack [m]
   type(checks_t) :: checks
   type(timers_t) :: timers
   type(two_levels_t) :: simulation
   real(rk) :: before, place(2)

   call start(simulation)
   before = simulation%tip(2)%intensity%k2
   place = simulation%tip(1)%xy
   call move(simulation, place, 0.5e-3_rk*length)
   call checks%is_true(is_meshed_for(1_ik), "the tip's own window follows it")
   call checks%is_true(.not. is_meshed_for(2_ik), "the other one's stays")
   call checks%is_close(simulation%tip(2)%intensity%k2/before, 1.0_rk, 1.0e-3_rk, "its intensity")
   ! Small moves add up.
   call move(simulation, place, 1.1e-3_rk*length)
   call checks%is_true(is_meshed_for(1_ik) .and. is_meshed_for(2_ik), "noticeable to both")
   ! Longer by 5 %: K_II by 2.5 % without another crack nearby, half of that at the near tip.
   call move(simulation, place, 0.05_rk*length)
   call checks%is_true(is_meshed_for(2_ik), "far")
   call checks%is_close(simulation%tip(2)%intensity%k2/before, sqrt(1.05_rk), 5.0e-3_rk, &
                        "the intensity grows with the crack")
   call test_following()
   call checks%finish()

contains

   !> The mesh of a tip's separate window is moved with the tip along the last segment of its path,
   !! forth and back. The intensity is that of a mesh made for this position.
   subroutine test_following()
      real(rk), parameter :: piece = 0.05_rk*length
      real(rk), parameter :: gains(4) = [-0.4_rk, 0.3_rk, 0.7_rk, 2.5_rk]*piece
      type(two_levels_t), save :: simulation
      real(rk) :: followed, place(2)
      integer(ik) :: k

      call start(simulation, piece)
      place = simulation%tip(1)%xy
      do k = 1, size(gains, kind=ik)
         call move(simulation, place, gains(k))
         followed = simulation%tip(1)%intensity%k2
         call checks%is_true(simulation%windows%slot(1)%window%has_moved .eqv. k < 4, &
                             "it follows, if not too far")
         call simulation%windows%network_changed()
         call move(simulation, place, gains(k))
         call checks%is_true(.not. simulation%windows%slot(1)%window%has_moved, "made again")
         call checks%is_close(followed/simulation%tip(1)%intensity%k2, 1.0_rk, 2.0e-3_rk, &
                              "the intensity of a tip whose window has followed it")
         ! Moved from the first mesh again.
         call simulation%windows%network_changed()
         call move(simulation, place, 0.0_rk)
      end do
   end subroutine test_following

   !> The last segment at the first tip has the prescribed length, or there is only one segment.
   subroutine start(simulation, piece)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in), optional :: piece  !< [m]
      real(rk), parameter :: along = 0.5_rk*length*sqrt(0.5_rk)
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      scene%discretization%size_fracture = 0.02_rk
      scene%discretization%window = 0.4_rk
      if (present(piece)) then
         associate (x => 1.0_rk + along*[-1.0_rk, -1.0_rk + 2.0_rk*piece/length, 1.0_rk])
            call add_fracture(scene, "f", x, x, 0.1_rk, 0.0_rk)
         end associate
      else
         call add_fracture(scene, "f", 1.0_rk + [-along, along], 1.0_rk + [-along, along], 0.1_rk, &
                           0.0_rk)
      end if
      call evaluate_initial_state(scene, simulation, timers, error)
      call checks%no_error(error, "initial state")
   end subroutine start

   !> Move the first tip from its initial position along the crack; the coarse level stays.
   subroutine move(simulation, place, by)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: place(2)  !< initial position [m]
      real(rk), intent(in) :: by  !< [m]
      type(error_t), allocatable :: error

      associate (tip => simulation%tip(1))
         tip%xy = place + by*tip%direction
         call move_end(simulation%network, tip%fracture, tip%end, tip%xy)
      end associate
      call simulation%evaluate(timers, error)
      call checks%no_error(error, "after a move")
   end subroutine move

   !> Whether a window has been meshed for the present position of the first tip.
   logical function is_meshed_for(window)
      integer(ik), intent(in) :: window

      is_meshed_for = .not. norm2(simulation%windows%slot(window)%window%made%place(:, 1) &
                                  - simulation%tip(1)%xy) > 0.0_rk
   end function is_meshed_for

end program test_twolevel_windows
