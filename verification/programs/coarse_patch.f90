!> Patch tests of the finite volumes on distorted triangles (verification/patch_tests).
!!
!! Arguments: mesh size [m], distortion as a share of the shortest edge. The fields are linear, so
!! that the discretization must reproduce them to round-off.
program coarse_patch
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_fields, only: cell_stresses
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use mesh_types, only: mesh_t
   use scene_types, only: initial_t, scene_t
   use verification_files, only: finish, real_argument, stop_on, table_t
   use verification_meshes, only: cell_centre, distort, plain_rectangle, turn
   implicit none(type, external)

   real(rk), parameter :: young = 4.0e10_rk, poisson = 0.2_rk, biot = 0.8_rk
   real(rk), parameter :: pore_pressure = 5.0e6_rk
   real(rk), parameter :: side_length = 2.0_rk  ! [m]
   type(table_t) :: table
   real(rk) :: found(7)
   type(mesh_t) :: mesh

   call table%open("errors.csv", "biaxial_displacement,biaxial_stress,shear_displacement," &
                   //"shear_stress,uniform_pressure,linear_pressure,linear_flux")
   call elastic([1.0e-4_rk, -3.0e-4_rk, 0.0_rk], found(1), found(2), found(5))
   call elastic([0.0_rk, 0.0_rk, 4.0e-4_rk], found(3), found(4), found(5))
   call flow(found(6), found(7))
   call table%row(found)
   call table%close()
   call finish()

contains

   subroutine rock(scene)
      type(scene_t), intent(inout) :: scene

      scene%material%young = young
      scene%material%poisson = poisson
      scene%material%biot = biot
      scene%material%porosity = 0.01_rk
      scene%material%permeability_xx = 1.0e-15_rk
      scene%material%permeability_yy = 1.0e-15_rk
      scene%fluid%compressibility = 4.0e-10_rk
      scene%fluid%viscosity = 1.0e-4_rk
   end subroutine rock

   subroutine solve(scene, mesh, model, state)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(inout) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state
      type(timers_t) :: timers
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      integer(ik) :: step

      allocate (model%cells%law(0), model%cells%residual_aperture(0), model%cells%injection(0))
      call model%set_mesh(mesh, scene, timers, error)
      call stop_on(error)
      call new_state(mesh, model%cells, initial_t(), model, state)
      do step = 1, 4  ! each leaves a millionth of what is not steady
         call model%advance(mesh, 1.0e6_rk, state, timers, report, error)
         call stop_on(error)
      end do
   end subroutine solve

   !> u = (e_x x + g y, e_y y) with a uniform pressure held on all sides. Either e or g is zero:
   !! then every side has uniform data.
   subroutine elastic(strain, displacement_error, stress_error, pressure_error)
      real(rk), intent(in) :: strain(3)  !< e_x, e_y, g
      real(rk), intent(out) :: displacement_error, stress_error, pressure_error  !< relative
      type(scene_t) :: scene
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: stresses(:, :)
      real(rk) :: shear, lame, stress(3), centre(2)
      integer(ik) :: c, side

      call rock(scene)
      shear = young/(2.0_rk*(1.0_rk + poisson))
      lame = young*poisson/((1.0_rk + poisson)*(1.0_rk - 2.0_rk*poisson))
      stress(1:2) = 2.0_rk*shear*strain(1:2) + lame*sum(strain(1:2)) - biot*pore_pressure
      stress(3) = shear*strain(3)
      do side = 1, 4
         scene%sides(side)%pressure_given = .true.
         scene%sides(side)%pressure = pore_pressure
      end do
      scene%sides(3)%displacement_given(2) = .true.
      scene%sides(4)%displacement_given(2) = .true.
      scene%sides(4)%displacement(2) = strain(2)*side_length
      if (abs(strain(3)) > 0.0_rk) then
         scene%sides(3:4)%displacement_given(1) = .true.
         scene%sides(4)%displacement(1) = strain(3)*side_length
         scene%sides(1)%traction = -[stress(1), stress(3)]
         scene%sides(2)%traction = [stress(1), stress(3)]
      else
         scene%sides(1:2)%displacement_given(1) = .true.
         scene%sides(2)%displacement(1) = strain(1)*side_length
      end if
      call plain_rectangle(side_length, side_length, real_argument(1), mesh)
      call distort(real_argument(2), mesh)
      call solve(scene, mesh, model, state)
      allocate (stresses(3, mesh%n_cells))
      call cell_stresses(mesh, model%regions, state%tractions, stresses)
      displacement_error = 0.0_rk
      do c = 1, mesh%n_cells
         centre = cell_centre(mesh, c)
         displacement_error = max(displacement_error, maxval(abs(state%unknowns(1:2, c) &
                               - [strain(1)*centre(1) + strain(3)*centre(2), strain(2)*centre(2)])))
      end do
      displacement_error = displacement_error/(side_length*maxval(abs(strain)))
      stress_error = maxval(abs(stresses - spread(stress, 2, mesh%n_cells)))/maxval(abs(stress))
      pressure_error = maxval(abs(state%unknowns(3, :mesh%n_cells)/pore_pressure - 1.0_rk))
   end subroutine elastic

   !> Steady flow with a full permeability tensor. The body is turned by 30 degrees and the
   !! principal axes of the permeability with it: the pressure is linear between the two sides that
   !! hold it, and the other two are streamlines.
   subroutine flow(pressure_error, flux_error)
      real(rk), intent(out) :: pressure_error, flux_error  !< relative
      real(rk), parameter :: angle = pi/6.0_rk
      real(rk), parameter :: along = 5.0e-14_rk, across = 2.0e-16_rk  ! [m2]
      type(scene_t) :: scene
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: exact, inflow, centre(2)
      integer(ik) :: c

      call rock(scene)
      scene%material%permeability_xx = along*cos(angle)**2 + across*sin(angle)**2
      scene%material%permeability_yy = along*sin(angle)**2 + across*cos(angle)**2
      scene%material%permeability_xy = (along - across)*sin(angle)*cos(angle)
      scene%sides(1:2)%pressure_given = .true.
      scene%sides(1)%pressure = pore_pressure
      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(3)%displacement_given(2) = .true.
      call plain_rectangle(side_length, side_length, real_argument(1), mesh)
      call distort(real_argument(2), mesh)
      call turn(angle, mesh)
      call solve(scene, mesh, model, state)
      pressure_error = 0.0_rk
      do c = 1, mesh%n_cells
         centre = cell_centre(mesh, c)
         exact = pore_pressure*(1.0_rk - dot_product(centre, [cos(angle), sin(angle)])/side_length)
         pressure_error = max(pressure_error, abs(state%unknowns(3, c) - exact)/pore_pressure)
      end do
      call inflow_of(mesh, model, state, inflow)
      flux_error = abs(inflow*scene%fluid%viscosity/(along*pore_pressure) - 1.0_rk)
   end subroutine flow

   !> Fluid that enters through side 1 [m2/s].
   subroutine inflow_of(mesh, model, state, inflow)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(rk), intent(out) :: inflow
      real(rk), allocatable :: fluxes(:)
      integer(ik) :: f, j, r

      inflow = 0.0_rk
      associate (regions => model%regions)
         do r = 1, regions%n_regions
            allocate (fluxes(regions%flow_faces%length(r)))
            call regions%flux(r)%apply(state%unknowns(3, regions%blocks%of(r)), fluxes)
            do j = 1, size(fluxes)
               f = regions%flow_faces%at(r, j)
               if (mesh%face_side(f) /= 1) cycle
               inflow = inflow - 0.5_rk*fluxes(j)*norm2(mesh%xy(:, mesh%face_nodes(2, f)) &
                                                        - mesh%xy(:, mesh%face_nodes(1, f)))
            end do
            deallocate (fluxes)
         end do
      end associate
   end subroutine inflow_of

end program coarse_patch
