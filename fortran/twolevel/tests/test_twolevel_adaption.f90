!> The coarse mesh before the first step, adapted to the response to a well: refined until the
!! estimated error is below the tolerance, coarsened where it is far below, the same where nothing
!! is to be gained; the state is that before the load.
program test_twolevel_adaption
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   type(checks_t) :: checks
   integer(ik) :: coarse, given

   given = cells_for(0.05_rk, 0.4_rk, 0.0_rk)
   call checks%is_true(cells_for(0.05_rk, 0.4_rk, 0.6_rk) > given, "refined")
   coarse = cells_for(0.01_rk, 0.1_rk, 0.6_rk)
   call checks%is_true(3*coarse < 2*cells_for(0.01_rk, 0.1_rk, 0.0_rk), "coarsened")
   call checks%is_true(cells_for(0.05_rk, 0.4_rk, 1.0_rk) == given, "nothing to be gained")
   call checks%finish()

contains

   !> Number of cells after the start of a scene with one well.
   function cells_for(size_fracture, size_boundary, tolerance) result(cells)
      real(rk), intent(in) :: size_fracture, size_boundary  !< [m]
      real(rk), intent(in) :: tolerance  !< 0: not adaptive [-]
      integer(ik) :: cells
      type(scene_t) :: scene
      type(two_levels_t) :: simulation
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      call add_fracture(scene, "f1", [0.85_rk, 1.15_rk], [0.9_rk, 1.1_rk], 0.5_rk, 0.02_rk)
      scene%injections = [injection_t(fracture=1_ik, rate=[1.0e-7_rk])]
      scene%growth%intensities = .false.
      scene%discretization%size_fracture = size_fracture
      scene%discretization%size_boundary = size_boundary
      scene%adaptive%enabled = tolerance > 0.0_rk
      scene%adaptive%tolerance = tolerance
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "start")
      cells = simulation%problem%mesh%n_cells
      call checks%is_close(maxval(abs(simulation%now%coarse%jump)), 0.0_rk, tiny(1.0_rk), &
                           "no load yet")
      call checks%is_close(simulation%time(), 0.0_rk, tiny(1.0_rk), "time")
      if (.not. scene%adaptive%enabled) return
      call checks%is_true(simulation%summary%energy_error > 0.0_rk, "the error is estimated")
      call checks%is_true(simulation%summary%energy_error <= tolerance, "within the tolerance")
      call simulation%next_state(timers, error)
      call checks%no_error(error, "first state")
      call simulation%next_state(timers, error)
      call checks%no_error(error, "first step")
      call checks%is_true(simulation%time() > 0.0_rk, "a step of the well")
   end function cells_for

end program test_twolevel_adaption
