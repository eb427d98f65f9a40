!> Entries of wells that meet in the same places without losses: fluid could then flow round
!! through wells and fractures at any rate, and the flows of the entries are not determined. Wells,
!! places and the outside, to which wells at a pressure belong, are the nodes of a graph; an entry
!! without a loss, and a pressure without one, connects two of them; a loop is refused.
module scene_check_entries
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: entry_t, scene_t
   implicit none(type, external)
   private

   public :: check_meetings

   !> A place where wells meet fractures.
   type :: place_t
      integer(ik) :: fracture = 0
      logical :: at_point = .false.  !< not the whole fracture
      real(rk) :: xy(2) = 0.0_rk  !< [m]
   end type place_t

contains

   !> Refuse the first entry that closes a loop.
   pure subroutine check_meetings(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(place_t), allocatable :: places(:)
      type(entry_t), allocatable :: entries(:)
      integer, allocatable :: group(:)  ! of each node: the outside, wells, places
      integer :: e, node, pass, w
      logical :: is_loop

      if (.not. scene%has_entries()) return
      allocate (places(0))
      group = [(w, w=0, size(scene%injections))]
      ! Wells without entries first: where only they meet, their flows are distributed.
      do pass = 1, 2
         do w = 1, size(scene%injections)
            associate (well => scene%injections(w))
               if (well%fracture == 0 .or. (allocated(well%entries) .neqv. pass == 2)) cycle
               if (pass == 1 .and. .not. allocated(well%pressure)) cycle
               entries = [entry_t(well%fracture, well%x, well%y)]
               if (pass == 2) entries = well%entries
               if (allocated(well%pressure) .and. .not. (well%friction > 0.0_rk .or. &
                                                         well%turbulence > 0.0_rk)) then
                  call join(group, 1, w + 1, is_loop)
               end if
               do e = 1, size(entries)
                  if (entries(e)%loss > 0.0_rk) cycle
                  call find_node(scene, place_t(entries(e)%fracture, well%at_point, &
                                                [entries(e)%x, entries(e)%y]), places, group, node)
                  call join(group, w + 1, node, is_loop)
                  if (pass == 1 .or. .not. is_loop) cycle
                  call refuse(error, sheet, sheet%find("injection", w), "fracture", &
                              "'"//trim(scene%fractures(entries(e)%fracture)%name)//"': the "// &
                              "entry there meets another well's, with which it is already "// &
                              "connected, or both have a pressure: without losses the flow "// &
                              "between them is not determined; give entry_loss, or other points")
                  return
               end do
            end associate
         end do
      end do
   end subroutine check_meetings

   !> The node of a place; a new one where there is none within a cell.
   pure subroutine find_node(scene, place, places, group, node)
      type(scene_t), intent(in) :: scene
      type(place_t), intent(in) :: place
      type(place_t), allocatable, intent(inout) :: places(:)
      integer, allocatable, intent(inout) :: group(:)
      integer, intent(out) :: node
      real(rk) :: near
      integer :: k

      near = scene%cell_size_of(place%fracture)
      do k = 1, size(places)
         if (places(k)%fracture /= place%fracture) cycle
         if (places(k)%at_point .neqv. place%at_point) cycle
         if (place%at_point .and. norm2(places(k)%xy - place%xy) >= near) cycle
         node = size(scene%injections) + 1 + k
         return
      end do
      places = [places, place]
      node = size(scene%injections) + 1 + size(places)
      group = [group, maxval(group) + 1]
   end subroutine find_node

   !> Connect two nodes, unless they are already.
   pure subroutine join(group, a, b, is_loop)
      integer, intent(inout) :: group(:)
      integer, intent(in) :: a, b  !< nodes
      logical, intent(out) :: is_loop
      integer :: other

      other = group(b)
      is_loop = group(a) == other
      where (group == other) group = group(a)
   end subroutine join

end module scene_check_entries
