!> A written scene reads back to the same scene, bit for bit, and names every parameter.
program test_scene_write
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_parameter_table, only: parameters
   use scene_parameters, only: groups, in_mechanics
   use scene_test_files, only: delete_file, put_bytes, put_lines, same_scene, source_path
   use scene_types, only: point_load_t, restraint_t, scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_write.nml", &
                                  again = "test_scene_write_again.nml"
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call round_trip(source_path("inputs/paper_c/onset.nml"))
   call round_trip(source_path("inputs/paper_c/wing_crack.nml"))
   call round_trip(source_path("inputs/paper_c/three_fractures.nml"))
   call round_trip(source_path("inputs/paper_d/permeability_case1.nml"))
   call round_trip(source_path("inputs/benchmarks/onset_2300.nml"))
   call check_odd_numbers()
   call check_sizes()
   call check_bodies()
   call check_word()
   call check_angles()
   call check_completeness()
   call delete_file(path)
   call delete_file(again)
   call checks%finish()

contains

   subroutine round_trip(name)
      character(len=*), intent(in) :: name
      type(scene_t) :: first, second

      call read_scene(name, first, error)
      call checks%no_error(error, name)
      if (allocated(error)) return
      call put_bytes(again, scene_text(first))
      call read_scene(again, second, error)
      call checks%no_error(error, name//" is read again")
      if (allocated(error)) return
      call checks%is_true(same_scene(first, second), name//" comes back the same")
   end subroutine round_trip

   !> Sizes by default, of two fractures of different lengths.
   subroutine check_sizes()
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=10 y_min=0 y_max=10 /", &
                            "&material young=1e10 poisson=0.1 biot=0.7 porosity=0.3 "// &
                            "permeability=1e-19 toughness=1e6 /", &
                            "&fluid compressibility=4e-10 viscosity=1e-3 /", &
                            "&fracture name='f' x=5 6 y=5 5 friction=0.5 aperture=1e-4 /", &
                            "&fracture name='g' x=5 5.3 y=3 3 friction=0.5 aperture=1e-4 /", &
                            "&side name='left' x_displacement=0 /", &
                            "&side name='bottom' y_displacement=0 /", &
                            "&time end=7.7 /", "&growth enabled=.true. /"])
      call round_trip(path)
      call read_scene(path, scene, error)
      call checks%is_true(scene%fractures(1)%cell_size > 0.0_rk, "one has a size of its own")
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=10 y_min=0 y_max=10 /", &
                            "&material young=1e10 poisson=0.1 /", &
                            "&fracture name='f' x=5 5 y=5 5 law='open' /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /"])
      call read_scene(path, scene, error)
      call checks%fails_with(error, ":3: &fracture: x and y of fracture 'f' give it a length "// &
                             "of 0.0 but it must have at least 1.4", "no length")
   end subroutine check_sizes

   !> Numbers that no short decimal holds, quotes in texts, long polylines, a scene without fluid.
   subroutine check_odd_numbers()
      call put_lines(path, [character(len=100) :: "&scene name='odd' title='a ''quoted'' "// &
                            """title"" &x = 1 / ! end' /", &
                            "&domain x_min=-0.0 x_max=3.3333333333333335 y_min=-1e-3 "// &
                            "y_max=1.0000000000000002 /", &
                            "&material young=1.2345678901234567e10 poisson=0.1 "// &
                            "biot=0.7000000000000001", "  porosity=0.30000000000000004 "// &
                            "permeability_xx=1.1e-19 permeability_yy=3.3e-20", &
                            "  permeability_xy=-1.7e-20 toughness=1.7976931348623155e308 /", &
                            "&fluid compressibility=4.4999999999999999e-10 viscosity=4.9e-324 /", &
                            "&fracture name='long' x=0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8 0.9 1.1 "// &
                            "1.2 1.3", "  y=6*0.1 6*0.30000000000000004 "// &
                            "friction=0.57735026918962573", "  dilation_deg=1.2345678901234567 "// &
                            "aperture=1.0000000000000001e-5 /", &
                            "&side name='right' x_displacement=-0.0 pressure=0.1 /", &
                            "&side name='top' y_displacement=1e-300 x_traction=-0.0 /", &
                            "&injection fracture='long' rate=-1e-9 x=0.1 y=0.1 "// &
                            "end=3.0000000000000004 /", &
                            "&time end=7.7 step=0.7 smallest_factor=1e-9 /", &
                            "&coarse size_fracture=0.05 size_boundary=0.1 /", &
                            "&probe name='A' x=0.123456789012345678 y=0.1 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                            "&material young=1e9 poisson=0.2 biot=0.5 porosity=0.1 "// &
                            "permeability=1e-18 density=2.5e3 /", &
                            "&fluid compressibility=1e-9 viscosity=1e-3 density=1.0001e3 /", &
                            "&gravity y=-9.81 /", &
                            "&in_situ sxx=-1e6 sxx_per_y=9e3 syy_per_y=24525 y_datum=1.1 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 pressure=2e5 /", &
                            "&time end=1 /", "&coarse size_boundary=0.2 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                            "&material young=1e9 poisson=0.2 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                            "&material young=1e9 poisson=0.2 toughness=1e6 /", &
                            "&fracture name='f' x=0.4 0.6 y=2*0.5 law='open' "// &
                            "face_pressure=-1.25e6 /", &
                            "&fracture name='g' x=0.4 0.6 y=2*0.8 law='slip' slip=0.1 /", &
                            "&fracture name='h' x=0.4 0.6 y=2*0.2 friction=0.1 "// &
                            "held_closed=.true. /", &
                            "&in_situ sxx=-1.1e7 sxy=2 /", &
                            "&restraint x=0 y=0 x_displacement=0 y_displacement=-0.1 /", &
                            "&restraint x=1 y=0 y_displacement=1e-3 /", &
                            "&point_load x=0 y=1 x_force=2 /", "&growth enabled=.true. /", &
                            "&load from=0.1 to=2.1 steps=3 /", &
                            "&fe size_fracture=0.1 size_boundary=0.2 rosette_radius=0.03 "// &
                            "element='plain' /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain shape='disc' x_centre=0.1 "// &
                            "y_centre=-3 radius=0.3 /", "&material young=1e9 poisson=0.2 /", &
                            "&restraint x=0 y=-3 x_displacement=0 y_displacement=0 /", &
                            "&restraint x=0.2 y=-3 y_displacement=0 /", &
                            "&adaptive enabled=.true. tolerance=0.03 passes=2 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
   end subroutine check_odd_numbers

   !> A word in the place of a number. Nothing is measured with the number then.
   subroutine check_word()
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                            "&material young=1e9 poisson=0.2 biot=0.5 porosity=0.1 "// &
                            "permeability=1e-18 toughness=1e6 /", &
                            "&fluid compressibility=1e-9 viscosity=1e-3 /", &
                            "&fracture name='f' x=0.4 0.6 y=2*0.5 friction=0.1 aperture=1e-3 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /", &
                            "&time end=1 /", "&coarse size_fracture=0.05 size_boundary=0.1 /", &
                            "&fine window = 'body' /", &
                            "&growth enabled=.true. increment=0.3 /"])
      call round_trip(path)
      call read_scene(path, scene, error)
      call checks%no_error(error, "a window that is the body")
      if (allocated(error)) return
      call checks%is_true(scene%discretization%window_is_body, "the window is the body")
      call checks%is_close(scene%discretization%window, 0.0_rk, 0.0_rk, "it has no edge")
      call checks%is_true(index(scene_text(scene), "window = 'body'") > 0, "written as a word")
   end subroutine check_word

   !> Arcs of a disc, edges of a polygon given clockwise, gravity and a stress that grows downwards.
   subroutine check_bodies()
      call put_lines(path, [character(len=100) :: "&domain shape='disc' x_centre=0.1 "// &
                            "y_centre=-3 radius=0.3 /", "&material young=1e9 poisson=0.2 /", &
                            "&side name='upper' arc_from_deg=80.123456789012345 "// &
                            "arc_to_deg=100.3 normal_traction=-1e6 /", &
                            "&side name='lower' arc_from_deg=-100 arc_to_deg=-80", &
                            "  x_displacement=0 y_displacement=1e-5 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain shape='disc' x_centre=0.1 "// &
                            "y_centre=-3 radius=0.3 /", "&material young=1e9 poisson=0.2 /", &
                            "&side name='rim' normal_traction=-0.1 shear_traction=0.3 /", &
                            "&restraint x=0.1 y=-3 x_displacement=0 y_displacement=0 /", &
                            "&restraint x=0.2 y=-3 y_displacement=0 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                            "&material young=1e9 poisson=0.2 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /", &
                            "&side name='right' normal_traction=-0.0 /", &
                            "&side name='top' shear_traction=-0.0 normal_traction=0.0 /", &
                            "&side name='bottom' shear_traction=0.0 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
      call put_lines(path, [character(len=100) :: "&domain shape='polygon' x=0, 0, 1, 2.1, 2", &
                            "  y=0, 1, 0.5, 1, -0.1 /", "&material young=1e9 poisson=0.2 "// &
                            "density=2.7e3 /", "&gravity y=-9.81 /", &
                            "&in_situ sxx=-1e6 sxx_per_y=9e3 syy_per_y=2.65e4 y_datum=1.1 /", &
                            "&side name='floor' edges=5 x_displacement=0 y_displacement=0 /", &
                            "&side name='lid' edges=2, 3 y_traction=-1e5 /", &
                            "&fe size_boundary=0.2 /"])
      call round_trip(path)
   end subroutine check_bodies

   !> Degrees in the file, radians in the scene: no angle is lost on the way.
   subroutine check_angles()
      type(scene_t) :: first, second
      character(len=24) :: angle
      integer :: i, n_same

      n_same = 0
      do i = 1, 200
         write (angle, "(f20.16)") 45.0_rk*(sin(real(i, rk)))**2
         call put_lines(path, [character(len=100) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
                               "&material young=1e9 poisson=0.2 biot=1 porosity=0.5 "// &
                               "permeability=1 /", &
                               "&side name='left' x_displacement=0 y_displacement=0 /", &
                               "&fluid compressibility=0 viscosity=1 /", &
                               "&fracture name='f' x=0.4 0.6 y=2*0.5 friction=0 dilation_deg="// &
                               trim(angle), "aperture=1 / &time end=1 step=1 /", &
                               "&coarse size_boundary=0.2 size_fracture=0.1 /"])
         call read_scene(path, first, error)
         if (.not. allocated(error)) call put_bytes(again, scene_text(first))
         if (.not. allocated(error)) call read_scene(again, second, error)
         if (allocated(error)) exit
         first%name = second%name
         if (same_scene(first, second)) n_same = n_same + 1
      end do
      call checks%no_error(error, "angles")
      call checks%is_true(n_same == 200, "200 angles come back the same")
   end subroutine check_angles

   !> Every parameter of every group that occurs is in the file, as a value or as a remark.
   subroutine check_completeness()
      character(len=256) :: line
      integer :: unit, status, i
      logical :: seen(size(parameters)), is_foreign
      character(len=16) :: group

      call read_scene(source_path("inputs/paper_d/permeability_case1.nml"), scene, error)
      call checks%no_error(error, "a scene with every group but those of points and heat")
      allocate (scene%heat)
      scene%restraints = [restraint_t(1.0_rk, 1.0_rk, [.true., .true.])]
      scene%point_loads = [point_load_t(0.5_rk, 0.5_rk)]
      call put_bytes(path, scene_text(scene))
      seen = .false.
      group = ""
      open (newunit=unit, file=path, action="read", status="old")
      do
         read (unit, "(a)", iostat=status) line
         if (status /= 0) exit
         if (line(1:1) == "&") group = line(2:)
         do i = 1, size(parameters)
            if (parameters(i)%group /= group) cycle
            if (index(line, "  "//trim(parameters(i)%name)//" =") == 1) seen(i) = .true.
            if (index(line, "  ! "//trim(parameters(i)%name)//":") == 1) seen(i) = .true.
         end do
      end do
      close (unit)
      do i = 1, size(parameters)
         group = parameters(i)%group
         if (parameters(i)%scenes == in_mechanics) cycle
         is_foreign = groups(findloc(groups%name == group, .true., dim=1))%scenes == in_mechanics
         call checks%is_true(seen(i) .neqv. is_foreign, trim(group)//" "// &
                             trim(parameters(i)%name)//" is written if it may be")
      end do
   end subroutine check_completeness

end program test_scene_write
