!> A window: a part of the network on a fine mesh, loaded by the coarse level. It is a square around
!! one tip, or the whole body with all tips.
!!
!! The edge takes the coarse displacement, or, on a side of the body, the conditions that the scene
!! prescribes there (so the whole body takes nothing on its edge). The rock takes the coarse
!! pressure as initial stress, and the fracture faces take the conditions of twolevel_faces.
module twolevel_window
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use coarse_in_situ, only: find_in_situ, in_situ_state_t, weight_of_scene
   use coarse_rock, only: new_rock, rock_t
   use coarse_state, only: state_t
   use contact_law, only: contact_law_t
   use fine_elasticity, only: elasticity_t
   use fine_loads, only: add_in_situ_tractions, fine_loads_t, no_loads, set_in_situ_stress
   use fine_model, only: fine_model_t
   use growth_network, only: end_pieces, increments_in
   use mesh_builder, only: build_mesh, locate, mesh_spec_t, mesher_t, move_tips
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use report_scene, only: place_rocks, regions_of_other_rock, shape_body
   use fine_tip_intensity, only: probe_of_tip
   use fine_tip_interaction, only: tip_probe_t
   use fine_tip_types, only: frame_of_tip, tip_frame_t
   use twolevel_faces, only: coarse_values_t, face_map_t, match_faces
   use twolevel_window_map, only: clear_edges, window_map_t
   use twolevel_window_path, only: near_ends, numbers_without, restore_fractures, straighten_far, &
                                   without
   use twolevel_window_spec, only: constants_of_rock, focus, grow_away, tip_place, window_spec
   use twolevel_window_sides, only: window_sides, window_sides_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows_state, only: window_history_t
   implicit none(type, external)
   private

   public :: window_t

   !> How far from the last segments of paths nodes move with the tips, over the length of the
   !! segment, and largest share of the elements that change for others not to be eliminated again
   !! [-].
   real(rk), parameter :: reach = 6.0_rk, most_change = 0.4_rk

   !> Longest path segment, over the increment [-].
   real(rk), parameter :: longer = 1.001_rk

   !> Network and tips for which the mesh of a window was made, or to which it has been moved.
   type :: made_for_t
      type(network_t) :: network  !< network for which the mesh was made
      integer(ik), allocatable :: kept(:)  !< vertices of the network that are in the mesh
      real(rk), allocatable :: place(:, :)  !< (2, tips) positions of the tips [m]
      logical, allocatable :: is_free(:)  !< (tips) free crack ends
      logical, allocatable :: has_focus(:)  !< (tips) with small elements around them
      logical, allocatable :: changes(:)  !< (cells) as tips move; empty: they are too many
      logical, allocatable :: held(:)  !< (fracture cells) their jump is given (twolevel_held_faces)
      logical :: is_projected = .false.  !< the position in the coarse mesh is known
   end type made_for_t

   !> A tip that a window serves.
   type :: served_t
      !> it is evaluated in the solutions of the window; others are closed, or far below their
      !! toughness
      logical :: is_evaluated = .false.
      logical :: has_probe = .false.  !< the probe is known
      type(tip_probe_t) :: probe  !< interaction integrals, valid as long as the model is the same
   end type served_t

   !> One window. Its data follow from the scene, the network and the coarse state, and from the
   !! time of its meshing; its history is in window_history_t.
   type :: window_t
      integer(ik), allocatable :: serves(:)  !< tips evaluated in the window
      !> body window; not a square that has become as large as the body
      logical :: is_body = .false.
      real(rk) :: lower(2) = 0.0_rk, upper(2) = 0.0_rk  !< corners [m]
      real(rk) :: coarser = 1.0_rk  !< its elements along fractures, over what its tips ask for [-]
      real(rk) :: element_size = 0.0_rk  !< at the fractures [m]
      real(rk) :: usual_edge = 0.0_rk  !< as the scene says [m]
      integer :: times_larger = 0  !< than that
      type(mesher_t) :: mesher
      type(mesher_t) :: as_made  !< mesh before its tips were moved, if they were
      type(mesh_t) :: mesh
      type(made_for_t), allocatable :: made  !< unallocated: no mesh
      logical :: has_moved = .false.  !< the mesh has been moved since it was made
      logical :: follows_other = .false.  !< the unmoved mesh is in another window
      type(fine_model_t) :: model
      integer(ik), allocatable :: at(:)  !< (tips served) numbers in the mesh; 0: not free
      type(served_t), allocatable :: served(:)  !< (tips served)
      type(fine_loads_t) :: loads
      type(window_sides_t) :: sides
      !> (2, n_nodes) loads other than those of the sides, where these change with time [N/m]
      real(rk), allocatable :: force_in_situ(:, :)
      !> (fracture cells) if the scene has a state in situ [Pa]
      real(rk), allocatable :: pressure_in_situ(:)
      real(rk), allocatable :: displacement(:, :)  !< displacement of the last solution [m]
      logical :: undrained = .false.  !< the model's constants are the undrained ones
      type(window_map_t) :: map  !< position in the coarse mesh
      type(face_map_t) :: faces
   contains
      procedure :: build
      procedure :: follow
      procedure :: set_up
      procedure :: take_plan
      procedure :: edge_length
      procedure :: can_be_larger
      procedure :: set_rock
      procedure :: crack_modulus
      procedure :: project
      procedure :: choose_tips
      procedure :: prepare_matrix
      procedure :: find_intensities
      procedure :: intensities_with
      procedure :: curved_edge
      procedure :: holds
      procedure :: is_too_coarse
      procedure :: has_fracture
      procedure :: displacement_at
      procedure :: visit
   end type window_t

   interface
      !> Store or load a window; its model is made again from its mesh.
      module subroutine visit(self, archive, scene, mesher, coarse, values, tips, error)
         implicit none(type, external)
         class(window_t), intent(inout) :: self
         type(archive_t), intent(inout) :: archive
         type(scene_t), intent(in) :: scene
         type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
         type(mesh_t), intent(in) :: coarse
         type(coarse_values_t), intent(in) :: values
         type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
         type(error_t), allocatable, intent(out) :: error
      end subroutine visit
   end interface

   interface
      !> Load the window with the state of the coarse level, solve, and evaluate the tips in
      !! question.
      module subroutine find_intensities(self, scene, coarse, values, state, tips, history, error)
         implicit none(type, external)
         class(window_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(mesh_t), intent(in) :: coarse
         type(coarse_values_t), intent(in) :: values
         type(state_t), intent(in) :: state
         type(window_tip_t), intent(inout) :: tips(:)
         type(window_history_t), intent(inout) :: history
         type(error_t), allocatable, intent(out) :: error
      end subroutine find_intensities

      !> Factorize the matrix, unless it is that of these laws, or depends on the state.
      module subroutine prepare_matrix(self, scene, law, error)
         implicit none(type, external)
         class(window_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(contact_law_t), intent(in) :: law(:)  !< (coarse fracture cells)
         type(error_t), allocatable, intent(out) :: error
      end subroutine prepare_matrix

      !> Displacements of the window's edge: the coarse ones, quadratic in each coarse cell; on
      !! sides of the body those that the scene prescribes. Zero at other nodes.
      pure module function curved_edge(self, coarse, displacement, gradient) result(edge)
         implicit none(type, external)
         class(window_t), intent(in) :: self
         type(mesh_t), intent(in) :: coarse
         real(rk), intent(in) :: displacement(:, :)  !< (2, coarse nodes) [m]
         real(rk), intent(in) :: gradient(:, :, :)  !< (2, 2, coarse nodes) [-]
         real(rk), allocatable :: edge(:, :)  !< (2, n_nodes) [m]
      end function curved_edge

      !> K_I and K_II under the loads of the last solution with other displacements on the edge, or
      !! another pressure in the rock. The window does not change.
      module subroutine intensities_with(self, history, k, error, edge, pressure)
         implicit none(type, external)
         class(window_t), intent(inout) :: self
         type(window_history_t), intent(in) :: history
         real(rk), intent(inout) :: k(:, :)  !< (2, tips) set for the tips served [Pa m^1/2]
         type(error_t), allocatable, intent(out) :: error
         !> (2, n_nodes) used where displacements are prescribed [m]
         real(rk), intent(in), optional :: edge(:, :)
         !> (coarse cells) pressure, constant in each cell [Pa]
         real(rk), intent(in), optional :: pressure(:)
      end subroutine intensities_with
   end interface

contains

   !> Prepare a window that follows the tips with the mesh of another window, which keeps its mesh,
   !! but not its matrix.
   subroutine take_plan(self, other)
      class(window_t), intent(inout) :: self
      type(window_t), intent(inout) :: other

      self%serves = other%serves
      self%is_body = other%is_body
      self%lower = other%lower
      self%upper = other%upper
      self%coarser = other%coarser
      self%element_size = other%element_size
      self%times_larger = other%times_larger
      self%usual_edge = other%usual_edge
      if (allocated(other%made)) self%made = other%made
      self%follows_other = allocated(self%made)
      self%sides = other%sides
      call self%model%take_order(other%model)
   end subroutine take_plan

   !> Mesh the window.
   subroutine build(self, scene, network, tips, is_beside_body, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      !> The intensities are compared with those of the whole body, which shows the error of the
      !! elements.
      logical, intent(in) :: is_beside_body
      type(error_t), allocatable, intent(out) :: error
      type(mesh_spec_t) :: spec
      type(network_t) :: far_straight
      logical :: is_needed(size(network%first) - 1)

      if (allocated(self%made)) deallocate (self%made)
      self%element_size = self%coarser*minval(tips(self%serves)%element_size(scene))
      self%usual_edge = scene%window_of(tips(self%serves(1))%fracture)
      call place(self, scene, network, tips)
      self%sides = window_sides(scene, self%is_body, self%lower, self%upper)
      spec = window_spec(self%lower, self%upper, self%element_size, scene)
      if (self%is_body) call shape_body(scene, spec)
      call grow_away(spec, self%sides%have_fronts(), is_beside_body .and. .not. self%is_body)
      call focus(scene, network, tips, self%serves, tips(self%serves)%has_focus .or. &
                 .not. self%is_body, spec, error)
      if (allocated(error)) return
      allocate (self%made)
      self%made%network = network
      self%made%has_focus = tips%has_focus
      is_needed = .not. self%is_body .or. .not. any(tips%is_needed)
      is_needed(pack(tips%fracture, tips%is_needed)) = .true.
      call straighten_far(network, spec, self%is_body, is_needed, far_straight, self%made%kept)
      call leave_out(network, self%made%kept, spec)
      call build_mesh(spec, far_straight, self%mesher, self%mesh, error)
      if (allocated(error)) return
      call find_changes(self, scene, network, far_straight, tips)
      self%has_moved = .false.
      self%follows_other = .false.
      call restore_fractures(network, far_straight, self%made%kept, self%mesh%fracture)
      call self%set_up(scene, tips, error)
   end subroutine build

   !> Remove from a specification what belongs to fractures without vertices in the mesh.
   pure subroutine leave_out(network, kept, spec)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: kept(:)  !< vertices in the mesh
      type(mesh_spec_t), intent(inout) :: spec
      integer(ik), allocatable :: stay(:)
      integer(ik) :: i, number(size(network%first) - 1)

      number = numbers_without(network, kept)
      if (all(number > 0)) return
      stay = pack([(i, i=1, size(number, kind=ik))], number > 0)
      spec%end_radius = spec%end_radius(:, stay)
      if (allocated(spec%own_size)) spec%own_size = spec%own_size(stay)
      stay = pack([(i, i=1, size(spec%refined, 2, kind=ik))], &
                  [(any(abs(network%xy(1, kept) - spec%refined(1, i)) <= 0.0_rk .and. &
                        abs(network%xy(2, kept) - spec%refined(2, i)) <= 0.0_rk), &
                    i=1, size(spec%refined, 2, kind=ik))])
      spec%refined = spec%refined(:, stay)
   end subroutine leave_out

   !> Find the elements that change as tips in focus move along path segments.
   subroutine find_changes(self, scene, network, simple, tips)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(network_t), intent(in) :: simple  !< in the mesh
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      type(window_tip_t), allocatable :: moving(:)
      real(rk) :: increment(size(network%first) - 1), piece(2, size(network%first) - 1)
      integer(ik) :: i, number(size(network%first) - 1)

      piece = end_pieces(network)
      increment = increments_in(network, scene)
      number = numbers_without(network, self%made%kept)
      moving = pack(tips(self%serves), tips(self%serves)%has_focus .or. .not. self%is_body)
      moving = pack(moving, [(piece(moving(i)%end, moving(i)%fracture) <= longer &
                              *increment(moving(i)%fracture), i=1, size(moving))])
      self%made%changes = near_ends(self%mesh, simple, number(moving%fracture), moving%end, reach)
      if (count(self%made%changes) <= most_change*self%mesh%n_cells) return
      deallocate (self%made%changes)
      allocate (self%made%changes(0))
   end subroutine find_changes

   !> Move the nodes of the original mesh with tips that have advanced along their last segments.
   !! The window stays at its position. Where this fails, the window has to be built again.
   subroutine follow(self, scene, network, tips, as_made, is_done, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      type(mesher_t), intent(in) :: as_made
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: refusal
      type(network_t) :: far_straight

      is_done = .false.
      if (any(regions_of_other_rock(scene))) return
      if (size(network%xy, 2) /= size(self%made%network%xy, 2)) return
      if (any(network%first /= self%made%network%first)) return
      far_straight = without(network, self%made%kept)
      self%has_moved = .true.
      call move_tips(as_made, far_straight, reach, self%mesher, self%mesh, refusal)
      if (allocated(refusal)) return
      call restore_fractures(network, far_straight, self%made%kept, self%mesh%fracture)
      call self%set_up(scene, tips, error)
      is_done = .not. allocated(error)
   end subroutine follow

   !> Set up the model and the loads of a new mesh.
   subroutine set_up(self, scene, tips, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i

      call self%set_rock(scene, .false., error)
      if (allocated(error)) return
      ! A stored window that is to be meshed again has a mesh only.
      if (allocated(self%made)) self%model%changes = self%made%changes
      associate (fracture => self%mesh%fracture, tip => tips(self%serves))
         self%at = [(findloc(fracture%tip_fracture == tip(i)%fracture .and. &
                             fracture%tip_end == tip(i)%end, .true., dim=1), i=1, size(tip))]
      end associate
      self%loads = no_loads(self%model%mesh)
      call load_in_situ(self, scene)
      if (any(self%sides%of%changes())) self%force_in_situ = self%loads%force
      call self%sides%add_loads(self%model%mesh, self%loads%force)
   end subroutine set_up

   !> Set the loads by the state in situ and by weight. The tractions in equilibrium with the stress
   !! in situ act where no displacement is prescribed.
   pure subroutine load_in_situ(self, scene)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(in_situ_state_t), allocatable :: in_situ
      type(rock_t) :: rock
      integer(ik) :: i

      rock = new_rock(scene%material, scene%fluid)
      call find_in_situ(scene, rock%biot(1), in_situ)
      self%loads%body_force = weight_of_scene(scene)
      if (.not. allocated(in_situ)) return
      associate (fine => self%model%mesh)
         call set_in_situ_stress(fine, in_situ%stress, in_situ%stress_per_y, in_situ%y_datum, &
                                 self%loads)
         if (in_situ%is_held) call add_in_situ_tractions(fine, self%loads)
         self%pressure_in_situ = &
            [(in_situ%pressure_at(0.5_rk*sum(fine%xy(2, fine%face_nodes(:2, 1, i)))), &
              i=1, fine%fracture%n_cells)]
      end associate
   end subroutine load_in_situ

   !> Of the square that the body cuts [m].
   pure real(rk) function edge_length(self)
      class(window_t), intent(in) :: self

      edge_length = 2.0_rk**self%times_larger*self%usual_edge
   end function edge_length

   !> Set the corners: those of the body, or of a square around the tip, cut off at the body's
   !! sides.
   pure subroutine place(self, scene, network, tips)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: tips(:)
      real(rk) :: half, xy(2)

      associate (domain => scene%domain)
         self%lower = [domain%x_min, domain%y_min]
         self%upper = [domain%x_max, domain%y_max]
         if (self%is_body) return
         xy = tip_place(network, tips(self%serves(1)))
         half = 0.5_rk*self%edge_length()
         self%lower = xy - half
         self%upper = xy + half
         call clear_edges(network, 0.3_rk*self%element_size, self%lower, self%upper)
         self%lower = max(self%lower, [domain%x_min, domain%y_min])
         self%upper = min(self%upper, [domain%x_max, domain%y_max])
      end associate
   end subroutine place

   !> E' of the rock around a tip of the window's mesh; with tip = 0 (not free) that of the window's
   !! main rock [Pa].
   pure real(rk) function crack_modulus(self, tip)
      class(window_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      type(tip_frame_t) :: frame

      crack_modulus = self%model%elasticity%crack_modulus()
      if (tip == 0 .or. size(self%model%rocks%of_cell) == 1) return
      frame = frame_of_tip(self%model%mesh, self%model%rocks, tip)
      crack_modulus = frame%rock%crack_modulus()
   end function crack_modulus

   !> Whether the window is smaller than the body.
   pure logical function can_be_larger(self)
      class(window_t), intent(in) :: self

      can_be_larger = .not. all(self%sides%on_body)
   end function can_be_larger

   !> Set the elastic constants: drained, or undrained for the response to a load in which no fluid
   !! moves. In the undrained case the pore pressure follows the strain, alpha p = alpha p_0 -
   !! alpha^2/S div u, with the singularity of the tip, which the coarse pressure does not contain.
   subroutine set_rock(self, scene, undrained, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: undrained
      type(error_t), allocatable, intent(out) :: error
      type(elasticity_t), allocatable :: elasticity(:)
      integer :: i

      if (allocated(self%served)) deallocate (self%served)
      elasticity = [constants_of_rock(scene%material, scene, undrained)]
      if (allocated(scene%regions)) then
         elasticity = [elasticity, (constants_of_rock(scene%regions(i)%material, scene, &
                                                      undrained), i=1, size(scene%regions))]
         call self%model%set_mesh(self%mesh, elasticity(1), error, &
                                  rocks=place_rocks(scene, self%mesh, elasticity))
      else
         call self%model%set_mesh(self%mesh, elasticity(1), error)
      end if
      if (.not. allocated(error)) call self%sides%add_springs(self%model%mesh, self%model%stiffness)
      self%undrained = undrained
   end subroutine set_rock

   !> Find the position of the window in the coarse mesh; required again whenever the coarse mesh
   !! has changed.
   subroutine project(self, mesher, coarse, is_grown, error)
      class(window_t), intent(inout) :: self
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: coarse
      logical, intent(in) :: is_grown(:)  !< (coarse fracture cells)
      type(error_t), allocatable, intent(out) :: error

      call self%map%find(self%model%mesh, mesher, coarse, error)
      if (allocated(error)) return
      self%faces = match_faces(self%model%mesh, coarse, is_grown)
      self%made%is_projected = .true.
   end subroutine project

   !> Choose the tips that are evaluated in the next solutions.
   pure subroutine choose_tips(self, is_evaluated)
      class(window_t), intent(inout) :: self
      logical, intent(in) :: is_evaluated(:)  !< (tips served)

      if (.not. allocated(self%served)) allocate (self%served(size(self%serves)))
      self%served%is_evaluated = is_evaluated
   end subroutine choose_tips

   !> Whether the mesh is that of the body, and the elements around some tips are too large, or a
   !! fracture is missing.
   pure logical function is_too_coarse(self, tips)
      class(window_t), intent(in) :: self
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)

      is_too_coarse = self%is_body .and. allocated(self%made)
      if (is_too_coarse) is_too_coarse = any(tips(self%serves)%has_focus .and. &
                                             .not. self%made%has_focus(self%serves)) .or. &
                                         any(tips%is_needed .and. &
                                             .not. self%has_fracture(tips%fracture))
   end function is_too_coarse

   !> Whether fractures are in the mesh.
   pure function has_fracture(self, fracture) result(has)
      class(window_t), intent(in) :: self
      integer(ik), intent(in) :: fracture(:)  !< their numbers in the network
      logical :: has(size(fracture))
      integer(ik) :: number(size(self%made%network%first) - 1)

      number = numbers_without(self%made%network, self%made%kept)
      has = number(fracture) > 0
   end function has_fracture

   !> Whether points lie in the window, edges included.
   pure logical function holds(self, points)
      class(window_t), intent(in) :: self
      real(rk), intent(in) :: points(:, :)  !< (2, n) [m]

      holds = all(minval(points, dim=2) >= self%lower) .and. &
              all(maxval(points, dim=2) <= self%upper)
   end function holds

   !> Displacement of the last solution at points of the window.
   subroutine displacement_at(self, xy, displacement, error)
      class(window_t), intent(in) :: self
      real(rk), intent(in) :: xy(:, :)  !< (2, n) [m]
      real(rk), intent(out) :: displacement(:, :)  !< (2, n) [m]
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: cells(size(xy, 2)), i
      real(rk) :: area(3), determinant, gradients(2, 6), lambda(3), values(6)

      call locate(self%mesher, xy, cells, error)
      if (allocated(error)) return
      associate (fine => self%model%mesh)
         do i = 1, size(xy, 2, kind=ik)
            associate (nodes => fine%cell_nodes(:, cells(i)), tip => fine%tip_corner(cells(i)))
               lambda = barycentric(fine%xy(:, nodes(:3)), xy(:, i))
               ! Quarter-point elements: the distance from the tip is proportional to the square of
               ! the parameter.
               if (tip > 0) then
                  lambda = lambda/sqrt(max(1.0_rk - lambda(tip), tiny(1.0_rk)))
                  lambda(tip) = 1.0_rk - (sum(lambda) - lambda(tip))
               end if
               call fine%evaluate(cells(i), lambda, values, gradients, area, determinant)
               displacement(:, i) = matmul(self%displacement(:, nodes), values)
            end associate
         end do
      end associate
   end subroutine displacement_at

end module twolevel_window
