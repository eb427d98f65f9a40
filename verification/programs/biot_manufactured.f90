!> Manufactured solution of Biot's equations in the unit square (verification/biot_manufactured).
!!
!! Arguments: mesh size [m], Poisson's ratio, permeability [m2], storage (1: with, 0: none).
!! Displacement and pressure vanish on all sides and grow linearly in time, for which backward
!! Euler is exact: what is left is the error in space.
program biot_manufactured
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_fields, only: cell_stresses
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use fine_element, only: triangle_rule_7
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use scene_types, only: initial_t, scene_t
   use verification_files, only: finish, integer_argument, real_argument, stop_on, table_t
   use verification_meshes, only: cell_centre, plain_rectangle
   implicit none(type, external)

   real(rk), parameter :: young = 1.0e9_rk  ! E [Pa]
   real(rk), parameter :: viscosity = 1.0e-3_rk  ! mu [Pa s]
   real(rk), parameter :: length = 1.0e-3_rk  ! displacement per second [m/s]
   real(rk), parameter :: pressure = 1.0e7_rk  ! pressure per second [Pa/s]
   integer(ik), parameter :: n_steps = 2
   real(rk), parameter :: dt = 0.5_rk  ! [s]
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   type(coarse_model_t) :: model
   type(state_t) :: state
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(error_t), allocatable :: error
   type(table_t) :: table
   real(rk), allocatable :: stresses(:, :)
   real(rk) :: error_of(3), norm(3), size, area, mass_error, exact(3), stress(3)
   integer(ik) :: c, side, step
   logical :: with_storage

   size = real_argument(1)
   with_storage = integer_argument(4) == 1
   scene%material%young = young
   scene%material%poisson = real_argument(2)
   scene%material%biot = 1.0_rk
   scene%material%porosity = 0.2_rk
   scene%material%permeability_xx = real_argument(3)
   scene%material%permeability_yy = real_argument(3)
   ! The textbook's storage with alpha = 1 is that of the fluid alone: none if it is incompressible.
   scene%material%storage = "textbook"
   scene%fluid%viscosity = viscosity
   scene%fluid%compressibility = merge(4.0e-10_rk, 0.0_rk, with_storage)
   do side = 1, 4
      scene%sides(side)%displacement_given = .true.
      scene%sides(side)%pressure_given = .true.
   end do

   call plain_rectangle(1.0_rk, 1.0_rk, size, mesh)
   allocate (model%cells%law(0), model%cells%residual_aperture(0), model%cells%injection(0))
   call model%set_mesh(mesh, scene, timers, error)
   call stop_on(error)
   call new_state(mesh, model%cells, initial_t(), model, state)
   allocate (model%source(3, mesh%n_cells))
   mass_error = 0.0_rk
   do step = 1, n_steps
      call set_source(step*dt)
      call model%advance(mesh, dt, state, timers, report, error)
      call stop_on(error)
      mass_error = max(mass_error, abs(report%mass_error))
   end do

   allocate (stresses(3, mesh%n_cells))
   call cell_stresses(mesh, model%regions, state%tractions, stresses)
   error_of = 0.0_rk
   norm = 0.0_rk
   do c = 1, mesh%n_cells
      area = cell_area(mesh, c)
      call solution(cell_centre(mesh, c), exact, stress)
      error_of(1) = error_of(1) + area*sum((state%unknowns(1:2, c) - exact(1:2))**2)
      norm(1) = norm(1) + area*sum(exact(1:2)**2)
      error_of(2) = error_of(2) + area*(state%unknowns(3, c) - exact(3))**2
      norm(2) = norm(2) + area*exact(3)**2
 error_of(3) = error_of(3) + area*sum(([1.0_rk, 1.0_rk, sqrt(2.0_rk)]*(stresses(:, c) - stress))**2)
      norm(3) = norm(3) + area*sum(([1.0_rk, 1.0_rk, sqrt(2.0_rk)]*stress)**2)
   end do
   error_of = sqrt(error_of/norm)
   call table%open("errors.csv", "displacement_l2,pressure_l2,stress_l2,pressure_extreme," &
                   //"mass_error_m2,cells")
   call table%row([error_of, maxval(abs(state%unknowns(3, :mesh%n_cells)))/pressure, mass_error, &
                   real(mesh%n_cells, rk)])
   call table%close()
   call finish()

contains

   !> Body force and fluid source, integrated over each cell.
   subroutine set_source(time)
      real(rk), intent(in) :: time
      real(rk) :: points(3, 7), weights(7)
      integer(ik) :: cell, point

      call triangle_rule_7(points, weights)
      do cell = 1, mesh%n_cells
         model%source(:, cell) = 0.0_rk
         do point = 1, 7
       model%source(:, cell) = model%source(:, cell) + 2.0_rk*cell_area(mesh, cell)*weights(point) &
                      *density(matmul(mesh%xy(:, mesh%cell_nodes(:, cell)), points(:, point)), time)
         end do
      end do
   end subroutine set_source

   !> With G the shear modulus, lambda Lame's constant, r = lambda/G, s = sin(pi x) sin(pi y)/(1 +
   !! r): u_x = U t ((cos(2 pi x) - 1) sin(2 pi y) + s), u_y = U t ((1 - cos(2 pi y)) sin(2 pi x) +
   !! s), p = P t sin(pi x) sin(pi y). The first part is free of divergence, so that the stress
   !! stays bounded as nu -> 1/2 (after Brenner 1993). Values at t = 1 s.
   pure subroutine solution(xy, values, stress)
      real(rk), intent(in) :: xy(2)
      real(rk), intent(out) :: values(3)  !< u_x, u_y [m], p [Pa]
      real(rk), intent(out) :: stress(3)  !< total, xx, yy, xy [Pa]
      real(rk) :: s, slope(2), gradient(2, 2), divergence

      associate (x => pi*xy(1), y => pi*xy(2), &
                 share => 1.0_rk/(1.0_rk + model%rock%lame(1)/model%rock%shear(1)))
         s = share*sin(x)*sin(y)
         slope = pi*share*[cos(x)*sin(y), sin(x)*cos(y)]
         values(1) = length*((cos(2.0_rk*x) - 1.0_rk)*sin(2.0_rk*y) + s)
         values(2) = length*((1.0_rk - cos(2.0_rk*y))*sin(2.0_rk*x) + s)
         values(3) = pressure*sin(x)*sin(y)
         gradient(1, 1) = length*(-2.0_rk*pi*sin(2.0_rk*x)*sin(2.0_rk*y) + slope(1))
         gradient(1, 2) = length*(2.0_rk*pi*(cos(2.0_rk*x) - 1.0_rk)*cos(2.0_rk*y) + slope(2))
         gradient(2, 1) = length*(2.0_rk*pi*(1.0_rk - cos(2.0_rk*y))*cos(2.0_rk*x) + slope(1))
         gradient(2, 2) = length*(2.0_rk*pi*sin(2.0_rk*y)*sin(2.0_rk*x) + slope(2))
      end associate
      divergence = gradient(1, 1) + gradient(2, 2)
   stress(1) = 2.0_rk*model%rock%shear(1)*gradient(1, 1) + model%rock%lame(1)*divergence - values(3)
   stress(2) = 2.0_rk*model%rock%shear(1)*gradient(2, 2) + model%rock%lame(1)*divergence - values(3)
      stress(3) = model%rock%shear(1)*(gradient(1, 2) + gradient(2, 1))
   end subroutine solution

   !> b = -G lap u - (lambda + G) grad div u + grad p [N/m3] (alpha = 1), and
   !! q0 = d(div u)/dt + S dp/dt - (k/mu) lap p [1/s].
   pure function density(xy, time)
      real(rk), intent(in) :: xy(2)
      real(rk), intent(in) :: time  !< [s]
      real(rk) :: density(3)
      real(rk) :: laplacian(2), gradient(2), s

      associate (x => pi*xy(1), y => pi*xy(2), rock => model%rock, &
                 share => 1.0_rk/(1.0_rk + model%rock%lame(1)/model%rock%shear(1)))
         s = sin(x)*sin(y)
         laplacian(1) = -4.0_rk*pi**2*(2.0_rk*cos(2.0_rk*x) - 1.0_rk)*sin(2.0_rk*y)
         laplacian(2) = -4.0_rk*pi**2*(1.0_rk - 2.0_rk*cos(2.0_rk*y))*sin(2.0_rk*x)
         laplacian = laplacian - 2.0_rk*pi**2*share*s
         ! div u = U t pi share (cos x sin y + sin x cos y) = U t pi share sin(x + y)
         gradient = pi**2*share*cos(x + y)
        density(1:2) = -length*(rock%shear(1)*laplacian + (rock%lame(1) + rock%shear(1))*gradient) &
                        + pressure*pi*[cos(x)*sin(y), sin(x)*cos(y)]
         density(1:2) = time*density(1:2)
         density(3) = length*pi*share*sin(x + y) + rock%storage(1)*pressure*s &
                      + time*rock%permeability(1, 1)/viscosity*2.0_rk*pi**2*pressure*s
      end associate
   end function density

end program biot_manufactured
