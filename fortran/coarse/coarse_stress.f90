!> Stress around one vertex: multi-point stress stencil. The flow is that of coarse_diffusion.
!!
!! Multi-point stress approximation with weakly symmetric stress (Nordbotten 2016; Keilegavlen and
!! Nordbotten 2017), in its mixed form on triangles: each face has, at each of its two ends,
!! its own traction [Pa]; around a vertex these are found from the displacements and pressures of
!! the cells there, so that the displacement is continuous at a third of each face, and that the
!! stress is symmetric in the mean over the vertex (a rotation is the multiplier). With the corners'
!! areas as weights this is a lumped mixed method (Wheeler and Yotov 2006; Ambartsumyan, Khattatov,
!! Nordbotten and Yotov 2020): the matrix is symmetric, and stable for nearly incompressible rock.
!!
!! The pressure enters the stress-strain relation itself, eps = A (sigma + alpha p I), and the fluid
!! content takes its volume change from the same tractions: these are the stabilizing terms, for
!! vanishing permeability and time steps.
!!
!! The local system (coarse_elimination) is
!!   A t + C r + G d = given displacements,  C^T t = 0
!! with tractions t, rotations r and the unknowns d (displacements, jumps, pressures) around the
!! vertex. The rotations times 2 G are the unknowns, of the size of a traction, so that pivots stay
!! comparable: G of one of the cells that share the rotation.
!!
!! Where rocks of several stiffnesses meet at a vertex each has a rotation of its own
!! (coarse_regions). With tractions given on both sides of an interface that ends on the boundary,
!! two of them can ask the same of the traction on the interface; one of them is left out then.
module coarse_stress
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_elimination, only: fix_unknown, local_system_t, new_local_system, response_t
   use coarse_in_situ, only: in_situ_state_t
   use coarse_layout, only: at_component, end_of_block, fracture_cell_of_block
   use coarse_regions, only: fracture_end_region, regions_t, traction_face
   use coarse_rock, only: rock_t, solid_t
   use mesh_geometry, only: corner_geometry, face_length, outward_normal
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: divide_rotations, set_stress_equations

contains

   !> The equations of the tractions and the rotations of one region.
   pure subroutine set_stress_equations(mesh, rock, sides, regions, region, local, doubled, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      real(rk), allocatable, intent(out) :: doubled(:)  !< factor of each rotation
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      integer(ik) :: m, n, n_tractions

      allocate (doubled(regions%nodes%length(region)))
      n_tractions = 2*regions%faces%length(region)
      n = n_tractions + regions%nodes%length(region)
      m = 3*regions%blocks%length(region)
      call new_local_system(n, m, local)
      call add_corners(mesh, rock, regions, region, local, doubled)
      call add_jumps(mesh, regions, region, local)
      local%equations(n + 1:n + m, :n) = -local%coupling(:m, :n)
      call apply_sides(mesh, sides, regions, region, local, in_situ)
      if (regions%has_interface(region)) call leave_out_repeated(n_tractions, local)
   end subroutine set_stress_equations

   !> Divide the rotations in the response of one region by their factors.
   pure subroutine divide_rotations(doubled, response)
      real(rk), intent(in) :: doubled(:)
      type(response_t), intent(inout) :: response  !< tractions x, y [Pa], then rotations [-]
      integer(ik) :: k, n_tractions

      n_tractions = size(response%matrix, 2, kind=ik) - size(doubled, kind=ik)
      do k = 1, size(doubled, kind=ik)
         associate (rotation => response%matrix(:, n_tractions + k))
            rotation = rotation/doubled(k)
         end associate
      end do
   end subroutine divide_rotations

   !> Contributions of the corners of cells around the vertex.
   pure subroutine add_corners(mesh, rock, regions, region, local, doubled)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      real(rk), intent(out) :: doubled(:)  !< 2 G of each rotation [Pa]
      integer(ik) :: at(2), c, cell, faces(2), first, i, j, k, rotation
      real(rk) :: sign_out(2), length(2), lever(2, 2), area, w
      type(solid_t) :: solid

      first = 2*regions%faces%length(region)
      doubled = 0.0_rk
      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         k = findloc(regions%regions_of_block(:, cell), region, dim=1)
         solid = rock%solid_at(cell)
         rotation = first + regions%nodes%place(region, regions%rotation_of_corner(k, cell))
         if (.not. doubled(rotation - first) > 0.0_rk) then
            doubled(rotation - first) = 2.0_rk*solid%shear
         end if
         call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
         do j = 1, 2
            call traction_face(mesh, faces(j), sign_out(j))
            at(j) = 2*regions%faces%place(region, faces(j)) - 1
         end do
         do j = 1, 2
            do i = 1, 2
               w = area/3.0_rk*sign_out(i)*sign_out(j)/(2.0_rk*solid%shear)
               call add_compliance(local%equations, at(i), at(j), w, solid%poisson(), lever(:, i), &
                                   lever(:, j))
            end do
            w = sign_out(j)*area/(3.0_rk*doubled(rotation - first))
            call add_symmetric(local%equations, at(j), rotation, -w*lever(2, j))
            call add_symmetric(local%equations, at(j) + 1, rotation, w*lever(1, j))
            w = sign_out(j)*area/3.0_rk
            local%coupling(at_component(c, 1), at(j)) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(at_component(c, 2), at(j) + 1) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(at_component(c, 3), at(j):at(j) + 1) = &
               w*lever(:, j)*solid%biot/(2.0_rk*(solid%lame + solid%shear))
         end do
      end do
   end subroutine add_corners

   !> Fix rotations whose equations, in the unknown tractions, depend linearly on those of previous
   !! rotations.
   pure subroutine leave_out_repeated(n_tractions, local)
      integer(ik), intent(in) :: n_tractions
      type(local_system_t), intent(inout) :: local
      real(rk), parameter :: nothing = 1.0e-10_rk  !< largest remainder of a repeated row
      real(rk) :: rows(n_tractions, local%n - n_tractions), left(n_tractions)
      real(rk) :: whole
      integer(ik) :: i, k

      do k = 1, size(rows, 2, kind=ik)
         left = local%equations(:n_tractions, n_tractions + k)
         whole = norm2(left)
         rows(:, k) = 0.0_rk
         if (.not. whole > 0.0_rk) cycle
         do i = 1, k - 1
            left = left - dot_product(rows(:, i), left)*rows(:, i)
         end do
         if (norm2(left) > nothing*whole) then
            rows(:, k) = left/norm2(left)
         else
            call fix_unknown(local, n_tractions + k, 0.0_rk)
         end if
      end do
   end subroutine leave_out_repeated

   !> Jumps of the fracture cells, which are unknowns: each end's acts in the region where it lies.
   pure subroutine add_jumps(mesh, regions, region, local)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      integer(ik) :: at, b, block, cell, f
      real(rk) :: half_length

      do b = regions%cell_count(region) + 1, regions%blocks%length(region)
         block = regions%blocks%at(region, b)
         cell = fracture_cell_of_block(mesh, block)
         if (fracture_end_region(mesh, regions, cell, end_of_block(mesh, block)) /= region) cycle
         f = mesh%fracture%cell_faces(1, cell)
         half_length = 0.5_rk*face_length(mesh, f)
         at = 2*regions%faces%place(region, f) - 1
         local%coupling(at_component(b, 1), at) = half_length
         local%coupling(at_component(b, 2), at + 1) = half_length
      end do
   end subroutine add_jumps

   !> A t_j (x) m_j : t_i (x) m_i for unit tractions, A the isotropic compliance.
   pure subroutine add_compliance(matrix, row, col, factor, nu, lever_i, lever_j)
      real(rk), intent(inout) :: matrix(:, :)  !< [m2/Pa]
      integer(ik), intent(in) :: row, col  !< of the x components
      real(rk), intent(in) :: factor  !< weight/(2G) [m2/Pa]
      real(rk), intent(in) :: nu  !< lambda/(2(lambda+G)) [-]
      real(rk), intent(in) :: lever_i(2), lever_j(2)  !< m_i, m_j [-]
      integer(ik) :: a, b

      do b = 1, 2
         do a = 1, 2
            matrix(row + a - 1, col + b - 1) = matrix(row + a - 1, col + b - 1) &
                                               - factor*nu*lever_i(a)*lever_j(b)
         end do
         matrix(row + b - 1, col + b - 1) = matrix(row + b - 1, col + b - 1) &
                                            + factor*dot_product(lever_i, lever_j)
      end do
   end subroutine add_compliance

   pure subroutine add_symmetric(matrix, row, col, value)
      real(rk), intent(inout) :: matrix(:, :)  !< [m2/Pa]
      integer(ik), intent(in) :: row, col
      real(rk), intent(in) :: value  !< [m2/Pa]

      matrix(row, col) = matrix(row, col) + value
      matrix(col, row) = matrix(col, row) + value
   end subroutine add_symmetric

   !> Outer boundary: each component has a prescribed displacement, a prescribed traction, or a
   !! spring.
   pure subroutine apply_sides(mesh, sides, regions, region, local, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      type(in_situ_state_t), intent(in), optional :: in_situ
      real(rk) :: traction(2)
      integer(ik) :: axis, f, j, last, n

      last = local%last()
      do j = 1, regions%faces%length(region)
         f = regions%faces%at(region, j)
         if (mesh%face_side(f) == 0) cycle
         associate (side => sides(mesh%face_side(f)), half_length => 0.5_rk*face_length(mesh, f), &
                    outward => outward_normal(mesh, f))
            traction = side%traction + side%normal_traction*outward &
                       + side%shear_traction*[-outward(2), outward(1)]
            if (present(in_situ)) then
               traction = in_situ%side_traction(traction, outward, &
                                                mesh%xy(2, regions%nodes%at(region, 1_ik)))
            end if
            do axis = 1, 2
               n = 2*(j - 1) + axis
               if (side%displacement_given(axis)) then
                  local%equations(last, n) = local%equations(last, n) &
                                             + half_length*side%displacement(axis)
               else if (side%spring(axis) > 0.0_rk) then
                  ! The side moves by what the traction lacks of the given one, over the spring.
                  associate (give => half_length/side%spring(axis))
                     local%equations(n, n) = local%equations(n, n) + give
                     local%equations(last, n) = local%equations(last, n) + give*traction(axis)
                  end associate
               else
                  call fix_unknown(local, n, traction(axis))
               end if
            end do
         end associate
      end do
      ! Where all tractions are given, as in a loaded corner, the rotation is free and without
      ! effect.
      do n = 2*regions%faces%length(region) + 1, local%n
         if (.not. any(abs(local%equations(:local%n, n)) > 0.0_rk)) local%equations(n, n) = 1.0_rk
      end do
   end subroutine apply_sides

end module coarse_stress
