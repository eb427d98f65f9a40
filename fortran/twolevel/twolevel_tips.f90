!> All free tips with their windows: intensities, growth, and what the coarse level has yet to learn
!! of it. Directions of growth: tips_path.
module twolevel_tips
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use mesh_builder, only: mesher_t
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use tips_growth, only: growth_drive, new_tip
   use tips_increment, only: begin_increment, plan_increment, reach
   use tips_network, only: extend, move_end, other_distance
   use tips_state, only: tip_state_t
   use twolevel_window, only: coarse_level_t, window_t
   implicit none(type, external)
   private

   public :: find_tips, tip_t, tips_t

   !> relative; the two methods differ by about as much
   real(rk), parameter :: intensity_error = 0.01_rk

   !> A free tip; its place is that on the fine level.
   type, extends(tip_state_t) :: tip_t
      real(rk) :: pending = 0.0_rk  !< growth that the coarse level does not know yet [m]
      integer(ik) :: pending_vertices = 0
   end type tip_t

   !> The tips and the network on the fine level, which is ahead of the coarse one.
   type :: tips_t
      type(network_t) :: network
      type(tip_t), allocatable :: tip(:)
      type(window_t), allocatable :: window(:)
      logical, allocatable :: built(:), projected(:)
   contains
      procedure :: evaluate
      procedure :: grow
      procedure :: correct_tips
      procedure :: coarse_changed
      procedure :: hand_over
   end type tips_t

contains

   !> The free tips of the network.
   subroutine find_tips(mesh, network, tips)
      type(mesh_t), intent(in) :: mesh
      type(network_t), intent(in) :: network
      type(tips_t), intent(out) :: tips

      integer(ik) :: i, n

      n = mesh%fracture%n_tips
      tips%network = network
      allocate (tips%tip(n), tips%window(n))
      allocate (tips%built(n), tips%projected(n), source=.false.)
      do i = 1, n
         tips%tip(i)%fracture = mesh%fracture%tip_fracture(i)
         tips%tip(i)%end = mesh%fracture%tip_end(i)
         tips%tip(i)%xy = mesh%fracture%point_xy(:, mesh%fracture%tip_point(i))
         tips%tip(i)%direction = mesh%fracture%tip_direction(:, i)
      end do
   end subroutine find_tips

   !> Stress intensity factors and growth drive of every tip, in the present state of the coarse
   !! level.
   subroutine evaluate(self, scene, mesher, mesh, level, state, undrained, error)
      class(tips_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: mesh  !< the coarse one
      type(coarse_level_t), intent(in) :: level
      type(state_t), intent(in) :: state
      logical, intent(in) :: undrained  !< no fluid has moved since the load changed
      type(error_t), allocatable, intent(out) :: error

      integer(ik) :: i

      do i = 1, size(self%tip)
         associate (tip => self%tip(i), window => self%window(i))
            if (.not. self%built(i)) then
               call window%build(scene, self%network, tip%fracture, tip%end, error)
               if (allocated(error)) return
               self%built(i) = .true.
               self%projected(i) = .false.
            end if
            if (.not. self%projected(i)) then
               call window%project(mesher, mesh, error)
               if (allocated(error)) return
               self%projected(i) = .true.
            end if
            if (window%undrained .neqv. undrained) then
               call window%set_rock(scene, undrained, error)
               if (allocated(error)) return
            end if
            call window%intensity(scene, mesh, level, state, tip%intensity, error)
            if (allocated(error)) return
            tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                     window%model%elasticity%crack_modulus())
         end associate
      end do
   end subroutine evaluate

   !> Advance the tips whose equivalent intensity reaches the toughness (model.md section 5).
   subroutine grow(self, scene, increment, any_grew)
      class(tips_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: increment  !< l_max [m]
      logical, intent(out) :: any_grew

      real(rk) :: advance(size(self%tip)), radius(size(self%tip)), to(2)
      logical :: grows(size(self%tip))
      integer(ik) :: i

      any_grew = .false.
      call begin_increment(self%tip)
      if (.not. any(reach(self%tip, scene%material%toughness))) return
      ! Where one tip grows, those that the error of their intensities does not tell from it grow
      ! too: wings of equal rank would otherwise drift apart by chance.
      grows = reach(self%tip, (1.0_rk - intensity_error)*scene%material%toughness)
      do i = 1, size(self%tip)
         associate (window => self%window(i))
            radius(i) = window%mesh%fracture%tip_radius(window%tip)
         end associate
      end do
      call plan_increment(self%tip, grows, increment, scene%growth%exponent, radius, advance)
      do i = 1, size(self%tip)
         if (.not. advance(i) > 0.0_rk) cycle
         associate (tip => self%tip(i))
            to = new_tip(tip%xy, tip%direction, tip%drive%angle, advance(i))
            call find_obstacle(self%network, scene, tip, to)
            if (tip%arrested) cycle
            call extend(self%network, tip%fracture, tip%end, to)
            call forget_windows(self, tip%xy, to)
            call tip%move(to, tip%drive%angle)
            tip%pending = tip%pending + advance(i)
            tip%pending_vertices = tip%pending_vertices + 1
            any_grew = .true.
         end associate
      end do
   end subroutine grow

   !> Turn the last advance of each tip so that it goes on straight. The tips have to be evaluated
   !! before and after.
   subroutine correct_tips(self, any_turned)
      class(tips_t), intent(inout) :: self
      logical, intent(out) :: any_turned

      real(rk) :: before(2)
      integer(ik) :: i
      logical :: has_turned

      any_turned = .false.
      do i = 1, size(self%tip)
         associate (tip => self%tip(i))
            before = tip%xy
            call tip%correct(tip%drive%angle, -tip%intensity%k2, has_turned)
            if (.not. has_turned) cycle
            call forget_windows(self, tip%origin, before)
            call forget_windows(self, tip%origin, tip%xy)
            call move_end(self%network, tip%fracture, tip%end, tip%xy)
            any_turned = .true.
         end associate
      end do
   end subroutine correct_tips

   !> A tip that comes nearer to another fracture or to the boundary than the coarse cells can
   !! resolve stops.
   subroutine find_obstacle(network, scene, tip, to)
      type(network_t), intent(in) :: network
      type(scene_t), intent(in) :: scene
      type(tip_t), intent(inout) :: tip
      real(rk), intent(in) :: to(2)

      real(rk) :: distance
      integer(ik) :: nearest

      associate (domain => scene%domain, reach => scene%discretization%size_fracture)
         call other_distance(network, tip%fracture, tip%xy, to, distance, nearest)
         if (distance < reach) then
            tip%arrested = .true.
            tip%arrest_reason = "next to fracture "//trim(scene%fractures(nearest)%name)
         else if (min(to(1) - domain%x_min, domain%x_max - to(1), to(2) - domain%y_min, &
                      domain%y_max - to(2)) < reach) then
            tip%arrested = .true.
            tip%arrest_reason = "next to the outer boundary"
         end if
      end associate
   end subroutine find_obstacle

   !> Windows that hold a new segment must be meshed again.
   subroutine forget_windows(self, from, to)
      class(tips_t), intent(inout) :: self
      real(rk), intent(in) :: from(2), to(2)

      integer(ik) :: i

      do i = 1, size(self%window)
         if (.not. self%built(i)) cycle
         if (all(min(from, to) <= self%window(i)%upper) .and. &
             all(max(from, to) >= self%window(i)%lower)) self%built(i) = .false.
      end do
   end subroutine forget_windows

   !> The coarse mesh is another one now.
   subroutine coarse_changed(self)
      class(tips_t), intent(inout) :: self

      self%projected = .false.
   end subroutine coarse_changed

   !> Give the coarse network what has grown, each tip's growth as one straight segment, once some
   !! tip's reaches the threshold. Tips with at least half of it go along.
   subroutine hand_over(self, threshold, network, centres)
      class(tips_t), intent(inout) :: self
      real(rk), intent(in) :: threshold  !< eps_p dH [m]
      type(network_t), intent(inout) :: network  !< the coarse one
      !> (2, n) where it has changed [m]; n may be 0
      real(rk), allocatable, intent(out) :: centres(:, :)

      integer(ik) :: i

      allocate (centres(2, 0))
      if (.not. any(self%tip%pending >= threshold*(1.0_rk - 1.0e-9_rk))) return
      do i = 1, size(self%tip)
         associate (tip => self%tip(i))
            if (tip%pending < 0.5_rk*threshold) cycle
            call extend(network, tip%fracture, tip%end, tip%xy)
            centres = reshape([centres, tip%xy], [2, size(centres, 2) + 1])
            if (tip%pending_vertices > 1) call straighten(self, i, network)
            tip%pending = 0.0_rk
            tip%pending_vertices = 0
         end associate
      end do
   end subroutine hand_over

   !> Replace the pending vertices of a tip by the straight segment that the coarse level has.
   subroutine straighten(self, i, coarse)
      class(tips_t), intent(inout) :: self
      integer(ik), intent(in) :: i
      type(network_t), intent(in) :: coarse

      type(network_t) :: straight
      real(rk), allocatable :: kept(:, :)
      integer(ik) :: f, from, to, dropped, before, last

      associate (tip => self%tip(i))
         f = tip%fracture
         dropped = tip%pending_vertices - 1
         from = self%network%first(f)
         to = self%network%first(f + 1) - 1
         straight = self%network
         allocate (kept(2, size(self%network%xy, 2) - dropped))
         if (tip%end == 1) then
            kept(:, :from) = self%network%xy(:, :from)
            kept(:, from + 1:) = self%network%xy(:, from + 1 + dropped:)
            straight%s_start(f) = self%network%s_start(f) - norm2(kept(:, from + 1) - kept(:, from))
            do last = from, from + dropped
               straight%s_start(f) = straight%s_start(f) &
                                    + norm2(self%network%xy(:, last + 1) - self%network%xy(:, last))
            end do
         else
            before = to - dropped
            kept(:, :before - 1) = self%network%xy(:, :before - 1)
            kept(:, before:) = self%network%xy(:, to:)
         end if
         straight%first(f + 1:) = self%network%first(f + 1:) - dropped
         call move_alloc(kept, straight%xy)
         self%network = straight
         tip%direction = coarse_direction(coarse, f, tip%end)
         self%built = .false.
      end associate
   end subroutine straighten

   !> Direction of the last segment at one end of a fracture.
   pure function coarse_direction(network, fracture, end) result(direction)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture, end
      real(rk) :: direction(2)

      integer(ik) :: tip

      tip = merge(network%first(fracture), network%first(fracture + 1) - 1, end == 1)
      direction = network%xy(:, tip) - network%xy(:, merge(tip + 1, tip - 1, end == 1))
      direction = direction/norm2(direction)
   end function coarse_direction

end module twolevel_tips
