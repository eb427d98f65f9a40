!> Wells: the fracture cells that they supply, their prescribed rates and pressures, and the times
!! at which these change.
module twolevel_wells
   use base_kinds, only: ik, rk
   use base_plane, only: nearest_place, norm2
   use base_tolerances, only: same_place, same_value
   use coarse_joints, only: joints_t
   use coarse_wells, only: control_limited, control_pressure, control_rate, control_shut, wells_t
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: injection_t, no_limit
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   implicit none(type, external)
   private

   public :: ask_wells, between_cells, control_wells, entries_of, feed_joints, mean_pressure
   public :: rate, share_wells, transfer_shares, wells_of_entries

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

   !> Share of each well's rate in each fracture cell: 1 in the cell nearest to the well's point, or
   !! one half in each of two cells at the same distance, or in every cell of the fracture by its
   !! length.
   pure subroutine share_wells(wells, fracture, share)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), allocatable, intent(out) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk) :: distance(fracture%n_cells)
      integer(ik) :: i, w

      allocate (share(fracture%n_cells, size(wells)), source=0.0_rk)
      do w = 1, size(wells, kind=ik)
         if (wells(w)%fracture == 0) cycle
         associate (well => wells(w))
            do i = 1, fracture%n_cells
               distance(i) = huge(1.0_rk)
               if (fracture%cell_fracture(i) /= well%fracture) cycle
               share(i, w) = fracture%cell_s(2, i) - fracture%cell_s(1, i)
               distance(i) = norm2(fracture_cell_centre(fracture, i) - [well%x, well%y])
            end do
            ! Between two cells rounding errors of the mesh would select one of them.
            if (well%at_point) share(:, w) = merge(1.0_rk, 0.0_rk, distance &
                                                   <= minval(distance)*(1.0_rk + same_value))
            share(:, w) = share(:, w)/sum(share(:, w))
         end associate
      end do
   end subroutine share_wells

   !> Assign wells at an intersection of fractures to the joint itself, and to no cell.
   pure subroutine feed_joints(wells, fracture, joints, share, joint_share)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      type(joints_t), intent(in) :: joints
      real(rk), intent(inout) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk), allocatable, intent(out) :: joint_share(:, :)  !< (joints, wells) [-]
      real(rk) :: distance, near
      integer(ik) :: b, w

      allocate (joint_share(joints%n, size(wells)), source=0.0_rk)
      do w = 1, size(wells, kind=ik)
         if (.not. wells(w)%at_point .or. wells(w)%fracture == 0) cycle
         do b = 1, joints%branch_count()
            associate (cell => joints%cell(b), joint => joints%joint(b))
               if (joints%is_outlet(joint)) cycle
               if (fracture%cell_fracture(cell) /= wells(w)%fracture) cycle
               distance = norm2(fracture%point_xy(:, joints%point(joint)) &
                                - [wells(w)%x, wells(w)%y])
               near = same_place*(fracture%cell_s(2, cell) - fracture%cell_s(1, cell))
               if (distance > near) cycle
               share(:, w) = 0.0_rk
               joint_share(:, w) = 0.0_rk
               joint_share(joint, w) = 1.0_rk
            end associate
         end do
      end do
   end subroutine feed_joints

   !> Whether each well lies between two cells.
   pure function between_cells(wells, share) result(between)
      type(injection_t), intent(in) :: wells(:)
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, wells) [-]
      logical :: between(size(wells))

      between = wells%at_point .and. count(share > 0.0_rk, dim=1) == 2
   end function between_cells

   !> Shares on a new mesh: the wells supply the same cells as before. Where these have been
   !! divided, each part gets its share, or for a well at a point the part that contains the point
   !! gets the whole.
   pure function transfer_shares(wells, fracture_before, fracture, before) result(after)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture_before, fracture
      real(rk), intent(in) :: before(:, :)  !< (old fracture cells, wells) [-]
      real(rk) :: after(fracture%n_cells, size(before, 2))
      real(rk) :: distance(fracture%n_cells)
      type(overlaps_t) :: overlaps
      integer(ik) :: i, k, w

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
      do w = 1, size(wells, kind=ik)
         if (.not. wells(w)%at_point .or. count(after(:, w) > 0.0_rk) < 2) cycle
         do i = 1, fracture%n_cells
            distance(i) = huge(1.0_rk)
            if (.not. after(i, w) > 0.0_rk) cycle
            associate (xy => fracture%point_xy(:, fracture%cell_points(:, i)), &
                       s => fracture%cell_s(:, i), place => [wells(w)%x, wells(w)%y])
               distance(i) = norm2(nearest_place(place, xy) - place)/(s(2) - s(1))
            end associate
         end do
         after(:, w) = merge(1.0_rk, 0.0_rk, distance <= minval(distance) + same_place)
         after(:, w) = after(:, w)/sum(after(:, w))
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
   pure subroutine control_wells(given, share, joint_share, wells)
      type(injection_t), intent(in) :: given(:)
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, entries) [-]
      real(rk), intent(in) :: joint_share(:, :)  !< (joints, entries) [-]
      type(wells_t), intent(out) :: wells
      logical :: between(size(share, 2))
      integer(ik), allocatable :: at(:), number(:)
      integer(ik) :: w

      number = [(w, w=1, size(given, kind=ik))]
      number = [pack(number, given%is_controlled() .and. given%fracture > 0), &
                pack(number, given%is_controlled() .and. given%fracture == 0)]
      wells%n = count(given%is_controlled() .and. given%fracture > 0)
      wells%n_all = size(number, kind=ik)
      if (wells%n_all == 0) return
      between = between_cells(entries_of(given), share)
      at = [(findloc(wells_of_entries(given), number(w), dim=1, kind=ik), w=1, wells%n)]
      call add_entries(given, number(:wells%n), wells, at)
      wells%number = number
      wells%share = share(:, at)
      wells%joint_share = joint_share(:, at)
      wells%is_between = between(at)
      do w = 1, merge(wells%n, 0_ik, wells%n_entries > 0)
         if (wells%first_entry(w) == w) cycle
         wells%share(:, w) = 0.0_rk
         wells%joint_share(:, w) = 0.0_rk
         wells%is_between(w) = .false.
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

   !> Mean pressure of the cells and joints that wells supply; 0 without any [Pa].
   pure real(rk) function mean_pressure(share, pressure, joint_share, joint_pressure) result(mean)
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk), intent(in) :: pressure(:)  !< (fracture cells) [Pa]
      real(rk), intent(in) :: joint_share(:, :)  !< (joints, wells) [-]
      real(rk), intent(in) :: joint_pressure(:)  !< (joints) [Pa]
      logical :: is_well(size(pressure)), is_fed(size(joint_pressure))

      is_well = sum(share, dim=2) > 0.0_rk
      is_fed = sum(joint_share, dim=2) > 0.0_rk
      mean = 0.0_rk
      if (any(is_well) .or. any(is_fed)) then
         mean = (sum(pressure, mask=is_well) + sum(joint_pressure, mask=is_fed)) &
                /(count(is_well) + count(is_fed))
      end if
   end function mean_pressure

end module twolevel_wells
