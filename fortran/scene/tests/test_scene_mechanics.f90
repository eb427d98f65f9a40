!> Mechanics-only scenes: what they must not say, and what must go together.
program test_scene_mechanics
   use base_errors, only: error_t
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_lines
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_mechanics.nml"
   character(len=80), parameter :: good(*) = [character(len=80) :: &
                                              "&domain x_min=0 x_max=2 y_min=0 y_max=1 /", &  ! 1
                                              "&material young=1e9 poisson=0.2 toughness=1e6 /", &
                                              "&fracture name='f' x=0.5 1 y=2*0.5 law='open' /", &
                                              "&restraint x=0 y=0 x_displacement=0 "// &
                                              "y_displacement=0 /", &  ! 4
                                              "&restraint x=2 y=0 y_displacement=0 /", &
                                              "&side name='top' y_traction=1e6 /", &  ! 6
                                              "&point_load x=1 y=0 y_force=-2e6 /", &
                                              "&load from=0 to=2 steps=4 /", &  ! 8
                                              "&fe size_fracture=0.1 size_boundary=0.2 /", &
                                              "&growth enabled=.true. /"]
   type(checks_t) :: checks

   call accept("the scene without a fault", 8, trim(good(8)))
   call accept("held by a side and a point", 5, "&side name='left' x_displacement=0 /")
   call refuse(1, trim(good(1))//" &time end=1 step=1 /", "&time: needs a fluid, but the group "// &
               "&fluid is missing")
   call refuse(6, "&side name='top' pressure=1 /", ":6: &side: pressure needs a fluid")
   call refuse(10, "&growth enabled=.true. threshold=0.5 /", "threshold needs a fluid")
   call refuse(8, trim(good(8))//" &fluid compressibility=0 viscosity=1 /", &
               ":8: &load: is for mechanics-only scenes, but this one has the group &fluid")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 /", "friction, which the law 'friction' "// &
               "needs, is missing")
   call accept("friction", 3, "&fracture name='f' x=0.5 1 y=2*0.5 friction=0.5 /")
   call accept("no friction", 3, "&fracture name='f' x=0.5 1 y=2*0.5 law='frictionless' /")
   call accept("a slip", 3, "&fracture name='f' x=0.5 1 y=2*0.5 law='slip' slip=1e-3 /")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 law='open' friction=0.5 /", &
               ":3: &fracture: friction is given, but only the law 'friction' has it, and not "// &
               "'open'")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 law='slip' /", "slip [m], which the law "// &
               "'slip' needs, is missing")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 friction=1 slip_taper=0.1 /", &
               "slip_taper is given, but only the law 'slip' has it, and not 'friction'")
   call accept("held closed", 3, "&fracture name='f' x=0.5 1 y=2*0.5 friction=1 "// &
               "held_closed=.true. face_pressure=1e6 /")
   call accept("a pressure on open faces", 3, "&fracture name='f' x=0.5 1 y=2*0.5 law='open' "// &
               "face_pressure=1e6 held_closed=.false. /")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 law='open' held_closed=.true. /", &
               ":3: &fracture: held_closed is .true., but the faces of the law 'open' do not touch")
   call refuse(5, "&restraint x=0 y=1 x_displacement=0 /", "", accepted=.true.)
   call refuse(5, "&restraint x=2 y=0 x_displacement=0 /", "the body can rotate; give a &side, "// &
               "left or right, an x_displacement, or bottom or top a y_displacement, or a "// &
               "&restraint either")
   call refuse(4, "&restraint x=0 y=0 y_displacement=0 /", "give a &side or a "// &
               "&restraint an x_displacement")
   call refuse(5, "&restraint x=2 y=0 /", ":5: &restraint: has no component", &
               and_4="&side name='left' x_displacement=0 y_displacement=0 /")
   call refuse(8, "&load from=2 to=2 /", ":8: &load: to is 2.0 but must differ from from, 2.0")
   call refuse(2, "&material young=1e9 poisson=0.2 toughness=1e6 heat_expansion=3e-5 /", &
               ":2: &material: heat_expansion is given, but the scene has no group &heat or "// &
               "&temperature")
   call refuse(8, "&temperature change=-5 /", ":2: &material: heat_expansion is missing, but "// &
               "&temperature takes one above 0 here or in a region")
   call refuse(8, "&temperature face_change=-5 /", "face_depth")
   call refuse(2, "&material young=1e9 poisson=0.2 toughness=1e6 heat_expansion=3e-5 /", "", &
               accepted=.true., and_4=trim(good(4))//" &temperature change=-5 face_change=-9 "// &
               "face_depth=2 /")
   call accept("a load that falls", 8, "&load from=2 to=-1 /")
   call accept("a load that goes to and fro", 8, "&load factors=0 1 0.4 -0.5 steps=3 /")
   call accept("to and fro from elsewhere", 8, "&load factors=0.5 from=-1 control='dead' /")
   call refuse(8, "&load factors=1 0 to=2 /", ":8: &load: to is given with factors, which "// &
               "determine it, but must not be")
   call refuse(8, "&load factors=1 0 control='length' /", ":8: &load: control is 'length' but "// &
               "must be 'dead' with factors, since growth under length control changes the "// &
               "load")
   call refuse(8, "&load factors=1 0.5 0.5 /", ":8: &load: factors has 0.5 twice in a row, but "// &
               "each factor must differ from the one before it")
   call refuse(8, "&load factors=2 from=2 /", ":8: &load: factors is 2.0 but must differ from "// &
               "from, or the load would not change")
   call accept("adaptive, with a point load", 10, trim(good(10))//" &adaptive enabled=.true. /")
   call accept("adaptive", 7, "&adaptive enabled=.true. /")
   call refuse(9, "&fe size_fracture=0.1 size_boundary=1.2 /", ":9: &fe: size_boundary is 1.2")
   call refuse(2, "&material young=1e9 poisson=0.2 /", "toughness [Pa m^1/2], which growth needs")
   call refuse(2, "&material young=1e9 poisson=0.2 toughness=0 /", ":2: &material: toughness "// &
               "is 0 but must be positive in a scene without &fluid")
   call refuse(3, "&fracture name='f' x=0.5 1 y=2*0.5 law='open' toughness=0 /", &
               ":3: &fracture: toughness is 0 but must be positive")
   call refuse(6, "", "", accepted=.true., and_1="&domain shape='disc' x_centre=1 y_centre=0.5 "// &
               "radius=2 /")
   call refuse(6, "", "radius [m], which the shape 'disc' needs", and_1="&domain shape='disc' "// &
               "x_centre=1 y_centre=0.5 /")
   call refuse(6, "", "x_min is given, but only the shape 'rectangle'", &
               and_1="&domain shape='disc' x_min=0 "// &
               "x_centre=1 y_centre=0.5 radius=2 /")
   call refuse(6, "", "radius is given, but only the shape 'disc'", &
               and_1=trim(good(1) (:len_trim(good(1)) - 1))//" radius=2 /")
   call refuse(6, trim(good(6)), "", accepted=.true., and_1="&domain shape='disc' x_centre=1 "// &
               "y_centre=0.5 radius=2 /")
   call delete_file(path)
   call checks%finish()

contains

   subroutine accept(name, line, text)
      character(len=*), intent(in) :: name, text
      integer, intent(in) :: line

      call refuse(line, text, name, accepted=.true.)
   end subroutine accept

   !> One line of the good scene is another one; then it is refused with these words.
   subroutine refuse(line, text, words, accepted, and_1, and_4)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, words
      logical, intent(in), optional :: accepted  !< the scene is good
      character(len=*), intent(in), optional :: and_1, and_4  !< other lines too
      character(len=160) :: lines(size(good))
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      lines = good
      lines(line) = text
      if (present(and_1)) lines(1) = and_1
      if (present(and_4)) lines(4) = and_4
      call put_lines(path, lines)
      call read_scene(path, scene, error)
      if (present(accepted)) then
         call checks%no_error(error, text)
      else
         call checks%fails_with(error, words, text)
      end if
   end subroutine refuse

end program test_scene_mechanics
