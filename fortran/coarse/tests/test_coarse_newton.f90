!> Newton's method on the fractures: the cubic law, pressure equilibrium, quadratic convergence, and
!! steps that are refused.
program test_coarse_newton
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t, state_open, state_stick
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, cut_square, hold, porous_body, set_permeability
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: inside(2, 2) = reshape([0.7_rk, 0.8_rk, 1.3_rk, 1.2_rk], [2, 2])
   real(rk), parameter :: opening_rate = 2.0e-5_rk  !< Q that opens a fracture [m2/s] ...
   real(rk), parameter :: opening_time = 20.0_rk  !< ... within this time [s]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(step_report_t) :: report
   type(scene_t) :: scene
   type(timers_t) :: timers

   call test_cubic_law()
   call test_pressure_spreads()
   call test_quadratic_convergence()
   call test_refused_steps()
   call test_vapour()
   call checks%finish()

contains

   !> Steady flow along a closed fracture in tight rock: dp/ds = -12 mu Q/a^3 (catalogue 4.10).
   subroutine test_cubic_law()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: aperture = 1.0e-5_rk, rate = 1.0e-7_rk
      real(rk) :: slope
      integer(ik) :: i, n, step

      scene = porous_body()
      call hold(scene, [-30.0e6_rk, -30.0e6_rk])
      call set_permeability(scene, 1.0e-30_rk)
      scene%discretization%newton_tolerance = 1.0e-13_rk
      call cut_square(checks, scene, inside, contact_law_t(friction=5.0_rk, dilation=0.0_rk), &
                      aperture, mesh, model, state)
      call model%equilibrate(mesh, 1.0_rk, state, timers, report, error)
      n = mesh%fracture%n_cells
      model%cells%injection([1_ik, n]) = [rate, -rate]
      do step = 1, 3
         call advance(checks, model, mesh, 1.0_rk, state, report, "flow along a fracture")
      end do
      call checks%is_true(all(state%contact == state_stick), "the fracture stays closed")
      slope = 12.0_rk*scene%fluid%viscosity*rate/aperture**3
      do i = 2, n
         associate (s => 0.5_rk*sum(mesh%fracture%cell_s(:, i - 1:i), dim=1))
            call checks%is_close((state%pressure(i - 1) - state%pressure(i))/(s(2) - s(1)), &
                                 slope, 1.0e-6_rk*slope, "cubic law")
         end associate
      end do
   end subroutine test_cubic_law

   !> Fluid let into a closed fracture spreads through a sealed, loaded body until the pressure is
   !! the same everywhere: its rise follows from the storage at constant stress and the fracture's
   !! own.
   subroutine test_pressure_spreads()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: aperture = 1.0e-3_rk, rate = 1.0e-6_rk, dt = 10.0_rk
      real(rk) :: before, capacity, plane_bulk, rise
      integer(ik) :: i

      scene = porous_body()
      call set_permeability(scene, 1.0e-15_rk)
      call hold(scene, [-30.0e6_rk, -25.0e6_rk])
      call cut_square(checks, scene, inside, contact_law_t(friction=5.0_rk, dilation=0.0_rk), &
                      aperture, mesh, model, state)
      call model%equilibrate(mesh, 1.0e-6_rk, state, timers, report, error)
      call checks%no_error(error, "initial state")
      before = state%pressure(1)
      ! Nothing happens by itself.
      do i = 1, 3
         call advance(checks, model, mesh, 1.0e3_rk, state, report, "rest")
         call checks%is_close(maxval(abs(state%pressure - before)), 0.0_rk, 1.0e-8_rk*before, &
                              "rest: fracture pressure")
         call checks%is_close(maxval(abs(state%unknowns(3, :) - before)), 0.0_rk, &
                              1.0e-8_rk*before, "rest: pressure")
         call checks%is_close(maxval(abs(state%jump)), 0.0_rk, 1.0e-14_rk, "rest: no jump")
      end do
      model%cells%injection(2) = rate
      call advance(checks, model, mesh, dt, state, report, "injection")
      model%cells%injection = 0.0_rk
      do i = 1, 5
         call advance(checks, model, mesh, 1.0e4_rk, state, report, "spreading")
      end do
      call checks%is_true(all(state%contact == state_stick), "closed throughout")
      ! lambda + G in plane strain, E/(2 (1 + nu)(1 - 2 nu)).
      associate (m => scene%material)
         plane_bulk = m%young/(2.0_rk*(1.0_rk + m%poisson)*(1.0_rk - 2.0_rk*m%poisson))
         capacity = 4.0_rk*(model%rock%storage(1) + m%biot**2/plane_bulk) &
                    + norm2(inside(:, 2) - inside(:, 1))*aperture*scene%fluid%compressibility
      end associate
      rise = rate*dt/capacity
      call checks%is_close(maxval(abs(state%pressure - before - rise)), 0.0_rk, 1.0e-6_rk*rise, &
                           "pressure rise in the fracture")
      call checks%is_close(maxval(abs(state%unknowns(3, :) - before - rise)), 0.0_rk, &
                           1.0e-6_rk*rise, "pressure rise in the rock")
   end subroutine test_pressure_spreads

   !> Rock so tight that fluid let into its fracture opens it.
   subroutine opening_scene(scene)
      type(scene_t), intent(out) :: scene

      scene = porous_body()
      call hold(scene, [-10.0e6_rk, -8.0e6_rk])
      call set_permeability(scene, 1.0e-18_rk)
   end subroutine opening_scene

   !> Viscous fluid opens a fracture from one end; then it is drawn off there, and the fracture
   !! closes again. Derivatives that are wrong anywhere would let the iteration converge slowly.
   subroutine test_quadratic_convergence()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state

      call opening_scene(scene)
      scene%fluid%viscosity = 0.02_rk
      call cut_square(checks, scene, inside, contact_law_t(friction=0.5_rk, dilation=0.02_rk), &
                      1.0e-4_rk, mesh, model, state)
      call model%equilibrate(mesh, 1.0_rk, state, timers, report, error)
      model%cells%injection(1) = opening_rate
      call converge(mesh, model, state, "opening")
      call checks%is_true(any(state%contact == state_open), "the fracture opens")
      call converge(mesh, model, state, "opening further")
      model%cells%injection(1) = -0.7_rk*opening_rate
      call converge(mesh, model, state, "closing")
      call converge(mesh, model, state, "closing further")
   end subroutine test_quadratic_convergence

   !> One step: eight more digits cost at most two more iterations, and the fluid is conserved.
   subroutine converge(mesh, model, state, name)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(inout) :: state
      character(len=*), intent(in) :: name
      type(state_t) :: before
      type(step_report_t) :: exact, rough
      type(error_t), allocatable :: error

      before = state
      model%settings%tolerance = 1.0e-3_rk
      call model%advance(mesh, opening_time, state, timers, rough, error)
      call checks%is_true(rough%converged, name//": three digits")
      state = before
      model%settings%tolerance = 1.0e-11_rk
      call model%advance(mesh, opening_time, state, timers, exact, error)
      call checks%is_true(exact%converged, name//": eleven digits")
      call checks%is_true(exact%iterations <= rough%iterations + 2, name//": quadratic convergence")
      print "(2a,2i4)", name, ", iterations to 1e-3 and to 1e-11:", rough%iterations, &
         exact%iterations
      associate (given => opening_time*sum(model%cells%injection), &
                 gained => balance(mesh, model, before, state))
         call checks%is_close(gained, given, 1.0e-9_rk*abs(given), name//": fluid")
         call checks%is_close(exact%mass_error, gained - given, 1.0e-12_rk*abs(given), &
                              name//": reported balance")
      end associate
   end subroutine converge

   !> A fracture in tight rock is pulled open, and closed again by fluid that is let in: it keeps
   !! its fluid, which fills the smaller a share of it the wider it is, at the vapour pressure; it
   !! is full again once what was let in is what it has opened by.
   subroutine test_vapour()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: aperture = 1.0e-5_rk, bearable = 1.0e5_rk, dt = 1.0_rk
      real(rk) :: held, total
      integer :: k

      call opening_scene(scene)
      call set_permeability(scene, 1.0e-30_rk)
      scene%fluid%compressibility = 0.0_rk
      scene%fluid%vapour_pressure = bearable
      scene%initial%pressure = 2.0e5_rk
      scene%sides(2)%traction(1) = 20.0e6_rk
      scene%sides(4)%traction(2) = 20.0e6_rk
      call cut_square(checks, scene, inside, contact_law_t(friction=0.5_rk, dilation=0.0_rk), &
                      aperture, mesh, model, state)
      total = norm2(inside(:, 2) - inside(:, 1))*aperture
      do k = 0, 3
         if (k > 0) model%cells%injection(2) = total
         call model%advance(mesh, dt, state, timers, report, error)
         call checks%no_error(error, "vapour")
         if (.not. report%converged) print *, report%reason, report%iterations
         call checks%is_true(report%converged, "vapour: converged")
         held = sum(model%condensed%length*(state%aperture - state%void))
         call checks%is_close(held, (1 + k)*total, 1.0e-9_rk*total, "vapour: fluid is kept")
         call checks%is_close(maxval(abs(state%pressure - bearable)), 0.0_rk, 0.0_rk, &
                              "vapour: pressure")
         call checks%is_true(all(state%void > 0.0_rk) .and. all(state%void < state%aperture), &
                             "vapour: filled in part")
         call checks%is_close(report%mass_error, 0.0_rk, 1.0e-9_rk*total, "vapour: balance")
      end do
      model%cells%injection(2) = sum(model%condensed%length*state%aperture)/dt
      call advance(checks, model, mesh, dt, state, report, "full: converged")
      call checks%is_true(all(state%void <= 0.0_rk) .and. all(state%pressure > bearable), "full")
      model%cells%injection(2) = -2.0_rk*sum(model%condensed%length*state%aperture)/dt
      call model%advance(mesh, dt, state, timers, report, error)
      call checks%is_true(.not. report%converged, "more is drawn than there is")
   end subroutine test_vapour

   !> Fluid that rock and fractures have gained in a step [m2].
   function balance(mesh, model, before, after) result(gain)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: before, after
      real(rk) :: gain
      integer(ik) :: i

      gain = sum(after%content - before%content)
      do i = 1, mesh%fracture%n_cells
         associate (length => mesh%fracture%cell_s(2, i) - mesh%fracture%cell_s(1, i))
            gain = gain + length*(after%aperture(i) - before%aperture(i) &
                                  + after%aperture(i)*model%settings%compressibility &
                                  *(after%pressure(i) - before%pressure(i)))
         end associate
      end do
   end function balance

   !> A step that does not converge, or leads to an impossible aperture, is reported and changes
   !! nothing.
   subroutine test_refused_steps()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: before, state

      call opening_scene(scene)
      call cut_square(checks, scene, inside, contact_law_t(friction=0.5_rk, dilation=0.02_rk), &
                      2.0e-5_rk, mesh, model, state)
      call model%equilibrate(mesh, 1.0_rk, state, timers, report, error)
      model%cells%injection(1) = opening_rate
      before = state
      model%settings%iterations_max = 1
      call refuse(mesh, model, before, .false., "did not converge")
      model%settings%iterations_max = 30
      model%cells%residual_aperture = -1.0e-3_rk
      call refuse(mesh, model, before, .true., "aperture")
      model%cells%residual_aperture = 2.0e-5_rk
      call advance(checks, model, mesh, opening_time, state, report, &
                   "with the right values it goes on")
      call checks%is_true(.not. same(before, state), "and changes the state")
   end subroutine test_refused_steps

   subroutine refuse(mesh, model, before, equilibrates, words)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(in) :: before
      logical, intent(in) :: equilibrates
      character(len=*), intent(in) :: words  !< part of the reason
      type(state_t) :: state
      type(step_report_t) :: report
      type(error_t), allocatable :: error

      state = before
      if (equilibrates) then
         call model%equilibrate(mesh, opening_time, state, timers, report, error)
      else
         call model%advance(mesh, opening_time, state, timers, report, error)
      end if
      call checks%no_error(error, "a step that is refused is no error: "//words)
      call checks%is_true(.not. report%converged, "refused: "//words)
      call checks%is_true(allocated(report%reason), "there is a reason: "//words)
      if (allocated(report%reason)) call checks%is_true(index(report%reason, words) > 0, &
                                                        words//": "//report%reason)
      call checks%is_true(same(before, state), "nothing changes: "//words)
   end subroutine refuse

   !> Every value is exactly the same.
   pure function same(a, b)
      type(state_t), intent(in) :: a, b
      logical :: same

      same = .not. (abs(a%time - b%time) > 0.0_rk &
                    .or. any(abs(a%unknowns - b%unknowns) > 0.0_rk) &
                    .or. any(abs(a%content - b%content) > 0.0_rk) &
                    .or. any(abs(a%jump - b%jump) > 0.0_rk) &
                    .or. any(abs(a%traction - b%traction) > 0.0_rk) &
                    .or. any(abs(a%pressure - b%pressure) > 0.0_rk) &
                    .or. any(abs(a%aperture - b%aperture) > 0.0_rk) &
                    .or. any(abs(a%leakoff - b%leakoff) > 0.0_rk) .or. any(a%contact /= b%contact))
   end function same

end program test_coarse_newton
