!> Heat on the mesh after an increment of growth from that on the mesh before: the same heat, and no
!! temperature outside the range of those before.
!!
!! The rise above the initial temperature is transferred. A cell takes capacity and heat of the old
!! cells that it overlaps, by areas, as if each had the temperature of its rest (without layers),
!! which the slope between its neighbours continues to the place of the new cell, within their
!! range. A face that is kept, or consists of parts of old ones, keeps the temperatures at the
!! same distances from it. What the layers of the old faces contain beyond the rest of their cell
!! belongs to the cells behind the new faces: their temperatures are moved towards the highest or
!! lowest before, by one share for all parts of a cell, until their heat is that. What remains is
!! shared by all new cells.
module heat_transfer
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: round_off, same_place
   use coarse_layer_profiles, only: kept_faces_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   use mesh_geometry, only: face_length
   use mesh_types, only: mesh_map_t, mesh_t
   implicit none(type, external)
   private

   public :: transfer_heat

   !> A face of the new mesh, and one with a layer before that it overlaps.
   type :: piece_t
      integer(ik) :: face = 0, layer = 0  !< new, old
      real(rk) :: of_old = 0.0_rk, of_new = 0.0_rk  !< overlap over the length of each [-]
   end type piece_t

   integer, parameter :: rise = 1, rate = 2  !< of what is transferred

contains

   !> Transfer the heat of a state from an old mesh to a new one.
   subroutine transfer_heat(old, new, map, faces, filled, state)
      class(heat_model_t), intent(in) :: old, new
      type(mesh_map_t), intent(in) :: map
      type(kept_faces_t), intent(in) :: faces  !< of fracture cells
      real(rk), intent(in) :: filled(:)  !< (fracture cells) fluid that a new one begins with [m2]
      type(heat_state_t), intent(inout) :: state
      type(piece_t), allocatable :: pieces(:)
      real(rk), allocatable :: before(:, :), after(:, :)  ! (2, unknowns) rise [K] and rate [K/s]
      real(rk), allocatable :: capacity(:)  ! (unknowns) [J/(m K)]
      real(rk) :: bounds(2), heat, supplied

      allocate (before(2, old%n), after(2, new%n), capacity(new%n))
      before = 0.0_rk
      before(rise, :) = state%temperature - old%initial
      if (allocated(state%rate)) before(rate, :) = state%rate
      heat = sum(state%capacity*state%temperature)
      pieces = pieces_of(old%mesh, new%mesh, map, faces)
      call transfer_cells(old, new, map, before, state%capacity, after, capacity)
      call transfer_layers(old, new, map, pieces, before, state%capacity, after, capacity)
      call transfer_fractures(old, new, faces, filled, before, state%capacity, after, capacity)
      bounds = [min(state%range(1), minval(state%temperature)), &
                max(state%range(2), maxval(state%temperature))]
      state%temperature = max(bounds(1), min(bounds(2), new%initial + after(rise, :)))
      ! Fluid that new cells begin with comes from outside.
      associate (of_fractures => state%temperature(new%first_cell:new%first_joint - 1))
         supplied = new%fluid_capacity*sum(filled*of_fractures)
      end associate
      call close_balance(new, map%cell_old == 0, heat + supplied, capacity, bounds, &
                         state%temperature)
      call close_balance(new, map%cell_old >= 0, heat + supplied, capacity, bounds, &
                         state%temperature)
      state%stored = state%stored + (sum(capacity*state%temperature) - heat)
      state%by_sides = state%by_sides + supplied
      state%capacity = capacity
      if (allocated(state%rate)) state%rate = after(rate, :)
      if (allocated(state%bend)) deallocate (state%bend)
      if (allocated(state%acting)) deallocate (state%acting)  ! found again for the next step
   end subroutine transfer_heat

   !> Faces with layers before, and the new ones that overlap them.
   function pieces_of(old, new, map, faces) result(pieces)
      type(mesh_t), intent(in) :: old, new
      type(mesh_map_t), intent(in) :: map
      type(kept_faces_t), intent(in) :: faces
      type(piece_t), allocatable :: pieces(:)
      real(rk) :: overlap
      integer(ik) :: c, f, k, l, side

      allocate (pieces(0))
      if (old%n_layers == 0) return
      do c = 1, new%fracture%n_cells
         do side = 1, 2
            f = new%fracture%cell_faces(side, c)
            do k = faces%before%first(c), faces%before%last(c)
               l = old%face_layer(old%fracture%cell_faces(side, faces%before%item(k)))
               if (l > 0) pieces = [pieces, piece_t(f, l, faces%of_old(k), faces%of_new(k))]
            end do
         end do
      end do
      do l = 1, old%n_layers
         associate (face => old%layer_face(l))
            if (old%face_side(face) == 0) cycle
            do f = 1, new%n_faces
               if (new%face_side(f) /= old%face_side(face)) cycle
               if (map%cell_old(new%face_cells(1, f)) > 0) then
                  if (map%cell_old(new%face_cells(1, f)) /= old%face_cells(1, face)) cycle
               end if
               overlap = common_length(old%xy(:, old%face_nodes(:, face)), &
                                       new%xy(:, new%face_nodes(:, f)))
               if (overlap > same_place*face_length(old, face)) then
                  pieces = [pieces, piece_t(f, l, overlap/face_length(old, face), &
                                            overlap/face_length(new, f))]
               end if
            end do
         end associate
      end do
   end function pieces_of

   !> Length of what two segments on one line have in common; 0: they are on different ones [m].
   pure real(rk) function common_length(first, second) result(length)
      real(rk), intent(in) :: first(2, 2), second(2, 2)  !< ends in columns [m]
      real(rk) :: along(2), at(2), offset(2, 2)

      length = norm2(first(:, 2) - first(:, 1))
      along = (first(:, 2) - first(:, 1))/length
      offset = second - spread(first(:, 1), 2, 2)
      at = matmul(along, offset)
      if (any(abs(along(1)*offset(2, :) - along(2)*offset(1, :)) > same_place*length)) at = 0.0_rk
      length = max(0.0_rk, min(length, maxval(at)) - max(0.0_rk, minval(at)))
   end function common_length

   !> Capacity and temperatures of the cells with their layers, without the profiles of these.
   pure subroutine transfer_cells(old, new, map, before, capacity_before, after, capacity)
      class(heat_model_t), intent(in) :: old, new
      type(mesh_map_t), intent(in) :: map
      real(rk), intent(in) :: before(:, :), capacity_before(:)
      real(rk), intent(out) :: after(:, :), capacity(:)
      real(rk) :: covered(old%mesh%n_cells), share, whole(old%mesh%n_cells)
      real(rk), allocatable :: of_rock(:)
      integer(ik) :: c, from, k, l

      after = 0.0_rk
      capacity = 0.0_rk
      whole = old%of_cells(capacity_before)
      covered = 0.0_rk
      do k = 1, size(map%overlap_cell, kind=ik)
         covered(map%overlap_cell(k)) = covered(map%overlap_cell(k)) + map%overlap_area(k)
      end do
      do c = 1, new%mesh%n_cells
         if (map%cell_old(c) > 0) then
            capacity(c) = whole(map%cell_old(c))
            after(:, c) = before(:, map%cell_old(c))
            cycle
         end if
         associate (first => map%overlap_first(c), last => map%overlap_first(c + 1) - 1)
            from = map%overlap_cell(first)
            ! Differences: what is uniform remains so.
            do k = first, last
               associate (other => map%overlap_cell(k))
                  share = whole(other)*map%overlap_area(k)/covered(other)
                  capacity(c) = capacity(c) + share
                  after(:, c) = after(:, c) + share*(before(:, other) - before(:, from) &
                                                     + beyond(old, before, other, new%place(:, c)))
               end associate
            end do
            after(:, c) = before(:, from) + after(:, c)/capacity(c)
         end associate
      end do
      ! Fluid that has entered a cell is shared by its parts as the rock is.
      of_rock = new%rock_capacity()
      capacity(:new%mesh%n_cells) = capacity(:new%mesh%n_cells)/new%of_cells(of_rock)
      do l = 1, new%layers%n
         c = new%layers%cell(l)
         associate (nodes => [(k, k=new%first_node(l), new%last_node(l))])
            capacity(nodes) = capacity(c)*of_rock(nodes)
            do k = 1, size(nodes, kind=ik)
               after(:, nodes(k)) = after(:, c) + beyond(new, after, c, new%place(:, nodes(k)))
            end do
         end associate
      end do
      capacity(:new%mesh%n_cells) = capacity(:new%mesh%n_cells)*of_rock(:new%mesh%n_cells)
   end subroutine transfer_cells

   !> What the linear field through a cell and its neighbours has at a place beyond the cell's
   !! value, as far as this stays within their range.
   pure function beyond(heat, values, cell, place) result(rise_there)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: values(:, :)  !< (2, unknowns)
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: place(2)  !< [m]
      real(rk) :: rise_there(2)
      real(rk) :: apart(2), more(2, 3), normal(2, 2), right(2, 2)
      integer(ik) :: k, next

      normal = 0.0_rk
      right = 0.0_rk
      more = 0.0_rk
      do k = 1, 3
         associate (face => heat%mesh%cell_faces(k, cell))
            next = sum(heat%mesh%face_cells(:, face)) - cell
            if (next == 0) cycle
            apart = heat%place(:, next) - heat%place(:, cell)
            more(:, k) = values(:, next) - values(:, cell)
            associate (weight => 1.0_rk/dot_product(apart, apart))
               normal = normal + weight*spread(apart, 2, 2)*spread(apart, 1, 2)
               right = right + weight*spread(more(:, k), 2, 2)*spread(apart, 1, 2)
            end associate
         end associate
      end do
      rise_there = 0.0_rk
      associate (determinant => normal(1, 1)*normal(2, 2) - normal(1, 2)**2)
         if (.not. determinant > round_off*(normal(1, 1) + normal(2, 2))**2) return
         apart = place - heat%place(:, cell)
         apart = [normal(2, 2)*apart(1) - normal(1, 2)*apart(2), &
                  normal(1, 1)*apart(2) - normal(1, 2)*apart(1)]/determinant
      end associate
      rise_there = max(min(0.0_rk, minval(more, dim=2)), &
                       min(max(0.0_rk, maxval(more, dim=2)), matmul(right, apart)))
   end function beyond

   !> Temperatures of layers, and of cells such that these have the heat of the layers before.
   pure subroutine transfer_layers(old, new, map, pieces, before, capacity_before, after, capacity)
      class(heat_model_t), intent(in) :: old, new
      type(mesh_map_t), intent(in) :: map
      type(piece_t), intent(in) :: pieces(:)
      real(rk), intent(in) :: before(:, :), capacity_before(:), capacity(:)
      real(rk), intent(inout) :: after(:, :)
      real(rk), dimension(new%mesh%n_cells) :: bound, high, low, missing, space
      real(rk) :: rest(2, size(after, 2))  ! without profiles
      integer(ik) :: c, k, l, p

      rest = after
      missing = 0.0_rk
      low = after(rise, :new%mesh%n_cells)
      high = low
      do c = 1, new%mesh%n_cells
         if (map%cell_old(c) > 0) cycle
         associate (cells => map%overlap_cell(map%overlap_first(c):map%overlap_first(c + 1) - 1))
            low(c) = min(low(c), minval(before(rise, cells)))
            high(c) = max(high(c), maxval(before(rise, cells)))
         end associate
      end do
      do p = 1, size(pieces, kind=ik)
         associate (piece => pieces(p), there => old%layers%cell(pieces(p)%layer))
            c = new%mesh%face_cells(1, piece%face)
            l = 0
            if (new%mesh%n_layers > 0) l = new%mesh%face_layer(piece%face)
            if (l > 0) call take_profile(old, new, piece, l, before, rest, after)
            do k = old%first_node(piece%layer), old%last_node(piece%layer)
               low(c) = min(low(c), before(rise, k))
               high(c) = max(high(c), before(rise, k))
               missing(c) = missing(c) + piece%of_old*capacity_before(k) &
                            *(before(rise, k) - before(rise, there))
            end do
         end associate
      end do
      do l = 1, new%layers%n
         c = new%layers%cell(l)
         do k = new%first_node(l), new%last_node(l)
            missing(c) = missing(c) - capacity(k)*(after(rise, k) - after(rise, c))
         end do
      end do
      bound = merge(high, low, missing > 0.0_rk)
      associate (n => new%mesh%n_cells)
         space = capacity(:n)*(bound - after(rise, :n))
         do l = 1, new%layers%n
            c = new%layers%cell(l)
            do k = new%first_node(l), new%last_node(l)
               space(c) = space(c) + capacity(k)*(bound(c) - after(rise, k))
            end do
         end do
         where (abs(space) > 0.0_rk) missing = max(0.0_rk, min(1.0_rk, missing/space))
         where (.not. abs(space) > 0.0_rk) missing = 0.0_rk
         do l = 1, new%layers%n
            c = new%layers%cell(l)
            do k = new%first_node(l), new%last_node(l)
               after(rise, k) = after(rise, k) + missing(c)*(bound(c) - after(rise, k))
            end do
         end do
         after(rise, :n) = after(rise, :n) + missing*(bound - after(rise, :n))
      end associate
   end subroutine transfer_layers

   !> Add the share of a piece in the temperatures of a layer, whose nodes have those of `rest`:
   !! the mean over the thickness of each volume, within the layer before.
   pure subroutine take_profile(old, new, piece, layer, before, rest, after)
      class(heat_model_t), intent(in) :: old, new
      type(piece_t), intent(in) :: piece
      integer(ik), intent(in) :: layer  !< of the new face
      real(rk), intent(in) :: before(:, :), rest(:, :)
      real(rk), intent(inout) :: after(:, :)
      real(rk) :: here(2), there(2)  ! distances of the ends of a volume from the face [m]
      integer(ik) :: i, k

      associate (to => new%layers%chain(layer), from => old%layers%chain(piece%layer), &
                 new_length => face_length(new%mesh, piece%face), &
                 old_length => face_length(old%mesh, old%mesh%layer_face(piece%layer)))
         here = 0.0_rk
         do i = 1, to%n
            here = [here(2), here(2) + to%volume(i)/new_length]
            there = 0.0_rk
            do k = 1, from%n
               there = [there(2), there(2) + from%volume(k)/old_length]
               associate (common => min(here(2), there(2)) - max(here(1), there(1)), &
                          node => new%first_node(layer) - 1 + i)
                  if (.not. common > 0.0_rk) cycle
                  after(:, node) = after(:, node) + piece%of_new*common/(here(2) - here(1)) &
                                   *(before(:, old%first_node(piece%layer) - 1 + k) - rest(:, node))
               end associate
            end do
         end do
      end associate
   end subroutine take_profile

   !> Fracture cells, as their parts before; new ones have that of the rock on both sides.
   pure subroutine transfer_fractures(old, new, faces, filled, before, capacity_before, after, &
                                      capacity)
      class(heat_model_t), intent(in) :: old, new
      type(kept_faces_t), intent(in) :: faces
      real(rk), intent(in) :: filled(:), before(:, :), capacity_before(:)
      real(rk), intent(inout) :: after(:, :), capacity(:)
      real(rk) :: covered(old%mesh%fracture%n_cells), share, total(2)
      integer(ik) :: c, from, i, j, k

      covered = 0.0_rk
      do k = 1, size(faces%before%item, kind=ik)
         associate (cell => faces%before%item(k))
            covered(cell) = covered(cell) + faces%of_old(k)
         end associate
      end do
      do i = 1, new%mesh%fracture%n_cells
         c = new%first_cell - 1 + i
         associate (sides => new%mesh%fracture%cell_faces(:, i))
            after(:, c) = 0.5_rk*(at_face(new, after, sides(1)) + at_face(new, after, sides(2)))
         end associate
         capacity(c) = new%fluid_capacity*filled(i)
         if (faces%before%length(i) == 0) cycle
         total = 0.0_rk
         from = old%first_cell - 1 + faces%before%at(i, 1_ik)
         do k = faces%before%first(i), faces%before%last(i)
            associate (cell => faces%before%item(k))
               j = old%first_cell - 1 + cell
               share = capacity_before(j)*faces%of_old(k)/covered(cell)
               capacity(c) = capacity(c) + share
               total = total + share*(before(:, j) - before(:, from))
            end associate
         end do
         after(:, c) = before(:, from)
         if (capacity(c) > 0.0_rk) after(:, c) = after(:, c) + total/capacity(c)
      end do
      do j = new%first_joint, new%n
         call transfer_joint(old, new, j, before, capacity_before, after, capacity)
      end do
   end subroutine transfer_fractures

   !> Temperature of the rock on a face of a fracture.
   pure function at_face(heat, values, face) result(there)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: values(:, :)  !< (2, unknowns)
      integer(ik), intent(in) :: face
      real(rk) :: there(2)

      if (heat%mesh%n_layers > 0) then
         if (heat%mesh%face_layer(face) > 0) then
            there = values(:, heat%first_node(heat%mesh%face_layer(face)))
            return
         end if
      end if
      there = values(:, heat%mesh%face_cells(1, face))
   end function at_face

   !> A joint: as before, or with next to nothing of the cells that meet there.
   pure subroutine transfer_joint(old, new, joint, before, capacity_before, after, capacity)
      class(heat_model_t), intent(in) :: old, new
      integer(ik), intent(in) :: joint  !< unknown
      real(rk), intent(in) :: before(:, :), capacity_before(:)
      real(rk), intent(inout) :: after(:, :), capacity(:)
      real(rk), parameter :: nothing = 1.0e-6_rk  ! [-]
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, k

      do i = old%first_joint, old%n
         if (norm2(new%place(:, joint) - old%place(:, i)) > 0.0_rk) cycle
         after(:, joint) = before(:, i)
         capacity(joint) = capacity_before(i)
         return
      end do
      cells = pack([(new%links(k)%ends(1), k=1, size(new%links, kind=ik))], &
                   new%links%ends(2) == joint)
      associate (total => sum(capacity(cells)))
         after(:, joint) = sum(after(:, cells), dim=2)/size(cells)
         ! Between new cells, which have no fluid yet.
         capacity(joint) = nothing**2*maxval(capacity(new%first_cell:new%first_joint - 1))
         if (.not. total > 0.0_rk) return
         after(:, joint) = matmul(after(:, cells), capacity(cells))/total
         capacity(joint) = nothing*total
         capacity(cells) = (1.0_rk - nothing)*capacity(cells)
      end associate
   end subroutine transfer_joint

   !> Give some cells the heat that is missing, or take from them what is too much, as far as
   !! temperatures stay within bounds.
   pure subroutine close_balance(new, takes, heat, capacity, bounds, temperature)
      class(heat_model_t), intent(in) :: new
      logical, intent(in) :: takes(:)  !< (cells)
      real(rk), intent(in) :: heat  !< of the body [J/m]
      real(rk), intent(in) :: capacity(:)
      real(rk), intent(in) :: bounds(2)  !< [K]
      real(rk), intent(inout) :: temperature(:)
      real(rk) :: bound, missing, space(new%n)
      integer(ik) :: l

      missing = heat - sum(capacity*temperature)
      bound = bounds(merge(2, 1, missing > 0.0_rk))
      space = 0.0_rk
      associate (n => new%mesh%n_cells)
         where (takes) space(:n) = capacity(:n)*(bound - temperature(:n))
      end associate
      do l = 1, new%layers%n
         if (.not. takes(new%layers%cell(l))) cycle
         associate (nodes => [new%first_node(l), new%last_node(l)])
            space(nodes(1):nodes(2)) = capacity(nodes(1):nodes(2)) &
                                       *(bound - temperature(nodes(1):nodes(2)))
         end associate
      end do
      if (.not. abs(sum(space)) > 0.0_rk) return
      where (abs(space) > 0.0_rk)
         temperature = temperature + min(1.0_rk, missing/sum(space))*(bound - temperature)
      end where
   end subroutine close_balance

end module heat_transfer
