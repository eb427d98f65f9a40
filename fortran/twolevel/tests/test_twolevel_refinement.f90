!> Windows that are too small for their tips: the errors of the intensities are stated as large, the
!! windows are enlarged, and the intensities are right then; an accurate window stays as it is.
!!
!! One crack of 0.1 m at 45 degrees, closed and slipping, in a body of 2 m under 20 and 10 MPa whose
!! fluid keeps its pressure: K_II = (tau - mu (sigma_n - p)) sqrt(pi a), in an infinite plane.
program test_twolevel_refinement
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use report_rows, only: event_growth_uncertain
   use twolevel_window_total, only: limit_windows
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: refinement_t
   use twolevel_refinement, only: find_refinements, growth_error, growth_error_t, is_uncertain, &
                                  note_uncertain_tips, refine_windows
   implicit none(type, external)

   real(rk), parameter :: a = 0.05_rk  !< half-length [m]
   real(rk), parameter :: pressure = 6.8e6_rk, friction = 0.5_rk
   real(rk), parameter :: known = (5.0e6_rk - friction*(15.0e6_rk - pressure)) &
                          *sqrt(pi*a)  !< K_II [Pa m^1/2]
   !> Relative difference of K of the body from that of an infinite one: a^2 over the square of its
   !! half-width of 1 m, times less than 1.
   real(rk), parameter :: finite = a**2
   real(rk), parameter :: usual_toughness = 4.2e5_rk  !< K_eq is 2 % below this toughness [Pa m^1/2]
   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_small_window(.true.)
   call test_small_window(.false.)
   call test_good_window()
   call test_poor_elements()
   call test_no_effect()
   call test_body()
   call test_many_windows()
   call checks%finish()

contains

   !> Evaluate the initial state with its errors.
   subroutine start(window, fine_ratio, simulation, toughness)
      real(rk), intent(in) :: window  !< [m]
      real(rk), intent(in) :: fine_ratio
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), parameter :: along = a*sqrt(0.5_rk)
      type(scene_t) :: scene
      type(step_report_t) :: report
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      scene%material%biot = 1.0e-6_rk
      scene%material%porosity = 1.0e-6_rk
      scene%material%toughness = toughness
      scene%fluid%compressibility = 1.0e-3_rk
      scene%initial%pressure = pressure
      scene%discretization%size_fracture = 0.02_rk
      scene%discretization%fine_ratio = fine_ratio
      scene%discretization%window = window
      call add_fracture(scene, "f", 1.0_rk + [-along, along], 1.0_rk + [-along, along], friction, &
                        0.0_rk)
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "begin")
      call simulation%equilibrate(timers, report, error)
      call checks%no_error(error, "initial state")
      call evaluate(simulation)
   end subroutine start

   subroutine evaluate(simulation)
      type(two_levels_t), intent(inout) :: simulation
      type(error_t), allocatable :: error

      call simulation%evaluate(timers, error)
      call checks%no_error(error, "tips")
      call estimate_coarse_errors(simulation, timers, error)
      call checks%no_error(error, "errors")
   end subroutine evaluate

   !> Refine the windows of uncertain tips.
   subroutine improve(simulation, any_improved)
      type(two_levels_t), intent(inout) :: simulation
      logical, intent(out) :: any_improved
      type(refinement_t), allocatable :: refinements(:)

      call find_refinements(simulation, 0.0_rk, refinements)
      any_improved = size(refinements) > 0
      call refine_windows(simulation, refinements)
   end subroutine improve

   !> Whether each tip's separate window has a mesh.
   function are_built(simulation)
      type(two_levels_t), intent(in) :: simulation
      logical :: are_built(2)
      integer :: i

      are_built = [(allocated(simulation%windows%slot(i)%window%made), i=1, 2)]
   end function are_built

   !> A window smaller than the coarse cell at its tip: K has a large error, which the comparison
   !! with the body shows; without this comparison there is no estimate. Then a larger window.
   subroutine test_small_window(has_reference)
      logical, intent(in) :: has_reference
      type(two_levels_t) :: simulation
      logical :: any_improved
      integer :: i
      real(rk) :: toughness  !< K_eq is 1 % above this toughness, within its error [Pa m^1/2]

      toughness = 0.97_rk*usual_toughness
      if (.not. has_reference) simulation%reference_most = 0
      call start(0.02_rk, 0.25_rk, simulation, toughness)
      associate (now => simulation%tip%intensity)
         call checks%is_true(all(abs(now%k2 - known) > 0.1_rk*known), "K is far off")
         call checks%is_true(all(now%k2_error > 0.99_rk*abs(now%k2 - known)), "by what is said")
         if (has_reference) then
            call checks%is_true(all(abs(now%k2_corrected - known) < 0.01_rk*known), "and mended")
         else
            call checks%is_true(all(now%k2_error > 0.9_rk*abs(now%k2)), "said to be unknown")
         end if
         call checks%is_true(all(now%k1_error <= 0.0_rk), "closed faces have no K_I all the same")
      end associate
      call checks%is_true(all([(is_uncertain(simulation%tip(i), simulation%now%segment(i), &
                                             simulation%network, toughness, &
                                             simulation%load_pressure), i=1, 2)]), &
                          "uncertain tips")
      call improve(simulation, any_improved)
      call checks%is_true(any_improved .and. .not. any(are_built(simulation)), "to be built")
      call checks%is_true(all([(simulation%windows%slot(i)%window%times_larger == 1, i=1, 2)]), &
                          "larger ones")
      call checks%is_true(size(simulation%chronicle%events) == 2, "an event for each")
      call evaluate(simulation)
      associate (now => simulation%tip%intensity)
         call checks%is_true(all(abs(now%k2 - known) < 0.02_rk*known), "K is right then")
         call checks%is_true(all(abs(now%k2 - known) <= now%k2_error + finite*known), &
                             "within its error")
      end associate
      call improve(simulation, any_improved)
      call checks%is_true(.not. any_improved, "that is enough")
   end subroutine test_small_window

   subroutine test_good_window()
      type(two_levels_t), save :: simulation
      logical :: any_improved
      integer(ik) :: n_unknowns

      call start(0.3_rk, 0.5_rk, simulation, usual_toughness)
      n_unknowns = simulation%windows%n_unknowns(simulation%tip)
      call improve(simulation, any_improved)
      call checks%is_true(.not. any_improved .and. all(are_built(simulation)), "they stay")
      call checks%is_true(simulation%windows%n_unknowns(simulation%tip) == n_unknowns, &
                          "all of them")
      associate (now => simulation%tip%intensity)
         ! Tolerance of verification/tip_cells.
         call checks%is_true(all(abs(now%k2 - known) < 0.01_rk*known), "K is right")
      end associate
   end subroutine test_good_window

   !> Where the error of the window itself is the larger part its elements become smaller, until no
   !! smaller ones are possible: then the errors of growth are stated. A pressure dp changes K_II of
   !! this crack by friction dp sqrt(pi a).
   subroutine test_poor_elements()
      type(two_levels_t), save :: simulation
      type(growth_error_t) :: growth
      logical :: any_improved, is_noted(2)
      real(rk) :: off  !< [Pa m^1/2]
      integer :: n

      call start(0.3_rk, 0.5_rk, simulation, usual_toughness)
      do n = 1, 5
         off = 0.1_rk*0.8_rk**(n - 5)*usual_toughness
         simulation%now%windows%tip%found%k2_error = off
         simulation%now%windows%tip%of_elements = off
         simulation%tip%intensity%k2_error = off
         call improve(simulation, any_improved)
         if (.not. any_improved) exit
         call checks%is_true(all(simulation%now%windows%tip%times_finer == n), "finer and finer")
      end do
      call checks%is_true(n == 5, "four times")
      growth = growth_error(simulation%tip(1), simulation%now%segment(1), simulation%network, &
                            usual_toughness, simulation%load_pressure)
      call checks%is_close(growth%pressure, 0.1_rk*usual_toughness/(friction*sqrt(pi*a)), 0.01_rk, &
                           "error of the pressure")
      call checks%is_close(growth%relative, growth%pressure/20.0e6_rk, 1.0e-9_rk, "over the load")
      call checks%is_true(.not. growth%position > 0.0_rk, "no position before growth")
      is_noted = [.false., .true.]
      call note_uncertain_tips(simulation, is_noted)
      associate (events => simulation%chronicle%events)
         call checks%is_true(events(size(events))%kind == event_growth_uncertain, "an event")
         call checks%is_true(all(is_noted) .and. events(size(events))%fracture == 1, "of one tip")
         n = size(events)
      end associate
      call note_uncertain_tips(simulation, is_noted)
      call checks%is_true(size(simulation%chronicle%events) == n, "once")
   end subroutine test_poor_elements

   !> A refinement that has not reduced the error is not repeated: neither smaller elements nor a
   !! larger window, until the error has become twice as large.
   subroutine test_no_effect()
      type(two_levels_t), save :: simulation
      logical :: any_improved
      integer :: i

      call start(0.1_rk, 0.5_rk, simulation, usual_toughness)
      call set_error(simulation, 0.1_rk)
      call improve(simulation, any_improved)
      call checks%is_true(all(simulation%now%windows%tip%times_finer == 1), "smaller elements")
      call set_error(simulation, 0.098_rk)
      call improve(simulation, any_improved)
      call checks%is_true(all(simulation%now%windows%tip%times_finer == 0), "taken back")
      call set_error(simulation, 0.098_rk)
      call improve(simulation, any_improved)
      call checks%is_true(all([(simulation%windows%slot(i)%window%times_larger == 1, i=1, 2)]), &
                          "a larger window then")
      call set_error(simulation, 0.097_rk)
      call improve(simulation, any_improved)
      call checks%is_true(all([(simulation%windows%slot(i)%window%times_larger == 0, i=1, 2)]), &
                          "taken back, too")
      call set_error(simulation, 0.097_rk)
      call improve(simulation, any_improved)
      call checks%is_true(.not. any_improved, "and no more of either")
      call set_error(simulation, 0.21_rk)
      call improve(simulation, any_improved)
      call checks%is_true(all(simulation%now%windows%tip%times_finer == 1), "another state")
   end subroutine test_no_effect

   !> An error to which elements and edge contribute nearly equally.
   subroutine set_error(simulation, share)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: share  !< of the toughness [-]

      simulation%tip%intensity%k2_error = share*usual_toughness
      simulation%now%windows%tip%of_elements = share*usual_toughness
      simulation%now%windows%tip%of_edge = 0.9_rk*share*usual_toughness
   end subroutine set_error

   !> A window that would have to be nearly as large as the body is replaced by the body, which both
   !! tips share; then no error enters over an edge.
   subroutine test_body()
      type(two_levels_t), save :: simulation
      logical :: any_improved

      call start(0.4_rk, 0.5_rk, simulation, usual_toughness)
      simulation%now%windows%tip%of_edge = 0.1_rk*usual_toughness
      simulation%tip%intensity%k2_error = 0.1_rk*usual_toughness
      call improve(simulation, any_improved)
      call checks%is_true(any_improved .and. all(simulation%windows%window_of == 3), "for both")
      call checks%is_true(size(simulation%windows%slot(3)%window%serves) == 2, "one for both")
      call checks%is_true(size(simulation%windows%slot(1)%window%serves) == 0, "not its own")
      call evaluate(simulation)
      associate (now => simulation%tip%intensity, seen => simulation%now%windows%tip)
         call checks%is_true(all(abs(now%k2 - known) < 0.01_rk*known), "K of the body")
         call checks%is_true(all(seen%of_edge < 1.0e-3_rk*known), "nothing comes over the edge")
      end associate
      call checks%is_true(.not. any(are_built(simulation)), "its own is not built")
   end subroutine test_body

   !> Windows of eight tips that nearly cover the body, and one another, have more unknowns than the
   !! body: the body is the only window then, has fewer, and gives the same K. Small windows stay.
   subroutine test_many_windows()
      real(rk), parameter :: half = 0.05_rk*sqrt(0.5_rk), apart = 0.35_rk
      type(two_levels_t), save :: simulation
      type(scene_t) :: scene
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      integer(ik) :: before
      real(rk), allocatable :: k2(:)
      real(rk) :: window
      integer :: i, n

      do n = 1, 2
         window = merge(0.15_rk, 0.6_rk, n == 1)
         scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
         scene%material%toughness = usual_toughness
         scene%initial%pressure = pressure
         scene%discretization%size_fracture = 0.02_rk
         scene%discretization%window = window
         scene%growth%enabled = .true.
         do i = 1, 4
            associate (x => 1.0_rk + apart*[-1.5_rk, -0.5_rk, 0.5_rk, 1.5_rk])
               call add_fracture(scene, "f", x(i) + [-half, half], 1.0_rk + [-half, half], &
                                 friction, 0.0_rk)
            end associate
         end do
         simulation = two_levels_t()
         call simulation%begin(scene, timers, error)
         call checks%no_error(error, "begin")
         call simulation%equilibrate(timers, report, error)
         call checks%no_error(error, "initial state")
         call evaluate(simulation)
         before = simulation%windows%n_unknowns(simulation%tip)
         k2 = simulation%tip%intensity%k2
         call limit_windows(simulation, timers, error)
         call checks%no_error(error, "limit")
         if (n == 1) then
            call checks%is_true(.not. any(simulation%windows%window_of == 9), "small windows stay")
         else
            call checks%is_true(simulation%windows%all_in_body(), "the body for all tips")
            call checks%is_true(simulation%windows%n_unknowns(simulation%tip) < before, &
                                "fewer unknowns")
            call checks%is_true(all(abs(simulation%tip%intensity%k2 - k2) < 0.01_rk*abs(k2)), &
                                "the same K")
         end if
      end do
   end subroutine test_many_windows

end program test_twolevel_refinement
