!> Tips that are shut, or keep their intensities: in a network of ten tips far below their toughness
!! the intensities that are kept are those of an evaluation within the stated errors.
!!
!! Five fractures of several lengths and angles, closed and slipping, each with a well; the fluid
!! pressure rises, and with it K.
program test_twolevel_carried
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use fine_tip_types, only: intensity_t
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: injection_t, scene_t
   use testing_checks, only: checks_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_places, only: end_cell, shut_tips
   use twolevel_state, only: two_levels_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows_state, only: windows_state_t
   implicit none(type, external)

   integer(ik), parameter :: n_steps = 12
   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_network("10 tips", 5, 1.0e7_rk, .false.)
   call test_network("10 tips in one window", 5, 1.0e7_rk, .true.)
   call test_rejected()
   call test_few()
   call test_near_toughness()
   call test_focus()
   call test_still()
   call test_cell_length()
   call test_reopening()
   call test_same_jump()
   call test_shut_tips()
   call checks%finish()

contains

   !> A network of fractures with a well each, in its initial state.
   subroutine start(simulation, n, toughness, is_body, cell, n_rough)
      type(two_levels_t), intent(inout) :: simulation
      integer, intent(in) :: n  !< fractures
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      logical, intent(in) :: is_body  !< one window
      real(rk), intent(in), optional :: cell  !< length of the fracture cells [m]
      integer, intent(in), optional :: n_rough  !< number of the last fractures, which stick
      real(rk), parameter :: x(5) = [0.5_rk, 1.4_rk, 1.0_rk, 0.6_rk, 1.5_rk]
      real(rk), parameter :: y(5) = [0.5_rk, 0.5_rk, 1.0_rk, 1.4_rk, 1.3_rk]
      real(rk), parameter :: half(5) = [0.15_rk, 0.2_rk, 0.1_rk, 0.2_rk, 0.12_rk]
      real(rk), parameter :: angle(5) = [45.0_rk, 60.0_rk, 30.0_rk, 50.0_rk, -40.0_rk]*pi/180.0_rk
      real(rk), parameter :: rates(5) = [3.0e-7_rk, 1.0e-7_rk, 5.0e-7_rk, 3.0e-8_rk, 3.0e-7_rk]
      type(scene_t) :: scene
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      integer :: i

      scene = squeezed_body(20.0e6_rk, 8.0e6_rk)
      scene%growth%enabled = .true.
      scene%growth%increment = 0.05_rk
      scene%material%toughness = toughness
      scene%discretization%window_is_body = is_body
      if (present(cell)) scene%discretization%size_fracture = cell
      do i = 1, n
         associate (along => half(i)*[cos(angle(i)), sin(angle(i))])
            call add_fracture(scene, "f", x(i) + along(1)*[-1.0_rk, 1.0_rk], &
                              y(i) + along(2)*[-1.0_rk, 1.0_rk], 0.3_rk, 0.01_rk)
         end associate
      end do
      if (present(n_rough)) scene%fractures(n - n_rough + 1:)%friction = 1.4_rk
      scene%injections = [(injection_t(fracture=int(i, ik), rate=[rates(i)*half(i)]), i=1, n)]
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "begin")
      call simulation%equilibrate(timers, report, error)
      call checks%no_error(error, "initial state")
      call simulation%begin_step()
      call evaluate(simulation)
   end subroutine start

   !> Evaluate the tips with their errors.
   subroutine evaluate(simulation)
      type(two_levels_t), intent(inout) :: simulation
      type(error_t), allocatable :: error

      call simulation%evaluate(timers, error)
      call checks%no_error(error, "tips")
      call estimate_coarse_errors(simulation, timers, error)
      call checks%no_error(error, "errors")
   end subroutine evaluate

   !> The next state.
   subroutine step(simulation, dt)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: dt  !< [s]
      type(step_report_t) :: report
      type(error_t), allocatable :: error

      call simulation%begin_step()
      call simulation%try_step(dt, timers, report, error)
      call checks%no_error(error, "step")
      call checks%is_true(report%converged, "step")
   end subroutine step

   !> Evaluate all tips of the present state, and return to the state with those that are kept.
   function evaluated(simulation) result(tips)
      type(two_levels_t), intent(inout) :: simulation
      type(tip_t), allocatable :: tips(:), kept(:)
      type(windows_state_t) :: windows

      kept = simulation%tip
      windows = simulation%now%windows
      call simulation%now%windows%tip%forget_jump()
      call evaluate(simulation)
      call checks%is_true(.not. any(simulation%tip%is_carried), "all are evaluated")
      tips = simulation%tip
      simulation%tip = kept
      simulation%now%windows = windows
   end function evaluated

   !> Intensities that are kept through several steps; the change of K goes from nearly nothing to
   !! more than a tenth per step.
   subroutine test_network(name, n, toughness, is_body)
      character(len=*), intent(in) :: name
      integer, intent(in) :: n  !< fractures
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      logical, intent(in) :: is_body
      type(two_levels_t) :: simulation
      type(tip_t), allocatable :: tips(:)
      real(rk) :: off(2), worst
      integer :: carried, i, k, mended

      call start(simulation, n, toughness, is_body)
      carried = 0
      mended = 0
      worst = 0.0_rk
      do k = 1, n_steps
         call step(simulation, 2.0_rk)
         call evaluate(simulation)
         tips = evaluated(simulation)
         do i = 1, size(tips)
            associate (kept => simulation%tip(i)%intensity, now => tips(i)%intensity)
               if (.not. simulation%tip(i)%is_carried) then
                  mended = mended + 1
                  cycle
               end if
               carried = carried + 1
               off = abs([kept%k1 - now%k1, kept%k2 - now%k2])
               worst = max(worst, maxval(off/[kept%k1_error, kept%k2_error]))
            end associate
         end do
      end do
      call checks%is_true(worst <= 1.0_rk, name//": K that is kept is within its error")
      call checks%is_true(carried > 2*n .and. mended > 2*n, name//": some are kept, some are not")
      print "(2a,i0,a,i0,a,f6.3)", name, ": kept ", carried, ", evaluated ", mended, &
         ", largest difference over the stated error ", worst
   end subroutine test_network

   !> The first step after the undrained response is rejected and tried again: K of this response is
   !! not kept, though the windows are those of the first try.
   subroutine test_rejected()
      type(two_levels_t), save :: simulation

      call start(simulation, 5, 1.0e7_rk, .false.)
      call step(simulation, 1.0e-3_rk)
      call evaluate(simulation)
      call simulation%put_back()
      call step(simulation, 0.5e-3_rk)
      call evaluate(simulation)
      call checks%is_true(.not. any(simulation%tip%is_carried), "after a rejected step")
   end subroutine test_rejected

   !> Eight tips or fewer are all evaluated.
   subroutine test_few()
      type(two_levels_t), save :: simulation

      call start(simulation, 4, 1.0e7_rk, .false.)
      call step(simulation, 1.0e-3_rk)
      call evaluate(simulation)
      call checks%is_true(.not. any(simulation%tip%is_carried), "eight tips")
   end subroutine test_few

   !> Tips within half of their toughness are all evaluated.
   subroutine test_near_toughness()
      type(two_levels_t), allocatable, save :: simulation
      real(rk) :: toughness
      logical, allocatable :: is_near(:)

      allocate (simulation)
      call start(simulation, 5, 1.0e8_rk, .false.)
      associate (drive => simulation%tip%drive%intensity)
         toughness = minval(drive) + maxval(drive)
      end associate
      deallocate (simulation)
      allocate (simulation)
      call start(simulation, 5, toughness, .false.)
      call step(simulation, 0.01_rk)
      call evaluate(simulation)
      call step(simulation, 0.01_rk)
      call evaluate(simulation)
      is_near = simulation%tip%excess(toughness) + simulation%tip%relative_error(toughness) &
                > -0.5_rk
      call checks%is_true(any(is_near) .and. .not. all(is_near), "some tips are near, some are not")
      call checks%is_true(any(simulation%tip%is_carried), "some of those far below are kept")
      call checks%is_true(.not. any(simulation%tip%is_carried .and. is_near), "no other one is")
   end subroutine test_near_toughness

   !> In the body as one window the elements are small around tips near their toughness only; K of
   !! the others is within the stated errors of what it is with small elements.
   subroutine test_focus()
      type(two_levels_t), allocatable, save :: far, near
      integer :: i

      allocate (far, near)
      call start(far, 5, 1.0e8_rk, .true.)
      call start(near, 5, 1.0e4_rk, .true.)
      call checks%is_true(.not. any(far%now%windows%tip%has_focus), "far: none")
      call checks%is_true(all(near%now%windows%tip%has_focus), "near: all")
      call checks%is_true(1.1_rk*far%windows%n_unknowns(far%tip) &
                          < near%windows%n_unknowns(near%tip), "fewer unknowns")
      do i = 1, size(far%tip)
         associate (a => far%tip(i)%intensity, b => near%tip(i)%intensity)
            call checks%is_close(a%k2, b%k2, a%k2_error + b%k2_error, "K_II")
         end associate
      end do
   end subroutine test_focus

   !> The body as window leaves out fractures that stick far from slip, until they are needed: K of
   !! the others differs by no more than from another mesh.
   subroutine test_still()
      type(two_levels_t), save :: simulation
      type(tip_t), allocatable :: without(:)
      integer(ik) :: fewer
      integer :: i

      call start(simulation, 5, 1.0e7_rk, .true., n_rough=3)
      associate (known => simulation%now%windows%tip, tips => simulation%tip)
         call checks%is_true(all(known%is_needed .eqv. known%fracture <= 2), "two of them move")
         call checks%is_true(all(tips%is_shut .neqv. known%is_needed), "the others are shut")
         without = tips
         fewer = simulation%windows%n_unknowns(tips)
         known%is_needed = .true.
         call evaluate(simulation)
         call checks%is_true(fewer < 0.8_rk*simulation%windows%n_unknowns(tips), "fewer unknowns")
         do i = 1, 4
            call checks%is_close(without(i)%intensity%k2, tips(i)%intensity%k2, &
                                 1.0e-3_rk*abs(tips(i)%intensity%k2), "K_II")
            call checks%is_true(abs(tips(i)%intensity%k2) > 1.0e5_rk, "some K_II")
         end do
      end associate
   end subroutine test_still

   !> What is compared is the jump over the root of the length of its cell, so a cell of
   !! another length alone does not change it. The mean opening of a cell of length d at a tip
   !! is (2/3) (8 K/E') sqrt(d/(2 pi)).
   subroutine test_cell_length()
      type(two_levels_t), allocatable, save :: simulation
      real(rk), parameter :: sizes(2) = [0.05_rk, 0.025_rk]
      real(rk) :: modulus, of_jump
      integer :: i, k

      do k = 1, size(sizes)
         allocate (simulation)
         call start(simulation, 5, 1.0e7_rk, .false., sizes(k))
         modulus = simulation%scene%material%young/(1.0_rk - simulation%scene%material%poisson**2)
         do i = 1, size(simulation%tip)
            associate (tip => simulation%tip(i), seen => simulation%now%windows%tip(i))
               of_jump = 0.375_rk*norm2(seen%jump_then)*modulus*sqrt(0.5_rk*pi)
               ! The jump is linear in a cell.
               call checks%is_close(of_jump/norm2([tip%intensity%k1, tip%intensity%k2]), 1.0_rk, &
                                    0.15_rk, "K of the jump")
            end associate
         end do
         deallocate (simulation)
      end do
   end subroutine test_cell_length

   !> A tip whose faces have stuck and move now is evaluated, not kept at K = 0.
   subroutine test_reopening()
      type(two_levels_t), save :: simulation
      real(rk), allocatable :: jump(:, :, :)
      real(rk) :: known

      call start(simulation, 5, 1.0e7_rk, .false.)
      known = simulation%tip(2)%intensity%k2
      jump = simulation%now%coarse%jump
      associate (cell => end_cell(simulation%problem%mesh%fracture, simulation%tip(2)))
         simulation%now%coarse%jump(:, :, cell - 1:cell) = 0.0_rk
      end associate
      call evaluate(simulation)
      call checks%is_true(simulation%tip(2)%is_shut, "the tip is shut")
      call checks%is_true(count(simulation%tip%is_shut) == 1, "no other one")
      call checks%is_true(.not. abs(simulation%tip(2)%intensity%k2) > 0.0_rk, "K = 0")
      simulation%now%coarse%jump = jump
      call evaluate(simulation)
      call checks%is_true(.not. simulation%tip(2)%is_carried, "evaluated")
      call checks%is_close(simulation%tip(2)%intensity%k2/known, 1.0_rk, 1.0e-9_rk, "K as before")
   end subroutine test_reopening

   !> The conditions under which an intensity is kept, and its error.
   subroutine test_same_jump()
      type(window_tip_t) :: seen
      type(tip_t) :: tip
      real(rk), parameter :: place(2) = [1.0_rk, 2.0_rk], jump(2) = [3.0_rk, -4.0_rk]

      call checks%is_true(.not. seen%has_same_jump(jump, place, .false.), "never evaluated")
      call seen%note_jump(jump, place, .false.)
      call checks%is_true(.not. seen%has_same_jump(jump, place, .false.), "errors not estimated")
      seen%is_compared = .true.
      call checks%is_true(seen%has_same_jump(jump, place, .false.), "the same")
      call checks%is_true(.not. seen%has_same_jump(jump, place + 1.0e-9_rk, .false.), "moved")
      call checks%is_true(seen%has_same_jump(jump + [0.0_rk, 0.49_rk], place, .false.), "9.8 %")
      call checks%is_true(.not. seen%has_same_jump(jump + [0.51_rk, 0.0_rk], place, .false.), &
                          "10.2 %")
      call checks%is_true(.not. seen%has_same_jump(-jump, place, .false.), "the other direction")
      call checks%is_true(.not. seen%has_same_jump(jump, place, .true.), "the undrained response")
      call checks%is_close(seen%change_of_jump(jump + [0.4_rk, 0.0_rk]), 0.08_rk, 1.0e-12_rk, &
                           "change")
      call tip%carry(intensity_t(k1=3.0_rk, k2=4.0_rk, k1_error=0.1_rk, k2_error=0.2_rk), 0.08_rk)
      call checks%is_true(tip%is_carried .and. .not. tip%is_loaded(), "kept")
      call checks%is_close(tip%intensity%k1_error, 0.5_rk, 1.0e-12_rk, "error of K_I")
      call checks%is_close(tip%intensity%k2_error, 0.6_rk, 1.0e-12_rk, "error of K_II")
      call seen%forget_jump()
      call checks%is_true(.not. seen%has_same_jump(jump, place, .false.), "forgotten")
   end subroutine test_same_jump

   !> Which tips are shut: two fractures, of three cells and of one, numbered one after the other.
   subroutine test_shut_tips()
      type(tip_t) :: tips(4)
      type(segment_t) :: segments(4)
      type(fracture_mesh_t) :: fracture
      real(rk) :: jump(2, 2, 4)

      fracture%n_cells = 4
      fracture%cell_fracture = [1_ik, 1_ik, 1_ik, 2_ik]
      tips%fracture = [1, 1, 2, 2]
      tips%end = [1, 2, 1, 2]
      jump = 0.0_rk
      call checks%is_true(all(shut_tips(tips, segments, fracture, jump) .eqv. &
                              [.true., .true., .false., .false.]), "no jump; one cell says nothing")
      jump(2, :, 1) = 1.0e-3_rk
      call checks%is_true(all(shut_tips(tips, segments, fracture, jump) .eqv. &
                              [.false., .true., .false., .false.]), "slip at one end")
      jump(2, 1, 2) = 0.9e-15_rk
      call checks%is_true(all(shut_tips(tips, segments, fracture, jump) .eqv. &
                              [.false., .true., .false., .false.]), "and rounding errors")
      jump(2, 1, 2) = 1.1e-15_rk
      call checks%is_true(.not. any(shut_tips(tips, segments, fracture, jump)), &
                          "slip up to two cells from the tip")
      jump(:, :, 2) = 0.0_rk
      tips(2)%is_free = .false.
      call checks%is_true(.not. any(shut_tips(tips, segments, fracture, jump)), "no tip any more")
      tips(2)%is_free = .true.
      segments(2)%gain = 1.0e-6_rk
      call checks%is_true(.not. any(shut_tips(tips, segments, fracture, jump)), "has grown")
      segments(2)%gain = 0.0_rk
      segments(2)%is_open = .true.
      call checks%is_true(.not. any(shut_tips(tips, segments, fracture, jump)), "grows")
      jump(1, 1, 3) = ieee_value(1.0_rk, ieee_quiet_nan)
      segments(2)%is_open = .false.
      call checks%is_true(.not. any(shut_tips(tips, segments, fracture, jump)), "unknown jump")
   end subroutine test_shut_tips

end program test_twolevel_carried
