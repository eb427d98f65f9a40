!> The pressure of a well in the rock: its cell has one pressure, the rock around the well has not.
!!
!! Two chains of rings around the well, in a body without end, take in the flow of the well. In the
!! first the rings begin at its wall, r_w, and grow with the distance from it. In the second the
!! cell is one volume, which has its pressure at r_c = 0.151 times the root of its area (Peaceman's
!! idea), and rings lie outside. The second answers like the cell of the mesh, so that the pressure
!! of the well is that of the cell plus the difference of the innermost pressures: also while the
!! flow has not left the cell, and in the steady state, where the difference is q mu/(2 pi K)
!! ln(r_c/r_w). The difference does not depend on what lies farther away.
!!
!! Where other rock is near, annuli have means: in the first chain of the rock, in the second of the
!! cells of the mesh.
!!
!! Around a line that fluid leaves, the displacement is free of rotation: the content of the rock is
!! S* p, S* = S + alpha^2/(lambda + 2 G) (Rudnicki 1986). Both chains take several implicit steps in
!! each step, so that their errors in time are small, and far from the well the same. The rock takes
!! one: the second chain with one step, compared with itself at four radii of the cell, shows the
!! error of that in the pressure of the cell, which is corrected too.
module coarse_well_rings
   use base_kinds, only: ik, pi, rk
   implicit none(type, external)
   private

   public :: annuli_t, new_well_rings, ring_count, rock_differs_to, well_rings_t

   integer(ik), parameter :: n_near = 56, n_cell = 26  !< nodes of the two chains
   integer(ik), parameter :: ring_count = n_near + 2*n_cell
   integer, parameter :: parts = 8  !< implicit steps of the chains in each step
   integer(ik), parameter :: around = 6  !< node at four radii of the cell
   !> The last rings end at so many radii of the cell, where the pressure is that before.
   real(rk), parameter :: outermost = 1.0e4_rk
   !> Beyond so many of them the rock and the mesh have the same annuli.
   real(rk), parameter :: rock_differs_to = 4.0_rk
   !> Error over the resistance around the cell that the mesh does not have [-].
   real(rk), parameter :: share_of_missing = 0.5_rk
   real(rk), parameter :: first_ring = 1.0e-3_rk  !< thickness over the radius of the well [-]
   !> Radius at which the pressure is that of a triangle, over the root of its area: the mean of 40
   !! places in five meshes, all within 0.002 (verification/wells_in_rock) [-].
   real(rk), parameter :: radius_of_cell = 0.151_rk

   !> Rock around a well, uniform in each of some annuli.
   type :: annuli_t
      real(rk), allocatable :: edge(:)  !< (n - 1) radii between them, increasing [m]
      real(rk), allocatable :: mobility(:)  !< (n) K/mu [m2/(Pa s)]
      real(rk), allocatable :: storage(:)  !< (n) S* [1/Pa]
   contains
      procedure :: loss
      procedure :: content
   end type annuli_t

   !> Rings, from the well outwards.
   type :: rings_t
      real(rk) :: inlet = 0.0_rk  !< between the well and the first node [Pa s/m2]
      real(rk), allocatable :: held(:)  !< content per pressure [m2/Pa]
      real(rk), allocatable :: conductance(:)  !< from each node outwards [m2/(Pa s)]
   end type rings_t

   type :: well_rings_t
      type(rings_t) :: near  !< with rings from the wall of the well on
      type(rings_t) :: cell  !< with the cell as the first volume
      real(rk) :: error = 0.0_rk  !< of the resistance from the well on, relative [-]
   contains
      procedure :: resistance
      procedure :: left_over
      procedure :: beyond_cell
      procedure :: take_in
   end type well_rings_t

contains

   !> Pressure lost per steady flow from one radius to a larger one [Pa s/m2].
   pure real(rk) function loss(self, from, to)
      class(annuli_t), intent(in) :: self
      real(rk), intent(in) :: from, to  !< [m]
      real(rk) :: ends(0:size(self%mobility))

      ends = min(to, max(from, [from, self%edge, to]))
      loss = sum(log(ends(1:)/ends(:size(self%mobility) - 1))/self%mobility)/(2.0_rk*pi)
   end function loss

   !> Content per pressure between two radii [m2/Pa].
   pure real(rk) function content(self, from, to)
      class(annuli_t), intent(in) :: self
      real(rk), intent(in) :: from, to  !< [m]
      real(rk) :: ends(0:size(self%storage))

      ends = min(to, max(from, [from, self%edge, to]))
      associate (inner => ends(:size(self%storage) - 1), outer => ends(1:))
         content = pi*sum(self%storage*(outer - inner)*(outer + inner))
      end associate
   end function content

   !> The rings of a well.
   pure function new_well_rings(radius, area, rock, meshed) result(rings)
      real(rk), intent(in) :: radius  !< of the well [m]
      real(rk), intent(in) :: area  !< of the cell [m2]
      type(annuli_t), intent(in) :: rock, meshed  !< around the well, and as the cells have it
      type(well_rings_t) :: rings
      real(rk) :: edge(0:n_near), end, node(n_near), ratio
      integer(ik) :: i

      associate (cell_radius => sqrt(area/pi))
         end = max(cell_radius, radius)*rock_differs_to
         rings%error = share_of_missing*abs(rock%loss(cell_radius, end) &
                                            - meshed%loss(cell_radius, end))/rock%loss(radius, end)
         end = outermost*max(cell_radius, radius)
         ratio = ((end - radius)/(first_ring*radius))**(1.0_rk/(n_near - 1))
         edge = [radius, (radius + first_ring*radius*ratio**(i - 1), i=1, n_near)]
         node(1) = radius + 0.5_rk*first_ring*radius
         node(2:) = radius + sqrt((edge(1:n_near - 1) - radius)*(edge(2:) - radius))
         rings%near = chain_of(rock, node, edge)
         rings%near%inlet = rock%loss(radius, node(1))
         ratio = (end/cell_radius)**(1.0_rk/(n_cell - 1))
         edge(:n_cell) = [0.0_rk, (cell_radius*ratio**(i - 1), i=1, n_cell)]
         node(1) = radius_of_cell*sqrt(area)
         node(2:n_cell) = sqrt(edge(1:n_cell - 1)*edge(2:n_cell))
         rings%cell = chain_of(meshed, node(:n_cell), edge(:n_cell))
      end associate
   end function new_well_rings

   !> A chain with these nodes and edges.
   pure function chain_of(rock, nodes, edges) result(chain)
      type(annuli_t), intent(in) :: rock
      real(rk), intent(in) :: nodes(:)  !< (n) [m]
      real(rk), intent(in) :: edges(0:)  !< (0:n) [m]
      type(rings_t) :: chain
      integer :: i, n

      n = size(nodes)
      chain%held = [(rock%content(edges(i - 1), edges(i)), i=1, n)]
      chain%conductance = [(1.0_rk/rock%loss(nodes(i), nodes(i + 1)), i=1, n - 1), &
                           1.0_rk/rock%loss(nodes(n), edges(n))]
   end function chain_of

   !> Pressures of the rings after a step with a flow out of the well.
   pure subroutine advance(self, m, dt, flow, pressure)
      type(rings_t), intent(in) :: self
      integer, intent(in) :: m  !< implicit steps
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk), intent(inout) :: pressure(:)  !< [Pa]
      real(rk) :: factor(size(pressure)), h, pivot(size(pressure))
      integer :: i, k, n

      n = size(pressure)
      h = dt/m
      pivot = self%held + h*self%conductance
      pivot(2:) = pivot(2:) + h*self%conductance(:n - 1)
      do i = 2, n
         factor(i) = h*self%conductance(i - 1)/pivot(i - 1)
         pivot(i) = pivot(i) - factor(i)*h*self%conductance(i - 1)
      end do
      do k = 1, m
         pressure = self%held*pressure
         pressure(1) = pressure(1) + h*flow
         do i = 2, n
            pressure(i) = pressure(i) + factor(i)*pressure(i - 1)
         end do
         pressure(n) = pressure(n)/pivot(n)
         do i = n - 1, 1, -1
            pressure(i) = (pressure(i) + h*self%conductance(i)*pressure(i + 1))/pivot(i)
         end do
      end do
   end subroutine advance

   !> Pressure of the well less that of the cell after a step, per flow in the step [Pa s/m2].
   pure real(rk) function resistance(self, dt)
      class(well_rings_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: p(ring_count)

      p = 0.0_rk
      call self%take_in(dt, 1.0_rk, p)
      resistance = self%beyond_cell(1.0_rk, p)
   end function resistance

   !> The same after a step without a flow, by the flow before [Pa].
   pure real(rk) function left_over(self, dt, pressure)
      class(well_rings_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: pressure(:)  !< (ring_count) before the step [Pa]
      real(rk) :: p(ring_count)

      p = pressure
      call self%take_in(dt, 0.0_rk, p)
      left_over = self%beyond_cell(0.0_rk, p)
   end function left_over

   !> Pressure of the well less that of the cell [Pa].
   pure real(rk) function beyond_cell(self, flow, pressure)
      class(well_rings_t), intent(in) :: self
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk), intent(in) :: pressure(:)  !< (ring_count) [Pa]

      associate (near => pressure(:n_near), cell => pressure(n_near + 1:n_near + n_cell), &
                 like_rock => pressure(n_near + n_cell + 1:))
         beyond_cell = self%near%inlet*flow + near(1) - cell(around) &
                       - (like_rock(1) - like_rock(around))
      end associate
   end function beyond_cell

   !> Pressures of all rings after a step with a flow.
   pure subroutine take_in(self, dt, flow, pressure)
      class(well_rings_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: flow  !< out of the well [m2/s]
      real(rk), intent(inout) :: pressure(:)  !< (ring_count) [Pa]

      call advance(self%near, parts, dt, flow, pressure(:n_near))
      call advance(self%cell, parts, dt, flow, pressure(n_near + 1:n_near + n_cell))
      call advance(self%cell, 1, dt, flow, pressure(n_near + n_cell + 1:))
   end subroutine take_in

end module coarse_well_rings
