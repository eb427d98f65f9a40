!> The back stress of layers of fluid pressure: integrals with the weight function of a half-plane
!! crack, and a layer on the faces of a crack.
program test_twolevel_back_stress
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_layout, only: end_block, layer_block
   use sample_scenes, only: add_fracture, evaluate_initial_state, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_back_stress, only: back_stress_of, weighted
   use twolevel_drained_tips, only: layer_at_tip, layer_t
   use twolevel_state, only: two_levels_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_one_long_strip()
   call test_strips()
   call test_layer()
   call test_closed()
   call checks%finish()

contains

   !> On a long strip from the tip on, a pressure that is linear in the distance has its half moment
   !! times the root of two. The strip ends far away: 1e-12 of it is missing.
   subroutine test_one_long_strip()
      real(rk), parameter :: thickness = 0.01_rk  ! [m]

      call checks%is_close(weighted([0.0_rk, 1.0e6_rk], [0.0_rk, 0.3_rk*thickness, thickness], &
                                    [1.0_rk, 0.7_rk, 0.0_rk]), &
                           sqrt(2.0_rk*thickness)*4.0_rk/3.0_rk, 1.0e-9_rk, "half moment")
   end subroutine test_one_long_strip

   !> Strips of finite length, against the same integrals with 400 points.
   subroutine test_strips()
      real(rk), parameter :: place(3) = [0.0_rk, 0.002_rk, 0.006_rk]  ! [m]
      real(rk), parameter :: pressure(3) = [5.0_rk, 3.0_rk, 0.0_rk]  ! [Pa]
      real(rk) :: near, far

      near = weighted([0.0_rk, 0.01_rk], place, pressure)
      far = weighted([0.01_rk, 0.03_rk], place, pressure)
      call checks%is_close(near, 0.673712865146_rk, 1.0e-6_rk, "at the tip")
      call checks%is_close(far, 0.020496054836_rk, 1.0e-6_rk, "behind it")
      call checks%is_close(weighted([0.0_rk, 0.03_rk], place, pressure), near + far, 1.0e-12_rk, &
                           "both")
   end subroutine test_strips

   !> A layer closes a tip, and a joint that is closed stays as it is.
   subroutine test_closed()
      type(window_tip_t) :: tip
      real(rk), parameter :: modulus = 4.0e10_rk  ! [Pa]

      tip%back_stress = -2.0e6_rk
      tip%found%k1 = 3.0e6_rk
      associate (k => tip%with_coarse_error(modulus))
         call checks%is_close(k%k1, 1.0e6_rk, 1.0e-3_rk, "less by the layer")
      end associate
      tip%found%k1 = 1.0e6_rk
      associate (k => tip%with_coarse_error(modulus))
         call checks%is_close(k%k1, 0.0_rk, 1.0e-3_rk, "closed")
      end associate
      tip%found%k1 = -3.0e6_rk
      tip%found%k1_corrected = -3.0e6_rk
      associate (k => tip%with_coarse_error(modulus))
         call checks%is_close(k%k1, -3.0e6_rk, 1.0e-3_rk, "joint")
         call checks%is_close(k%k1_corrected, -3.0e6_rk, 1.0e-3_rk, "joint, corrected")
      end associate
   end subroutine test_closed

   !> The layer of a pressure dp that began a time t ago, dp erfc(n/(2 sqrt(c t))), against the
   !! closed form of docs/theory.md times the half moment of the layer, linear between its nodes,
   !! over that of the profile (2 sqrt(2) (c t)^(1/4) Gamma(3/4)/sqrt(pi)). What lies beyond the
   !! other tip, 0.4 m away, is (n/0.4 m)^(3/2) of the layer, at most 0.4 %.
   subroutine test_layer()
      real(rk), parameter :: dp = 1.0e6_rk  ! [Pa]
      real(rk), parameter :: old = huge(1.0_rk)  ! [s]
      type(two_levels_t), save :: simulation
      type(scene_t) :: scene
      type(layer_t) :: data
      type(error_t), allocatable :: error
      real(rk) :: exact, moment(2), reach
      integer(ik) :: cell, end, l, side

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      call add_fracture(scene, "f", [0.8_rk, 1.2_rk], [0.9_rk, 1.1_rk], 0.5_rk, 0.0_rk)
      call evaluate_initial_state(scene, simulation, timers, error)
      call checks%no_error(error, "initial state")
      associate (problem => simulation%problem, state => simulation%now%coarse)
         call checks%is_close(back_stress_of(problem, state, 1_ik, 1_ik, old), 0.0_rk, 0.0_rk, &
                              "no layer in undrained rock")
         problem%values%undrained = .false.
         problem%values%nodal = 0.0_rk
         deallocate (problem%values%drained)
         allocate (problem%values%drained(0))
         state%unknowns(3, :) = 0.0_rk
         associate (layers => problem%model%layers, mesh => problem%mesh)
            call checks%is_true(layers%n == 2*mesh%fracture%n_cells, "both faces have layers")
            reach = minval([(layers%chain(l)%place(layers%chain(l)%n), l=1, layers%n)])/5.0_rk
            do l = 1, layers%n
               associate (chain => layers%chain(l))
                  state%unknowns(3, end_block(mesh, layers%fracture_cell(l), layers%side(l))) = dp
                  state%layer(:chain%n - 1, l) = dp*erfc(chain%place(:chain%n - 1)/(2.0_rk*reach))
                  state%unknowns(:, layer_block(mesh, l)) = 0.0_rk
               end associate
            end do
         end associate
         do end = 1, 2
            data = layer_at_tip(problem%mesh, problem%model%rock, state, &
                                problem%values, 1_ik, end)
            associate (fracture => problem%mesh%fracture, layers => problem%model%layers)
               do side = 1, 2
                  cell = merge(1_ik, fracture%n_cells, end == 1)
                  l = problem%mesh%face_layer(fracture%cell_faces(side, cell))
                  associate (place => layers%chain(l)%place, n => layers%chain(l)%n)
                     moment(side) = half_moment([0.0_rk, place], &
                                                [dp, state%layer(:n - 1, l), 0.0_rk])
                  end associate
               end do
            end associate
            exact = -0.5_rk*(1.0_rk + data%drained_tip)*sqrt(2.0_rk)/gamma(1.25_rk)*data%eta*dp &
                    *sqrt(reach)*(0.5_rk*sum(moment)/(dp*2.0_rk*sqrt(2.0_rk*reach) &
                                                      *gamma(0.75_rk)/sqrt(pi)))
            call checks%is_close(back_stress_of(problem, state, 1_ik, end, old), exact, &
                                 0.005_rk*abs(exact), "back stress")
            call checks%is_close(back_stress_of(problem, state, 1_ik, end, &
                                                (0.25_rk*reach)**2/data%diffusivity), &
                                 -0.5_rk*(1.0_rk + data%drained_tip)*sqrt(2.0_rk) &
                                 /gamma(1.25_rk)*data%eta*dp*sqrt(0.25_rk*reach), &
                                 1.0e-9_rk*abs(exact), "back stress of a younger layer")
            call checks%is_close(0.5_rk*sum(moment)/dp, &
                                 2.0_rk*sqrt(2.0_rk*reach)*gamma(0.75_rk)/sqrt(pi), &
                                 0.05_rk*sqrt(reach)*2.0_rk, "half moment of the nodes")
         end do
      end associate
   end subroutine test_layer

   !> Integral of values that are linear between places over the root of the place.
   pure real(rk) function half_moment(place, value)
      real(rk), intent(in) :: place(:)  !< [m]
      real(rk), intent(in) :: value(:)  !< [Pa]
      real(rk) :: slope
      integer :: i

      half_moment = 0.0_rk
      do i = 1, size(place) - 1
         slope = (value(i + 1) - value(i))/(place(i + 1) - place(i))
         half_moment = half_moment + 2.0_rk*(value(i) - slope*place(i)) &
                       *(sqrt(place(i + 1)) - sqrt(place(i))) &
                       + slope/1.5_rk*(place(i + 1)**1.5_rk - place(i)**1.5_rk)
      end do
   end function half_moment

end program test_twolevel_back_stress
