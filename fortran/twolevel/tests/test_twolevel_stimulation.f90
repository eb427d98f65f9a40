!> Effects of an injection on fractures, over whole scenes with growth: distribution of the fluid,
!! stimulated and connected fractures, and slip events that contain all slip.
program test_twolevel_stimulation
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use growth_network, only: total_length
   use report_rows, only: history_row_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   real(rk), parameter :: rate = 1.0e-7_rk  !< [m2/s]
   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_growth("equilibrium")
   call test_growth("paris")
   call test_joint()
   call test_before_the_well()
   call checks%finish()

contains

   !> A fracture at 45 degrees that slips and grows, supplied along its whole length; another one
   !! far away that does not change; the right side is drained.
   function growing_scene() result(scene)
      type(scene_t) :: scene

      scene = squeezed_body(20.0e6_rk, 8.0e6_rk)
      scene%sides(2)%pressure_given = .true.
      scene%sides(2)%pressure = 6.0e6_rk
      scene%material%toughness = 1.0e6_rk
      scene%discretization%newton_tolerance = 1.0e-12_rk
      scene%growth%enabled = .true.
      scene%growth%increment = 0.04_rk
      scene%time%step = 100.0_rk
      scene%output%stimulated_jump = 1.0e-6_rk
      call add_fracture(scene, "fed", [0.85_rk, 1.15_rk], [0.85_rk, 1.15_rk], 0.3_rk, 0.01_rk)
      call add_fracture(scene, "far", [0.2_rk, 0.5_rk], [1.8_rk, 1.8_rk], 2.0_rk, 0.0_rk)
      scene%injections = [injection_t(fracture=1, rate=[rate])]
   end function growing_scene

   !> Next state, with its growth.
   subroutine go_on(simulation, error)
      type(two_levels_t), intent(inout) :: simulation
      type(error_t), allocatable, intent(out) :: error

      call simulation%next_state(timers, error)
      if (.not. allocated(error)) call simulation%grow(timers, error)
   end subroutine go_on

   !> The fluid volumes add up; lengths are those of the network; events contain all slip.
   subroutine test_growth(law)
      character(len=*), intent(in) :: law
      type(scene_t) :: scene
      type(two_levels_t) :: simulation
      type(history_row_t) :: first, row
      type(error_t), allocatable :: error
      real(rk) :: whole
      integer :: step

      scene = growing_scene()
      scene%growth%law = law
      scene%initial%fracture_pressure = "equilibrated"
      if (law == "paris") scene%growth%new_volume = "prefilled"
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, law//": begin")
      do step = 1, 10
         call simulation%next_state(timers, error)
         call checks%no_error(error, law//": a state")
         if (allocated(error)) return
         row = simulation%history()
         if (step == 1) then
            first = row
            call checks%is_close(maxval(abs([row%injection_rate, row%injectivity, &
                                             row%fracture_fluid, row%rock_fluid, &
                                             row%stimulated_length])), 0.0_rk, 0.0_rk, &
                                 law//": nothing has happened")
         end if
         call simulation%grow(timers, error)
         call checks%no_error(error, law//": growth")
         if (allocated(error)) return
      end do
      whole = total_length(simulation%network)
      call checks%is_true(whole > total_length(simulation%start) + 0.1_rk, law//": there is growth")
      call checks%is_close(row%fracture_fluid + row%rock_fluid + row%rock_outflow + row%outflow, &
                           row%injected + row%prefilled, 1.0e-10_rk*row%injected, &
                           law//": fluid in fractures, in rock and gone is what was given")
      call checks%is_close(row%rock_fluid + row%rock_outflow, row%leakoff, &
                           1.0e-10_rk*row%injected, law//": the rock's is what leaked off")
      call checks%is_true(abs(row%rock_outflow) > 1.0e-3_rk*row%injected, law//": the side drains")
      call checks%is_close(row%injection_rate, rate, 1.0e-15_rk*rate, law//": rate")
      call checks%is_true(row%n_clusters == 2, law//": two groups")
      call checks%is_close(row%connections_per_branch, 0.0_rk, 0.0_rk, law//": no connections")
      if (law == "equilibrium") then
         call checks%is_close(row%connected_length, whole - 0.3_rk, 1.0e-9_rk, &
                              "the fed fracture with its wings is connected")
         call checks%is_close(row%stimulated_length, whole - 0.3_rk, 1.0e-9_rk, &
                              "and stimulated")
      end if
      call checks%is_close(row%connected_stimulated, row%connected_length, 1.0e-9_rk, &
                           law//": all that is connected is stimulated")
      call simulation%end_slip()
      associate (events => simulation%chronicle%slip_events)
         call checks%is_true(all(events%fracture == 1), law//": the other one has no event")
         call checks%is_close(sum(events%moment), row%seismic_moment - first%seismic_moment, &
                              1.0e-9_rk*row%seismic_moment, law//": events hold all slip")
      end associate
      print "(2a,2f8.4,a,es9.2,a,i0)", law, ": connected, stimulated [m]", row%connected_length, &
         row%stimulated_length, ", fluid error/injected", (row%fracture_fluid + row%rock_fluid &
                    + row%rock_outflow + row%outflow - row%injected - row%prefilled)/row%injected, &
         ", events ", size(simulation%chronicle%slip_events)
   end subroutine test_growth

   !> A bar with a stem, and a separate fracture: the position of the well determines the connected
   !! part.
   subroutine test_joint()
      real(rk), parameter :: connected(3) = [0.7_rk, 0.7_rk, 0.3_rk]
      integer :: well

      do well = 1, 3
         call test_well(well, connected(well))
      end do
   end subroutine test_joint

   subroutine test_well(well, connected)
      integer, intent(in) :: well  !< fracture that the well supplies
      real(rk), intent(in) :: connected  !< [m]
      type(scene_t) :: scene
      type(two_levels_t) :: simulation
      type(history_row_t) :: row
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 20.0e6_rk)
      scene%growth%intensities = .false.
      call add_fracture(scene, "bar", [0.5_rk, 0.9_rk], [1.0_rk, 1.0_rk], 1.0_rk, 0.0_rk)
      call add_fracture(scene, "stem", [0.7_rk, 0.7_rk], [1.3_rk, 1.0_rk], 1.0_rk, 0.0_rk)
      call add_fracture(scene, "alone", [1.2_rk, 1.5_rk], [1.0_rk, 1.0_rk], 1.0_rk, 0.0_rk)
      scene%injections = [injection_t(fracture=well, rate=[1.0e-8_rk])]
      call simulation%begin(scene, timers, error)
      if (.not. allocated(error)) call go_on(simulation, error)
      if (.not. allocated(error)) call go_on(simulation, error)
      call checks%no_error(error, "joint")
      if (allocated(error)) return
      row = simulation%history()
      call checks%is_close(row%connected_length, connected, 1.0e-12_rk, "connected")
      call checks%is_close(row%connected_stimulated, 0.0_rk, 0.0_rk, "nothing has moved")
      call checks%is_true(row%n_clusters == 2, "two groups")
      ! Branches: two halves of the bar, stem, the third: 3 connected ends of 8.
      call checks%is_close(row%connections_per_branch, 0.75_rk, 1.0e-15_rk, "C_B")
   end subroutine test_well

   !> Before a well starts nothing is injected; the pressure rises later only.
   subroutine test_before_the_well()
      type(scene_t) :: scene
      type(two_levels_t), save :: simulation
      type(history_row_t) :: row
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 20.0e6_rk)
      scene%growth%intensities = .false.
      call add_fracture(scene, "f", [0.8_rk, 1.2_rk], [1.0_rk, 1.0_rk], 1.0_rk, 0.0_rk)
      scene%injections = [injection_t(fracture=1, rate=[rate], start=60.0_rk, end=120.0_rk)]
      scene%initial%fracture_pressure = "undrained"  ! the first state comes with the first step
      call simulation%begin(scene, timers, error)
      if (.not. allocated(error)) call go_on(simulation, error)
      call checks%no_error(error, "before the well")
      if (allocated(error)) return
      row = simulation%history()
      call checks%is_close(row%injection_rate, 0.0_rk, 0.0_rk, "no rate yet")
      call checks%is_close(row%injectivity, 0.0_rk, 0.0_rk, "nor injectivity")
      call go_on(simulation, error)
      call checks%no_error(error, "with the well")
      row = simulation%history()
      call checks%is_close(row%injection_rate, rate, 1.0e-15_rk*rate, "the rate then")
      call checks%is_true(row%injectivity > 0.0_rk .and. row%injectivity < huge(1.0_rk), &
                          "and an injectivity")
   end subroutine test_before_the_well

end program test_twolevel_stimulation
