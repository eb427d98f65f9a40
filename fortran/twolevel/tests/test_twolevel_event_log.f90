!> Event log and rows of the tips: before and after growth, joints, arrests, contact.
program test_twolevel_event_log
   use base_kinds, only: ik, rk
   use contact_law, only: state_open, state_slip, state_stick
   use growth_network, only: network_of_scene
   use growth_targets, only: target_boundary
   use mesh_types, only: fracture_mesh_t
   use report_rows, only: event_arrest, event_growth, event_joint, event_opening, event_slip_onset
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_rows_of_tips()
   call test_growth()
   call test_contact()
   call test_gain()
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
      type(two_levels_t) :: simulation

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
         call checks%is_close(maxval(abs(row%k1 - [16.0_rk, 17.0_rk, 26.0_rk, 27.0_rk])), 0.0_rk, &
                              0.0_rk, "before, then after")
         call checks%is_close(row(1)%xy(1), 0.8_rk, 0.0_rk, "grown: where it was")
         call checks%is_close(row(1)%advance, 0.1_rk, 1.0e-15_rk, "and how far it went")
         call checks%is_close(row(1)%angle, 0.25_rk, 0.0_rk, "in which direction")
         call checks%is_close(row(3)%xy(1), 0.7_rk, 0.0_rk, "then: where it is")
         call checks%is_close(row(2)%xy(1), 1.2_rk, 0.0_rk, "the other stays")
      end associate
   end subroutine test_rows_of_tips

   !> One tip joins the boundary; the other stops before it, which is reported once.
   subroutine test_growth()
      type(two_levels_t) :: simulation

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
      type(two_levels_t) :: simulation
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
      type(two_levels_t) :: simulation

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

end program test_twolevel_event_log
