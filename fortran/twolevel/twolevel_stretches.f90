!> Parts of fractures, told by arc lengths: they stay what they are when the mesh changes.
module twolevel_stretches
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: stretches_t

   !> Stretches that neither touch nor overlap.
   type :: stretches_t
      integer(ik), allocatable :: fracture(:)
      real(rk), allocatable :: s(:, :)  !< (2, n) from and to [m]
   contains
      procedure :: clear
      procedure :: add
      procedure :: length
      procedure :: covers
   end type stretches_t

contains

   !> None.
   pure subroutine clear(self)
      class(stretches_t), intent(inout) :: self

      self%fracture = [integer(ik) ::]
      self%s = reshape([real(rk) ::], [2, 0])
   end subroutine clear

   !> Add a stretch; it takes in those that it meets.
   pure subroutine add(self, fracture, s)
      class(stretches_t), intent(inout) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s(2)  !< from and to [m]; nothing is added unless from < to
      logical :: stays(size(self%fracture))
      real(rk) :: whole(2)
      integer(ik) :: i, n

      if (.not. s(1) < s(2)) return
      stays = self%fracture /= fracture .or. self%s(2, :) < s(1) .or. self%s(1, :) > s(2)
      whole = [min(s(1), minval(self%s(1, :), mask=.not. stays)), &
               max(s(2), maxval(self%s(2, :), mask=.not. stays))]
      n = count(stays)
      self%s = reshape([self%s(:, pack([(i, i=1, size(stays))], stays)), whole], [2, n + 1])
      self%fracture = [pack(self%fracture, stays), fracture]
   end subroutine add

   !> Length of all of them [m].
   pure real(rk) function length(self)
      class(stretches_t), intent(in) :: self

      length = sum(self%s(2, :) - self%s(1, :))
   end function length

   !> A place of a fracture lies in one of them.
   pure logical function covers(self, fracture, s)
      class(stretches_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s  !< arc length [m]

      covers = any(self%fracture == fracture .and. self%s(1, :) <= s .and. s <= self%s(2, :))
   end function covers

end module twolevel_stretches
