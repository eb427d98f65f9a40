!> What goes to the C++ mesh library: specifications and networks, indices from 0.
module mesh_c_inputs
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use mesh_c_binding, only: cm_network_t, cm_spec_t
   use mesh_types, only: network_t
   use, intrinsic :: iso_c_binding, only: c_loc
   implicit none(type, external)
   private

   public :: c_network_arrays_t, mesh_spec_t
   public :: prepare_network, prepare_spec

   !> What to mesh: a rectangle or a polygon with the fractures in it.
   type :: mesh_spec_t
      real(rk) :: x_min = 0.0_rk, x_max = 0.0_rk  !< [m]
      real(rk) :: y_min = 0.0_rk, y_max = 0.0_rk  !< [m]
      real(rk) :: size_fracture = 0.0_rk  !< cells at the fractures [m]
      real(rk) :: size_boundary = 0.0_rk  !< cells far from them [m]
      logical :: is_window = .false.  !< fractures may be cut by the edges
      integer(ik) :: rosette_sectors = 0  !< elements around each free tip; 0: no rosettes
      real(rk) :: rosette_radius = 0.0_rk  !< [m]; less where something is near
      !> (2, n) corners of a polygon, counter-clockwise [m]; not allocated: the rectangle
      real(rk), allocatable :: corners(:, :)
      !> (n) side number (1 or more) of the edge from each corner to the next one
      integer(ik), allocatable :: edge_side(:)
      !> (2, n) places that become nodes: on the boundary, inside, on fractures [m]
      real(rk), allocatable :: fixed_points(:, :)
      !> (2, n_fractures) rosette radius at start and end [m]; 0: rosette_radius
      real(rk), allocatable :: end_radius(:, :)
      integer(ik), allocatable :: guide_count(:)  !< points of each guide
      !> (2, n) lines that cells follow where there is room, one after the other [m]
      real(rk), allocatable :: guides(:, :)
      real(rk) :: joint_size = 0.0_rk  !< cells where fractures meet [m]; 0: size_fracture
      !> (2, n) places away from which cells grow along fractures, too [m]; they do not if absent
      real(rk), allocatable :: foci(:, :)
      real(rk) :: focus_slope = 0.0_rk  !< growth of sizes per distance from the nearest of them [-]
      real(rk) :: focus_size = 0.0_rk  !< largest size along fractures that this leads to [m]
      logical :: is_rough = .false.  !< faster triangles, which gmsh does not smooth
      real(rk) :: ring_slope = 0.0_rk  !< growth of sizes around rosettes [-]; 0: usual
   end type mesh_spec_t

   !> What a network of C points to; it must outlive the call and be a target.
   type :: c_network_arrays_t
      integer(ik), allocatable :: first(:)  !< (n+1) from 0
      real(rk), allocatable :: xy(:, :)  !< (2, n_vertices) [m]
      real(rk), allocatable :: s_start(:)  !< (n) [m]
   end type c_network_arrays_t

contains

   !> The specification as C sees it; the structure points to its arrays.
   subroutine prepare_spec(spec, n_fractures, c_spec, error)
      type(mesh_spec_t), intent(in), target :: spec
      integer(ik), intent(in) :: n_fractures
      type(cm_spec_t), intent(out) :: c_spec
      type(error_t), allocatable, intent(out) :: error

      c_spec%x_min = spec%x_min
      c_spec%x_max = spec%x_max
      c_spec%y_min = spec%y_min
      c_spec%y_max = spec%y_max
      c_spec%size_fracture = spec%size_fracture
      c_spec%size_boundary = spec%size_boundary
      c_spec%is_window = merge(1_ik, 0_ik, spec%is_window)
      c_spec%rosette_sectors = spec%rosette_sectors
      c_spec%rosette_radius = spec%rosette_radius
      c_spec%joint_size = spec%joint_size
      c_spec%ring_slope = spec%ring_slope
      c_spec%is_rough = merge(1_ik, 0_ik, spec%is_rough)
      if (allocated(spec%foci)) then
         c_spec%n_foci = ubound(spec%foci, 2)
         if (c_spec%n_foci > 0) c_spec%foci = c_loc(spec%foci)
         c_spec%focus_slope = spec%focus_slope
         c_spec%focus_size = spec%focus_size
      end if
      if (allocated(spec%corners)) then
         if (.not. allocated(spec%edge_side)) then
            call raise_error(error, "mesh_builder", "the edges of the polygon have no sides")
            return
         end if
         if (ubound(spec%corners, 1) /= 2 .or. &
             ubound(spec%corners, 2) /= ubound(spec%edge_side, 1)) then
            call raise_error(error, "mesh_builder", "corners and sides do not fit each other")
            return
         end if
         c_spec%n_corners = ubound(spec%corners, 2)
         c_spec%corners = c_loc(spec%corners)
         c_spec%edge_side = c_loc(spec%edge_side)
      end if
      if (allocated(spec%fixed_points)) then
         if (ubound(spec%fixed_points, 1) /= 2) then
            call raise_error(error, "mesh_builder", "a fixed point has an x and a y")
            return
         end if
         c_spec%n_fixed = ubound(spec%fixed_points, 2)
         if (c_spec%n_fixed > 0) c_spec%fixed = c_loc(spec%fixed_points)
      end if
      if (allocated(spec%end_radius)) then
         if (ubound(spec%end_radius, 1) /= 2 .or. ubound(spec%end_radius, 2) /= n_fractures) then
            call raise_error(error, "mesh_builder", "every fracture has two rosette radii")
            return
         end if
         if (n_fractures > 0) c_spec%end_radius = c_loc(spec%end_radius)
      end if
      if (allocated(spec%guides)) then
         c_spec%n_guides = ubound(spec%guide_count, 1)
         c_spec%guide_count = c_loc(spec%guide_count)
         c_spec%guide_xy = c_loc(spec%guides)
      end if
   end subroutine prepare_spec

   !> The network as C sees it; the arrays keep what the structure points to.
   subroutine prepare_network(network, arrays, c_network, error)
      type(network_t), intent(in) :: network
      type(c_network_arrays_t), intent(out), target :: arrays
      type(cm_network_t), intent(out) :: c_network
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      if (allocated(network%first)) then
         arrays%first = network%first - 1
         arrays%xy = network%xy
         arrays%s_start = network%s_start
      else
         allocate (arrays%first(1), source=0_ik)
         allocate (arrays%xy(2, 0), arrays%s_start(0))
      end if
      associate (first => arrays%first, xy => arrays%xy)
         n = ubound(first, 1) - 1
         if (n < 0 .or. ubound(xy, 1) /= 2 .or. ubound(arrays%s_start, 1) /= n) then
            call raise_error(error, "mesh_builder", &
                             "the arrays of the network do not fit each other")
            return
         end if
         if (first(1) /= 0 .or. first(n + 1) /= ubound(xy, 2) .or. any(first(2:) < first(:n))) then
            call raise_error(error, "mesh_builder", "the vertices of the network are not in order")
            return
         end if
      end associate
      c_network%n_fractures = n
      c_network%first = c_loc(arrays%first)
      if (n > 0) then
         c_network%xy = c_loc(arrays%xy)
         c_network%s_start = c_loc(arrays%s_start)
      end if
   end subroutine prepare_network

end module mesh_c_inputs
