!> Face laws of a scene: a pressure on the faces does what the opposite stress in the body does
!! (superposition, exact on any mesh), faces held closed slide and do not part, their wings do.
program test_mechanics_faces
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use mechanics_rise, only: rise
   use mechanics_simulation, only: mechanics_simulation_t
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: exact = 1.0e-9_rk
   real(rk), parameter :: quadrature = 1.0e-6_rk  !< of the integrals' singular auxiliary fields
   real(rk), parameter :: pressure = 3.0_rk  !< [Pa]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(scene_t) :: scene

   call compare("open", [0.0_rk, 0.0_rk])
   call compare("frictionless", [-9.0_rk, -4.0_rk])
   call compare("friction", [-12.0_rk, -4.0_rk])
   call closed_under_tension()
   call wings_of_a_closed_crack()
   call checks%finish()

contains

   !> A plate of 2 m with a crack of 0.4 m at 30 degrees under stresses in x and y.
   function plate(law, stress) result(scene)
      character(len=*), intent(in) :: law
      real(rk), intent(in) :: stress(2)  !< xx, yy [Pa]
      type(scene_t) :: scene

      scene%domain%x_min = -1.0_rk
      scene%domain%x_max = 1.0_rk
      scene%domain%y_min = -1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%material%young = 1.0e9_rk
      scene%material%poisson = 0.25_rk
      allocate (scene%fractures(1), scene%point_loads(0))
      scene%fractures(1) = fracture_t(name="f", law=law, friction=0.2_rk, &
                                      x=0.2_rk*cos(0.5236_rk)*[-1, 1], &
                                      y=0.2_rk*sin(0.5236_rk)*[-1, 1])
      scene%restraints = [restraint_t(x=-1.0_rk, y=-1.0_rk, displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, y=-1.0_rk, displacement_given=[.false., .true.])]
      scene%sides(1)%traction = [-stress(1), 0.0_rk]
      scene%sides(2)%traction = [stress(1), 0.0_rk]
      scene%sides(3)%traction = [0.0_rk, -stress(2)]
      scene%sides(4)%traction = [0.0_rk, stress(2)]
      scene%discretization%size_fracture = 0.03_rk
      scene%discretization%size_boundary = 0.3_rk
      scene%growth%intensities = .true.
      call resolve_defaults(scene)
   end function plate

   !> The scene at a load factor.
   subroutine respond(name, scene, factor, simulation)
      character(len=*), intent(in) :: name
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: factor  !< [-]
      type(mechanics_simulation_t), intent(inout) :: simulation

      call timers%begin()
      call simulation%begin(scene, timers, error)
      if (.not. allocated(error)) call simulation%respond(factor, timers, error)
      call checks%no_error(error, name)
   end subroutine respond

   !> A pressure on the faces, and the same tension in all directions instead.
   subroutine compare(law, stress)
      character(len=*), intent(in) :: law
      real(rk), intent(in) :: stress(2)  !< xx, yy [Pa]
      real(rk), parameter :: factor = 2.5_rk
      type(mechanics_simulation_t) :: pressed, pulled
      real(rk) :: largest

      scene = plate(law, stress)
      scene%fractures(1)%face_pressure = pressure
      call respond(law//": with a pressure", scene, factor, pressed)
      call respond(law//": with a tension", plate(law, stress + pressure), factor, pulled)
      largest = maxval(hypot(pulled%tip%intensity%k1, pulled%tip%intensity%k2))
      call checks%is_true(largest > 0.1_rk, law//": the tips are loaded")
      associate (a => pressed%tip%intensity, b => pulled%tip%intensity)
         call checks%is_close(maxval(abs([a%k1_dc - b%k1_dc, a%k2_dc - b%k2_dc])), 0.0_rk, &
                              exact*largest, law//": intensities from the displacements")
         call checks%is_close(maxval(abs([a%k1 - b%k1, a%k2 - b%k2])), 0.0_rk, &
                              quadrature*largest, law//": intensities from the integral")
      end associate
      associate (a => pressed%body%contact, b => pulled%body%contact)
         call checks%is_close(maxval(abs(a%traction - b%traction)), 0.0_rk, exact*10.0_rk, &
                              law//": contact carries what the pressure leaves")
         call checks%is_close(maxval(abs(a%jump - b%jump)), 0.0_rk, &
                              exact*maxval(abs(b%jump)), law//": jumps")
      end associate
   end subroutine compare

   !> Faces that are held closed carry tension; others part.
   subroutine closed_under_tension()
      type(mechanics_simulation_t) :: held, free
      integer(ik), parameter :: tau = 1, n = 2

      scene = plate("frictionless", [0.0_rk, 5.0_rk])
      call respond("free to part", scene, 1.0_rk, free)
      scene%fractures(1)%held_closed = .true.
      call respond("held closed", scene, 1.0_rk, held)
      associate (jump => held%body%contact%jump)
         call checks%is_true(maxval(abs(jump(tau, :, :))) > 0.0_rk, "held closed: it slides")
         call checks%is_close(maxval(abs(jump(n, :, :))), 0.0_rk, &
                              1.0e-12_rk*maxval(abs(jump(tau, :, :))), "held closed: no opening")
      end associate
      call checks%is_true(maxval(free%body%contact%jump(n, :, :)) > 1.0e-10_rk, &
                          "free to part: it opens")
      call checks%is_true(minval(free%tip%intensity%k1) > 1.0_rk, "free to part: K_I")
      call checks%is_close(maxval(abs(held%tip%intensity%k1)), 0.0_rk, 0.0_rk, "held closed: K_I")
   end subroutine closed_under_tension

   !> Under compression wings grow from the ends of a closed crack, and open.
   subroutine wings_of_a_closed_crack()
      type(mechanics_simulation_t) :: simulation
      logical :: has_onset, any_grew
      real(rk) :: opening(2)
      integer(ik) :: cell

      scene = plate("friction", [-10.0_rk, 0.0_rk])
      scene%fractures(1)%held_closed = .true.
      scene%growth%enabled = .true.
      scene%growth%law = "paris"
      scene%material%toughness = 1.0_rk
      call timers%begin()
      call simulation%begin(scene, timers, error)
      if (.not. allocated(error)) call rise(simulation, 100.0_rk, has_onset, timers, error)
      if (.not. allocated(error)) call simulation%grow_tips(any_grew, timers, error)
      call checks%no_error(error, "wings of a closed crack")
      if (allocated(error)) return
      call checks%is_true(has_onset .and. any_grew, "wings grow")
      opening = 0.0_rk
      associate (fracture => simulation%body%mesh%fracture, &
                 jump => simulation%body%contact%jump(2, :, :))
         do cell = 1, fracture%n_cells
            if (minval(fracture%cell_s(:, cell)) > -1.0e-9_rk .and. &
                maxval(fracture%cell_s(:, cell)) < 0.4_rk + 1.0e-9_rk) then
               opening(1) = max(opening(1), maxval(abs(jump(:, cell))))
            else
               opening(2) = max(opening(2), jump(3, cell))
            end if
         end do
      end associate
      call checks%is_true(opening(2) > 1.0e-10_rk, "the wings open")
      call checks%is_close(opening(1), 0.0_rk, 1.0e-12_rk*opening(2), "the crack stays closed")
      call checks%is_true(minval(simulation%tip%intensity%k1) > 0.0_rk, "K_I of the wings")
   end subroutine wings_of_a_closed_crack

end program test_mechanics_faces
