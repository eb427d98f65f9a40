!> Pressure over the distance from the faces with layers: at points, and from one mesh to the next.
module coarse_layer_profiles
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use base_plane, only: norm2, turned_left
   use coarse_layers, only: layers_t
   use mesh_geometry, only: cell_centre
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: find_pressure, kept_faces_t, no_profiles, profile_t, profiles_of, profiles_t
   public :: return_excess, set_apart, take_profiles

   !> The pressure before a face with a layer, not farther from it than the height of its cell.
   !! Beyond the last node of the chain it is an exponential curve, with the slope of the chain
   !! there, to the pressure of the farthest node of the point's cell: exact where the pressure is
   !! linear.
   !!
   !! At tips the profile of the last face goes round the tip. Near a tip the pressure differs from
   !! that of the faces by A xi, xi**2 = (r + x)/2, with the distance r from the tip and x ahead of
   !! it. Its mean slope before the last face, of length L, is A/sqrt(L): the depth in the profile
   !! is sqrt(L) xi.
   type :: profile_t
      real(rk) :: start(2) = 0.0_rk  !< an end of the face, a tip if it has one [m]
      real(rk) :: ahead(2) = 0.0_rk, normal(2) = 0.0_rk  !< unit vectors
      real(rk) :: length = 0.0_rk, height = 0.0_rk  !< of face and cell [m]
      logical :: at_tip = .false.
      ! In one cell: nodes, from the face to the farthest corner
      real(rk), allocatable :: places(:)  !< [m]
      real(rk), allocatable :: values(:)  !< [Pa]
      real(rk), allocatable :: slopes(:)  !< [Pa/m]
      real(rk) :: rate = 0.0_rk  !< of the exponential curve [-]
   contains
      procedure :: place
      procedure :: set_values
      procedure :: depth
      procedure :: pressure_at
   end type profile_t

   !> Pressures in the layers, for their transfer to another mesh.
   type :: profiles_t
      integer(ik), allocatable :: cell(:), face_of_cell(:), fracture_cell(:), side(:)
      integer(ik), allocatable :: n(:)  !< nodes
      real(rk), allocatable :: place(:, :)  !< distance of the nodes from the face [m]
      real(rk), allocatable :: value(:, :)  !< (nodes, and then that of the rest of the cell) [Pa]
      !> Content beyond that at the pressure of the rest of the cell, of layers that are kept [m2]
      real(rk), allocatable :: excess(:)
   end type profiles_t

   !> Faces of the fracture cells of a new mesh that are, or are parts of, faces before: a joint
   !! divides a face, or moves a node between two faces.
   type :: kept_faces_t
      type(lists_t) :: before  !< fracture cells before that each fracture cell overlaps
      real(rk), allocatable :: of_old(:), of_new(:)  !< (items) overlap, over the length of each [-]
   end type kept_faces_t

contains

   !> The pressure at a point, by the nearest of some layers whose profiles reach it; elsewhere it
   !! is left as it is.
   pure subroutine find_pressure(layers, among, mesh, tips, unknowns, inner, xy, cell, at_nodes, &
                                 pressure)
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: among(:)  !< numbers of these layers
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: tips(:)  !< nodes at these tips
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      real(rk), intent(in) :: xy(2)  !< [m]
      integer(ik), intent(in) :: cell  !< in which the point lies, or next to it
      real(rk), intent(in) :: at_nodes(3)  !< pressures at the nodes of this cell [Pa]
      real(rk), intent(inout) :: pressure  !< [Pa]
      type(profile_t) :: profile
      real(rk) :: depth, nearest
      integer(ik) :: i

      nearest = huge(1.0_rk)
      do i = 1, size(among, kind=ik)
         call profile%place(layers, among(i), mesh, tips)
         depth = profile%depth(xy)
         if (depth > min(profile%height, nearest)) cycle
         nearest = depth
         call profile%set_values(layers, among(i), unknowns, inner, &
                                 mesh%xy(:, mesh%cell_nodes(:, cell)), at_nodes)
         pressure = profile%pressure_at(xy, depth)
      end do
   end subroutine find_pressure

   !> Place the profile of a layer.
   pure subroutine place(self, layers, layer, mesh, tips)
      class(profile_t), intent(inout) :: self
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: layer
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: tips(:)  !< nodes at these tips
      real(rk) :: depth
      integer(ik) :: end

      associate (nodes => mesh%face_nodes(:, mesh%layer_face(layer)))
         end = merge(2, 1, any(tips == nodes(2)))
         self%at_tip = any(tips == nodes(end))
         self%start = mesh%xy(:, nodes(end))
         self%ahead = self%start - mesh%xy(:, nodes(3 - end))
      end associate
      self%length = norm2(self%ahead)
      self%ahead = self%ahead/self%length
      self%normal = turned_left(self%ahead)
      depth = dot_product(cell_centre(mesh, layers%cell(layer)) - self%start, self%normal)
      if (depth < 0.0_rk) self%normal = -self%normal
      self%height = 3.0_rk*abs(depth)
   end subroutine place

   !> Set the nodes of a profile in a cell.
   pure subroutine set_values(self, layers, layer, unknowns, inner, corners, at_nodes)
      class(profile_t), intent(inout) :: self
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: layer
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      real(rk), intent(in) :: corners(2, 3)  !< of the cell [m]
      real(rk), intent(in) :: at_nodes(3)  !< pressures there [Pa]
      real(rk), parameter :: small = 0.01_rk  ! gap of the last two places
      real(rk) :: at_face, depths(3)
      integer(ik) :: far, k

      at_face = layers%given(layer)
      if (layers%at(1, layer) > 0) at_face = unknowns(3, layers%at(1, layer)/3)
      depths = [(distance(self, corners(:, k)), k=1, 3)]
      far = maxloc(depths, dim=1)
      associate (chain => layers%chain(layer), n => layers%chain(layer)%n)
         if (self%at_tip) then
            depths(far) = max(round_tip(self, corners(:, far)), (1.0_rk + small)*chain%place(n))
         end if
         self%places = [0.0_rk, chain%place(:n), depths(far)]
         self%values = [at_face, inner(:n - 1, layer), unknowns(1, (layers%at(2, layer) + 2)/3), &
                        at_nodes(far)]
      end associate
      call set_slopes(self)
   end subroutine set_values

   !> Depth of a point in the profile; beyond its height where it does not lie before the face [m].
   pure real(rk) function depth(self, xy)
      class(profile_t), intent(in) :: self
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk) :: along

      depth = huge(1.0_rk)
      along = dot_product(xy - self%start, self%ahead)
      if (dot_product(xy - self%start, self%normal) < 0.0_rk) return
      if (along < -self%length .or. (along > 0.0_rk .and. .not. self%at_tip)) return
      depth = distance(self, xy)
   end function depth

   !> Distance of a point from the face, or from its tip, if it lies ahead of that [m].
   pure real(rk) function distance(self, xy)
      type(profile_t), intent(in) :: self
      real(rk), intent(in) :: xy(2)  !< [m]

      distance = dot_product(xy - self%start, self%normal)
      if (.not. self%at_tip) return
      if (dot_product(xy - self%start, self%ahead) > 0.0_rk) distance = norm2(xy - self%start)
   end function distance

   !> Depth in the profile of the face at a tip [m].
   pure real(rk) function round_tip(self, xy)
      type(profile_t), intent(in) :: self
      real(rk), intent(in) :: xy(2)  !< [m]

      associate (from_tip => xy - self%start)
         round_tip = sqrt(0.5_rk*self%length*max(0.0_rk, norm2(from_tip) &
                                                 + dot_product(from_tip, self%ahead)))
      end associate
   end function round_tip

   !> Pressure at a point: between nodes by cubics without overshoot, exponentially between the last
   !! two.
   pure real(rk) function pressure_at(self, xy, depth) result(found)
      class(profile_t), intent(in) :: self
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(in) :: depth  !< of the point [m]
      integer(ik) :: k, m
      real(rk) :: at, t

      associate (place => self%places, value => self%values, slope => self%slopes)
         m = size(place, kind=ik)
         at = depth
         if (self%at_tip) at = round_tip(self, xy)
         at = min(at, place(m))
         k = max(1_ik, min(count(place <= at, kind=ik), m - 1))
         associate (h => place(k + 1) - place(k))
            t = (at - place(k))/h
            if (k == m - 1) then
               if (abs(self%rate) > sqrt(epsilon(1.0_rk))) then
                  t = (1.0_rk - exp(-self%rate*t))/(1.0_rk - exp(-self%rate))
               end if
               found = (1.0_rk - t)*value(k) + t*value(k + 1)
            else
               associate (secant => (value(k + 1) - value(k))/h)
                  found = value(k) + h*t*(secant + (1.0_rk - t)*((1.0_rk - t)*(slope(k) - secant) &
                                                                 - t*(slope(k + 1) - secant)))
               end associate
            end if
         end associate
      end associate
   end function pressure_at

   !> Slopes at the nodes but the last one: harmonic means of those of the secants.
   pure subroutine set_slopes(self)
      type(profile_t), intent(inout) :: self
      real(rk) :: secant(size(self%places) - 1)
      integer(ik) :: i, m

      m = size(self%places, kind=ik)
      secant = (self%values(2:) - self%values(:m - 1))/(self%places(2:) - self%places(:m - 1))
      self%slopes = [secant(1), secant(:m - 2)]  ! at m - 1: the last secant is long
      do i = 2, m - 2
         self%slopes(i) = 0.0_rk
         if (secant(i - 1)*secant(i) <= 0.0_rk) cycle
         associate (before => self%places(i) - self%places(i - 1), &
                    after => self%places(i + 1) - self%places(i))
            self%slopes(i) = 3.0_rk*(before + after)/((before + 2.0_rk*after)/secant(i - 1) &
                                                      + (2.0_rk*before + after)/secant(i))
         end associate
      end do
      self%rate = 0.0_rk
      if (abs(secant(m - 1)) > 0.0_rk) self%rate = decay_rate(self%slopes(m - 1)/secant(m - 1))
   end subroutine set_slopes

   !> The rate u at which (1 - exp(-u t))/(1 - exp(-u)) has a slope at t = 0, u/(1 - exp(-u)).
   pure real(rk) function decay_rate(slope) result(u)
      real(rk), intent(in) :: slope  !< below a hundredth as a hundredth [-]
      real(rk), parameter :: least = 0.01_rk, most = 100.0_rk
      integer, parameter :: halvings = 50
      real(rk) :: high, low, start
      integer :: i

      low = -most
      high = most
      do i = 1, halvings
         u = 0.5_rk*(low + high)
         start = 1.0_rk + 0.5_rk*u  ! near u = 0
         if (abs(u) > 1.0e-6_rk) start = u/(1.0_rk - exp(-u))
         if (start < max(least, min(most, slope))) then
            low = u
         else
            high = u
         end if
      end do
   end function decay_rate

   !> Those of a state without layers.
   pure type(profiles_t) function no_profiles() result(none)
      allocate (none%cell(0), none%face_of_cell(0), none%fracture_cell(0), none%side(0))
      allocate (none%excess(0))
   end function no_profiles

   !> The pressures in the layers of a state.
   pure function profiles_of(layers, unknowns, inner) result(found)
      type(layers_t), intent(in) :: layers
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      type(profiles_t) :: found
      integer(ik) :: k, l

      found%cell = layers%cell
      found%face_of_cell = layers%face_of_cell
      found%fracture_cell = layers%fracture_cell
      found%side = layers%side
      found%n = layers%chain%n
      allocate (found%place(layers%n_nodes, layers%n), found%value(layers%n_nodes + 1, layers%n), &
                source=0.0_rk)
      do k = 1, size(layers%cells, kind=ik)
         associate (first => (layers%at(2, layers%of_cell%at(k, 1_ik)) + 2)/3)
            do l = layers%of_cell%first(k), layers%of_cell%last(k)
               call take(layers%of_cell%item(l), unknowns(3, first))
            end do
         end associate
      end do

   contains

      pure subroutine take(l, rest)
         integer(ik), intent(in) :: l
         real(rk), intent(in) :: rest  !< pressure of the rest of the cell [Pa]

         associate (n => layers%chain(l)%n)
            found%place(:n, l) = layers%chain(l)%place
            found%value(:n - 1, l) = inner(:n - 1, l)
            found%value(n, l) = unknowns(1, (layers%at(2, l) + 2)/3)
            found%value(n + 1, l) = rest
         end associate
      end subroutine take

   end function profiles_of

   !> Take the excess of the layers at faces that are kept on another mesh out of their cells, which
   !! keep the pressure of their rest: it is not transferred by areas.
   pure subroutine set_apart(layers, cell_old, faces, unknowns, content, found)
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: cell_old(:)  !< (new cells) the same cell before; 0: none
      type(kept_faces_t), intent(in) :: faces
      real(rk), intent(inout) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(inout) :: content(:)  !< (n_cells) [m2]
      type(profiles_t), intent(inout) :: found  !< of `profiles_of`
      real(rk) :: excess
      integer(ik) :: i, k, l
      logical :: is_kept

      allocate (found%excess(layers%n), source=0.0_rk)
      do k = 1, size(layers%cells, kind=ik)
         do i = 1, layers%of_cell%length(k)
            l = layers%of_cell%at(k, i)
            if (layers%fracture_cell(l) > 0) then
               is_kept = any(faces%before%item == layers%fracture_cell(l))
            else
               is_kept = any(cell_old == layers%cell(l))
            end if
            if (.not. is_kept) cycle
            associate (chain => layers%chain(l), n => layers%chain(l)%n, cell => layers%cell(l))
               excess = dot_product(chain%volume, found%value(:n, l) - found%value(n + 1, l))
               found%excess(l) = layers%storage(k)*excess
               content(cell) = content(cell) - found%excess(l)
               unknowns(3, cell) = unknowns(3, cell) - excess/layers%volume(k)
            end associate
         end do
      end do
   end subroutine set_apart

   !> Give the layers of a new mesh those before at the same faces: the same pressures beyond that
   !! of the rest of the cell at the same distances from the face, their means where a face consists
   !! of parts of two. Other layers have the pressure of their cell.
   pure subroutine take_profiles(layers, before, cell_old, faces, unknowns, inner)
      type(layers_t), intent(in) :: layers
      type(profiles_t), intent(in) :: before  !< set apart
      integer(ik), intent(in) :: cell_old(:)  !< (n_cells) the same cell before; 0: none
      type(kept_faces_t), intent(in) :: faces
      real(rk), intent(inout) :: unknowns(:, :)  !< (3, n_blocks); those of the layers are set
      real(rk), allocatable, intent(out) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      real(rk) :: value(layers%n_nodes)
      real(rk) :: excess, rest
      integer(ik) :: i, k, l

      call layers%begin(unknowns, inner)
      do k = 1, size(layers%cells, kind=ik)
         excess = 0.0_rk
         rest = unknowns(3, layers%cells(k))
         do i = 1, layers%of_cell%length(k)
            l = layers%of_cell%at(k, i)
            associate (chain => layers%chain(l), n => layers%chain(l)%n)
               call find_values(l, value(:n))
               excess = excess + dot_product(chain%volume, value(:n))
               inner(:n - 1, l) = rest + value(:n - 1)
               unknowns(1, (layers%at(2, l) + 2)/3) = rest + value(n)
            end associate
         end do
         unknowns(3, layers%cells(k)) = rest + excess/layers%volume(k)
      end do

   contains

      !> Pressures of a layer beyond that of the rest of its cell.
      pure subroutine find_values(l, values)
         integer(ik), intent(in) :: l
         real(rk), intent(out) :: values(:)  !< [Pa]
         integer(ik) :: old, part

         values = 0.0_rk
         associate (c => layers%fracture_cell(l), place => layers%chain(l)%place)
            if (c == 0) then
               if (cell_old(layers%cell(l)) == 0) return
               old = findloc(before%cell == cell_old(layers%cell(l)) .and. &
                             before%face_of_cell == layers%face_of_cell(l), .true., dim=1)
               call add_values(before, old, 1.0_rk, place, values)
               return
            end if
            do part = faces%before%first(c), faces%before%last(c)
               old = layer_before(before, faces%before%item(part), layers%side(l))
               call add_values(before, old, faces%of_new(part), place, values)
            end do
         end associate
      end subroutine find_values

   end subroutine take_profiles

   !> Add a share of the pressures of a layer before, beyond that of the rest of its cell.
   pure subroutine add_values(before, old, share, place, values)
      type(profiles_t), intent(in) :: before
      integer(ik), intent(in) :: old  !< layer; 0: none
      real(rk), intent(in) :: share  !< of the face [-]
      real(rk), intent(in) :: place(:)  !< [m]
      real(rk), intent(inout) :: values(:)  !< there [Pa]

      if (old == 0) return
      associate (m => before%n(old))
         values = values + share*interpolated(before%place(:m, old), before%value(:m + 1, old) &
                                              - before%value(m + 1, old), place)
      end associate
   end subroutine add_values

   !> Number of the layer on a side of a fracture cell; 0: none.
   pure integer(ik) function layer_before(before, fracture_cell, side)
      type(profiles_t), intent(in) :: before
      integer(ik), intent(in) :: fracture_cell, side

      layer_before = findloc(before%fracture_cell == fracture_cell .and. before%side == side, &
                             .true., dim=1, kind=ik)
   end function layer_before

   !> Return the excess that has been set apart to the cells at the same faces, whether these have
   !! layers or not.
   pure subroutine return_excess(before, mesh, cell_old, faces, content)
      type(profiles_t), intent(in) :: before
      type(mesh_t), intent(in) :: mesh  !< new
      integer(ik), intent(in) :: cell_old(:)  !< (n_cells) the same cell before; 0: none
      type(kept_faces_t), intent(in) :: faces
      real(rk), intent(inout) :: content(:)  !< (n_cells) [m2]
      integer(ik) :: at, c, old, part, side

      do c = 1, mesh%fracture%n_cells
         do side = 1, 2
            associate (cell => mesh%face_cells(1, mesh%fracture%cell_faces(side, c)))
               do part = faces%before%first(c), faces%before%last(c)
                  old = layer_before(before, faces%before%item(part), side)
                  if (old == 0) cycle
                  content(cell) = content(cell) + faces%of_old(part)*before%excess(old)
               end do
            end associate
         end do
      end do
      do old = 1, size(before%cell, kind=ik)
         if (before%fracture_cell(old) > 0) cycle
         at = findloc(cell_old, before%cell(old), dim=1, kind=ik)
         if (at > 0) content(at) = content(at) + before%excess(old)
      end do
   end subroutine return_excess

   !> Linear interpolation between nodes; the first value holds up to the first node, the last one,
   !! of the rest of the cell, beyond the last node.
   pure function interpolated(place, value, at) result(found)
      real(rk), intent(in) :: place(:)  !< (n) [m]
      real(rk), intent(in) :: value(:)  !< (n + 1) [Pa]
      real(rk), intent(in) :: at(:)  !< [m]
      real(rk) :: found(size(at))  !< [Pa]
      real(rk), parameter :: same = 1.0e-12_rk  ! relative
      integer(ik) :: i, k
      real(rk) :: t

      do i = 1, size(at, kind=ik)
         k = count(place <= at(i)*(1.0_rk + same))
         if (k == 0) then
            found(i) = value(1)
         else if (k == size(place)) then
            found(i) = value(k)
            if (at(i) > place(k)*(1.0_rk + same)) found(i) = value(k + 1)
         else
            t = max(0.0_rk, at(i) - place(k))/(place(k + 1) - place(k))
            found(i) = (1.0_rk - t)*value(k) + t*value(k + 1)
         end if
      end do
   end function interpolated

end module coarse_layer_profiles
