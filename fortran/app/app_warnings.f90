!> Warnings on the terminal.
module app_warnings
   use base_kinds, only: ik
   use base_number, only: integer_text
   use base_texts, only: text_t
   implicit none(type, external)
   private

   public :: show_warnings

   integer, parameter :: shown = 5  !< largest number of printed warnings; run.json has all

contains

   !> Print the number of warnings and the first ones; nothing if there are none.
   subroutine show_warnings(warnings, unit)
      type(text_t), allocatable, intent(in) :: warnings(:)
      integer, intent(in) :: unit
      integer :: i, n

      if (.not. allocated(warnings)) return
      n = size(warnings)
      if (n == 0) return
      write (unit, "(i0,a)") n, trim(merge(" warning: ", " warnings:", n == 1))
      do i = 1, min(n, shown)
         write (unit, "(2a)") "  ", warnings(i)%text
      end do
      if (n > shown) write (unit, "(a)") "  and "//integer_text(int(n - shown, ik))// &
         " more, see warnings in run.json"
   end subroutine show_warnings

end module app_warnings
