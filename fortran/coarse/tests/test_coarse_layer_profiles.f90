!> Layers from one mesh to the next: the same faces keep pressures and content; faces that consist
!! of halves of two others have the means of their pressures; no fluid is made or lost, also where
!! the new mesh has no layers. Pressures at points before faces: exact in steady flow.
program test_coarse_layer_profiles
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use base_timers, only: timers_t
   use coarse_layer_profiles, only: find_pressure, kept_faces_t, profiles_of, profiles_t, &
                                    return_excess, set_apart, take_profiles
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, hold, load_sides, mesh_square, porous_body, straight_network, &
                            uniform_cells
   use scene_types, only: initial_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   !> A fracture from side to side.
   real(rk), parameter :: line(2, 2, 1) = reshape([0.0_rk, 1.0_rk, 2.0_rk, 1.0_rk], [2, 2, 1])
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   type(coarse_model_t) :: model
   type(state_t) :: state

   call take_in_fluid()
   call same_faces()
   call moved_faces()
   call points_in_steady_flow()
   call checks%finish()

contains

   !> Fluid goes into the layers, more of it the farther along the fracture.
   subroutine take_in_fluid()
      integer(ik) :: i

      scene = porous_body()
      call hold(scene)
      call mesh_square(checks, straight_network(line), 0.25_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      model%first_step = 1.0e-2_rk
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, initial_t(pressure=1.0e6_rk), model, state)
      model%cells%injection = [(1.0e-10_rk*i, i=1, mesh%fracture%n_cells)]
      do i = 1, 4
         call model%advance(mesh, 0.1_rk, state, timers, report, error)
         call checks%no_error(error, "step")
      end do
   end subroutine take_in_fluid

   !> All faces are those before.
   subroutine same_faces()
      type(kept_faces_t) :: faces
      type(state_t) :: after
      integer(ik) :: c, n

      n = mesh%fracture%n_cells
      faces%before%first = [(c, c=1, n + 1)]
      faces%before%item = [(c, c=1, n)]
      faces%of_old = spread(1.0_rk, 1, int(n))
      faces%of_new = faces%of_old
      after = state
      call carry_over(faces, .true., after)
      call checks%is_close(maxval(abs(after%layer - state%layer)), 0.0_rk, 1.0e-3_rk, &
                           "inner nodes [Pa]")
      associate (scale => maxval(abs(state%content)))
         call checks%is_close(maxval(abs(after%content - state%content))/scale, 0.0_rk, &
                              1.0e-12_rk, "content of each cell")
      end associate
      call checks%is_close(maxval(abs(after%unknowns(3, :mesh%n_cells) &
                                      - state%unknowns(3, :mesh%n_cells))), 0.0_rk, 1.0e-3_rk, &
                           "means of the cells [Pa]")
   end subroutine same_faces

   !> Each face consists of the second half of one and the first half of the next; the first half of
   !! the first one is left to the first, the last half of the last to the last.
   subroutine moved_faces()
      type(kept_faces_t) :: faces
      type(state_t) :: after
      integer(ik) :: c, l, n, next
      real(rk) :: largest

      n = mesh%fracture%n_cells
      faces%before%first = [(2*c - 1, c=1, n + 1)]
      faces%before%item = [(c, min(c + 1, n), c=1, n)]
      faces%of_old = spread(0.5_rk, 1, int(2*n))
      faces%of_old(1) = 1.0_rk
      faces%of_old(2*n) = 0.0_rk  ! of the last face the other half counts
      faces%of_new = spread(0.5_rk, 1, int(2*n))
      after = state
      call carry_over(faces, .true., after)
      call checks%is_close(sum(after%content)/sum(state%content), 1.0_rk, 1.0e-13_rk, &
                           "fluid in the rock, faces moved")
      largest = 0.0_rk
      do l = 1, model%layers%n
         next = findloc(model%layers%fracture_cell == min(n, model%layers%fracture_cell(l) + 1) &
                        .and. model%layers%side == model%layers%side(l), .true., dim=1)
         largest = max(largest, abs(beyond(after, l) &
                                    - 0.5_rk*(beyond(state, l) + beyond(state, next))))
      end do
      ! Linear interpolation between nodes whose places differ from face to face
      call checks%is_close(largest/beyond(state, findloc(model%layers%fracture_cell, n, dim=1)), &
                           0.0_rk, 0.05_rk, "pressure next to moved faces")
      after = state
      call carry_over(faces, .false., after)
      call checks%is_close(sum(after%content)/sum(state%content), 1.0_rk, 1.0e-13_rk, &
                           "fluid in the rock without layers")
   end subroutine moved_faces

   !> Pressure of the first node beyond that of the rest of the cell [Pa].
   real(rk) function beyond(at, l)
      type(state_t), intent(in) :: at
      integer(ik), intent(in) :: l  !< layer

      beyond = at%layer(1, l) &
               - at%unknowns(3, (model%layers%at(2, mesh%cell_layer(model%layers%cell(l))) + 2)/3)
   end function beyond

   !> Steady flow from right to left, across a fracture: the pressure is linear, and so it is in the
   !! layers, in and beyond their chains.
   subroutine points_in_steady_flow()
      real(rk), parameter :: across(2, 2, 1) = reshape([1.0_rk, 0.0_rk, 1.0_rk, 2.0_rk], [2, 2, 1])
      real(rk), parameter :: drop = 2.0e7_rk  ! per m [Pa/m]
      real(rk), parameter :: depth(5) = [1.0e-5_rk, 1.0e-3_rk, 0.03_rk, 0.08_rk, 0.15_rk]
      real(rk) :: found, largest, weight(3), xy(2)
      integer(ik) :: c, i, k

      scene = porous_body()
      call hold(scene)
      call load_sides(scene, [-60.0e6_rk, -60.0e6_rk, 0.0_rk])
      scene%sides(1:2)%pressure_given = .true.
      scene%sides(2)%pressure = 2.0_rk*drop
      call mesh_square(checks, straight_network(across), 0.25_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization with drained sides")
      call new_state(mesh, model%cells, initial_t(), model, state)
      call advance(checks, model, mesh, 1.0e12_rk, state, report, "steady flow")
      largest = 0.0_rk
      do i = 1, size(depth)
         xy = [depth(i), 0.31_rk]
         do c = 1, mesh%n_cells
            weight = barycentric(mesh%xy(:, mesh%cell_nodes(:, c)), xy)
            if (all(weight >= 0.0_rk)) exit
         end do
         found = -1.0_rk
         call find_pressure(model%layers, [(k, k=1, model%layers%n)], mesh, [integer(ik) ::], &
                            state%unknowns, state%layer, xy, c, &
                            drop*mesh%xy(1, mesh%cell_nodes(:, c)), found)
         largest = max(largest, abs(found - drop*xy(1)))
      end do
      call checks%is_close(largest/drop, 0.0_rk, 1.0e-5_rk, "pressure at points, steady flow")
   end subroutine points_in_steady_flow

   !> From the mesh to itself, with or without layers on the new one.
   subroutine carry_over(faces, has_layers, after)
      type(kept_faces_t), intent(in) :: faces
      logical, intent(in) :: has_layers
      type(state_t), intent(inout) :: after
      type(profiles_t) :: profiles
      integer(ik) :: c
      integer(ik), allocatable :: cell_old(:)

      cell_old = [(c, c=1, mesh%n_cells)]
      profiles = profiles_of(model%layers, after%unknowns, after%layer)
      call set_apart(model%layers, cell_old, faces, after%unknowns, after%content, profiles)
      call return_excess(profiles, mesh, cell_old, faces, after%content)
      if (.not. has_layers) return
      call take_profiles(model%layers, profiles, cell_old, faces, after%unknowns, after%layer)
   end subroutine carry_over

end program test_coarse_layer_profiles
