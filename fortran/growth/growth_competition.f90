!> Tips that grow together at their toughness: corrections of their advances, and stability of equal
!! growth.
!!
!! For small changes the intensities are K_i + sum_j M_ij da_j + c_i df, with the load factor f
!! (growth_control) and the tip interaction matrix M. Equal growth is stable where M is negative
!! definite on the advances on which the load does no work, c^T da = 0. Otherwise there are other
!! solutions, in which one tip runs ahead and the load on the other tips falls.
!!
!! Where a fluid drives the tips there is no load factor: the fluid volume is fixed, and c = 0. Then
!! each tip has not advanced and K_i <= K_IC, or has advanced and K_i = K_IC, a linear
!! complementarity problem. It has one solution where M is negative definite, otherwise several:
!! here the tips with the largest excess grow first, and other tips only as far as needed to satisfy
!! the conditions.
!!
!! Tip groups: equal tips advance equally, and count as one unknown.
!!
!! Tips that have advanced equally far, and whose intensities differ by less than their errors,
!! advance equally as long as this holds: otherwise the errors of their meshes would separate them.
!! A tip equal to a member of a group belongs to the group, so the order of the tips does not
!! matter.
module growth_competition
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use algebra_lapack, only: dgesv, dsyev
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   implicit none(type, external)
   private

   public :: complementary_advances, broyden_update, likes, matrix_of_groups, means, numbered
   public :: values_of_groups, preference

   ! Position of a tip with respect to its bounds.
   integer, parameter :: at_lower = -1, is_free = 0, at_upper = 1

contains

   !> Changes of the advances of a group, within bounds, after which no tip below its upper bound
   !! exceeds its toughness, and no tip above its lower bound is below it (principal pivoting,
   !! Cottle and Dantzig 1968). From their lower bounds the tips become free one after the other,
   !! the one with the largest excess first; the tips that are free already follow at their
   !! toughness. Of several solutions the result is therefore the one in which leading tips grow and
   !! the others stay.
   subroutine complementary_advances(excess, matrix, lower, upper, change)
      real(rk), intent(in) :: excess(:)  !< K_eq - K_IC before the changes [Pa m^1/2]
      real(rk), intent(in) :: matrix(:, :)  !< M [Pa m^-1/2]
      real(rk), intent(in) :: lower(:), upper(:)  !< bounds of the changes [m]
      real(rk), intent(out) :: change(size(excess))  !< [m]
      integer :: place(size(excess)), step
      real(rk) :: left(size(excess)), least
      integer :: k

      place = at_lower
      change = lower
      left = excess + matmul(matrix, change)
      least = 1.0e-10_rk*maxval(abs(left))
      do step = 1, 8*size(excess)
         left = excess + matmul(matrix, change)
         k = maxloc(-place*left, dim=1)
         if (place(k) == is_free .or. .not. -place(k)*left(k) > least) exit
         call move_tip(k, matrix, lower, upper, left(k), place, change)
      end do
   end subroutine complementary_advances

   !> Move one tip from its bound, and with it the free tips, until the tip is at its toughness or
   !! at its other bound.
   subroutine move_tip(k, matrix, lower, upper, excess, place, change)
      integer, intent(in) :: k
      real(rk), intent(in) :: matrix(:, :)  !< M [Pa m^-1/2]
      real(rk), intent(in) :: lower(:), upper(:)  !< [m]
      real(rk), intent(in) :: excess  !< excess of the tip [Pa m^1/2]
      integer, intent(inout) :: place(:)
      real(rk), intent(inout) :: change(:)  !< [m]
      real(rk) :: bound(size(change)), left, rate(size(change)), room, slope
      integer :: first, i, turn, way

      way = -place(k)
      left = excess
      do turn = 1, size(change)
         rate = follow(k, matrix, place == is_free)*way
         slope = dot_product(matrix(k, :), rate)
         bound = merge(upper, lower, rate > 0.0_rk)
         room = abs(bound(k) - change(k))
         first = k
         do i = 1, size(change)
            if (place(i) /= is_free .or. .not. abs(rate(i)) > 0.0_rk) cycle
            if (.not. abs(bound(i) - change(i)) < room*abs(rate(i))) cycle
            room = abs(bound(i) - change(i))/abs(rate(i))
            first = i
         end do
         if (-left*slope > 0.0_rk .and. abs(left) <= room*abs(slope)) then
            change = change + rate*abs(left/slope)
            place(k) = is_free
            return
         end if
         change = change + rate*room
         left = left + slope*room
         change(first) = bound(first)
         place(first) = merge(at_upper, at_lower, rate(first) > 0.0_rk)
         if (first == k) return
      end do
   end subroutine move_tip

   !> Rates at which the free tips advance, at constant intensity, while one tip advances at rate 1
   !! [-].
   function follow(k, matrix, moves) result(rate)
      integer, intent(in) :: k
      real(rk), intent(in) :: matrix(:, :)  !< M [Pa m^-1/2]
      logical, intent(in) :: moves(:)
      real(rk) :: rate(size(moves))
      real(rk) :: equations(count(moves), count(moves)), right(count(moves), 1)
      integer(ik) :: info, n, pivots(count(moves))
      integer, allocatable :: free(:)
      integer :: i

      rate = 0.0_rk
      rate(k) = 1.0_rk
      free = pack([(i, i=1, size(moves))], moves)
      n = size(free, kind=ik)
      if (n == 0) return
      equations = matrix(free, free)
      right(:, 1) = -matrix(free, k)
      call dgesv(n, 1_ik, equations, n, pivots, right, n, info)
      if (info == 0) rate(free) = right(:, 1)
   end function follow

   !> Broyden update of the matrix: the smallest change (Frobenius norm) with which the matrix
   !! predicts the measured change of the intensities (Broyden 1965).
   pure subroutine broyden_update(matrix, change, outcome)
      real(rk), intent(inout) :: matrix(:, :)  !< M [Pa m^-1/2]
      real(rk), intent(in) :: change(:)  !< change of the advances [m]
      real(rk), intent(in) :: outcome(:)  !< change of the intensities at constant load [Pa m^1/2]
      real(rk) :: length, missed(size(change))
      integer :: j

      length = sum(change**2)
      if (.not. length > 0.0_rk) return
      missed = outcome - matmul(matrix, change)
      do j = 1, size(change)
         matrix(:, j) = matrix(:, j) + missed*change(j)/length
      end do
   end subroutine broyden_update

   !> Largest eigenvalue of M on the advances on which the load does no work. Negative: equal growth
   !! of the group is stable. A group of one tip cannot separate: -huge.
   pure real(rk) function preference(matrix, slope)
      real(rk), intent(in) :: matrix(:, :)  !< M [Pa m^-1/2]
      real(rk), intent(in) :: slope(:)  !< c [Pa m^1/2]
      real(rk) :: mirror(size(slope)), turned(size(slope), size(slope))
      integer :: j, n

      n = size(slope)
      preference = -huge(1.0_rk)
      if (n < 2) return
      ! A Householder reflection maps the load's direction onto the first axis; the other axes span
      ! the advances on which the load does no work.
      mirror = slope/norm2(slope)
      mirror(1) = mirror(1) + sign(1.0_rk, mirror(1))
      mirror = mirror/norm2(mirror)
      turned = 0.5_rk*(matrix + transpose(matrix))
      do j = 1, n
         turned(:, j) = turned(:, j) - 2.0_rk*mirror*dot_product(mirror, turned(:, j))
      end do
      do j = 1, n
         turned(j, :) = turned(j, :) - 2.0_rk*mirror*dot_product(mirror, turned(j, :))
      end do
      preference = largest_eigenvalue(turned(2:, 2:))
   end function preference

   !> Largest eigenvalue of a symmetric matrix; NaN where LAPACK does not converge.
   pure real(rk) function largest_eigenvalue(matrix)
      real(rk), intent(in) :: matrix(:, :)
      real(rk) :: a(size(matrix, 1), size(matrix, 1)), eigenvalues(size(matrix, 1))
      real(rk) :: work(3*size(matrix, 1))
      integer(ik) :: info, n

      a = matrix
      n = size(a, 1, kind=ik)
      call dsyev("N", "L", n, a, n, eigenvalues, work, size(work, kind=ik), info)
      largest_eigenvalue = merge(eigenvalues(n), ieee_value(1.0_rk, ieee_quiet_nan), info == 0)
   end function largest_eigenvalue

   !> Index of the first tip of each tip's group. A group is a connected component of the pairs of
   !! equal tips.
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

   !> Groups renumbered from 1, in order of first appearance.
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

   !> Mean over the group of each tip, one value per tip.
   pure function means(kind, values)
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      real(rk), intent(in) :: values(:)
      real(rk) :: means(size(values))
      integer :: k

      do k = 1, size(values)
         means(k) = sum(values, mask=kind == kind(k))/count(kind == kind(k))
      end do
   end function means

   !> Interaction matrix of the groups: mean change of a group's intensities per advance of all tips
   !! of another group.
   pure function matrix_of_groups(kind, matrix) result(reduced)
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
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
   end function matrix_of_groups

   !> One value per group: that of its first tip.
   pure function values_of_groups(kind, values) result(each)
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      real(rk), intent(in) :: values(:)
      real(rk) :: each(maxval(kind))
      integer :: k

      do k = 1, size(each)
         each(k) = values(findloc(kind, k, dim=1))
      end do
   end function values_of_groups

end module growth_competition
