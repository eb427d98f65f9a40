!> Polygons, arcs of discs and gravity: what is accepted, and what is refused with which words.
program test_scene_bodies
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_check_geometry, only: holds_point
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_changed
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_bodies.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   ! An L of 2 m with its notch at (1, 1), given clockwise; edge 6 is the floor, 3 and 4 the notch.
   character(len=100), parameter :: polygon(*) = [character(len=100) :: &
      "&domain shape='polygon' x=0, 0, 1, 1, 2, 2", &  ! 1
      "  y=0, 2, 2, 1, 1, 0 /", &  ! 2
      "&material young=1e9 poisson=0.2 density=2000 /", &  ! 3
      "&fracture name='f' x=0, 0.5 y=2*1.0 law='open' /", &  ! 4
      "&side name='floor' edges=6 x_displacement=0 y_displacement=0 /", &  ! 5
      "&side name='top' edges=2, 4 normal_traction=-1e6 /", &  ! 6
      "&gravity y=-10 /", &  ! 7
      "&in_situ sxx_per_y=1e4 syy_per_y=2e4 y_datum=2 /", &  ! 8
      "&fe size_fracture=0.1 size_boundary=0.3 /"]  ! 9
   character(len=100), parameter :: disc(*) = [character(len=100) :: &
      "&domain shape='disc' x_centre=1 y_centre=0", &  ! 1
      "  radius=0.5 /", &  ! 2
      "&material young=1e9 poisson=0.2 /", &  ! 3
      "&restraint x=1 y=0 x_displacement=0 y_displacement=0 /", &  ! 4
      "&restraint x=1.5 y=0 y_displacement=0 /", &  ! 5
      "&side name='a' arc_from_deg=80 arc_to_deg=100 normal_traction=-1e6 /", &  ! 6
      "&side name='b' arc_from_deg=-100 arc_to_deg=-80 y_traction=1e6 /", &  ! 7
      "", &  ! 8
      "&fe size_boundary=0.3 /"]  ! 9
   !&>
   character(len=100) :: good(9)
   type(checks_t) :: checks
   type(error_t), allocatable :: error

   good = polygon
   call accept(8, trim(good(8)), "the polygon without a fault")
   call check_corners()
   call check_polygon_sides()
   call check_probes()
   call check_weight()
   good = disc
   call accept(8, "", "the disc without a fault")
   call check_arcs()
   call check_geometry()
   call delete_file(path)
   call checks%finish()

contains

   subroutine check_corners()
      call refuse(2, "  y=0, 2, 2, 1, 1 /", ":2: &domain: y has 5 values but must have as many "// &
                  "as x, 6"//doc)
     call refuse_two(1, "&domain shape='polygon' x=0, 1", 2, "y=0, 1 /", ":1: &domain: x has 2 "// &
                      "values but must have at least 3, the corners of the polygon"//doc)
      call refuse(1, "&domain shape='polygon' x_min=0 x=0, 0, 1, 1, 2, 2", ":1: &domain: x_min "// &
                  "is given, but only the shape 'rectangle' has it, and not 'polygon'"//doc)
      call refuse(2, "/", ":1: &domain: y [m], which the shape 'polygon' needs, is missing"//doc)
      ! Corners may divide a straight edge, and run counter-clockwise.
      call accept_two(1, "&domain shape='polygon' x=2, 2, 1, 1, 0.5, 0, 0", 2, &
                      "  y=0, 1, 1, 2, 2, 2, 0 /", "seven corners")
   end subroutine check_corners

   subroutine check_polygon_sides()
    call refuse(5, "&side name='floor' x_displacement=0 y_displacement=0 /", ":5: &side: edges "// &
                  "is missing, but a side of a polygon needs the numbers of its edges"//doc)
      call refuse(5, "&side name='floor' edges=7 x_displacement=0 y_displacement=0 /", &
                  ":5: &side: edges has 7 but must be at most 6, the number of edges"//doc)
      call refuse(5, "&side name='floor' edges=0 x_displacement=0 y_displacement=0 /", &
                  ":5: &side: edges is 0 but must be a whole number at least 1"//doc)
      call refuse(5, "&side name='floor' edges=1.5 x_displacement=0 y_displacement=0 /", &
                  ":5: &side: edges is 1.5 but must be a whole number at least 1"//doc)
     call refuse(6, "&side name='top' edges=2, 6 y_traction=1 /", ":6: &side: name 'top' has a "// &
                  "part of the boundary that side 'floor' has, but sides must not overlap"//doc)
      call refuse(6, "&side name='top' edges=2 normal_traction=-1 y_traction=1 /", ":6: "// &
                  "&side: normal_traction is given with y_traction, but a side has either "// &
                  "normal and shear tractions, or values in x and y"//doc)
      call refuse(6, "&side name='top' edges=2 shear_traction=-1 x_displacement=0 /", &
                  ":6: &side: shear_traction is given with x_displacement")
    call refuse(6, "&side name='top' edges=2 arc_to_deg=1 /", ":6: &side: arc_to_deg is given, "// &
                  "but only a disc has arcs"//doc)
      call refuse(5, "&side name='floor' edges=6 y_displacement=0 /", "give a &side or a "// &
                  "&restraint an x_displacement")
      call refuse(5, "&side name='wall' edges=1, 6 y_displacement=0 /", "give a &side or a "// &
                  "&restraint an x_displacement")
      call accept(5, "&side name='walls' edges=1, 5 x_displacement=0 /"// &
                  "&restraint x=0 y=0 y_displacement=0 /", "held by walls and a point")
      call accept(6, "", "an unloaded polygon")
   end subroutine check_polygon_sides

   subroutine check_probes()
      call refuse(4, "&probe name='p' x=1.1 y=1.1 /", "(1.1, 1.1) but must lie within the domain")
   end subroutine check_probes

   subroutine check_weight()
      call refuse(3, "&material young=1e9 poisson=0.2 /", ":7: &gravity: is given, but the "// &
                  "material has no density"//doc)
      call refuse(8, "&in_situ syy_per_y=-2e4 /", ":8: &in_situ: syy_per_y is -20000.0 but "// &
                  "must balance the weight: density times gravity requires 20000.0 Pa/m"//doc)
      call refuse(7, "", ":8: &in_situ: syy_per_y is 20000.0 but must balance the weight")
      call refuse(7, "&gravity x=1 y=-10 /", ":7: &gravity: x is 1.0 but must be 0")
      call accept(8, "", "gravity as a load")
      call accept(7, "&in_situ sxx_per_y=1e4 /", "no weight", and_8="")
      call refuse(7, "&gravity y=nan /", ":7: &gravity: y is nan but must be a finite number "// &
                  "like 4.0e10 [m/s2]"//doc)
   end subroutine check_weight

   subroutine check_arcs()
      call accept(7, "&side name='b' arc_from_deg=100 arc_to_deg=430 x_traction=1 /", "neighbours")
      call accept(6, "&side name='rim' normal_traction=-1e6 /", "the whole rim", and_7="")
    call refuse(7, "&side name='b' arc_from_deg=90 arc_to_deg=120 x_traction=1 /", ":7: &side: "// &
                  "name 'b' has a part of the boundary that side 'a' has, but sides must not "// &
                  "overlap"//doc)
      call refuse(7, "&side name='b' arc_from_deg=200 arc_to_deg=445 x_traction=1 /", &
                  "sides must not overlap")
      call refuse(7, "&side name='b' x_traction=1 /", "sides must not overlap")
    call refuse(7, "&side name='b' arc_from_deg=200 x_traction=1 /", ":7: &side: arc_to_deg is "// &
                  "missing but must be given with arc_from_deg"//doc)
      call refuse(7, "&side name='b' arc_from_deg=200 arc_to_deg=190 x_traction=1 /", ":7: "// &
                 "&side: arc_to_deg is 190.0 but must be above arc_from_deg, 200.0, by at most "// &
                  "360"//doc)
      call refuse(7, "&side name='b' edges=1 x_traction=1 /", ":7: &side: edges is given, but "// &
                  "only a polygon has edges"//doc)
      call accept(4, "", "held by an arc", and_7="&side name='b' arc_from_deg=-100 "// &
                  "arc_to_deg=-80 x_displacement=0 y_displacement=0 /")
      call refuse(2, "  radius=0.5 x=0, 1, 1 /", "x is given, but only the shape "// &
                  "'polygon' has it, and not 'disc'")
   end subroutine check_arcs

   !> Places that are known, beside and in a notch.
   subroutine check_geometry()
      real(rk), parameter :: x(7) = [0.0_rk, 4.0_rk, 4.0_rk, 2.5_rk, 2.0_rk, 1.5_rk, 0.0_rk]
      real(rk), parameter :: y(7) = [0.0_rk, 0.0_rk, 2.0_rk, 2.0_rk, 1.0_rk, 2.0_rk, 2.0_rk]

      call checks%is_true(holds_point(x, y, [2.0_rk, 0.99_rk]), "below the notch")
      call checks%is_true(holds_point(x, y, [2.0_rk, 1.0_rk]), "in the notch's corner")
      call checks%is_true(holds_point(x, y, [2.25_rk, 1.5_rk]), "on its side")
      call checks%is_true(.not. holds_point(x, y, [2.0_rk, 1.01_rk]), "in the notch")
      call checks%is_true(.not. holds_point(x, y, [-1.0_rk, 2.0_rk]), "beside the body")
   end subroutine check_geometry

   subroutine accept(line, text, name, and_7, and_8)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, name
      character(len=*), intent(in), optional :: and_7, and_8  !< other lines too

      if (present(and_7)) then
         call accept_two(line, text, 7, and_7, name)
      else if (present(and_8)) then
         call accept_two(line, text, 8, and_8, name)
      else
         call accept_two(line, text, line, text, name)
      end if
   end subroutine accept

   subroutine accept_two(line_1, text_1, line_2, text_2, name)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2, name

      call read_changed(line_1, text_1, line_2, text_2, error)
      call checks%no_error(error, name)
   end subroutine accept_two

   !> One line of the good scene is another one; then it is refused with these words.
   subroutine refuse(line, text, words)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, words

      call refuse_two(line, text, line, text, words)
   end subroutine refuse

   subroutine refuse_two(line_1, text_1, line_2, text_2, words)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2, words

      call read_changed(line_1, text_1, line_2, text_2, error)
      call checks%fails_with(error, words, words)
   end subroutine refuse_two

   subroutine read_changed(line_1, text_1, line_2, text_2, error)
      integer, intent(in) :: line_1, line_2
      character(len=*), intent(in) :: text_1, text_2
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: scene

      call put_changed(path, good, line_1, text_1, line_2, text_2)
      call read_scene(path, scene, error)
   end subroutine read_changed

end program test_scene_bodies
