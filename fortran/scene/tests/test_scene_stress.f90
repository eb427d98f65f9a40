!> The stress that a scene states, against closed forms: given in situ, by tractions, by held sides
!! (uniaxial strain), by both; and the tractions of fractures in it.
program test_scene_stress
   use base_kinds, only: pi, rk
   use scene_stress, only: far_stress_t, find_far_stress, part_t, parts_of_scene
   use scene_types, only: boundary_part_t, fracture_t, point_load_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: nu = 0.2_rk, tight = 1.0e-12_rk
   type(checks_t) :: checks

   call test_tractions()
   call test_held()
   call test_in_situ()
   call test_parts()
   call test_depth()
   call test_unknown()
   call checks%finish()

contains

   function body() result(s)
      type(scene_t) :: s

      s%domain%x_max = 4.0_rk
      s%domain%y_max = 2.0_rk
      s%material%young = 40.0e9_rk
      s%material%poisson = nu
      s%material%biot = 0.7_rk
      s%fractures = [fracture_t ::]
      s%parts = [boundary_part_t ::]
      s%point_loads = [point_load_t ::]
      s%restraints = [restraint_t ::]
   end function body

   subroutine expect(s, xx, yy, xy, name)
      type(scene_t), intent(in) :: s
      real(rk), intent(in) :: xx, yy, xy  !< [MPa]
      character(len=*), intent(in) :: name
      type(far_stress_t) :: far

      call find_far_stress(s, far)
      call checks%is_true(.not. allocated(far%unknown), name//": known")
      call compare(far%stress_at(1.0_rk), 1.0e6_rk*[xx, yy, xy], name)
   end subroutine expect

   !> Stresses of some 30 MPa.
   subroutine compare(values, expected, name)
      real(rk), intent(in) :: values(:), expected(:)  !< [Pa]
      character(len=*), intent(in) :: name
      integer :: i

      do i = 1, size(values)
         call checks%is_close(values(i), expected(i), 30.0e6_rk*tight, name)
      end do
   end subroutine compare

   subroutine test_tractions()
      type(scene_t) :: s

      s = body()
      s%sides(1)%displacement_given(1) = .true.
      s%sides(3)%displacement_given(2) = .true.
      s%sides(2)%traction(1) = -20.0e6_rk
      s%sides(4)%normal_traction = -10.0e6_rk
      call expect(s, -20.0_rk, -10.0_rk, 0.0_rk, "two loaded sides")
      s%sides(3)%displacement_given(2) = .false.
      s%sides(3)%traction(2) = 10.0e6_rk
      s%initial%pressure = 3.0e6_rk
      call expect(s, -20.0_rk, -10.0_rk, 0.0_rk, "opposite tractions are total ones")
      s = body()
      s%sides%shear_traction = [2.0e6_rk, 2.0e6_rk, -2.0e6_rk, -2.0e6_rk]
      call expect(s, 0.0_rk, 0.0_rk, 2.0_rk, "shear")
      s%sides%shear_traction = 0.0_rk
      s%sides(1)%traction(2) = -2.0e6_rk
      s%sides(2)%traction(2) = 2.0e6_rk
      s%sides(3)%traction(1) = -2.0e6_rk
      s%sides(4)%traction(1) = 2.0e6_rk
      call expect(s, 0.0_rk, 0.0_rk, 2.0_rk, "the same shear by components")
   end subroutine test_tractions

   !> Held in x: strain in y alone, so that the change of the stress in x is nu/(1 - nu) of it.
   subroutine test_held()
      type(scene_t) :: s
      real(rk) :: across, along

      s = body()
      s%sides(1:2)%displacement_given(1) = .true.
      s%sides(3)%displacement_given(2) = .true.
      s%sides(4)%traction(2) = -10.0e6_rk
      call expect(s, -10.0_rk*nu/(1.0_rk - nu), -10.0_rk, 0.0_rk, "uniaxial strain")
      s%initial%pressure = 2.0e6_rk
      ! From -0.7 2 MPa on: the change in y is -8.6 MPa.
      call expect(s, -1.4_rk - 8.6_rk*nu/(1.0_rk - nu), -10.0_rk, 0.0_rk, "from a pressure on")
      s%material%plane_stress = .true.
      s%initial%pressure = 0.0_rk
      call expect(s, -10.0_rk*nu, -10.0_rk, 0.0_rk, "in plane stress")
      s = body()
      s%sides(1:2)%displacement_given(1) = .true.
      s%sides(3:4)%displacement_given(2) = .true.
      s%sides(2)%displacement(1) = -4.0e-4_rk
      along = 40.0e3_rk*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
      across = 40.0e3_rk*(1.0_rk - nu)/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
      call expect(s, -1.0e-4_rk*across, -1.0e-4_rk*along, 0.0_rk, "a strain of 1e-4")
   end subroutine test_held

   subroutine test_in_situ()
      type(scene_t) :: s

      s = body()
      s%in_situ%stress = [-20.0e6_rk, -15.0e6_rk, 3.0e6_rk]
      s%sides(1)%displacement_given(1) = .true.
      s%sides(3)%displacement_given(2) = .true.
      call expect(s, -20.0_rk, -15.0_rk, 3.0_rk, "in situ")
      s%sides(2)%traction(1) = -1.0e6_rk
      call expect(s, -21.0_rk, -15.0_rk, 3.0_rk, "and a traction, which is added")
      s%sides(2)%displacement_given(1) = .true.
      s%sides(4)%traction(2) = -4.0e6_rk
      call expect(s, -21.0_rk, -19.0_rk, 3.0_rk, "and held sides")
      s%domain%shape = "disc"
      call expect(s, -20.0_rk, -15.0_rk, 3.0_rk, "in a disc")
   end subroutine test_in_situ

   !> The circle of Mohr for any angle, friction with cohesion, and a bend.
   subroutine test_parts()
      type(scene_t) :: s
      type(far_stress_t) :: far
      type(part_t), allocatable :: parts(:)
      real(rk) :: angle, normal, shear
      integer :: i

      s = body()
      s%in_situ%stress = [-20.0e6_rk, -10.0e6_rk, 0.0_rk]
      s%initial%pressure = 2.0e6_rk
      do i = 0, 11
         angle = pi*i/12.0_rk
         s%fractures = [fracture_t(name="f", x=[1.0_rk, 1.0_rk + 0.3_rk*cos(angle)], &
                                   y=[1.0_rk, 1.0_rk + 0.3_rk*sin(angle)], friction=0.5_rk)]
         call find_far_stress(s, far)
         parts = parts_of_scene(s, far)
         ! A fracture along x bears the 10 MPa of y.
         normal = 15.0e6_rk - 5.0e6_rk*cos(2.0_rk*angle)
         shear = abs(5.0e6_rk*sin(2.0_rk*angle))
         call checks%is_close(parts(1)%normal, normal, 30.0e6_rk*tight, "normal traction")
         call checks%is_close(parts(1)%shear, shear, 30.0e6_rk*tight, "shear traction")
         call checks%is_close(parts(1)%tendency(), shear/(normal - 2.0e6_rk), tight, "tendency")
         call checks%is_close(parts(1)%slips_at, normal - 2.0_rk*shear, 90.0e6_rk*tight, "slips")
         call checks%is_close(parts(1)%opens_at, normal, 30.0e6_rk*tight, "opens")
      end do
      s%fractures = [fracture_t(name="f", x=[1.0_rk, 2.0_rk, 2.0_rk], friction=0.5_rk, &
                                y=[0.5_rk, 1.5_rk, 1.8_rk], cohesion=1.0e6_rk, &
                                tensile_strength=0.5e6_rk)]
      parts = parts_of_scene(s, far)
      call checks%is_true(size(parts) == 2, "two parts")
      call compare(parts%slips_at, [7.0e6_rk, 20.5e6_rk], "with cohesion")
      call compare(parts%opens_at, [15.5e6_rk, 20.5e6_rk], "and strength")
      s%fractures%friction = 0.0_rk
      s%fractures%cohesion = 0.0_rk
      parts = parts_of_scene(s, far)
      call checks%is_true(parts(1)%slips_at < -1.0e300_rk, "without friction it slips always")
   end subroutine test_parts

   !> The end that slips first where stress and pressure grow with depth: the deeper one here, with
   !! the ratio of shear to effective normal traction the same at both.
   subroutine test_depth()
      type(scene_t) :: s
      type(far_stress_t) :: far
      type(part_t), allocatable :: parts(:)

      s = body()
      s%in_situ%per_y = [15.0e3_rk, 25.0e3_rk]
      s%in_situ%y_datum = 1000.0_rk
      s%fluid%density = 1000.0_rk
      s%gravity(2) = -10.0_rk
      s%fractures = [fracture_t(name="f", x=[1.0_rk, 2.0_rk], y=[0.5_rk, 1.5_rk], friction=0.6_rk)]
      call find_far_stress(s, far)
      parts = parts_of_scene(s, far)
      ! Per metre of depth 20 kPa, 5 kPa and 10 kPa of pressure: it slips 5/0.6 kPa below 20.
      call checks%is_close(parts(1)%y, 1.5_rk, tight, "the upper end: the smallest rise")
      call checks%is_close(parts(1)%slips_at - parts(1)%pressure, &
                           998.5_rk*(20.0e3_rk - 5.0e3_rk/0.6_rk - 10.0e3_rk), 1.0e-6_rk, "rise")
   end subroutine test_depth

   subroutine test_unknown()
      type(scene_t) :: s

      s = body()
      s%sides(2)%traction(1) = -20.0e6_rk
      call refuse(s, "opposite sides bear different tractions")
      s = body()
      s%sides(2)%spring(1) = 1.0e9_rk
      call refuse(s, "the sides have springs")
      s = body()
      s%gravity(2) = -9.81_rk
      s%material%density = 2600.0_rk
      call refuse(s, "the weight of the rock loads it, without a stress in situ")
      s = body()
      s%sides(1)%shear_traction = 1.0e6_rk
      call refuse(s, "the sides bear different shear tractions")
      s = body()
      s%point_loads = [point_load_t(1.0_rk, 1.0_rk, [0.0_rk, 1.0_rk])]
      call refuse(s, "points of the body are loaded or held")
      s = body()
      s%domain%shape = "disc"
      call refuse(s, "the body is no rectangle, and has no stress in situ")
   end subroutine test_unknown

   subroutine refuse(s, words)
      type(scene_t), intent(in) :: s
      character(len=*), intent(in) :: words
      type(far_stress_t) :: far

      call find_far_stress(s, far)
      call checks%is_true(allocated(far%unknown), words)
      if (allocated(far%unknown)) call checks%is_true(far%unknown == words, far%unknown)
   end subroutine refuse

end program test_scene_stress
