!> The flow of the fluid that carries heat in a step of the coarse level, from its state after the
!! step: through faces, along fractures, through joints, and across the outer boundary.
!!
!! Where a face has a layer of fluid pressure, the multi-point fluxes are those at its outer end.
!! What the fluid of the fracture loses differs from that by what the layer stores, and is shared by
!! the two sides. Thus the flows into a fracture cell are those of its fluid balance.
module heat_flows
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_diffusion, only: region_fluxes
   use coarse_layer_places, only: cell_ahead, tip_conductance
   use coarse_layout, only: end_block
   use coarse_model, only: coarse_model_t
   use coarse_state, only: state_t
   use heat_links, only: external_t
   use heat_model, only: heat_model_t
   use mesh_geometry, only: face_length
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: set_flows

contains

   !> Set the flows of a step.
   subroutine set_flows(heat, mesh, model, state, wells)
      class(heat_model_t), intent(inout) :: heat
      type(mesh_t), intent(in) :: mesh  !< with the layers of the pressure
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state  !< after the step
      type(external_t), intent(in) :: wells(:)  !< their flows [W/(m K)]
      real(rk) :: round_tips(mesh%fracture%n_tips), through(mesh%n_faces)
      integer(ik) :: f, first, k, l

      round_tips = tip_flows(mesh, model, state)
      through = face_flows(mesh, model, state, round_tips)*heat%fluid_capacity
      heat%links(:mesh%n_faces)%flow = merge(through, 0.0_rk, mesh%face_side == 0)
      k = mesh%n_faces
      do l = 1, heat%layers%n
         f = heat%mesh%layer_face(l)
         heat%links(k + 1:k + heat%layers%chain(l)%n)%flow = through(f)
         k = k + heat%layers%chain(l)%n
      end do
      first = k + 1
      k = k + size(state%flow, kind=ik)
      heat%links(first:k)%flow = state%flow*heat%fluid_capacity
      first = k + 1
      k = k + size(state%branch_flow, kind=ik)
      heat%links(first:k)%flow = state%branch_flow*heat%fluid_capacity
      heat%links(k + 1:)%flow = round_tips*heat%fluid_capacity
      heat%externals = [wells, sides(heat, -through), outlets(heat, model, state)]
   end subroutine set_flows

   !> Flow through each face out of its first cell [m2/s].
   function face_flows(mesh, model, state, round_tips) result(through)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: round_tips(:)  !< (tips) of their cells' loss [m2/s]
      real(rk) :: loss(mesh%fracture%n_cells)
      real(rk) :: through(mesh%n_faces)
      real(rk), allocatable :: flux(:), scalars(:)
      integer(ik) :: f, i, j, r

      through = 0.0_rk
      scalars = model%regions%scalars_of(state%unknowns)
      do r = 1, model%regions%n_regions
         allocate (flux(model%regions%flow_faces%length(r)))
         call region_fluxes(model%regions, model%regions%flux, scalars, r, flux)
         do j = 1, size(flux, kind=ik)
            f = model%regions%flow_faces%at(r, j)
            through(f) = through(f) + 0.5_rk*face_length(mesh, f)*flux(j)
         end do
         deallocate (flux)
      end do
      do i = 1, mesh%fracture%n_cells
         loss(i) = state%leakoff(i)*face_length(mesh, mesh%fracture%cell_faces(1, i))
      end do
      do i = 1, mesh%fracture%n_tips
         j = tip_cell(mesh, i)
         loss(j) = loss(j) - round_tips(i)
      end do
      do i = 1, mesh%fracture%n_cells
         associate (faces => mesh%fracture%cell_faces(:, i))
            through(faces) = through(faces) - 0.5_rk*(loss(i) + sum(through(faces)))
         end associate
      end do
   end function face_flows

   !> Flow round each tip from the faces of its cell to the cell ahead, as in coarse_layer_places
   !! [m2/s].
   pure function tip_flows(mesh, model, state) result(flow)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(rk) :: flow(mesh%fracture%n_tips)
      integer(ik) :: ahead, i, side

      flow = 0.0_rk
      if (model%layers%n == 0) return
      do i = 1, mesh%fracture%n_tips
         ahead = cell_ahead(mesh, i)
         associate (cell => tip_cell(mesh, i))
            do side = 1, 2
               if (mesh%face_layer(mesh%fracture%cell_faces(side, cell)) == 0) cycle
               flow(i) = flow(i) + tip_conductance(model%rock, ahead) &
                         *(state%unknowns(3, end_block(mesh, cell, side)) &
                           - state%unknowns(3, ahead))
            end do
         end associate
      end do
   end function tip_flows

   !> Fracture cell at a tip.
   pure integer(ik) function tip_cell(mesh, tip)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: tip

      tip_cell = mesh%fracture%point_cells%at(mesh%fracture%tip_point(tip), 1_ik)
   end function tip_cell

   !> Heat across the outer boundary, except what the multi-point fluxes conduct. Fluid that enters
   !! has the temperature of the side, or where it has none that before the first step.
   pure function sides(heat, into) result(externals)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: into(:)  !< (faces) flow into the body [W/(m K)]
      type(external_t), allocatable :: externals(:)
      integer(ik) :: f, layer, n

      associate (mesh => heat%mesh)
         allocate (externals(count(mesh%face_side > 0)))
         n = 0
         do f = 1, mesh%n_faces
            if (mesh%face_side(f) == 0) cycle
            n = n + 1
            associate (side => heat%sides(mesh%face_side(f)), external => externals(n))
               external = external_t(mesh%face_cells(1, f), flow=into(f), &
                                     temperature=side%temperature)
               if (.not. side%temperature_given) external%temperature = &
                  heat%undisturbed(0.5_rk*sum(mesh%xy(2, mesh%face_nodes(:, f))))
               layer = 0
               if (mesh%n_layers > 0) layer = mesh%face_layer(f)
               if (layer == 0) cycle
               external%unknown = heat%first_node(layer)
               external%conductance = heat%layers%chain(layer)%conductance(0)
            end associate
         end do
      end associate
   end function sides

   !> Heat through the ends of fractures at sides with a pressure.
   pure function outlets(heat, model, state) result(externals)
      class(heat_model_t), intent(in) :: heat
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(external_t), allocatable :: externals(:)
      integer(ik) :: j, n

      associate (joints => model%joints, supplied => model%into_joints(state))
         allocate (externals(count(joints%is_outlet)))
         n = 0
         do j = 1, joints%n
            if (.not. joints%is_outlet(j)) cycle
            n = n + 1
            externals(n) = external_t(heat%first_joint - 1 + j, temperature= &
                                      outside(heat, heat%place(:, heat%first_joint - 1 + j)), &
                                      flow=-heat%fluid_capacity*(supplied(j) &
                                                   + sum(state%branch_flow(joints%branches%of(j)))))
         end do
      end associate
   end function outlets

   !> Temperature outside the body at a point of its boundary [K].
   pure real(rk) function outside(heat, point)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: point(2)  !< [m]
      integer(ik) :: f
      real(rk) :: distance, least

      outside = heat%undisturbed(point(2))
      least = huge(1.0_rk)
      do f = 1, heat%mesh%n_faces
         associate (side => heat%mesh%face_side(f), nodes => heat%mesh%face_nodes(:, f))
            if (side == 0) cycle
            distance = minval([norm2(heat%mesh%xy(:, nodes(1)) - point), &
                               norm2(heat%mesh%xy(:, nodes(2)) - point)])
            if (.not. distance < least) cycle
            least = distance
            outside = heat%undisturbed(point(2))
            if (heat%sides(side)%temperature_given) outside = heat%sides(side)%temperature
         end associate
      end do
   end function outside

end module heat_flows
