!> A body under a load factor: its state on a mesh that is adapted to growth and to the error
!! estimate, and its tips; whether fractures have cut the body into parts.
module mechanics_state
   use base_errors, only: error_t
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use fine_elasticity, only: elasticity_t, is_same
   use fine_tip_types, only: frame_of_tip, tip_frame_t
   use growth_rules, only: growth_rules_t
   use growth_law, only: growth_drive
   use growth_network, only: network_of_scene
   use mechanics_body, only: body_t
   use mechanics_programme, only: reading_t
   use mesh_types, only: fracture_mesh_t, point_boundary
   use report_restart, only: restartable_t
   use report_scene, only: relative_toughness
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: cuts_through, loaded_body_t, together

   !> Largest relative difference of K_eq of tips that grow together: about the error of the
   !! intensities, so that equal tips remain equal [-].
   real(rk), parameter :: together = 2.0e-3_rk

   !> Distance below which ends and kinks are targets of a tip that passes them, since no mesh of
   !! good shape fits between [increments].
   real(rk), parameter :: near_way = 0.02_rk

   !> Target error of a new mesh over the present estimated error [-].
   real(rk), parameter :: error_step = 0.4_rk

   !> A body under a load factor.
   type, abstract, extends(restartable_t) :: loaded_body_t
      logical :: is_cut = .false.  !< fractures have cut off an unsupported part of the body
      type(body_t) :: body
      integer :: meshed_vertices = 0  !< vertices of the network for which the mesh was made
      logical :: is_trying = .false.  !< meshes are made from that kept by the body (tries)
      real(rk) :: factor = 0.0_rk  !< load factor [-]
      !> load factors from which to which equilibrium is searched [-]
      real(rk) :: bounds(2) = 0.0_rk
      logical :: turns = .false.  !< the load may change direction
      real(rk) :: accepted_moment = 0.0_rk  !< seismic moment before the present slip [N m]
   contains
      procedure :: take_scene
      procedure :: respond
      procedure :: adapt
      procedure :: evaluate
      procedure :: correct_intensities
      procedure :: accept
      procedure :: reading
      procedure :: largest_excess
      procedure :: seismic_moment
   end type loaded_body_t

contains

   !> Set the scene, its network, its first load and its rules of growth.
   subroutine take_scene(self, scene)
      class(loaded_body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(outline_t) :: outline
      integer(ik) :: f

      call self%set_scene(scene)
      self%factor = scene%load%from
      self%bounds = [scene%load%from, scene%load%to]
      if (allocated(scene%load%factors)) self%turns = size(scene%load%factors) > 1
      self%start = network_of_scene(scene)
      self%network = self%start
      outline = outline_of_scene(scene)
      self%rules = growth_rules_t(toughness=scene%material%toughness, &
                                  increment=scene%growth%increment, &
                                  stop_gain=scene%growth%stop_gain, &
                                  exponent=scene%growth%exponent, together=together, &
                                  joins=.true., heads=.true., &
                                  near=near_way*scene%growth%increment, outline=outline%corners)
      ! In equilibrium all tips that grow advance by shares of one increment (mechanics_tries): the
      ! smallest of all fractures.
      if (any(scene%fractures%increment > 0.0_rk)) then
         associate (own => [(scene%increment_of(f), f=1, size(scene%fractures, kind=ik))])
            self%rules%increment = minval(own)
            self%rules%near = near_way*minval(own)
            if (scene%growth%law == "paris") then
               self%rules%own_increment = own
               self%rules%own_near = near_way*own
            end if
         end associate
      end if
   end subroutine take_scene

   !> Find the state of the body and of its tips at a load factor.
   subroutine respond(self, factor, timers, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%heed(error)
      if (allocated(error)) return
      call self%body%respond(self%scene, factor, timers, error)
      if (allocated(error)) return
      self%factor = factor
      if (self%scene%growth%intensities) call take_intensities(self)
   end subroutine respond

   !> Take the intensities of the tips from the tips of the body's mesh.
   subroutine take_intensities(self)
      class(loaded_body_t), intent(inout) :: self
      type(tip_frame_t) :: frame
      integer(ik) :: i, k

      associate (fracture => self%body%mesh%fracture)
         do i = 1, size(self%tip)
            associate (tip => self%tip(i))
               k = findloc(fracture%tip_fracture == tip%fracture .and. &
                           fracture%tip_end == tip%end, .true., dim=1)
               tip%is_free = k > 0  ! otherwise it has joined a target, or was joined
               if (.not. tip%is_free) then
                  tip%arrested = .true.
                  cycle
               end if
               tip%intensity = self%body%intensity(k)
               tip%rosette_radius = fracture%tip_radius(k)
               frame = frame_of_tip(self%body%model%mesh, self%body%model%rocks, k)
               tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                        frame%rock%crack_modulus())
               call tip%resist(relative_toughness(self%scene, self%network, tip%fracture, tip%end))
            end associate
         end do
      end associate
   end subroutine take_intensities

   !> Estimate the errors of the intensities from that of the whole solution.
   subroutine correct_intensities(self, timers, error)
      class(loaded_body_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%body%correct_intensities(timers, error)
      if (.not. allocated(error)) call take_intensities(self)
   end subroutine correct_intensities

   !> With &adaptive, adapt the mesh to the error at a load. A coarse mesh estimates the error of a
   !! much finer one poorly, so the error decreases in steps, each with about twice the elements.
   subroutine adapt(self, factor, timers, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: factor  !< load factor [-]
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

   !> Find the state at the present load on a mesh of the present network, made from the mesh before
   !! the increment.
   subroutine evaluate(self, timers, error)
      class(loaded_body_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      if (size(self%network%xy, 2) > self%meshed_vertices .and. .not. self%is_trying) then
         ! The network has new vertices: a new increment.
         call self%body%remember()
         self%meshed_vertices = size(self%network%xy, 2)
      end if
      call self%body%grow(self%scene, self%start, self%network, timers, error)
      if (.not. allocated(error)) then
         if (self%scene%adaptive%enabled) then
            call self%adapt(self%factor, timers, error)
         else
            call self%respond(self%factor, timers, error)
         end if
      end if
      if (allocated(error)) self%is_cut = cuts_through(self%body%mesh%fracture)
   end subroutine evaluate

   !> The intensities of the tips that may grow.
   pure function reading(self)
      class(loaded_body_t), intent(in) :: self
      type(reading_t) :: reading

      reading%factor = self%factor
      reading%k1 = pack(self%tip%intensity%k1,.not. self%tip%arrested)
      reading%k2 = pack(self%tip%intensity%k2,.not. self%tip%arrested)
   end function reading

   !> Accept the slip of the faces as the history of further slip.
   subroutine accept(self)
      class(loaded_body_t), intent(inout) :: self

      self%accepted_moment = self%seismic_moment()
      call self%body%contact%accept()
   end subroutine accept

   !> Seismic moment of all slip in contact so far, per metre of thickness [N m].
   pure real(rk) function seismic_moment(self) result(moment)
      class(loaded_body_t), intent(in) :: self
      real(rk), parameter :: share(3) = [1.0_rk, 1.0_rk, 4.0_rk]/6.0_rk  ! start, end, mid
      type(elasticity_t) :: rock(2)  ! on side +, -
      real(rk) :: shear, other
      integer(ik) :: cell

      moment = self%accepted_moment
      associate (body => self%body)
         do cell = 1, body%mesh%fracture%n_cells
            rock(1) = body%model%rocks%in_cell(body%model%mesh%face_cells(1, cell))
            rock(2) = body%model%rocks%in_cell(body%model%mesh%face_cells(2, cell))
            shear = rock(1)%shear_modulus()
            other = rock(2)%shear_modulus()
            if (.not. is_same(rock(1), rock(2))) shear = 2.0_rk*shear*other/(shear + other)
            moment = moment + shear &
                     *body%model%mesh%face_length(cell) &
                     *dot_product(share, abs(body%contact%jump(1, :, cell) &
                                             - body%contact%slip_before(:, cell)))
         end do
      end associate
   end function seismic_moment

   !> Largest K_eq/K_IC - 1 of the tips that may grow; -1 if there are none [-].
   pure real(rk) function largest_excess(self)
      class(loaded_body_t), intent(in) :: self

      largest_excess = -1.0_rk
      if (.not. all(self%tip%arrested)) then
         largest_excess = maxval(self%tip%drive%intensity, mask=.not. self%tip%arrested) &
                          /self%scene%material%toughness - 1.0_rk
      end if
   end function largest_excess

   !> Fractures form a ring, possibly with the outer boundary, and cut off a part of the body;
   !! .false. without a mesh.
   pure logical function cuts_through(fracture)
      type(fracture_mesh_t), intent(in) :: fracture
      type(groups_t) :: groups
      integer(ik) :: cell, i, outer
      logical :: were_joined

      cuts_through = .false.
      if (.not. allocated(fracture%cell_points)) return
      groups = single_groups(fracture%n_points)
      outer = findloc(fracture%point_kind, point_boundary, dim=1)
      do i = 1, fracture%n_points
         if (fracture%point_kind(i) == point_boundary) call groups%join(outer, i)
      end do
      do cell = 1, fracture%n_cells
         associate (ends => fracture%cell_points(:, cell))
            call groups%join(ends(1), ends(2), were_joined)
         end associate
         cuts_through = cuts_through .or. were_joined
      end do
   end function cuts_through

end module mechanics_state
