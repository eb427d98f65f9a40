!> The checkpoints of a run: an accepted state in memory, which is renewed after steps, and when it
!! is written.
!!
!! What is written is the state in memory, also after a signal within a step: a step that is left
!! changes the simulation, but not that state. Where steps are so short that copies would take more
!! than a percent of the time, it is that of an earlier step, and a restart repeats what took a
!! hundred times as long as a copy.
module app_checkpoints
   use app_version, only: version
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text, integer_text
   use report_checkpoint, only: about_t, write_checkpoint
   use report_restart, only: restartable_t
   use report_run, only: run_output_t
   use report_simulation, only: simulation_t
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   implicit none(type, external)
   private

   public :: checkpoints_t

   !> Least ratio of the wall time between two checkpoints, or two copies in memory, to the duration
   !! of the last one; but not of those that the scene counts, after a signal and at the end.
   real(rk), parameter :: pause_per_cost = 100.0_rk

   type :: checkpoints_t
      logical :: is_on = .false.
      type(archive_t) :: state  !< the last accepted state
      type(about_t) :: about
      logical :: is_due = .false.  !< there is a state, and it has not been written
      integer(ik) :: states = 0  !< number of states since the last checkpoint
      integer(ik) :: most_states = 0  !< and after how many there is another; 0: by wall time
      real(rk) :: interval = 0.0_rk  !< wall time between checkpoints [s]
      real(rk) :: last = 0.0_rk, cost = 0.0_rk  !< end and duration of the last checkpoint [s]
      real(rk) :: last_copy = 0.0_rk, copy_cost = 0.0_rk  !< the same of the state in memory [s]
      real(rk) :: spent = 0.0_rk  !< CPU time of all states kept and checkpoints written [s]
      integer(ik) :: n_written = 0
   contains
      procedure :: begin
      procedure :: count_state
      procedure :: note
      procedure :: write => write_files
      procedure :: summary
   end type checkpoints_t

contains

   subroutine begin(self, scene, simulation)
      class(checkpoints_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      class(simulation_t), intent(in) :: simulation

      self%is_on = .false.
      select type (simulation)
      class is (restartable_t)
         self%is_on = scene%output%checkpoint > 0.0_rk .or. scene%output%checkpoint_states > 0
      end select
      self%interval = scene%output%checkpoint
      self%most_states = scene%output%checkpoint_states
      self%about%version = version
      self%about%scene = scene_text(scene)
      self%last = wall_time()
   end subroutine begin

   !> Another state has been accepted: whether it is to be stored in `state`, and to be written.
   subroutine count_state(self, simulation, keeps, writes)
      class(checkpoints_t), intent(inout) :: self
      class(restartable_t), intent(in) :: simulation
      logical, intent(out) :: keeps, writes
      real(rk) :: now, since

      self%states = self%states + 1
      now = wall_time()
      since = now - self%last
      writes = self%interval > 0.0_rk .and. &
               (since >= self%interval .or. simulation%begins_stage) &
               .and. since >= pause_per_cost*self%cost
      if (self%most_states > 0) writes = writes .or. self%states >= self%most_states
      keeps = writes .or. simulation%is_over() .or. &
              now - self%last_copy >= pause_per_cost*self%copy_cost
      if (keeps) self%last_copy = now
   end subroutine count_state

   !> The state has been stored.
   subroutine note(self, simulation)
      class(checkpoints_t), intent(inout) :: self
      class(restartable_t), intent(in) :: simulation

      self%about%time = simulation%time()
      self%about%state = simulation%last_state()
      self%is_due = .true.
      self%copy_cost = wall_time() - self%last_copy
      self%last_copy = self%last_copy + self%copy_cost
   end subroutine note

   !> Write the last state, unless it has been written. A failure is a line of the log.
   subroutine write_files(self, files)
      class(checkpoints_t), intent(inout) :: self
      type(run_output_t), intent(inout) :: files
      type(archive_t) :: head
      type(error_t), allocatable :: error
      real(rk) :: begun

      if (.not. self%is_due) return
      begun = wall_time()
      call head%begin_storing()
      call self%about%visit(head)
      call files%visit_text(head)
      call write_checkpoint(files%place%directory, head, self%state, error)
      if (allocated(error)) then
         call files%log("no checkpoint: "//error%message)
      else
         self%n_written = self%n_written + 1
      end if
      self%is_due = .false.
      self%states = 0
      self%last = wall_time()
      self%cost = self%last - begun
   end subroutine write_files

   !> Number, size and cost of the checkpoints in words.
   function summary(self, cpu) result(words)
      class(checkpoints_t), intent(in) :: self
      real(rk), intent(in) :: cpu  !< CPU time of the run [s]
      character(len=:), allocatable :: words

      words = integer_text(self%n_written)//" checkpoints, the last one of "// &
              brief_text(1.0e-6_rk*real(self%state%length, rk), 3)//" MB without tables; with "// &
              "the states kept in memory "//brief_text(self%spent, 3)//" s CPU time, "// &
              brief_text(100.0_rk*self%spent/max(cpu, tiny(cpu)), 3)//" % of the run"
   end function summary

   !> Wall time since any fixed time [s].
   real(rk) function wall_time()
      integer(lk) :: now, rate

      call system_clock(now, rate)
      wall_time = real(now, rk)/real(rate, rk)
   end function wall_time

end module app_checkpoints
