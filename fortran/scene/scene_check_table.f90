!> Checks what the table of parameters says of the names of one group among each other.
module scene_check_table
   use base_errors, only: error_t
   use scene_parameters, only: choice_name, choice_value, parameters
   use scene_sheet, only: parameter_index, record_t, refuse, sheet_t
   use scene_values, only: value_t
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: check_table

contains

   !> Every name belongs to the choice that its group makes, stands together with those that go with
   !! it, and is at most what bounds it.
   pure subroutine check_table(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason
      integer :: i, item

      do i = 1, sheet%length
         associate (record => sheet%records(i))
            do item = lbound(record%values, 1), ubound(record%values, 1)
               call find_fault(record, item, reason)
               if (.not. allocated(reason)) cycle
               call refuse(error, sheet, i, trim(parameters(item)%name), reason)
               return
            end do
         end associate
      end do
   end subroutine check_table

   !> What is wrong with a name, given or not.
   pure subroutine find_fault(record, item, reason)
      type(record_t), intent(in) :: record
      integer, intent(in) :: item
      character(len=:), allocatable, intent(out) :: reason  !< unallocated: nothing is
      type(value_t) :: bound, choice
      integer :: other

      associate (rule => parameters(item), value => record%values(item))
         if (value%line > 0 .and. .not. record%suits(item)) then
            choice = record%value(choice_name(rule))
            reason = "is given, but only the "//choice_name(rule)//" '"//choice_value(rule)// &
                     "' has it, and not '"//choice%text//"'"
            return
         end if
         if (rule%with /= "") then
            other = parameter_index(record%group, rule%with)
            if (value%line == 0 .and. record%values(other)%line > 0) then
               reason = "is missing but must be given with "//trim(rule%with)
            end if
         end if
         if (rule%at_most /= "" .and. value%is_set) then
            bound = record%value(trim(rule%at_most))
            if (.not. bound%is_set) return
            if (value%reals(1) <= bound%reals(1)) return
            reason = "is "//real_text(value%reals(1))//" but must be at most "// &
                     trim(rule%at_most)//", "//real_text(bound%reals(1))
         end if
      end associate
   end subroutine find_fault

end module scene_check_table
