!> Tests of report_network: changes are kept with their times, joints with the time they were first
!! seen.
program test_report_network
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_texts, only: text_t
   use mesh_types, only: fracture_mesh_t, network_t, point_boundary, point_interior, &
                         point_joint_t, point_tip
   use report_files, only: make_directory, remove_file
   use report_network, only: network_record_t
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   character(len=*), parameter :: folder = "test_report_network.out"
   character(len=*), parameter :: path = folder//"/network.json"
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(network_record_t) :: record
   type(network_t) :: network
   type(fracture_mesh_t) :: mesh
   character(len=:), allocatable :: text
   logical :: was_there

   call make_directory(folder, error)
   call remove_file(path, was_there)
   call record%open(path, [text_t("main"), text_t("side")], has_fluid=.true.)
   call record%flush(error)
   call checks%is_true(.not. file_exists(path), "without a network there is no file")

   ! Fracture 1 comes from the boundary and ends in a tip at (1, 0); fracture 2 stands above it.
   network = network_t([1_ik, 3_ik, 5_ik], reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, &
      & 1.5_rk, 1.0_rk, 1.5_rk, 0.25_rk], [2, 4]), [0.0_rk, 0.0_rk])
   mesh%n_points = 4
   mesh%n_cells = 2
   mesh%cell_fracture = [1_ik, 2_ik]
   mesh%point_xy = network%xy
   mesh%point_kind = [point_boundary, point_tip, point_tip, point_tip]
   mesh%point_cells%first = [1_ik, 2_ik, 3_ik, 4_ik, 5_ik]
   mesh%point_cells%item = [1_ik, 1_ik, 2_ik, 2_ik]
   mesh%n_tips = 3
   mesh%tip_point = [2_ik, 3_ik, 4_ik]
   mesh%tip_fracture = [1_ik, 2_ik, 2_ik]
   mesh%tip_end = [2_ik, 1_ik, 2_ik]
   mesh%tip_direction = reshape([1.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, -1.0_rk], [2, 3])
   call record%step(0.0_rk, network, mesh)
   call record%step(1.0_rk, network, mesh)
   call record%flush(error)
   call checks%no_error(error, "the first network")
   text = file_text(path)
   call checks%is_true(occurrences("time_s") == 2, "one step and one joint: no change, no step")
   call has('"kind": "boundary"')
   call has('"length_m": 0.75')
   call has('"name": "side"')

   ! Fracture 2 grows down to the line of fracture 1, which grows to meet it: a T joint at (1.5, 0).
   network = network_t([1_ik, 4_ik, 7_ik], reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, &
      & 0.0_rk, 1.5_rk, 1.0_rk, 1.5_rk, 0.25_rk, 1.5_rk, 0.0_rk], [2, 6]), [0.0_rk, 0.0_rk])
   mesh%n_points = 6
   mesh%n_cells = 5
   mesh%cell_fracture = [1_ik, 1_ik, 1_ik, 2_ik, 2_ik]
   mesh%point_xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.5_rk, 0.0_rk, 2.0_rk, 0.0_rk, &
      & 1.5_rk, 1.0_rk, 1.5_rk, 0.25_rk], [2, 6])
   mesh%point_kind = [point_boundary, point_interior, point_joint_t, point_tip, point_tip, &
      & point_interior]
   mesh%point_cells%first = [1_ik, 2_ik, 4_ik, 7_ik, 8_ik, 9_ik, 11_ik]
   mesh%point_cells%item = [1_ik, 1_ik, 2_ik, 2_ik, 3_ik, 5_ik, 3_ik, 4_ik, 4_ik, 5_ik]
   mesh%n_tips = 2
   mesh%tip_point = [4_ik, 5_ik]
   mesh%tip_fracture = [1_ik, 2_ik]
   mesh%tip_end = [2_ik, 1_ik]
   mesh%tip_direction = reshape([1.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [2, 2])
   call record%step(7.5_rk, network, mesh)
   call record%flush(error)
   call checks%no_error(error, "the grown network")
   text = file_text(path)
   call checks%is_true(occurrences('"time_s": 0.0') == 2, "old step and joint keep their times")
   call checks%is_true(occurrences('"time_s": 7.5') == 2, "a new step and a new joint")
   call has('"kind": "T",'//achar(10)//'      "time_s": 7.5,'//achar(10)//'      "x_m": 1.5,'// &
      & achar(10)//'      "y_m": 0.0,'//achar(10)//'      "fractures": [1, 2]')
   call has('"x_m": [0.0, 1.0, 2.0]')
   call has('{"tip": 1, "fracture": 1, "end": "end", "x_m": 2.0, "y_m": 0.0, '// &
      & '"direction": [1.0, 0.0]}')
   call checks%finish()

contains

   subroutine has(words)
      character(len=*), intent(in) :: words

      call checks%is_true(index(text, words) > 0, words)
   end subroutine has

   !> How often words occur in the file.
   function occurrences(words) result(n)
      character(len=*), intent(in) :: words
      integer :: n, i

      n = 0
      do i = 1, len(text) - len(words) + 1
         if (text(i:i + len(words) - 1) == words) n = n + 1
      end do
   end function occurrences

end program test_report_network
