!> The temperatures of the rock in a window, as the pressures p_T of coarse_rock that have their
!! stress.
!!
!! A front next to a face may be thinner than the elements. A value at a vertex is that of the
!! linear field between coarse nodes, plus the mean of what the profiles in the layers add to it,
!! weighted by the shape function of the vertex: so the elements contain what the profiles do.
module twolevel_window_heat
   use base_kinds, only: ik, rk
   use base_plane, only: triangle_area
   use fine_mesh, only: fine_mesh_t
   use heat_field, only: add_profile
   use twolevel_problem, only: coarse_problem_t
   use twolevel_window_map, only: window_map_t
   implicit none(type, external)
   private

   public :: warm_window

   integer, parameter :: parts = 4  !< of the edge of an element next to a layer

contains

   !> Set the pressures of the vertices of a window.
   subroutine warm_window(problem, fine, map)
      type(coarse_problem_t), intent(in) :: problem
      type(fine_mesh_t), intent(in) :: fine
      type(window_map_t), intent(inout) :: map
      real(rk) :: plain(fine%n_vertices)
      real(rk) :: extra(2, fine%n_vertices)  ! of each vertex [K m2], [m2]
      integer(ik) :: c, v

      if (.not. (allocated(problem%heat) .and. allocated(problem%model%rock%temperature))) return
      call map%interpolate(problem%mesh, problem%heat_field%nodal, plain)
      extra = 0.0_rk
      do c = 1, fine%n_cells
         call add_element(problem, fine, map, c, plain, extra)
      end do
      plain = plain + extra(1, :)/extra(2, :)
      map%heat_pressure = [(problem%model%rock%heat_pressure(map%coarse_cell(v), plain(v)), &
                            v=1, fine%n_vertices)]
   end subroutine warm_window

   !> Add what the profiles add in an element: at the centres of the triangles that it is cut into.
   pure subroutine add_element(problem, fine, map, c, plain, extra)
      type(coarse_problem_t), intent(in) :: problem
      type(fine_mesh_t), intent(in) :: fine
      type(window_map_t), intent(in) :: map
      integer(ik), intent(in) :: c
      real(rk), intent(in) :: plain(:)  !< (vertices) [K]
      real(rk), intent(inout) :: extra(:, :)  !< (2, vertices) [K m2], [m2]
      real(rk) :: area, here, share(3), there
      integer(ik) :: i, j, k

      associate (nodes => fine%cell_nodes(:3, c), cells => map%coarse_cell)
         area = triangle_area(fine%xy(:, nodes))
         extra(2, nodes) = extra(2, nodes) + area/3.0_rk
         if (.not. any(problem%heat_field%is_near(cells(nodes)))) return
         area = area/parts**2
         do i = 0, parts - 1
            do j = 0, 2*(parts - i) - 2
               share(1) = i + merge(1.0_rk, 2.0_rk, modulo(j, 2_ik) == 0)/3.0_rk
               share(2) = j/2 + merge(1.0_rk, 2.0_rk, modulo(j, 2_ik) == 0)/3.0_rk
               share(:2) = share(:2)/parts
               share(3) = 1.0_rk - share(1) - share(2)
               here = dot_product(share, plain(nodes))
               there = here
               k = maxloc(share, dim=1)
               call add_profile(problem%heat, problem%heat_field, &
                                matmul(fine%xy(:, nodes), share), cells(nodes(k)), there)
               extra(1, nodes) = extra(1, nodes) + area*share*(there - here)
            end do
         end do
      end associate
   end subroutine add_element

end module twolevel_window_heat
