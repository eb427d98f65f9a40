!> Meshes for the programs of verification cases.
module verification_meshes
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use verification_files, only: stop_on
   implicit none(type, external)
   private

   public :: cell_centre, distort, network_of, plain_rectangle, turn

contains

   !> Triangles of one size in [0, width] x [0, height], no fracture.
   subroutine plain_rectangle(width, height, size, mesh)
      real(rk), intent(in) :: width, height, size  !< [m]
      type(mesh_t), intent(out) :: mesh
      type(network_t) :: network
      type(mesher_t) :: mesher
      type(error_t), allocatable :: error

      allocate (network%first(1), source=1_ik)
      allocate (network%xy(2, 0), network%s_start(0))
      call build_mesh(mesh_spec_t(x_max=width, y_max=height, size_fracture=size, &
                                  size_boundary=size), network, mesher, mesh, error)
      call stop_on(error)
   end subroutine plain_rectangle

   !> Straight or kinked fractures: the vertices of each, one after the other.
   function network_of(counts, xy) result(network)
      integer(ik), intent(in) :: counts(:)  !< vertices of each fracture
      real(rk), intent(in) :: xy(:, :)  !< (2, vertices) [m]
      type(network_t) :: network
      integer(ik) :: i

      allocate (network%first(size(counts) + 1), network%s_start(size(counts)))
      network%first(1) = 1
      do i = 1, size(counts, kind=ik)
         network%first(i + 1) = network%first(i) + counts(i)
      end do
      network%s_start = 0.0_rk
      network%xy = xy
   end function network_of

   !> Move every node that is not on the outer boundary by up to `share` of the shortest edge of
   !! the mesh, in a pseudo-random direction that is the same on every machine.
   subroutine distort(share, mesh)
      real(rk), intent(in) :: share  !< [-]; triangles keep their sense up to about 0.3
      type(mesh_t), intent(inout) :: mesh
      logical :: is_outer(mesh%n_nodes)
      real(rk) :: shortest, draw(2)
      integer(ik) :: face, node

      is_outer = .false.
      shortest = huge(1.0_rk)
      do face = 1, mesh%n_faces
         associate (ends => mesh%face_nodes(:, face))
            if (mesh%face_side(face) > 0) is_outer(ends) = .true.
            shortest = min(shortest, norm2(mesh%xy(:, ends(2)) - mesh%xy(:, ends(1))))
         end associate
      end do
      draw = [0.3_rk, 0.7_rk]
      do node = 1, mesh%n_nodes
         ! Additive sequence of golden-ratio type (Roberts 2018): evenly spread, no generator.
         draw = modulo(draw + [0.7548776662466927_rk, 0.5698402909980532_rk], 1.0_rk)
         if (is_outer(node)) cycle
         mesh%xy(:, node) = mesh%xy(:, node) + share*shortest*(2.0_rk*draw - 1.0_rk)
      end do
   end subroutine distort

   !> Turn a mesh without fractures about the origin.
   subroutine turn(angle, mesh)
      real(rk), intent(in) :: angle  !< anticlockwise [rad]
      type(mesh_t), intent(inout) :: mesh

      mesh%xy = matmul(reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2]), mesh%xy)
   end subroutine turn

   pure function cell_centre(mesh, cell) result(centre)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      centre = sum(mesh%xy(:, mesh%cell_nodes(:, cell)), dim=2)/3.0_rk
   end function cell_centre

end module verification_meshes
