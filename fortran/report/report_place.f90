!> The folder of a run. Nothing in it is touched before it is sure that this run may have it, and
!! what an earlier run has left there stays until this one has something to put in its place.
module report_place
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik
   use base_number, only: integer_text
   use base_texts, only: text_t
   use report_files, only: make_directory, remove_file
   implicit none(type, external)
   private

   public :: place_t

   character(len=*), parameter :: top_files(11) = [character(len=15) :: "scene.nml", "run.json", &
      & "history.csv", "tips.csv", "fractures.csv", "probes.csv", "network.json", "events.csv", &
      & "slip_events.csv", "wells.csv", "run.log"]

   integer(c_int), parameter :: is_held = -1  !< by another run; as in report_place.c
   integer(c_int), parameter :: no_hold = -2

   !> The folder, held against other runs from `claim` to `release` or the end of the process.
   type :: place_t
      character(len=:), allocatable :: directory
      integer(c_int), private :: hold = no_hold
   contains
      procedure :: claim
      procedure :: has_results
      procedure :: clear
      procedure :: check
      procedure :: release
   end type place_t

   interface
      function c_same_file(a, b) result(answer) bind(C, name="output_same_file")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: a(*)
         ! allow(C071)
         character(kind=c_char), intent(in) :: b(*)
         integer(c_int) :: answer
      end function c_same_file

      function c_hold_folder(path, holder) result(hold) bind(C, name="output_hold_folder")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(out) :: holder
         integer(c_int) :: hold
      end function c_hold_folder

      function c_is_folder(path, hold) result(answer) bind(C, name="output_is_folder")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: hold
         integer(c_int) :: answer
      end function c_is_folder

      subroutine c_release_folder(hold) bind(C, name="output_release_folder")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: hold
      end subroutine c_release_folder
   end interface

contains

   !> Make the folder and hold it. `refused`: the folder is a wrong choice, and nothing was written.
   subroutine claim(self, directory, source, refused, error)
      class(place_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: source  !< path of the scene that is run; empty: no file
      logical, intent(out) :: refused
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: holder
      integer :: i

      self%directory = trim(directory)
      refused = .false.
      do i = 1, size(top_files)
         if (source == "") exit
         refused = c_same_file(source//c_null_char, path_in(self, top_files(i))//c_null_char) /= 0
         if (refused) then
            call raise_error(error, "", "the run would replace "//source//" by its own "// &
                             trim(top_files(i))//": name another folder than "//self%directory// &
                             " with --out")
            return
         end if
      end do
      call make_directory(self%directory, error)
      if (allocated(error)) then
         refused = leads_through_file(self%directory)
         return
      end if
      self%hold = c_hold_folder(self%directory//c_null_char, holder)
      refused = self%hold == is_held
      if (refused) call raise_error(error, "", "another run"//process_text(holder)// &
                                    " writes into "//self%directory// &
                                    ": wait for its end, or name another folder with --out")
   end subroutine claim

   !> A path, or the beginning of it, is that of a file and no folder.
   function leads_through_file(path) result(answer)
      character(len=*), intent(in) :: path
      logical :: answer, exists, is_folder
      integer :: i

      answer = .false.
      do i = 1, len(path)
         if (i < len(path)) then
            if (path(i + 1:i + 1) /= "/") cycle
         end if
         inquire (file=path(:i), exist=exists)
         inquire (file=path(:i)//"/.", exist=is_folder)
         answer = answer .or. (exists .and. .not. is_folder)
      end do
   end function leads_through_file

   !> Which process, where that is known.
   pure function process_text(process) result(text)
      integer(c_int), intent(in) :: process
      character(len=:), allocatable :: text

      text = ""
      if (process > 0) text = " (process "//integer_text(int(process, ik))//")"
   end function process_text

   !> A run has left files here.
   function has_results(self)
      class(place_t), intent(in) :: self
      logical :: has_results
      integer :: i

      do i = 1, size(top_files)
         inquire (file=path_in(self, top_files(i)), exist=has_results)
         if (has_results) return
      end do
   end function has_results

   !> Remove what an earlier run has left, but scene.nml, which this one has written.
   subroutine clear(self)
      class(place_t), intent(in) :: self
      logical :: was_there
      integer :: i

      do i = 1, size(top_files)
         call remove_file(path_in(self, top_files(i))//".part", was_there)
         if (top_files(i) /= "scene.nml") call remove_file(path_in(self, top_files(i)), was_there)
      end do
   end subroutine clear

   !> Somebody has removed or replaced the folder, or files of the run that were written before.
   subroutine check(self, files, error)
      class(place_t), intent(in) :: self
      type(text_t), intent(in) :: files(:)  !< paths in the folder
      type(error_t), allocatable, intent(out) :: error
      logical :: exists
      integer :: i

      if (c_is_folder(self%directory//c_null_char, self%hold) == 0) then
         call raise_error(error, "", "the folder "//self%directory// &
                          " was removed or replaced during the run")
         return
      end if
      do i = 1, size(files)
         inquire (file=path_in(self, files(i)%text), exist=exists)
         if (exists) cycle
         call raise_error(error, "", path_in(self, files(i)%text)//" was removed during the run")
         return
      end do
   end subroutine check

   !> Let other runs have the folder.
   subroutine release(self)
      class(place_t), intent(inout) :: self

      if (self%hold >= 0_c_int) call c_release_folder(self%hold)
      self%hold = no_hold
   end subroutine release

   pure function path_in(place, name) result(path)
      class(place_t), intent(in) :: place
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: path

      path = place%directory//"/"//trim(name)
   end function path_in

end module report_place
