!> Slopes of the temperature along faces with layers.
!!
!! The multi-point fluxes see a layer at both ends of its face, a sixth of the face from its middle
!! (the point of a linear temperature that the mean with the flux of one end gives). With one
!! temperature at both ends, heat would pass along the face through every layer, in addition to
!! conduction. So the temperature at its ends has the slope between the layers of the faces next to
!! it, the harmonic mean of both sides (van Leer 1974), or that of one side at the end of a path. It
!! moves no end farther than the layer is from the highest and the lowest temperature of all.
module heat_slopes
   use base_kinds, only: ik, rk
   use coarse_chain, only: chain_t
   use coarse_layers, only: layers_t
   use mesh_geometry, only: face_length
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: new_slopes, slopes_t

   type :: slopes_t
      integer(ik), allocatable :: next(:, :)  !< (2, layers) next to both ends of the face; 0: none
      real(rk), allocatable :: apart(:, :)  !< (2, layers) distance of their middles [m]
      real(rk), allocatable :: reach(:)  !< (layers) from the middle to where an end is seen [m]
      integer(ik) :: n = 0  !< entries of what follows
      ! Heat into unknown row for each kelvin that the second end of a layer is above its middle:
      integer(ik), allocatable :: row(:), layer(:)
      real(rk), allocatable :: conduction(:)  !< [W/(m K)]
   contains
      procedure :: add
      procedure :: ends
      procedure :: heat_flows
   end type slopes_t

contains

   !> The slopes of a mesh, without entries of conduction.
   pure function new_slopes(mesh, most) result(slopes)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: most  !< entries
      type(slopes_t) :: slopes
      integer(ik) :: at(mesh%n_nodes), e, l, node

      allocate (slopes%next(2, mesh%n_layers), source=0_ik)
      allocate (slopes%apart(2, mesh%n_layers), source=1.0_rk)
      allocate (slopes%reach(mesh%n_layers))
      allocate (slopes%row(most), slopes%layer(most), slopes%conduction(most))
      at = 0
      do l = 1, mesh%n_layers
         slopes%reach(l) = face_length(mesh, mesh%layer_face(l))/6.0_rk
         do e = 1, 2
            node = mesh%face_nodes(e, mesh%layer_face(l))
            if (at(node) == 0) then
               at(node) = l
            else
               call join(at(node), l)
            end if
         end do
      end do

   contains

      !> Let two faces at a node be neighbours, if they do not turn by more than 60 degrees.
      pure subroutine join(a, b)
         integer(ik), intent(in) :: a, b
         integer(ik) :: ends(2), i
         real(rk), parameter :: straight = -0.5_rk
         real(rk) :: along(2, 2)

         associate (faces => mesh%layer_face([a, b]))
            do i = 1, 2
               ends(i) = findloc(mesh%face_nodes(:, faces(i)), node, dim=1, kind=ik)
               along(:, i) = mesh%xy(:, mesh%face_nodes(3 - ends(i), faces(i))) - mesh%xy(:, node)
            end do
         end associate
         associate (length => norm2(along, dim=1))
            if (dot_product(along(:, 1), along(:, 2)) > straight*product(length)) return
            slopes%apart(ends(1), a) = 0.5_rk*sum(length)
            slopes%apart(ends(2), b) = 0.5_rk*sum(length)
         end associate
         slopes%next(ends(1), a) = b
         slopes%next(ends(2), b) = a
      end subroutine join

   end function new_slopes

   !> Add the heat into an unknown by a scalar that the multi-point fluxes see, if it is the end of
   !! a layer.
   pure subroutine add(self, mesh, scalar, row, conduction)
      class(slopes_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: scalar, row
      real(rk), intent(in) :: conduction  !< [W/(m K)]

      associate (layer => (scalar + 2)/3 - mesh%n_cells, end => modulo(scalar - 1, 3_ik) + 1)
         if (layer < 1 .or. layer > mesh%n_layers .or. end > 2) return
         self%n = self%n + 1
         self%row(self%n) = row
         self%layer(self%n) = layer
         self%conduction(self%n) = (2*end - 3)*conduction
      end associate
   end subroutine add

   !> What the second end of each layer has above its middle [K].
   pure function ends(self, layers, first_node, temperature) result(rise)
      class(slopes_t), intent(in) :: self
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: first_node(:)  !< (layers) unknown of the node next to the face
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk) :: rise(layers%n)
      real(rk) :: depth, highest, lowest, slope(2)
      integer(ik) :: e, l

      highest = maxval(temperature)
      lowest = minval(temperature)
      do l = 1, layers%n
         associate (own => layers%chain(l), next => self%next(:, l))
            rise(l) = 0.0_rk
            if (all(next == 0)) cycle
            do e = 1, 2
               if (next(e) == 0) cycle
               associate (other => layers%chain(next(e)))
                  depth = min(own%place(own%n), other%place(other%n))
                  slope(e) = (2*e - 3)*(at_depth(other, temperature(first_node(next(e)):), depth) &
                                        - at_depth(own, temperature(first_node(l):), depth)) &
                             /self%apart(e, l)
               end associate
            end do
            if (any(next == 0)) then
               rise(l) = slope(maxloc(next, dim=1))
            else if (product(slope) > 0.0_rk) then
               rise(l) = 2.0_rk*product(slope)/sum(slope)
            end if
            associate (here => temperature(first_node(l) + own%n - 1))
               rise(l) = sign(min(self%reach(l)*abs(rise(l)), here - lowest, highest - here), &
                              rise(l))
            end associate
         end associate
      end do
   end function ends

   !> Temperature of a chain at a distance from its face, at most that of its last node [K].
   pure real(rk) function at_depth(chain, temperature, depth)
      type(chain_t), intent(in) :: chain
      real(rk), intent(in) :: temperature(:)  !< from the first node on, at least [K]
      real(rk), intent(in) :: depth  !< [m]
      integer(ik) :: i
      real(rk) :: share

      i = chain%n - 1
      do while (i > 1 .and. chain%place(i) > depth)
         i = i - 1
      end do
      share = (depth - chain%place(i))/(chain%place(i + 1) - chain%place(i))
      at_depth = temperature(i) + share*(temperature(i + 1) - temperature(i))
   end function at_depth

   !> Heat into the unknowns by what the second ends have above the middles [W/m].
   pure function heat_flows(self, rise, n) result(into)
      class(slopes_t), intent(in) :: self
      real(rk), intent(in) :: rise(:)  !< (layers) [K]
      integer(ik), intent(in) :: n  !< unknowns
      real(rk) :: into(n)
      integer(ik) :: k

      into = 0.0_rk
      do k = 1, self%n
         associate (i => self%row(k))
            into(i) = into(i) + self%conduction(k)*rise(self%layer(k))
         end associate
      end do
   end function heat_flows

end module heat_slopes
