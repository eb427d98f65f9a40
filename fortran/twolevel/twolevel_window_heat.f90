!> The temperatures of the rock in a window, as the pressures p_T of coarse_rock that have their
!! stress.
!!
!! A front next to a face may be thinner than the elements. In each element they have the linear
!! field with the same integrals against linear functions (discontinuous between elements): so the
!! nodal forces, of strains that are linear in straight elements, are those of the front itself.
module twolevel_window_heat
   use base_kinds, only: ik, rk
   use base_plane, only: triangle_area
   use coarse_rock, only: solid_t
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use heat_field, only: moments
   use mesh_geometry, only: face_length
   use mesh_types, only: mesh_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_window_map, only: window_map_t
   implicit none(type, external)
   private

   public :: heat_error, warm_window

contains

   !> Set the pressures in the elements of a window, unless they are known.
   subroutine warm_window(problem, fine, map, loads)
      type(coarse_problem_t), intent(in) :: problem
      type(fine_mesh_t), intent(in) :: fine
      type(window_map_t), intent(inout) :: map
      type(fine_loads_t), intent(inout) :: loads
      logical :: is_known
      integer(ik) :: c

      if (.not. (allocated(problem%heat) .and. allocated(problem%model%rock%temperature))) return
      is_known = allocated(loads%heat_pressure) .and. allocated(map%temperature)
      if (is_known) is_known = all(abs(map%temperature - problem%heat_field%acting) <= 0.0_rk)
      if (is_known) return
      map%temperature = problem%heat_field%acting
      if (.not. allocated(loads%heat_pressure)) allocate (loads%heat_pressure(3, fine%n_cells))
      do c = 1, fine%n_cells
         associate (nodes => fine%cell_nodes(:3, c))
            loads%heat_pressure(:, c) = linear_part(problem, fine%xy(:, nodes), &
                                                    map%coarse_cell(nodes))
         end associate
      end do
   end subroutine warm_window

   !> The linear pressure in an element, at its corners: from its parts in the coarse cells, or, if
   !! these hardly hold it (along paths that differ from the coarse ones), from the cells at its
   !! corners, continued [Pa].
   function linear_part(problem, xy, corner_cells) result(corner)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: xy(2, 3)  !< corners [m]
      integer(ik), intent(in) :: corner_cells(3)  !< coarse cells there
      real(rk) :: corner(3)
      real(rk), parameter :: most = 0.9_rk  ! of the area that counts as held
      real(rk), parameter :: whole(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      real(rk) :: inside(3, 3)  ! (corners, faces of a cell), see `find_part` [m2]
      real(rk) :: part(3, 9)  ! area coordinates of its corners
      real(rk) :: area, moment(3)  ! integrals over parts, over the area of the element
      integer(ik), allocatable :: cells(:)
      integer(ik) :: c, i, k, m, n, next

      moment = 0.0_rk
      area = 0.0_rk
      allocate (cells(20))
      cells(:3) = corner_cells
      n = merge(1, 3, all(corner_cells == corner_cells(1)))
      i = 0
      do while (i < n)
         i = i + 1
         c = cells(i)
         if (any(cells(:i - 1) == c)) cycle
         call find_part(problem%mesh, c, xy, inside, part, m)
         if (n == 1) then
            part(:, :3) = whole
            m = 3
         end if
         if (m < 3) cycle
         call integrate(problem, c, xy, inside, part(:, :m), moment, area)
         if (n == 1) exit
         do k = 1, 3
            if (.not. any(inside(:, k) < 0.0_rk)) cycle
            next = sum(problem%mesh%face_cells(:, problem%mesh%cell_faces(k, c))) - c
            if (next == 0 .or. any(cells(:n) == next)) cycle
            if (n == size(cells)) cells = [cells, cells]
            n = n + 1
            cells(n) = next
         end do
      end do
      if (.not. area > most) then
         moment = 0.0_rk
         area = 0.0_rk
         do k = 1, 3
            call find_part(problem%mesh, corner_cells(k), xy, inside, part, m)
            call integrate(problem, corner_cells(k), xy, inside, whole, moment, area)
         end do
      end if
      corner = (12.0_rk*moment - 3.0_rk*sum(moment))/area
   end function linear_part

   !> The part of an element in a coarse cell.
   pure subroutine find_part(mesh, cell, xy, inside, part, n)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: xy(2, 3)  !< corners of the element [m]
      !> Twice the areas between the faces of the cell and the corners: (corners, faces), positive
      !! inside [m2]
      real(rk), intent(out) :: inside(3, 3)
      real(rk), intent(out) :: part(3, 9)  !< area coordinates of its corners
      integer(ik), intent(out) :: n  !< number of its corners
      real(rk) :: along(2), before(3, 9), from(2), here, there
      integer(ik) :: j, k, m, next

      n = 0
      associate (nodes => mesh%cell_nodes(:, cell))
         do k = 1, 3
            from = mesh%xy(:, nodes(k))
            along = mesh%xy(:, nodes(modulo(k, 3_ik) + 1)) - from
            inside(:, k) = along(1)*(xy(2, :) - from(2)) - along(2)*(xy(1, :) - from(1))
         end do
      end associate
      if (any(all(inside <= 0.0_rk, dim=1))) return
      part(:, :3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      n = 3
      do k = 1, 3
         if (.not. any(inside(:, k) < 0.0_rk)) cycle
         before = part
         m = n
         n = 0
         do j = 1, m
            next = mod(j, m) + 1
            here = dot_product(inside(:, k), before(:, j))
            there = dot_product(inside(:, k), before(:, next))
            if (here >= 0.0_rk) then
               n = n + 1
               part(:, n) = before(:, j)
            end if
            if ((here > 0.0_rk .and. there < 0.0_rk) .or. (here < 0.0_rk .and. there > 0.0_rk)) then
               n = n + 1
               part(:, n) = before(:, j) + here/(here - there)*(before(:, next) - before(:, j))
            end if
         end do
      end do
   end subroutine find_part

   !> Add the integrals of the pressure in a coarse cell over a part of an element, each weighted
   !! with an area coordinate of the element [Pa], and the area, over that of the element.
   subroutine integrate(problem, cell, xy, inside, part, moment, area)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: xy(2, 3)  !< corners of the element [m]
      real(rk), intent(in) :: inside(3, 3)  !< of `find_part` [m2]
      real(rk), intent(in) :: part(:, :)  !< area coordinates of its corners
      real(rk), intent(inout) :: moment(3), area
      real(rk) :: mean(3), plain(3), share, stress
      integer(ik) :: k

      associate (field => problem%heat_field, nodes => problem%mesh%cell_nodes(:, cell))
         stress = problem%model%rock%heat_pressure(cell, 1.0_rk)
         ! The temperature without profiles, continued to the corners of the element
         plain = matmul(inside(:, [2, 3, 1]), field%nodal(nodes))/sum(inside(1, :)) &
                 + field%lack(cell)
         do k = 2, size(part, 2, kind=ik) - 1
            associate (triangle => part(:, [1_ik, k, k + 1]))
               share = triangle_area(triangle(2:, :))*2.0_rk  ! of the element
               if (field%around%length(cell) > 0) then
                  mean = moments(problem%heat, field, matmul(xy, triangle), cell)
               else
                  mean = matmul(plain, triangle)
                  mean = (sum(mean) + mean)/12.0_rk
               end if
               moment = moment + stress*share*matmul(triangle, mean)
               area = area + share
            end associate
         end do
      end associate
   end subroutine integrate

   !> Error of K_I by the temperatures of coarse cells next to a tip whose faces have another
   !! temperature than the rock before. With a front of the age t round the tip of a long crack,
   !! K_I = 0.76 s (D t)^(1/4), s the thermal stress of the faces; measured, cells of the size h
   !! leave at most 0.06 h/(2 sqrt(D t)) of this wrong (docs/theory.md). sqrt(pi D t) is the
   !! temperature of the last face over its slope into the rock, or if that is longer than the face,
   !! its square over the length of the face: wide fronts are steep at the tip [Pa m^1/2].
   pure real(rk) function heat_error(problem, fracture, end) result(error)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture, end  !< of the tip
      real(rk), parameter :: pi = acos(-1.0_rk), whole = 0.76_rk, part = 0.03_rk*whole
      real(rk) :: root, thickness
      integer(ik) :: l, t
      type(solid_t) :: solid

      error = 0.0_rk
      if (.not. (allocated(problem%heat) .and. allocated(problem%model%rock%temperature))) return
      associate (mesh => problem%heat%mesh, layers => problem%heat%layers, &
                 field => problem%heat_field)
         t = findloc(mesh%fracture%tip_fracture == fracture .and. &
                     mesh%fracture%tip_end == end, .true., dim=1)
         if (t == 0) return
         if (field%near%length(mesh%fracture%tip_node(t)) == 0) return
         l = field%near%at(mesh%fracture%tip_node(t), 1_ik)
         associate (c => layers%cell(l), h => face_length(mesh, mesh%layer_face(l)))
            associate (profile => field%profile(field%around%first(c) - 1 &
                                                + field%around%place(c, l)))
               if (.not. abs(profile%slopes(1)) > 0.0_rk) return
               thickness = abs(profile%values(1)/profile%slopes(1))
               root = sqrt(thickness*max(1.0_rk, thickness/h)/sqrt(pi))
               solid = problem%model%rock%solid_at(c)
               error = solid%heat_stress*2.0_rk*solid%shear/(solid%lame + 2.0_rk*solid%shear) &
                       *abs(profile%values(1))*min(whole*root, part*h/root)
            end associate
         end associate
      end associate
   end function heat_error

end module twolevel_window_heat
