!> A way to simulate a scene, as the run loop sees it: from one accepted state to the next, with
!! the growth of the tips in between.
module app_mode
   use app_journal, only: journal_t
   use base_errors, only: error_t
   use base_kinds, only: ik
   use base_timers, only: timers_t
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   use tips_network, only: end_gain
   use tips_state, only: tip_state_t
   implicit none(type, external)
   private

   public :: mode_t

   !> One scene on its way.
   type, abstract :: mode_t
      character(len=:), allocatable :: ending  !< why the scene is over; allocated once it is
   contains
      procedure(begin_mode), deferred :: begin
      procedure(tell_start), deferred :: tell_start
      procedure(go_on), deferred :: next_state
      procedure(tell), deferred :: tell_state
      procedure(go_on), deferred :: grow
      procedure(tell), deferred :: tell_end
      procedure(name_state), deferred :: last_state
      procedure :: end_at_gain
   end type mode_t

   abstract interface
      !> Mesh and set up; nothing is loaded yet.
      subroutine begin_mode(self, scene, timers, error)
         import :: error_t, mode_t, scene_t, timers_t
         implicit none(type, external)
         class(mode_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine begin_mode

      !> Tell the first network, and what the scene uses and does without.
      subroutine tell_start(self, journal)
         import :: journal_t, mode_t
         implicit none(type, external)
         class(mode_t), intent(in) :: self
         type(journal_t), intent(inout) :: journal
      end subroutine tell_start

      !> next_state: go on to the next accepted state. grow: let the tips grow in it, and tell the
      !! files of that. Either sets `ending` where nothing is left to do.
      subroutine go_on(self, journal, timers, error)
         import :: error_t, journal_t, mode_t, timers_t
         implicit none(type, external)
         class(mode_t), intent(inout) :: self
         type(journal_t), intent(inout) :: journal
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine go_on

      !> tell_state: tell the files of an accepted state. tell_end: write the fields of the last
      !! good state, however the run has ended, unless they have just been written.
      subroutine tell(self, journal, error)
         import :: error_t, journal_t, mode_t
         implicit none(type, external)
         class(mode_t), intent(inout) :: self
         type(journal_t), intent(inout) :: journal
         type(error_t), allocatable, intent(out) :: error
      end subroutine tell

      !> The last state that the files were told of, in words for messages: a time, a load factor.
      pure function name_state(self) result(words)
         import :: mode_t
         implicit none(type, external)
         class(mode_t), intent(in) :: self
         character(len=:), allocatable :: words
      end function name_state
   end interface

contains

   !> Set `ending` if a fracture's end has grown as far as the scene wants.
   subroutine end_at_gain(self, scene, start, network, tips)
      class(mode_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< of the scene, and as it has grown
      class(tip_state_t), intent(in) :: tips(:)
      integer(ik) :: i

      do i = 1, size(tips)
         associate (tip => tips(i))
            if (end_gain(network, start, tip%fracture, tip%end) < scene%growth%stop_gain) cycle
            self%ending = "fracture "//trim(scene%fractures(tip%fracture)%name)// &
                          " has gained stop_gain"
         end associate
      end do
   end subroutine end_at_gain

end module app_mode
