!> Small bodies, fracture networks and helpers for the tests of the coarse level and of both levels.
module sample_bodies
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_layout, only: end_block
   use coarse_matrix, only: matrix_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_regions, only: regions_t
   use coarse_rock, only: new_rock, rock_t
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use coarse_stencils, only: discretize
   use contact_law, only: contact_law_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_geometry, only: face_length
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   private

   public :: action, advance, boxes, cell_centre, cut_square, dense_matrix, equilibrate, hold
   public :: linear_unknowns, load_sides, mesh_square, new_square, porous_body, prepare, scattered
   public :: set_permeability, shake, straight_network, uniform_cells

contains

   !> The rock and the fluid of Paper C; sides without traction, closed to flow.
   pure function porous_body() result(scene)
      type(scene_t) :: scene

      scene%material%young = 40.0e9_rk
      scene%material%poisson = 0.2_rk
      scene%material%biot = 0.8_rk
      scene%material%porosity = 0.01_rk
      scene%material%permeability_xx = 5.0e-20_rk
      scene%material%permeability_yy = 5.0e-20_rk
      scene%fluid%compressibility = 4.0e-10_rk
      scene%fluid%viscosity = 1.0e-4_rk
      allocate (scene%fractures(0), scene%injections(0), scene%probes(0))
   end function porous_body

   pure subroutine set_permeability(scene, permeability)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: permeability  !< [m2]

      scene%material%permeability_xx = permeability
      scene%material%permeability_yy = permeability
   end subroutine set_permeability

   !> Rollers at left and bottom, and perhaps normal stresses on the right side and on top.
   pure subroutine hold(scene, stress)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in), optional :: stress(2)  !< xx, yy [Pa]

      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(3)%displacement_given(2) = .true.
      if (.not. present(stress)) return
      scene%sides(2)%traction(1) = stress(1)
      scene%sides(4)%traction(2) = stress(2)
   end subroutine hold

   !> Let a uniform total stress act on all sides.
   pure subroutine load_sides(scene, stress)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy [Pa]

      scene%sides(1)%traction = -stress([1, 3])
      scene%sides(2)%traction = stress([1, 3])
      scene%sides(3)%traction = -stress([3, 2])
      scene%sides(4)%traction = stress([3, 2])
   end subroutine load_sides

   !> Straight fractures: `ends(:, :, f)` are the two ends of fracture f [m].
   pure function straight_network(ends) result(network)
      real(rk), intent(in) :: ends(:, :, :)
      type(network_t) :: network
      integer(ik) :: f, n

      n = size(ends, 3)
      allocate (network%first, source=[(1_ik + 2_ik*f, f=0, n)])
      allocate (network%xy, source=reshape(ends, [2_ik, 2_ik*n]))
      allocate (network%s_start(n), source=0.0_rk)
   end function straight_network

   !> Mesh of [0, 2] x [0, 2] m.
   subroutine mesh_square(checks, network, size_fracture, size_boundary, mesh, mesher)
      type(checks_t), intent(inout) :: checks
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: size_fracture, size_boundary  !< [m]
      type(mesh_t), intent(out) :: mesh
      type(mesher_t), intent(inout), optional :: mesher  !< of a mesh that will change
      type(mesh_spec_t) :: spec
      type(mesher_t) :: own
      type(error_t), allocatable :: error

      spec = mesh_spec_t(x_max=2.0_rk, y_max=2.0_rk, size_fracture=size_fracture, &
                         size_boundary=size_boundary)
      if (present(mesher)) then
         call build_mesh(spec, network, mesher, mesh, error)
      else
         call build_mesh(spec, network, own, mesh, error)
      end if
      call checks%no_error(error, "mesh of the square")
   end subroutine mesh_square

   !> [0, 2] x [0, 2] m as n by n boxes, each cut in two from its lower left to its upper right
   !! corner: the body's lower right and upper left corners have one cell each.
   pure function boxes(n) result(mesh)
      integer(ik), intent(in) :: n
      type(mesh_t) :: mesh
      integer(ik) :: c, i, j, lower_left

      mesh%n_nodes = (n + 1)**2
      mesh%n_cells = 2*n**2
      allocate (mesh%xy(2, mesh%n_nodes), mesh%cell_nodes(3, mesh%n_cells))
      do j = 0, n
         do i = 0, n
            mesh%xy(:, j*(n + 1) + i + 1) = 2.0_rk*[i, j]/n
         end do
      end do
      c = 0
      do j = 0, n - 1
         do i = 0, n - 1
            lower_left = j*(n + 1) + i + 1
            mesh%cell_nodes(:, c + 1) = lower_left + [0_ik, 1_ik, n + 2]
            mesh%cell_nodes(:, c + 2) = lower_left + [0_ik, n + 2, n + 1]
            c = c + 2
         end do
      end do
      call find_faces(mesh)
      allocate (mesh%fracture%cell_faces(2, 0), mesh%fracture%cell_points(2, 0))
      allocate (mesh%fracture%point_xy(2, 0), mesh%fracture%point_kind(0))
   end function boxes

   !> Faces of cells, and the sides of the square on which they lie.
   pure subroutine find_faces(mesh)
      type(mesh_t), intent(inout) :: mesh
      integer(ik) :: c, f, k, ends(2), nodes(2, 3*mesh%n_cells), cells(2, 3*mesh%n_cells)

      allocate (mesh%cell_faces(3, mesh%n_cells))
      mesh%n_faces = 0
      do c = 1, mesh%n_cells
         do k = 1, 3
            ends = mesh%cell_nodes([k, mod(k, 3_ik) + 1], c)
            do f = 1, mesh%n_faces
               if (all(nodes(:, f) == ends(2:1:-1))) exit
            end do
            if (f > mesh%n_faces) then
               mesh%n_faces = f
               nodes(:, f) = ends
               cells(:, f) = [c, 0_ik]
            else
               cells(2, f) = c
            end if
            mesh%cell_faces(k, c) = f
         end do
      end do
      allocate (mesh%face_nodes, source=nodes(:, :mesh%n_faces))
      allocate (mesh%face_cells, source=cells(:, :mesh%n_faces))
      allocate (mesh%face_side(mesh%n_faces), mesh%face_fracture_cell(mesh%n_faces), source=0_ik)
      do f = 1, mesh%n_faces
         if (mesh%face_cells(2, f) > 0) cycle
         associate (centre => 0.5_rk*sum(mesh%xy(:, mesh%face_nodes(:, f)), dim=2))
            mesh%face_side(f) = minloc([centre(1), 2.0_rk - centre(1), centre(2), &
                                        2.0_rk - centre(2)], dim=1)
         end associate
      end do
   end subroutine find_faces

   !> Move the inner nodes to and fro by a fifth of their shortest edge, so that no two cells are
   !! alike.
   pure subroutine shake(mesh)
      type(mesh_t), intent(inout) :: mesh
      real(rk), parameter :: share = 0.2_rk
      real(rk), allocatable :: shortest(:)
      integer(ik) :: f, v

      allocate (shortest(mesh%n_nodes), source=huge(1.0_rk))
      do f = 1, mesh%n_faces
         associate (nodes => mesh%face_nodes(:, f))
            shortest(nodes) = min(shortest(nodes), face_length(mesh, f))
         end associate
      end do
      do f = 1, mesh%n_faces
         if (mesh%face_cells(2, f) == 0) shortest(mesh%face_nodes(:, f)) = 0.0_rk
      end do
      do v = 1, mesh%n_nodes
         mesh%xy(:, v) = mesh%xy(:, v) + share*shortest(v)*[cos(2.4_rk*v), sin(2.4_rk*v)]
      end do
   end subroutine shake

   pure function cell_centre(mesh, cell) result(centre)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      centre = sum(mesh%xy(:, mesh%cell_nodes(:, cell)), dim=2)/3.0_rk
   end function cell_centre

   !> Unknowns of the coarse level in a linear field: u = translation + gradient*x in all cells, no
   !! jumps, pressure p0 + slope*x.
   pure function linear_unknowns(mesh, translation, gradient, p0, slope) result(unknowns)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: translation(2)  !< [m]
      real(rk), intent(in) :: gradient(2, 2)  !< d u_i / d x_j [-]
      real(rk), intent(in) :: p0  !< [Pa]
      real(rk), intent(in) :: slope(2)  !< [Pa/m]
      real(rk), allocatable :: unknowns(:, :)  !< (3, n_blocks)
      integer(ik) :: c, i
      real(rk) :: centre(2)

      allocate (unknowns(3, mesh%n_cells + 2*mesh%fracture%n_cells), source=0.0_rk)
      do c = 1, mesh%n_cells
         centre = cell_centre(mesh, c)
         unknowns(1:2, c) = translation + matmul(gradient, centre)
         unknowns(3, c) = p0 + dot_product(slope, centre)
      end do
      do i = 1, mesh%fracture%n_cells
         associate (points => mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, i)))
            unknowns(3, end_block(mesh, i, [1_ik, 2_ik])) = &
               p0 + dot_product(slope, 0.5_rk*sum(points, dim=2))
         end associate
      end do
   end function linear_unknowns

   !> Numbers between -1 and 1 without any pattern, the same in every run.
   pure function scattered(n) result(x)
      integer(ik), intent(in) :: n
      real(rk) :: x(n)
      integer(ik) :: i

      x = [(sin(real(i, rk)**2 + 0.5_rk*i), i=1, n)]
   end function scattered

   !> One law for all fracture cells.
   pure function uniform_cells(mesh, law, aperture) result(cells)
      type(mesh_t), intent(in) :: mesh
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: aperture  !< residual [m]
      type(fracture_cells_t) :: cells

      associate (n => mesh%fracture%n_cells)
         allocate (cells%law(n), source=law)
         allocate (cells%residual_aperture(n), source=aperture)
         allocate (cells%roughness(n), source=0.0_rk)
         allocate (cells%share(n), source=1.0_rk)
         allocate (cells%has_tip(n), source=.false.)
         allocate (cells%viscous(n), source=0.0_rk)
         allocate (cells%leak_resistance(n), source=0.0_rk)
         allocate (cells%injection(n), source=0.0_rk)
      end associate
   end function uniform_cells

   !> elastic + dt*flow as a full matrix.
   pure function dense_matrix(matrix, dt) result(full)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable :: full(:, :)
      integer(ik) :: col, entry, row
      real(rk) :: block(3, 3)

      allocate (full(3*matrix%n_blocks, 3*matrix%n_blocks), source=0.0_rk)
      do row = 1, matrix%n_blocks
         do entry = matrix%columns%first(row), matrix%columns%last(row)
            col = matrix%columns%item(entry)
            block = matrix%elastic(:, :, entry)
            block(3, 3) = block(3, 3) + dt*matrix%flow(entry)
            full(3*row - 2:3*row, 3*col - 2:3*col) = block
            full(3*col - 2:3*col, 3*row - 2:3*row) = transpose(block)
         end do
      end do
   end function dense_matrix

   !> matrix*unknowns less the boundary's part, as (3, n_blocks).
   function action(matrix, dt, unknowns) result(rows)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt, unknowns(:, :)
      real(rk), allocatable :: rows(:, :)

      allocate (rows(3, matrix%n_blocks))
      rows = reshape(matmul(dense_matrix(matrix, dt), reshape(unknowns, [size(unknowns)])), &
                     [3_ik, matrix%n_blocks]) - matrix%elastic_known
      rows(3, :) = rows(3, :) - dt*matrix%flow_known
   end function action

   !> The discretized rock of a scene without regions.
   subroutine prepare(checks, mesh, scene, rock, regions, matrix)
      type(checks_t), intent(inout) :: checks
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      type(rock_t), intent(out) :: rock
      type(regions_t), intent(out) :: regions
      type(matrix_t), intent(out) :: matrix
      type(error_t), allocatable :: error

      rock = new_rock(scene%material, scene%fluid)
      call discretize(mesh, rock, scene%sides, regions, matrix, error)
      call checks%no_error(error, "discretization")
   end subroutine prepare

   !> The square with one straight fracture, on cells of irregular shape, before anything happens.
   subroutine cut_square(checks, scene, line, law, aperture, mesh, model, state)
      type(checks_t), intent(inout) :: checks
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: line(2, 2)  !< ends of the fracture [m]
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: aperture  !< residual [m]
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state

      call mesh_square(checks, straight_network(reshape(line, [2, 2, 1])), 0.2_rk, 0.4_rk, mesh)
      call shake(mesh)
      call begin(checks, scene, law, aperture, mesh, model, state)
   end subroutine cut_square

   !> The square with a network, before anything happens.
   subroutine new_square(checks, scene, network, sizes, law, aperture, mesh, model, state)
      type(checks_t), intent(inout) :: checks
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: sizes(2)  !< of cells at fractures and at the boundary [m]
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: aperture  !< residual [m]
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state

      call mesh_square(checks, network, sizes(1), sizes(2), mesh)
      call begin(checks, scene, law, aperture, mesh, model, state)
   end subroutine new_square

   subroutine begin(checks, scene, law, aperture, mesh, model, state)
      type(checks_t), intent(inout) :: checks
      type(scene_t), intent(in) :: scene
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: aperture  !< residual [m]
      type(mesh_t), intent(inout) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      model%cells = uniform_cells(mesh, law, aperture)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, scene%initial, model, state)
   end subroutine begin

   !> A time step, which must converge.
   subroutine advance(checks, model, mesh, dt, state, report, name)
      type(checks_t), intent(inout) :: checks
      type(coarse_model_t), intent(inout) :: model
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(out) :: report
      character(len=*), intent(in) :: name
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call model%advance(mesh, dt, state, timers, report, error)
      call checks%no_error(error, name)
      call checks%is_true(report%converged, name//" converges")
   end subroutine advance

   !> The initial state, which must converge.
   subroutine equilibrate(checks, model, mesh, dt, state, report, name)
      type(checks_t), intent(inout) :: checks
      type(coarse_model_t), intent(inout) :: model
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(out) :: report
      character(len=*), intent(in) :: name
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call model%equilibrate(mesh, dt, state, timers, report, error)
      call checks%no_error(error, name)
      call checks%is_true(report%converged, name//" converges")
   end subroutine equilibrate

end module sample_bodies
