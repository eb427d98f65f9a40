!> Regions of the rock: outlines of every shape, what is refused with which words, and that a scene
!> with regions comes back from its own file.
program test_scene_regions
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_plane, only: polygon_area
   use scene_namelist, only: read_scene
   use scene_region_outline, only: body_part, region_outline
   use scene_test_files, only: delete_file, put_bytes, put_changed, put_lines, same_scene
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_regions.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: good(*) = [character(len=100) :: &
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 1
      "&material young=1e10 poisson=0.2 biot=0.8 porosity=0.01 permeability=1e-15 /", &  ! 2
      "&fluid compressibility=4.0e-10 viscosity=1.0e-3 /", &  ! 3
      "&region name='p' x=0.1, 0.5, 0.5, 0.1", &  ! 4
      "  y=0.1, 0.1, 0.4, 0.4 permeability=1e-14 /", &  ! 5
      "&region name='h' shape='half_plane' x=1.5, 1.5", &  ! 6
      "  y=1.0, 0.0 permeability_xx=1e-14 permeability_yy=2e-14 permeability_xy=-1e-14 /", &  ! 7
      "&region name='b' shape='band' x=-1, 0.5, 3 y=0.5, 0.7, 0.5", &  ! 8
      "  x_other=-1, 3 y_other=0.9, 0.9 permeability=1e-16 /", &  ! 9
      "&region name='c' shape='parabola' x_vertex=1.2, 1.4 y_vertex=2*0.5", &  ! 10
      "  curvature=2*1.0 permeability=1e-13 young=3e9 poisson=0.3 biot=0.9 porosity=0.2 /", &  ! 11
      "&side name='left' x_displacement=0.0 /", &  ! 12
      "&side name='bottom' y_displacement=0.0 /", &  ! 13
      "&time end=1.0 step=1.0 /", &  ! 14
      "&coarse size_boundary=0.1 /"]  ! 15
   !&>
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(scene_t) :: scene

   call check_outlines()
   call check_names()
   call check_points()
   call check_permeability()
   call check_rock()
   call check_round_trip()
   call delete_file(path)
   call checks%finish()

contains

   !> Areas of regions, and of their parts in the body.
   subroutine check_outlines()
      call put_lines(path, good)
      call read_scene(path, scene, error)
      call checks%no_error(error, "the scene without a fault")
      call area_is(1, 0.12_rk, 0.12_rk, "polygon")
      ! The half-plane right of x = 1.5 ends as far outside of the body as this is large.
      call area_is(2, 2.5_rk*3.0_rk, 0.5_rk, "half-plane")
      ! Under y = 0.9, over a roof from (-1, 0.5) over (0.5, 0.7) to (3, 0.5).
      call area_is(3, 1.6_rk - 0.4_rk, 0.8_rk - roof(), "band")
      call area_is(4, 0.2_rk*1.02_rk, 0.2_rk, "between parabolas")
      call checks%is_close(scene%regions(2)%material%young, 1.0e10_rk, 0.0_rk, "the scene's rock")
      call checks%is_close(scene%regions(2)%material%permeability_xy, -1.0e-14_rk, 0.0_rk, &
                           "and its own")
      ! All right of one parabola: 2 - 1.2 less the mean of (y - 1/2)^2.
      call put_changed(path, good, 10, "&region name='c' shape='parabola' x_vertex=1.2 "// &
                       "y_vertex=0.5", 11, "curvature=1.0 permeability=1e-13 /")
      call read_scene(path, scene, error)
      call checks%no_error(error, "one parabola")
      call checks%is_close(polygon_area(body_part(scene%regions(4), scene%domain)), &
                           0.8_rk - 1.0_rk/12.0_rk, 1.0e-5_rk, "right of a parabola")
   end subroutine check_outlines

   !> Area between y = 1/2 and the roof within the body.
   pure real(rk) function roof()
      roof = 0.5_rk*(2.0_rk/15.0_rk + 0.2_rk)*0.5_rk + 0.5_rk*(0.2_rk + 0.08_rk)*1.5_rk
   end function roof

   subroutine area_is(i, whole, part, name)
      integer, intent(in) :: i
      real(rk), intent(in) :: whole, part  !< [m2]
      character(len=*), intent(in) :: name

      associate (region => scene%regions(i), body => scene%domain)
         call checks%is_close(polygon_area(region_outline(region, body)), whole, 1.0e-12_rk, name)
         call checks%is_close(polygon_area(body_part(region, body)), part, 1.0e-12_rk, &
                              name//" in the body")
      end associate
   end subroutine area_is

   subroutine check_names()
      call refuse(6, "&region name='p' shape='half_plane' x=1.5, 1.5", ":6: &region: name 'p' "// &
                  "is already taken on line 4 but must be unique")
      call refuse(6, "&region name='h' shape='disc' x=1.5, 1.5", ":6: &region: shape is 'disc' "// &
                  "but must be 'polygon', 'half_plane', 'band' or 'parabola'"//doc)
     call refuse(6, "&region name='h' shape='half_plane' x=1.5, 1.5 x_vertex=1", ":6: &region: "// &
                 "x_vertex is given, but only the shape 'parabola' has it, and not 'half_plane'"// &
                  doc)
      call refuse(9, "  x_other=-1, 3 permeability=1e-16 /", ":8: &region: y_other [m], which "// &
                  "the shape 'band' needs, is missing"//doc)
      call refuse(8, "&region name='b' shape='band' x=-1, 0.5, 3", ":8: &region: y [m], which "// &
                  "the shape 'band' needs, is missing"//doc)
      call refuse(10, "&region name='c' shape='parabola' x=1 x_vertex=1.2, 1.4 y_vertex=2*0.5", &
                ":10: &region: x is given, but the shape 'parabola' has x_vertex, y_vertex and "// &
                  "curvature instead"//doc)
      call refuse(3, "", ":5: &region: permeability needs a fluid, but the group &fluid is "// &
                  "missing"//doc)
   end subroutine check_names

   subroutine check_points()
    call refuse(5, "  y=0.1, 0.1, 0.4 permeability=1e-14 /", ":5: &region: y of region 'p' has "// &
                  "3 values but must have as many as x, 4"//doc)
      call refuse(4, "&region name='p' x=0.1, 0.5", ":4: &region: x of region 'p' has 2 values "// &
                  "but the shape 'polygon' must have 3 to 2000"//doc)
      call refuse(6, "&region name='h' shape='half_plane' x=1.5, 1.5, 1.5", ":6: &region: x of "// &
                  "region 'h' has 3 values but the shape 'half_plane' must have 2"//doc)
     call refuse(7, "  y=2*1.0 permeability=1e-14 /", ":6: &region: x of region 'h' and y give "// &
                  "one point twice but must give two, a line"//doc)
    call refuse(11, "  curvature=1.0 permeability=1e-13 /", ":11: &region: curvature of region "// &
                  "'c' has 1 value but must have as many as x_vertex, 2"//doc)
      ! A bow tie; a spike; corners on an edge; parabolas and curves that cross.
    call refuse(5, "  y=0.1, 0.4, 0.1, 0.4 permeability=1e-14 /", ":4: &region: x and the rest "// &
                  "of region 'p' give an outline that crosses or touches itself near "// &
                  "(0.1, 0.1) but its edges must meet at their ends only"//doc)
    call refuse(5, "  y=0.1, 0.3, 0.2, 0.4 permeability=1e-14 /", ":4: &region: x and the rest "// &
                  "of region 'p' give an outline that crosses or touches itself near "// &
                  "(0.1, 0.1) but its edges must meet at their ends only"//doc, &
                  and_4="&region name='p' x=0.1, 0.5, 0.5, 0.5")
      call refuse(11, "  curvature=2.0, 1.0 permeability=1e-13 /", ":10: &region: x_vertex and "// &
                  "the rest of region 'c' give an outline that crosses or touches itself near ")
      call refuse(9, "  x_other=3, -1 y_other=0.9, 0.9 permeability=1e-16 /", ":8: &region: x "// &
                  "and the rest of region 'b' give an outline that crosses or touches itself near ")
      call refuse(5, "  y=1.1, 1.1, 1.4, 1.4 permeability=1e-14 /", ":4: &region: x and the "// &
                  "rest of region 'p' define a region outside the body, but it must contain a "// &
                  "part of the body"//doc)
      call refuse(5, "  y=1.0, 1.0, 1.4, 1.4 permeability=1e-14 /", ":4: &region: x and the "// &
                  "rest of region 'p' define a region outside the body, but it must contain a "// &
                  "part of the body"//doc)
   end subroutine check_points

   subroutine check_permeability()
      call refuse(5, "  y=0.1, 0.1, 0.4, 0.4 /", ":4: &region: name is given, but the region "// &
                  "has no rock properties: it must have at least one of young, poisson, biot, "// &
                  "porosity, permeability, density, toughness, heat_capacity, heat_conductivity"// &
                  ", heat_expansion"//doc)
     call refuse(5, "  y=0.1, 0.1, 0.4, 0.4 permeability=-1e-14 /", ":5: &region: permeability "// &
                  "is -1e-14 but must be a finite number greater than 0.0 [m2]"//doc)
      call refuse(5, "  y=0.1, 0.1, 0.4, 0.4 permeability=1e-14 permeability_xx=1e-14 /", &
                  ":5: &region: permeability is given with components of the tensor, but only "// &
                  "one of the two may be given"//doc)
      call refuse(7, "  y=1.0, 0.0 permeability_xx=1e-14 /", ":6: &region: permeability_yy is "// &
                  "missing but must be given with the other components of the tensor"//doc)
      call refuse(7, "  y=1.0, 0.0 permeability_xx=1e-14 permeability_yy=1e-14 "// &
                  "permeability_xy=2e-14 /", ":7: &region: permeability_xy is 2.0e-14 but must "// &
                  "be smaller than sqrt(permeability_xx permeability_yy), since the tensor "// &
                  "must be positive definite"//doc)
      call refuse(7, "  y=1.0, 0.0 permeability_xx=1e-14 permeability_yy=1e-18 /", &
                  ":7: &region: permeability_xx and the other components make the rock "// &
                  "10000.0 times more permeable in one direction than across it, but the flux "// &
                  "approximation is valid for a ratio of at most 1000.0"//doc)
      call refuse(7, "  y=1.0, 0.0 permeability_xx=1e-14 permeability_yy=1e-14 "// &
                  "permeability_xy=0.9999e-14 /", ":7: &region: permeability_xx and the other "// &
                  "components make the rock 20000.0 times more permeable in one direction "// &
                  "than across it, but the flux approximation is valid for a ratio of at most "// &
                  "1000.0"//doc)
      call refuse(5, "  y=0.1, 0.1, 0.4, 0.4 permeability=1e-28 /", ":5: &region: permeability "// &
                "of region 'p' and the permeability of the rock around it or of another region "// &
                  "differ by more than a factor of 1e12 but must not"//doc)
   end subroutine check_permeability

   !> The rock of a region, each of its numbers and what follows from them together.
   subroutine check_rock()
      character(len=*), parameter :: first = "  y=0.1, 0.1, 0.4, 0.4 "

      call refuse(5, first//"young=-1e9 /", ":5: &region: young is -1e9 but must be a finite "// &
                  "number greater than 0.0 [Pa]"//doc)
      call refuse(5, first//"poisson=0.5 /", ":5: &region: poisson is 0.5 but must be a finite "// &
                  "number greater than -1.0 and less than 0.5"//doc)
      call refuse(5, first//"porosity=0.9 /", ":5: &region: porosity of region 'p' makes its "// &
                  "Biot coefficient 0.8 smaller than its porosity, 0.9, but it must be at "// &
                  "least that"//doc)
      call refuse(5, first//"biot=0.005 /", ":5: &region: biot of region 'p' makes its Biot "// &
                  "coefficient 0.005 smaller than its porosity, 0.01, but it must be at least "// &
                  "that"//doc)
      call refuse(5, first//"biot=0.0 porosity=0.0 /", ":5: &region: biot of region 'p' gives "// &
                  "no storage: phi c_p and the part of the solid are both zero, but their sum "// &
                  "must be positive"//doc)
      call refuse(3, "&fluid compressibility=0.0 viscosity=1.0e-3 /", ":4: &region: name 'p' "// &
                  "stands for a rock whose Skempton coefficient B = alpha/(K S + alpha^2) is "// &
                  "1.429 with a fluid of no compressibility, but that must be at most 1", &
                  and_4="&region name='p' x=0.1, 0.5, 0.5, 0.1 biot=0.5 porosity=0.4")
      call refuse(5, first//"toughness=1e6 /", ":5: &region: toughness of region 'p' is given, "// &
                  "but that of &material, which the rest of the body has, is missing"//doc)
      call refuse(5, first//"young=1e20 /", ":5: &region: young of region 'p' and that of the "// &
                  "rock around it or of another region differ by more than a factor of 1e9 "// &
                  "but must not"//doc)
      call refuse(5, first//"density=2700.0 /", ":5: &region: density is 2700.0 but there is "// &
                  "no gravity; give &gravity, or omit the density"//doc)
   end subroutine check_rock

   subroutine check_round_trip()
      type(scene_t) :: first, second

      call put_lines(path, good)
      call read_scene(path, first, error)
      call put_bytes(path, scene_text(first))
      call read_scene(path, second, error)
      call checks%no_error(error, "a written scene")
      call checks%is_true(same_scene(first, second), "comes back the same")
   end subroutine check_round_trip

   !> One line of the good scene is another one; then it is refused with these words.
   subroutine refuse(line, text, words, and_4)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, words
      character(len=*), intent(in), optional :: and_4  !< the fourth line too
      type(scene_t) :: changed

      if (present(and_4)) then
         call put_changed(path, good, line, text, 4, and_4)
      else
         call put_changed(path, good, line, text, line, text)
      end if
      call read_scene(path, changed, error)
      call checks%fails_with(error, words, words)
   end subroutine refuse

end program test_scene_regions
