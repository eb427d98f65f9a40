!> Faults in scene files: each is refused with file, line, group and name, and what would be right.
!>
!> Each case replaces one line of a good scene; the messages are compared whole.
program test_scene_faults
   use base_errors, only: error_t
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_changed, put_lines
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_faults.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: good(*) = [character(len=100) :: &
      "&scene name='base' /", &  ! 1
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 2
      "&material young=40.0e9", &  ! 3
      "  poisson=0.2", &  ! 4
      "  biot=0.8 porosity=0.01", &  ! 5
      "  permeability=5.0e-20", &  ! 6
      "  toughness=0.7e6 /", &  ! 7
      "&fluid compressibility=4.0e-10 viscosity=1.0e-4 /", &  ! 8
      "&fracture name='f1'", &  ! 9
      "  x=0.9, 1.1", &  ! 10
      "  y=0.5, 0.6", &  ! 11
      "  friction=0.5 dilation_deg=1.0", &  ! 12
      "  aperture=1.0e-3 /", &  ! 13
      "&fracture name='f2' x=0.2, 0.4 y=2*0.5 friction=0.5 aperture=1e-3 /", &  ! 14
      "&side name='left' x_displacement=0.0 /", &  ! 15
      "&side name='bottom' y_displacement=0.0 /", &  ! 16
      "&side name='right' x_traction=-20.0e6 /", &  ! 17
      "&injection fracture='f1' rate=5.0e-9", &  ! 18
      "  start=0.0 /", &  ! 19
      "&time end=3600.0", &  ! 20
      "  step=60.0 /", &  ! 21
      "&coarse size_fracture=0.01 size_boundary=0.1", &  ! 22
      "  newton_max=30 /", &  ! 23
      "&fine window=0.2 /", &  ! 24
      "&growth enabled=.true. /", &  ! 25
      "&probe name='p' x=0.5 y=0.5 /"]  ! 26
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call put_lines(path, good)
   call read_scene(path, scene, error)
   call checks%no_error(error, "the scene without a fault")

   call check_syntax()
   call check_kinds_and_ranges()
   call check_missing()
   call check_each_other()
   call check_geometry()
   call check_files()
   call delete_file(path)
   call checks%finish()

contains

   subroutine check_syntax()
      call refuse(8, "&fluids compressibility=4.0e-10 viscosity=1.0e-4 /", &
                  ":8: unknown group &fluids, the nearest is &fluid"//doc)
      call refuse(3, "&material yuong=40.0e9", &
                  ":3: &material: unknown name yuong, the nearest is young"//doc)
      call refuse(4, "  poisson=0.2 viscosity=1.0e-4", ":4: &material: unknown name viscosity, "// &
                  "which belongs to &fluid"//doc)
      call refuse(10, "  x(1)=0.9 x(2)=1.1", ":10: &fracture: unknown name x(1), the nearest "// &
                  "is x, whose values are given as one list without indices"//doc)
      call refuse(8, "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &
                  ":8: &domain: is given twice, first on line 2, but must be given once: put "// &
                  "all its names there"//doc)
      call refuse(5, "  biot=0.8 porosity=0.01 Poisson=0.25", &
                  ":5: &material: poisson is given twice, first on line 4, but must be given once")
      call refuse(7, "  toughness=0.7e6", ":3: &material: is not ended by '/' as it must be"//doc)
      call refuse(26, "&probe name='p' x=0.5 y=0.5", ":26: &probe: is not ended by '/' as it "// &
                  "must be"//doc)
      call refuse(26, "&probe 'p' x=0.5 y=0.5 /", &
                  ":26: &probe: ''p'' stands where 'name = value' or the closing '/' is expected")
      call refuse(1, "onset &scene /", &
                  ": is no scene file, which begins with a group, as &domain, or with include")
      call refuse(7, "/ onset", &
                  ":7: text outside of a group, where only comments are allowed")
      call refuse(1, "&scene name='base /", ":1: a text in quotes is not closed on its line")
      call refuse(5, "  biot= porosity=0.01", ":5: &material: biot has no value"//doc)
      call refuse(10, "  x=0.9,,1.1", ":10: &fracture: x lacks a value before a comma"//doc)
   end subroutine check_syntax

   subroutine check_kinds_and_ranges()
      call refuse(4, "  poisson=0.5", ":4: &material: poisson is 0.5 but must be a finite "// &
                  "number greater than -1.0 and less than 0.5"//doc)
      call refuse(3, "&material young=40GPa", ":3: &material: young is 40GPa but must be a "// &
                  "finite number greater than 0.0 [Pa]"//doc)
      call refuse(3, "&material young='40.0e9'", ":3: &material: young is '40.0e9' but must be "// &
                  "a finite number greater than 0.0 [Pa]"//doc)
      call refuse(3, "&material young=NaN", ":3: &material: young is NaN but must be a finite "// &
                  "number greater than 0.0 [Pa]"//doc)
      call refuse(17, "&side name='right' x_traction=-Inf /", ":17: &side: x_traction is -Inf "// &
                  "but must be a finite number like 4.0e10 [Pa]"//doc)
      call refuse(20, "&time end=0.0", &
                  ":20: &time: end is 0.0 but must be a finite number greater than 0.0 [s]"//doc)
      call refuse(24, "&fine window=0.0 /", &
                  ":24: &fine: window is 0.0 but must be a finite number greater than 0.0 [m] "// &
                  "or 'body'"//doc)
      call refuse(24, "&fine window='rock' /", &
                  ":24: &fine: window is 'rock' but must be a finite number greater than 0.0 "// &
                  "[m] or 'body'"//doc)
      call refuse(24, "&fine window=body /", &
                  ":24: &fine: window is body but must be a finite number greater than 0.0 [m] "// &
                  "or 'body'"//doc)
      call refuse(24, "&fine window='body', 0.2 /", &
                  ":24: &fine: window has 2 values but must be one number"//doc)
      call refuse(12, "  friction=-0.5 dilation_deg=1.0", &
                  ":12: &fracture: friction is -0.5 but must be a finite number at least 0.0"//doc)
      call refuse(12, "  friction=0.5 dilation_deg=46", ":12: &fracture: dilation_deg is 46 "// &
                  "but must be a finite number at least 0.0 and at most 45.0 [degree]"//doc)
      call refuse(26, "&output stimulated_jump=0.0 /", ":26: &output: stimulated_jump is 0.0 "// &
                  "but must be a finite number greater than 0.0 [m]"//doc)
      call refuse(26, "&output out_of_plane_length=-1.0 /", ":26: &output: out_of_plane_length "// &
                  "is -1.0 but must be a finite number greater than 0.0 [m]"//doc)
      call refuse(5, "  biot=1.1 porosity=0.01", ":5: &material: biot is 1.1 but must be a "// &
                  "finite number at least 0.0 and at most 1.0"//doc)
      call refuse(23, "  newton_max=30.5 /", ":23: &coarse: newton_max is 30.5 but must be a "// &
                  "whole number at least 1 and at most 1000"//doc)
      call refuse(25, "&growth enabled='yes' /", &
                  ":25: &growth: enabled is 'yes' but must be .true. or .false."//doc)
      call refuse(1, "&scene name=base /", ":1: &scene: name is base but must be a text in "// &
                  "quotes of at most 64 letters, digits, '_', '-' and '.', beginning with a "// &
                  "letter or a digit"//doc)
      call refuse(15, "&side name='west' x_displacement=0.0 /", &
                  ":15: &side: name is 'west' but must be 'left', 'right', 'bottom' or 'top'"//doc)
      call refuse(4, "  poisson=0.2, 0.3", ":4: &material: poisson has 2 values but must be "// &
                  "one number"//doc)
   end subroutine check_kinds_and_ranges

   subroutine check_missing()
      call refuse(4, "", ":3: &material: poisson, which is always needed, is missing"//doc)
      call refuse(2, "", ": group &domain is missing, and with it x_min [m], which the "// &
                  "shape 'rectangle' needs"//doc)
      call refuse(7, "/", ":3: &material: toughness [Pa m^1/2], which growth needs, is missing"// &
                  "; rock has 0.5e6 to 2.5e6, so begin with toughness = 1.5e6"//doc)
      call refuse(7, "radiation_damping=1.0e6 /", ":3: &material: toughness [Pa m^1/2], which "// &
                  "growth needs, is missing; rock has 0.5e6 to 2.5e6, so begin with toughness "// &
                  "= 1.5e6; radiation_damping must be omitted with it"//doc)
      call refuse(5, "  biot=0.8", ":3: &material: porosity, which a scene with &fluid needs, "// &
                  "is missing"//doc)
      call refuse(13, "/", ":9: &fracture: aperture [m], which a scene with &fluid needs, is "// &
                  "missing"//doc)
      call refuse(6, "", ":3: &material: permeability [m2], which a scene with &fluid needs, "// &
                  "is missing"//doc)
      call refuse(8, "", ":18: &injection: needs a fluid, but the group &fluid is missing"//doc)
      call refuse_two(8, "", 14, "&initial pressure=1.0e6 /", &
                      ":14: &initial: needs a fluid, but the group &fluid is missing"//doc)
      call refuse_two(8, "", 14, "&side name='top' pressure=1.0e6 /", &
                      ":14: &side: pressure needs a fluid, but the group &fluid is missing"//doc)
   end subroutine check_missing

   subroutine check_each_other()
      call refuse(14, "&fracture name='f1' x=0.2, 0.4 y=2*0.5 friction=0.5 aperture=1e-3 /", &
                  ":14: &fracture: name 'f1' is already taken on line 9 but must be unique"//doc)
      call refuse(17, "&side name='left' x_traction=-20.0e6 /", &
                  ":17: &side: name 'left' is already taken on line 15 but must be unique"//doc)
      call refuse(15, "&side name='left' x_displacement=0.0 x_traction=1.0 /", &
                  ":15: &side: x_traction is given with x_displacement, but only one of them "// &
                  "can be prescribed"//doc)
      call refuse(15, "", ": the body can move in x; give a &side or a &restraint an "// &
                  "x_displacement"//doc)
      call refuse(16, "", ": the body can move in y; give a &side or a &restraint a "// &
                  "y_displacement"//doc)
      call refuse_two(15, "&side name='left' y_displacement=0.0 /", &
                      16, "&side name='bottom' x_displacement=0.0 /", &
                      ": the body can rotate; give a &side, left or right, an x_displacement, "// &
                      "or bottom or top a y_displacement, or a &restraint either"//doc)
      call refuse(5, "  biot=0.8 porosity=0.9", &
                  ":5: &material: biot is 0.8 but must be at least the porosity, 0.9"//doc)
      call refuse_two(5, "  biot=0.0 porosity=0.0", 4, "  poisson=0.2", &
                      ":5: &material: biot and porosity give no storage: phi c_p and the part "// &
                      "of the solid are both zero, but their sum must be positive"//doc)
      call refuse_two(5, "  biot=0.3 porosity=0.1 storage='textbook'", &
                      8, "&fluid compressibility=0.0 viscosity=1e-4 /", &
                      ":8: &fluid: compressibility is 0.0, which makes Skempton's "// &
                      "coefficient B = alpha/(K S + alpha^2) of this rock 1.304, but that must "// &
                      "be at most 1; 3.15e-11 1/Pa would make it 1"//doc)
      call refuse(6, "  permeability=5e-20 permeability_xx=5e-20", &
                  ":6: &material: permeability is given with components of the tensor, but "// &
                  "only one of the two may be given"//doc)
      call refuse(6, "  permeability_xx=5e-20", ":3: &material: permeability_yy is missing but "// &
                  "must be given with the other components of the tensor"//doc)
      call refuse(6, "  permeability_xx=4e-20 permeability_yy=1e-20 permeability_xy=2.1e-20", &
                  ":6: &material: permeability_xy is 2.1e-20 but must be smaller than "// &
                  "sqrt(permeability_xx permeability_yy), since the tensor must be positive "// &
                  "definite"//doc)
      call refuse(21, "  step=7200.0 /", ":21: &time: step is 7200.0 but must be at most "// &
                  "end, 3600.0"//doc)
      call refuse(21, "  step=60.0 growth_factor=1e-7 smallest_factor=1e-6 /", &
                  ":21: &time: smallest_factor is 1.0e-6 but must be at most growth_factor, "// &
                  "1.0e-7"//doc)
      call refuse(19, "  start=10.0 end=5.0 /", ":19: &injection: end is 5.0 but must be after "// &
                  "start, 10.0"//doc)
      call refuse(18, "&injection fracture='g1' rate=5.0e-9", ":18: &injection: fracture is "// &
                  "'g1', which is no fracture of the scene; the nearest is 'f1'"//doc)
      call refuse(19, "  start=0.0 x=1.0 /", &
                  ":18: &injection: y is missing but must be given with x"//doc)
      call refuse(24, "&fine window=0.01 /", ":24: &fine: window is 0.01 but must be larger "// &
                  "than twice the fine mesh size, 0.005; omit it for the default, 5 lengths of "// &
                  "the fracture"//doc)
      call refuse(12, "  friction=0.5 cell_size=0.3", ":12: &fracture: cell_size of fracture"// &
                  " 'f1' is 0.3 but must be at most size_boundary, 0.1"//doc)
      call refuse_two(12, "  friction=0.5 cell_size=0.3", 22, "&coarse size_boundary=0.5", &
                      ":12: &fracture: cell_size of fracture 'f1' is 0.3 but must be at most "// &
                      "the length of the fracture, 0.2236"//doc)
      call refuse(12, "  friction=0.5 window=0.001", ":12: &fracture: window is 0.001 but must "// &
                  "be larger than twice the fine mesh size, 0.005; omit it for the default, 5 "// &
                  "lengths of the fracture"//doc)
      call refuse(12, "  friction=0.5 increment=-1.0", ":12: &fracture: increment is -1.0 but "// &
                  "must be a finite number greater than 0.0 [m]"//doc)
      call refuse(25, "&growth enabled=.true. increment=0.15 /", &
                  ":25: &growth: increment is 0.15 but must be at most half the window, 0.1; "// &
                  "omit it for the default, the fine mesh size"//doc)
   end subroutine check_each_other

   subroutine check_geometry()
      call refuse(2, "&domain x_min=2.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &
                  ":2: &domain: x_max is 2.0 but must be greater than x_min, 2.0"//doc)
      call refuse(22, "&coarse size_fracture=0.01 size_boundary=1.5", &
                  ":22: &coarse: size_boundary is 1.5 but must be at most the shorter edge of "// &
                  "the domain, 1.0"//doc)
      call refuse(22, "&coarse size_fracture=0.2 size_boundary=0.1", &
                  ":22: &coarse: size_fracture is 0.2 but must be at most size_boundary, 0.1"//doc)
      call refuse(22, "&coarse size_fracture=0.25 size_boundary=0.5", &
                  ":22: &coarse: size_fracture is 0.25 but must be at most the length of "// &
                  "fracture 'f1', 0.2236; omit it, "// &
                  "so that cells follow from the length of each fracture"//doc)
      call refuse(10, "  x=0.9, 1.0, 1.1", ":11: &fracture: y of fracture 'f1' has 2 values "// &
                  "but must have as many as x, 3"//doc)
      call refuse_two(10, "  x=0.9", 11, "  y=0.5", ":10: &fracture: x of fracture 'f1' has "// &
                      "one value but must have at least two, the ends of the fracture"//doc)
      call refuse(19, "  x=0.9 y=0.75 /", ":19: &injection: x and y are (0.9, 0.75), 0.2236 m "// &
                  "away from fracture 'f1', but must be within size_fracture, 0.01 m"//doc)
      call refuse(26, "&probe name='p' x=2.5 y=0.5 /", ":26: &probe: x and y of probe 'p' are "// &
                  "(2.5, 0.5) but must lie within the domain"//doc)
   end subroutine check_geometry

   subroutine check_files()
      character(len=*), parameter :: bad_name = "1 bad name.nml"

      call read_scene("no_such_scene.nml", scene, error)
      call checks%fails_with(error, "no_such_scene.nml: there is no such scene file", &
                             "a missing file")
      call read_scene(".", scene, error)
      call checks%fails_with(error, ".: is no file that can be read", "a folder")
      call put_lines(path, [character(len=1) ::])
      call read_scene(path, scene, error)
      call checks%fails_with(error, path//": is empty, a pipe or a device", "an empty file")
      call put_lines(bad_name, [character(len=100) :: "&scene /", good(2:)])
      call read_scene(bad_name, scene, error)
      call checks%fails_with(error, bad_name//":1: &scene: name is missing, and '1 bad name', "// &
                             "as the file is called, cannot serve for it", &
                             "a file name that is no scene name")
      call delete_file(bad_name)
   end subroutine check_files

   !> The good scene with one other line is refused with this message.
   subroutine refuse(number, line, message)
      integer, intent(in) :: number
      character(len=*), intent(in) :: line, message

      call refuse_two(number, line, number, line, message)
   end subroutine refuse

   subroutine refuse_two(number_1, line_1, number_2, line_2, message)
      integer, intent(in) :: number_1, number_2
      character(len=*), intent(in) :: line_1, line_2, message

      call put_changed(path, good, number_1, line_1, number_2, line_2)
      call read_scene(path, scene, error)
      call checks%fails_by(error, path//message)
   end subroutine refuse_two

end program test_scene_faults
