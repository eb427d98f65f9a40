!> Growth of the coarse mesh with the network: remeshing around the tips, and the transfer of the
!! state to the new mesh.
submodule(twolevel_state) twolevel_remeshing
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_timers, only: phase_remesh, phase_transfer
   use base_tolerances, only: same_place
   use coarse_layer_profiles, only: kept_faces_t, no_profiles, profiles_of, profiles_t, &
                                    return_excess, set_apart, take_profiles
   use coarse_layout, only: fracture_layout_t
   use coarse_model, only: rest_fluid
   use coarse_state, only: guess_t
   use mesh_builder, only: remesh
   use mesh_types, only: fracture_mesh_t, mesh_map_t
   use twolevel_guess, only: transfer_guess
   use twolevel_heat, only: carry_heat
   use twolevel_setup, only: choose_first_step
   use twolevel_overlaps, only: fracture_overlaps, kept_faces, overlaps_t
   use twolevel_transfer, only: hand_over, transfer_cells, transfer_state
   use twolevel_wells, only: transfer_shares
   implicit none(type, external)

contains

   module procedure grow_coarse
   real(rk), allocatable :: centres(:, :)
   logical :: is_straightened
   real(rk) :: threshold

   threshold = self%scene%growth%threshold*self%scene%discretization%size_fracture
   if (any(self%has_gained())) threshold = same_place*self%rules%increment
   call hand_over(threshold, self%network, self%tip, self%now%coarse_network, centres, &
                  is_straightened)
   grew = size(centres, 2) > 0
   if (.not. grew) return
   if (is_straightened) then
      call self%windows%network_changed()
      call self%reference%network_changed()
   end if
   call self%remesh_coarse(centres, timers, error)
   call discard(self%kept_problem)
   end procedure grow_coarse

   module procedure remesh_coarse
   type(coarse_problem_t), allocatable :: of_try, problem
   type(mesh_map_t) :: map
   type(profiles_t) :: profiles
   type(kept_faces_t) :: faces
   type(fracture_mesh_t) :: fracture_before
   type(fracture_layout_t) :: layout
   type(guess_t) :: guess
   integer(ik), allocatable :: pairs(:, :)
   real(rk) :: radius
   integer(ik) :: i, k, nearest

   call timers%heed(error)
   if (allocated(error)) return
   allocate (problem)
   radius = 0.0_rk  ! the largest of those of the tips that have gone on
   do i = 1, size(centres, 2, kind=ik)
      nearest = minloc([(norm2(self%tip(k)%xy - centres(:, i)), k=1, size(self%tip))], dim=1)
      associate (f => self%tip(nearest)%fracture)
         radius = max(radius, 5.0_rk*self%rules%increment_of(f), &
                      3.0_rk*self%scene%cell_size_of(f))
      end associate
   end do
   call timers%start(phase_remesh)
   call remesh(self%problem%mesher, self%now%coarse_network, centres, radius, &
               self%scene%smallest_cell(), problem%mesher, problem%mesh, map, error)
   call timers%stop(phase_remesh)
   if (allocated(error)) return
   call timers%start(phase_transfer)
   faces = kept_faces(self%problem%mesh%fracture, problem%mesh%fracture)
   associate (layers => self%problem%model%layers, state => self%now%coarse)
      if (layers%n > 0) then
         profiles = profiles_of(layers, state%unknowns, state%layer)
         call set_apart(layers, map%cell_old, faces, state%unknowns, state%content, profiles)
      else
         profiles = no_profiles()
      end if
   end associate
   guess = self%now%coarse%guess
   fracture_before = self%problem%mesh%fracture
   pairs = self%problem%model%connections
   layout = layout_of(self%problem)
   call transfer_levels(self%scene, self%problem, map, problem, self%now)
   call timers%stop(phase_transfer)
   if (.not. allocated(self%kept_problem)) then
      call move_alloc(self%problem, self%kept_problem)
   else
      call move_alloc(self%problem, of_try)
      call of_try%model%release()
   end if
   call move_alloc(problem, self%problem)
   call self%windows%coarse_changed()
   call self%reference%coarse_changed()
   call choose_first_step(self%scene, self%problem%model%first_step)
   call self%problem%model%set_mesh(self%problem%mesh, self%scene, timers, error)
   if (allocated(error)) return
   call transfer_layers(self%problem, profiles, map, faces, self%now%coarse)
   call self%problem%feed_wells(self%scene, error)
   if (allocated(error)) return
   call rest_fluid(self%problem%model, self%now%coarse)
   if (allocated(of_try)) then
      call carry_heat(self%scene, of_try, map, faces, self%problem, self%now, error)
   else
      call carry_heat(self%scene, self%kept_problem, map, faces, self%problem, self%now, error)
   end if
   if (allocated(error)) return
   call transfer_guess(fracture_before, self%problem%mesh%fracture, pairs, &
                       self%problem%model%connections, layout, layout_of(self%problem), guess)
   self%now%coarse%guess = guess
   self%now%has_new_mesh = .true.
   end procedure remesh_coarse

   !> Numbering of the unknowns on the fractures.
   pure type(fracture_layout_t) function layout_of(problem) result(layout)
      type(coarse_problem_t), intent(in) :: problem

      associate (model => problem%model)
         layout = fracture_layout_t(n_cells=problem%mesh%fracture%n_cells, per_cell=7_ik, &
                                    n_flows=size(model%connections, 2, kind=ik), &
                                    n_branches=model%joints%branch_count(), &
                                    n_wells=model%wells%n, n_joints=model%joints%n)
      end associate
   end function layout_of

   !> Transfer the pressures in layers to a new coarse mesh, after all else.
   subroutine transfer_layers(problem, profiles, map, faces, state)
      type(coarse_problem_t), intent(in) :: problem  !< with the new mesh
      type(profiles_t), intent(in) :: profiles  !< before
      type(mesh_map_t), intent(in) :: map
      type(kept_faces_t), intent(in) :: faces
      type(state_t), intent(inout) :: state

      associate (layers => problem%model%layers, mesh => problem%mesh)
         call return_excess(profiles, mesh, map%cell_old, faces, state%content)
         if (layers%n == 0) return
         call insert_layers(mesh%n_cells, layers%n, state%unknowns)
         call take_profiles(layers, profiles, map%cell_old, faces, state%unknowns, state%layer)
      end associate
   end subroutine transfer_layers

   !> Insert the blocks of layers after those of the cells.
   pure subroutine insert_layers(n_cells, n_layers, unknowns)
      integer(ik), intent(in) :: n_cells, n_layers
      real(rk), allocatable, intent(inout) :: unknowns(:, :)  !< (3, blocks)
      real(rk), allocatable :: with_layers(:, :)

      allocate (with_layers(3, size(unknowns, 2) + n_layers), source=0.0_rk)
      with_layers(:, :n_cells) = unknowns(:, :n_cells)
      with_layers(:, n_cells + n_layers + 1:) = unknowns(:, n_cells + 1:)
      call move_alloc(with_layers, unknowns)
   end subroutine insert_layers

   !> Transfer cells, wells and state to a new coarse mesh.
   subroutine transfer_levels(scene, old, map, new, now)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: old
      type(mesh_map_t), intent(in) :: map
      type(coarse_problem_t), intent(inout) :: new
      type(levels_state_t), intent(inout) :: now
      type(state_t) :: state
      type(overlaps_t) :: overlaps
      real(rk) :: prefilled
      integer(ik) :: i
      logical :: is_prefilled

      is_prefilled = scene%growth%new_volume == "prefilled"
      call transfer_cells(old%mesh, new%mesh, old%model%cells, scene%growth%new_aperture, &
                          is_prefilled, new%model%cells)
      call transfer_state(map, old%mesh, new%mesh, new%model%cells, is_prefilled, now%coarse, &
                          state, prefilled)
      associate (before => old%mesh%fracture, after => new%mesh%fracture)
         new%share = transfer_shares(before, after, old%share)
         overlaps = fracture_overlaps(before, after)
         now%grown = pack([(i, i=1, after%n_cells)], overlaps%is_new([(i, i=1, after%n_cells)]))
      end associate
      now%coarse = state
      call now%trend%transfer(map)
      now%fluid%prefilled = now%fluid%prefilled + prefilled
   end subroutine transfer_levels

end submodule twolevel_remeshing
