!> A mechanics-only scene in progress: the body, its tips, and the load factor, which rises to each
!! onset of growth and never past one.
module mechanics_simulation
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use mechanics_body, only: body_t
   use mechanics_onset, only: foreseen_onset, reading_t
   use mechanics_outline, only: outline_of_scene, outline_t
   use mechanics_targets, only: cuts_through, find_target, target_boundary, target_none
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   use tips_growth, only: advances, carry_over, growth_drive, new_tip
   use tips_network, only: extend, move_end, network_of_scene
   use tips_state, only: tip_state_t
   implicit none(type, external)
   private

   public :: simulation_t, tip_t

   !> Share of the toughness within which the first tip is at its onset.
   real(rk), parameter :: at_onset = 1.0e-9_rk
   !> Width of a bracket, over its place, that holds a jump of the intensity and not its root.
   real(rk), parameter :: at_jump = 1.0e-13_rk
   !> Share of the toughness that tips may lack to grow together with the first: about the error of
   !! the intensities, so that equal tips stay equal.
   real(rk), parameter :: together = 2.0e-3_rk

   !> Share of the estimated error that one new mesh is made for.
   real(rk), parameter :: error_step = 0.4_rk

   !> A free tip of the body.
   type, extends(tip_state_t) :: tip_t
      real(rk) :: rosette_radius = 0.0_rk  !< [m]
   end type tip_t

   !> Everything that changes while a scene runs.
   type :: simulation_t
      type(scene_t) :: scene
      type(network_t) :: start  !< network of the scene
      type(network_t) :: network
      type(outline_t) :: outline
      logical :: is_cut = .false.  !< fractures have cut off a piece that nothing holds
      type(body_t) :: body
      type(tip_t), allocatable :: tip(:)
      real(rk) :: factor = 0.0_rk  !< of the load [-]
      real(rk) :: accepted_moment = 0.0_rk  !< seismic moment before the present slip [N m]
   contains
      procedure :: begin
      procedure :: respond
      procedure :: rise
      procedure :: grow
      procedure :: time
      procedure :: seismic_moment
   end type simulation_t

contains

   !> Mesh the body; nothing is loaded yet.
   subroutine begin(self, scene, timers, error)
      class(simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i

      self%scene = scene
      self%factor = scene%load%from
      self%start = network_of_scene(scene)
      self%network = self%start
      self%outline = outline_of_scene(scene)
      call self%body%build(scene, self%start, self%network, timers, error)
      if (allocated(error)) return
      associate (fracture => self%body%mesh%fracture)
         allocate (self%tip(fracture%n_tips))
         do i = 1, fracture%n_tips
            self%tip(i)%fracture = fracture%tip_fracture(i)
            self%tip(i)%end = fracture%tip_end(i)
            self%tip(i)%xy = fracture%point_xy(:, fracture%tip_point(i))
            self%tip(i)%direction = fracture%tip_direction(:, i)
         end do
      end associate
   end subroutine begin

   !> The programme's parameter: 0 at the start, 1 at the end [s].
   pure real(rk) function time(self)
      class(simulation_t), intent(in) :: self

      associate (load => self%scene%load)
         time = (self%factor - load%from)/(load%to - load%from)
      end associate
   end function time

   !> State and tips at a load factor.
   subroutine respond(self, factor, timers, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%body%respond(self%scene, factor, timers, error)
      if (allocated(error)) return
      self%factor = factor
      if (self%scene%growth%intensities) call take_intensities(self)
   end subroutine respond

   !> The tips learn what the body's mesh has at theirs.
   subroutine take_intensities(self)
      type(simulation_t), intent(inout) :: self
      integer(ik) :: i, k

      associate (fracture => self%body%mesh%fracture)
         do i = 1, size(self%tip)
            associate (tip => self%tip(i))
               k = findloc(fracture%tip_fracture == tip%fracture .and. &
                           fracture%tip_end == tip%end, .true., dim=1)
               if (k == 0) then  ! another fracture has joined it
                  tip%arrested = .true.
                  cycle
               end if
               tip%intensity = self%body%intensity(k)
               tip%rosette_radius = fracture%tip_radius(k)
               tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                        self%body%model%elasticity%crack_modulus())
            end associate
         end do
      end associate
   end subroutine take_intensities

   !> Raise the load up to a factor, or to the onset of growth if that comes first.
   !!
   !! Without contact the intensities are linear in the factor. The equivalent intensity, the
   !! largest over all angles of linear functions, is then convex: where it is below the toughness
   !! at both ends of an interval, it is so within.
   subroutine rise(self, target, has_onset, timers, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: target  !< [-]
      logical, intent(out) :: has_onset
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(reading_t) :: low, high
      real(rk) :: onset

      has_onset = .false.
      if (.not. allocated(self%body%displacement)) then
         low%factor = self%factor
         call adapt(self, target, timers, error)
         if (allocated(error)) return
         call self%respond(low%factor, timers, error)
         if (allocated(error)) return
      end if
      call accept(self)
      if (.not. self%scene%growth%enabled) then
         call self%respond(target, timers, error)
         if (allocated(error) .or. .not. self%scene%growth%intensities) return
         call self%body%correct_intensities(timers, error)
         if (.not. allocated(error)) call take_intensities(self)
         return
      end if
      has_onset = largest_excess(self) >= -at_onset
      if (has_onset) return
      low = reading(self)
      ! Where all loads rise in proportion, the intensities do so until contact changes.
      onset = target
      if (all_loads_rise(self%scene) .and. low%factor > 0.0_rk .and. &
          largest_excess(self) > -1.0_rk) onset = low%factor/(1.0_rk + largest_excess(self))
      if (onset < target) then
         call self%respond(onset, timers, error)
         if (allocated(error)) return
         has_onset = abs(largest_excess(self)) <= at_onset
         if (has_onset) return
         if (largest_excess(self) < 0.0_rk) low = reading(self)
      end if
      if (.not. largest_excess(self) >= 0.0_rk) then
         call self%respond(target, timers, error)
         if (allocated(error)) return
         if (largest_excess(self) < -at_onset) return
      end if
      has_onset = .true.
      high = reading(self)
      call find_onset(self, low, high, timers, error)
   end subroutine rise

   !> The load between one at which no tip grows and one at which some do, the present one.
   subroutine find_onset(self, low, high, timers, error)
      class(simulation_t), intent(inout) :: self
      type(reading_t), intent(inout) :: low, high
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: iterations = 60
      type(reading_t) :: last, next
      real(rk) :: width(0:iterations)
      integer :: k

      last = low
      next = high
      width = huge(1.0_rk)
      do k = 1, iterations
         if (abs(largest_excess(self)) <= at_onset) return
         width(k) = high%factor - low%factor
         if (k > 3 .and. width(k) > 0.5_rk*width(max(k - 3, 0))) then
            next%factor = 0.5_rk*(low%factor + high%factor)  ! the lines lead nowhere
         else
            next%factor = foreseen_onset(last, next, low%factor, high%factor, &
                                         self%scene%material%toughness)
         end if
         last = reading(self)
         call self%respond(next%factor, timers, error)
         if (allocated(error)) return
         next = reading(self)
         if (largest_excess(self) < 0.0_rk) then
            low = next
         else
            high = next
         end if
         ! Where contact changes, the intensity may jump past the toughness: at this load.
         if (high%factor - low%factor <= at_jump*abs(high%factor)) then
            call self%respond(high%factor, timers, error)
            return
         end if
      end do
      call raise_error(error, "", "the load at which the next tip grows was not found")
   end subroutine find_onset

   !> The intensities of the tips that may grow.
   pure function reading(self)
      class(simulation_t), intent(in) :: self
      type(reading_t) :: reading

      reading%factor = self%factor
      reading%k1 = pack(self%tip%intensity%k1,.not. self%tip%arrested)
      reading%k2 = pack(self%tip%intensity%k2,.not. self%tip%arrested)
   end function reading

   !> No load but those that the factor multiplies.
   pure logical function all_loads_rise(scene)
      type(scene_t), intent(in) :: scene

      all_loads_rise = .not. any(abs([scene%material%density*scene%gravity, &
                                      scene%in_situ%stress, scene%in_situ%per_y]) > 0.0_rk)
   end function all_loads_rise

   !> What the faces have slipped so far becomes the history of their next slip.
   subroutine accept(self)
      type(simulation_t), intent(inout) :: self

      self%accepted_moment = self%seismic_moment()
      call self%body%contact%accept()
   end subroutine accept

   !> Seismic moment of all slip in contact so far, per metre of thickness [N m].
   pure real(rk) function seismic_moment(self) result(moment)
      class(simulation_t), intent(in) :: self
      real(rk), parameter :: share(3) = [1.0_rk, 1.0_rk, 4.0_rk]/6.0_rk  ! start, end, mid
      integer(ik) :: cell

      moment = self%accepted_moment
      associate (body => self%body)
         do cell = 1, body%mesh%fracture%n_cells
            moment = moment + body%model%elasticity%shear_modulus() &
                     *body%model%mesh%face_length(cell) &
                     *dot_product(share, abs(body%contact%jump(1, :, cell) &
                                             - body%contact%slip_before(:, cell)))
         end do
      end associate
   end function seismic_moment

   !> By how much the tip nearest to growth exceeds the toughness, relative to it.
   pure real(rk) function largest_excess(self)
      type(simulation_t), intent(in) :: self

      largest_excess = -1.0_rk
      if (.not. all(self%tip%arrested)) then
         largest_excess = maxval(self%tip%drive%intensity, mask=.not. self%tip%arrested) &
                          /self%scene%material%toughness - 1.0_rk
      end if
   end function largest_excess

   !> Advance the tips at their onset, each in the direction in which it goes on straight
   !! (tips_path), on a new mesh and at the same load.
   subroutine grow(self, increment, any_grew, timers, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: increment  !< l_max [m]
      logical, intent(out) :: any_grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: corrections = 8
      real(rk), parameter :: nothing = 1.0e-9_rk  ! of an advance
      real(rk) :: wanted(size(self%tip)), applied, left, kink, to(2)
      logical :: grows(size(self%tip)), any_turned, has_turned
      integer(ik) :: i, k

      any_grew = .false.
      self%tip%advance = 0.0_rk
      do i = 1, size(self%tip)
         self%tip(i)%intensity_before = self%tip(i)%intensity
         self%tip(i)%drive_before = self%tip(i)%drive
         grows(i) = self%tip(i)%drive%intensity >= (1.0_rk - together) &
                    *self%scene%material%toughness .and. .not. self%tip(i)%arrested
      end do
      if (.not. any(grows)) return
      wanted = advances(self%tip%drive%energy, grows, increment, self%scene%growth%exponent)
      do i = 1, size(self%tip)
         if (.not. grows(i)) cycle
         associate (tip => self%tip(i))
            call carry_over(wanted(i), tip%carried, tip%rosette_radius, applied, left)
            tip%carried = left
            if (.not. applied > 0.0_rk) cycle
            call tip%foresee(tip%drive%angle, -tip%intensity%k2, tip%drive%intensity, applied, &
                             kink)
            to = new_tip(tip%xy, tip%direction, kink, applied)
            call meet_target(self, tip, tip%xy, to)
            if (.not. norm2(to - tip%xy) > nothing*applied) cycle  ! something has come to it
            call extend(self%network, tip%fracture, tip%end, to)
            call tip%move(to, kink)
            any_grew = .true.
         end associate
      end do
      if (.not. any_grew) return
      call self%body%remember()
      call rebuild(self, timers, error)
      do k = 1, corrections
         if (allocated(error)) return
         any_turned = .false.
         do i = 1, size(self%tip)
            associate (tip => self%tip(i))
               if (tip%arrested) cycle
               call tip%correct(tip%drive%angle, -tip%intensity%k2, has_turned)
               if (.not. has_turned) cycle
               call meet_target(self, tip, tip%origin, tip%xy)
               tip%advance = norm2(tip%xy - tip%origin)
               call move_end(self%network, tip%fracture, tip%end, tip%xy)
               any_turned = .true.
            end associate
         end do
         if (.not. any_turned) exit
         call rebuild(self, timers, error)
      end do
      do i = 1, size(self%tip)
         call self%tip(i)%settle(-self%tip(i)%intensity%k2)
      end do
   end subroutine grow

   !> Let the mesh follow the error at a load, if the scene wants it. A coarse mesh shows the error
   !! of a much finer one poorly, so the error falls in steps, each of which makes a mesh about
   !! twice as large.
   subroutine adapt(self, factor, timers, error)
      type(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< of the load [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: pass

      if (.not. self%scene%adaptive%enabled) return
      do pass = 0, self%scene%adaptive%passes
         call self%respond(factor, timers, error)
         if (allocated(error)) return
         call self%body%estimate_body(self%scene, timers)
         if (self%body%estimate%relative <= self%scene%adaptive%tolerance) return
         if (pass == self%scene%adaptive%passes) return
         call self%body%refine(self%scene, self%start, self%network, &
                               max(self%scene%adaptive%tolerance, &
                                   error_step*self%body%estimate%relative), timers, error)
         if (allocated(error)) return
      end do
   end subroutine adapt

   !> The state on a mesh of the present network, made from the one before the increment, at the
   !! same load.
   subroutine rebuild(self, timers, error)
      type(simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%body%grow(self%scene, self%start, self%network, timers, error)
      if (.not. allocated(error)) then
         if (self%scene%adaptive%enabled) then
            call adapt(self, self%factor, timers, error)
         else
            call self%respond(self%factor, timers, error)
         end if
      end if
      if (allocated(error)) self%is_cut = cuts_through(self%body%mesh%fracture)
   end subroutine rebuild

   !> A tip that crosses another fracture or the boundary, or comes nearer to it than its rosette
   !! is wide, joins it there and stops.
   subroutine meet_target(self, tip, from, to)
      type(simulation_t), intent(in) :: self
      type(tip_t), intent(inout) :: tip
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk), intent(inout) :: to(2)  !< where it grows, or meets something [m]
      real(rk) :: at(2), reach
      integer(ik) :: target

      reach = self%scene%discretization%rosette_radius
      if (.not. reach > 0.0_rk) reach = self%scene%discretization%size_fracture
      call find_target(self%network, self%outline, tip%fracture, from, to, reach, target, at)
      if (target == target_none) return
      to = at
      tip%arrested = .true.
      tip%joint = "joins the outer boundary"
      if (target == tip%fracture) then
         tip%joint = "joins its own fracture"
      else if (target /= target_boundary) then
         tip%joint = "joins fracture "//trim(self%scene%fractures(target)%name)
      end if
   end subroutine meet_target

end module mechanics_simulation
