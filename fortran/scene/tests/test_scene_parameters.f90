!> The table of parameters is consistent in itself.
program test_scene_parameters
   use base_kinds, only: ik
   use scene_expression, only: token_list_t, tokenize
   use scene_parameter_table, only: parameters
   use scene_parameters, only: choice_name, choice_value, groups, kind_choice, kind_logical, &
                               kind_name, kind_real, kind_text, need_always, need_choice, &
                               need_never, parameter_t
   use scene_values, only: default_value, read_value, value_t
   use scene_words, only: in_words
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   integer :: i, first, last

   do i = 1, size(groups)
      first = findloc(parameters%group == groups(i)%name, .true., dim=1)
      last = findloc(parameters%group == groups(i)%name, .true., dim=1, back=.true.)
      call checks%is_true(first > 0, trim(groups(i)%name)//" has parameters")
      call checks%is_true(all(parameters(first:last)%group == groups(i)%name), &
                          trim(groups(i)%name)//" has its parameters in one piece")
      call checks%is_true(groups(i)%meaning /= "", trim(groups(i)%name)//" has a meaning")
      call checks%is_true(count(groups%name == groups(i)%name) == 1, trim(groups(i)%name)// &
                          " is one group")
   end do
   do i = 1, size(parameters)
      call check_parameter(parameters(i))
      call check_others(parameters(i))
   end do
   call checks%finish()

contains

   subroutine check_parameter(item)
      type(parameter_t), intent(in) :: item
      character(len=:), allocatable :: name, fault, reason
      type(token_list_t) :: tokens
      type(value_t) :: value
      integer(ik) :: fault_line

      name = trim(item%group)//" "//trim(item%name)
      call checks%is_true(any(groups%name == item%group), name//" belongs to a group")
      call checks%is_true(count(parameters%group == item%group .and. &
                                parameters%name == item%name) == 1, name//" is one parameter")
      call checks%is_true(item%meaning /= "", name//" has a meaning")
      call checks%is_true(len_trim(item%meaning) < len(item%meaning), name// &
                          ": its meaning is not cut off")
      if (item%kind /= kind_real) call checks%is_true((item%kind == kind_choice) .eqv. &
                                                      (item%choices /= ""), name// &
                                                      " and its choices")
      if (any(item%kind == [kind_choice, kind_logical, kind_name, &
                            kind_text])) call checks%is_true(item%unit == "-" .and. &
                                                             in_words(item%range, &
                                                                      whole=.false.) == "", name// &
                                                             " is no number")
      if (item%need == need_always) then
         call checks%is_true(item%default == "" .and. item%absent == "", name//" is required")
      end if
      if (item%need == need_never) then
         call checks%is_true((item%default == "") .neqv. (item%absent == ""), &
                             name//" has a default or tells what its absence means")
      end if
      if (item%default == "") return
      call tokenize(trim(item%default), tokens, fault, fault_line)
      call read_value(item, item%default, tokens%items(1:tokens%length - 1), value, reason)
      call checks%is_true(.not. allocated(reason), name//" has a valid default")
      call default_value(item, value)
      call checks%is_true(value%is_set .and. value%line == 0, name//" gets its default")
   end subroutine check_parameter

   !> The names that a parameter speaks of stand in its group and can be compared with it.
   subroutine check_others(item)
      type(parameter_t), intent(in) :: item
      character(len=:), allocatable :: name
      integer, parameter :: most_together = 3
      integer :: k, other

      name = trim(item%group)//" "//trim(item%name)
      call checks%is_true(item%need /= need_choice .or. item%of /= "", name//" has a choice")
      if (item%of /= "") then
         other = index_of(item%group, choice_name(item))
         call checks%is_true(parameters(other)%kind == kind_choice, name//" belongs to a choice")
         call checks%is_true(index("|"//trim(parameters(other)%choices)//"|", &
                                   "|"//choice_value(item)//"|") > 0, name//" has one of its words")
      end if
      if (item%with /= "") then
         ! What must be given together refers one to the next, and the last to the first.
         other = index_of(item%group, item%with)
         do k = 2, most_together
            if (parameters(other)%with /= item%name) then
               other = index_of(item%group, parameters(other)%with)
            end if
         end do
         call checks%is_true(parameters(other)%with == item%name, name//" and those with it")
      end if
      if (item%at_most /= "") then
         other = index_of(item%group, item%at_most)
         call checks%is_true(all([item%kind, parameters(other)%kind] == kind_real) .and. &
                             item%unit == parameters(other)%unit, name//" and its bound")
      end if
   end subroutine check_others

   !> Where a name of a group stands; it must.
   integer function index_of(group, name) result(other)
      character(len=*), intent(in) :: group, name

      other = findloc(parameters%group == group .and. parameters%name == name, .true., dim=1)
      if (other == 0) error stop "a name that its group does not have"
   end function index_of

end program test_scene_parameters
