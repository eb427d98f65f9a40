!> Growth or wells that a scene has from a restart on. The state has been loaded as that of a scene
!! with the wells and the growth of the checkpoint; mesh and fields stay.
submodule(twolevel_state:twolevel_simulation) twolevel_switch
use base_texts, only: text_t
use coarse_wells, only: control_rate, rock_wells_t
use report_rows, only: entry_row_t
use scene_plausible, only: doubts_of_scene
use scene_types, only: growth_t
use twolevel_places, only: place_tips
use twolevel_schedule, only: next_switch
use twolevel_well_rows, only: entry_rows, well_pressures
implicit none(type, external)

contains

module procedure take_over
type(growth_t) :: growth
type(timers_t) :: timers
real(rk), allocatable :: share(:, :)
type(text_t), allocatable :: doubts(:)
integer(ik) :: i, n_controlled, n_old, n_rock

growth = self%scene%growth
n_old = size(self%scene%injections, kind=ik)
call timers%begin()
self%scene = scene
call keep_above_zero(self%scene)
doubts = doubts_of_scene(scene)
do i = 1, size(doubts, kind=ik)
   call self%summary%warn(doubts(i)%text)
end do
self%scene%growth%was_enabled = growth%enabled .or. growth%was_enabled
self%rules = rules_of_scene(self%scene)
associate (now => self%now%coarse%time, before => self%before%time, step => self%step)
   call follow_sides(self%scene, now, before)
   step%ends_at_switch = step%ends_at_switch .or. &
                         next_switch(self%scene, before) <= now*(1.0_rk + same_time)
end associate
associate (problem => self%problem, mesh => self%problem%mesh)
   n_controlled = problem%model%wells%n_all
   n_rock = problem%model%rock_wells%n
   problem%model%rock_wells = rock_wells_t()
   call share_wells(entries_of(self%scene%injections), mesh%fracture, share)
   share(:, :size(problem%share, 2)) = problem%share
   problem%share = share
   call problem%model%set_mesh(mesh, self%scene, timers, error)
   if (allocated(error)) return
   call problem%feed_wells(self%scene, error)
   if (allocated(error)) return
   if (self%scene%growth%leaves_partial_cells()) then
      call place_tips(self%front_state_t, self%now%segment, problem)
   end if
end associate
if (size(self%scene%injections) > n_old) call add_wells(self, n_old, n_controlled, n_rock)
if (self%scene%growth%enabled .eqv. growth%enabled) return
call set_scales(self)
self%now%grown = [integer(ik) ::]
if (.not. self%scene%growth%enabled) return
call self%summary%use_after_all("growth", no_growth)
self%summary%growth_jumps = max(0_ik, self%summary%growth_jumps)
if (allocated(self%windows%slot)) return
call begin_windows(self)
call self%evaluate(timers, error)
if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
end procedure take_over

!> Add wells at rest after those of the state.
subroutine add_wells(self, n_old, n_controlled, n_rock)
   class(two_levels_t), intent(inout) :: self
   integer(ik), intent(in) :: n_old  !< number of the wells of the state
   !> numbers of those that pressures control, and of those of them in the rock
   integer(ik), intent(in) :: n_controlled, n_rock
   type(levels_state_t) :: before
   logical, allocatable :: is_old(:)  ! flows of controlled wells and entries
   integer(ik) :: n

   before = self%now
   call self%rest_wells()
   associate (model => self%problem%model, now => self%now%coarse, was => before%coarse)
      n = size(self%scene%injections, kind=ik)
      allocate (is_old(0))
      if (model%wells%n_all > 0) is_old = model%wells%flow_number() <= n_old
      if (n_controlled > 0) then
         associate (heads => is_old(:model%wells%n_all))
            now%well_flow = unpack(was%well_flow, is_old, now%well_flow)
            now%well_head = unpack(was%well_head, heads, now%well_head)
            now%well_rate = unpack(was%well_rate, heads, now%well_rate)
            self%now%given = unpack(before%given, is_old, self%now%given)
            self%now%at_limit = unpack(before%at_limit, heads, self%now%at_limit)
         end associate
      end if
      if (allocated(was%rings)) now%rings(:, :size(was%rings, 2)) = was%rings
      now%rock_well_control = [was%rock_well_control, &
                               spread(control_rate, 1, &
                                      int(model%rock_wells%n - n_rock))]
      call self%well_results%add(self%scene, self%problem, now)
      if (allocated(self%now%heat%well_temperature)) then
         self%now%heat%well_temperature = [self%now%heat%well_temperature, &
                                           spread(0.0_rk, 1, n - n_old)]
      end if
      call follow_wells(self, n_old, is_old(model%wells%n_all + 1:))
      call self%summary%use_after_all("injection", no_wells)
   end associate
end subroutine add_wells

!> Begin to follow the errors of added wells.
subroutine follow_wells(self, n_old, entry_is_old)
   class(two_levels_t), intent(inout) :: self
   integer(ik), intent(in) :: n_old  !< number of the wells so far
   logical, intent(in) :: entry_is_old(:)  !< (entries of all wells)
   type(entry_row_t), allocatable :: rows(:)
   logical :: is_old(size(self%scene%injections))
   integer :: n, n_new

   n = size(is_old)
   n_new = n - n_old
   is_old = .false.
   is_old(:n_old) = .true.
   associate (errors => self%value_errors, state => self%now%coarse)
      call errors%wells%add([is_old, is_old, is_old], &
                            [well_pressures(self%scene, self%problem, state%time, state), &
                             spread(0.0_rk, 1, 2*n)])
      if (allocated(errors%of_wells)) then
         errors%of_wells = [errors%of_wells, spread(0.0_rk, 1, n_new)]
         errors%flows = [errors%flows, spread(.false., 1, n_new)]
         errors%risen = [errors%risen, spread(0.0_rk, 1, n_new)]
      end if
      if (.not. allocated(errors%entries%value)) return
      rows = entry_rows(self%problem, state)
      call errors%entries%add([entry_is_old, entry_is_old], [rows%pressure, rows%flow])
   end associate
end subroutine follow_wells

end submodule twolevel_switch
