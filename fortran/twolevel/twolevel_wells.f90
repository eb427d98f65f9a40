!> Wells: the fracture cells that they supply, their prescribed rates and pressures, and the times
!! at which these change.
!!
!! A well at a point of a fracture lies between the middle of its cell and that of the next cell, or
!! a joint, and flow along the fracture is linear there. With the distances d1, d2 from these two,
!! and l = d1 + d2,
!!   q1 = q d2/l,   q2 = q d1/l,   p = p1 d2/l + p2 d1/l + R q d1 d2/l^2
!! R being the resistance between the two, give the same flow and pressure as a well at its exact
!! place. Behind the last middle before a tip nothing flows on: q1 = q, p = p1 + R q over d1. A side
!! with a pressure is like a joint with this pressure: what is supplied to it leaves the body.
module twolevel_wells
   use base_kinds, only: ik, rk
   use base_plane, only: nearest_share, point_distance
   use base_tolerances, only: same_value
   use coarse_joints, only: joints_t
   use coarse_wells, only: control_limited, control_pressure, control_rate, control_shut, wells_t
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: injection_t, no_limit
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   implicit none(type, external)
   private

   public :: ask_wells, control_wells, entries_of, place_wells, places_of_cells, rate, share_wells
   public :: transfer_shares, wells_of_entries

contains

   !> A list of wells with one entry each, of all entries of all wells.
   pure function entries_of(wells) result(entries)
      type(injection_t), intent(in) :: wells(:)
      type(injection_t), allocatable :: entries(:)
      integer(ik), allocatable :: of(:)
      integer(ik) :: e, k

      of = wells_of_entries(wells)
      entries = wells(of)
      do k = 1, size(of, kind=ik)
         if (.not. allocated(wells(of(k))%entries)) cycle
         e = count(of(:k) == of(k), kind=ik)
         associate (entry => wells(of(k))%entries(e))
            entries(k)%fracture = entry%fracture
            entries(k)%x = entry%x
            entries(k)%y = entry%y
         end associate
      end do
   end function entries_of

   !> The well of each entry.
   pure function wells_of_entries(wells) result(of)
      type(injection_t), intent(in) :: wells(:)
      integer(ik), allocatable :: of(:)
      integer(ik) :: e, w

      of = [((w, e=1, wells(w)%entry_count()), w=1, size(wells, kind=ik))]
   end function wells_of_entries

   !> Share of each well's rate in each cell of its fracture, by its length; those of wells at
   !! points are found on each mesh (place_wells).
   pure subroutine share_wells(wells, fracture, share)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), allocatable, intent(out) :: share(:, :)  !< (fracture cells, wells) [-]
      integer(ik) :: w

      allocate (share(fracture%n_cells, size(wells)), source=0.0_rk)
      do w = 1, size(wells, kind=ik)
         if (wells(w)%fracture == 0) cycle
         share(:, w) = merge(fracture%cell_s(2, :) - fracture%cell_s(1, :), 0.0_rk, &
                             fracture%cell_fracture == wells(w)%fracture)
         share(:, w) = share(:, w)/sum(share(:, w))
      end do
   end subroutine share_wells

   !> Shares of the wells at points of fractures in cells and joints, and the ways to these. A tip
   !! that grows in the next cell has no steady flow before it.
   pure subroutine place_wells(wells, fracture, joints, roughness, share, joint_share, path)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      type(joints_t), intent(in) :: joints
      real(rk), intent(in) :: roughness(:)  !< (fracture cells) above 0 where they have grown [m]
      real(rk), intent(inout) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk), allocatable, intent(out) :: joint_share(:, :)  !< (joints, wells) [-]
      !> (fracture cells, wells) pressure at the well above that in its cells, over the loss of its
      !! flow in half of each of them [-]
      real(rk), allocatable, intent(out) :: path(:, :)
      real(rk), parameter :: next_to_joint = 1.0_rk - 1.0e-9_rk  ! its cell has a share
      real(rk) :: offset, t
      integer(ik) :: cell, end, joint, next, w

      allocate (joint_share(joints%n, size(wells)), path(fracture%n_cells, size(wells)), &
                source=0.0_rk)
      do w = 1, size(wells, kind=ik)
         if (.not. wells(w)%at_point .or. wells(w)%fracture == 0) cycle
         call find_cell(wells(w), fracture, cell, offset)
         share(:, w) = 0.0_rk
         share(cell, w) = 1.0_rk
         path(cell, w) = tiny(1.0_rk)
         end = merge(1_ik, 2_ik, offset < 0.0_rk)
         offset = abs(offset)
         if (offset < same_value) cycle
         joint = 0
         if (joints%n > 0) joint = findloc(joints%point, fracture%cell_points(end, cell), dim=1, &
                                           kind=ik)
         if (joint > 0) then
            ! All of it would leave at once.
            if (offset > 1.0_rk - same_value .and. joints%is_outlet(joint)) cycle
            offset = min(offset, next_to_joint)
            share(cell, w) = 1.0_rk - offset
            joint_share(joint, w) = offset
            path(cell, w) = offset
            cycle
         end if
         path(cell, w) = offset
         next = cell_next(fracture, cell, end)
         if (next == 0) cycle
         if (roughness(next) > 0.0_rk .and. cell_next(fracture, next, end) == 0) cycle
         associate (s => fracture%cell_s)
            t = offset*(s(2, cell) - s(1, cell))/(s(2, cell) - s(1, cell) + s(2, next) - s(1, next))
         end associate
         if (abs(t - 0.5_rk) < same_value) t = 0.5_rk
         share([cell, next], w) = [1.0_rk - t, t]
         path([cell, next], w) = t*(1.0_rk - t)
      end do
   end subroutine place_wells

   !> Whether the middle of each cell lies beyond each well at a point of its fracture, 1, or before
   !! it, -1; 0: in it, on another fracture, or the well is not at a point.
   pure function places_of_cells(wells, fracture) result(ahead)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk) :: ahead(fracture%n_cells, size(wells))
      real(rk) :: offset
      integer(ik) :: cell, w

      ahead = 0.0_rk
      do w = 1, size(wells, kind=ik)
         if (.not. wells(w)%at_point .or. wells(w)%fracture == 0) cycle
         call find_cell(wells(w), fracture, cell, offset)
         where (fracture%cell_fracture == wells(w)%fracture) &
            ahead(:, w) = sign(1.0_rk, fracture%cell_s(1, :) - fracture%cell_s(1, cell))
         ahead(cell, w) = 0.0_rk
         if (abs(offset) >= same_value) ahead(cell, w) = sign(1.0_rk, -offset)
      end do
   end function places_of_cells

   !> The cell of a well at a point, and its distance from the middle over half the length, negative
   !! towards the start.
   pure subroutine find_cell(well, fracture, cell, offset)
      type(injection_t), intent(in) :: well
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(out) :: cell
      real(rk), intent(out) :: offset  !< [-]
      real(rk) :: distance(fracture%n_cells)
      integer(ik) :: i

      distance = huge(1.0_rk)
      associate (point => [well%x, well%y], xy => fracture%point_xy, ends => fracture%cell_points)
         do i = 1, fracture%n_cells
            if (fracture%cell_fracture(i) /= well%fracture) cycle
            distance(i) = point_distance(point, xy(:, ends(:, i)))
         end do
         cell = minloc(distance, dim=1, kind=ik)
         offset = 2.0_rk*nearest_share(point, xy(:, ends(:, cell))) - 1.0_rk
      end associate
   end subroutine find_cell

   !> The cell behind an end of a cell of the same fracture; 0: none.
   pure integer(ik) function cell_next(fracture, cell, end) result(next)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: cell
      integer(ik), intent(in) :: end  !< 1: its start, 2: its end

      next = cell + 2*end - 3
      if (next < 1 .or. next > fracture%n_cells) then
         next = 0
      else if (fracture%cell_points(3 - end, next) /= fracture%cell_points(end, cell)) then
         next = 0
      end if
   end function cell_next

   !> Shares on a new mesh: the wells supply the same cells as before. Where these have been
   !! divided, each part gets its share.
   pure function transfer_shares(fracture_before, fracture, before) result(after)
      type(fracture_mesh_t), intent(in) :: fracture_before, fracture
      real(rk), intent(in) :: before(:, :)  !< (old fracture cells, wells) [-]
      real(rk) :: after(fracture%n_cells, size(before, 2))
      type(overlaps_t) :: overlaps
      integer(ik) :: i, k

      overlaps = fracture_overlaps(fracture_before, fracture)
      after = 0.0_rk
      do i = 1, fracture%n_cells
         do k = overlaps%first(i), overlaps%first(i + 1) - 1
            associate (s => fracture_before%cell_s(:, overlaps%old(k)))
               after(i, :) = after(i, :) + before(overlaps%old(k), :) &
                             *overlaps%length(k)/(s(2) - s(1))
            end associate
         end do
      end do
   end function transfer_shares

   !> Prescribed rate of a well in the step that begins at a time; steps do not straddle its stages.
   !! 0 for a well whose rate depends on pressures.
   elemental function rate(well, time, dt) result(q)
      type(injection_t), intent(in) :: well
      real(rk), intent(in) :: time, dt  !< [s]
      real(rk) :: q  !< [m2/s]
      integer(ik) :: stage

      q = 0.0_rk
      if (well%is_controlled()) return
      stage = well%stage_at(time + 0.5_rk*dt)
      if (stage > 0) q = well%rate(stage)
   end function rate

   !> Data of the wells whose rate depends on pressures.
   pure subroutine control_wells(given, share, joint_share, path, wells)
      type(injection_t), intent(in) :: given(:)
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, entries) [-]
      real(rk), intent(in) :: joint_share(:, :)  !< (joints, entries) [-]
      real(rk), intent(in) :: path(:, :)  !< (fracture cells, entries) [-]
      type(wells_t), intent(out) :: wells
      integer(ik), allocatable :: at(:), number(:)
      integer(ik) :: w

      number = [(w, w=1, size(given, kind=ik))]
      number = [pack(number, given%is_controlled() .and. given%fracture > 0), &
                pack(number, given%is_controlled() .and. given%fracture == 0)]
      wells%n = count(given%is_controlled() .and. given%fracture > 0)
      wells%n_all = size(number, kind=ik)
      wells%entry = [integer(ik) ::]
      if (wells%n_all == 0) return
      at = [(findloc(wells_of_entries(given), number(w), dim=1, kind=ik), w=1, wells%n)]
      call add_entries(given, number(:wells%n), wells, at)
      wells%number = number
      wells%share = share(:, at)
      wells%joint_share = joint_share(:, at)
      wells%path = path(:, at)
      wells%entry = at
      do w = 1, merge(wells%n, 0_ik, wells%n_entries > 0)
         if (wells%first_entry(w) == w) cycle
         wells%share(:, w) = 0.0_rk
         wells%joint_share(:, w) = 0.0_rk
         wells%path(:, w) = 0.0_rk
         wells%entry(w) = 0
      end do
      wells%storage = given(number)%storage
      wells%friction = given(number)%friction
      wells%turbulence = given(number)%turbulence
      wells%control = spread(control_shut, 1, int(wells%n_all))
      wells%rate = spread(0.0_rk, 1, int(wells%n_all))
      wells%pressure = wells%rate
   end subroutine control_wells

   !> Add the entries of the wells that have them, and their numbers among all entries.
   pure subroutine add_entries(given, number, wells, at)
      type(injection_t), intent(in) :: given(:)
      integer(ik), intent(in) :: number(:)  !< of the wells in fractures among those given
      type(wells_t), intent(inout) :: wells
      integer(ik), allocatable, intent(inout) :: at(:)  !< (places)
      integer(ik) :: e, w

      allocate (wells%of_entry(0), wells%entry_loss(0))
      do w = 1, size(number, kind=ik)
         associate (well => given(number(w)), first => at(w))
            if (.not. allocated(well%entries)) cycle
            wells%of_entry = [wells%of_entry, [(w, e=1, well%entry_count())]]
            wells%entry_loss = [wells%entry_loss, well%entries%loss]
            at = [at, [(first + e - 1, e=1, well%entry_count())]]
         end associate
      end do
      wells%n_entries = size(wells%of_entry, kind=ik)
   end subroutine add_entries

   !> Set the prescribed rates and pressures of these wells in the step that begins at a time.
   pure subroutine ask_wells(given, time, dt, wells)
      type(injection_t), intent(in) :: given(:)
      real(rk), intent(in) :: time, dt  !< [s]
      type(wells_t), intent(inout) :: wells
      integer(ik) :: stage, w

      do w = 1, wells%n_all
         associate (well => given(wells%number(w)), control => wells%control(w))
            stage = well%stage_at(time + 0.5_rk*dt)
            wells%rate(w) = 0.0_rk
            control = control_shut
            ! The fluid stored in a well flows on after its end, as in a stage of rate 0.
            if (well%storage > 0.0_rk .and. time + 0.5_rk*dt >= well%end) control = control_rate
            if (stage == 0) cycle
            control = control_pressure
            if (allocated(well%pressure)) then
               wells%pressure(w) = well%pressure(stage)
               if (allocated(wells%pressure_in_situ)) then
                  wells%pressure(w) = wells%pressure(w) - wells%pressure_in_situ(w)
               end if
            end if
            if (.not. allocated(well%rate)) cycle
            wells%rate(w) = well%rate(stage)
            control = control_rate
            ! A stage of rate 0 has no limit: the well drives no flow.
            if (.not. allocated(well%pressure)) cycle
            if (abs(wells%rate(w)) > 0.0_rk .and. well%pressure(stage) < no_limit) then
               control = control_limited
            end if
         end associate
      end do
   end subroutine ask_wells

end module twolevel_wells
