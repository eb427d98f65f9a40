!> Temperatures at points, for meshes finer than that of the coarse level: with the profiles in the
!! layers.
module heat_field
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: corner_gradient, region_fluxes
   use coarse_layer_profiles, only: find_pressure
   use coarse_layout, only: at_component, layer_block
   use heat_model, only: heat_model_t
   use mesh_geometry, only: cell_centre
   implicit none(type, external)
   private

   public :: add_profile, heat_field_t, new_field

   type :: heat_field_t
      real(rk), allocatable :: nodal(:)  !< (nodes) without the profiles [K]
      logical, allocatable :: is_near(:)  !< (cells) at a node of a face with a layer
      ! As coarse_layers has pressures:
      real(rk), allocatable :: unknowns(:, :)  !< (3, blocks) [K]
      real(rk), allocatable :: inner(:, :)  !< (n_nodes - 1, layers) [K]
   end type heat_field_t

contains

   !> The field of temperatures above those of the sides' datum.
   function new_field(heat, temperature) result(field)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      type(heat_field_t) :: field
      logical :: is_near(heat%mesh%n_nodes)
      integer(ik) :: c, k, l

      associate (mesh => heat%mesh, layers => heat%layers)
         field%nodal = nodal_values(heat, temperature)
         field%unknowns = reshape(merge(temperature(max(heat%of_scalar, 1_ik)), 0.0_rk, &
                                        heat%of_scalar > 0), [3, size(heat%of_scalar)/3])
         allocate (field%inner(max(layers%n_nodes - 1, 0_ik), layers%n), source=0.0_rk)
         is_near = .false.
         do l = 1, layers%n
            k = heat%first_node(l)
            associate (n => layers%chain(l)%n)
               field%inner(:n - 1, l) = temperature(k:k + n - 2)
               ! Half the difference between its ends is no unknown of heat.
               field%unknowns(2, layer_block(mesh, l)) = 0.0_rk
            end associate
            is_near(mesh%face_nodes(:, mesh%layer_face(l))) = .true.
         end do
         field%is_near = [(any(is_near(mesh%cell_nodes(:, c))), c=1, mesh%n_cells)]
      end associate
   end function new_field

   !> Temperatures at nodes: the mean of what the multi-point fluxes extrapolate from the cells, or
   !! with layers from the rests of them.
   function nodal_values(heat, temperature) result(nodal)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk), allocatable :: nodal(:)  !< (nodes) [K]
      real(rk) :: gradient(2), number(heat%mesh%n_nodes)
      real(rk), allocatable :: flux(:), scalars(:)
      integer(ik) :: c, cell, k, r

      scalars = heat%scalars(temperature)
      allocate (nodal(heat%mesh%n_nodes), source=0.0_rk)
      number = 0.0_rk
      associate (mesh => heat%mesh, regions => heat%regions)
         do r = 1, regions%n_regions
            flux = spread(0.0_rk, 1, int(regions%flow_faces%length(r)))
            call region_fluxes(regions, regions%flux, scalars, r, flux)
            do c = 1, regions%cell_count(r)
               cell = regions%blocks%at(r, c)
               k = findloc(regions%regions_of_block(:, cell), r, dim=1)
               call corner_gradient(mesh, heat%rock%resistivity, regions, flux, cell, k, gradient)
               associate (v => mesh%cell_nodes(k, cell))
                  number(v) = number(v) + 1.0_rk
                  nodal(v) = nodal(v) + temperature(cell) &
                             + dot_product(gradient, mesh%xy(:, v) - cell_centre(mesh, cell))
               end associate
            end do
         end do
      end associate
      nodal = nodal/number
   end function nodal_values

   !> Replace the temperature at a point by that of the profile of a layer before which it lies.
   pure subroutine add_profile(heat, field, xy, cell, temperature)
      class(heat_model_t), intent(in) :: heat
      type(heat_field_t), intent(in) :: field
      real(rk), intent(in) :: xy(2)  !< [m]
      integer(ik), intent(in) :: cell  !< of the coarse mesh
      real(rk), intent(inout) :: temperature  !< [K]

      call find_pressure(heat%layers, heat%mesh, field%unknowns, field%inner, xy, cell, &
                         field%nodal(heat%mesh%cell_nodes(:, cell)), temperature)
   end subroutine add_profile

end module heat_field
