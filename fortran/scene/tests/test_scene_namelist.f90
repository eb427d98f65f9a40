!> What a file says arrives in the scene, and what it leaves out has its default.
program test_scene_namelist
   use base_errors, only: error_t
   use base_kinds, only: pi, rk
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_lines, source_path
   use scene_types, only: discretization_t, growth_t, initial_t, output_t, scene_t, time_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_namelist.nml"
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(scene_t) :: scene

   call check_syntax()
   call check_defaults()
   call check_mechanics_only()
   call check_onset()
   call check_other_scenes()
   call delete_file(path)
   call checks%finish()

contains

   !> Everything the syntax allows, groups in an odd order, every group in use.
   subroutine check_syntax()
      type(scene_t) :: scene

      call put_lines(path, [character(len=80) :: "! a comment with &group and 'quote", &
                            "&injection fracture='b',rate=1d-7,start=10,end=20,x=0.5,y=0.25 /", &
                            "&TIME End = 100. Step = +1.0E1, /", &
                            "&coarse size_fracture=0.1,size_boundary=", "   0.5 ! [m]", &
                            "   newton_max = 17 newton_tolerance = 1e-10 condensation='full' /", &
                            "&domain x_min=-1 x_max=1 y_min=-.5 y_max=5.0d-1/", &
                            "&fracture name=""a"" x=2*0.0 y=-0.2,0.2, friction=0.6 "// &
                            "aperture=1e-4 /", "&fracture name='b' x=0.25 0.5", &
                            "  0.75, y=3*0.25 friction=0 dilation_deg=45 aperture=1e-3 /", &
                            "&side name='top' x_traction=1e5 y_displacement=-1e-3 pressure=2e6 /", &
                            "&side name='left' x_displacement=0 y_displacement=0 /", &
                            "&material young=1e9 poisson=.25 biot=.9 porosity=.1 "// &
                            "permeability_xx=2e-15", "  permeability_yy=1e-15 "// &
                            "permeability_xy=-1e-16 toughness=1e6", &
                            "  plane='stress' storage='textbook'/", &
                            "&fluid compressibility=4.5e-10 viscosity=1e-3 /", &
                            "&growth enabled=T increment=0.01 exponent=0 threshold=1 "// &
                            "new_aperture=1e-3", "  new_volume='prefilled' stop_gain=0.5 /", &
                            "&fine window=.4 size_ratio=1 rosette_sectors=16 "// &
                            "face_condition='jump' /", &
                            "&initial fracture_pressure='undrained', pressure=1.5e6 /", &
                            "&output vtu=.false. interval=5 out_of_plane_length=2 "// &
                            "stimulated_jump=1e-7 /", &
                            "&probe name='p' x=1 y=.5/ "// &
                            "&probe name='q' x=0 y=0 /", "&scene title='it''s a test' /"])
      call read_scene(path, scene, error)
      call checks%no_error(error, "every feature of the syntax")
      if (allocated(error)) return

      call checks%is_true(scene%name == "test_scene_namelist", "a scene is called as its file")
      call checks%is_true(scene%title == "it's a test", "title")
      call exactly([scene%domain%x_min, scene%domain%x_max, scene%domain%y_min, &
                    scene%domain%y_max], [-1.0_rk, 1.0_rk, -0.5_rk, 0.5_rk], "domain")
      associate (m => scene%material)
         call exactly([m%young, m%poisson, m%biot, m%porosity, m%toughness], &
                      [1.0e9_rk, 0.25_rk, 0.9_rk, 0.1_rk, 1.0e6_rk], "material")
         call exactly([m%permeability_xx, m%permeability_yy, m%permeability_xy], &
                      [2.0e-15_rk, 1.0e-15_rk, -1.0e-16_rk], "permeability tensor")
         call checks%is_true(m%plane_stress .and. m%storage == "textbook", &
                             "switches of the material")
      end associate
      call exactly([scene%fluid%compressibility, scene%fluid%viscosity], [4.5e-10_rk, 1.0e-3_rk], &
                   "fluid")
      call checks%is_true(size(scene%fractures) == 2, "two fractures")
      call checks%is_true(scene%fractures(1)%name == "a" .and. scene%fractures(2)%name == "b", &
                          "names")
      call exactly(scene%fractures(1)%x, [0.0_rk, 0.0_rk], "x of a")
      call exactly(scene%fractures(2)%x, [0.25_rk, 0.5_rk, 0.75_rk], "x of b over two lines")
      call exactly(scene%fractures(2)%y, [0.25_rk, 0.25_rk, 0.25_rk], "y of b by a repeat count")
      call exactly([scene%fractures(1)%dilation, scene%fractures(1)%friction], [0.0_rk, 0.6_rk], &
                   "law of a")
      call checks%is_close(scene%fractures(2)%dilation, pi/4.0_rk, epsilon(1.0_rk), &
                           "45 degrees in radians")
      call checks%is_true(all(scene%sides(1)%displacement_given), "left is held in both directions")
      call checks%is_true(.not. scene%sides(4)%displacement_given(1), "top is free in x")
      call exactly([scene%sides(4)%displacement(2), scene%sides(4)%traction(1), &
                    scene%sides(4)%pressure], [-1.0e-3_rk, 1.0e5_rk, 2.0e6_rk], "top")
      call checks%is_true(all([scene%sides%pressure_given] .eqv. [.false., .false., .false., &
                                                                  .true.]), &
                          "only the top has a pressure")
      call exactly([scene%sides(2)%traction, scene%sides(3)%traction], [0.0_rk, 0.0_rk, 0.0_rk, &
                                                                        0.0_rk], &
                   "sides that are not given are free")
      associate (w => scene%injections(1))
         call checks%is_true(w%fracture == 2 .and. w%at_point, "the well finds a fracture "// &
                             "given after it")
         call exactly([w%rate(1), w%start, w%end, w%x, w%y], [1.0e-7_rk, 10.0_rk, 20.0_rk, 0.5_rk, &
                                                              0.25_rk], "well")
      end associate
      call checks%is_true(scene%initial%fracture_pressure == "undrained", &
                          "initial fracture pressure")
      call exactly([scene%initial%pressure], [1.5e6_rk], "initial pressure")
      call exactly([scene%time%end, scene%time%step], [100.0_rk, 10.0_rk], "time")
      associate (d => scene%discretization)
         call exactly([d%size_fracture, d%size_boundary, d%window, d%fine_ratio, &
                       d%newton_tolerance], [0.1_rk, 0.5_rk, 0.4_rk, 1.0_rk, 1.0e-10_rk], "sizes")
         call checks%is_true(d%newton_max == 17 .and. d%rosette_sectors == 16, "counts")
         call checks%is_true(d%face_condition == "jump", "face condition")
         call checks%is_true(d%condensation == "full", "condensation")
      end associate
      associate (g => scene%growth)
         call checks%is_true(g%enabled .and. g%intensities, "growth computes intensity factors")
         call exactly([g%increment, g%exponent, g%threshold, g%new_aperture, g%stop_gain], &
                      [0.01_rk, 0.0_rk, 1.0_rk, 1.0e-3_rk, 0.5_rk], "growth")
         call checks%is_true(g%new_volume == "prefilled", "new volume")
      end associate
      call checks%is_true(scene%probes(1)%name == "p" .and. scene%probes(2)%name == "q", "probes")
      call exactly([scene%probes(1)%x, scene%probes(1)%y], [1.0_rk, 0.5_rk], &
                   "a probe in the corner")
      call checks%is_true(.not. scene%output%vtu, "no VTU files")
      call exactly([scene%output%interval, scene%output%out_of_plane_length, &
                    scene%output%stimulated_jump], [5.0_rk, 2.0_rk, 1.0e-7_rk], "output")
   end subroutine check_syntax

   !> The defaults of the table are those of the types.
   subroutine check_defaults()
      type(discretization_t) :: discretization
      type(growth_t) :: growth
      type(initial_t) :: initial
      type(output_t) :: output
      type(time_t) :: time

      call put_lines(path, smallest())
      call read_scene(path, scene, error)
      call checks%no_error(error, "the smallest scene")
      if (allocated(error)) return
      call exactly([scene%time%share_after_growth, scene%time%smallest_factor], &
                   [time%share_after_growth, 1.0e-6_rk], "default times")
      call exactly([scene%discretization%fine_ratio, scene%discretization%newton_tolerance, &
                    scene%discretization%size_fracture, scene%discretization%window], &
                   [discretization%fine_ratio, discretization%newton_tolerance, &
                    discretization%size_fracture, discretization%window], "default discretization")
      call checks%is_true(scene%discretization%rosette_sectors == discretization%rosette_sectors, &
                          "default rosette")
      call checks%is_true(scene%discretization%newton_max == discretization%newton_max, &
                          "default Newton iterations")
      call checks%is_true(scene%discretization%face_condition == discretization%face_condition, &
                          "default face condition")
      call exactly([scene%growth%exponent, scene%growth%threshold, scene%growth%new_aperture, &
                    scene%growth%stop_gain], &
                   [growth%exponent, growth%threshold, growth%new_aperture, growth%stop_gain], &
                   "default growth")
      call checks%is_true(.not. scene%growth%enabled .and. .not. scene%growth%intensities, &
                          "growth is off")
      call checks%is_true(scene%growth%new_volume == growth%new_volume, "default new volume")
      call checks%is_true(scene%initial%fracture_pressure == initial%fracture_pressure, &
                          "default initial")
      call exactly([scene%initial%pressure], [initial%pressure], "default pressure")
      call checks%is_true(scene%output%vtu .eqv. output%vtu, "default output")
      call checks%is_true(scene%material%storage == "thesis" .and. &
                          .not. scene%material%plane_stress, "default material")
   end subroutine check_defaults

   !> Without a fluid, a fracture needs neither aperture nor flow properties.
   subroutine check_mechanics_only()
      call put_lines(path, [character(len=80) :: smallest(), &
                            "&fracture name='f' x=0.4,0.6 y=0.5,0.5 law='open' /"])
      call read_scene(path, scene, error)
      call checks%no_error(error, "a fracture without a cell size")
      call checks%is_close(scene%discretization%size_fracture, 0.01_rk, 1.0e-15_rk, &
                           "a 20th of its length")
      call put_lines(path, [character(len=80) :: smallest(0.1_rk), &
                            "&fracture name='f' x=0.4,0.6 y=0.5,0.5 law='open' /", &
                            "&restraint x=1 y=1 x_displacement=-0.5 /", &
                            "&point_load x=0 y=1 x_force=2 y_force=-3e5 /", &
                            "&load from=0.5 to=2 steps=3 /"])
      call read_scene(path, scene, error)
      call checks%no_error(error, "mechanics only")
      if (allocated(error)) return
      call checks%is_true(.not. scene%has_fluid(), "mechanics only: no fluid")
      call checks%is_true(scene%fractures(1)%law == "open", "an open fracture")
      call checks%is_true(size(scene%restraints) == 1 .and. size(scene%point_loads) == 1, &
                          "a restraint and a point load")
      associate (point => scene%restraints(1), force => scene%point_loads(1))
         call checks%is_true(all(point%displacement_given .eqv. [.true., .false.]), &
                             "the restraint holds x")
         call exactly([point%x, point%y, point%displacement], [1.0_rk, 1.0_rk, -0.5_rk, 0.0_rk], &
                      "restraint")
         call exactly([force%x, force%y, force%force], [0.0_rk, 1.0_rk, 2.0_rk, -3.0e5_rk], &
                      "point load")
      end associate
      call exactly([scene%load%from, scene%load%to, scene%time%end, scene%time%step], &
                   [0.5_rk, 2.0_rk, 1.0_rk, 1.0_rk/3.0_rk], "load")
      call exactly([scene%fluid%viscosity], [0.0_rk], "a viscosity of 0 tells that there is "// &
                   "no fluid")
   end subroutine check_mechanics_only

   subroutine check_onset()
      call read_scene(source_path("inputs/paper_c/onset.nml"), scene, error)
      call checks%no_error(error, "onset.nml")
      if (allocated(error)) return
      call checks%is_true(scene%name == "onset", "its name")
      associate (f => scene%fractures(1))
         call checks%is_close(hypot(f%x(2) - f%x(1), f%y(2) - f%y(1)), 0.1_rk, 1.0e-15_rk, &
                              "length 0.1 m")
         call checks%is_close(atan2(f%y(2) - f%y(1), f%x(2) - f%x(1)), pi/4.0_rk, &
                              1.0e-15_rk, "at 45 degrees")
         call checks%is_close(sum(f%x), 2.0_rk, 0.0_rk, "centre in x")
         call checks%is_close(sum(f%y), 2.0_rk, 0.0_rk, "centre in y")
         call checks%is_close(f%dilation, pi/180.0_rk, 1.0e-17_rk, &
                              "dilation of 1 degree")
      end associate
      call exactly([scene%sides(2)%traction, scene%sides(4)%traction], [-20.0e6_rk, 0.0_rk, &
                                                                        0.0_rk, -10.0e6_rk], "load")
      call exactly([scene%injections(1)%start, scene%injections(1)%end, scene%time%end]/3600.0_rk, &
                   [6.0_rk, 21.0_rk, 27.0_rk], "rest, injection, rest")
      call exactly([scene%material%permeability_xx, scene%material%permeability_yy, &
                    scene%material%permeability_xy], [5.0e-20_rk, 5.0e-20_rk, 0.0_rk], "isotropic")
      call checks%is_true(scene%growth%intensities .and. .not. scene%growth%enabled, &
                          "intensities only")
      call checks%is_true(.not. scene%injections(1)%at_point, "injection over the fracture")
      call checks%is_true(all(scene%probes%name == [character(len=6) :: "c", "d", "centre"]), &
                          "probes")
   end subroutine check_onset

   subroutine check_other_scenes()
      call read_scene(source_path("inputs/paper_c/wing_crack.nml"), scene, error)
      call checks%no_error(error, "wing_crack.nml")
      if (.not. allocated(error)) then
         call checks%is_true(scene%growth%enabled .and. scene%growth%new_volume == "conserved", &
                             "grows")
         call exactly([scene%injections(1)%start, scene%injections(1)%end], [0.0_rk, &
                                                                             huge(1.0_rk)], &
                      "injection throughout")
         call exactly([scene%time%end/3600.0_rk, scene%time%tolerance, &
                       scene%growth%stop_gain], [100.0_rk, 0.01_rk, 0.25_rk], "times")
      end if
      call read_scene(source_path("inputs/paper_c/three_fractures.nml"), scene, error)
      call checks%no_error(error, "three_fractures.nml")
      if (.not. allocated(error)) then
         call checks%is_true(size(scene%fractures) == 3 .and. scene%injections(1)%fracture == 2, &
                             "injection into the second of three")
         call exactly([scene%discretization%size_fracture, scene%fractures(3)%y], &
                      [0.02_rk, 0.780_rk, 0.831_rk], "size and third fracture")
      end if
      call read_scene(source_path("inputs/benchmarks/onset_2300.nml"), scene, error)
      call checks%no_error(error, "onset_2300.nml")
      if (.not. allocated(error)) then
         call checks%is_close(scene%time%end/scene%time%step, 21.0_rk, 0.0_rk, "21 steps")
         call checks%is_true(.not. scene%output%vtu, "no VTU")
      end if
   end subroutine check_other_scenes

   !> A body that is held, and nothing else.
   function smallest(size_fracture) result(lines)
      real(rk), intent(in), optional :: size_fracture
      character(len=80) :: lines(5)

      lines = [character(len=80) :: "&domain x_min=0 x_max=1 y_min=0 y_max=1 /", &
               "&material young=1e9 poisson=0.2 /", &
               "&side name='bottom' x_displacement=0 y_displacement=0 /", &
               "&output /", &
               "&fe size_boundary=0.2 /"]
      if (present(size_fracture)) write (lines(5), "(a,f4.2,a)") &
         "&fe size_boundary=0.2 size_fracture=", size_fracture, " /"
   end function smallest

   subroutine exactly(values, expected, name)
      real(rk), intent(in) :: values(:), expected(:)
      character(len=*), intent(in) :: name

      call checks%is_true(size(values) == size(expected), name//": count")
      if (size(values) /= size(expected)) return
      call checks%is_true(all(abs(values - expected) <= 0.0_rk), name)
   end subroutine exactly

end program test_scene_namelist
