!> Simulations whose complete state can be stored in an archive (base_archive), and that go on from
!! it as if they had not been interrupted, bit for bit.
!!
!! The state is stored between two accepted states, when the event log is empty. What follows from
!! the scene (rules, laws, step settings) is made again from it, so that it may differ at a restart.
module report_restart
   use base_archive, only: archive_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk
   use base_texts, only: add_text, text_t
   use base_timers, only: timers_t
   use growth_archive, only: visit_front
   use mesh_archive, only: visit_network
   use report_rows, only: summary_t
   use report_simulation, only: simulation_t
   use scene_outline, only: sides_of_scene
   use scene_plausible, only: doubts_of_scene
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: restartable_t, visit_simulation

   !> A simulation that can be stored.
   type, abstract, extends(simulation_t) :: restartable_t
      logical :: begins_stage = .false.  !< a stage of a well begins at the present state
   contains
      procedure(prepare_scene), deferred :: prepare
      procedure(visit_state), deferred :: visit
      procedure :: take_over
   end type restartable_t

   abstract interface
      !> Set up for a scene, without meshes; `visit` with a loading archive follows.
      subroutine prepare_scene(self, scene)
         import :: restartable_t, scene_t
         implicit none(type, external)
         class(restartable_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
      end subroutine prepare_scene

      !> Store or load the complete state.
      subroutine visit_state(self, archive, timers, error)
         import :: archive_t, error_t, restartable_t, timers_t
         implicit none(type, external)
         class(restartable_t), intent(inout) :: self
         type(archive_t), intent(inout) :: archive
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine visit_state
   end interface

contains

   !> Go on from the loaded state with growth switched, or with more wells, which stand after those
   !! of the scene so far.
   subroutine take_over(self, scene, error)
      class(restartable_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      call raise_error(error, "", "a restart of "//trim(scene%name)//" at "//self%last_state()// &
                       " cannot switch growth on or off: the scene has no fluid")
   end subroutine take_over

   !> What all simulations have.
   subroutine visit_simulation(archive, simulation)
      type(archive_t), intent(inout) :: archive
      class(simulation_t), intent(inout) :: simulation

      call archive%enter("simulation")
      call visit_network(archive, "start", simulation%start)
      if (allocated(simulation%start%first)) call archive%set_extent("fractures", &
                                                          size(simulation%start%first, kind=ik) - 1)
      call visit_network(archive, "network_before", simulation%network_before)
      call archive%set_extent("sides", size(sides_of_scene(simulation%scene), kind=ik))
      call visit_front(archive, "front", simulation%front_state_t)
      if (allocated(simulation%network%xy)) call archive%set_extent("vertices", &
                                                            size(simulation%network%xy, 2, kind=ik))
      call visit_summary(archive, simulation%summary)
      call visit_warnings(archive, simulation%scene, simulation%summary)
      call simulation%watch%visit(archive)
      call simulation%catalogue%visit(archive)
      call simulation%tape%visit(archive)
      call archive%list("ending", simulation%ending)
      call archive%item("owes_state", simulation%owes_state)
      call archive%item("shows_growth", simulation%shows_growth)
      call archive%item("start_time", simulation%start_time)
      call archive%list("has_slipped", simulation%has_slipped, "fractures")
      call archive%list("has_opened", simulation%has_opened, "fractures")
      call archive%list("position_error", simulation%position_error, "tips ?")
      call archive%leave()
   end subroutine visit_simulation

   !> The summary of the run so far.
   subroutine visit_summary(archive, summary)
      type(archive_t), intent(inout) :: archive
      type(summary_t), intent(inout) :: summary
      integer(lk) :: i, n

      call archive%item("steps", summary%steps)
      call archive%item("cells", summary%cells)
      call archive%item("fracture_cells", summary%fracture_cells)
      call archive%item("mass_error_relative", summary%mass_error_relative)
      call archive%item("keq_over_kic", summary%keq_over_kic)
      call archive%item("lowest_pressure", summary%lowest_pressure)
      call archive%item("extreme_error", summary%extreme_error)
      call archive%item("contact_residual", summary%contact_residual)
      call archive%item("condition_estimate", summary%condition_estimate)
      call archive%item("forward_error_bound", summary%forward_error_bound)
      call archive%item("smallest_angle", summary%smallest_angle)
      call archive%item("energy_error", summary%energy_error)
      call archive%item("newton_total", summary%newton_total)
      call archive%item("newton_max", summary%newton_max)
      call archive%item("step_cuts", summary%step_cuts)
      call archive%item("growth_jumps", summary%growth_jumps)
      call archive%item("longest_jump", summary%longest_jump)
      call archive%item("has_growth", summary%has_growth)
      call archive%item("increments", summary%increments)
      call archive%item("meshes_whole", summary%meshes_whole)
      call archive%item("meshes_patched", summary%meshes_patched)
      call archive%extent("dofs", summary%dofs, n)
      if (archive%is_loading) then
         if (allocated(summary%dofs)) deallocate (summary%dofs)
         if (n >= 0_lk) allocate (summary%dofs(n))
      end if
      do i = 1_lk, n
         call archive%list("name", summary%dofs(i)%name)
         call archive%item("n", summary%dofs(i)%n)
      end do
      call archive%texts("used", summary%used)
      call archive%texts("left_out", summary%left_out)
   end subroutine visit_summary

   !> Warnings of the run so far. Those about the scene are made again: it may differ.
   subroutine visit_warnings(archive, scene, summary)
      type(archive_t), intent(inout) :: archive
      type(scene_t), intent(in) :: scene
      type(summary_t), intent(inout) :: summary
      type(text_t), allocatable :: doubts(:), others(:)
      integer :: i, k

      doubts = doubts_of_scene(scene)
      allocate (others(0))
      if (allocated(summary%warnings) .and. .not. archive%is_loading) then
         do i = 1, size(summary%warnings)
            associate (warning => summary%warnings(i)%text)
               if (any([(doubts(k)%text == warning, k=1, size(doubts))])) cycle
               call add_text(others, warning)
            end associate
         end do
      end if
      call archive%texts("warnings", others)
      if (.not. (archive%is_loading .and. allocated(others))) return
      do i = 1, size(others)
         call summary%warn(others(i)%text)
      end do
   end subroutine visit_warnings

end module report_restart
