!> Carries single values between a group of a sheet and the components of a scene, either way.
module scene_exchange_values
   use base_kinds, only: ik, lk, radians, rk
   use scene_sheet, only: parameter_index, record_t
   use scene_values, only: value_t
   implicit none(type, external)
   private

   public :: exchange, exchange_word, set_text, to_degrees

   !> Copy one value: into the scene if `reading` and the sheet has it, else into the sheet.
   !> A component that equals `nothing` stays out of the sheet.
   interface exchange
      module procedure exchange_real
      module procedure exchange_reals
      module procedure exchange_wholes
      module procedure exchange_integer
      module procedure exchange_logical
      module procedure exchange_text
   end interface exchange

contains

   pure subroutine exchange_real(record, name, component, reading, nothing)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      real(rk), intent(inout) :: component  !< [unit of the name]
      logical, intent(in) :: reading
      real(rk), intent(in), optional :: nothing  !< what an absent value is [unit of the name]

      associate (value => record%values(parameter_index(record%group, name)))
         if (reading) then
            if (value%is_set .and. .not. allocated(value%text)) component = value%reals(1)
         else
            value%is_set = .true.
            if (present(nothing)) value%is_set = .not. same_bits(component, nothing)
            value%reals = [component]
         end if
      end associate
   end subroutine exchange_real

   pure subroutine exchange_reals(record, name, component, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      real(rk), allocatable, intent(inout) :: component(:)  !< [unit of the name]
      logical, intent(in) :: reading

      associate (value => record%values(parameter_index(record%group, name)))
         if (reading) then
            if (value%is_set) component = value%reals
         else
            value%is_set = .true.
            value%reals = component
         end if
      end associate
   end subroutine exchange_reals

   pure subroutine exchange_wholes(record, name, component, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      integer(ik), allocatable, intent(inout) :: component(:)
      logical, intent(in) :: reading

      associate (value => record%values(parameter_index(record%group, name)))
         if (reading) then
            if (value%is_set) component = nint(value%reals, ik)
         else
            value%is_set = .true.
            value%reals = real(component, rk)
         end if
      end associate
   end subroutine exchange_wholes

   pure subroutine exchange_integer(record, name, component, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      integer(ik), intent(inout) :: component
      logical, intent(in) :: reading

      associate (value => record%values(parameter_index(record%group, name)))
         if (reading) then
            if (value%is_set) component = value%whole
         else
            value%is_set = .true.
            value%whole = component
         end if
      end associate
   end subroutine exchange_integer

   pure subroutine exchange_logical(record, name, component, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      logical, intent(inout) :: component
      logical, intent(in) :: reading

      associate (value => record%values(parameter_index(record%group, name)))
         if (reading) then
            if (value%is_set) component = value%flag
         else
            value%is_set = .true.
            value%flag = component
         end if
      end associate
   end subroutine exchange_logical

   pure subroutine exchange_text(record, name, component, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      ! allow(C072)
      character(len=*), intent(inout) :: component
      logical, intent(in) :: reading
      type(value_t) :: value

      if (reading) then
         value = record%value(name)
         if (value%is_set) component = value%text
      else
         call set_text(record, name, trim(component))
      end if
   end subroutine exchange_text

   !> Whether a word stands in the place of a number.
   pure subroutine exchange_word(record, name, word, is_said, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name, word
      logical, intent(inout) :: is_said
      logical, intent(in) :: reading

      associate (value => record%values(parameter_index(record%group, name)))
         if (.not. reading) then
            if (is_said) call set_text(record, name, word)
         else if (value%is_set .and. allocated(value%text)) then
            is_said = value%text == word
         end if
      end associate
   end subroutine exchange_word

   pure subroutine set_text(record, name, text)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name, text

      associate (value => record%values(parameter_index(record%group, name)))
         value%is_set = .true.
         value%text = text
      end associate
   end subroutine set_text

   !> The simplest angle in degrees from which the same bits in radians follow.
   pure real(rk) function to_degrees(angle) result(degrees)
      real(rk), intent(in) :: angle  !< [rad]
      character(len=32) :: style, buffer
      real(rk) :: candidate
      integer :: n_digits, neighbour

      degrees = angle/radians
      do n_digits = 1, 17
         write (style, "(a,i0,a)") "(es32.", n_digits - 1, "e3)"
         write (buffer, style) angle/radians
         read (buffer, "(f32.0)") candidate
         if (same_bits(candidate*radians, angle)) then
            degrees = candidate
            return
         end if
      end do
      do neighbour = -4, 4  ! the product may round away from the angle
         candidate = angle/radians + real(neighbour, rk)*spacing(angle/radians)
         if (same_bits(candidate*radians, angle)) degrees = candidate
      end do
   end function to_degrees

   pure logical function same_bits(a, b)
      real(rk), intent(in) :: a, b  !< [any unit]

      same_bits = transfer(a, 0_lk) == transfer(b, 0_lk)
   end function same_bits

end module scene_exchange_values
