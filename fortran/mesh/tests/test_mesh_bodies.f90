!> Whole bodies through the Fortran interface: polygons, fixed points, rosettes, wanted sizes
!! and quality. The meshes themselves are tested in C++ (cpp_mesh/tests).
program test_mesh_bodies
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use mesh_builder, only: build_mesh, build_mesh_sized, mesh_quality, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t, point_boundary
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call test_disc(checks)
   call test_sized(checks)
   call test_refusals(checks)
   call checks%finish()

contains

   !> One straight fracture.
   function straight_network(ends) result(network)
      real(rk), intent(in) :: ends(2, 2)
      type(network_t) :: network

      allocate (network%first, source=[1_ik, 3_ik])
      allocate (network%xy, source=ends)
      allocate (network%s_start, source=[0.0_rk])
   end function straight_network

   !> Area of a cell.
   real(rk) function area(mesh, cell)
      type(mesh_t), intent(in) :: mesh
      integer, intent(in) :: cell
      real(rk) :: u(2), v(2)

      associate (node => mesh%cell_nodes(:, cell))
         u = mesh%xy(:, node(2)) - mesh%xy(:, node(1))
         v = mesh%xy(:, node(3)) - mesh%xy(:, node(1))
      end associate
      area = 0.5_rk*(u(1)*v(2) - u(2)*v(1))
   end function area

   !> Area of the body.
   real(rk) function total_area(mesh)
      type(mesh_t), intent(in) :: mesh
      integer :: cell

      total_area = 0.0_rk
      do cell = 1, mesh%n_cells
         total_area = total_area + area(mesh, cell)
      end do
   end function total_area

   !> Nodes exactly at a place.
   integer function nodes_at(mesh, xy)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: xy(2)

      nodes_at = count(.not. hypot(mesh%xy(1, :) - xy(1), mesh%xy(2, :) - xy(2)) > 0.0_rk)
   end function nodes_at

   !> A disc of radius 1 m with the side numbers 1 (lower half) and 2 (upper half).
   function disc_spec(n) result(spec)
      integer, intent(in) :: n
      type(mesh_spec_t) :: spec
      integer :: k

      allocate (spec%corners(2, n), spec%edge_side(n))
      do k = 1, n
         spec%corners(:, k) = [cos(2.0_rk*pi*(k - 1)/n), sin(2.0_rk*pi*(k - 1)/n)]
         spec%edge_side(k) = merge(2_ik, 1_ik, 2*k <= n)
      end do
      spec%size_fracture = 0.05_rk
      spec%size_boundary = 0.2_rk
   end function disc_spec

   !> A cracked disc with fixed points and different rosettes at both tips.
   subroutine test_disc(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      integer, parameter :: n = 120
      real(rk) :: polygon, half, length(2)
      integer :: face, k

      spec = disc_spec(n)
      spec%rosette_sectors = 8
      spec%rosette_radius = 0.05_rk
      spec%end_radius = reshape([0.0_rk, 0.02_rk], [2, 1])
      spec%fixed_points = reshape([spec%corners(:, 31), 0.1_rk, 0.5_rk], [2, 2])
      call build_mesh(spec, straight_network(reshape([-0.3_rk, 0.0_rk, 0.3_rk, 0.0_rk], [2, 2])), &
                      mesher, mesh, error)
      call checks%no_error(error, "disc")
      if (allocated(error)) return
      polygon = 0.5_rk*n*sin(2.0_rk*pi/n)
      call checks%is_close(total_area(mesh), polygon, 1.0e-12_rk, "disc: area")
      length = 0.0_rk
      do face = 1, mesh%n_faces
         k = mesh%face_side(face)
         if (k == 0) cycle
         length(k) = length(k) + norm2(mesh%xy(:, mesh%face_nodes(2, face)) - &
                                       mesh%xy(:, mesh%face_nodes(1, face)))
      end do
      half = n*sin(pi/n)
      call checks%is_close(length(1), half, 1.0e-12_rk, "disc: side 1")
      call checks%is_close(length(2), half, 1.0e-12_rk, "disc: side 2")
      do k = 1, 2
         call checks%is_true(nodes_at(mesh, spec%fixed_points(:, k)) == 1, &
                             "disc: fixed points are nodes")
      end do
      associate (f => mesh%fracture)
         call checks%is_true(f%n_tips == 2, "disc: tips")
         call checks%is_close(sum(merge(f%tip_radius, 0.0_rk, f%tip_end == 1)), 0.05_rk, &
                              1.0e-15_rk, "disc: usual rosette")
         call checks%is_close(sum(merge(f%tip_radius, 0.0_rk, f%tip_end == 2)), 0.02_rk, &
                              1.0e-15_rk, "disc: rosette of its own")
      end associate
   end subroutine test_disc

   !> Half the size everywhere makes four times as many cells; quality is that of the worst cell.
   subroutine test_sized(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher, mesher_new
      type(mesh_t) :: mesh, mesh_new
      type(network_t) :: network
      real(rk), allocatable :: sizes(:)
      real(rk) :: smallest, u(2), v(2)
      integer(ik) :: worst
      integer :: k
      real(rk) :: angles(3)

      spec%x_max = 1.0_rk
      spec%y_max = 1.0_rk
      spec%size_fracture = 0.1_rk
      spec%size_boundary = 0.1_rk
      network = straight_network(reshape([0.0_rk, 0.5_rk, 0.5_rk, 0.5_rk], [2, 2]))
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "sized: old mesh")
      allocate (sizes(mesh%n_cells), source=0.05_rk)
      network%xy(:, 2) = [0.6_rk, 0.5_rk]
      call build_mesh_sized(spec, network, mesher, sizes, mesher_new, mesh_new, error)
      call checks%no_error(error, "sized")
      if (allocated(error)) return
      call checks%is_close(total_area(mesh_new), 1.0_rk, 1.0e-12_rk, "sized: area")
      call checks%is_close(real(mesh_new%n_cells, rk)/mesh%n_cells, 4.0_rk, 0.4_rk, &
                           "sized: number of cells")
      call checks%is_true(mesh_new%fracture%n_cells == 12, "sized: fracture cells")
      call checks%is_true(count(mesh_new%fracture%point_kind == point_boundary) == 1, &
                          "sized: edge crack")
      call mesh_quality(mesher_new, smallest, worst, error)
      call checks%no_error(error, "quality")
      do k = 1, 3
         associate (node => cshift(mesh_new%cell_nodes(:, worst), k))
            u = mesh_new%xy(:, node(2)) - mesh_new%xy(:, node(1))
            v = mesh_new%xy(:, node(3)) - mesh_new%xy(:, node(1))
         end associate
         angles(k) = acos(dot_product(u, v)/(norm2(u)*norm2(v)))
      end do
      call checks%is_close(smallest, minval(angles), 1.0e-12_rk, "quality: smallest angle")
      call build_mesh_sized(spec, network, mesher, sizes(2:), mesher_new, mesh_new, error)
      call checks%is_true(allocated(error), "sized: one size too few is refused")
   end subroutine test_sized

   !> Arrays that do not fit.
   subroutine test_refusals(checks)
      type(checks_t), intent(inout) :: checks
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher, none
      type(mesh_t) :: mesh
      type(network_t) :: network
      real(rk) :: angle
      integer(ik) :: cell

      spec = disc_spec(12)
      spec%edge_side = spec%edge_side(2:)
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%is_true(allocated(error), "refused: sides that do not fit the corners")
      deallocate (spec%edge_side)
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%is_true(allocated(error), "refused: no sides")
      spec = disc_spec(12)
      spec%end_radius = reshape([0.1_rk, 0.1_rk], [2, 1])
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%is_true(allocated(error), "refused: radii without fractures")
      spec = disc_spec(12)
      spec%fixed_points = reshape([2.0_rk, 0.0_rk], [2, 1])
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%is_true(allocated(error), "refused: a fixed point outside")
      if (allocated(error)) call checks%is_true(index(error%message, "fixed point 1") > 0, &
                                                "refused: which fixed point")
      call build_mesh_sized(disc_spec(12), network, none, [1.0_rk], mesher, mesh, error)
      call checks%is_true(allocated(error), "refused: no old mesh")
      call mesh_quality(none, angle, cell, error)
      call checks%is_true(allocated(error), "refused: quality of no mesh")
   end subroutine test_refusals

end program test_mesh_bodies
