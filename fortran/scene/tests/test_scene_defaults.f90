!> Defaults that follow from other values: the numbers that they stand for.
program test_scene_defaults
   use base_kinds, only: rk
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, scene_t, time_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call check_fluid()
   call check_mechanics()
   call checks%finish()

contains

   pure function small_scene() result(scene)
      type(scene_t) :: scene

      scene%fractures = [fracture_t(law="slip", x=[0.0_rk, 3.0_rk, 3.0_rk], &
                                    y=[0.0_rk, 4.0_rk, 5.0_rk]), &
                         fracture_t(law="slip", x=[0.0_rk, 1.0_rk], y=[0.0_rk, 0.0_rk], &
                                    slip_taper=0.1_rk), &
                         fracture_t(x=[0.0_rk, 1.0_rk], y=[0.0_rk, 0.0_rk])]
      scene%discretization%size_fracture = 0.25_rk
      scene%discretization%size_boundary = 2.0_rk
      scene%discretization%fine_ratio = 0.5_rk
   end function small_scene

   subroutine check_fluid()
      type(scene_t) :: scene

      scene = small_scene()
      scene%fluid%viscosity = 1.0_rk
      scene%time%end = 9.0_rk
      scene%time%step = 3.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%growth%increment, 0.125_rk, 0.0_rk, "the fine mesh size")
      call checks%is_close(scene%output%interval, 3.0_rk, 0.0_rk, "the regular step")
      call checks%is_close(scene%time%tolerance, 0.0_rk, 0.0_rk, "steps are given")
      scene%growth%enabled = .true.
      call resolve_defaults(scene)
      call checks%is_close(scene%time%tolerance, 0.01_rk, 0.0_rk, "but tips are in equilibrium")
      scene%growth%enabled = .false.
      scene%time = time_t(end=9.0_rk)
      scene%output%interval = 0.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%time%tolerance, 0.01_rk, 0.0_rk, "steps are chosen")
      call checks%is_close(scene%time%smallest_factor, 1.0e-9_rk, 0.0_rk, "down to tiny ones")
      call checks%is_close(scene%output%interval, 0.09_rk, 0.0_rk, "a hundred times")
      scene%output%interval = 5.0_rk
      scene%growth%increment = 0.2_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%growth%increment, 0.2_rk, 0.0_rk, "a given increment stays")
      call checks%is_close(scene%output%interval, 5.0_rk, 0.0_rk, "a given interval stays")
   end subroutine check_fluid

   subroutine check_mechanics()
      type(scene_t) :: scene

      scene = small_scene()
      scene%load%steps = 4
      call resolve_defaults(scene)
      call checks%is_close(scene%time%end, 1.0_rk, 0.0_rk, "the programme takes one unit of time")
      call checks%is_close(scene%time%step, 0.25_rk, 0.0_rk, "a step of it")
      call checks%is_close(scene%growth%increment, 0.25_rk, 0.0_rk, "size_fracture")
      call checks%is_close(scene%discretization%rosette_radius, 0.25_rk, 0.0_rk, "rosette")
      call checks%is_close(scene%fractures(1)%slip_taper, 3.0_rk, 1.0e-15_rk, "half the length")
      call checks%is_close(scene%fractures(2)%slip_taper, 0.1_rk, 0.0_rk, "a given taper stays")
      call checks%is_close(scene%fractures(3)%slip_taper, 0.0_rk, 0.0_rk, "no slip, no taper")
      scene%fractures = scene%fractures(1:0)
      scene%discretization%size_fracture = 0.0_rk
      scene%discretization%rosette_radius = 0.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%rosette_radius, 2.0_rk, 0.0_rk, "no fracture")
   end subroutine check_mechanics

end program test_scene_defaults
