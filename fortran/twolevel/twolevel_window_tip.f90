!> A tip in a window: its intensities and their error estimates.
module twolevel_window_tip
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use fine_tip_types, only: complete_errors, intensity_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: of_edge, of_elements, window_tip_t

   ! Parts of the error that a refinement reduces.
   integer, parameter :: of_elements = 1  !< by smaller elements
   integer, parameter :: of_edge = 2  !< by a larger window, or by the body as window

   !> A refinement has had no effect if the error is still more than this share of the error before
   !! [-], until the error has become so many times as large [-]. One that has been taken back is
   !! not repeated before, whatever the error is.
   real(rk), parameter :: no_effect = 0.9_rk, other_state = 2.0_rk

   !> Largest number of refinements. Each halves the rosette; from the second on each also halves
   !! the other elements.
   integer, parameter :: finer_most = 4

   !> One tip of the network, free or not.
   type :: window_tip_t
      integer(ik) :: fracture = 0, end = 0  !< in the network
      integer :: times_finer = 0  !< number of refinements
      !> (of_elements, of_edge) error of the intensities before the last refinement [Pa m^1/2]
      real(rk) :: refined_at(2) = huge(1.0_rk)
      !> In the body as window its surroundings have elements as small as those of its own window:
      !! it is, or has been, near its toughness
      logical :: has_focus = .false.
      !> The body as window has its fracture, which moves or has moved, or comes near that
      logical :: is_needed = .false.
      logical :: can_withdraw(2) = .false.  !< this refinement can still be taken back
      logical :: was_withdrawn(2) = .false.  !< it has been taken back
      !> intensities of the last solution, without the error by the coarse level
      type(intensity_t) :: found
      !> Contribution of the coarse level to the errors of K_I and K_II (twolevel_coarse_errors), by
      !! the last comparison [Pa m^1/2]: signed correction, and estimated error
      real(rk) :: lacking(2) = 0.0_rk, uncertain(2) = 0.0_rk
      real(rk) :: compared(2) = 0.0_rk  !< K_I, K_II of the window then [Pa m^1/2]
      real(rk) :: compared_at(2) = 0.0_rk  !< where the tip was then [m]
      real(rk) :: of_elements = 0.0_rk  !< the part that smaller elements would mend [Pa m^1/2]
      real(rk) :: of_edge = 0.0_rk  !< the part that a larger window would mend [Pa m^1/2]
      !> At the last evaluation: opening and slip behind the tip, proportional to K [m^1/2], and the
      !! position of the tip [m]
      real(rk) :: jump_then(2) = 0.0_rk, place_then(2) = huge(1.0_rk)
      logical :: was_undrained = .false.  !< and whether it was that of an undrained response
      !> the errors by the coarse level have been estimated for the last evaluation
      logical :: is_compared = .false.
      real(rk) :: passing(2) = 0.0_rk  !< and what coarse cells show badly of the rock's pressure
      real(rk) :: back_stress = 0.0_rk  !< K_I of layers on the faces, not in `found` [Pa m^1/2]
   contains
      procedure :: element_size
      procedure :: rosette_radius
      procedure :: can_be_finer
      procedure :: is_futile
      procedure :: forget_coarse_error
      procedure :: note_jump
      procedure :: forget_jump
      procedure :: has_same_jump
      procedure :: change_of_jump
      procedure :: with_coarse_error
   end type window_tip_t

contains

   !> Size of the elements at fractures that the tip requires [m].
   elemental real(rk) function element_size(self, scene)
      class(window_tip_t), intent(in) :: self
      type(scene_t), intent(in) :: scene

      element_size = 0.5_rk**max(0, self%times_finer - 1)*usual_size(self, scene)
   end function element_size

   !> Radius of the rosette around the tip: two radii fit on the last straight segment, since the
   !! domain of the interaction integral ends at a kink [m].
   elemental real(rk) function rosette_radius(self, scene, piece)
      class(window_tip_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: piece  !< length of the last segment [m]

      rosette_radius = 0.5_rk**self%times_finer*min(usual_size(self, scene), 0.5_rk*piece)
   end function rosette_radius

   !> What the scene says [m].
   elemental real(rk) function usual_size(self, scene)
      class(window_tip_t), intent(in) :: self
      type(scene_t), intent(in) :: scene

      usual_size = scene%discretization%fine_ratio*scene%cell_size_of(self%fracture)
   end function usual_size

   elemental logical function can_be_finer(self)
      class(window_tip_t), intent(in) :: self

      can_be_finer = self%times_finer < finer_most
   end function can_be_finer

   !> Whether the last refinement of one kind has not reduced the error, so that the next would not
   !! either.
   elemental logical function is_futile(self, part, error)
      class(window_tip_t), intent(in) :: self
      integer, intent(in) :: part  !< of_elements or of_edge
      real(rk), intent(in) :: error  !< of the intensities now [Pa m^1/2]

      associate (before => self%refined_at(part))
         is_futile = before < huge(1.0_rk) .and. error < other_state*before .and. &
                     (error > no_effect*before .or. self%was_withdrawn(part))
      end associate
   end function is_futile

   !> Reset the contribution of the coarse level.
   elemental subroutine forget_coarse_error(self)
      class(window_tip_t), intent(inout) :: self

      self%lacking = 0.0_rk
      self%compared = 0.0_rk
      self%uncertain = 0.0_rk
      self%of_edge = 0.0_rk
      self%passing = 0.0_rk
      self%back_stress = 0.0_rk
   end subroutine forget_coarse_error

   !> Store the jump behind the tip at an evaluation.
   pure subroutine note_jump(self, jump, place, undrained)
      class(window_tip_t), intent(inout) :: self
      real(rk), intent(in) :: jump(2)  !< opening and slip, proportional to K [m^1/2]
      real(rk), intent(in) :: place(2)  !< position of the tip [m]
      logical, intent(in) :: undrained  !< in the undrained response

      self%jump_then = jump
      self%place_then = place
      self%was_undrained = undrained
      self%is_compared = .false.
   end subroutine note_jump

   !> The next evaluation is due: no jump is known.
   elemental subroutine forget_jump(self)
      class(window_tip_t), intent(inout) :: self

      self%place_then = huge(1.0_rk)
      self%is_compared = .false.
   end subroutine forget_jump

   !> Whether the tip is where it was at the last evaluation, with nearly the same jump behind it,
   !! drained or undrained as then, and the errors of this evaluation are known.
   pure logical function has_same_jump(self, jump, place, undrained)
      class(window_tip_t), intent(in) :: self
      real(rk), intent(in) :: jump(2)  !< opening and slip, proportional to K [m^1/2]
      real(rk), intent(in) :: place(2)  !< position of the tip [m]
      logical, intent(in) :: undrained  !< in the undrained response
      real(rk), parameter :: constant = 0.1_rk  ! change of a jump that carries an intensity [-]

      has_same_jump = self%is_compared .and. .not. norm2(place - self%place_then) > 0.0_rk .and. &
                      (undrained .eqv. self%was_undrained) .and. &
                      norm2(jump - self%jump_then) <= constant*norm2(self%jump_then)
   end function has_same_jump

   !> Change of the jump since the last evaluation, relative [-].
   pure real(rk) function change_of_jump(self, jump) result(change)
      class(window_tip_t), intent(in) :: self
      real(rk), intent(in) :: jump(2)  !< opening and slip, proportional to K [m^1/2]

      change = norm2(jump - self%jump_then)/max(norm2(self%jump_then), tiny(1.0_rk))
   end function change_of_jump

   !> Intensities of the last solution, with the last estimate of the errors by the coarse level.
   pure function with_coarse_error(self, crack_modulus) result(intensity)
      class(window_tip_t), intent(in) :: self
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      type(intensity_t) :: intensity

      intensity = self%found
      call add_back_stress(self%back_stress, crack_modulus, intensity)
      intensity%k1_corrected = intensity%k1_corrected + self%lacking(1)
      intensity%k2_corrected = intensity%k2_corrected + self%lacking(2)
      intensity%k1_error = intensity%k1_error + self%uncertain(1) + self%passing(1)
      intensity%k2_error = intensity%k2_error + self%uncertain(2) + self%passing(2)
      intensity%passing_error = maxval(self%passing)
      call complete_errors(crack_modulus, intensity)
   end function with_coarse_error

   !> Add K_I of layers of fluid pressure on the faces (twolevel_back_stress), unless the faces
   !! touch at the tip. It may close the tip; opening, it is at most what the tip has without it, so
   !! that K_I does not jump where faces begin to touch. A joint that closes (K_I < 0) bears it.
   pure subroutine add_back_stress(of_layers, crack_modulus, intensity)
      real(rk), intent(in) :: of_layers  !< [Pa m^1/2]
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      type(intensity_t), intent(inout) :: intensity
      real(rk) :: before, k1

      before = intensity%k1
      k1 = min(of_layers, max(0.0_rk, before))
      if (intensity%closed .or. .not. abs(k1) > 0.0_rk) return
      intensity%k1 = with_layers(before)
      intensity%k1_inner = with_layers(intensity%k1_inner)
      intensity%k1_dc = with_layers(intensity%k1_dc)
      intensity%k1_corrected = intensity%k1_corrected + intensity%k1 - before
      intensity%g_domain = intensity%g_domain + (intensity%k1**2 - before**2)/crack_modulus

   contains

      !> K_I with that of the layers [Pa m^1/2].
      pure real(rk) function with_layers(without)
         real(rk), intent(in) :: without  !< [Pa m^1/2]

         with_layers = max(min(0.0_rk, without), without + k1)
      end function with_layers

   end subroutine add_back_stress

end module twolevel_window_tip
