!> Runs a scene from start to end, with output to its files and to the terminal, with or without a
!! fluid.
module app_run
   use, intrinsic :: iso_fortran_env, only: int8, output_unit
   use app_changes, only: check_changes
   use app_checkpoints, only: checkpoints_t
   use app_interrupts, only: interrupted
   use app_simulations, only: allocate_simulation
   use app_version, only: version
   use app_warnings, only: show_warnings
   use base_archive, only: archive_t
   use base_errors, only: error_t, keep_first, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_texts, only: text_t
   use base_timers, only: listener_t, phase_output, timers_t
   use growth_network, only: total_length
   use mesh_types, only: mesh_t, network_t
   use report_checkpoint, only: about_t, read_checkpoint
   use report_progress, only: progress_t, progress_values_t
   use report_record, only: closing_lines, run_record_t, status_failed, status_finished, &
                            status_stopped
   use report_replay, only: first_part, part_of, read_record
   use report_restart, only: restartable_t
   use report_rows, only: history_row_t, probe_row_t
   use report_run, only: run_output_t
   use report_simulation, only: simulation_t, snapshot_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: run_scene

   !> Files and progress line of a run.
   type :: journal_t
      type(run_output_t) :: files
      type(progress_t) :: progress
      logical :: has_state = .false.  !< `shown` is that of a state of this process
      logical :: owes_rows = .false.  !< fractures.csv lacks the last accepted state
      logical :: owes_vtu = .false.  !< VTU files of the last accepted state are not written
      integer(ik) :: n_growth = 0  !< number of states of growth with VTU files
      type(progress_values_t) :: shown  !< values of the last accepted state
      type(checkpoints_t) :: checkpoints
   contains
      procedure :: write_state
      procedure :: show_work
      procedure :: write_chronicle
      procedure :: write_fields
      procedure :: visit
   end type journal_t

   !> Listener of long computations, which shows progress and ends them after a signal.
   type, extends(listener_t) :: follower_t
      type(journal_t), pointer :: journal => null()
   contains
      procedure :: hear
   end type follower_t

contains

   !> Show progress, or end the computation if a signal has been received.
   subroutine hear(self, ends)
      class(follower_t), intent(inout) :: self
      logical, intent(out) :: ends

      ends = interrupted()
      if (.not. ends) call self%journal%show_work()
   end subroutine hear

   !> Run a scene to its end. `refused`: the directory cannot be used, and nothing was written. With
   !! `origin` the run goes on from the checkpoint in that directory.
   subroutine run_scene(scene, source, directory, quiet, simulation, refused, was_interrupted, &
                        error, origin)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: source  !< path of the scene's file; empty: no file
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      class(simulation_t), allocatable, intent(out) :: simulation  !< state at the end
      logical, intent(out) :: refused, was_interrupted
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in), optional :: origin
      type(scene_t) :: own  ! with the first step of a run that is continued
      type(journal_t), target :: journal
      type(follower_t), target :: follower
      type(run_record_t) :: record
      type(timers_t) :: timers
      type(error_t), allocatable :: trouble
      integer(int8), allocatable :: decisions(:)
      logical :: is_meshed

      was_interrupted = .false.
      own = scene
      call allocate_simulation(scene, simulation)
      call timers%begin()
      if (len_trim(scene%time%replay) > 0) then
         call read_record(trim(scene%time%replay), version, decisions, error)
         refused = allocated(error)
         if (refused) return
         call simulation%tape%follow(decisions)
      end if
      call journal%files%open(directory, source, refused, error)
      if (allocated(error)) return
      if (present(origin)) then
         call restart(simulation, journal, own, origin, timers, refused, error)
         is_meshed = .not. allocated(error)
      else
         call simulation%begin(scene, timers, error)
         is_meshed = .not. allocated(error)
         if (is_meshed .or. .not. journal%files%keeps_earlier_run) then
            call timers%start(phase_output)
            call journal%files%begin(scene, trouble)
            call timers%stop(phase_output)
            call keep_first(trouble, error)
         end if
      end if
      if (refused) then
         call journal%files%place%release()
         return
      end if
      if (.not. allocated(error)) then
         call journal%progress%begin(quiet)
         if (.not. present(origin)) call write_network(journal, simulation)
         call journal%checkpoints%begin(own, simulation)
         follower%journal => journal
         timers%listener => follower
         call march(simulation, journal, timers, error)
         call write_last_state(simulation, journal, timers, trouble)
         call keep_first(trouble, error)
         call timers%start(phase_output)
         call journal%checkpoints%write(journal%files)
         if (journal%checkpoints%is_on) then
            call journal%files%log(journal%checkpoints%summary(timers%cpu_seconds()))
         end if
         call timers%stop(phase_output)
      end if

      was_interrupted = .not. (allocated(error) .or. allocated(simulation%ending))
      call simulation%tell_limits()
      record%scene = trim(scene%name)
      record%version = version
      call set_end(record, simulation, was_interrupted, error)
      call journal%files%log(record%status//": "//record%reason//origin_text(error))
      call journal%files%close(record, timers, trouble)
      call keep_first(trouble, error)
      if (quiet) return
      call show_warnings(record%warnings, output_unit)
      if (is_meshed) call print_closing(simulation, record, timers%wall_seconds(), directory)
   end subroutine run_scene

   !> Set the summary, the status and the reason of the end of a run.
   subroutine set_end(record, simulation, was_interrupted, error)
      type(run_record_t), intent(inout) :: record
      class(simulation_t), intent(in) :: simulation
      logical, intent(in) :: was_interrupted
      type(error_t), allocatable, intent(in) :: error  !< allocated: the run has failed

      record%summary_t = simulation%summary
      if (allocated(error)) then
         record%status = status_failed
         record%reason = error%message
      else if (was_interrupted) then
         record%status = status_stopped
         record%reason = "interrupted"
      else
         record%status = status_finished
         record%reason = simulation%ending
      end if
   end subroutine set_end

   !> Write all files up to the last accepted state except run.json, which has the status of this
   !! too.
   subroutine write_last_state(simulation, journal, timers, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: trouble

      call journal%progress%clear()
      call timers%start(phase_output)
      call simulation%end_slip()
      call journal%write_chronicle(simulation)
      call journal%write_fields(simulation, error)
      call journal%files%flush(trouble)
      call keep_first(trouble, error)
      call timers%stop(phase_output)
   end subroutine write_last_state

   !> Origin of an error, for the log.
   pure function origin_text(error) result(text)
      type(error_t), allocatable, intent(in) :: error
      character(len=:), allocatable :: text

      text = ""
      if (.not. allocated(error)) return
      if (len(error%origin) > 0) text = " (in "//error%origin//")"
   end function origin_text

   !> Print the closing lines of a run.
   subroutine print_closing(simulation, record, seconds, directory)
      class(simulation_t), intent(in) :: simulation
      type(run_record_t), intent(in) :: record
      real(rk), intent(in) :: seconds  !< wall time of the run [s]
      character(len=*), intent(in) :: directory
      type(text_t), allocatable :: lines(:)
      real(rk) :: length
      integer :: i

      length = total_length(simulation%network)
      lines = closing_lines(record, simulation%last_state(), length, &
                            length - total_length(simulation%start), seconds, directory)
      do i = 1, size(lines)
         write (output_unit, "(a)") lines(i)%text
      end do
   end subroutine print_closing

   !> Proceed from state to state until the end of the scene, a failure or an interruption.
   subroutine march(simulation, journal, timers, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      do
         if (interrupted() .or. simulation%is_over()) return
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) then
            call timers%start(phase_output)
            call journal%write_state(simulation, error)
            call timers%stop(phase_output)
            if (allocated(error)) return
            call simulation%grow(timers, error)
         end if
         if (.not. allocated(error)) call keep_decisions(simulation, journal)
         if (allocated(error)) then
            if (error%is_interruption) then
               deallocate (error)
               return
            end if
            error%message = "after "//simulation%last_state()//": "//error%message
            return
         end if
         call timers%start(phase_output)
         call journal%write_chronicle(simulation)
         call keep_state(simulation, journal, timers, error)
         call timers%stop(phase_output)
         if (allocated(error)) return
      end do
   end subroutine march

   !> Add the decisions up to the accepted state to the record.
   subroutine keep_decisions(simulation, journal)
      class(simulation_t), intent(in) :: simulation
      type(journal_t), intent(inout) :: journal

      if (.not. simulation%tape%is_recording) return
      if (journal%files%record%length == 0) call journal%files%record%append(first_part(version))
      call journal%files%record%append(part_of(simulation%tape%bytes()))
   end subroutine keep_decisions

   !> Keep the accepted state in memory, and write a checkpoint if it is due.
   subroutine keep_state(simulation, journal, timers, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: begun  ! [s]
      logical :: keeps, writes

      if (.not. journal%checkpoints%is_on) return
      select type (simulation)
      class is (restartable_t)
         associate (checkpoints => journal%checkpoints)
            begun = timers%cpu_seconds()
            call checkpoints%count_state(simulation, keeps, writes)
            if (.not. keeps) return
            call checkpoints%state%begin_storing()
            call journal%visit(checkpoints%state)
            call simulation%visit(checkpoints%state, timers, error)
            if (allocated(error)) return
            call checkpoints%note(simulation)
            if (writes) call checkpoints%write(journal%files)
            checkpoints%spent = checkpoints%spent + timers%cpu_seconds() - begun
         end associate
      end select
   end subroutine keep_state

   !> Load the checkpoint of a run and take over its files. `refused`: nothing was written.
   subroutine restart(simulation, journal, scene, origin, timers, refused, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(scene_t), intent(inout) :: scene
      character(len=*), intent(in) :: origin
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: refused
      type(error_t), allocatable, intent(out) :: error
      type(archive_t) :: archive
      type(about_t) :: about
      type(scene_t) :: stored  ! with the wells and growth of the checkpoint
      character(len=:), allocatable :: remark, switched

      refused = .true.
      call read_checkpoint(origin, version, about, archive, remark, error)
      if (allocated(error)) return
      call check_changes(about%scene, journal%files%place%directory, about%time, scene, stored, &
                         switched, error)
      if (allocated(error)) return
      call journal%files%prepare(stored)
      call journal%files%visit_text(archive)
      call journal%visit(archive)
      select type (simulation)
      class is (restartable_t)
         call simulation%prepare(stored)
         call simulation%visit(archive, timers, error)
         if (allocated(error)) return
         if (.not. allocated(archive%fault) .and. archive%place /= archive%length) then
            archive%fault = "more than this program knows"
         end if
         if (allocated(archive%fault)) then
            call raise_error(error, "", "the checkpoint in "//origin//" has "//archive%fault// &
                             ": it was written by another program")
            return
         end if
         if (len(switched) > 0) then
            call journal%files%take_over(scene)
            call simulation%take_over(scene, error)
            if (allocated(error)) return
         end if
      end select
      refused = .false.
      call timers%start(phase_output)
      call journal%files%continue(scene, origin, error)
      call timers%stop(phase_output)
      if (len(remark) > 0) call journal%files%log("warning: "//remark)
      call journal%files%log("restart from the state at "//about%state//switched)
   end subroutine restart

   !> Store or load what decides about the next files.
   subroutine visit(self, archive)
      class(journal_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call self%files%visit(archive)
      call archive%enter("journal")
      call archive%item("owes_rows", self%owes_rows)
      call archive%item("owes_vtu", self%owes_vtu)
      call archive%item("n_growth", self%n_growth)
      call archive%leave()
   end subroutine visit

   !> Add the present network to network.json.
   subroutine write_network(self, simulation)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(in) :: simulation
      type(network_t) :: network
      type(mesh_t) :: mesh

      call simulation%present_network(network, mesh)
      call self%files%network%step(simulation%time(), network, mesh%fracture)
   end subroutine write_network

   !> Write an accepted state: history, probes, fields if they are due, the progress line.
   subroutine write_state(self, simulation, error)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(inout) :: simulation
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      type(probe_row_t) :: probes
      character(len=:), allocatable :: log_line

      self%owes_rows = .true.
      self%owes_vtu = .true.
      row = simulation%history()
      if (size(simulation%scene%probes) > 0) then
         call simulation%probes(probes, error)
         if (allocated(error)) return
         call self%files%tables%probe_row(row%time, probes)
      end if
      call self%files%tables%history_row(row)
      call write_due_fields(self, simulation, row%time, error)
      if (allocated(error)) return
      call self%files%tick(error)
      self%shown = progress_values_t(share=simulation%share_done(), time=row%time, &
                                     step=simulation%summary%steps, n_stick=row%n_stick, &
                                     n_slip=row%n_slip, n_open=row%n_open, &
                                     fracture_length=row%fracture_length, &
                                     well_pressure=row%well_pressure, &
                                     keq_over_kic=simulation%keq_over_kic(), &
                                     is_load=.not. simulation%scene%has_fluid())
      self%has_state = .true.
      call self%progress%show(self%shown, log_line)
      if (allocated(log_line)) call self%files%log(log_line)
   end subroutine write_state

   !> Update the progress line during the search for the next state.
   subroutine show_work(self)
      class(journal_t), intent(inout) :: self
      character(len=:), allocatable :: log_line

      if (.not. self%has_state) return
      self%shown%solutions = self%shown%solutions + 1
      call self%progress%show(self%shown, log_line)
      if (allocated(log_line)) call self%files%log(log_line)
   end subroutine show_work

   !> Write the event log to the tables and to run.log, and empty it.
   subroutine write_chronicle(self, simulation)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(inout) :: simulation
      integer(ik) :: i

      associate (chronicle => simulation%chronicle)
         do i = 1, size(chronicle%events, kind=ik)
            call self%files%tables%event_row(chronicle%events(i))
         end do
         do i = 1, size(chronicle%tips, kind=ik)
            call self%files%tables%tip_row(chronicle%tips(i))
         end do
         do i = 1, size(chronicle%wells, kind=ik)
            call self%files%tables%well_row(chronicle%wells(i))
         end do
         do i = 1, size(chronicle%entries, kind=ik)
            call self%files%tables%entry_row(chronicle%entries(i))
         end do
         do i = 1, size(chronicle%slip_events, kind=ik)
            call self%files%tables%slip_event_row(chronicle%slip_events(i))
         end do
         do i = 1, size(chronicle%remarks, kind=ik)
            call self%files%log(chronicle%remarks(i)%text)
         end do
         if (chronicle%has_new_network) call write_network(self, simulation)
         call chronicle%clear()
      end associate
   end subroutine write_chronicle

   !> Write fields if they are due: at the end of an interval, or without a fluid of a load step;
   !! and at every increment of growth, with VTU files for at most growth_states of them.
   subroutine write_due_fields(self, simulation, time, error)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(inout) :: simulation
      real(rk), intent(in) :: time  !< of the state [s], or its load factor
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: words
      logical :: is_due

      is_due = .not. simulation%shows_growth
      if (simulation%scene%has_fluid()) is_due = self%files%fields_due(time)
      if (is_due) then
         call self%write_fields(simulation, error)
      else if (simulation%shows_growth) then
         associate (limit => simulation%scene%output%growth_states)
            if (self%n_growth == limit .and. limit > 0 .and. simulation%scene%output%vtu) then
               words = "growth_states = "//integer_text(limit)//" of &output is reached: VTU "// &
                       "files of further increments of growth are omitted"
               call self%files%log(words)
               call simulation%summary%warn(words)
            end if
            call self%write_fields(simulation, error, with_vtu=self%n_growth < limit)
         end associate
         self%n_growth = self%n_growth + 1
      end if
   end subroutine write_due_fields

   !> Write the fields of the last accepted state, unless they have been written.
   subroutine write_fields(self, simulation, error, with_vtu)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: with_vtu  !< .false.: only the rows of fractures.csv
      type(snapshot_t), allocatable :: fields
      logical :: has_vtu

      has_vtu = .true.
      if (present(with_vtu)) has_vtu = with_vtu
      if (.not. (self%owes_rows .or. (self%owes_vtu .and. has_vtu))) return
      call simulation%snapshot(fields)
      if (.not. allocated(fields)) return
      call self%files%write_fields(fields, error, self%owes_rows, has_vtu)
      self%owes_rows = .false.
      if (has_vtu) self%owes_vtu = .false.
   end subroutine write_fields

end module app_run
