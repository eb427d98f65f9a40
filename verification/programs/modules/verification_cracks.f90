!> Fine-level problems of cracks for the programs of verification cases: mesh, solve, list the tips.
module verification_cracks
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: uniform_field
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t
   use fine_loads, only: fine_loads_t
   use fine_model, only: fine_model_t
   use fine_tip_intensity, only: intensity_of_tip
   use fine_tip_types, only: intensity_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use verification_files, only: stop_on, table_t
   implicit none(type, external)
   private

   public :: line_stress, mesh_window, rock, set_remote, write_faces, write_tips

   !> The rock of Paper C; Biot's coefficient does not matter without pore pressure.
   type(elasticity_t), parameter :: rock = elasticity_t(4.0e10_rk, 0.2_rk, 1.0_rk, .false.)

contains

   !> A square window around the origin with rosettes of one element size at the tips.
   subroutine mesh_window(network, half_width, size, size_boundary, sectors, model)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: half_width, size, size_boundary  !< [m]
      integer(ik), intent(in) :: sectors  !< elements around each tip
      type(fine_model_t), intent(inout) :: model
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(error_t), allocatable :: error

      call build_mesh(mesh_spec_t(-half_width, half_width, -half_width, half_width, size, &
                                size_boundary, .true., sectors, size), network, mesher, mesh, error)
      call stop_on(error)
      call model%set_mesh(mesh, rock, error)
      call stop_on(error)
   end subroutine mesh_window

   !> Displacement of a uniform stress on the window's edge.
   subroutine set_remote(model, stress, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy [Pa]
      type(fine_loads_t), intent(inout) :: loads
      integer(ik) :: node

      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = uniform_field(rock, stress, model%mesh%xy(:, node))
      end do
   end subroutine set_remote

   !> Normal and shear stress of a uniform stress on a line at an angle to the x axis.
   pure subroutine line_stress(angle, stress, normal, shear)
      real(rk), intent(in) :: angle  !< [rad]
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy [Pa]
      real(rk), intent(out) :: normal, shear  !< [Pa]

      normal = stress(1)*sin(angle)**2 + stress(2)*cos(angle)**2 &
               - 2.0_rk*stress(3)*sin(angle)*cos(angle)
      shear = (stress(2) - stress(1))*sin(angle)*cos(angle) &
              + stress(3)*(cos(angle)**2 - sin(angle)**2)
   end subroutine line_stress

   !> Solve, and write tips.csv: a row per tip, in the order of the mesh.
   subroutine write_tips(model, conditions, loads, scale, displacement)
      type(fine_model_t), intent(inout) :: model
      type(face_conditions_t), intent(in) :: conditions
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: scale  !< unit of the intensities [Pa m^1/2]
      real(rk), allocatable, intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(intensity_t) :: intensity
      type(error_t), allocatable :: error
      type(table_t) :: table
      integer(ik) :: tip

      call model%prepare(conditions, error)
      call stop_on(error)
      call model%solve(loads, displacement, error)
      call stop_on(error)
   call table%open("tips.csv", "tip,fracture,end,x_m,y_m,k1,k2,k1_dc,k2_dc,k1_inner,k2_inner,cells")
      do tip = 1, model%mesh%fracture%n_tips
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call stop_on(error)
         associate (fracture => model%mesh%fracture)
            call table%row([real(tip, rk), real(fracture%tip_fracture(tip), rk), &
                            real(fracture%tip_end(tip), rk), &
                            model%mesh%xy(:, fracture%tip_node(tip)), &
                            [intensity%k1, intensity%k2, intensity%k1_dc, intensity%k2_dc, &
                       intensity%k1_inner, intensity%k2_inner]/scale, real(model%mesh%n_cells, rk)])
         end associate
      end do
      call table%close()
   end subroutine write_tips

   !> faces.csv: the jump at the nodes of all fracture cells.
   subroutine write_faces(model, displacement)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(table_t) :: table
      real(rk) :: jump(2), tau(2)
      integer(ik) :: cell, j, k
      integer(ik), parameter :: order(3) = [1_ik, 3_ik, 2_ik]  ! start, middle, end

      call table%open("faces.csv", "fracture,s_m,jump_n_m,jump_t_m")
      do cell = 1, model%mesh%fracture%n_cells
         tau = model%mesh%face_tangent(:, cell)
         do j = 1, 3
            k = order(j)
            ! The start of a cell is the end of the one before it.
            if (k == 1 .and. cell > 1) then
               if (model%mesh%fracture%cell_fracture(cell) &
                   == model%mesh%fracture%cell_fracture(cell - 1)) cycle
            end if
            jump = displacement(:, model%mesh%face_nodes(k, 2, cell)) &
                   - displacement(:, model%mesh%face_nodes(k, 1, cell))
            call table%row([real(model%mesh%fracture%cell_fracture(cell), rk), &
                            model%mesh%face_s(k, cell), dot_product(jump, [-tau(2), tau(1)]), &
                            dot_product(jump, tau)])
         end do
      end do
      call table%close()
   end subroutine write_faces

end module verification_cracks
