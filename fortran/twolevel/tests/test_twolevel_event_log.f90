!> Event log and rows of the tips: before and after growth, joints, arrests, contact.
program test_twolevel_event_log
   use base_kinds, only: ik, rk
   use contact_law, only: state_open, state_slip, state_stick
   use growth_network, only: network_of_scene
   use growth_targets, only: target_boundary
   use mesh_types, only: fracture_mesh_t
   use report_rows, only: event_arrest, event_bifurcation, event_growth, event_joint, &
                          event_opening, event_slip_onset
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   type(checks_t) :: checks
   real(rk), parameter :: toughness = 1.0e6_rk  !< [Pa m^1/2]

   call test_rows_of_tips()
   call test_growth()
   call test_contact()
   call test_gain()
   call test_separation()
   call checks%finish()

contains

   !> A scene with a fracture and two tips, at 0.5 s.
   subroutine start(simulation)
      type(two_levels_t), intent(out) :: simulation
      type(scene_t) :: scene
      integer :: end

      scene = squeezed_body(20.0e6_rk, 20.0e6_rk)
      call add_fracture(scene, "f", [0.8_rk, 1.2_rk], [1.0_rk, 1.0_rk], 1.0_rk, 0.0_rk)
      call simulation%set_scene(scene)
      simulation%start = network_of_scene(scene)
      simulation%network = simulation%start
      simulation%now%coarse%time = 0.5_rk
      allocate (simulation%tip(2))
      do end = 1, 2
         simulation%tip(end)%fracture = 1
         simulation%tip(end)%end = end
         simulation%tip(end)%xy = simulation%network%xy(:, end)
         simulation%tip(end)%direction = [2.0_rk*end - 3.0_rk, 0.0_rk]
      end do
   end subroutine start

   !> One of two tips has grown by 0.1 m: both rows are of the state before growth.
   subroutine test_rows_of_tips()
      type(two_levels_t), save :: simulation

      call start(simulation)
      call simulation%tip(1)%move([0.7_rk, 1.0_rk], 0.25_rk)
      simulation%tip%intensity_before%k1 = [16.0_rk, 17.0_rk]
      simulation%tip%intensity%k1 = [26.0_rk, 27.0_rk]
      call simulation%note_tips()
      simulation%tip%advance = 0.0_rk
      call simulation%note_tips()
      call checks%is_true(size(simulation%chronicle%tips) == 4, "two rows each")
      associate (row => simulation%chronicle%tips)
         call checks%is_close(maxval(abs(row%time - 0.5_rk)), 0.0_rk, 0.0_rk, "time")
         call checks%is_true(all(row%tip == [1, 2, 1, 2]), "tips in their order")
        call checks%is_close(maxval(abs(row%intensity%k1 - [16.0_rk, 17.0_rk, 26.0_rk, 27.0_rk])), &
                              0.0_rk, 0.0_rk, "before, then after")
         call checks%is_close(row(1)%xy(1), 0.8_rk, 0.0_rk, "grown: where it was")
         call checks%is_close(row(1)%advance, 0.1_rk, 1.0e-15_rk, "and how far it went")
         call checks%is_close(row(1)%angle, 0.25_rk, 0.0_rk, "in which direction")
         call checks%is_close(row(3)%xy(1), 0.7_rk, 0.0_rk, "then: where it is")
         call checks%is_close(row(2)%xy(1), 1.2_rk, 0.0_rk, "the other stays")
      end associate
   end subroutine test_rows_of_tips

   !> One tip joins the boundary; the other stops before it, which is reported once.
   subroutine test_growth()
      type(two_levels_t), save :: simulation

      call start(simulation)
      call simulation%tip%begin_increment()
      call simulation%tip(1)%move([0.0_rk, 1.0_rk], 0.0_rk)
      simulation%tip%arrested = .true.
      simulation%tip%target = target_boundary
      simulation%tip%joined = [.true., .false.]
      call simulation%note_growth()
      call kinds_are(simulation, [character(len=10) :: event_growth, event_joint, event_arrest])
      if (size(simulation%chronicle%events) == 3) then
         call checks%is_true(simulation%chronicle%events(2)%detail == "joins the outer boundary", &
                             "what is joined")
         call checks%is_true(simulation%chronicle%events(3)%detail == &
                             "next to the outer boundary", &
                             "what has stopped it")
      end if
      call simulation%chronicle%clear()
      call simulation%tip%begin_increment()
      call simulation%note_growth()
      call kinds_are(simulation, [character(len=10) ::])
   end subroutine test_growth

   subroutine kinds_are(simulation, expected)
      type(two_levels_t), intent(in) :: simulation
      character(len=*), intent(in) :: expected(:)
      integer :: i

      associate (events => simulation%chronicle%events)
         call checks%is_true(size(events) == size(expected), "number of events")
         do i = 1, min(size(events), size(expected))
            call checks%is_true(events(i)%kind == trim(expected(i)), "event "//trim(expected(i)))
         end do
      end associate
   end subroutine kinds_are

   !> The first slip and the first opening of a fracture are events, later ones are none.
   subroutine test_contact()
      type(two_levels_t), save :: simulation
      type(fracture_mesh_t) :: fracture
      logical, parameter :: always(1) = .true.

      call start(simulation)
      fracture%n_cells = 2
      fracture%cell_fracture = [1_ik, 1_ik]
      fracture%cell_points = reshape([1_ik, 2_ik, 2_ik, 3_ik], [2, 2])
      fracture%point_xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 3.0_rk, 0.0_rk], [2, 3])
      call simulation%note_contact(fracture, [state_stick, state_slip], always, always)
      call simulation%note_contact(fracture, [state_slip, state_slip], always, always)
      call simulation%note_contact(fracture, [state_open, state_open], always,.not. always)
      call simulation%note_contact(fracture, [state_open, state_slip], always, always)
      call kinds_are(simulation, [character(len=10) :: event_slip_onset, event_opening])
      if (size(simulation%chronicle%events) == 2) then
         call checks%is_close(simulation%chronicle%events(1)%xy(1), 2.0_rk, 0.0_rk, "slip: where")
         call checks%is_close(simulation%chronicle%events(2)%xy(1), 0.5_rk, 0.0_rk, &
                              "opening: where")
      end if
   end subroutine test_contact

   !> The scene ends once a tip has grown by the prescribed gain.
   subroutine test_gain()
      type(two_levels_t), save :: simulation

      call start(simulation)
      simulation%rules%stop_gain = 0.1_rk
      simulation%network%xy(1, 2) = 1.29_rk
      call simulation%end_at_gain()
      call checks%is_true(.not. simulation%is_over(), "0.09 m are not enough")
      simulation%network%xy(1, 2) = 1.31_rk
      call simulation%end_at_gain()
      call checks%is_true(simulation%is_over(), "0.11 m are")
      simulation%owes_state = .true.
      call checks%is_true(.not. simulation%is_over(), "but for one more state")
   end subroutine test_gain

   !> Two tips have grown in one group and separate. An event tells it if their K_eq were equal,
   !! once the difference of their gains exceeds the sum of their errors and a tenth of the shorter
   !! increment; none tells a difference with a reason.
   subroutine test_separation()
      real(rk), parameter :: equal(2) = [0.0_rk, -0.02_rk], other(2) = [0.0_rk, -0.3_rk]

      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.029_rk) == 1, "by chance")
      call checks%is_true(n_separations(equal, [0.05_rk, 0.11_rk], 0.029_rk) == 1, "the other one")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.031_rk) == 1, "within errors")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.108_rk], 0.0_rk) == 0, "hardly")
      call checks%is_true(n_separations(equal, [0.0011_rk, 0.001_rk], 0.0_rk) == 0, &
                          "hardly, over the increment")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.107_rk], 0.0_rk, increments= &
                                        [0.02_rk, 0.04_rk]) == 1, "of the shorter increment")
      call checks%is_true(n_separations(other, [0.11_rk, 0.05_rk], 0.0_rk) == 0, "with a reason")
      call checks%is_true(n_separations(other, [0.11_rk, 0.05_rk], 0.0_rk, off=0.3_rk) == 1, &
                          "K_eq known to 30 %")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.0_rk, arrested=.true.) == 0, &
                          "one has met a target")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.0_rk, first=2_ik) == 0, &
                          "never one group")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.0_rk, other=.true.) == 0, &
                          "of another fracture, behind")
      call checks%is_true(n_separations(equal, [0.11_rk, 0.05_rk], 0.0_rk, other=.false.) == 1, &
                          "of another fracture, equal")
   end subroutine test_separation

   !> Number of events of two tips that have grown by 0.02 m, in one group unless `first` says
   !! another one, and then by different gains.
   integer function n_separations(excess, gain, error, off, increments, arrested, first, &
                                  other) result(n)
      real(rk), intent(in) :: excess(2)  !< of K_eq over K_IC when they separate [-]
      real(rk), intent(in) :: gain(2)  !< [m]
      real(rk), intent(in) :: error  !< of the position of each [m]
      real(rk), intent(in), optional :: off  !< error of K_eq over K_IC [-]
      real(rk), intent(in), optional :: increments(2)  !< [m]
      logical, intent(in), optional :: arrested  !< the tip behind is
      integer(ik), intent(in), optional :: first  !< group of the second tip at first
      !> the second tip is one of another fracture, and has fallen behind its group
      logical, intent(in), optional :: other
      type(two_levels_t) :: simulation
      real(rk) :: increment(2)
      integer :: k

      increment = 0.05_rk
      if (present(increments)) increment = increments
      call start(simulation)
      call simulation%notes%begin(2)
      simulation%tip%drive%intensity = toughness*(1.0_rk + excess)
      if (present(off)) simulation%tip%intensity%k1_error = off*toughness
      allocate (simulation%now%segment(2))
      simulation%now%segment%gain = 0.02_rk
      associate (groups => simulation%now%groups)
         groups%kind = [1_ik, 1_ik]
         if (present(first)) groups%kind(2) = first
         groups%usual = [0.0_rk, 0.0_rk]
         groups%is_alone = [.false., .false.]
      end associate
      simulation%now%stated_errors%tip = [error, error]
      simulation%now%stated_errors%position = [error, error]
      call note(simulation, increment)
      simulation%now%groups%kind = [1_ik, 2_ik]
      if (present(other)) then
         simulation%tip(2)%fracture = 2
         simulation%now%groups%is_alone(2) = other
      end if
      call note(simulation, increment)
      ! What they are later does not matter.
      simulation%tip%drive%intensity = toughness
      simulation%now%segment%gain = gain
      if (present(arrested)) then
         associate (behind => simulation%tip(minloc(gain, dim=1)))
            behind%arrested = arrested
            if (arrested) behind%target = target_boundary
         end associate
      end if
      do k = 1, 2
         call note(simulation, increment)
      end do
      n = size(simulation%chronicle%events)
      if (n > 0) then
         associate (tip => simulation%tip(maxloc(gain, dim=1)))
            call checks%is_close(norm2(simulation%chronicle%events(1)%xy - tip%xy), 0.0_rk, &
                                 0.0_rk, "the one ahead")
         end associate
         call checks%is_true(simulation%chronicle%events(1)%kind == event_bifurcation, "event")
         ! One of the two may as well be where the other one is; added once.
         call checks%is_close(simulation%now%stated_errors%length, &
                              max(0.0_rk, abs(gain(1) - gain(2)) - error), 1.0e-15_rk, &
                              "the lead beyond the errors of the positions")
         call checks%is_close(minval(simulation%now%stated_errors%position), &
                              max(error, abs(gain(1) - gain(2))), 1.0e-15_rk, &
                              "the error of the tip that is behind, too")
      end if
   end function n_separations

   !> Note the separation of tips in the present state.
   subroutine note(simulation, increment)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: increment(:)  !< (tips) [m]

      call simulation%notes%note_separation(simulation%tip, simulation%now, toughness, increment, &
                                            simulation%chronicle)
   end subroutine note

end program test_twolevel_event_log
