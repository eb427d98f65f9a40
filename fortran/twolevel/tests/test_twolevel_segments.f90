!> Tips so near to a target that only a ligament lies between: they join it at once where K_eq
!! exceeds K_IC, and no other tips do.
program test_twolevel_segments
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use growth_network, only: end_place
   use growth_targets, only: target_boundary
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t, time_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   real(rk), parameter :: increment = 0.05_rk  !< l_max [m]
   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_two_bars(0.2e-3_rk)
   call test_tips_of_two()
   call test_side()
   call checks%finish()

contains

   !> Rock that no fluid enters, under low stress, with a well in the first fracture. Fractures that
   !! stick do not deform.
   function injected_body() result(scene)
      type(scene_t) :: scene

      scene = squeezed_body(100.0e6_rk, 2.0e6_rk)
      scene%material%biot = 6.0e-4_rk
      scene%material%porosity = 6.0e-4_rk
      scene%fluid%compressibility = 4.0e-9_rk
      scene%material%permeability_xx = 1.0e-24_rk
      scene%material%permeability_yy = 1.0e-24_rk
      scene%material%toughness = 1.0e6_rk
      scene%growth%enabled = .true.
      scene%growth%increment = increment
      scene%initial%fracture_pressure = "equilibrated"
      scene%time = time_t(end=30.0_rk, tolerance=0.05_rk, smallest_factor=1.0e-9_rk)
      scene%injections = [injection_t(fracture=1, rate=[1.0e-6_rk])]
   end function injected_body

   !> Step until a tip has joined, or for a number of states.
   subroutine march(scene, name, simulation, states)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: name
      type(two_levels_t), intent(out) :: simulation
      integer, intent(out) :: states  !< number of states until a tip has joined; 0: none has
      type(error_t), allocatable :: error
      integer :: k

      states = 0
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, name)
      do k = 1, 80
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) call simulation%grow(timers, error)
         call checks%no_error(error, name//": a step")
         if (allocated(error)) return
       call checks%is_close(max(scene%material%toughness, maxval(simulation%tip%drive%intensity)), &
                              scene%material%toughness, 6.0e-3_rk*scene%material%toughness, &
                              name//": at most the toughness")
         if (.not. any(simulation%tip%joined)) cycle
         states = k
         exit
      end do
      call checks%is_true(states > 0, name//": something has joined")
      call checks%is_close(simulation%now%fluid%mass_error/simulation%now%fluid%injected, 0.0_rk, &
                           1.0e-10_rk, &
                           name//": fluid is conserved")
   end subroutine march

   !> Between two sticking fractures both tips are equal: they join in one step, and the fluid that
   !! the other fractures take lets the pressure decrease below that of the onset, 2 MPa +
   !! K_IC/sqrt(pi a).
   subroutine test_two_bars(gap)
      real(rk), intent(in) :: gap  !< [m]
      real(rk), parameter :: half = 0.2_rk
      type(scene_t) :: scene
      type(two_levels_t) :: simulation
      real(rk) :: s
      integer :: states

      scene = injected_body()
      call add_fracture(scene, "stem", [0.8_rk + gap, 1.2_rk - gap], [1.0_rk, 1.0_rk], 0.5_rk, &
                        0.0_rk)
      call add_fracture(scene, "left", [0.8_rk, 0.8_rk], [0.87_rk, 1.14_rk], 9.0_rk, 0.0_rk)
      call add_fracture(scene, "right", [1.2_rk, 1.2_rk], [0.85_rk, 1.13_rk], 9.0_rk, 0.0_rk)
      call march(scene, "two bars", simulation, states)
      if (states == 0) return
      call checks%is_true(all(simulation%tip(:2)%joined), "both in one step")
      call checks%is_true(all(simulation%tip(:2)%target == [2_ik, 3_ik]), "each its own")
      call checks%is_true(count(simulation%tip%is_free) == 4, "the ends of the bars are tips still")
      call checks%is_close(maxval(abs(end_place(simulation%network, 1_ik, 1_ik) &
                                      - [0.8_rk, 1.0_rk])), 0.0_rk, 0.1_rk*gap, "left joint")
      call checks%is_close(maxval(abs(end_place(simulation%network, 1_ik, 2_ik) &
                                      - [1.2_rk, 1.0_rk])), 0.0_rk, 0.1_rk*gap, "right joint")
      call checks%is_close(simulation%tip(1)%advance, gap, 1.0e-3_rk*gap, "over the gap")
      s = scene%material%toughness/sqrt(pi*(half - gap))
      associate (problem => simulation%problem, state => simulation%now%coarse)
         call checks%is_true(problem%well_pressure(state) < 2.0e6_rk + s, &
                             "the pressure falls")
      end associate
   end subroutine test_two_bars

   !> End to end: one tip joins the other, which is deactivated.
   subroutine test_tips_of_two()
      type(scene_t) :: scene
      type(two_levels_t), save :: simulation
      integer :: states

      scene = injected_body()
      scene%sides(2)%traction(1) = -4.0e6_rk
      call add_fracture(scene, "stem", [0.8_rk, 1.1999_rk], [1.0_rk, 1.0_rk], 0.5_rk, 0.0_rk)
      call add_fracture(scene, "next", [1.2_rk, 1.4_rk], [1.0_rk, 1.02_rk], 0.5_rk, 0.0_rk)
      call march(scene, "end to end", simulation, states)
      if (states == 0) return
      call checks%is_true(count(simulation%tip%is_free) == 2, "two tips are left")
   end subroutine test_tips_of_two

   !> A side of the body.
   subroutine test_side()
      type(scene_t) :: scene
      type(two_levels_t), save :: simulation
      integer :: states

      scene = injected_body()
      call add_fracture(scene, "stem", [1.6_rk, 1.9995_rk], [1.0_rk, 1.0_rk], 0.5_rk, 0.0_rk)
      call march(scene, "a side", simulation, states)
      if (states == 0) return
      call checks%is_true(any(simulation%tip%target == target_boundary), "the side")
      call checks%is_close(maxval(abs(end_place(simulation%network, 1_ik, 2_ik) &
                                      - [2.0_rk, 1.0_rk])), 0.0_rk, 1.0e-4_rk, "straight ahead")
   end subroutine test_side

end program test_twolevel_segments
