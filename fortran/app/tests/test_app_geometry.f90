!> Scenes whose geometry cannot be simulated: refused with file, line, group, names and place.
program test_app_geometry
   use app_geometry, only: check_geometry
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_sheet, only: sheet_t
   use scene_test_files, only: delete_file, put_changed
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_app_geometry.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: wet(*) = [character(len=100) :: &
      "&domain x_min=0 x_max=2 y_min=0 y_max=1 /", &  ! 1
      "&material young=4e10 poisson=0.2 biot=0.8 porosity=0.01 permeability=5e-20 /", &  ! 2
      "&fluid compressibility=4e-10 viscosity=1e-4 /", &  ! 3
      "&fracture name='f1' x=0.9, 1.1 y=2*0.5 friction=0.5 aperture=1e-3 /", &  ! 4
      "&fracture name='f2' x=0.2, 0.4 y=2*0.5 friction=0.5 aperture=1e-3 /", &  ! 5
      "&side name='left' x_displacement=0 y_displacement=0 /", &  ! 6
      "&time end=3600 step=60 /", &  ! 7
      "&coarse size_fracture=0.01 size_boundary=0.1 /"]  ! 8
   ! An L of 2 m with its notch at (1, 1), given clockwise; edge 6 is the floor, 3 and 4 the notch.
   character(len=100), parameter :: polygon(*) = [character(len=100) :: &
      "&domain shape='polygon' x=0, 0, 1, 1, 2, 2", &  ! 1
      "  y=0, 2, 2, 1, 1, 0 /", &  ! 2
      "&material young=1e9 poisson=0.2 /", &  ! 3
      "&fracture name='f' x=0, 0.5 y=2*1.0 law='open' /", &  ! 4
      "&fracture name='g' x=0.3, 0.7 y=2*0.5 law='open' /", &  ! 5
      "&side name='floor' edges=1 x_displacement=0 y_displacement=0 /", &  ! 6
      "&restraint x=2 y=0 y_displacement=0 /", &  ! 7
      "&fe size_fracture=0.1 size_boundary=0.3 /"]  ! 8
   character(len=100), parameter :: disc(*) = [character(len=100) :: &
      "&domain shape='disc' x_centre=1 y_centre=0 radius=0.5 /", &  ! 1
      "&material young=1e9 poisson=0.2 /", &  ! 2
      "&restraint x=1 y=0 x_displacement=0 y_displacement=0 /", &  ! 3
      "&restraint x=1.5 y=0 y_displacement=0 /", &  ! 4
      "&fracture name='f' x=0.9, 1.1 y=2*0.1 law='open' /", &  ! 5
      "&point_load x=1 y=0.5 y_force=-1 /", &  ! 6
      "", &  ! 7
      "&fe size_fracture=0.05 size_boundary=0.1 /"]  ! 8
   !&>
   character(len=100) :: good(8)
   type(checks_t) :: checks
   type(error_t), allocatable :: error

   good = wet
   call accept(5, good(5), "the scene with a fluid")
   call check_fractures()
   call check_joints()
   good = polygon
   call accept(5, good(5), "the polygon")
   call check_polygon()
   good = disc
   call accept(5, good(5), "the disc")
   call check_disc()
   call delete_file(path)
   call checks%finish()

contains

   subroutine check_fractures()
      call refuse(5, wet_fracture("x=0.2, 0.4 y=0.5, 1.5"), ":5: &fracture: fracture 'f2' "// &
                  "leaves the domain at (0.4, 1.5); shorten it or enlarge the domain"//doc)
      call refuse(5, wet_fracture("x=0.2, 0.2, 0.4 y=3*0.5"), ":5: &fracture: fracture 'f2' "// &
                  "has a segment of length 0 m at (0.2, 0.5), which is too short to be meshed; "// &
                  "remove a vertex"//doc)
      call refuse(5, wet_fracture("x=0.2, 0.4 y=2*1"), ":5: &fracture: fracture 'f2' runs "// &
                  "along the boundary at (0.2, 1); a fracture may only end there"//doc)
      call refuse(5, wet_fracture("x=0.2, 0.3, 0.4 y=0.5, 1, 0.5"), ":5: &fracture: fracture "// &
                  "'f2' has an inner vertex on the boundary at (0.3, 1); a fracture may only "// &
                  "end there"//doc)
      call refuse(5, wet_fracture("x=1.1, 0.9 y=2*0.5"), ":4: &fracture: fracture 'f1' and "// &
                  "fracture 'f2' (line 5) overlap at (0.9, 0.5); leave one of them out or move "// &
                  "it"//doc)
      call refuse(5, wet_fracture("x=0.9, 1.1 y=0.5, 0.505"), ":4: &fracture: fracture 'f1' "// &
                  "and fracture 'f2' (line 5) meet at too small an angle at (0.9, 0.5): 1.4321 "// &
                  "degrees; at least 3 are needed"//doc)
      call refuse(5, wet_fracture("x=0.2, 0.4, 0.2 y=0.5, 0.5, 0.505"), ":5: &fracture: parts "// &
                  "of fracture 'f2' meet at too small an angle")
      call refuse(5, wet_fracture("x=1, 1 y=0.500002, 0.7"), ":4: &fracture: fracture 'f1' and "// &
                 "fracture 'f2' (line 5) come within 2e-06 m at (1, 0.500002) without meeting; "// &
                  "let them meet or move them apart"//doc)
      call refuse(5, wet_fracture("x=0.000001, 0.4 y=0, 0.5"), ":5: &fracture: fracture 'f2' "// &
                  "meets the boundary at (1e-06, 0) only 1e-06 m from a corner of the domain; "// &
                  "put them at one place or farther apart"//doc)
   end subroutine check_fractures

   !> With a fluid fractures may touch, also where they grow.
   subroutine check_joints()
      call accept(5, wet_fracture("x=2*1.03125 y=0.4, 0.6"), "fractures with a fluid that cross")
      good(2) = trim(wet(2) (:len_trim(wet(2)) - 1))//" toughness=1e6 /"
      good(8) = trim(wet(8))//" &fine window=0.1 / &growth enabled=.true. /"
      call accept(5, wet_fracture("x=2*1.03125 y=0.4, 0.6"), "fractures that cross and grow")
      call accept(5, wet_fracture("x=2*1.0 y=0.5, 0.6"), "a T that grows")
      call accept(5, wet_fracture("x=1.1, 1.2 y=0.5, 0.6"), "a V that grows")
      call accept(5, wet_fracture("x=0.2, 0.6, 0.6, 0.4 y=0.5, 0.5, 0.6, 0.4"), &
                  "a fracture that crosses itself and grows")
      call accept(5, wet_fracture("x=0.2, 0.3, 0.4 y=0.5, 0.6, 0.5"), "a kink")
      call accept(5, wet_fracture("x=0, 0.3 y=0.5, 0.6"), "an end on the boundary")
      good = wet
   end subroutine check_joints

   !> Corners and edges have the numbers that the file gives them.
   subroutine check_polygon()
      call refuse_two(1, "&domain shape='polygon' x=0, 0, 1, 1, 2, 2, 0", 2, &
                      "  y=0, 2, 2, 1, 1, 0, 0 /", ":1: &domain: corner 1 and corner 7 lie at "// &
                      "one place at (0, 0); give every corner once"//doc)
      call refuse_two(1, "&domain shape='polygon' x=0, 2, 0, 2", 2, "  y=0, 2, 2, 0 /", &
                     ":1: &domain: edge 1 and edge 3 meet, but edges may meet only at a corner "// &
                      "that they share (edge k runs from corner k to the next one)"//doc)
      call refuse_two(1, "&domain shape='polygon' x=0, 0, 2, 2, 1, 2", 2, &
                      "  y=0, 2, 1, 2, 1.2, 0 /", "edge 4 and edge 2 meet")
      call refuse_two(1, "&domain shape='polygon' x=0, 1, 2", 2, "  y=0, 1, 2 /", "too sharp")
      call refuse_two(1, "&domain shape='polygon' x=0, 0, 2, 3, 2, 2", 2, &
                      "  y=0, 2, 1.04, 1.02, 1, 0 /", ":1: &domain: corner 4 at (3, 1.02) is "// &
                      "too sharp to be meshed: less than 3 degrees lie between its edges"//doc)
      call refuse(4, "&fracture name='f' x=0.9, 1.9 y=1.9, 0.9 law='open' /", ":4: &fracture: "// &
                  "fracture 'f' leaves the domain on the way to its vertex at (1.9, 0.9); let "// &
                  "it stay within"//doc)
      call refuse(4, "&fracture name='f' x=1.2, 1.8 y=2*1 law='open' /", "runs along the boundary")
      call refuse(4, "&fracture name='f' x=0.5, 1, 1.5 y=0.5, 1, 0.5 law='open' /", &
                  "has an inner vertex on the boundary at (1, 1)")
      call accept(4, "&fracture name='f' x=1, 0.5 y=1, 0.6 law='open' /", "from the notch's corner")
      call refuse(4, "&fracture name='f' x=0.5, 1.5 y=1.49998, 0.49998 law='open' /", ":4: "// &
                  "&fracture: fracture 'f' passes within 1.41421e-05 m of corner 4 at (1, 1); "// &
                  "let it end there or move it away"//doc)
      call accept(4, "&fracture name='f' x=2*0.5 y=0.3, 0.7 law='open' /", "fractures that cross")
      call refuse(7, "&restraint x=1.5 y=1.5 y_displacement=0 /", ":7: &restraint: the "// &
                  "restraint lies outside the body at (1.5, 1.5); put it inside or on the "// &
                  "boundary"//doc)
      call refuse(7, "&point_load x=0.5 y=0.50001 y_force=1 /", ":7: &point_load: the point "// &
                  "load lies within 1e-05 m of fracture 'g' (line 5) at (0.5, 0.50001); move "// &
                  "it farther away"//doc)
      call refuse(7, "&point_load x=0.5 y=0.5 y_force=1 /", ":7: &point_load: the point load "// &
                  "lies on fracture 'g' (line 5) at (0.5, 0.5), where it would act on one of "// &
                  "its two faces only; move it off the fracture"//doc)
      call refuse(7, "&restraint x=0 y=1 y_displacement=0 /", ":7: &restraint: the restraint "// &
                  "lies on fracture 'f' (line 4) at (0, 1), where it would act")
      call accept(7, "&point_load x=0.7 y=0.5 y_force=1 /", "a load at a tip")
   end subroutine check_polygon

   subroutine check_disc()
     call refuse(5, "&fracture name='f' x=0.9, 1.6 y=2*0.1 law='open' /", "fracture 'f' leaves "// &
                  "the domain at (1.6, 0.1)")
      call accept(5, "&fracture name='f' x=0.5, 0.7 y=2*0 law='open' /", "from the rim")
      call refuse(6, "&point_load x=1 y=0.6 y_force=-1 /", ":6: &point_load: the point load "// &
                  "lies outside the body at (1, 0.6)")
      call refuse(6, "&point_load x=1 y=0.00001 y_force=-1 /", ":6: &point_load: the point "// &
                  "load lies only 1e-05 m from the restraint (line 3) at (1, 1e-05)")
   end subroutine check_disc

   pure function wet_fracture(vertices) result(line)
      character(len=*), intent(in) :: vertices
      character(len=:), allocatable :: line

      line = "&fracture name='f2' "//vertices//" friction=0.5 aperture=1e-3 /"
   end function wet_fracture

   !> One line of the good scene is another one; it is good as well.
   subroutine accept(line, text, name)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, name

      call judge(line, text, line, text, error)
      call checks%no_error(error, name)
   end subroutine accept

   !> One line of the good scene is another one; then it is refused with these words.
   subroutine refuse(line, text, words)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, words

      call refuse_two(line, text, line, text, words)
   end subroutine refuse

   subroutine refuse_two(line_1, text_1, line_2, text_2, words)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2, words

      call judge(line_1, text_1, line_2, text_2, error)
      call checks%fails_with(error, words, words)
   end subroutine refuse_two

   subroutine judge(line_1, text_1, line_2, text_2, error)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene
      type(sheet_t) :: sheet
      real(rk) :: n_cells(2)

      call put_changed(path, good, line_1, text_1, line_2, text_2)
      call read_scene(path, scene, error, sheet)
      call checks%no_error(error, "read: "//trim(text_1))
      if (.not. allocated(error)) call check_geometry(sheet, scene, n_cells, error)
   end subroutine judge

end program test_app_geometry
