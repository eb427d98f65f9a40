!> Mandel's problem: a slab between rigid frictionless plates (verification/mandel).
!!
!! Arguments: mesh size [m], time step as dT = c dt/a**2, storage (1: thesis, 2: textbook). One
!! quarter of the slab, 0 < x < a, 0 < y < b. The plate moves as a rigid body under the force F on
!! this quarter. Its displacement follows in every step by superposition: the equations without
!! fractures are linear, so one step with the plate at rest and one with the plate moved by 1 m
!! tell how far it has to move.
program coarse_mandel
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_regions, only: regions_t
   use coarse_state, only: state_t, step_report_t
   use mesh_types, only: mesh_t
   use scene_types, only: initial_t, scene_t
   use verification_files, only: finish, integer_argument, real_argument, stop_on, table_t
   use verification_meshes, only: cell_centre, plain_rectangle
   implicit none(type, external)

   real(rk), parameter :: a = 1.0_rk, b = 0.5_rk  ! half-width, half-height [m]
   real(rk), parameter :: force = 1.0e6_rk  ! F [N/m]
   real(rk), parameter :: places(3) = [0.0_rk, 0.5_rk, 0.8_rk]*a
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   type(coarse_model_t) :: rest, moved
   type(timers_t) :: timers
   type(error_t), allocatable :: error
   type(state_t) :: state
   type(table_t) :: table
   real(rk) :: diffusivity, dt, dt_relative, plate, drift
   integer(ik) :: step, n_steps

   dt_relative = real_argument(2)
   scene%material%young = 40.0e9_rk
   scene%material%poisson = 0.2_rk
   scene%material%biot = 0.8_rk
   scene%material%porosity = 0.01_rk
   scene%material%permeability_xx = 5.0e-20_rk
   scene%material%permeability_yy = 5.0e-20_rk
   if (integer_argument(3) == 2) scene%material%storage = "textbook"
   scene%fluid%compressibility = 4.0e-10_rk
   scene%fluid%viscosity = 1.0e-4_rk
   scene%sides(1)%displacement_given(1) = .true.
   scene%sides(2)%pressure_given = .true.
   scene%sides(3)%displacement_given(2) = .true.
   scene%sides(4)%displacement_given(2) = .true.
   call plain_rectangle(a, b, real_argument(1), mesh)
   call set_up(scene, rest)
   scene%sides(4)%displacement(2) = 1.0_rk
   call set_up(scene, moved)
   call new_state(mesh, rest%cells, initial_t(), rest, state)
   associate (rock => rest%rock)
      diffusivity = rock%mobility/(rock%storage(1) + rock%biot(1)**2 &
                                   /(rock%lame(1) + 2.0_rk*rock%shear(1)))
   end associate
   dt = dt_relative*a**2/diffusivity

   call table%open("history.csv", "t_relative,p_0,p_05,p_08,plate_relative,force_error")
   ! The undrained state: a step in which no fluid moves.
   call advance(1.0e-9_rk*dt)
   call write_row(0.0_rk)
   n_steps = nint(1.0_rk/dt_relative, ik)
   do step = 1, n_steps
      call advance(dt)
      call write_row(step*dt_relative)
   end do
   call table%close()
   call finish()

contains

   subroutine set_up(of_scene, model)
      type(scene_t), intent(in) :: of_scene
      type(coarse_model_t), intent(inout) :: model

      allocate (model%cells%law(0), model%cells%residual_aperture(0), model%cells%injection(0))
      call model%set_mesh(mesh, of_scene, timers, error)
      call stop_on(error)
   end subroutine set_up

   !> One step in which the plate carries the force.
   subroutine advance(step_length)
      real(rk), intent(in) :: step_length  !< [s]
      type(state_t) :: other
      type(step_report_t) :: report
      real(rk) :: at_rest, by_move

      other = state
      call rest%advance(mesh, step_length, state, timers, report, error)
      call stop_on(error)
      call moved%advance(mesh, step_length, other, timers, report, error)
      call stop_on(error)
      at_rest = plate_force(rest%regions, state)
      by_move = plate_force(moved%regions, other) - at_rest
      plate = (-force - at_rest)/by_move
      state%unknowns = state%unknowns + plate*(other%unknowns - state%unknowns)
      state%tractions = state%tractions + plate*(other%tractions - state%tractions)
      state%content = state%content + plate*(other%content - state%content)
      drift = abs(plate_force(rest%regions, state)/force + 1.0_rk)
   end subroutine advance

   !> Force of the plate on the slab in y [N/m].
   real(rk) function plate_force(regions, of_state)
      type(regions_t), intent(in) :: regions
      type(state_t), intent(in) :: of_state
      integer(ik) :: f, j, r

      plate_force = 0.0_rk
      do r = 1, regions%n_regions
         do j = 1, regions%faces%length(r)
            f = regions%faces%at(r, j)
            if (mesh%face_side(f) /= 4) cycle
            plate_force = plate_force + 0.5_rk*norm2(mesh%xy(:, mesh%face_nodes(2, f)) &
                                                     - mesh%xy(:, mesh%face_nodes(1, f))) &
                          *of_state%tractions(regions%at_traction(r, f) + 1)
         end do
      end do
   end function plate_force

   !> Pressure at the places, by the least-squares line through the cells within one and a half mesh
   !! sizes of x (the solution does not depend on y), the plate's displacement, the error of the
   !! force.
   subroutine write_row(time)
      real(rk), intent(in) :: time  !< T = c t/a**2
      real(rk) :: p(size(places)), weight(5), x, reach
      integer(ik) :: c, i

      reach = 1.5_rk*real_argument(1)
      do i = 1, size(places, kind=ik)
         weight = 0.0_rk
         do c = 1, mesh%n_cells
            associate (centre => cell_centre(mesh, c))
               x = centre(1) - places(i)
            end associate
            if (i == 1) x = x**2  ! even in x: a line in x**2
            if (abs(x) > merge(reach**2, reach, i == 1)) cycle
            weight = weight + [1.0_rk, x, x**2, state%unknowns(3, c), x*state%unknowns(3, c)]
         end do
         p(i) = (weight(3)*weight(4) - weight(2)*weight(5))/(weight(1)*weight(3) - weight(2)**2)
      end do
      call table%row([time, p*a/force, -plate*rest%rock%shear(1)*a/(force*b), drift])
   end subroutine write_row

end program coarse_mandel
