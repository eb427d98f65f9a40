!> ParaView collections (.pvd): which file holds which time.
!!
!! ParaView wants times in rising order, and shows files of equal time on top of one another. So
!! states of equal time have neighbouring numbers, and those of a falling load stand last first.
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
      logical, private :: is_falling = .false.  !< each time is less than the one before
      real(rk), private :: last = 0.0_rk  !< time in the collection
      type(text_buffer_t), private :: entries  !< lines, in the order in which they were added
      integer, private :: written = 0  !< files in the collection on disk
   contains
      procedure :: open => open_collection
      procedure :: add
      procedure :: flush => flush_collection
   end type collection_t

contains

   !> Begin a collection; it is on disk only once it has a file.
   subroutine open_collection(self, path, is_falling)
      class(collection_t), intent(out) :: self
      character(len=*), intent(in) :: path
      logical, intent(in), optional :: is_falling  !< the times will fall

      self%path = path
      if (present(is_falling)) self%is_falling = is_falling
   end subroutine open_collection

   !> Add a file. Its time in the collection is at least the number next to the time before.
   subroutine add(self, time, file)
      class(collection_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: file  !< path from the collection's directory
      real(rk) :: listed

      listed = time
      if (self%n_files > 0 .and. self%is_falling) then
         listed = min(time, nearest(self%last, -1.0_rk))
      else if (self%n_files > 0) then
         listed = max(time, nearest(self%last, 1.0_rk))
      end if
      call self%entries%append('    <DataSet timestep="'//exact_text(listed)// &
                               '" part="0" file="'//file//'"/>'//newline)
      self%last = listed
      self%n_files = self%n_files + 1
   end subroutine add

   !> Write the collection whole, if it has changed.
   subroutine flush_collection(self, error)
      class(collection_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: lines

      if (self%n_files == self%written) return
      lines = self%entries%text()
      if (self%is_falling) lines = last_first(lines)
      call write_text_file(self%path, &
                           '<?xml version="1.0"?>'//newline// &
                           '<VTKFile type="Collection" version="1.0">'//newline// &
                           "  <Collection>"//newline//lines// &
                           "  </Collection>"//newline//"</VTKFile>"//newline, error)
      if (.not. allocated(error)) self%written = self%n_files
   end subroutine flush_collection

   !> The lines of a text in reverse order.
   pure function last_first(text) result(reversed)
      character(len=*), intent(in) :: text  !< whole lines
      character(len=len(text)) :: reversed
      integer :: first, last, done

      done = 0
      last = len(text)
      do while (last > 0)
         first = index(text(:last - 1), newline, back=.true.) + 1
         reversed(done + 1:done + last - first + 1) = text(first:last)
         done = done + last - first + 1
         last = first - 1
      end do
   end function last_first

end module output_pvd
