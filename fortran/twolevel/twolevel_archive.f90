!> The state of both levels in an archive (base_archive).
module twolevel_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: ik, lk
   use coarse_archive, only: visit_state
   use contact_archive, only: visit_laws
   use fine_archive, only: visit_contact, visit_fine_mesh
   use growth_archive, only: visit_groups, visit_interaction, visit_segments
   use mesh_archive, only: visit_network
   use twolevel_faces, only: coarse_values_t
   use twolevel_followed, only: followed_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_stepping, only: stepper_t
   use twolevel_trend, only: trend_t
   use twolevel_value_errors, only: value_errors_t
   use twolevel_windows_state, only: windows_state_t
   implicit none(type, external)
   private

   public :: visit_levels, visit_stepper, visit_value_errors, visit_values

contains

   subroutine visit_levels(archive, name, now)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(levels_state_t), intent(inout), target :: now

      call archive%enter(name)
      call visit_state(archive, "coarse", now%coarse)
      call visit_network(archive, "coarse_network", now%coarse_network)
      call archive%list("grown", now%grown, "grown; 1:fcells")
      call archive%item("has_new_mesh", now%has_new_mesh)
      call archive%item("undrained", now%undrained)
      call visit_segments(archive, "segment", now%segment)
      call archive%list("active", now%active, "tips ?")
      call visit_interaction(archive, "interaction", now%interaction)
      call visit_groups(archive, "groups", now%groups)
      call visit_windows_state(archive, "windows", now%windows)
      call visit_windows_state(archive, "reference", now%reference)
      call visit_trend(archive, "trend", now%trend)
      call now%stated_errors%visit(archive)
      call archive%plain("fluid", c_loc(now%fluid), storage_size(now%fluid)/8_lk)
      call archive%list("given", now%given, "places ?")
      call archive%list("at_limit", now%at_limit, "controlled ?")
      call archive%leave()
   end subroutine visit_levels

   subroutine visit_windows_state(archive, name, known)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(windows_state_t), intent(inout), target :: known
      integer(lk) :: i, m, n

      call archive%enter(name)
      call archive%extent("tip", known%tip, n, "tips ?")
      if (archive%is_loading) then
         if (allocated(known%tip)) deallocate (known%tip)
         if (n >= 0_lk) allocate (known%tip(n))
      end if
      if (n > 0_lk) call archive%plain("tip", c_loc(known%tip), n*storage_size(known%tip)/8_lk)
      call archive%extent("history", known%history, n, "history_"//name//" ?")
      if (archive%is_loading) then
         if (allocated(known%history)) deallocate (known%history)
         if (n >= 0_lk) allocate (known%history(n))
      end if
      do i = 1_lk, n
         associate (history => known%history(i))
            m = merge(1_lk, -1_lk, allocated(history%mesh))
            call archive%count("mesh", m)
            if (archive%is_loading .and. m > 0_lk) allocate (history%mesh)
            if (m > 0_lk) call visit_fine_mesh(archive, "mesh", history%mesh)
            if (m < 0_lk) call archive%set_extent("fine_faces", -1_ik)  ! that of the window
            m = merge(1_lk, -1_lk, allocated(history%contact))
            call archive%count("contact", m)
            if (archive%is_loading .and. m > 0_lk) allocate (history%contact)
            if (m > 0_lk) call visit_contact(archive, "contact", history%contact)
         end associate
      end do
      call archive%leave()
   end subroutine visit_windows_state

   subroutine visit_trend(archive, name, trend)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(trend_t), intent(inout) :: trend

      call archive%enter(name)
      call archive%item("dt", trend%dt)
      call archive%list("rock", trend%rock, "cells")
      call archive%list("fracture", trend%fracture, "fcells")
      call archive%list("jump", trend%jump, "2, fcells")
      call archive%list("knows_rock", trend%knows_rock, "cells")
      call archive%list("knows_fracture", trend%knows_fracture, "fcells")
      call archive%item("pressure", trend%pressure)
      call archive%item("jumps", trend%jumps)
      call archive%item("least_pressure", trend%least_pressure)
      call archive%item("least_jump", trend%least_jump)
      call archive%agree(name, [allocated(trend%rock), allocated(trend%fracture), &
                                allocated(trend%jump), allocated(trend%knows_rock), &
                                allocated(trend%knows_fracture)])
      call archive%leave()
   end subroutine visit_trend

   !> The control of the step length, without its settings, which are those of the scene.
   subroutine visit_stepper(archive, name, stepper)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(stepper_t), intent(inout) :: stepper

      call archive%enter(name)
      call archive%item("next", stepper%next)
      call archive%item("left_in_vain", stepper%left_in_vain)
      call archive%item("halvings", stepper%halvings)
      call archive%item("solvable", stepper%solvable)
      call archive%item("solved", stepper%solved)
      call archive%item("moment", stepper%moment)
      call archive%item("in_vain", stepper%in_vain)
      call archive%item("onset_cuts", stepper%onset_cuts)
      call archive%item("onset", stepper%onset)
      call archive%item("has_sudden_onset", stepper%has_sudden_onset)
      call archive%item("error_before", stepper%error_before)
      call archive%item("arrival_cuts", stepper%arrival_cuts)
      call archive%item("late", stepper%late)
      call archive%item("at_switches", stepper%at_switches)
      call archive%item("without_headway", stepper%without_headway)
      call archive%item("slow_steps", stepper%slow_steps)
      call archive%item("slow_time", stepper%slow_time)
      call archive%item("was_cut", stepper%was_cut)
      call archive%item("is_short", stepper%is_short)
      call archive%list("pressure", stepper%pressure)
      call archive%leave()
   end subroutine visit_stepper

   subroutine visit_value_errors(archive, name, errors)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(value_errors_t), intent(inout), target :: errors

      call archive%enter(name)
      call archive%plain("row", c_loc(errors%row), storage_size(errors%row)/8_lk)
      call archive%item("of_pressure", errors%of_pressure)
      call archive%item("diffusing", errors%diffusing)
      call archive%item("of_flow", errors%of_flow)
      call archive%item("of_drive", errors%of_drive)
      call archive%item("of_held", errors%of_held)
      call archive%item("start", errors%start)
      call archive%item("held", errors%held)
      call archive%list("of_first", errors%of_first, "fractures, 2")
      call archive%list("opened", errors%opened, "fractures")
      call archive%item("gross", errors%gross)
      call archive%list("of_place", errors%of_place, "fractures ?")
      call archive%list("first_stress", errors%first_stress, "2, fractures")
      call archive%item("of_start", errors%of_start)
      call archive%item("of_length", errors%of_length)
      call archive%item("of_slip", errors%of_slip)
      call archive%item("of_opening", errors%of_opening)
      call archive%list("of_wells", errors%of_wells, "all_wells ?")
      call archive%list("of_flows", errors%of_flows, "all_wells ?")
      call archive%list("of_given", errors%of_given, "fractures ?")
      call archive%list("flows", errors%flows, "all_wells ?")
      call archive%list("risen", errors%risen, "all_wells ?")
      call archive%item("of_rock", errors%of_rock)
      call archive%plain("step", c_loc(errors%step), storage_size(errors%step)/8_lk)
      call visit_followed(archive, "quantities", errors%quantities)
      call visit_followed(archive, "fractures", errors%fractures)
      call visit_followed(archive, "wells", errors%wells)
      call visit_followed(archive, "entries", errors%entries)
      call visit_followed(archive, "probes", errors%probes)
      call archive%leave()
   end subroutine visit_value_errors

   subroutine visit_followed(archive, name, followed)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(followed_t), intent(inout) :: followed
      character(len=:), allocatable :: of

      of = "followed_"//name//" ?"
      call archive%enter(name)
      call archive%item("time", followed%time)
      call archive%item("step", followed%step)
      call archive%item("n_steps", followed%n_steps)
      call archive%item("squares", followed%squares)
      call archive%list("first", followed%first, of)
      call archive%list("turn", followed%turn, of)
      call archive%list("varied", followed%varied, of)
      call archive%list("value", followed%value, of)
      call archive%list("rate", followed%rate, of)
      call archive%list("largest", followed%largest, of)
      call archive%list("of_step", followed%of_step, of)
      call archive%list("sum", followed%sum, of)
      call archive%list("linear", followed%linear, of)
      call archive%list("error", followed%error, of)
      associate (f => followed)
         call archive%agree(name, [allocated(f%first), allocated(f%turn), allocated(f%varied), &
                                   allocated(f%value), allocated(f%rate), allocated(f%largest), &
                                   allocated(f%of_step), allocated(f%sum), allocated(f%linear), &
                                   allocated(f%error)])
      end associate
      call archive%leave()
   end subroutine visit_followed

   subroutine visit_values(archive, name, values)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(coarse_values_t), intent(inout), target :: values
      integer(lk) :: n

      call archive%enter(name)
      call archive%list("of", values%of, "3, blocks ?")
      call archive%list("nodal", values%nodal, "3, nodes ?")
      call archive%extent("drained", values%drained, n, "mesh_tips ?")
      if (archive%is_loading) then
         if (allocated(values%drained)) deallocate (values%drained)
         if (n >= 0_lk) allocate (values%drained(n))
      end if
      if (n > 0_lk) call archive%plain("drained", c_loc(values%drained), &
                                       n*storage_size(values%drained)/8_lk)
      call archive%list("displacement", values%displacement, "2, nodes ?")
      call archive%list("gradient", values%gradient, "2, 2, nodes ?")
      call visit_laws(archive, "law", values%law)
      call archive%list("is_grown", values%is_grown, "fcells ?")
      call archive%list("viscous", values%viscous, "fcells ?")
      call archive%item("undrained", values%undrained)
      call archive%agree(name, [allocated(values%of), allocated(values%nodal), &
                                allocated(values%drained), allocated(values%displacement), &
                                allocated(values%gradient), &
                                allocated(values%law), allocated(values%is_grown), &
                                allocated(values%viscous)])
      call archive%leave()
   end subroutine visit_values

end module twolevel_archive
