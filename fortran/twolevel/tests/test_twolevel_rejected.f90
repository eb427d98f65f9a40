!> A rejected try of a step changes nothing, wherever the tips are and whatever it has begun: all
!! parts of the state are restored to the last bit, and a run with further tries is the same.
program test_twolevel_rejected
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use report_rows, only: history_row_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t, time_t
   use twolevel_equilibrium, only: find_equilibrium
   use twolevel_levels_state, only: checkpoint_t, different_part, equal, part_t, parts
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   implicit none(type, external)

   integer, parameter :: most = 36  !< number of states compared
   type(checks_t) :: checks
   type(timers_t) :: timers

   call timers%begin()
   call test_parts()
   call test_rejected()
   call checks%finish()

contains

   !> A copy is equal; a change of a part is found, and reported by its name.
   subroutine test_parts()
      type(two_levels_t), save :: simulation
      type(error_t), allocatable :: error
      type(checkpoint_t) :: copy, state
      type(part_t), allocatable :: list(:)

      call simulation%begin(two_fractures(), timers, error)
      call simulation%next_state(timers, error)
      if (.not. allocated(error)) call simulation%grow(timers, error)
      call checks%no_error(error, "a state")
      if (allocated(error)) return
      state = simulation%present_state()
      copy = state
      call checks%is_true(equal(state, copy), "a copy is equal")
      list = parts(state)
      call checks%is_true(size(list) > 20, "a part for each thing that is remembered")
      copy%levels%coarse%jump(1, 2, 3) = nearest(copy%levels%coarse%jump(1, 2, 3), 1.0_rk)
      call checks%is_true(different_part(state, copy) == "jumps", "a bit of a jump")
      copy = state
      copy%front%tip(1)%xy(1) = nearest(copy%front%tip(1)%xy(1), 1.0_rk)
      call checks%is_true(different_part(state, copy) == "tips", "a bit of a tip's place")
      copy = state
      copy%levels%windows%history(1)%contact%slip_before(1, 1) = 1.0_rk
      call checks%is_true(different_part(state, copy) == "contact in windows", "a slip")
      copy = state
      deallocate (copy%levels%given)
      call checks%is_true(equal(state, copy), "nothing and none are the same")
   end subroutine test_parts

   !> Tries of several lengths before each state, compared with the run without.
   subroutine test_rejected()
      real(rk), parameter :: lengths(2) = [0.5_rk, 8.0_rk]
      type(history_row_t), allocatable :: alone(:), row(:)
      real(rk), allocatable :: k_alone(:, :), k(:, :)
      integer :: new_meshes(size(lengths)), none(0)

      call follow([real(rk) ::], alone, k_alone, none)
      call checks%is_true(maxval(alone%fracture_length) > alone(1)%fracture_length + 0.04_rk, &
                          "growth of several segments")
      call follow(lengths, row, k, new_meshes)
      call checks%is_true(new_meshes(2) > 3, "segments are begun in vain")
      call same(alone%time, row%time, "times")
      call same(pressures(alone), pressures(row), "pressures")
      call same(alone%fracture_length, row%fracture_length, "lengths")
      call same(alone%max_slip, row%max_slip, "slip")
      call same(alone%length_error, row%length_error, "errors of the length")
      call same(alone%well_pressure_error, row%well_pressure_error, "errors of the pressure")
      call same(reshape(k_alone, [size(k)]), reshape(k, [size(k)]), "intensities")
   end subroutine test_rejected

   !> Values of all wells, row after row.
   pure function pressures(rows)
      type(history_row_t), intent(in) :: rows(:)
      real(rk), allocatable :: pressures(:)
      integer :: i

      pressures = [(rows(i)%well_pressure, i=1, size(rows))]
   end function pressures

   subroutine same(a, b, what)
      real(rk), intent(in) :: a(:), b(:)
      character(len=*), intent(in) :: what

      call checks%is_close(maxval(abs(a - b)), 0.0_rk, 0.0_rk, what//" are the same bits")
   end subroutine same

   !> A fracture with a well that grows at both ends, and one next to it.
   pure function two_fractures() result(scene)
      type(scene_t) :: scene

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      scene%time = time_t(end=1.0e5_rk, tolerance=3.0e-2_rk, smallest_factor=1.0e-9_rk)
      scene%growth%enabled = .true.
      scene%growth%law = "equilibrium"
      scene%growth%increment = 0.02_rk
      scene%material%toughness = 1.0e6_rk
      scene%initial%fracture_pressure = "equilibrated"
      call add_fracture(scene, "fed", [0.85_rk, 1.15_rk], [0.95_rk, 1.05_rk], 0.5_rk, 0.01_rk)
      call add_fracture(scene, "beside", [0.9_rk, 1.2_rk], [0.7_rk, 0.8_rk], 0.5_rk, 0.01_rk)
      scene%injections = [injection_t(fracture=1, rate=[1.0e-7_rk])]
   end function two_fractures

   !> States of a run, with rejected tries before every second of its steps.
   subroutine follow(lengths, row, k, new_meshes)
      real(rk), intent(in) :: lengths(:)  !< (kinds of tries) length over that of the step [-]
      type(history_row_t), allocatable, intent(out) :: row(:)  !< (states)
      real(rk), allocatable, intent(out) :: k(:, :)  !< (tips, states) K_eq [Pa m^1/2]
      integer, intent(out) :: new_meshes(:)  !< (kinds of tries) number with a separate mesh
      type(two_levels_t) :: simulation
      type(error_t), allocatable :: error
      integer :: i, kind

      new_meshes = 0
      call simulation%begin(two_fractures(), timers, error)
      call checks%no_error(error, "begin")
      allocate (row(most), k(size(simulation%tip), most))
      do i = 1, most
         ! The first two states are that at rest and one without previous rates.
         do kind = 1, merge(size(lengths), 0, i > 2 .and. modulo(i, 2) == 0)
            call reject(simulation, lengths(kind), new_meshes(kind))
         end do
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) call simulation%grow(timers, error)
         call checks%no_error(error, "a state")
         if (allocated(error)) return
         row(i) = simulation%history()
         k(:, i) = simulation%tip%drive%intensity
      end do
   end subroutine follow

   !> Two tries that are rejected for their time error: at once, and with the tips in equilibrium,
   !! or later.
   subroutine reject(simulation, length, new_meshes)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: length  !< length of the tries, over that of the step [-]
      integer, intent(inout) :: new_meshes  !< number of tries with a separate mesh
      type(error_t), allocatable :: error
      type(step_report_t) :: report
      type(trial_t) :: trial
      type(checkpoint_t) :: before
      real(rk) :: tolerance
      integer :: k

      tolerance = simulation%scene%time%tolerance
      call simulation%begin_step()
      before = simulation%present_state()
      simulation%scene%time%tolerance = tiny(1.0_rk)
      do k = 1, 2
         call find_equilibrium(simulation, length*simulation%stepper%next, .false., .false., &
                               timers, report, trial, error)
         call checks%no_error(error, "a try")
         if (allocated(simulation%kept_problem)) new_meshes = new_meshes + 1
         call checks%is_true(.not. equal(simulation%present_state(), before), "a try changes much")
         call simulation%put_back()
         call checks%is_true(different_part(simulation%present_state(), before) == "", &
                             "and leaves nothing: "//different_part(simulation%present_state(), &
                                                                    before))
         simulation%scene%time%tolerance = trial%time_error/3.0_rk
      end do
      simulation%scene%time%tolerance = tolerance
   end subroutine reject

end program test_twolevel_rejected
