!> What a path leads to, and a hold on a folder that no other process gets meanwhile.
module base_paths
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   implicit none(type, external)
   private

   public :: path_kind, path_nothing, path_file, path_folder, path_pipe, path_device
   public :: hold_folder, hold_is_taken, release_folder, same_file

   ! As in base_paths_system.c.
   integer, parameter :: path_nothing = 0
   integer, parameter :: path_file = 1
   integer, parameter :: path_folder = 2
   integer, parameter :: path_pipe = 3
   integer, parameter :: path_device = 4  !< or a socket; another number: the way is barred

   integer, parameter :: hold_is_taken = -1  !< another process or call holds the folder

   interface
      function c_path_kind(path) result(kind) bind(C, name="base_path_kind")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: kind
      end function c_path_kind

      function c_same_file(a, b) result(answer) bind(C, name="base_same_file")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: a(*)
         ! allow(C071)
         character(kind=c_char), intent(in) :: b(*)
         integer(c_int) :: answer
      end function c_same_file

      function c_hold_folder(path) result(hold) bind(C, name="base_hold_folder")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: hold
      end function c_hold_folder

      subroutine c_release_folder(hold) bind(C, name="base_release_folder")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: hold
      end subroutine c_release_folder
   end interface

contains

   !> What a path leads to: path_nothing .. path_device.
   integer function path_kind(path) result(kind)
      character(len=*), intent(in) :: path

      kind = c_path_kind(trim(path)//c_null_char)
   end function path_kind

   !> Both paths lead to one file, whatever links they take.
   logical function same_file(a, b)
      character(len=*), intent(in) :: a, b

      same_file = c_same_file(trim(a)//c_null_char, trim(b)//c_null_char) /= 0
   end function same_file

   !> Take a hold on a folder until release_folder or the end of the process; hold_is_taken if
   !! another one has it. Where the file system knows no holds, the number is negative too, and
   !! nobody is kept out.
   integer function hold_folder(path) result(hold)
      character(len=*), intent(in) :: path

      hold = c_hold_folder(trim(path)//c_null_char)
   end function hold_folder

   !> Give a hold back; one that was never taken is fine.
   subroutine release_folder(hold)
      integer, intent(inout) :: hold

      if (hold >= 0) call c_release_folder(int(hold, c_int))
      hold = -2
   end subroutine release_folder

end module base_paths
