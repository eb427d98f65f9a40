!> What the fluid on the faces does to the singular pressure of undrained rock around a tip, for
!! windows.
!!
!! The rock's own pressure (coarse_own_pressure) has that singular pressure at the nodes around the
!! tip, but the fluid on the faces drains it, however thin the layer: on the faces along one cell
!! behind the tip the rock's pressure differs from the fluid's by as much as it does two cells
!! behind, on both sides alike. The change of pressure falls linearly with the distance from these
!! faces, to zero at the length of a cell. It moves with the tip through the cells: with the tip
!! inside its cell, the drained faces are those of a part of this cell and of the one behind it, and
!! what depends on cells is weighted with these parts. Nothing jumps as a tip moves on.
module coarse_tip_drainage
   use base_kinds, only: ik, rk
   use base_plane, only: cross, nearest_share, norm2
   use mesh_geometry, only: cell_centre
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: drained_tip_t, drained_tips, pressure_at, pressure_of_face

   !> The drained faces of a tip: the parts of two cells, nearer the tip first.
   type :: drained_tip_t
      real(rk) :: ends(2, 2, 2) = 0.0_rk  !< (2, ends, parts) that nearer the tip first [m]
      !> (ends, sides, parts) change of pressure, to the left and to the right of the way back [Pa]
      real(rk) :: change(2, 2, 2) = 0.0_rk
      real(rk) :: reach = 0.0_rk  !< distance at which the change vanishes; 0: none [m]
   end type drained_tip_t

contains

   !> The drained faces of all tips. Fractures of a single cell have none.
   pure function drained_tips(mesh, nodal, fluid, passed) result(tips)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) pressure of the rock [Pa]
      real(rk), intent(in) :: fluid(:)  !< (fracture cells) [Pa]
      real(rk), intent(in) :: passed(:)  !< (fracture cells) share behind the tip [-]
      type(drained_tip_t), allocatable :: tips(:)
      integer(ik) :: cell, tip

      allocate (tips(mesh%fracture%n_tips))
      associate (here => mesh%fracture)
         do tip = 1, here%n_tips
            cell = findloc(here%cell_fracture == here%tip_fracture(tip) .and. &
                           here%cell_points(here%tip_end(tip), :) == here%tip_point(tip), &
                           .true., dim=1)
            if (cell == 0) cycle
            associate (step => merge(1_ik, -1_ik, here%tip_end(tip) == 1))
               do while (behind(mesh, cell, step) /= cell)  ! a tip that has moved back
                  if (.not. passed(behind(mesh, cell, step)) < 1.0_rk) exit
                  cell = behind(mesh, cell, step)
               end do
               if (behind(mesh, cell, step) == cell) cycle
               tips(tip) = drained_tip(mesh, nodal, fluid, cell, step, passed(cell))
            end associate
         end do
      end associate
   end function drained_tips

   !> The drained faces of a tip.
   pure function drained_tip(mesh, nodal, fluid, cell, step, passed) result(tip)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) pressure of the rock [Pa]
      real(rk), intent(in) :: fluid(:)  !< (fracture cells) [Pa]
      integer(ik), intent(in) :: cell, step  !< of the tip, and from one to the one behind it
      real(rk), intent(in) :: passed  !< share of the cell behind the tip [-]
      type(drained_tip_t) :: tip
      real(rk) :: back, ends(2, 2), new, places(2), rock(2), share, weights(2)
      integer(ik) :: cells(2), i, k, part

      cells = [cell, behind(mesh, cell, step)]
      weights = [passed, 1.0_rk - passed]
      if (behind(mesh, cells(2), step) == cells(2)) weights = [1.0_rk, 0.0_rk]
      ends = ends_of(mesh, cell, step)
      tip%reach = norm2(ends(:, 2) - ends(:, 1))
      do part = 1, 2
         ends = ends_of(mesh, cells(part), step)
         places = merge([1.0_rk - passed, 1.0_rk], [0.0_rk, 1.0_rk - passed], part == 1)
         do k = 1, 2
            share = places(k)
            tip%ends(:, k, part) = ends(:, 1) + share*(ends(:, 2) - ends(:, 1))
            back = merge(passed - 1.0_rk, passed, part == 1) + share  ! from the tip, in cells
            new = 0.0_rk
            do i = 1, 2
               if (weights(i) > 0.0_rk) new = new + weights(i) &
                         *drained_pressure(mesh, nodal, fluid, cells(i), step, tip%ends(:, k, part))
            end do
            rock = rock_pressures(mesh, nodal, cells(part), ends, share)
            ! The sides have one pressure at the tip.
            rock = 0.5_rk*sum(rock) + min(1.0_rk, max(0.0_rk, back))*(rock - 0.5_rk*sum(rock))
            tip%change(k, :, part) = new - rock
         end do
      end do
   end function drained_tip

   !> Pressure of the rock on drained faces, from those of a fracture cell and two cells behind: the
   !! fluid's, which is linear, less the difference there [Pa].
   pure real(rk) function drained_pressure(mesh, nodal, fluid, cell, step, place) result(pressure)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) pressure of the rock [Pa]
      real(rk), intent(in) :: fluid(:)  !< (fracture cells) [Pa]
      integer(ik), intent(in) :: cell, step
      real(rk), intent(in) :: place(2)  !< [m]
      real(rk) :: from(2), way(2)
      integer(ik) :: before, nodes(4)

      before = behind(mesh, behind(mesh, cell, step), step)
      nodes = reshape(mesh%face_nodes(:, mesh%fracture%cell_faces(:, before)), [4])
      from = middle(mesh, cell)
      way = middle(mesh, before) - from
      pressure = fluid(cell) - (fluid(before) - 0.25_rk*sum(nodal(nodes))) &
                 + (fluid(before) - fluid(cell))*dot_product(place - from, way) &
                 /dot_product(way, way)
   end function drained_pressure

   !> Pressure of the rock on the faces of a fracture cell, to the left and to the right of the way
   !! from the first end to the second [Pa].
   pure function rock_pressures(mesh, nodal, cell, ends, share) result(pressure)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: ends(2, 2)  !< of the cell [m]
      real(rk), intent(in) :: share  !< place between the ends [-]
      real(rk) :: pressure(2)
      integer(ik) :: face, nodes(2), side

      do side = 1, 2
         face = mesh%fracture%cell_faces(side, cell)
         nodes = mesh%face_nodes(:, face)
         if (norm2(mesh%xy(:, nodes(2)) - ends(:, 1)) &
             < norm2(mesh%xy(:, nodes(1)) - ends(:, 1))) then
            nodes = nodes(2:1:-1)
         end if
         associate (p => (1.0_rk - share)*nodal(nodes(1)) + share*nodal(nodes(2)))
            if (is_left(ends, cell_centre(mesh, mesh%face_cells(1, face)))) then
               pressure(1) = p
            else
               pressure(2) = p
            end if
         end associate
      end do
   end function rock_pressures

   !> Pressure of the rock at a point of a cell, where the fluid drains the rock around tips [Pa].
   pure real(rk) function pressure_at(tips, mesh, nodal, cell, weights) result(pressure)
      type(drained_tip_t), intent(in) :: tips(:)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: weights(3)  !< of the cell's nodes at the point [-]
      real(rk) :: all, at(2), centre(2), change, nearness
      integer :: i

      associate (nodes => mesh%cell_nodes(:, cell))
         pressure = dot_product(nodal(nodes), weights)
         at = matmul(mesh%xy(:, nodes), weights)
      end associate
      all = 0.0_rk
      change = 0.0_rk
      do i = 1, size(tips)
         associate (tip => tips(i))
            if (.not. tip%reach > 0.0_rk) cycle
            if (any(abs(at - tip%ends(:, 1, 1)) > 2.0_rk*tip%reach)) cycle
            centre = cell_centre(mesh, cell)
            call add_change(tip, at, centre, change, nearness)
            all = all + nearness
         end associate
      end do
      pressure = pressure + change/max(1.0_rk, all)
   end function pressure_at

   !> Add the change by a tip at a point.
   pure subroutine add_change(tip, at, centre, change, nearness)
      type(drained_tip_t), intent(in) :: tip
      real(rk), intent(in) :: at(2), centre(2)  !< the point, and the centre of its cell [m]
      real(rk), intent(inout) :: change  !< [Pa]
      real(rk), intent(out) :: nearness  !< 1 on the drained faces, 0 out of their reach [-]
      real(rk) :: distance(2), share(2)
      integer :: k, side

      distance = huge(1.0_rk)
      do k = 1, 2
         associate (along => tip%ends(:, 2, k) - tip%ends(:, 1, k))
            if (.not. any(abs(along) > 0.0_rk)) cycle  ! a part without length has no sides
            share(k) = nearest_share(at, tip%ends(:, :, k))
            distance(k) = norm2(at - tip%ends(:, 1, k) - share(k)*along)
         end associate
      end do
      k = minloc(distance, dim=1)
      nearness = max(0.0_rk, 1.0_rk - distance(k)/tip%reach)
      ! A point on a face belongs to the side on which its cell lies.
      side = merge(1, 2, is_left(tip%ends(:, :, k), centre))
      change = change + nearness*((1.0_rk - share(k))*tip%change(1, side, k) &
                                  + share(k)*tip%change(2, side, k))
   end subroutine add_change

   !> Pressure of the rock in the middle of a face [Pa].
   pure real(rk) function pressure_of_face(tips, mesh, nodal, face) result(pressure)
      type(drained_tip_t), intent(in) :: tips(:)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: nodal(:)  !< (n_nodes) [Pa]
      integer(ik), intent(in) :: face
      real(rk) :: weights(3)
      integer(ik) :: i

      associate (cell => mesh%face_cells(1, face))
         do i = 1, 3
            weights(i) = merge(0.5_rk, 0.0_rk, any(mesh%face_nodes(:, face) &
                                                   == mesh%cell_nodes(i, cell)))
         end do
         pressure = pressure_at(tips, mesh, nodal, cell, weights)
      end associate
   end function pressure_of_face

   !> The cell behind a cell on the same fracture; the cell itself if there is none.
   pure integer(ik) function behind(mesh, cell, step)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, step

      behind = cell + step
      if (behind < 1 .or. behind > mesh%fracture%n_cells) then
         behind = cell
      else if (mesh%fracture%cell_fracture(behind) /= mesh%fracture%cell_fracture(cell)) then
         behind = cell
      end if
   end function behind

   !> Ends of a fracture cell, that nearer the tip first [m].
   pure function ends_of(mesh, cell, step) result(ends)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, step
      real(rk) :: ends(2, 2)

      ends = mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, cell))
      if (step < 0) ends = ends(:, 2:1:-1)
   end function ends_of

   !> Middle of a fracture cell [m].
   pure function middle(mesh, cell)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: middle(2)

      middle = 0.5_rk*sum(mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, cell)), dim=2)
   end function middle

   !> Whether a point lies to the left of the way from the first end to the second.
   pure logical function is_left(ends, point)
      real(rk), intent(in) :: ends(2, 2), point(2)  !< [m]

      is_left = cross(ends(:, 2) - ends(:, 1), point - ends(:, 1)) > 0.0_rk
   end function is_left

end module coarse_tip_drainage
