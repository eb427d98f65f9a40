!> Defaults that follow from other values: the numbers that they stand for.
program test_scene_defaults
   use base_kinds, only: rk
   use scene_namelist, only: resolve_defaults
   use scene_types, only: domain_t, fracture_t, scene_t, time_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(scene_t) :: scene

   call check_fluid()
   call check_mechanics()
   call check_sizes()
   call check_windows()
   call check_bodies_of_windows()
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

   !> Straight fractures of given lengths in a body of 400 m, with a fluid and growth.
   pure function growing(lengths) result(scene)
      real(rk), intent(in) :: lengths(:)  !< [m]
      type(scene_t) :: scene
      integer :: i

      scene%fractures = [(fracture_t(x=[100.0_rk, 100.0_rk + lengths(i)], &
                                     y=[10.0_rk*i, 10.0_rk*i]), i=1, size(lengths))]
      scene%domain = domain_t(x_max=400.0_rk, y_max=400.0_rk)
      scene%fluid%viscosity = 1.0_rk
      scene%time%end = 9.0_rk
      scene%growth%enabled = .true.
      scene%growth%intensities = .true.
   end function growing

   !> Cells and increments follow from the length of each fracture and the tolerance.
   subroutine check_sizes()
      integer :: i

      scene = growing([20.0_rk])
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%size_fracture, 1.0_rk, 1.0e-15_rk, "20 cells")
      call checks%is_close(scene%discretization%size_boundary, 20.0_rk, 1.0e-14_rk, &
                           "a 20th of the body")
      call checks%is_close(scene%growth%increment, 0.5_rk, 1.0e-15_rk, "half a cell")
      call checks%is_close(scene%discretization%window, 100.0_rk, 1.0e-13_rk, "5 lengths")
      call checks%is_close(scene%fractures(1)%cell_size, 0.0_rk, 0.0_rk, "none of its own")
      scene = growing([0.1_rk, 50.0_rk])
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%size_fracture, 0.005_rk, 1.0e-15_rk, "the least")
      call checks%is_close(scene%cell_size_of(2), 2.5_rk, 1.0e-14_rk, "cells of the other one")
      call checks%is_close(scene%increment_of(1), 0.0025_rk, 1.0e-15_rk, "increments of one")
      call checks%is_close(scene%increment_of(2), 1.25_rk, 1.0e-14_rk, "increments of the other")
      call checks%is_close(scene%window_of(1), 0.5_rk, 1.0e-12_rk, "window of one")
      call checks%is_close(scene%window_of(2), 120.0_rk, 1.0e-13_rk, "0.3 of the body")
      scene = growing([4.0_rk])
      scene%domain%x_min = scene%fractures(1)%x(1)
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%window, 40.0_rk, 1.0e-13_rk, &
                           "10 lengths of a fracture that ends on a side")
      scene = growing([20.0_rk])
      scene%time%tolerance = 0.02_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%size_fracture, 2.0_rk, 1.0e-15_rk, &
                           "errors are of first order in the size of cells")
      scene = growing([20.0_rk])
      scene%time%tolerance = 0.5_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%size_fracture, 2.0_rk, 1.0e-15_rk, "10 at least")
      scene = growing([(20.0_rk, i=1, 25)])
      call resolve_defaults(scene)
      call checks%is_close(scene%discretization%size_fracture, 1.25_rk, 1.0e-15_rk, "400 in all")
      scene = growing([20.0_rk, 4.0_rk])
      scene%discretization%size_fracture = 0.8_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%cell_size_of(1), 0.8_rk, 0.0_rk, "a given size is that of all")
      call checks%is_close(scene%increment_of(2), 0.4_rk, 1.0e-15_rk, "and its increment")
      scene = growing([20.0_rk])
      scene%fluid%viscosity = 0.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%growth%increment, 1.0_rk, 1.0e-15_rk, "mechanics: an element")
      call checks%is_close(scene%discretization%rosette_radius, 1.0_rk, 1.0e-15_rk, "its rosette")
   end subroutine check_sizes

   !> Given windows stay; what is given of one fracture is only its own.
   subroutine check_windows()
      scene = growing([20.0_rk, 4.0_rk])
      scene%discretization%window = 60.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%window_of(1), 60.0_rk, 0.0_rk, "a given window is that of all")
      scene = growing([20.0_rk, 4.0_rk])
      scene%fractures(2)%window = 30.0_rk
      call resolve_defaults(scene)
      call checks%is_close(scene%window_of(1), 100.0_rk, 1.0e-13_rk, "the default of the one")
      call checks%is_close(scene%window_of(2), 30.0_rk, 0.0_rk, "what is given for the other")
   end subroutine check_windows

   !> The body is the window where squares would be too large together, or cannot be.
   subroutine check_bodies_of_windows()
      integer :: i

      scene = growing([(20.0_rk, i=1, 9)])  ! 18 squares of 100 m
      call resolve_defaults(scene)
      call checks%is_true(scene%discretization%window_is_body, "many fractures")
      scene = growing([100.0_rk])
      call resolve_defaults(scene)
      call checks%is_true(scene%discretization%window_is_body, "a fracture as large as the body")
      scene = growing([20.0_rk])
      scene%domain%shape = "disc"
      call resolve_defaults(scene)
      call checks%is_true(scene%discretization%window_is_body, "a disc")
      scene = growing([20.0_rk])
      scene%growth%intensities = .false.
      call resolve_defaults(scene)
      call checks%is_true(.not. (scene%discretization%window_is_body .or. &
                                 scene%discretization%window > 0.0_rk), "no tips, no windows")
   end subroutine check_bodies_of_windows

end program test_scene_defaults
