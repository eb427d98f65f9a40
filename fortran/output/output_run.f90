!> All files of one run (docs: the contract's "Files of a run"), each of them always whole.
!!
!! Tables, collections, network and log gather in memory and are written when `tick` finds it time:
!! every three seconds, and so seldom that writing takes less than half a percent of the wall time.
module output_run
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_timers, only: timers_t
   use mesh_types, only: mesh_t, network_t
   use results_fields, only: fracture_fields_t, intersection_fields_t, matrix_fields_t
   use results_rows, only: history_row_t, probe_row_t, tip_row_t
   use output_files, only: make_directory, remove_file, rename_file
   use output_network, only: network_record_t
   use output_record, only: run_record_t
   use output_snapshots, only: snapshots_t
   use output_tables, only: tables_t
   use base_texts, only: add_text, text_t
   use output_text, only: newline, text_buffer_t
   use scene_types, only: scene_t
   use scene_write, only: write_scene
   implicit none(type, external)
   private

   public :: run_output_t

   real(rk), parameter :: pause = 3.0_rk  !< between two writings of the tables [s]
   real(rk), parameter :: pause_per_cost = 200.0_rk  !< or times the last one's duration

   character(len=*), parameter :: top_files(9) = [character(len=13) :: "run.json", "scene.nml", &
      & "history.csv", "tips.csv", "fractures.csv", "probes.csv", "network.json", "events.csv", &
      & "run.log"]

   !> The files of a run, from `open` to `close`.
   type :: run_output_t
      character(len=:), allocatable :: directory
      type(tables_t), private :: tables
      type(snapshots_t), private :: snapshots
      type(network_record_t), private :: network
      type(text_buffer_t), private :: log_text
      integer, private :: log_written = 0  !< characters of the log on disk
      logical, private :: writes_vtu = .true.
      real(rk), private :: interval = 0.0_rk  !< between written fields [s]
      real(rk), private :: next_fields = 0.0_rk  !< when fields are due [s]
      integer(lk), private :: clock_begin = 0_lk  !< ticks
      real(rk), private :: last_flush = 0.0_rk  !< wall time since open [s]
      real(rk), private :: flush_cost = 0.0_rk  !< wall time of the last writing [s]
   contains
      procedure :: open => open_run
      procedure :: history_row
      procedure :: tip_row
      procedure :: probe_row
      procedure :: event_row
      procedure :: network_step
      procedure :: fields_due
      procedure :: write_fields
      procedure :: log
      procedure :: tick
      procedure :: flush => flush_run
      procedure :: close => close_run
   end type run_output_t

contains

   !> Make the directory, remove an earlier run's files from it, and write scene.nml.
   subroutine open_run(self, directory, scene, error)
      class(run_output_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      character(len=:), allocatable :: scene_path
      type(text_t), allocatable :: names(:)
      logical :: was_there
      integer :: i

      self%directory = trim(directory)
      self%writes_vtu = scene%output%vtu
      self%interval = scene%output%interval
      call system_clock(self%clock_begin)

      call make_directory(self%directory, error)
      if (allocated(error)) return
      do i = 1, size(top_files)
         call remove_file(self%directory//"/"//trim(top_files(i)), was_there)
         call remove_file(self%directory//"/"//trim(top_files(i))//".part", was_there)
      end do
      call self%snapshots%open(self%directory, scene, error)
      if (allocated(error)) return
      scene_path = self%directory//"/scene.nml"
      call write_scene(scene_path//".part", scene, error)
      if (allocated(error)) then
         call remove_file(scene_path//".part", was_there)
         return
      end if
      call rename_file(scene_path//".part", scene_path, error)
      if (allocated(error)) return

      call self%tables%open(self%directory, scene)
      allocate (names(0))
      if (allocated(scene%fractures)) then
         do i = 1, size(scene%fractures)
            call add_text(names, trim(scene%fractures(i)%name))
         end do
      end if
      call self%network%open(self%directory//"/network.json", names, scene%has_fluid())
   end subroutine open_run

   !> Add an accepted step to history.csv.
   subroutine history_row(self, row)
      class(run_output_t), intent(inout) :: self
      type(history_row_t), intent(in) :: row

      call self%tables%history_row(row)
   end subroutine history_row

   !> Add a tip to tips.csv.
   subroutine tip_row(self, row)
      class(run_output_t), intent(inout) :: self
      type(tip_row_t), intent(in) :: row

      call self%tables%tip_row(row)
   end subroutine tip_row

   !> Add the state at all probes to probes.csv.
   subroutine probe_row(self, time, row)
      class(run_output_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s], or the load factor
      type(probe_row_t), intent(in) :: row

      call self%tables%probe_row(time, row)
   end subroutine probe_row

   !> Add an event to events.csv.
   subroutine event_row(self, time, kind, detail, fracture, xy)
      class(run_output_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: kind  !< event_slip_onset .. event_remesh of results_chronicle
      character(len=*), intent(in) :: detail  !< a few words with numbers and units
      integer(ik), intent(in), optional :: fracture
      real(rk), intent(in), optional :: xy(2)  !< [m]

      call self%tables%event_row(time, kind, detail, fracture, xy)
   end subroutine event_row

   !> Note the network for network.json; nothing happens if it has not changed.
   subroutine network_step(self, time, network, mesh)
      class(run_output_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(network_t), intent(in) :: network
      type(mesh_t), intent(in) :: mesh

      call self%network%step(time, network, mesh%fracture)
   end subroutine network_step

   !> It is time to write fields: the scene's interval, or its regular step, has passed.
   pure function fields_due(self, time)
      class(run_output_t), intent(in) :: self
      real(rk), intent(in) :: time  !< [s]
      logical :: fields_due

      fields_due = time >= self%next_fields - 1.0e-6_rk*self%interval
   end function fields_due

   !> Write the fields at a time: VTU files where the scene wants them, and the rows of
   !! fractures.csv.
   subroutine write_fields(self, time, mesh, matrix, fracture, intersections, error)
      class(run_output_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(mesh_t), intent(in) :: mesh
      type(matrix_fields_t), intent(in) :: matrix
      type(fracture_fields_t), intent(in) :: fracture
      type(intersection_fields_t), intent(in) :: intersections  !< may be empty
      type(error_t), allocatable, intent(out) :: error

      call self%tables%fracture_rows(time, mesh%fracture, fracture)
      if (self%writes_vtu) then
         call self%snapshots%write(time, mesh, matrix, fracture, intersections, error)
      end if
      if (self%interval > 0.0_rk) then
         self%next_fields = self%interval*(aint(time/self%interval + 1.0e-6_rk) + 1.0_rk)
      end if
   end subroutine write_fields

   !> Add a line to run.log, with the wall time since `open` before it.
   subroutine log(self, message)
      class(run_output_t), intent(inout) :: self
      character(len=*), intent(in) :: message
      character(len=16) :: stamp

      write (stamp, '(f12.3," s  ")') wall_time(self)
      call self%log_text%append(stamp//message//newline)
   end subroutine log

   !> To be called often: write what has gathered, if it is time.
   subroutine tick(self, error)
      class(run_output_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (wall_time(self) - self%last_flush >= max(pause, pause_per_cost*self%flush_cost)) then
         call self%flush(error)
      end if
   end subroutine tick

   !> Write now what has gathered.
   subroutine flush_run(self, error)
      class(run_output_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: begun

      begun = wall_time(self)
      call self%tables%flush(error)
      if (.not. allocated(error)) call self%snapshots%flush(error)
      if (.not. allocated(error)) call self%network%flush(error)
      if (.not. allocated(error) .and. self%log_text%length > self%log_written) then
         call self%log_text%write_file(self%directory//"/run.log", error)
         if (.not. allocated(error)) self%log_written = self%log_text%length
      end if
      self%last_flush = wall_time(self)
      self%flush_cost = self%last_flush - begun
   end subroutine flush_run

   !> End the run, well or not: write everything, and run.json last, even if other files failed.
   subroutine close_run(self, record, timers, error)
      class(run_output_t), intent(inout) :: self
      type(run_record_t), intent(in) :: record
      type(timers_t), intent(in) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: trouble

      call self%flush(error)
      call record%write(self%directory//"/run.json", timers, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
   end subroutine close_run

   !> Wall time since `open` [s].
   function wall_time(self)
      class(run_output_t), intent(in) :: self
      real(rk) :: wall_time
      integer(lk) :: now, rate

      call system_clock(now, rate)
      wall_time = real(now - self%clock_begin, rk)/real(rate, rk)
   end function wall_time

end module output_run
