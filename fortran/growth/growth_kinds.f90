!> Kinds of tips: those that are alike grow alike, and count as one.
!!
!! Tips that have come equally far, and that the errors of their intensities do not tell from each
!! other, go equally far as long as that is so: else the errors of their meshes would part them.
!! What is like something alike is alike too, so the order of the tips does not matter.
module growth_kinds
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: likes, matrix_of_kinds, means, numbered, of_kinds

contains

   !> The first tip that is like each, itself if there is none before it, by what is alike in pairs
   !! and all that follows from that.
   pure function likes(alike) result(first)
      logical, intent(in) :: alike(:, :)  !< (tips, tips)
      integer(ik) :: first(size(alike, 1))
      integer(ik) :: before(size(first)), i, j

      first = [(i, i=1, size(first, kind=ik))]
      do
         before = first
         do j = 1, size(first, kind=ik)
            do i = 1, size(first, kind=ik)
               if (alike(i, j) .or. alike(j, i)) first([i, j]) = min(first(i), first(j))
            end do
         end do
         if (all(first == before)) exit
      end do
   end function likes

   !> Marks as numbers from 1, in the order in which they come.
   pure function numbered(marks) result(number)
      integer(ik), intent(in) :: marks(:)
      integer(ik) :: number(size(marks))
      integer(ik) :: k, n

      n = 0
      do k = 1, size(marks, kind=ik)
         number(k) = findloc(marks, marks(k), dim=1, kind=ik)
         if (number(k) == k) then
            n = n + 1
            number(k) = n
         else
            number(k) = number(number(k))
         end if
      end do
   end function numbered

   !> The means over each kind, for all of it.
   pure function means(kind, values)
      integer(ik), intent(in) :: kind(:)  !< from 1
      real(rk), intent(in) :: values(:)
      real(rk) :: means(size(values))
      integer :: k

      do k = 1, size(values)
         means(k) = sum(values, mask=kind == kind(k))/count(kind == kind(k))
      end do
   end function means

   !> The matrix between kinds of tips, all of which go equally far.
   pure function matrix_of_kinds(kind, matrix) result(reduced)
      integer(ik), intent(in) :: kind(:)  !< from 1
      real(rk), intent(in) :: matrix(:, :)
      real(rk) :: reduced(maxval(kind), maxval(kind))
      integer :: i, j

      reduced = 0.0_rk
      do j = 1, size(kind)
         do i = 1, size(kind)
            reduced(kind(i), kind(j)) = reduced(kind(i), kind(j)) &
                                        + matrix(i, j)/count(kind == kind(i))
         end do
      end do
   end function matrix_of_kinds

   !> A value of each kind: that of its first tip.
   pure function of_kinds(kind, values) result(each)
      integer(ik), intent(in) :: kind(:)  !< from 1
      real(rk), intent(in) :: values(:)
      real(rk) :: each(maxval(kind))
      integer :: k

      do k = 1, size(each)
         each(k) = values(findloc(kind, k, dim=1))
      end do
   end function of_kinds

end module growth_kinds
