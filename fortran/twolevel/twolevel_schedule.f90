!> Times at which loads and wells change abruptly, and the time-dependent values of the sides.
module twolevel_schedule
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_time
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: follow_sides, last_switch, next_switch, shortest_stage

contains

   !> Set the values of the sides for a step from `since` to `time`.
   elemental subroutine follow_sides(scene, time, since)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: since  !< [s]

      call scene%sides%set_time(time, since)
      if (allocated(scene%parts)) call scene%parts%set_time(time, since)
   end subroutine follow_sides

   !> Last time at which a stage of a well began or ended, a time-dependent side value had a corner,
   !! or the scene began [s].
   pure real(rk) function last_switch(scene, now) result(time)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now  !< [s]

      associate (switches => switch_times(scene))
         time = max(0.0_rk, maxval(switches, mask=switches <= now))
      end associate
   end function last_switch

   !> Next time at which a stage of a well begins or ends, a time-dependent side value has a corner,
   !! or the scene ends [s].
   pure real(rk) function next_switch(scene, now) result(time)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now  !< [s]

      associate (switches => switch_times(scene))
         time = min(scene%time%end, minval(switches, mask=switches > now*(1.0_rk + same_time)))
      end associate
   end function next_switch

   !> Shortest time between two switches [s].
   pure real(rk) function shortest_stage(scene) result(shortest)
      type(scene_t), intent(in) :: scene
      real(rk) :: time

      time = 0.0_rk
      shortest = scene%time%end
      do while (time < scene%time%end)
         shortest = min(shortest, next_switch(scene, time) - time)
         time = next_switch(scene, time)
      end do
   end function shortest_stage

   !> All these times, in any order [s].
   pure function switch_times(scene) result(times)
      type(scene_t), intent(in) :: scene
      real(rk), allocatable :: times(:)
      integer(ik) :: k, w

      allocate (times(0))
      do w = 1, size(scene%injections, kind=ik)
         associate (well => scene%injections(w))
            times = [times, [(well%stage_start(k), k=1, well%stage_count())], well%end]
         end associate
      end do
      do k = 1, size(scene%sides, kind=ik)
         if (scene%sides(k)%changes()) times = [times, scene%sides(k)%course%time]
      end do
      if (.not. allocated(scene%parts)) return
      do k = 1, size(scene%parts, kind=ik)
         if (scene%parts(k)%changes()) times = [times, scene%parts(k)%course%time]
      end do
   end function switch_times

end module twolevel_schedule
