!> Mutated scene files through what `check` does, many to a process (docs/sweeps.md):
!!
!!    mutated_scenes check FIRST LAST SCENE.nml ...   judge the mutated files FIRST to LAST
!!    mutated_scenes write FIRST LAST SCENE.nml ...   leave them as mutated-NUMBER.nml, beside each
!!                                                    that is a scene scene-NUMBER.nml, as of a run
!!
!! Each file stands on disk while it is judged: one that ends the process is still there, and its
!! name has its number. An alarm ends the process if a file takes too long.
program mutated_scenes
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit
   use app_geometry, only: check_geometry
   use app_size, only: check_size, describe_scene
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: integer_text
   use scene_mutations, only: mutator_t
   use scene_namelist, only: read_scene
   use scene_sheet, only: sheet_t
   use scene_test_files, only: delete_file, put_bytes, same_scene
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use verification_files, only: integer_argument, text_argument
   implicit none(type, external)

   interface
      !> End the process after so many seconds; 0: do not. POSIX.
      integer(c_int) function alarm(seconds) bind(c)
         import :: c_int
         implicit none(type, external)
         integer(c_int), value :: seconds
      end function alarm
   end interface

   integer(c_int), parameter :: time_limit = 20_c_int  !< for one file [s]
   integer, parameter :: longest_message = 1000  !< characters
   real(rk), parameter :: memory = 16.0e9_rk  !< of the machine that scenes are judged for [byte]
   type(mutator_t) :: mutator
   character(len=:), allocatable :: path, again, fault
   real(rk) :: began, ended, slowest
   integer(lk) :: number, slowest_number
   integer :: i, n_refused, n_accepted, n_faults, page
   integer(c_int) :: seconds_left
   logical :: is_taken, is_refused

   do i = 4, command_argument_count()
      call mutator%load(text_argument(i), is_taken)
      if (.not. is_taken) call stop_with(text_argument(i)//" cannot be read")
   end do
   n_refused = 0
   n_accepted = 0
   n_faults = 0
   slowest = 0.0_rk
   slowest_number = 0_lk
   open (newunit=page, status="scratch", action="readwrite")
   do number = integer_argument(2), integer_argument(3)
      path = "mutated-"//integer_text(int(number, ik))//".nml"
      call put_bytes(path, mutator%mutated(number))
      again = "scene-"//path(len("mutated-") + 1:)
      call cpu_time(began)
      seconds_left = alarm(time_limit)
      call judge(is_refused, fault)
      seconds_left = alarm(0_c_int)
      call cpu_time(ended)
      if (ended - began > slowest) then
         slowest = ended - began
         slowest_number = number
      end if
      if (is_refused) n_refused = n_refused + 1
      if (.not. is_refused) n_accepted = n_accepted + 1
      if (allocated(fault)) then
         n_faults = n_faults + 1
         write (error_unit, "(3a)") path, ": ", fault
      else if (text_argument(1) /= "write") then
         call delete_file(path)
         if (.not. is_refused) call delete_file(again)
      end if
   end do
   print "(2(i0,a),i0,a,f0.3,a,i0)", n_refused, " refused, ", n_accepted, " accepted, ", n_faults, &
      " faults, slowest ", slowest, " s: ", slowest_number
   if (n_faults > 0) error stop 1, quiet = .true.

contains

   !> Read, describe, write and read again.
   subroutine judge(is_refused, fault)
      logical, intent(out) :: is_refused
      character(len=:), allocatable, intent(out) :: fault  !< what is wrong; unallocated: nothing
      type(sheet_t) :: sheet
      type(scene_t) :: scene, scene_again
      real(rk) :: n_cells(2)
      type(error_t), allocatable :: error

      call read_scene(path, scene, error, sheet)  ! as `check` does
      if (.not. allocated(error)) call check_size(sheet, scene, memory, error)
      if (.not. allocated(error)) call check_geometry(sheet, scene, n_cells, error)
      if (.not. allocated(error)) call check_size(sheet, scene, memory, error, n_cells)
      is_refused = allocated(error)
      if (is_refused) then
         call judge_message(error%message, fault)
         return
      end if
      call put_bytes(again, scene_text(scene))
      call read_scene(again, scene_again, error)  ! the geometry is the same if the scene is
      if (allocated(error)) then
         fault = "scene.nml cannot be read: "//error%message
         return
      end if
      if (.not. same_scene(scene, scene_again)) fault = "scene.nml is another scene"
      if (scene_text(scene_again) /= scene_text(scene)) fault = "scene.nml is another text"
      call judge_page(scene, n_cells, fault)
   end subroutine judge

   !> A refusal is one line that begins with the file.
   subroutine judge_message(message, fault)
      character(len=*), intent(in) :: message
      character(len=:), allocatable, intent(inout) :: fault
      integer :: k

      if (index(message, path) /= 1) fault = "the refusal does not name the file: "//message
      if (len(message) > longest_message) fault = "the refusal is too long"
      do k = 1, len(message)
         if (iachar(message(k:k)) >= 32) cycle
         fault = "the refusal has a control character"
      end do
   end subroutine judge_message

   !> What `check` prints has no counts below 0 and nothing but numbers for numbers.
   subroutine judge_page(scene, n_cells, fault)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: n_cells(2)  !< as expected
      character(len=:), allocatable, intent(inout) :: fault
      character(len=1024) :: line
      integer :: status

      rewind (page)
      call describe_scene(scene, n_cells, page)
      endfile (page)
      rewind (page)
      do
         read (page, "(a)", iostat=status) line
         if (status /= 0) exit
         if (index(line, "title:") == 1 .or. index(line, "scene:") == 1) cycle
         if (index(line, "**") > 0 .or. index(line, "NaN") > 0 .or. index(line, "Infinity") > 0 &
             .or. index(line, " -") > 0 .and. index(line, "load factor") /= 1) then
            fault = "check prints '"//trim(line)//"'"
         end if
      end do
   end subroutine judge_page

   subroutine stop_with(reason)
      character(len=*), intent(in) :: reason

      write (error_unit, "(a)") reason
      error stop 2, quiet = .true.
   end subroutine stop_with

end program mutated_scenes
