!> Regions by place: which rock counts at a point, how far an interface is, what toughness a tip has
!! before tougher rock, and where a tip is too near to an interface.
program test_report_scene
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use mesh_types, only: network_t
   use report_scene, only: has_other_toughness, interface_distance, keep_off, &
                           regions_of_other_rock, relative_toughness
   use scene_region_outline, only: rock_places_t
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(scene_t) :: scene

   call test_places()
   call test_interfaces()
   call test_toughness()
   call test_other_toughness()
   call checks%finish()

contains

   !> A square of 2 m with the half-plane x > 1 and, over it, the box 0.5 < x < 1.5, 0.5 < y < 1.
   function square() result(scene)
      type(scene_t) :: scene

      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      scene%material%young = 4.0e10_rk
      scene%material%poisson = 0.2_rk
      scene%material%toughness = 1.0e6_rk
      scene%growth%increment = 0.1_rk
      allocate (scene%regions(2))
      scene%regions%material = scene%material
      scene%regions(1)%shape = "half_plane"
      scene%regions(1)%x = [1.0_rk, 1.0_rk]
      scene%regions(1)%y = [2.0_rk, 0.0_rk]
      scene%regions(2)%x = [0.5_rk, 1.5_rk, 1.5_rk, 0.5_rk]
      scene%regions(2)%y = [0.5_rk, 0.5_rk, 1.0_rk, 1.0_rk]
   end function square

   subroutine test_places()
      type(rock_places_t) :: places

      scene = square()
      call places%set(scene)
      call checks%is_true(places%region_at([0.3_rk, 0.7_rk]) == 0, "the rock of the scene")
      call checks%is_true(places%region_at([1.7_rk, 0.7_rk]) == 1, "the half-plane")
      call checks%is_true(places%region_at([1.2_rk, 0.7_rk]) == 2, "the later region counts")
      call checks%is_close(places%distance([1.2_rk, 1.5_rk], [.true., .false.]), 0.2_rk, &
                           1.0e-15_rk, "to the half-plane's line")
      call checks%is_close(places%distance([1.2_rk, 1.5_rk], [.false., .true.]), 0.5_rk, &
                           1.0e-15_rk, "to the box")
      deallocate (scene%regions)
      call places%set(scene)
      call checks%is_true(places%region_at([1.2_rk, 0.7_rk]) == 0, "no regions")
   end subroutine test_places

   !> A tip may have another toughness by a region, or by its fracture, or by both.
   subroutine test_other_toughness()
      logical :: by_region, by_fracture
      integer :: k

      do k = 0, 3
         by_region = modulo(k, 2) == 1
         by_fracture = k > 1
         scene = square()
         allocate (scene%fractures(2))
         if (by_fracture) scene%fractures(2)%toughness = 2.0e6_rk
         if (.not. by_region) deallocate (scene%regions)
         call checks%is_true(has_other_toughness(scene) .eqv. (by_region .or. by_fracture), &
                             "another toughness")
      end do
   end subroutine test_other_toughness

   !> Other toughness or permeability is no interface of elasticity; other stiffness is.
   subroutine test_interfaces()
      type(error_t), allocatable :: error
      real(rk) :: radius

      scene = square()
      scene%regions(1)%material%toughness = 2.0e6_rk
      scene%regions(2)%material%permeability_xx = 1.0e-15_rk
      call checks%is_true(.not. any(regions_of_other_rock(scene)), "elastic constants are equal")
      call checks%is_true(interface_distance(scene, [1.0_rk, 1.0_rk]) >= huge(1.0_rk), "nowhere")
      radius = 0.1_rk
      call keep_off([1.0_rk, 1.0_rk], scene, radius, error)
      call checks%no_error(error, "a tip on the outline of tougher rock")
      call checks%is_close(radius, 0.1_rk, 0.0_rk, "leaves the rosette as it is")

      scene%regions(1)%material%young = 8.0e10_rk
      call checks%is_close(interface_distance(scene, [0.9_rk, 1.8_rk]), 0.1_rk, 1.0e-15_rk, &
                           "to stiffer rock")
      call keep_off([0.9_rk, 1.8_rk], scene, radius, error)
      call checks%no_error(error, "a tip with room for a smaller rosette")
      call checks%is_close(radius, 0.05_rk, 1.0e-15_rk, "half as large as the distance")
      radius = 0.1_rk
      call keep_off([0.9999_rk, 1.8_rk], scene, radius, error)
      call checks%is_true(allocated(error), "a tip next to an interface")
     if (allocated(error)) call checks%is_true(index(error%message, "9.99900E-01") > 0, "its place")
   end subroutine test_interfaces

   !> A tip on its way to the right, y = 1.5: K_IC rises over the last tenth of an increment.
   subroutine test_toughness()
      real(rk), parameter :: x(5) = [0.5_rk, 0.9899_rk, 0.995_rk, 0.99999_rk, 1.2_rk]
      real(rk), parameter :: expected(5) = [1.0_rk, 1.0_rk, 1.25_rk, 1.4995_rk, 1.5_rk]
      integer :: k

      scene = square()
      scene%regions(1)%material%toughness = 1.5e6_rk
      do k = 1, size(x)
         call checks%is_close(relative_toughness(scene, line_to(x(k)), 1_ik, 2_ik), expected(k), &
                              1.0e-9_rk, "toughness ahead")
         call checks%is_close(relative_toughness(scene, line_to(x(k)), 1_ik, 1_ik), 1.0_rk, &
                              1.0e-15_rk, "of the other end")
      end do
      deallocate (scene%regions)
      call checks%is_close(relative_toughness(scene, line_to(1.2_rk), 1_ik, 2_ik), 1.0_rk, &
                           0.0_rk, "of one rock")
   end subroutine test_toughness

   function line_to(x) result(network)
      real(rk), intent(in) :: x  !< [m]
      type(network_t) :: network

      allocate (network%first, source=[1_ik, 3_ik])
      allocate (network%xy, source=reshape([0.2_rk, 1.5_rk, x, 1.5_rk], [2, 2]))
      allocate (network%s_start, source=[0.0_rk])
   end function line_to

end program test_report_scene
