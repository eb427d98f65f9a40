!> Tests of report_run: a small run writes every file with the contract's names, and only whole
!! files.
program test_report_run
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: phase_output, timers_t
   use contact_law, only: state_open, state_slip, state_stick
   use fine_tip_types, only: intensity_t
   use mesh_types, only: mesh_t, network_t, point_boundary, point_joint_t, point_tip
   use report_files, only: make_directory, write_text_file
   use report_record, only: run_record_t, status_finished
   use report_rows, only: event_slip_onset, event_step_cut, event_t, fracture_fields_t, &
                          history_row_t, intersection_fields_t, matrix_fields_t, probe_row_t, &
                          tip_row_t
   use report_run, only: run_output_t
   use report_simulation, only: snapshot_t
   use scene_types, only: injection_t, scene_t
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   character(len=*), parameter :: nl = achar(10)
   character(len=*), parameter :: fracture_names = "time_s,fracture,s_m,x_m,y_m,aperture_m,"// &
      & "jump_n_m,jump_t_m,traction_n_pa,traction_t_pa,pressure_pa,void_m,state"
   character(len=*), parameter :: top = "test_report_run.out"
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   type(network_t) :: network
   type(matrix_fields_t) :: matrix
   type(fracture_fields_t) :: fracture
   type(intersection_fields_t) :: intersections
   type(probe_row_t) :: probes
   type(timers_t) :: timers
   logical :: refused

   call make_scene()
   call make_mesh()
   call make_state()
   call timers%begin()
   call run_with_fluid(top//"/run")
   call run_without_fluid(top//"/dry")
   call refuse()
   call checks%finish()

contains

   !> Two times with everything.
   subroutine run_with_fluid(folder)
      character(len=*), intent(in) :: folder
      type(run_output_t) :: output
      type(run_record_t) :: record
      type(history_row_t) :: row
      type(intensity_t) :: intensity
      integer :: i

      ! Leftovers of an earlier and longer run, and of one that died while it wrote.
      call make_directory(folder//"/vtu", error)
      do i = 0, 3
         call write_text_file(folder//"/vtu/matrix_00000"//achar(48 + i)//".vtu", "old", error)
      end do
      call write_text_file(folder//"/run.json", "old", error)
      call write_text_file(folder//"/history.csv.part", "ol", error)

      scene%injections = [injection_t(name="in", fracture=1_ik, rate=[1.0e-6_rk]), &
                          injection_t(name="out", fracture=1_ik, rate=[-1.0e-6_rk])]
      call output%open(folder, "", refused, error)
      if (.not. allocated(error)) call output%begin(scene, error)
      call checks%no_error(error, "open")
      call checks%is_true(file_exists(folder//"/scene.nml"), "scene.nml is there from the start")
      call checks%is_true(.not. file_exists(folder//"/run.json"), "an earlier run.json is gone")
      call checks%is_true(.not. file_exists(folder//"/vtu/matrix_000003.vtu"), "and its fields")
      call checks%is_true(.not. file_exists(folder//"/history.csv.part"), "and what it left aside")

      call timers%start(phase_output)
      do i = 0, 1
         row = history_row_t(time=2.0_rk*i, dt=2.0_rk, newton_iterations=4_ik, &
            & well_pressure=[6.8e6_rk, 2.0e6_rk], injected=1.0e-4_rk, leakoff=2.0e-5_rk, &
            & prefilled=0.0_rk, fracture_volume=1.0e-3_rk, mass_error_relative=1.0e-14_rk, &
            & max_slip=1.0e-4_rk, max_opening=2.0e-5_rk, n_stick=1_ik, n_slip=1_ik, &
            & n_open=1_ik, fracture_length=1.25_rk, n_tips=2_ik, n_intersections=1_ik, &
            & seismic_moment=1.0e6_rk)
         call output%tables%history_row(row)
         intensity = intensity_t(k1=1.0e6_rk, k2=2.0e5_rk, k1_dc=1.1e6_rk, k2_dc=2.1e5_rk, &
            & k1_error=1.0e3_rk, k2_error=2.0e3_rk, g_domain=28.0_rk, g_error=1.5_rk, &
            & k1_dc_error=3.0e3_rk, k2_dc_error=4.0e3_rk, k1_corrected=1.0005e6_rk, &
            & k2_corrected=2.005e5_rk)
         call output%tables%tip_row(tip_row_t(time=2.0_rk*i, tip=1_ik, fracture=1_ik, &
            & xy=[1.0_rk, 0.5_rk], keq=1.05e6_rk, g=30.0_rk, angle=pi/4.0_rk, advance=0.0_rk, &
            & intensity=intensity))
         call output%tables%probe_row(2.0_rk*i, probes)
         call checks%is_true(output%fields_due(2.0_rk*i), "fields are due at each regular step")
        call output%write_fields(snapshot_t(2.0_rk*i, mesh, matrix, fracture, intersections), error)
         call checks%no_error(error, "fields")
         call checks%is_true(.not. output%fields_due(2.0_rk*i + 0.02_rk), "not at the short steps")
         call output%network%step(2.0_rk*i, network, mesh%fracture)
      end do
      associate (tables => output%tables)
         call tables%event_row(event_t(2.0_rk, event_slip_onset, "slip 1.0e-5 m", 1_ik, .true., &
                                       [0.25_rk, 0.5_rk]))
         call tables%event_row(event_t(time=2.0_rk, kind=event_step_cut, &
                                       detail="from 2 s to 1 s, as Newton did not converge"))
      end associate
      call output%log("two steps, ""quoted""")
      call output%tick(error)
      call checks%is_true(.not. file_exists(folder//"/history.csv"), "tables wait for their time")
      call output%flush(error)
      call checks%no_error(error, "flush")
      call checks%is_true(file_exists(folder//"/history.csv"), "a flush writes them")
      call checks%is_true(.not. file_exists(folder//"/run.json"), "run.json waits for the end")
      call timers%stop(phase_output)
      record%scene = "small"
      record%version = "0.1.0"
      record%status = status_finished
      record%reason = "end time reached"
      call output%close(record, timers, error)
      call checks%no_error(error, "close")

      call row_has(folder//"/history.csv", 1, "time_s,dt_s,newton_iterations,"// &
         & "in_well_pressure_pa,out_well_pressure_pa,injected_m2,leakoff_m2,prefilled_m2,"// &
         & "fracture_volume_m2,"// &
         & "mass_error_relative,max_slip_m,max_opening_m,n_stick,n_slip,n_open,"// &
         & "fracture_length_m,n_tips,n_intersections,seismic_moment_nm", &
         & "0.0,2.0,4,6800000.0,2000000.0,0.0001,2e-05,0.0,0.001,1e-14,0.0001,2e-05,1,1,1,"// &
         & "1.25,2,1,1000000.0")
      call row_has(folder//"/history.csv", 2, "time_s", "2.0")
      call row_has(folder//"/tips.csv", 1, "time_s,tip,fracture,x_m,y_m,k1_pa_sqrtm,"// &
         & "k2_pa_sqrtm,k1_dc_pa_sqrtm,k2_dc_pa_sqrtm,keq_pa_sqrtm,g_j_m2,angle_deg,advance_m,"// &
         & "k1_error_pa_sqrtm,k2_error_pa_sqrtm,g_ahead_j_m2,g_ahead_error_j_m2,"// &
         & "k1_dc_error_pa_sqrtm,k2_dc_error_pa_sqrtm,k1_corrected_pa_sqrtm,"// &
         & "k2_corrected_pa_sqrtm", "0.0,1,1,1.0,0.5,1000000.0,200000.0,1100000.0,210000.0,"// &
         & "1050000.0,30.0,45.0,0.0,1000.0,2000.0,28.0,1.5,3000.0,4000.0,1000500.0,200500.0")
      call row_has(folder//"/fractures.csv", 1, fracture_names, &
         & "0.0,1,0.25,0.25,0.5,0.001,0.0,0.0,-10000000.0,1000000.0,6000000.0,0.0,stick")
      call row_has(folder//"/fractures.csv", 2, fracture_names, &
         & "0.0,1,0.75,0.75,0.5,0.0011,0.0001,-0.002,-5000000.0,3000000.0,6500000.0,0.0001,slip")
      call row_has(folder//"/fractures.csv", 3, fracture_names, &
         & "0.0,2,0.125,0.5,0.375,0.002,0.001,0.0,0.0,0.0,7000000.0,0.0,open")
      call row_has(folder//"/fractures.csv", 4, "time_s", "2.0")
      call row_has(folder//"/probes.csv", 1, "time_s,A_p_pa,A_ux_m,A_uy_m,A_sxx_pa,A_syy_pa,"// &
         & "A_sxy_pa", "0.0,6800000.0,0.001,-0.002,-10000000.0,-20000000.0,500000.0")
      call starts(folder//"/events.csv", "time_s,kind,fracture,x_m,y_m,detail"//nl// &
         & "2.0,slip_onset,1,0.25,0.5,slip 1.0e-5 m"//nl// &
         & '2.0,step_cut,,,,"from 2 s to 1 s, as Newton did not converge"'//nl)
      call starts(folder//"/matrix.pvd", '<?xml version="1.0"?>'//nl// &
         & '<VTKFile type="Collection" version="1.0">'//nl//"  <Collection>"//nl// &
         & '    <DataSet timestep="0.0" part="0" file="vtu/matrix_000000.vtu"/>'//nl// &
         & '    <DataSet timestep="2.0" part="0" file="vtu/matrix_000001.vtu"/>'//nl// &
         & "  </Collection>"//nl//"</VTKFile>"//nl)
      call checks%is_true(file_exists(folder//"/vtu/fractures_000001.vtu"), "fractures' fields")
      call checks%is_true(file_exists(folder//"/vtu/intersections_000001.vtu"), "intersections'")
      call checks%is_true(file_exists(folder//"/network.json"), "network.json")
      call starts(folder//"/run.json", "{"//nl//'  "scene": "small",')
      call checks%is_true(index(file_text(folder//"/run.log"), 's  two steps, "quoted"'//nl) > 0, &
         & "run.log")
   end subroutine run_with_fluid

   !> Mechanics only, without VTU files, intersections and intensities: nothing about fluid is
   !! written.
   subroutine run_without_fluid(folder)
      character(len=*), intent(in) :: folder
      type(run_output_t) :: output
      type(run_record_t) :: record
      type(matrix_fields_t) :: dry_matrix
      type(fracture_fields_t) :: dry_fracture
      type(probe_row_t) :: dry_probes
      type(intersection_fields_t) :: none
      type(scene_t) :: dry_scene

      dry_scene = scene
      dry_scene%fluid%viscosity = 0.0_rk
      dry_scene%output%vtu = .false.
      dry_scene%output%interval = 10.0_rk
      dry_scene%growth%intensities = .false.
      dry_matrix = matrix
      deallocate (dry_matrix%pressure)
      dry_fracture = fracture
      deallocate (dry_fracture%pressure, dry_fracture%void)
      call output%open(folder, "", refused, error)
      if (.not. allocated(error)) call output%begin(dry_scene, error)
      call checks%no_error(error, "open without fluid")
      call output%tables%history_row(history_row_t(time=1.0_rk, strain_energy=0.25_rk))
      call output%tables%tip_row(tip_row_t(time=1.0_rk))
      dry_probes = probes
      deallocate (dry_probes%pressure)
      call output%tables%probe_row(1.0_rk, dry_probes)
      call output%write_fields(snapshot_t(1.0_rk, mesh, dry_matrix, dry_fracture, none), error)
      call checks%no_error(error, "fields without fluid")
      call checks%is_true(.not. output%fields_due(9.99_rk), "fields follow the interval")
      call checks%is_true(output%fields_due(10.0_rk), "fields are due when it has passed")
      call output%write_fields(snapshot_t(25.0_rk, mesh, dry_matrix, dry_fracture, none), error)
      call checks%is_true(.not. output%fields_due(29.9_rk), "missed times are not made up for")
      call output%close(record, timers, error)
      call checks%no_error(error, "close without fluid")
      call row_has(folder//"/history.csv", 1, "load_factor,max_slip_m,strain_energy_j", &
         & "1.0,0.0,0.25")
      call lacks(folder//"/history.csv", "time_s")
      call lacks(folder//"/history.csv", "dt_s")
      call lacks(folder//"/history.csv", "well_pressure_pa")
      call lacks(folder//"/history.csv", "mass_error_relative")
      call row_has(folder//"/fractures.csv", 1, "load_factor,traction_t_pa,state", &
         & "1.0,1000000.0,stick")
      call lacks(folder//"/fractures.csv", "pressure_pa")
      call row_has(folder//"/probes.csv", 1, "load_factor,A_ux_m,A_uy_m,A_sxx_pa,A_syy_pa,"// &
                   "A_sxy_pa", &
         & "1.0,0.001,-0.002,-10000000.0,-20000000.0,500000.0")
      call lacks(folder//"/probes.csv", "A_p_pa")
      call checks%is_true(.not. file_exists(folder//"/tips.csv"), "no intensities, no tips.csv")
      call checks%is_true(.not. file_exists(folder//"/matrix.pvd"), "no VTU, no collection")
      call checks%is_true(.not. file_exists(folder//"/vtu"), "no VTU, no folder")
   end subroutine run_without_fluid

   !> A directory that cannot be made.
   subroutine refuse()
      type(run_output_t) :: output

      call output%open(top//"/run/run.json", "", refused, error)
      call checks%fails_with(error, "run.json", "a file in the way of the directory is refused")
   end subroutine refuse

   !> A file begins with these words.
   subroutine starts(path, words)
      character(len=*), intent(in) :: path, words

      call checks%is_true(index(file_text(path), words) == 1, path//" begins with "//words)
   end subroutine starts

   !> A row of a table without quoted texts has these values in the columns of these names; others
   !! may stand among them.
   subroutine row_has(path, row, names, values)
      character(len=*), intent(in) :: path, names, values  !< lists with commas
      integer, intent(in) :: row  !< from 1
      character(len=:), allocatable :: header, line, name
      integer :: i, column

      header = piece(file_text(path), nl, 1)
      line = piece(file_text(path), nl, row + 1)
      i = 1
      do
         name = piece(names, ",", i)
         if (name == "") exit
         column = 1
         do while (piece(header, ",", column) /= name .and. piece(header, ",", column) /= "")
            column = column + 1
         end do
         call checks%is_true(piece(line, ",", column) == piece(values, ",", i), path//", "//name// &
            & ": "//piece(line, ",", column)//" is "//piece(values, ",", i))
         i = i + 1
      end do
   end subroutine row_has

   !> A table has no column of this name.
   subroutine lacks(path, name)
      character(len=*), intent(in) :: path, name

      call checks%is_true(index(","//piece(file_text(path), nl, 1)//",", ","//name//",") == 0, &
         & path//" has no "//name)
   end subroutine lacks

   !> A piece of a text between separators; nothing behind the last.
   pure function piece(text, separator, number)
      character(len=*), intent(in) :: text
      character(len=1), intent(in) :: separator
      integer, intent(in) :: number  !< from 1
      character(len=:), allocatable :: piece
      integer :: i, from

      from = 1
      do i = 2, number
         if (index(text(from:), separator) == 0) exit
         from = from + index(text(from:), separator)
      end do
      piece = ""
      if (i <= number) return
      piece = text(from:)
      if (index(piece, separator) > 0) piece = piece(:index(piece, separator) - 1)
   end function piece

   !> A scene with one probe, two fractures and intensities.
   subroutine make_scene()

      scene%name = "small"
      scene%domain%x_max = 1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%material%young = 4.0e10_rk
      scene%material%poisson = 0.2_rk
      scene%material%biot = 0.8_rk
      scene%material%permeability_xx = 1.0e-18_rk
      scene%material%permeability_yy = 2.0e-18_rk
      scene%fluid%viscosity = 1.0e-4_rk
      scene%time%end = 4.0_rk
      scene%time%step = 2.0_rk
      scene%output%interval = 2.0_rk
      scene%growth%intensities = .true.
      allocate (scene%fractures(2), scene%injections(0), scene%probes(1))
      scene%fractures(1)%name = "main"
      scene%fractures(1)%x = [0.0_rk, 1.0_rk]
      scene%fractures(1)%y = [0.5_rk, 0.5_rk]
      scene%fractures(2)%name = "side"
      scene%fractures(2)%x = [0.5_rk, 0.5_rk]
      scene%fractures(2)%y = [0.25_rk, 0.5_rk]
      scene%probes(1)%name = "A"
   end subroutine make_scene

   !> Four triangles; fracture 1 splits them, fracture 2 meets it from below. (The writers need no
   !! more of a mesh than its points, cells and fracture cells, which here do not have to fit
   !! together.)
   subroutine make_mesh()

      mesh%n_nodes = 8
      mesh%n_cells = 4
      mesh%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.5_rk, 0.0_rk, 0.5_rk, 0.0_rk, &
         & 0.5_rk, 1.0_rk, 0.5_rk, 1.0_rk, 1.0_rk, 0.0_rk, 1.0_rk], [2, 8])
      mesh%cell_nodes = reshape([1_ik, 2_ik, 3_ik, 1_ik, 3_ik, 4_ik, 5_ik, 6_ik, 7_ik, 5_ik, 7_ik, &
         & 8_ik], [3, 4])
      network = network_t([1_ik, 3_ik, 5_ik], reshape([0.0_rk, 0.5_rk, 1.0_rk, 0.5_rk, 0.5_rk, &
         & 0.25_rk, 0.5_rk, 0.5_rk], [2, 4]), [0.0_rk, 0.0_rk])
      associate (f => mesh%fracture)
         f%n_cells = 3
         f%n_points = 4
         f%n_tips = 2
         f%cell_fracture = [1_ik, 1_ik, 2_ik]
         f%cell_points = reshape([1_ik, 2_ik, 2_ik, 3_ik, 4_ik, 2_ik], [2, 3])
         f%cell_s = reshape([0.0_rk, 0.5_rk, 0.5_rk, 1.0_rk, 0.0_rk, 0.25_rk], [2, 3])
         f%point_xy = reshape([0.0_rk, 0.5_rk, 0.5_rk, 0.5_rk, 1.0_rk, 0.5_rk, 0.5_rk, 0.25_rk], &
            & [2, 4])
         f%point_kind = [point_boundary, point_joint_t, point_tip, point_tip]
         f%point_cells%first = [1_ik, 2_ik, 5_ik, 6_ik, 7_ik]
         f%point_cells%item = [1_ik, 1_ik, 2_ik, 3_ik, 2_ik, 3_ik]
         f%tip_point = [3_ik, 4_ik]
         f%tip_fracture = [1_ik, 2_ik]
         f%tip_end = [2_ik, 1_ik]
         f%tip_direction = reshape([1.0_rk, 0.0_rk, 0.0_rk, -1.0_rk], [2, 2])
      end associate
   end subroutine make_mesh

   subroutine make_state()

      matrix%displacement = reshape([0.1_rk, 0.2_rk, 0.3_rk, 0.4_rk, 0.5_rk, 0.6_rk, 0.7_rk, &
         & 0.8_rk], [2, 4])*1.0e-3_rk
      matrix%stress = spread([-1.0e7_rk, -2.0e7_rk, 5.0e5_rk], 2, 4)
      matrix%pressure = [6.0e6_rk, 6.1e6_rk, 6.2e6_rk, 1.0e7_rk/3.0_rk]
      fracture%aperture = [1.0e-3_rk, 1.1e-3_rk, 2.0e-3_rk]
      fracture%jump_n = [0.0_rk, 1.0e-4_rk, 1.0e-3_rk]
      fracture%jump_t = [0.0_rk, -2.0e-3_rk, 0.0_rk]
      fracture%traction_n = [-1.0e7_rk, -5.0e6_rk, 0.0_rk]
      fracture%traction_t = [1.0e6_rk, 3.0e6_rk, 0.0_rk]
      fracture%pressure = [6.0e6_rk, 6.5e6_rk, 7.0e6_rk]
      fracture%void = [0.0_rk, 1.0e-4_rk, 0.0_rk]
      fracture%state = [state_stick, state_slip, state_open]
      probes%displacement = reshape([1.0e-3_rk, -2.0e-3_rk], [2, 1])
      probes%stress = reshape([-1.0e7_rk, -2.0e7_rk, 5.0e5_rk], [3, 1])
      probes%pressure = [6.8e6_rk]
      intersections%point = [2_ik]
      intersections%pressure = [6.75e6_rk]
   end subroutine make_state

end program test_report_run
