!> Lists of strings, each of its own length.
module base_texts
   implicit none(type, external)
   private

   public :: add_once, add_text, text_t

   !> A string of its own length.
   type :: text_t
      character(len=:), allocatable :: text
   end type text_t

contains

   !> Add a string to a list.
   pure subroutine add_text(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text
      type(text_t), allocatable :: longer(:)
      integer :: n

      n = 0
      if (allocated(list)) n = size(list)
      allocate (longer(n + 1))
      if (n > 0) longer(1:n) = list
      longer(n + 1)%text = text
      call move_alloc(longer, list)
   end subroutine add_text

   !> Add a string to a list that does not have it yet.
   subroutine add_once(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text
      integer :: i

      if (allocated(list)) then
         do i = 1, size(list)
            if (list(i)%text == text) return
         end do
      end if
      call add_text(list, text)
   end subroutine add_once

end module base_texts
