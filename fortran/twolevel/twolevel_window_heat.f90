!> The temperatures of the rock in a window, as the pressures p_T of coarse_rock that have their
!! stress.
!!
!! A front next to a face may be thinner than the elements. In each element they have the linear
!! field with the same integrals against linear functions (discontinuous between elements): so the
!! nodal forces, of strains that are linear in straight elements, are those of the front itself.
module twolevel_window_heat
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric, cross, left_part, triangle_area
   use coarse_rock, only: solid_t
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use heat_field, only: moments
   use mesh_geometry, only: face_length
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
      real(rk) :: area, inside(3), moment(3)
      real(rk), allocatable :: part(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, j, k, next
      logical :: crosses(3)

      if (all(corner_cells == corner_cells(1))) then
         corner = linear(integrals(problem, xy, xy, corner_cells(1)), triangle_area(xy))
         return
      end if
      moment = 0.0_rk
      area = 0.0_rk
      cells = corner_cells
      i = 0
      do while (i < size(cells))
         i = i + 1
         associate (mesh => problem%mesh, c => cells(i))
            if (any(cells(:i - 1) == c)) cycle
            part = xy
            associate (at => mesh%xy(:, mesh%cell_nodes(:, c)))
               do k = 1, 3
                  associate (from => at(:, k), to => at(:, modulo(k, 3_ik) + 1))
                     inside = [(cross(to - from, xy(:, j) - from), j=1, 3)]
                     crosses(k) = any(inside < 0.0_rk)
                     if (.not. crosses(k)) cycle
                     if (all(inside <= 0.0_rk)) exit
                     part = left_part(part, reshape([from, to], [2, 2]))
                  end associate
               end do
            end associate
            if (k <= 3 .or. size(part, 2) < 3) cycle
            do k = 2, size(part, 2, kind=ik) - 1
               associate (triangle => part(:, [1_ik, k, k + 1]))
                  moment = moment + integrals(problem, xy, triangle, c)
                  area = area + triangle_area(triangle)
               end associate
            end do
         end associate
         do k = 1, 3
            if (.not. crosses(k)) cycle
            next = sum(problem%mesh%face_cells(:, problem%mesh%cell_faces(k, cells(i)))) - cells(i)
            if (next > 0 .and. all(cells /= next)) cells = [cells, next]
         end do
      end do
      if (.not. area > most*triangle_area(xy)) then
         moment = 0.0_rk
         do k = 1, 3
            moment = moment + integrals(problem, xy, xy, corner_cells(k))/3.0_rk
         end do
         area = triangle_area(xy)
      end if
      corner = linear(moment, area)

   contains

      !> At the corners, from its integrals with their area coordinates.
      pure function linear(of, over)
         real(rk), intent(in) :: of(3)  !< [Pa m2]
         real(rk), intent(in) :: over  !< [m2]
         real(rk) :: linear(3)

         linear = (12.0_rk*of - 3.0_rk*sum(of))/over
      end function linear

   end function linear_part

   !> Integrals of the pressure in a coarse cell over a triangle, each weighted with an area
   !! coordinate of an element [Pa m2].
   function integrals(problem, xy, triangle, cell) result(moment)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: xy(2, 3)  !< corners of the element [m]
      real(rk), intent(in) :: triangle(2, 3)  !< [m]
      integer(ik), intent(in) :: cell
      real(rk) :: moment(3)
      real(rk) :: of_part(3), share(3, 3)
      integer(ik) :: j

      share = reshape([(barycentric(xy, triangle(:, j)), j=1, 3)], [3, 3])
      of_part = moments(problem%heat, problem%heat_field, triangle, cell)
      of_part = [(problem%model%rock%heat_pressure(cell, of_part(j)), j=1, 3)]
      moment = triangle_area(triangle)*matmul(share, of_part)
   end function integrals

   !> Error of K_I by the temperatures of coarse cells next to a tip whose faces have another
   !! temperature than the rock before. With a front of the time t round the tip of a long crack,
   !! K_I = 0.76 s (D t)^(1/4), s the thermal stress of the faces; measured, cells of the size h
   !! leave at most 0.06 h/(2 sqrt(D t)) of this wrong (docs/theory.md) [Pa m^1/2].
   pure real(rk) function heat_error(problem, fracture, end, time) result(error)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture, end  !< of the tip
      real(rk), intent(in) :: time  !< [s]
      real(rk), parameter :: whole = 0.76_rk, part = 0.03_rk*whole
      real(rk) :: root
      integer(ik) :: t
      type(solid_t) :: solid

      error = 0.0_rk
      if (.not. (allocated(problem%heat) .and. allocated(problem%model%rock%temperature))) return
      associate (mesh => problem%heat%mesh, layers => problem%heat%layers, &
                 rock => problem%heat%rock, field => problem%heat_field)
         t = findloc(mesh%fracture%tip_fracture == fracture .and. &
                     mesh%fracture%tip_end == end, .true., dim=1)
         if (t == 0 .or. layers%n == 0 .or. .not. time > 0.0_rk) return
         associate (near => field%near%of(mesh%fracture%tip_node(t)))
            if (size(near) == 0) return
            associate (l => near(1), c => layers%cell(near(1)))
               if (layers%at(1, l) == 0) return
               root = sqrt(sqrt(time*rock%mobility_at(c)/rock%storage(min(int(c), &
                                                                          size(rock%storage)))))
               solid = problem%model%rock%solid_at(c)
               error = solid%heat_stress*2.0_rk*solid%shear/(solid%lame + 2.0_rk*solid%shear) &
                       *abs(field%unknowns(3, layers%at(1, l)/3)) &
                       *min(whole*root, part*face_length(mesh, mesh%layer_face(l))/root)
            end associate
         end associate
      end associate
   end function heat_error

end module twolevel_window_heat
