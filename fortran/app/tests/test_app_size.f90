!> Sizes of scenes, and those that no machine or not this one can hold: refused with the number.
program test_app_size
   use app_size, only: check_size, estimate_t, size_of_scene
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_sheet, only: sheet_t
   use scene_test_files, only: delete_file, put_lines
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_app_size.nml"
   real(rk), parameter :: memory = 16.0e9_rk  ! [byte]
   type(checks_t) :: checks

   call check_uniform()
   call check_graded()
   call check_limits()
   call delete_file(path)
   call checks%finish()

contains

   !> Cells of one size: the body's area over that of an equilateral triangle.
   subroutine check_uniform()
      type(scene_t) :: scene
      type(sheet_t) :: sheet
      type(estimate_t) :: estimate

      call read_wet("0.1", "0.1", "end=3600 step=60", scene, sheet)
      estimate = size_of_scene(scene)
      call checks%is_close(estimate%cells, anint(2.0_rk*4.0_rk/sqrt(3.0_rk)*100.0_rk), 0.0_rk, &
                           "cells")
      call checks%is_close(estimate%fracture_cells, 2.0_rk, 0.0_rk, "fracture cells")
      call checks%is_close(estimate%steps, 60.0_rk, 0.0_rk, "steps")
      call read_wet("0.1", "0.1", "end=3601 step=60", scene, sheet)
      estimate = size_of_scene(scene)
      call checks%is_close(estimate%steps, 61.0_rk, 0.0_rk, "a last step that is short")
   end subroutine check_uniform

   !> A long fracture with very small cells: about 4/sqrt(3) 2 L/(slope h) of them are near it.
   subroutine check_graded()
      type(scene_t) :: scene
      type(sheet_t) :: sheet
      type(estimate_t) :: estimate
      real(rk) :: slope, expected

      call read_wet("1e-6", "0.1", "end=3600 step=60", scene, sheet)
      estimate = size_of_scene(scene)
      slope = 0.1_rk/(0.25_rk*sqrt(5.0_rk))
      expected = 4.0_rk/sqrt(3.0_rk)*2.0_rk*0.2_rk/(slope*1.0e-6_rk)
      call checks%is_close(estimate%cells, expected, 0.05_rk*expected, "graded cells")
   end subroutine check_graded

   subroutine check_limits()
      call read_and_judge("0.01", "0.1", "end=3600 step=60", "")
      call read_and_judge("0.01", "0.1", "end=1e12 step=1e-3", "7: &time: step asks for about "// &
                          "1000000000000000 steps, and a run counts up to 2150000000")
      call read_and_judge("0.01", "0.1", "end=1e9 step=1", "7: &time: step asks for about "// &
                          "1000000000 steps; their tables need at least 4300 GB")
      call read_and_judge("1e-7", "1e-7", "end=60 step=60", "8: &coarse: the sizes ask for "// &
                          "about 462000000000000 cells, and a run numbers up to 10700000")
      call read_and_judge("1e-3", "1e-3", "end=60 step=60", "8: &coarse: the sizes ask for "// &
                          "about 4620000 cells and 13900000 unknowns, which need at least 37 "// &
                          "GB of memory, and this machine has 16: give larger ones")
      call read_and_judge("2e-5", "0.1", "end=60 step=60", "")
      call read_and_judge("2e-5", "0.1 condensation='full'", "end=60 step=60", &
                          "8: &coarse: size_fracture asks for about 10000 fracture cells, "// &
                          "which need at least")
      call read_and_judge("1e-7", "0.1", "end=60 step=60", "8: &coarse: the sizes ask for about")
   end subroutine check_limits

   subroutine read_and_judge(near, far, times, words)
      character(len=*), intent(in) :: near, far, times
      character(len=*), intent(in) :: words  !< of the refusal; empty: there is none
      type(scene_t) :: scene
      type(sheet_t) :: sheet
      type(error_t), allocatable :: error

      call read_wet(near, far, times, scene, sheet)
      call check_size(sheet, scene, memory, error)
      if (words == "") then
         call checks%no_error(error, "a scene of usual size")
      else
         call checks%fails_with(error, path//":"//words, "sizes "//near//", "//far//", "//times)
      end if
   end subroutine read_and_judge

   !> A body of 2 m x 1 m with a fracture of 0.2 m.
   subroutine read_wet(near, far, times, scene, sheet)
      character(len=*), intent(in) :: near, far  !< size_fracture, size_boundary [m]
      character(len=*), intent(in) :: times  !< content of &time
      type(scene_t), intent(out) :: scene
      type(sheet_t), intent(out) :: sheet
      type(error_t), allocatable :: error

      call put_lines(path, [character(len=100) :: &
                            "&domain x_min=0 x_max=2 y_min=0 y_max=1 /", &
                            "&material young=4e10 poisson=0.2 biot=0.8 porosity=0.01", &
                            "  permeability=5e-20 /", &
                            "&fluid compressibility=4e-10 viscosity=1e-4 /", &
                            "&fracture name='f' x=0.9, 1.1 y=2*0.5 friction=0.5 aperture=1e-3 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /", &
                            "&time "//times//" /", &
                            "&coarse size_fracture="//near//" size_boundary="//far//" /"])
      call read_scene(path, scene, error, sheet)
      call checks%no_error(error, "the scene is read")
   end subroutine read_wet

end program test_app_size
