!> ParaView collections (.pvd): which file holds which time.
module output_pvd
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: exact_text
   use output_files, only: write_text_file
   use output_text, only: newline, text_buffer_t
   implicit none(type, external)
   private

   public :: collection_t

   !> One collection. Only files that are complete may be added.
   type :: collection_t
      integer :: n_files = 0
      character(len=:), allocatable, private :: path
      type(text_buffer_t), private :: entries
      integer, private :: written = 0  !< files in the collection on disk
   contains
      procedure :: open => open_collection
      procedure :: add
      procedure :: flush => flush_collection
   end type collection_t

contains

   !> Begin a collection; it is on disk only once it has a file.
   subroutine open_collection(self, path)
      class(collection_t), intent(out) :: self
      character(len=*), intent(in) :: path

      self%path = path
   end subroutine open_collection

   !> Add a file.
   subroutine add(self, time, file)
      class(collection_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: file  !< path from the collection's directory

      call self%entries%append('    <DataSet timestep="'//exact_text(time)//'" part="0" file="'// &
                               file//'"/>'//newline)
      self%n_files = self%n_files + 1
   end subroutine add

   !> Write the collection whole, if it has changed.
   subroutine flush_collection(self, error)
      class(collection_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%n_files == self%written) return
      call write_text_file(self%path, &
                           '<?xml version="1.0"?>'//newline// &
                           '<VTKFile type="Collection" version="1.0">'//newline// &
                           "  <Collection>"//newline//self%entries%text()// &
                           "  </Collection>"//newline//"</VTKFile>"//newline, error)
      if (.not. allocated(error)) self%written = self%n_files
   end subroutine flush_collection

end module output_pvd
