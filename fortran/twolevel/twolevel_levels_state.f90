!> The state of both levels: all quantities that a step changes, as plain values that are copied and
!! compared. Scene, meshes, models with their factors, and windows are separate.
module twolevel_levels_state
   use, intrinsic :: iso_fortran_env, only: int8
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use growth_interaction, only: tip_groups_t, interaction_t
   use growth_front, only: front_state_t
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use heat_state, only: heat_state_t
   use mesh_types, only: network_t
   use twolevel_errors, only: stated_errors_t
   use twolevel_trend, only: trend_t
   use twolevel_windows_state, only: windows_state_t
   implicit none(type, external)
   private

   public :: checkpoint_t, different_part, equal, fluid_totals_t, levels_state_t, part_t, parts

   !> Fluid volumes of all steps so far [m2].
   type :: fluid_totals_t
      real(rk) :: injected = 0.0_rk  !< injected minus produced
      real(rk) :: produced = 0.0_rk  !< drawn by wells
      real(rk) :: leaked = 0.0_rk  !< from the fractures into the rock
      real(rk) :: outflow = 0.0_rk  !< through ends of fractures on the boundary
      real(rk) :: prefilled = 0.0_rk  !< contained in new fracture cells
      real(rk) :: mass_error = 0.0_rk  !< error of the balance
   end type fluid_totals_t

   !> State of both levels without tips and fine network (growth_front).
   type :: levels_state_t
      type(state_t) :: coarse  !< coarse level, on its mesh
      type(network_t) :: coarse_network  !< coarse network; the fine network is ahead of it
      integer(ik), allocatable :: grown(:)  !< fracture cells added by the last growth
      logical :: has_new_mesh = .false.  !< the mesh has changed since the last accepted state
      logical :: undrained = .false.  !< the state is the undrained response to the load
      type(segment_t), allocatable :: segment(:)  !< (tips) last path segments
      !> (tips) tips that are evaluated; unallocated: all. The tries of a step do not need the
      !! others.
      logical, allocatable :: active(:)
      type(interaction_t) :: interaction  !< tip interaction matrix
      type(tip_groups_t) :: groups  !< tip groups
      type(windows_state_t) :: windows
      type(windows_state_t) :: reference  !< state of the body as one window
      type(trend_t) :: trend  !< rates of accepted steps
      type(stated_errors_t) :: stated_errors  !< estimated errors of lengths and pressures
      type(fluid_totals_t) :: fluid
      type(heat_state_t) :: heat
      !> (controlled wells, then their entries) volumes since the last switch [m2]
      real(rk), allocatable :: given(:)
      !> (controlled wells) wells whose rate is reduced by a limit
      logical, allocatable :: at_limit(:)
   end type levels_state_t

   !> Complete state of a simulation.
   type :: checkpoint_t
      type(front_state_t) :: front
      type(levels_state_t) :: levels
   end type checkpoint_t

   !> A part of a state as numbers, for comparisons.
   type :: part_t
      character(len=:), allocatable :: name
      real(rk), allocatable :: value(:)
   end type part_t

contains

   !> Whether two states are equal to the last bit.
   pure logical function equal(a, b)
      type(checkpoint_t), intent(in) :: a, b

      equal = len(different_part(a, b)) == 0
   end function equal

   !> Name of the first part in which two states differ; empty: the states are equal.
   pure function different_part(a, b) result(name)
      type(checkpoint_t), intent(in) :: a, b
      character(len=:), allocatable :: name
      type(part_t), allocatable :: of_a(:), of_b(:)
      integer :: i

      of_a = parts(a)
      of_b = parts(b)
      name = ""
      do i = 1, min(size(of_a), size(of_b))
         name = of_a(i)%name
         if (of_b(i)%name /= name .or. size(of_a(i)%value) /= size(of_b(i)%value)) return
         if (any(abs(of_a(i)%value - of_b(i)%value) > 0.0_rk)) return
      end do
      name = ""
      if (size(of_a) /= size(of_b)) name = "parts"
   end function different_part

   !> Parts of a state, in the order of its components.
   pure function parts(state) result(list)
      type(checkpoint_t), intent(in) :: state
      type(part_t), allocatable :: list(:)

      associate (front => state%front, now => state%levels)
         list = [network_part("network", front%network), &
                 part_t("tips", bytes_of_tips(front%tip)), &
                 coarse_parts(now%coarse), &
                 network_part("coarse network", now%coarse_network), &
                 part_t("new cells", integers(now%grown)), &
                 part_t("flags", truths([now%has_new_mesh, now%undrained])), &
                 part_t("segments", bytes_of_segments(now%segment)), &
                 part_t("tips active", some_truths(now%active)), &
                 part_t("interaction", [flat(now%interaction%matrix), &
                                        flat(now%interaction%measured), &
                                        numbers(now%interaction%known_at), &
                                        some_truths(now%interaction%is_known)]), &
                 part_t("groups", [integers(now%groups%kind), numbers(now%groups%usual), &
                                   some_truths(now%groups%is_alone)]), &
                 windows_parts("windows", now%windows), &
                 windows_parts("reference", now%reference), &
                 trend_part(now%trend), certainty_part(now%stated_errors), &
                 part_t("fluid", [now%fluid%injected, now%fluid%produced, now%fluid%leaked, &
                                  now%fluid%outflow, now%fluid%prefilled, now%fluid%mass_error]), &
                 part_t("wells", [numbers(now%given), some_truths(now%at_limit)]), &
                 part_t("heat", [numbers(now%heat%temperature), numbers(now%heat%capacity), &
                                 numbers(now%heat%rate), numbers(now%heat%bend), &
                                 numbers(now%heat%acting), numbers(now%heat%well_temperature), &
                                 now%heat%last, now%heat%next, now%heat%stored, &
                                 now%heat%by_wells, now%heat%by_sides, now%heat%moved, &
                                 now%heat%beyond_range, now%heat%range])]
      end associate
   end function parts

   pure function coarse_parts(state) result(list)
      type(state_t), intent(in) :: state
      type(part_t), allocatable :: list(:)

      list = [part_t("time", [state%time]), &
              part_t("rock", [flat(state%unknowns), flat(state%layer), numbers(state%content), &
                              numbers(state%tractions)]), &
              part_t("jumps", [cube(state%jump), flat(state%slip_before), flat(state%slip_path), &
                               flat(state%opened), flat(state%opened_before)]), &
              part_t("contact", [cube(state%traction), plane(state%contact)]), &
              part_t("fluid in fractures", [numbers(state%pressure), numbers(state%aperture), &
                                            numbers(state%void), numbers(state%leakoff), &
                                            numbers(state%injection)]), &
              part_t("flow", [numbers(state%flow), numbers(state%branch_flow), &
                              numbers(state%joint_pressure)]), &
              part_t("flow in wells", [numbers(state%well_flow), numbers(state%well_head), &
                                       numbers(state%well_rate), &
                                       integers(state%rock_well_control), &
                                       flat(state%rings)]), &
              part_t("guess", [state%guess%dt, numbers(state%guess%change)])]
   end function coarse_parts

   pure function windows_parts(name, windows) result(list)
      character(len=*), intent(in) :: name
      type(windows_state_t), intent(in) :: windows
      type(part_t), allocatable :: list(:)
      real(rk), allocatable :: contact(:), tips(:)
      integer :: i

      allocate (contact(0), tips(0))
      if (allocated(windows%history)) then
         do i = 1, size(windows%history)
            associate (history => windows%history(i))
               if (.not. allocated(history%contact)) cycle
               associate (c => history%contact)
                  contact = [contact, real(i, rk), cube(c%jump), flat(c%slip_before), &
                             flat(c%slip_path), flat(c%opened), flat(c%apart), cube(c%traction), &
                             plane(c%state)]
               end associate
               if (allocated(history%mesh)) contact = [contact, flat(history%mesh%face_s)]
            end associate
         end do
      end if
      if (allocated(windows%tip)) then
         do i = 1, size(windows%tip)
            associate (tip => windows%tip(i))
               tips = [tips, real(tip%times_finer, rk), tip%refined_at, &
                       truths([tip%can_withdraw, tip%was_withdrawn]), tip%found%k1, tip%found%k2, &
                       tip%found%k1_error, tip%found%k2_error, tip%found%g_domain, tip%lacking, &
                       tip%uncertain, tip%compared, tip%compared_at, tip%of_elements, &
                       tip%of_edge, tip%passing, tip%back_stress, tip%jump_then, tip%place_then, &
                       truths([tip%is_compared, tip%was_undrained, tip%has_focus, &
                               tip%is_needed])]
            end associate
         end do
      end if
      list = [part_t("contact in "//name, contact), part_t("tips in "//name, tips)]
   end function windows_parts

   pure type(part_t) function network_part(name, network) result(part)
      character(len=*), intent(in) :: name
      type(network_t), intent(in) :: network

      part = part_t(name, [integers(network%first), flat(network%xy), numbers(network%s_start)])
   end function network_part

   pure type(part_t) function trend_part(trend) result(part)
      type(trend_t), intent(in) :: trend

      part = part_t("rates", [trend%dt, numbers(trend%rock), numbers(trend%fracture), &
                              flat(trend%jump), some_truths(trend%knows_rock), &
                              some_truths(trend%knows_fracture), trend%pressure, trend%jumps, &
                              trend%least_pressure, trend%least_jump])
   end function trend_part

   pure type(part_t) function certainty_part(stated_errors) result(part)
      type(stated_errors_t), intent(in) :: stated_errors

      associate (time_error => stated_errors%time_error)
         part = part_t("errors", [stated_errors%length, stated_errors%pressure, &
                                  numbers(stated_errors%tip), &
                                  real(stated_errors%tries, rk), [stated_errors%tried], &
                                  stated_errors%slope, truths([time_error%is_followed]), &
                                  time_error%value, &
                                  time_error%rate, time_error%error, time_error%step, &
                                  stated_errors%before_switch, stated_errors%time])
      end associate
   end function certainty_part

   !> Bytes of the tips, which have only non-allocatable components, some of them private.
   pure function bytes_of_tips(tip) result(values)
      type(tip_t), allocatable, intent(in) :: tip(:)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(tip)) values = real(transfer(tip, [0_int8]), rk)
   end function bytes_of_tips

   !> Bytes of the segments, which have only non-allocatable components.
   pure function bytes_of_segments(segment) result(values)
      type(segment_t), allocatable, intent(in) :: segment(:)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(segment)) values = real(transfer(segment, [0_int8]), rk)
   end function bytes_of_segments

   pure function numbers(a) result(values)
      real(rk), allocatable, intent(in) :: a(:)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = a
   end function numbers

   pure function flat(a) result(values)
      real(rk), allocatable, intent(in) :: a(:, :)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = [a]
   end function flat

   pure function cube(a) result(values)
      real(rk), allocatable, intent(in) :: a(:, :, :)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = [a]
   end function cube

   pure function integers(a) result(values)
      integer(ik), allocatable, intent(in) :: a(:)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = real(a, rk)
   end function integers

   pure function plane(a) result(values)
      integer(ik), allocatable, intent(in) :: a(:, :)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = real([a], rk)
   end function plane

   pure function some_truths(a) result(values)
      logical, allocatable, intent(in) :: a(:)
      real(rk), allocatable :: values(:)

      allocate (values(0))
      if (allocated(a)) values = truths(a)
   end function some_truths

   pure function truths(a) result(values)
      logical, intent(in) :: a(:)
      real(rk) :: values(size(a))

      values = merge(1.0_rk, 0.0_rk, a)
   end function truths

end module twolevel_levels_state
