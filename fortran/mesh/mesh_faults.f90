!> Inputs refused by the C++ mesh library: the objects at fault, and the message.
module mesh_faults
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_ptr
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik
   use base_number, only: integer_text
   use mesh_c_binding, only: c_string_length, cm_fault_t, cm_last_error, cm_last_fault
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: culprit_t, fault_t, culprit_corner, culprit_edge, culprit_fixed_point
   public :: culprit_fracture, last_fault, raise_library_error, with_name

   ! Kinds of culprits, as cm_culprit_kind of c_api.h.
   integer(ik), parameter :: culprit_fracture = 1
   integer(ik), parameter :: culprit_corner = 2  !< of the specification's boundary
   integer(ik), parameter :: culprit_edge = 3  !< from the corner of the same number
   integer(ik), parameter :: culprit_fixed_point = 4

   !> One of the inputs.
   type :: culprit_t
      integer(ik) :: kind = 0  !< culprit_fracture .. culprit_fixed_point
      integer(ik) :: number = 0  !< which of them
   end type culprit_t

   !> What stands in the way of meshing.
   type :: fault_t
      type(culprit_t), allocatable :: culprits(:)  !< at most two, the one to blame first
      !> A sentence in which {1} and {2} stand for the culprits
      character(len=:), allocatable :: reason
   end type fault_t

contains

   !> Pass on what the library says. Where the network has names it comes from a scene, which has
   !! been found good: its fractures have grown since, and are called by their names; the advice
   !! behind the semicolon, how to change the scene, is left out.
   subroutine raise_library_error(error, origin, network)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: origin
      type(network_t), intent(in), optional :: network
      type(fault_t) :: fault
      character(len=:), allocatable :: reason
      integer(ik) :: i

      reason = text_of(cm_last_error())
      if (present(network)) then
         fault = last_fault()
         if (allocated(network%names) .and. size(fault%culprits) > 0) then
            reason = fault%reason(:index(fault%reason//";", ";") - 1)
            do i = 1, size(fault%culprits, kind=ik)
               reason = with_name(reason, "{"//integer_text(i)//"}", &
                                  name_of(fault%culprits(i), network))
            end do
         end if
      end if
      call raise_error(error, origin, reason)
   end subroutine raise_library_error

   !> What a sentence about a run calls a culprit.
   pure function name_of(culprit, network) result(name)
      type(culprit_t), intent(in) :: culprit
      type(network_t), intent(in) :: network  !< with names
      character(len=:), allocatable :: name

      select case (culprit%kind)
      case (culprit_fracture)
         name = "fracture '"//network%names(culprit%number)%text//"'"
      case (culprit_corner)
         name = "a corner of the body"
      case (culprit_edge)
         name = "a side of the body"
      case default
         name = "a restraint or point load"
      end select
   end function name_of

   !> A text with a mark replaced, where it stands.
   pure function with_name(text, mark, name) result(whole)
      character(len=*), intent(in) :: text, mark, name
      character(len=:), allocatable :: whole
      integer :: at

      whole = text
      at = index(text, mark)
      if (at > 0) whole = text(:at - 1)//name//text(at + len(mark):)
   end function with_name

   !> What the library has refused.
   function last_fault() result(fault)
      type(fault_t) :: fault
      type(cm_fault_t) :: last

      call cm_last_fault(last)
      allocate (fault%culprits(last%n_culprits))
      fault%culprits%kind = last%culprit_kind(:last%n_culprits)
      fault%culprits%number = last%culprit(:last%n_culprits) + 1
      fault%reason = text_of(last%reason)
   end function last_fault

   !> A text of C, which a null character ends.
   function text_of(start) result(text)
      type(c_ptr), intent(in) :: start
      character(len=:), allocatable :: text
      character(kind=c_char), pointer :: characters(:)
      integer :: i, n

      n = int(c_string_length(start))
      call c_f_pointer(start, characters, [n])
      allocate (character(len=n) :: text)
      do i = 1, n
         text(i:i) = characters(i)
      end do
   end function text_of

end module mesh_faults
