!> A try of a step that is rejected leaves no trace: a run with further ones is the same to the last
!! bit. Not so yet where tips are on their way: the coarse mesh keeps the cells of pieces that are
!! begun, and windows the meshes that have followed the tips. What is known of the tips is as
!! before.
program test_twolevel_rejected
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use growth_company, only: company_t
   use results_rows, only: history_row_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t, time_t
   use twolevel_equilibrium, only: find_equilibrium
   use twolevel_simulation, only: twolevel_simulation_t
   use twolevel_stepping, only: trial_t
   implicit none(type, external)

   integer, parameter :: most = 22  !< states that are followed
   type(checks_t) :: checks
   type(timers_t) :: timers

   call timers%begin()
   call test_rejected()
   call test_on_the_way()
   call checks%finish()

contains

   !> Tries of several lengths, before each state in turn, beside the run without.
   subroutine test_rejected()
      real(rk), parameter :: lengths(3) = [0.1_rk, 0.4_rk, 1.0_rk]
      type(history_row_t), allocatable :: alone(:), row(:)
      real(rk), allocatable :: k_alone(:, :), k(:, :)
      logical :: is_tried(most)
      integer :: i, rejected

      is_tried = .false.
      call follow(0.0_rk, is_tried, alone, k_alone, rejected)
      ! The first two states are that at rest and one with no rates before it.
      is_tried(3:) = .not. alone(3:)%fracture_length > alone(1)%fracture_length
      call checks%is_true(count(is_tried) > 5 .and. count(.not. is_tried) > 5, "growth")
      do i = 1, size(lengths)
         call follow(lengths(i), is_tried, row, k, rejected)
         call checks%is_true(rejected == 2*count(is_tried), "tries are rejected")
         call same(alone%time, row%time, "times")
         call same(pressures(alone), pressures(row), "pressures")
         call same(alone%fracture_length, row%fracture_length, "lengths")
         call same(alone%max_slip, row%max_slip, "slip")
         call same(alone%length_error, row%length_error, "errors of the length")
         call same(alone%well_pressure_error, row%well_pressure_error, "errors of the pressure")
         call same(reshape(k_alone, [size(k)]), reshape(k, [size(k)]), "intensities")
      end do
   end subroutine test_rejected

   !> Those of all wells, row after row.
   pure function pressures(rows)
      type(history_row_t), intent(in) :: rows(:)
      real(rk), allocatable :: pressures(:)
      integer :: i

      pressures = [(rows(i)%well_pressure, i=1, size(rows))]
   end function pressures

   !> Tries in which tips go on: what decides about the next one is as it was.
   subroutine test_on_the_way()
      type(twolevel_simulation_t) :: simulation
      type(error_t), allocatable :: error
      real(rk), allocatable :: matrix(:, :), measured(:, :), place(:, :), reached(:)
      integer :: i, rejected

      rejected = 0
      call simulation%begin(two_fractures(), timers, error)
      do i = 1, most
         if (i > 2) then
            matrix = simulation%now%rivals%matrix
            measured = simulation%now%rivals%measured
            reached = simulation%now%segment%reached
            place = reshape([simulation%tip%xy(1), simulation%tip%xy(2)], [size(reached), 2])
            associate (kinds => kinds_of(simulation))
               call reject(simulation, 1.0_rk, rejected)
               call checks%is_true(all(kinds == kinds_of(simulation)), "the same kinds of tips")
            end associate
            call same(reshape(matrix, [size(matrix)]), &
                      reshape(simulation%now%rivals%matrix, [size(matrix)]), "rivals")
            call same(reshape(measured, [size(matrix)]), &
                      reshape(simulation%now%rivals%measured, [size(matrix)]), "measured rivals")
            call same(reached, simulation%now%segment%reached, "places along pieces")
            call same(reshape(place, [size(place)]), [simulation%tip%xy(1), simulation%tip%xy(2)], &
                      "places")
         end if
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) call simulation%grow(timers, error)
         call checks%no_error(error, "a state")
         if (allocated(error)) return
      end do
   end subroutine test_on_the_way

   !> Which tips would grow as one now.
   function kinds_of(simulation) result(kind)
      type(twolevel_simulation_t), intent(in) :: simulation
      integer(ik) :: kind(size(simulation%tip))
      type(company_t) :: company

      company = simulation%now%company
      associate (drive => simulation%tip%drive%intensity/simulation%rules%toughness)
         call company%find_kinds(drive, 0.0_rk*drive, simulation%now%segment%gain, &
                                 simulation%tip%arrested, simulation%rules%increment, &
                                 simulation%now%rivals, kind)
      end associate
   end function kinds_of

   subroutine same(a, b, what)
      real(rk), intent(in) :: a(:), b(:)
      character(len=*), intent(in) :: what

      call checks%is_close(maxval(abs(a - b)), 0.0_rk, 0.0_rk, what//" are the same bits")
   end subroutine same

   !> A fracture that is injected into and grows at both ends, and one beside it.
   pure function two_fractures() result(scene)
      type(scene_t) :: scene

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      scene%time = time_t(end=1.0e5_rk, tolerance=1.0e-2_rk, smallest_factor=1.0e-9_rk)
      scene%growth%enabled = .true.
      scene%growth%law = "equilibrium"
      scene%growth%increment = 0.02_rk
      scene%material%toughness = 1.0e6_rk
      scene%initial%fracture_pressure = "equilibrated"
      call add_fracture(scene, "fed", [0.85_rk, 1.15_rk], [0.95_rk, 1.05_rk], 0.5_rk, 0.01_rk)
      call add_fracture(scene, "beside", [0.9_rk, 1.2_rk], [0.7_rk, 0.8_rk], 0.5_rk, 0.01_rk)
      scene%injections = [injection_t(fracture=1, rate=[1.0e-7_rk])]
   end function two_fractures

   !> The states of a run, with tries that are rejected before each of its steps.
   subroutine follow(length, is_tried, row, k, rejected)
      real(rk), intent(in) :: length  !< of the tries, over that of the step [-]
      logical, intent(in) :: is_tried(:)  !< (states) there are such tries before it
      type(history_row_t), allocatable, intent(out) :: row(:)  !< (states)
      real(rk), allocatable, intent(out) :: k(:, :)  !< (tips, states) K_eq [Pa m^1/2]
      integer, intent(out) :: rejected  !< tries
      type(twolevel_simulation_t) :: simulation
      type(error_t), allocatable :: error
      integer :: i

      rejected = 0
      call simulation%begin(two_fractures(), timers, error)
      call checks%no_error(error, "begin")
      allocate (row(most), k(size(simulation%tip), most))
      do i = 1, most
         if (is_tried(i)) call reject(simulation, length, rejected)
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) call simulation%grow(timers, error)
         call checks%no_error(error, "a state")
         if (allocated(error)) return
         row(i) = simulation%history()
         k(:, i) = simulation%tip%drive%intensity
      end do
   end subroutine follow

   !> Two tries that are rejected for their error in time: at once, and with the tips where they
   !! come to rest.
   subroutine reject(simulation, length, rejected)
      type(twolevel_simulation_t), intent(inout) :: simulation
      real(rk), intent(in) :: length  !< over that of the step [-]
      integer, intent(inout) :: rejected
      type(error_t), allocatable :: error
      type(step_report_t) :: report
      type(trial_t) :: trial
      real(rk) :: tolerance, time
      integer :: k

      time = simulation%time()
      tolerance = simulation%scene%time%tolerance
      call simulation%begin_step()
      simulation%scene%time%tolerance = tiny(1.0_rk)
      do k = 1, 2
         call find_equilibrium(simulation, length*simulation%stepper%next, .false., .false., &
                               timers, report, trial, error)
         call checks%no_error(error, "a try")
         call simulation%put_back()
         simulation%scene%time%tolerance = trial%time_error/3.0_rk
         rejected = rejected + 1
      end do
      simulation%scene%time%tolerance = tolerance
      call checks%is_close(simulation%time(), time, 0.0_rk, "nothing is accepted")
   end subroutine reject

end program test_twolevel_rejected
