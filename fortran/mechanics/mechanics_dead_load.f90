!> Unstable growth of a scene without a fluid: under a dead load if the equilibrium load of the
!! longer network is smaller, and under any load if no load factor gives an equilibrium. The path
!! consists of networks in equilibrium at smaller loads, and the load stays until a network is in
!! equilibrium at it again.
module mechanics_dead_load
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_timers, only: timers_t
   use mechanics_state, only: loaded_body_t
   use report_rows, only: event_unstable
   implicit none(type, external)
   private

   public :: dead_load_t

   !> The load, and the unstable growth at it.
   type :: dead_load_t
      private
      real(rk) :: factor = 0.0_rk  !< load factor before the increment [-]
      !> equilibrium load of the network before the increment [-]
      real(rk) :: borne = 0.0_rk
      logical :: is_unstable = .false.
      real(rk) :: length = 0.0_rk  !< growth since its beginning [m]
      real(rk) :: released = 0.0_rk  !< released energy less that of new faces [J/m]
      character(len=:), allocatable :: end  !< event to be added once the state is accepted
      real(rk) :: end_factor = 0.0_rk  !< load factor of that event [-]
      real(rk), allocatable :: energy(:)  !< (tips) G before the increment [J/m2]
   contains
      procedure :: begin_increment
      procedure :: end_increment
      procedure :: note_end
      procedure :: stop_growth
      procedure :: visit
   end type dead_load_t

contains

   !> Keep the state from which tips grow.
   subroutine begin_increment(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body

      self%factor = body%factor
      if (.not. self%is_unstable) self%borne = body%factor
      self%energy = body%tip%drive%energy
   end subroutine begin_increment

   !> After an increment, which ends at the equilibrium load: if that is smaller than before and the
   !! load does not fall, evaluate the state at the load before the increment.
   subroutine end_increment(self, body, is_loose, timers, error)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      logical, intent(in) :: is_loose  !< no load factor gives an equilibrium
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: borne, share
      logical :: bears_less

      associate (load => body%scene%load)
         borne = body%factor
         bears_less = (body%factor - self%factor)*(body%bounds(2) - body%bounds(1)) < 0.0_rk
         if (is_loose .or. (load%control == "dead" .and. bears_less)) then
            if (.not. self%is_unstable) then
               call body%chronicle%add_event(self%factor, event_unstable, "unstable growth begins")
               self%is_unstable = .true.
               self%length = 0.0_rk
               self%released = 0.0_rk
            end if
            if (.not. is_loose) call body%respond(self%factor, timers, error)
            if (allocated(error)) return
            call add_growth(self, body, 1.0_rk)
         else if (self%is_unstable) then
            ! The equilibrium load reaches the load within this increment.
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

   !> Add the growth and released energy of an increment, or of the part of it up to the arrest of
   !! the tips, at which G is the energy of new faces.
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

   !> Add the event of unstable growth that has ended in the increment before the accepted state.
   subroutine note_end(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      if (.not. allocated(self%end)) return
      call body%chronicle%add_event(self%end_factor, event_unstable, self%end)
      deallocate (self%end)
   end subroutine note_end

   !> End unstable growth with the run.
   subroutine stop_growth(self, body)
      class(dead_load_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      if (.not. self%is_unstable) return
      call body%chronicle%add_event(body%factor, event_unstable, &
                                    "unstable growth continues at the end of the run: "// &
                                    words(self))
      self%is_unstable = .false.
   end subroutine stop_growth

   !> Length and released energy of unstable growth, in words.
   pure function words(self)
      type(dead_load_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%length, 4)//" m in all, "//brief_text(self%released, 4)// &
              " J/m released"
   end function words

   !> All of it in an archive.
   subroutine visit(self, archive)
      class(dead_load_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("dead_load")
      call archive%item("factor", self%factor)
      call archive%item("borne", self%borne)
      call archive%item("is_unstable", self%is_unstable)
      call archive%item("length", self%length)
      call archive%item("released", self%released)
      call archive%list("end", self%end)
      call archive%item("end_factor", self%end_factor)
      call archive%list("energy", self%energy)
      call archive%leave()
   end subroutine visit

end module mechanics_dead_load
