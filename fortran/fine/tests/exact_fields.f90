!> Two exact elastic fields, smooth and cracked, and how far solutions and recovered stresses are
!! from them.
module exact_fields
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: centre_crack
   use fine_elasticity, only: elasticity_t
   use fine_element, only: collapsed_rule, triangle_rule_7
   use fine_faces, only: loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_recovery, only: recovered_stress, recovery_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: angle, reactions, rock, solve_exact, true_errors

   type(elasticity_t), parameter :: rock = elasticity_t(1.0_rk, 0.3_rk, 0.0_rk, .false.)
   real(rk), parameter :: angle = 0.3_rk  !< of the crack [rad]

contains

   !> Exact field: a smooth one (Muskhelishvili's functions phi = psi = exp(z)), or a crack |x| < 1
   !! at an angle under tension across it.
   pure function exact_displacement(cracked, xy) result(displacement)
      logical, intent(in) :: cracked
      real(rk), intent(in) :: xy(2)
      real(rk) :: displacement(2)
      real(rk) :: rotation(2, 2)
      complex(rk) :: z, value

      if (cracked) then
         rotation = turn()
         displacement = matmul(rotation, centre_crack(rock, 1.0_rk, 1.0_rk, 0.0_rk, &
                                                      matmul(transpose(rotation), xy), .true.))
      else
         z = cmplx(xy(1), xy(2), rk)
         value = (rock%kolosov()*exp(z) - z*conjg(exp(z)) - conjg(exp(z))) &
                 /(2.0_rk*rock%shear_modulus())
         displacement = [real(value, rk), aimag(value)]
      end if
   end function exact_displacement

   pure function turn() result(rotation)
      real(rk) :: rotation(2, 2)

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
   end function turn

   !> Stress tensor of the same fields.
   pure function exact_stress(cracked, xy) result(stress)
      logical, intent(in) :: cracked
      real(rk), intent(in) :: xy(2)
      real(rk) :: stress(2, 2)
      real(rk) :: place(2)
      complex(rk) :: z, root, phi, phi_slope, traction

      if (cracked) then
         place = matmul(transpose(turn()), xy)
         z = cmplx(place(1), place(2), rk)
         root = sqrt(z - 1.0_rk)*sqrt(z + 1.0_rk)
         phi = 0.5_rk*(z/root - 1.0_rk)
         phi_slope = -0.5_rk/root**3
         traction = phi + conjg(phi) + (z - conjg(z))*conjg(phi_slope)
         stress(2, 2) = real(traction, rk)
         stress(1, 2) = -aimag(traction)
         stress(1, 1) = 4.0_rk*real(phi, rk) - stress(2, 2)
         stress(2, 1) = stress(1, 2)
         stress = matmul(turn(), matmul(stress, transpose(turn())))
      else
         z = cmplx(xy(1), xy(2), rk)
         traction = 2.0_rk*(conjg(z)*exp(z) + exp(z))  ! s_yy - s_xx + 2 i s_xy
         stress(1, 1) = 2.0_rk*real(exp(z), rk) - 0.5_rk*real(traction, rk)
         stress(2, 2) = 2.0_rk*real(exp(z), rk) + 0.5_rk*real(traction, rk)
         stress(1, 2) = 0.5_rk*aimag(traction)
         stress(2, 1) = stress(1, 2)
      end if
   end function exact_stress

   !> Solve with the exact displacement on the edges.
   subroutine solve_exact(mesh, cracked, model, displacement, error)
      type(mesh_t), intent(in) :: mesh
      logical, intent(in) :: cracked
      type(fine_model_t), intent(inout) :: model
      real(rk), allocatable, intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(error_t), allocatable, intent(out) :: error
      type(fine_loads_t) :: loads
      integer(ik) :: node

      call model%set_mesh(mesh, rock, error)
      if (.not. allocated(error)) call model%prepare(loaded_everywhere(model%mesh), error)
      if (allocated(error)) return
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = exact_displacement(cracked, model%mesh%xy(:, node))
      end do
      if (cracked) loads%fluid_pressure = 1.0_rk
      call model%solve(loads, displacement, error)
   end subroutine solve_exact

   !> True errors in the energy norm, of the solution or of recovered stresses.
   function true_errors(model, displacement, cracked, recovery) result(element)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      logical, intent(in) :: cracked
      type(recovery_t), intent(in), optional :: recovery  !< default: the stresses of the elements
      real(rk) :: element(model%mesh%n_cells)  !< [(J/m)^1/2]
      integer(ik), parameter :: n_t = 6, n_w = 8
      real(rk) :: points(3, n_t*n_w), weights(n_t*n_w), values(6), gradients(2, 6), share
      real(rk) :: area_coordinates(3), determinant, stress(2, 2), exact(2, 2), difference(3)
      integer(ik) :: cell, n_points, point

      share = rock%lame_lambda()/(2.0_rk*(rock%lame_lambda() + rock%shear_modulus()))
      do cell = 1, model%mesh%n_cells
         n_points = 7
         call triangle_rule_7(points(:, 1:7), weights(1:7))
         if (model%mesh%tip_corner(cell) > 0) then
            n_points = n_t*n_w
            call collapsed_rule(model%mesh%tip_corner(cell), n_t, n_w, points, weights)
         end if
         element(cell) = 0.0_rk
         associate (nodes => model%mesh%cell_nodes(:, cell))
            do point = 1, n_points
               call model%mesh%evaluate(cell, points(:, point), values, gradients, &
                                        area_coordinates, determinant)
               exact = exact_stress(cracked, matmul(model%mesh%xy(:, nodes), values))
               stress = model%elasticity%total_stress(matmul(displacement(:, nodes), &
                                                             transpose(gradients)), 0.0_rk)
               difference = [stress(1, 1), stress(2, 2), stress(1, 2)]
               if (present(recovery)) then
                  difference = recovered_stress(model%mesh, recovery, cell, area_coordinates)
               end if
               difference = difference - [exact(1, 1), exact(2, 2), exact(1, 2)]
               element(cell) = element(cell) + weights(point)*determinant &
                               *(difference(1)**2 + difference(2)**2 + 2.0_rk*difference(3)**2 &
                                 - share*(difference(1) + difference(2))**2) &
                               /(2.0_rk*rock%shear_modulus())
            end do
         end associate
      end do
      element = sqrt(element)
   end function true_errors

   !> Nodal forces that balance the loads and the stresses: reactions of prescribed displacements
   !! and of tied faces, zero up to rounding elsewhere.
   pure function reactions(model, loads, displacement) result(force)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), allocatable :: force(:, :)  !< (2, n_nodes) [N/m]
      integer(ik) :: cell

      force = -model%external_forces(loads)
      do cell = 1, model%mesh%n_cells
         associate (nodes => model%mesh%cell_nodes(:, cell))
            force(:, nodes) = force(:, nodes) + model%element_forces(displacement, cell)
         end associate
      end do
   end function reactions

end module exact_fields
