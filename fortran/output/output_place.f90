!> The folder of a run: nothing in it is touched before it is sure that this run may have it.
module output_place
   use base_errors, only: error_t, raise_error
   use base_paths, only: hold_folder, hold_is_taken, path_folder, path_kind, path_nothing, &
                         release_folder, same_file
   use output_files, only: make_directory, remove_file
   implicit none(type, external)
   private

   public :: place_t

   character(len=*), parameter :: top_files(9) = [character(len=13) :: "scene.nml", "run.json", &
      & "history.csv", "tips.csv", "fractures.csv", "probes.csv", "network.json", "events.csv", &
      & "run.log"]
   integer, parameter :: scene_file = 1  !< in top_files

   !> The folder, held against other runs from `claim` to `release` or the end of the process.
   type :: place_t
      character(len=:), allocatable :: directory
      logical :: has_scene = .false.  !< the scene that is run is its scene.nml, as it would be
      integer, private :: hold = -2
   contains
      procedure :: claim
      procedure :: clear
      procedure :: release
   end type place_t

contains

   !> Make the folder and hold it. `refused`: the folder is a wrong choice, and nothing was made.
   subroutine claim(self, directory, source, scene_text, refused, error)
      class(place_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: source  !< path of the scene that is run; empty: no file
      character(len=*), intent(in) :: scene_text  !< of the scene.nml to be written
      logical, intent(out) :: refused
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      self%directory = trim(directory)
      refused = .true.
      if (all(path_kind(self%directory) /= [path_nothing, path_folder])) then
         call raise_error(error, "", self%directory//" is no folder: name another one with --out")
         return
      end if
      do i = 1, size(top_files)
         if (source == "") exit
         if (.not. same_file(source, self%directory//"/"//trim(top_files(i)))) cycle
         self%has_scene = i == scene_file .and. has_text(source, scene_text)
         if (self%has_scene) cycle
         call raise_error(error, "", "the run would write its own "//trim(top_files(i))// &
                          " over the scene "//source//": name another folder with --out")
         return
      end do
      refused = .false.
      call make_directory(self%directory, error)
      if (allocated(error)) return
      self%hold = hold_folder(self%directory)
      refused = self%hold == hold_is_taken
      if (refused) call raise_error(error, "", "another run writes into "//self%directory// &
                                    ": wait for its end or name another folder with --out")
   end subroutine claim

   !> Remove an earlier run's files, but those that this run has begun with.
   subroutine clear(self, kept)
      class(place_t), intent(in) :: self
      character(len=*), intent(in) :: kept  !< besides scene.nml
      logical :: was_there
      integer :: i

      do i = 1, size(top_files)
         call remove_file(self%directory//"/"//trim(top_files(i))//".part", was_there)
         if (i == scene_file .or. top_files(i) == kept) cycle
         call remove_file(self%directory//"/"//trim(top_files(i)), was_there)
      end do
   end subroutine clear

   !> Let other runs have the folder.
   subroutine release(self)
      class(place_t), intent(inout) :: self

      call release_folder(self%hold)
   end subroutine release

   !> A file holds a text and nothing else.
   function has_text(path, text)
      character(len=*), intent(in) :: path, text
      logical :: has_text
      character(len=len(text)) :: there
      integer :: n_bytes, status, unit

      has_text = .false.
      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
            status="old", iostat=status)
      if (status /= 0) return
      inquire (unit, size=n_bytes)
      if (n_bytes == len(text)) then
         read (unit, iostat=status) there
         has_text = status == 0 .and. there == text
      end if
      close (unit)
   end function has_text

end module output_place
