!> Gravity, densities and a stress in situ in scenes with a fluid: what is accepted, and what is
!! refused with which words.
program test_scene_column
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_changed, put_lines
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_column.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: good(*) = [character(len=100) :: &
      "&domain x_min=0 x_max=200 y_min=-2100 y_max=-2000 /", &  ! 1
      "&material young=3e10 poisson=0.25 biot=0.8 porosity=0.1 permeability=1e-16", &  ! 2
      "  density=2500 /", &  ! 3
      "&fluid compressibility=4.5e-10 viscosity=1e-3", &  ! 4
      "  density=1000 /", &  ! 5
      "&gravity y=-10 /", &  ! 6
      "&in_situ sxx_per_y=1.7e4", &  ! 7
      "  syy_per_y=2.5e4 /", &  ! 8
      "&side name='left' x_displacement=0 /", &  ! 9
      "&side name='bottom' y_displacement=0 /", &  ! 10
      "&side name='top' pressure=0 /", &  ! 11
      "&time end=1e6 /", &  ! 12
      "&coarse size_boundary=15 /"]  ! 13
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call put_lines(path, good)
   call read_scene(path, scene, error)
   call checks%no_error(error, "a basin")
   call checks%is_true(scene%fluid%vapour_pressure >= 0.0, "its pressures count from vacuum")
   call accept(8, "  syy_per_y=2.501e4 /", 8, "  syy_per_y=2.501e4 /", "a rounded gradient")
   call accept(7, "&in_situ sxx=-3e7 syy=-5e7", 8, "/", "weight as a load beside a stress")
   call accept(5, "/", 5, "/", "a fluid without weight")
   call accept(7, "&in_situ", 8, "y_datum=-2000 /", "weight as a load")
   call check_faults()
   call delete_file(path)
   call checks%finish()

contains

   !> One of the good lines is another one.
   subroutine check_faults()
      call refuse(6, "", ":8: &in_situ: syy_per_y is 25000.0 but must balance the weight: "// &
                  "density times gravity requires 0.0 Pa/m"//doc)
      call refuse(8, "  syy_per_y=2e4 /", ":8: &in_situ: syy_per_y is 20000.0 but must "// &
                  "balance the weight: density times gravity requires 25000.0 Pa/m"//doc)
      call refuse(8, "  syy_per_y=-2.5e4 /", ":8: &in_situ: syy_per_y is -25000.0 but must "// &
                  "balance the weight: density times gravity requires 25000.0 Pa/m"//doc)
      call refuse(3, "/", ":6: &gravity: is given, but the material has no density"//doc)
      call refuse(6, "&gravity x=1 y=-10 /", ":6: &gravity: x is 1.0 but must be 0, since an "// &
                  "in-situ stress that varies only with y balances no weight in x"//doc)
      call refuse(5, "  density=0 /", ":5: &fluid: density is 0 but must be a finite number "// &
                  "greater than 0.0 [kg/m3]"//doc)
      call refuse(5, "  density=1g/cm3 /", ":5: &fluid: density is 1g but must be a finite "// &
                  "number greater than 0.0 [kg/m3]"//doc)
      call refuse(7, "&in_situ sxx_per_x=1.7e4", ":7: &in_situ: unknown name sxx_per_x, the "// &
                  "nearest is sxx_per_y"//doc)
      call put_changed(path, good, 3, "  density=99 /", 8, "  syy_per_y=990 /")
      call expect(":3: &material: density is 99.0 but must be at least that of the fluid in "// &
                  "its pores, porosity times density of &fluid: 100.0"//doc)
      call check_weightless()
      call check_layers()
   end subroutine check_faults

   !> A region of another density.
   subroutine check_layers()
      character(len=*), parameter :: layer = &
                                     "&region name='b' x=-1,300,300,-1 y=-2200,-2200,-2050,-2050"
      character(len=100) :: lines(size(good) + 1)

      lines(:size(good)) = good
      lines(7:8) = ""
      lines(size(lines)) = layer//" density=2700 /"
      call put_lines(path, lines)
      call read_scene(path, scene, error)
      call checks%no_error(error, "two layers that settle")
      if (.not. allocated(error)) then
         call checks%is_close(scene%regions(1)%material%density, 2700.0_rk, 0.0_rk, "density")
      end if
      lines(7) = "&in_situ sxx=-3e7 syy=-5e7 /"
      call put_lines(path, lines)
      call read_scene(path, scene, error)
      call checks%no_error(error, "beside a stress that does not change with y")
      lines(7) = "&in_situ sxx_per_y=1.7e4 syy_per_y=2.5e4 /"
      call put_lines(path, lines)
      call expect(":14: &region: density is 2700.0 but must be that of &material, 2500.0, "// &
                  "with a stress in situ that varies with y: one gradient does not balance "// &
                  "two weights; omit sxx_per_y and syy_per_y, so that the body settles under "// &
                  "its weight"//doc)
      lines(5:7) = [character(len=100) :: "/", "", ""]
      call put_lines(path, lines)
      call expect(":14: &region: density is 2700.0 but there is no gravity; give &gravity, or "// &
                  "omit the density"//doc)
      lines(5:6) = [character(len=100) :: "  density=1000 /", "&gravity y=-10 /"]
      lines(size(lines)) = layer//" density=99 /"
      call put_lines(path, lines)
      call expect(":14: &region: density is 99.0 but must be at least that of the fluid in its "// &
                  "pores, porosity times density of &fluid: 100.0"//doc)
      lines(size(lines)) = layer//" density=0 /"
      call put_lines(path, lines)
      call expect(":14: &region: density is 0 but must be a finite number greater than 0.0 "// &
                  "[kg/m3]"//doc)
   end subroutine check_layers

   !> No gravity, no stress in situ, but a density of the fluid; and gravity askew with one.
   subroutine check_weightless()
      character(len=100) :: lines(size(good))

      lines = good
      lines(6:8) = ""
      call put_lines(path, lines)
      call expect(":5: &fluid: density is 1000.0 but there is no gravity; give &gravity y, on "// &
                  "earth -9.81, or omit the density"//doc)
      lines(6) = "&gravity x=1 y=-10 /"
      call put_lines(path, lines)
      call expect(":6: &gravity: x is 1.0 but must be 0, since the pressure of a fluid with a "// &
                  "density varies only with y"//doc)
   end subroutine check_weightless

   subroutine accept(number_1, line_1, number_2, line_2, name)
      integer, intent(in) :: number_1, number_2
      character(len=*), intent(in) :: line_1, line_2, name

      call put_changed(path, good, number_1, line_1, number_2, line_2)
      call read_scene(path, scene, error)
      call checks%no_error(error, name)
   end subroutine accept

   subroutine refuse(number, line, message)
      integer, intent(in) :: number
      character(len=*), intent(in) :: line, message

      call put_changed(path, good, number, line, number, line)
      call expect(message)
   end subroutine refuse

   subroutine expect(message)
      character(len=*), intent(in) :: message

      call read_scene(path, scene, error)
      call checks%fails_by(error, path//message)
   end subroutine expect

end program test_scene_column
