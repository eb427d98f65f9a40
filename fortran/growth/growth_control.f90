!> Length control: how far the tips of a group go while the load factor follows them.
module growth_control
   use base_kinds, only: ik, rk
   use growth_competition, only: corrected_advances
   use growth_kinds, only: matrix_of_kinds, means, of_kinds
   implicit none(type, external)
   private

   public :: better_advances, fitted, joined_groups

contains

   !> Better advances of tips that grow in kinds. Tips that would go back go back in steps.
   subroutine better_advances(kind, lack, matrix, slope, room, tolerance, advance)
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      real(rk), intent(in) :: lack(:)  !< K_IC - K_eq [Pa m^1/2]
      real(rk), intent(in) :: matrix(:, :)  !< M of growth_competition [Pa m^-1/2]
      real(rk), intent(in) :: slope(:)  !< dK_eq/df [Pa m^1/2]
      real(rk), intent(in) :: room(:)  !< to the ends of the pieces [m]
      real(rk), intent(in) :: tolerance  !< on the lack of tips that have advanced [Pa m^1/2]
      real(rk), intent(inout) :: advance(:)  !< [m]
      real(rk), parameter :: back = 0.25_rk  ! of an advance is left at least
      real(rk), dimension(maxval(kind)) :: gain, lack_of, room_of, slope_of
      real(rk) :: of_all(maxval(kind), maxval(kind))
      real(rk), allocatable :: change(:)
      integer(ik), allocatable :: free(:)
      logical :: is_free(maxval(kind))
      integer(ik) :: k, leader

      of_all = matrix_of_kinds(kind, matrix)
      lack_of = of_kinds(kind, means(kind, lack))
      slope_of = of_kinds(kind, means(kind, slope))
      room_of = of_kinds(kind, room)
      gain = of_kinds(kind, means(kind, advance))
      ! One that stays goes on again where it is not behind.
      is_free = gain > 0.0_rk .or. lack_of <= tolerance
      free = pack([(k, k=1, size(gain, kind=ik))], is_free)
      leader = minloc(lack_of(free), dim=1, kind=ik)  ! has no need to go back
      allocate (change(size(free)))
      call corrected_advances(lack_of(free), of_all(free, free), slope_of(free), leader, change)
      ! The matrix may be that of quite other places: back in steps.
      gain(free) = min(room_of(free), max(gain(free) + change, back*gain(free)))
      advance = gain(kind)
   end subroutine better_advances

   !> In proportion, so that the first tip comes to the end of its piece; what is too short for the
   !! mesh is none, nor what hardly changes the intensities.
   pure function fitted(advance, room, accepted, shortest) result(fit)
      real(rk), intent(in) :: advance(:), room(:), accepted(:)  !< [m]
      real(rk), intent(in) :: shortest  !< of a piece, what the mesh can hold [m]
      real(rk) :: fit(size(advance))
      real(rk), parameter :: negligible = 1.0e-3_rk  ! of the room

      fit = room
      if (.not. maxval(advance/room) > 0.0_rk) return
      fit = advance/maxval(advance/room)
      where (accepted + fit < shortest .or. fit < negligible*room) fit = 0.0_rk
      where (fit > 0.999_rk*room) fit = room
   end function fitted

   !> All tips of two groups, in their order.
   pure function joined_groups(a, b) result(group)
      integer(ik), intent(in) :: a(:), b(:)
      integer(ik), allocatable :: group(:)
      integer(ik) :: i

      group = pack([(i, i=1, max(maxval(a), maxval(b)))], &
                   [(any(a == i) .or. any(b == i), i=1, max(maxval(a), maxval(b)))])
   end function joined_groups

end module growth_control
