!> Wells: which fracture cells they feed, at which rate, and when they start and end.
module twolevel_wells
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_time
   use mesh_types, only: fracture_mesh_t, mesh_map_t
   use scene_types, only: injection_t, scene_t
   implicit none(type, external)
   private

   public :: next_switch, rate, share_wells, transfer_shares

contains

   !> The share of each well's rate that each fracture cell takes: all of it the cell nearest to the
   !! well's point, or every cell of its fracture by its length.
   pure subroutine share_wells(wells, fracture, share)
      type(injection_t), intent(in) :: wells(:)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), allocatable, intent(out) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk) :: distance(fracture%n_cells)
      integer(ik) :: i, w

      allocate (share(fracture%n_cells, size(wells)), source=0.0_rk)
      do w = 1, size(wells, kind=ik)
         associate (well => wells(w))
            do i = 1, fracture%n_cells
               distance(i) = huge(1.0_rk)
               if (fracture%cell_fracture(i) /= well%fracture) cycle
               share(i, w) = fracture%cell_s(2, i) - fracture%cell_s(1, i)
               distance(i) = norm2(0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, i)), &
                                              dim=2) - [well%x, well%y])
            end do
            if (well%at_point) then
               share(:, w) = 0.0_rk
               share(minloc(distance, dim=1), w) = 1.0_rk
            end if
            share(:, w) = share(:, w)/sum(share(:, w))
         end associate
      end do
   end subroutine share_wells

   !> The shares on a new mesh: the wells go on feeding the cells that they fed.
   pure function transfer_shares(map, before) result(after)
      type(mesh_map_t), intent(in) :: map
      real(rk), intent(in) :: before(:, :)  !< (old fracture cells, wells) [-]
      real(rk) :: after(size(map%fracture_cell_old), size(before, 2))
      integer(ik) :: i

      after = 0.0_rk
      do i = 1, size(after, 1, kind=ik)
         if (map%fracture_cell_old(i) > 0) after(i, :) = before(map%fracture_cell_old(i), :)
      end do
   end function transfer_shares

   !> Rate of a well in the step that begins at a time; steps do not straddle its start or end.
   elemental function rate(well, time, dt) result(q)
      type(injection_t), intent(in) :: well
      real(rk), intent(in) :: time, dt  !< [s]
      real(rk) :: q  !< [m2/s]

      q = 0.0_rk
      if (time + 0.5_rk*dt > well%start .and. time + 0.5_rk*dt < well%end) q = well%rate
   end function rate

   !> The next time at which a well starts or ends, or the scene does [s].
   pure function next_switch(scene, now) result(time)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now  !< [s]
      real(rk) :: time
      real(rk) :: later
      integer(ik) :: w

      time = scene%time%end
      later = now*(1.0_rk + same_time)
      do w = 1, size(scene%injections, kind=ik)
         associate (well => scene%injections(w))
            if (well%start > later) time = min(time, well%start)
            if (well%end > later) time = min(time, well%end)
         end associate
      end do
   end function next_switch

end module twolevel_wells
