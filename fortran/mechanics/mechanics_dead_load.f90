!> Unstable growth: under a dead load where the longer network would bear less, and under any load
!! where no load factor keeps the tips in equilibrium. The path consists of networks in equilibrium,
!! all at the load at which the growth began, until they bear that load again.
module mechanics_dead_load
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_timers, only: timers_t
   use mechanics_equilibrium, only: increment_t
   use mechanics_state, only: loaded_body_t
   use report_rows, only: event_unstable
   implicit none(type, external)
   private

   public :: dead_load_t

   !> The load, and the unstable growth at it.
   type :: dead_load_t
      real(rk), private :: factor = 0.0_rk  !< before the increment [-]
      real(rk), private :: borne = 0.0_rk  !< what the network before the increment bears [-]
      logical, private :: is_unstable = .false.
      real(rk), private :: length = 0.0_rk  !< of growth since it began [m]
      real(rk), private :: released = 0.0_rk  !< energy beyond that of new faces since then [J/m]
      character(len=:), allocatable, private :: end  !< what is to be told of it once accepted
      real(rk), private :: end_factor = 0.0_rk  !< where that was [-]
      real(rk), allocatable, private :: energy(:)  !< G of the tips before the increment [J/m2]
   contains
      procedure :: begin_increment
      procedure :: end_increment
      procedure :: tell
      procedure :: stop_growth
   end type dead_load_t

contains

   !> Remember the state from which tips grow.
   subroutine begin_increment(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body

      self%factor = body%factor
      if (.not. self%is_unstable) self%borne = body%factor
      self%energy = body%tip%drive%energy
   end subroutine begin_increment

   !> The tips have grown, at the load that they bear now: where it is less than before, and does
   !! not fall, the state is that at the load before.
   subroutine end_increment(self, body, increment, timers, error)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      type(increment_t), intent(inout) :: increment
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: borne, share
      logical :: bears_less

      if (.not. increment%has_grown) return
      associate (load => body%scene%load)
         borne = body%factor
         bears_less = (body%factor - self%factor)*(body%bounds(2) - body%bounds(1)) < 0.0_rk
         if (increment%is_loose .or. (load%control == "dead" .and. bears_less)) then
            if (.not. self%is_unstable) then
               call body%chronicle%add_event(self%factor, event_unstable, "unstable growth begins")
               self%is_unstable = .true.
               self%length = 0.0_rk
               self%released = 0.0_rk
            end if
            if (.not. increment%is_loose) call body%respond(self%factor, timers, error)
            if (allocated(error)) return
            call add_growth(self, body, 1.0_rk)
         else if (self%is_unstable) then
            ! The network bears the load at some place of this increment, where G is that of new
            ! faces.
            share = 1.0_rk
            if (abs(borne - self%factor) > 0.0_rk) share = (self%factor - self%borne) &
                                                           /(borne - self%borne)
            call add_growth(self, body, share)
            self%end = "unstable growth ends: "//words(self)
            self%end_factor = self%factor
            self%is_unstable = .false.
         end if
         self%borne = borne
      end associate
   end subroutine end_increment

   !> What the tips have gained in an increment, or the share of it up to their arrest, where they
   !! have just the energy that new faces need.
   pure subroutine add_growth(self, body, share)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body
      real(rk), intent(in) :: share  !< [-]
      real(rk) :: needed(size(body%tip)), surplus(size(body%tip))

      needed = (body%rules%toughness*body%tip%drive%resistance)**2 &
               /merge(body%tip%drive%crack_modulus, body%body%model%elasticity%crack_modulus(), &
                      body%tip%drive%crack_modulus > 0.0_rk)
      surplus = self%energy - needed
      if (share < 1.0_rk) then
         surplus = 0.5_rk*surplus
      else
         where (body%tip%is_free)
            surplus = 0.5_rk*(surplus + body%tip%drive%energy - needed)
         end where
      end if
      self%length = self%length + share*sum(body%tip%advance)
      self%released = self%released + share*dot_product(surplus, body%tip%advance)
   end subroutine add_growth

   !> Where unstable growth has ended in the increment that led to the accepted state, say so.
   subroutine tell(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      if (.not. allocated(self%end)) return
      call body%chronicle%add_event(self%end_factor, event_unstable, self%end)
      deallocate (self%end)
   end subroutine tell

   !> The scene is over: unstable growth ends with it.
   subroutine stop_growth(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      if (.not. self%is_unstable) return
      call body%chronicle%add_event(body%factor, event_unstable, &
                                    "unstable growth continues at the end of the run: "// &
                                    words(self))
      self%is_unstable = .false.
   end subroutine stop_growth

   pure function words(self)
      type(dead_load_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%length, 4)//" m in all, "//brief_text(self%released, 4)// &
              " J/m released"
   end function words

end module mechanics_dead_load
