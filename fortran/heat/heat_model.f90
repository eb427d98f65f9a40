!> Heat in rock and fractures on one mesh: finite volumes whose conduction is that of the
!! multi-point fluxes of the coarse level (coarse_diffusion), with the layers of that level next
!! to fractures and to sides with a temperature (coarse_layer_places, coarse_chain). The nodes of
!! layers are unknowns here, since fluid flows through them.
!!
!! Unknowns: the temperature of each cell, or with layers of the rest of it; of the nodes of layers,
!! from the face inwards; of fracture cells, which is also that of their faces; of joints, whose
!! capacity is next to nothing. All temperatures are relative to that of &heat, so that heat which
!! does not move leaves no rounding errors.
module heat_model
   use algebra_mumps, only: mumps_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use coarse_diffusion, only: set_flux_equations
   use coarse_elimination, only: eliminate, local_system_t, share_t
   use coarse_joints, only: joints_t
   use coarse_layer_places, only: cell_ahead, place_layers
   use coarse_layers, only: layers_t
   use coarse_layout, only: at_component, block_count, end_block, layer_block
   use coarse_permeability, only: place_regions
   use coarse_regions, only: find_regions, regions_t
   use coarse_rock, only: new_rock, rock_t
   use heat_links, only: external_t, link_t
   use heat_slopes, only: new_slopes, slopes_t
   use heat_state, only: heat_state_t
   use mesh_geometry, only: cell_area, cell_centre, face_length, fracture_cell_centre, &
                            outward_normal
   use mesh_types, only: mesh_t
   use scene_heat, only: heat_t
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: fluid_t, material_t, region_t, scene_t
   implicit none(type, external)
   private

   public :: heat_model_t

   !> Nodes of layers compared with those of the pressure, for temperatures at points and not only
   !! flows through faces.
   integer(ik), parameter :: finer = 2
   !> The last node of an extended layer, and how far the rest of its cell lies beyond the centre,
   !! both over the distance of the centre from the face (docs/theory.md) [-].
   real(rk), parameter :: last_place = 0.88_rk, beyond_centre = 0.2_rk

   type :: heat_model_t
      integer(ik) :: n = 0  !< unknowns
      type(mesh_t) :: mesh  !< with the layers of heat
      type(rock_t) :: rock  !< conductivity and capacity instead of mobility and storage
      type(regions_t) :: regions
      type(layers_t) :: layers
      type(heat_t) :: heat  !< of the scene
      real(rk) :: fluid_capacity = 0.0_rk  !< C_f [J/(m3 K)]
      type(boundary_side_t), allocatable :: sides(:)  !< temperatures and heat flows of the sides
      integer(ik), allocatable :: first_node(:)  !< (layers) unknown of the node next to the face
      integer(ik) :: first_cell = 0  !< unknown of the first fracture cell
      integer(ik) :: first_joint = 0  !< unknown of the first joint
      integer(ik), allocatable :: of_scalar(:)  !< unknowns of what the stencils see; 0: none
      real(rk), allocatable :: place(:, :)  !< (2, unknowns) [m]
      real(rk), allocatable :: initial(:)  !< (unknowns) temperature before the first step [K]
      ! Conduction: flow into unknown row of each entry's value times the temperature of col.
      integer(ik), allocatable :: row(:), col(:)
      real(rk), allocatable :: conduction(:)  !< [W/(m K)]
      type(slopes_t) :: slopes  !< along faces with layers
      real(rk), allocatable :: known(:)  !< (unknowns) flow out of them that the sides give [W/m]
      type(link_t), allocatable :: links(:)  !< faces, nodes of layers, fracture cells, branches
      type(mumps_t) :: matrix
      type(external_t), allocatable :: externals(:)  !< of the present step
   contains
      procedure :: set_mesh
      procedure :: along_faces
      procedure :: begin
      procedure :: scalars
      procedure :: cell_means
      procedure :: last_node
      procedure :: of_cells
      procedure :: rock_capacity
      procedure :: undisturbed
   end type heat_model_t

contains

   !> Discretize; `first` is the shortest time that layers have to resolve.
   subroutine set_mesh(self, mesh, scene, connections, joints, first, error)
      class(heat_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      integer(ik), intent(in) :: connections(:, :)  !< (2, pairs) of fracture cells
      type(joints_t), intent(in) :: joints
      real(rk), intent(in) :: first  !< [s]
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: l

      self%mesh = mesh
      self%heat = scene%heat
      self%fluid_capacity = scene%fluid%heat_capacity
      self%sides = sides_of_scene(scene)
      self%sides%pressure_given = self%sides%temperature_given
      self%sides%temperature = self%sides%temperature - self%heat%temperature
      self%rock = thermal_rock(scene, mesh)
      call place_layers(self%mesh, self%rock, self%sides, first, self%layers, finer, &
                        last_place)
      do l = 1, self%layers%n
         if (self%layers%fracture_cell(l) > 0) cycle
         ! In the rise above the initial temperatures (heat_field)
         self%layers%given(l) = self%sides(self%layers%side(l))%temperature - self%undisturbed( &
                                0.5_rk*sum(mesh%xy(2, mesh%face_nodes(:, self%mesh%layer_face(l)))))
      end do
      call find_regions(self%mesh, self%regions)
      call number_unknowns(self, joints)
      call conduct(self, error)
      if (allocated(error)) return
      call place_sources(self)
      call link(self, connections, joints)
   end subroutine set_mesh

   !> Conductivity and capacity as the mobility and the storage of rigid rock.
   pure function thermal_rock(scene, mesh) result(rock)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(rock_t) :: rock
      type(region_t), allocatable :: regions(:)
      type(fluid_t) :: unit
      integer :: i

      unit%viscosity = 1.0_rk
      unit%compressibility = 1.0_rk
      rock = new_rock(thermal(scene%material), unit)
      if (.not. allocated(scene%regions)) return
      regions = scene%regions
      do i = 1, size(regions)
         regions(i)%material = thermal(regions(i)%material)
      end do
      call place_regions(mesh, regions, scene%domain, unit, rock)

   contains

      pure type(material_t) function thermal(material)
         type(material_t), intent(in) :: material
         real(rk), parameter :: rigid = 1.0e30_rk  ! [Pa]

         thermal%young = rigid
         thermal%porosity = material%heat_capacity
         thermal%permeability_xx = material%heat_conductivity
         thermal%permeability_yy = material%heat_conductivity
      end function thermal

   end function thermal_rock

   !> Number the unknowns, and find where they lie.
   subroutine number_unknowns(self, joints)
      class(heat_model_t), intent(inout) :: self
      type(joints_t), intent(in) :: joints
      integer(ik) :: c, f, i, l, n
      real(rk) :: middle(2)

      associate (mesh => self%mesh, layers => self%layers)
         n = mesh%n_cells
         allocate (self%first_node(layers%n))
         do l = 1, layers%n
            self%first_node(l) = n + 1
            n = n + layers%chain(l)%n
         end do
         self%first_cell = n + 1
         self%first_joint = self%first_cell + mesh%fracture%n_cells
         self%n = self%first_joint + joints%n - 1
         allocate (self%place(2, self%n), self%of_scalar(3*block_count(mesh)))
         self%of_scalar = 0
         do c = 1, mesh%n_cells
            self%place(:, c) = cell_centre(mesh, c)
            self%of_scalar(at_component(c, 3_ik)) = c
         end do
         do l = 1, layers%n
            associate (chain => layers%chain(l), at => at_component(layer_block(mesh, l), 1_ik))
               f = mesh%layer_face(l)
               middle = 0.5_rk*sum(mesh%xy(:, mesh%face_nodes(:, f)), dim=2)
               c = layers%cell(l)
               if (layers%extended(l)) then
                  self%place(:, c) = self%place(:, c) &
                                     - beyond_centre*distance(self, c, f)*outward_normal(mesh, f)
               end if
               do i = 1, chain%n
                  self%place(:, self%first_node(l) + i - 1) = &
                     middle - chain%place(i)*outward_normal(mesh, f)
               end do
               self%of_scalar(at:at + 1) = self%first_node(l) + chain%n - 1
               self%of_scalar(at + 2) = layers%cell(l)
            end associate
         end do
         do i = 1, mesh%fracture%n_cells
            self%place(:, self%first_cell + i - 1) = fracture_cell_centre(mesh%fracture, i)
            self%of_scalar(at_component(end_block(mesh, i, [1_ik, 2_ik]), 3_ik)) = &
               self%first_cell + i - 1
         end do
         self%place(:, self%first_joint:) = mesh%fracture%point_xy(:, joints%point)
      end associate
      self%initial = self%undisturbed(self%place(2, :))
   end subroutine number_unknowns

   !> Temperature before the first step at a height [K].
   elemental real(rk) function undisturbed(self, y)
      class(heat_model_t), intent(in) :: self
      real(rk), intent(in) :: y  !< [m]

      undisturbed = self%heat%temperature_per_y*(y - self%heat%y_datum)
   end function undisturbed

   !> The conduction by multi-point fluxes.
   subroutine conduct(self, error)
      class(heat_model_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(local_system_t) :: local
      type(share_t) :: share
      integer(ik), allocatable :: around(:)
      logical :: is_given(size(self%sides))
      real(rk) :: given(size(self%sides))  ! [K] or [W/m2]
      real(rk) :: offset(2, self%mesh%n_cells)  ! [m]
      integer(ik) :: a, b, info, m, n, r

      offset = self%place(:, :self%mesh%n_cells) &
               - reshape([(cell_centre(self%mesh, a), a=1, self%mesh%n_cells)], shape(offset))
      is_given = self%sides%temperature_given
      given = merge(self%sides%temperature, -self%sides%heat_flux, is_given)
      n = sum([(self%regions%scalar_count(r)**2, r=1, self%regions%n_regions)])
      allocate (self%row(n), self%col(n), self%conduction(n))
      self%slopes = new_slopes(self%mesh, n)
      allocate (self%known(self%n), source=0.0_rk)
      n = 0
      do r = 1, self%regions%n_regions
         call set_flux_equations(self%mesh, self%rock%resistivity, is_given, given, self%regions, &
                                 r, local, self%layers%relief, offset)
         call eliminate(local, self%regions%flux(r), share, info)
         if (info /= 0) then
            call raise_error(error, "heat_model", "the cells around a vertex are degenerate")
            return
         end if
         around = around_vertex(self, r)
         m = size(around, kind=ik)
         do a = 1, m
            if (around(a) == 0) cycle
            self%known(around(a)) = self%known(around(a)) + share%known(a)
            do b = 1, m
               if (around(b) == 0) cycle
               n = n + 1
               self%row(n) = around(b)
               self%col(n) = around(a)
               self%conduction(n) = share%matrix(a, b)
               if (.not. allocated(self%regions%scalars)) cycle
               call self%slopes%add(self%mesh, self%regions%scalars%at(r, a), around(b), &
                                    share%matrix(a, b))
            end do
         end do
      end do
      self%row = self%row(:n)
      self%col = self%col(:n)
      self%conduction = self%conduction(:n)
   end subroutine conduct

   !> Sources of heat, each in the cell around it.
   pure subroutine place_sources(self)
      class(heat_model_t), intent(inout) :: self
      real(rk) :: inside(self%mesh%n_cells)
      integer(ik) :: c, i

      if (.not. allocated(self%heat%source_power)) return
      do i = 1, size(self%heat%source_power, kind=ik)
         associate (mesh => self%mesh, at => [self%heat%source_x(i), self%heat%source_y(i)])
            do c = 1, mesh%n_cells
               inside(c) = minval(barycentric(mesh%xy(:, mesh%cell_nodes(:, c)), at))
            end do
         end associate
         c = maxloc(inside, dim=1, kind=ik)
         self%known(c) = self%known(c) - self%heat%source_power(i)
      end do
   end subroutine place_sources

   !> The unknowns around a vertex.
   pure function around_vertex(self, region) result(around)
      class(heat_model_t), intent(in) :: self
      integer(ik), intent(in) :: region
      integer(ik) :: around(self%regions%scalar_count(region))

      if (allocated(self%regions%scalars)) then
         around = self%of_scalar(self%regions%scalars%of(region))
      else
         around = self%of_scalar(at_component(self%regions%blocks%of(region), 3_ik))
      end if
   end function around_vertex

   !> Heat that the slopes of the temperature along faces bring into the unknowns [W/m].
   pure function along_faces(self, temperature) result(into)
      class(heat_model_t), intent(in) :: self
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk) :: into(self%n)

      into = self%slopes%heat_flows(self%slopes%ends(self%layers, self%first_node, temperature), &
                                    self%n)
   end function along_faces

   !> Temperatures among which the multi-point fluxes find those around a vertex.
   pure function scalars(self, temperature) result(values)
      class(heat_model_t), intent(in) :: self
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk), allocatable :: values(:)  !< [K]

      allocate (values(size(self%of_scalar)), source=0.0_rk)
      where (self%of_scalar > 0) values = temperature(max(self%of_scalar, 1_ik))
      if (.not. allocated(self%regions%scalars)) values = values(3 :: 3)
   end function scalars

   !> Set up the links, in this order: faces of the mesh; from node to node of layers, the last one
   !! to the cell; pairs of fracture cells; branches to their joints; last fracture cells to the
   !! cells ahead of the tips. Faces on the outer boundary have none.
   subroutine link(self, connections, joints)
      class(heat_model_t), intent(inout) :: self
      integer(ik), intent(in) :: connections(:, :)
      type(joints_t), intent(in) :: joints
      integer(ik) :: b, f, i, k, l, n

      n = self%mesh%n_faces + self%first_cell - 1 - self%mesh%n_cells + size(connections, 2) &
          + joints%branch_count() + self%mesh%fracture%n_tips
      allocate (self%links(n))
      do f = 1, self%mesh%n_faces
         self%links(f) = face_link(self, f)
      end do
      k = self%mesh%n_faces
      do l = 1, self%layers%n
         associate (chain => self%layers%chain(l), first => self%first_node(l))
            do i = 1, chain%n - 1
               self%links(k + i) = link_t([first + i, first + i - 1], chain%conductance(i))
            end do
            ! Between the last node and the centre of the cell.
            self%links(k + chain%n) = &
               link_t([self%layers%cell(l), first + chain%n - 1], &
                      across(self, self%mesh%layer_face(l), chain%place(chain%n)), .false.)
            k = k + chain%n
         end associate
      end do
      do i = 1, size(connections, 2, kind=ik)
         self%links(k + i) = link_t(self%first_cell - 1 + connections(:, i), is_limited=.true.)
      end do
      k = k + size(connections, 2, kind=ik)
      do b = 1, joints%branch_count()
         self%links(k + b) = link_t([self%first_cell - 1 + joints%cell(b), &
                                     self%first_joint - 1 + joints%joint(b)], is_limited=.true.)
      end do
      k = k + joints%branch_count()
      associate (fracture => self%mesh%fracture)
         do i = 1, fracture%n_tips
            self%links(k + i)%ends = [self%first_cell - 1 + fracture%point_cells%at( &
                                      fracture%tip_point(i), 1_ik), cell_ahead(self%mesh, i)]
         end do
      end associate
   end subroutine link

   !> From the first cell of a face to the second, or to the fracture, whose layer is in between.
   pure type(link_t) function face_link(self, f) result(face)
      class(heat_model_t), intent(in) :: self
      integer(ik), intent(in) :: f
      integer(ik) :: layer
      real(rk) :: half(2)

      associate (mesh => self%mesh, cells => self%mesh%face_cells(:, f))
         if (mesh%face_side(f) > 0) return
         face%ends = cells
         if (cells(2) > 0) then
            half = [across(self, f, 0.0_rk), across(self, f, 0.0_rk, 2)]
            face%conductance = product(half)/sum(half)
            face%conducts = .false.
            return
         end if
         face%ends(2) = self%first_cell - 1 + mesh%face_fracture_cell(f)
         layer = 0
         if (mesh%n_layers > 0) layer = mesh%face_layer(f)
         if (layer > 0) then
            face%ends(1) = self%first_node(layer)
            face%conductance = self%layers%chain(layer)%conductance(0)
         else
            face%conductance = across(self, f, 0.0_rk)
            face%conducts = .false.
         end if
      end associate
   end function face_link

   !> Distance of the place of a cell from one of its faces [m].
   pure real(rk) function distance(self, cell, face)
      class(heat_model_t), intent(in) :: self
      integer(ik), intent(in) :: cell, face

      associate (mesh => self%mesh)
         distance = abs(dot_product(outward_normal(mesh, face), self%place(:, cell) &
                                    - mesh%xy(:, mesh%face_nodes(1, face))))
      end associate
   end function distance

   !> Conductance between a distance from a face and the place of one of its cells [W/(m K)].
   pure real(rk) function across(self, f, from, which) result(conductance)
      class(heat_model_t), intent(in) :: self
      integer(ik), intent(in) :: f
      real(rk), intent(in) :: from  !< [m]
      integer, intent(in), optional :: which  !< of its two cells
      integer :: k

      k = 1
      if (present(which)) k = which
      associate (c => self%mesh%face_cells(k, f))
         conductance = self%rock%mobility_at(c)*face_length(self%mesh, f) &
                       /(distance(self, c, f) - from)
      end associate
   end function across

   !> The state before the first step.
   pure subroutine begin(self, width, length, first, n_wells, state)
      class(heat_model_t), intent(in) :: self
      real(rk), intent(in) :: width(:), length(:)  !< fluid and length of the fracture cells [m]
      real(rk), intent(in) :: first  !< first substep [s]
      integer, intent(in) :: n_wells
      type(heat_state_t), intent(out) :: state
      real(rk), parameter :: nothing = 1.0e-6_rk  ! of a joint, over the largest cell's [-]

      state%temperature = self%initial
      state%next = first
      allocate (state%well_temperature(n_wells), source=0.0_rk)
      associate (of_fractures => self%fluid_capacity*width*length)
         state%capacity = [self%rock_capacity(), of_fractures, &
                           spread(nothing*maxval([0.0_rk, of_fractures]), 1, &
                                  int(self%n - self%first_joint) + 1)]
      end associate
      state%range = [minval(self%initial), maxval(self%initial)]
   end subroutine begin

   !> Capacity of the rock and its first fluid, of cells and nodes of layers [J/(m K)].
   pure function rock_capacity(self) result(capacity)
      class(heat_model_t), intent(in) :: self
      real(rk) :: capacity(self%first_cell - 1)
      integer(ik) :: c, l

      do c = 1, self%mesh%n_cells
         capacity(c) = self%rock%storage(min(int(c), size(self%rock%storage))) &
                       *cell_area(self%mesh, c)
      end do
      associate (layers => self%layers)
         if (layers%n > 0) capacity(layers%cells) = layers%storage*layers%rest
         do l = 1, layers%n
            capacity(self%first_node(l):self%last_node(l)) = layers%chain(l)%storage &
                                                             *layers%chain(l)%volume
         end do
      end associate
   end function rock_capacity

   !> Last unknown of a layer.
   elemental integer(ik) function last_node(self, layer)
      class(heat_model_t), intent(in) :: self
      integer(ik), intent(in) :: layer

      last_node = self%first_node(layer) + self%layers%chain(layer)%n - 1
   end function last_node

   !> Sum over each cell and its layers.
   pure function of_cells(self, values) result(total)
      class(heat_model_t), intent(in) :: self
      real(rk), intent(in) :: values(:)  !< (unknowns of the rock, at least)
      real(rk) :: total(self%mesh%n_cells)
      integer(ik) :: c, k, l

      total = values(:self%mesh%n_cells)
      do l = 1, self%layers%n
         c = self%layers%cell(l)
         do k = self%first_node(l), self%last_node(l)
            total(c) = total(c) + values(k)
         end do
      end do
   end function of_cells

   !> Mean temperature of each cell with its layers [K].
   pure function cell_means(self, state) result(mean)
      class(heat_model_t), intent(in) :: self
      type(heat_state_t), intent(in) :: state
      real(rk) :: mean(self%mesh%n_cells)

      mean = self%of_cells(state%capacity*state%temperature)/self%of_cells(state%capacity)
   end function cell_means

end module heat_model
