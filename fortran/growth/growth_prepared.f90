!> Pieces of a path that a mesh has cells for already, though the tip has not gone along them: tries
!! of a step that were not taken have begun them, and the next ones go the same way.
module growth_prepared
   use base_kinds, only: ik, rk
   use growth_tip, only: tip_t
   implicit none(type, external)
   private

   public :: prepared_t

   !> A piece of a path.
   type :: piece_t
      type(tip_t) :: tip  !< as it was when the piece was begun, with its direction
      real(rk) :: to(2) = 0.0_rk  !< where the piece ends [m]
   end type piece_t

   !> The pieces of one tip, one after the other, those that it has gone along included.
   type :: prepared_t
      type(piece_t), allocatable, private :: piece(:)
   contains
      procedure :: add
      procedure :: find
      procedure :: tip_of
      procedure :: end_of
      procedure :: length_from
   end type prepared_t

contains

   !> One more piece, from where the last one ends.
   pure subroutine add(self, tip, to)
      class(prepared_t), intent(inout) :: self
      type(tip_t), intent(in) :: tip  !< its origin is where the piece begins
      real(rk), intent(in) :: to(2)  !< [m]

      if (.not. allocated(self%piece)) allocate (self%piece(0))
      self%piece = [self%piece, piece_t(tip=tip, to=to)]
   end subroutine add

   !> The number of the piece that begins at a place; 0: none does.
   pure integer(ik) function find(self, from, within)
      class(prepared_t), intent(in) :: self
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk), intent(in) :: within  !< [m]
      integer(ik) :: k

      find = 0
      if (.not. allocated(self%piece)) return
      do k = size(self%piece, kind=ik), 1, -1
         if (norm2(self%piece(k)%tip%origin - from) > within) cycle
         find = k
         return
      end do
   end function find

   !> The tip at the beginning of a piece.
   pure type(tip_t) function tip_of(self, number)
      class(prepared_t), intent(in) :: self
      integer(ik), intent(in) :: number

      tip_of = self%piece(number)%tip
   end function tip_of

   !> Where a piece ends [m].
   pure function end_of(self, number) result(to)
      class(prepared_t), intent(in) :: self
      integer(ik), intent(in) :: number
      real(rk) :: to(2)

      to = self%piece(number)%to
   end function end_of

   !> The length of a piece and all that follow it [m]; 0 beyond the last one.
   pure function length_from(self, number) result(length)
      class(prepared_t), intent(in) :: self
      integer(ik), intent(in) :: number
      real(rk) :: length
      integer(ik) :: k

      length = 0.0_rk
      if (.not. allocated(self%piece)) return
      do k = number, size(self%piece, kind=ik)
         length = length + norm2(self%piece(k)%to - self%piece(k)%tip%origin)
      end do
   end function length_from

end module growth_prepared
