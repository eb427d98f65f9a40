!> Corners of fractures: kinks from 10 degrees on, ends on other fractures, crossings, and a
!! fracture that crosses itself; none where fractures pass each other or go straight on.
program test_report_corners
   use base_kinds, only: ik, rk
   use report_corners, only: joints_of_scene, kinks_of_scene
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call test_none()
   call test_kinks()
   call test_joints()
   call test_itself()
   call checks%finish()

contains

   subroutine test_none()
      type(scene_t) :: scene

      call checks%is_true(size(kinks_of_scene(scene)) == 0, "no fractures, no kinks")
      call checks%is_true(size(joints_of_scene(scene)) == 0, "no fractures, no joints")
   end subroutine test_none

   !> Turns of 9, 11 and 90 degrees.
   subroutine test_kinks()
      type(scene_t) :: scene
      real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk
      real(rk), parameter :: turn(4) = [9.0_rk, 11.0_rk, 90.0_rk, 0.0_rk]*degree
      real(rk), allocatable :: places(:, :)
      real(rk) :: turned, x(5), y(5)
      integer(ik) :: i

      x(1) = 3.0_rk
      y(1) = -1.0_rk
      turned = 0.0_rk
      do i = 2, 5
         x(i) = x(i - 1) + cos(turned)
         y(i) = y(i - 1) + sin(turned)
         turned = turned + turn(i - 1)
      end do
      allocate (scene%fractures(1))
      scene%fractures(1)%x = x
      scene%fractures(1)%y = y
      places = kinks_of_scene(scene)
      call checks%is_true(size(places, 2) == 2, "9 degrees are no kink, 11 and 90 are")
      if (size(places, 2) /= 2) return
      call checks%is_close(maxval(abs(places(:, 1) - [x(3), y(3)])), 0.0_rk, 0.0_rk, "11 degrees")
      call checks%is_close(maxval(abs(places(:, 2) - [x(4), y(4)])), 0.0_rk, 0.0_rk, "90 degrees")
      call checks%is_true(size(joints_of_scene(scene)) == 0, "a kink is no joint")
   end subroutine test_kinks

   !> A crossing, an end on another fracture, and one that passes.
   subroutine test_joints()
      type(scene_t) :: scene
      real(rk), allocatable :: places(:, :)

      allocate (scene%fractures(4))
      scene%fractures(1)%x = [0.0_rk, 2.0_rk]
      scene%fractures(1)%y = [0.0_rk, 0.0_rk]
      scene%fractures(2)%x = [0.5_rk, 0.5_rk]
      scene%fractures(2)%y = [-1.0_rk, 1.0_rk]
      scene%fractures(3)%x = [1.5_rk, 2.5_rk]
      scene%fractures(3)%y = [0.0_rk, 1.0_rk]
      scene%fractures(4)%x = [3.0_rk, 4.0_rk]
      scene%fractures(4)%y = [0.0_rk, 1.0_rk]
      places = joints_of_scene(scene)
      call checks%is_true(size(places, 2) == 2, "a crossing and an end")
      if (size(places, 2) /= 2) return
      call checks%is_close(maxval(abs(places(:, 1) - [0.5_rk, 0.0_rk])), 0.0_rk, 1.0e-15_rk, &
                           "crossing")
      call checks%is_close(maxval(abs(places(:, 2) - [1.5_rk, 0.0_rk])), 0.0_rk, 1.0e-15_rk, "end")
   end subroutine test_joints

   subroutine test_itself()
      type(scene_t) :: scene
      real(rk), allocatable :: places(:, :)

      allocate (scene%fractures(1))
      scene%fractures(1)%x = [0.0_rk, 2.0_rk, 2.0_rk, 1.0_rk]
      scene%fractures(1)%y = [0.0_rk, 0.0_rk, 1.0_rk, -1.0_rk]
      places = joints_of_scene(scene)
      call checks%is_true(size(places, 2) == 1, "crosses itself once")
      if (size(places, 2) /= 1) return
      call checks%is_close(maxval(abs(places(:, 1) - [1.5_rk, 0.0_rk])), 0.0_rk, 1.0e-15_rk, &
                           "where")
   end subroutine test_itself

end program test_report_corners
