!> Slip events by hand: patches that go on, divide, meet and come to rest; moment and magnitude;
!! stress drop, and what is seismic.
program test_report_slip
   use base_kinds, only: ik, rk
   use contact_law, only: state_open, state_slip, state_stick
   use mesh_types, only: fracture_mesh_t
   use report_slip, only: magnitude, slip_catalogue_t, slip_step_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer, parameter :: n = 8
   real(rk), parameter :: shear = 10.0e9_rk, breadth = 2.0_rk, dt = 0.5_rk, slip = 1.0e-3_rk
   type(checks_t) :: checks
   type(fracture_mesh_t) :: fracture
   type(slip_catalogue_t) :: catalogue
   real(rk) :: modulus(n) = shear

   call make_fractures()
   call test_one()
   call test_division_and_meeting()
   call test_meeting_rates()
   call test_two_rocks()
   call test_other_mesh()
   call test_end_of_run()
   call test_seismic()
   call test_stress_drop()
   call test_meeting_speeds()
   call test_magnitude()
   call checks%finish()

contains

   !> Two fractures along x, of five cells from 0 to 5 m, and of three from 5 to 8 m.
   subroutine make_fractures()
      integer(ik) :: i

      fracture%n_cells = n
      fracture%cell_fracture = [1_ik, 1_ik, 1_ik, 1_ik, 1_ik, 2_ik, 2_ik, 2_ik]
      fracture%cell_points = reshape([(i, i + 1, i=1, n)], [2, n])
      fracture%cell_s = reshape([(real(i - 1, rk), real(i, rk), i=1, n)], [2, n])
      fracture%point_xy = reshape([(real(i, rk), 0.0_rk, i=0, n)], [2, n + 1])
   end subroutine make_fractures

   !> A step in which the given cells slip by 1 mm, those of `apart` without contact.
   subroutine step(time, cells, apart, is_sudden, faster, traction)
      real(rk), intent(in) :: time  !< [s]
      integer, intent(in) :: cells(:)
      integer, intent(in) :: apart(:)
      logical, intent(in), optional :: is_sudden  !< default: no
      real(rk), intent(in), optional :: faster(:)  !< (n) times 1 mm that the cells slip [-]
      real(rk), intent(in), optional :: traction(:)  !< (n) f_tau after the step; default: 0 [Pa]
      real(rk) :: after(n), potency(n)
      integer(ik) :: state(n)
      logical :: sudden

      state = state_stick
      state(cells) = state_slip
      state(apart) = state_open
      sudden = .false.
      if (present(is_sudden)) sudden = is_sudden
      potency = merge(slip, 0.0_rk, state /= state_stick)
      if (present(faster)) potency = faster*potency
      after = 0.0_rk
      if (present(traction)) after = traction
      call catalogue%follow(time, fracture, slip_step_t(dt, potency, modulus, state, after, sudden))
   end subroutine step

   !> Two steps on a patch that moves, then rest.
   subroutine test_one()
      call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
      call step(0.5_rk, [2, 3], [integer ::])
      call step(1.0_rk, [3, 4], [3], is_sudden=.true.)
      call checks%is_true(size(catalogue%news) == 0, "it is not over")
      call step(1.5_rk, [integer ::], [integer ::])
      call checks%is_true(size(catalogue%news) == 1, "it is")
      associate (event => catalogue%news(1))
         call checks%is_true(event%number == 1 .and. event%fracture == 1, "number and fracture")
         call checks%is_close(event%time, 0.0_rk, 0.0_rk, "begins with the first step")
         call checks%is_close(event%end, 1.0_rk, 0.0_rk, "ends with the last")
         call checks%is_close(maxval(abs(event%s - [1.0_rk, 4.0_rk])), 0.0_rk, 1.0e-15_rk, "where")
         call checks%is_close(event%xy(1), 2.5_rk, 1.0e-14_rk, "centre")
         call checks%is_close(event%area, 6.0_rk, 1.0e-14_rk, "area")
         call checks%is_close(event%mean_slip, 4.0_rk*slip/3.0_rk, 1.0e-17_rk, "mean slip")
         call checks%is_close(event%moment, 4.0_rk*slip*shear*breadth, 1.0e-6_rk, "moment")
         call checks%is_close(event%largest_rate, 2.0_rk*slip*shear*breadth/dt, 1.0e-6_rk, "rate")
         call checks%is_close(event%sudden_share, 0.5_rk, 1.0e-15_rk, "share of the second step")
         call checks%is_close(event%open_share, 0.25_rk, 1.0e-15_rk, "share of open faces")
         call checks%is_true(event%ended_by == "stick" .and. .not. event%is_seismic, "it sticks")
      end associate
   end subroutine test_one

   !> A patch that divides stays one event; two that meet become the earlier one. The end of one
   !! fracture and the beginning of the next are neighbours in the list only.
   subroutine test_division_and_meeting()
      call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
      call step(0.5_rk, [5, 6], [integer ::])
      call step(1.0_rk, [2, 5, 6], [integer ::])
      call step(1.5_rk, [2, 3, 4, 5, 6, 8], [integer ::])
      call step(2.0_rk, [1, 5, 6], [integer ::])
      call step(2.5_rk, [5], [integer ::])
      call step(3.0_rk, [integer ::], [integer ::])
      associate (events => catalogue%news)
         call checks%is_true(size(events) == 4, "four events")
         if (size(events) /= 4) return
         call checks%is_true(all(events%fracture == [2, 2, 1, 1]), "on both fractures")
         call checks%is_true(all(events%number == [1, 2, 3, 4]), "numbered as they end")
         ! 8 alone; 1 alone; 6 for four steps; 5 with 2 and all between.
         call checks%is_close(sum(events%moment)/(slip*shear*breadth), 15.0_rk, 1.0e-12_rk, &
                              "every cell's slip belongs to one of them")
         call checks%is_close(events(4)%moment/(slip*shear*breadth), 9.0_rk, 1.0e-12_rk, &
                              "those that meet are one")
         call checks%is_close(events(4)%largest_rate/(slip*shear*breadth/dt), 4.0_rk, 1.0e-12_rk, &
                              "its rate is that of all its patches")
         call checks%is_close(events(4)%time, 0.0_rk, 0.0_rk, "which began with the first")
         call checks%is_close(maxval(abs(events(4)%s - [1.0_rk, 5.0_rk])), 0.0_rk, 1.0e-15_rk, &
                              "and covers both")
      end associate
   end subroutine test_division_and_meeting

   !> Of two events that meet, the faster one's rate stays, whichever comes first.
   subroutine test_meeting_rates()
      integer :: fast, i

      do fast = 1, 5, 4
         call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
        call step(0.5_rk, [1, 5], [integer ::], faster=[(merge(9.0_rk, 1.0_rk, i == fast), i=1, n)])
         call step(1.0_rk, [1, 2, 3, 4, 5], [integer ::])
         call catalogue%end_all()
         call checks%is_true(size(catalogue%news) == 1, "they meet")
         call checks%is_close(catalogue%news(1)%largest_rate*dt/(slip*shear*breadth), 9.0_rk, &
                              1.0e-12_rk, "the faster one's rate")
      end do
   end subroutine test_meeting_rates

   !> Slip in two rocks, the second a tenth as stiff: shares, moment and place are those of the
   !! moment, the mean slip is that of both.
   subroutine test_two_rocks()
      call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
      modulus(3:) = 0.1_rk*shear
      call step(0.5_rk, [2, 3], [3])
      call step(1.0_rk, [3], [integer ::], is_sudden=.true.)
      call catalogue%end_all()
      modulus = shear
      associate (event => catalogue%news(1))
         call checks%is_close(event%moment/(slip*shear*breadth), 1.2_rk, 1.0e-12_rk, "both rocks")
         call checks%is_close(event%largest_rate*dt/(slip*shear*breadth), 1.1_rk, 1.0e-12_rk, &
                              "rate in both rocks")
         call checks%is_close(event%magnitude, (log10(event%moment) - 9.1_rk)/1.5_rk, 1.0e-12_rk, &
                              "magnitude of that moment")
         call checks%is_close(event%open_share, 0.1_rk/1.2_rk, 1.0e-12_rk, "open share of it")
         call checks%is_close(event%sudden_share, 0.1_rk/1.2_rk, 1.0e-12_rk, "sudden share of it")
         call checks%is_close(event%xy(1), (1.5_rk + 0.2_rk*2.5_rk)/1.2_rk, 1.0e-12_rk, "place")
         call checks%is_close(event%mean_slip, 1.5_rk*slip, 1.0e-15_rk, "mean slip")
      end associate
   end subroutine test_two_rocks

   !> Growth divides cells: the event goes on, told by arc lengths.
   subroutine test_other_mesh()
      type(fracture_mesh_t) :: finer
      integer(ik) :: i

      call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
      call step(0.5_rk, [3], [integer ::])
      finer%n_cells = 10
      finer%cell_fracture = spread(1_ik, 1, 10)
      finer%cell_points = reshape([(i, i + 1, i=1, 10)], [2, 10])
      finer%cell_s = reshape([(0.5_rk*(i - 1), 0.5_rk*i, i=1, 10)], [2, 10])
      finer%point_xy = reshape([(0.5_rk*i, 0.0_rk, i=0, 10)], [2, 11])
      call catalogue%follow(1.0_rk, finer, &
                            slip_step_t(dt, [(merge(0.5_rk*slip, 0.0_rk, i == 6), i=1, 10)], &
                                        spread(shear, 1, 10), &
                                        [(merge(state_slip, state_stick, i == 6), i=1, 10)], &
                                        spread(0.0_rk, 1, 10)))
      call catalogue%end_all()
      call checks%is_true(size(catalogue%news) == 1, "one event on two meshes")
      call checks%is_close(catalogue%news(1)%moment, 1.5_rk*slip*shear*breadth, 1.0e-6_rk, &
                           "with the slip of both")
      call checks%is_close(catalogue%news(1)%area, 2.0_rk, 1.0e-15_rk, "over the larger one")
   end subroutine test_other_mesh

   !> What still slips when the run ends is listed as such; what slips too little is not.
   subroutine test_end_of_run()
      call catalogue%begin(breadth, 1.5_rk*slip, 1.0_rk)
      call step(0.5_rk, [1, 7], [integer ::])
      call step(1.0_rk, [7], [integer ::])
      call catalogue%end_all()
      call checks%is_true(size(catalogue%news) == 1, "too little slip is no event")
      call checks%is_true(catalogue%news(1)%ended_by == "run", "the run ends it")
      call checks%is_close(catalogue%news(1)%end, 1.0_rk, 0.0_rk, "at its end")
      call catalogue%end_all()
      call checks%is_true(size(catalogue%news) == 1, "once")
   end subroutine test_end_of_run

   !> Creep, 10 mm/s for two steps, creep again: three events, with the slip of each; the fast one
   !! nucleates where it is fastest in its first step.
   subroutine test_seismic()
      call catalogue%begin(breadth, 1.0e-6_rk, 4.5e-3_rk)
      call step(0.5_rk, [2, 3, 4], [integer ::])
      call step(1.0_rk, [2, 3, 4], [integer ::], faster=real([1, 1, 3, 5, 1, 1, 1, 1], rk))
      call step(1.5_rk, [1, 2, 3, 4], [integer ::], faster=real([1, 1, 9, 5, 1, 1, 1, 1], rk))
      call step(2.0_rk, [1, 2], [integer ::])
      call step(2.5_rk, [integer ::], [integer ::])
      associate (events => catalogue%news)
         call checks%is_true(size(events) == 3, "three events")
         if (size(events) /= 3) return
         call checks%is_true(all(events%is_seismic .eqv. [.false., .true., .false.]), "the second")
         call checks%is_true(all(events%ended_by == ["speed", "speed", "stick"]), "what ends them")
         call checks%is_close(maxval(abs(events%time - [0.0_rk, 0.5_rk, 1.5_rk])), 0.0_rk, 0.0_rk, &
                              "when they begin")
         call checks%is_close(maxval(abs(events%end - [0.5_rk, 1.5_rk, 2.0_rk])), 0.0_rk, 0.0_rk, &
                              "and end")
         call checks%is_close(maxval(abs(events%moment/(slip*shear*breadth) &
                                         - [3.0_rk, 25.0_rk, 2.0_rk])), 0.0_rk, 1.0e-12_rk, &
                              "the slip of each")
         call checks%is_close(events(2)%onset_xy(1), 3.5_rk, 1.0e-14_rk, "nucleation")
         call checks%is_close(events(2)%largest_slip_rate, 1.8e-2_rk, 1.0e-15_rk, "largest rate")
         call checks%is_close(events(2)%mean_slip_rate, 25.0_rk*slip/4.0_rk, 1.0e-15_rk, &
                              "mean rate")
         call checks%is_close(maxval(abs(events(2)%s - [0.0_rk, 4.0_rk])), 0.0_rk, 1.0e-15_rk, &
                              "its patch")
         call checks%is_close(maxval(abs(events(3)%s - [0.0_rk, 2.0_rk])), 0.0_rk, 1.0e-15_rk, &
                              "not that of what comes after it")
      end associate
   end subroutine test_seismic

   !> Tractions fall from before the first step to after the last one, of either sign, and on cells
   !! that are reached later; others of the fracture do not count.
   subroutine test_stress_drop()
      call catalogue%begin(breadth, 1.0e-6_rk, 1.0_rk)
      call catalogue%remember(fracture, 1.0e6_rk*real([1, -5, 5, 5, 7, 9, 9, 9], rk))
      call step(0.5_rk, [2, 3], [integer ::], traction=1.0e6_rk*real([2, -4, 4, 6, 6, 0, 0, 0], rk))
      call step(1.0_rk, [3, 4], [integer ::], traction=1.0e6_rk*real([2, 1, 2, 3, 5, 0, 0, 0], rk))
      call step(1.5_rk, [integer ::], [integer ::])
      call checks%is_true(size(catalogue%news) == 1, "one event")
      ! 5 + 1, 5 - 2, 5 - 3 MPa
      call checks%is_close(catalogue%news(1)%stress_drop, 11.0e6_rk/3.0_rk, 1.0e-6_rk, &
                           "stress drop")
   end subroutine test_stress_drop

   !> A creeping patch that meets a fast one is over; the fast one goes on with what follows.
   subroutine test_meeting_speeds()
      call catalogue%begin(breadth, 1.0e-6_rk, 4.5e-3_rk)
      call step(0.5_rk, [1, 4], [integer ::], faster=real([1, 1, 1, 5, 1, 1, 1, 1], rk))
      call step(1.0_rk, [1, 2, 3, 4], [integer ::], faster=real([1, 1, 1, 5, 1, 1, 1, 1], rk))
      call step(1.5_rk, [integer ::], [integer ::])
      associate (events => catalogue%news)
         call checks%is_true(size(events) == 2, "two events")
         if (size(events) /= 2) return
         call checks%is_true(all(events%is_seismic .eqv. [.false., .true.]), "the creep ends first")
         call checks%is_close(maxval(abs(events%moment/(slip*shear*breadth) &
                                         - [1.0_rk, 13.0_rk])), 0.0_rk, 1.0e-12_rk, &
                              "no slip is lost or counted twice")
      end associate
   end subroutine test_meeting_speeds

   !> M_w = 6 has 10^18.1 N m = 1.2589e18 N m.
   subroutine test_magnitude()
      call checks%is_close(magnitude(10.0_rk**18.1_rk), 6.0_rk, 1.0e-13_rk, "magnitude 6")
      call checks%is_close(magnitude(1.0e5_rk), -4.1_rk/1.5_rk, 1.0e-13_rk, "a small one")
   end subroutine test_magnitude

end program test_report_slip
