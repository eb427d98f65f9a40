!> All files of one run, each of them always complete.
!!
!! Tables, collections, network and log are kept in memory and are written when `tick` decides:
!! every three seconds, or less often so that writing takes less than half a percent of the wall
!! time.
module report_run
   use base_archive, only: archive_t
   use base_buffer, only: newline, text_buffer_t
   use base_errors, only: error_t, keep_first
   use base_kinds, only: lk, rk
   use base_texts, only: add_text, text_t
   use base_timers, only: timers_t
   use report_files, only: place_t, remove_file, reserve_file, write_text_file
   use report_network, only: network_record_t
   use report_record, only: run_record_t, status_failed
   use report_replay, only: record_name
   use report_simulation, only: snapshot_t
   use report_snapshots, only: snapshots_t
   use report_tables, only: tables_t
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   implicit none(type, external)
   private

   public :: run_output_t

   integer, parameter :: record_size = 4096  !< disk space reserved for run.json, a block [byte]
   real(rk), parameter :: pause = 3.0_rk  !< shortest time between two writings of the tables [s]
   !> and its ratio to the duration of the last [-]
   real(rk), parameter :: pause_per_cost = 200.0_rk

   !> The files of a run, from `open` to `close`.
   type :: run_output_t
      type(place_t) :: place
      logical :: keeps_earlier_run = .false.  !< files of an earlier run exist, before `begin`
      type(tables_t) :: tables
      type(snapshots_t), private :: snapshots
      type(network_record_t) :: network
      type(text_buffer_t), private :: log_text
      type(text_buffer_t) :: record  !< decisions (report_replay)
      !> lengths of the log and of the record on disk
      integer(lk), private :: log_written = 0_lk, record_written = 0_lk
      logical, private :: writes_vtu = .true.
      real(rk), private :: interval = 0.0_rk  !< time between written fields [s]
      real(rk), private :: next_fields = 0.0_rk  !< time of the next fields [s]
      integer(lk), private :: clock_begin = 0_lk  !< clock at `open` [ticks]
      real(rk), private :: last_flush = 0.0_rk  !< wall time of the last writing, since `open` [s]
      real(rk), private :: flush_cost = 0.0_rk  !< duration of the last writing [s]
   contains
      procedure :: open => open_run
      procedure :: begin => begin_run
      procedure :: prepare => prepare_tables
      procedure :: continue => continue_run
      procedure :: take_over
      procedure :: visit
      procedure :: visit_text
      procedure :: fields_due
      procedure :: write_fields
      procedure :: log
      procedure :: tick
      procedure :: flush => flush_run
      procedure :: close => close_run
   end type run_output_t

contains

   !> Claim a folder for the run; its contents do not change before `begin`. `refused`: the folder
   !! cannot be used.
   subroutine open_run(self, directory, source, refused, error)
      class(run_output_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: source  !< path of the scene that is run; empty: no file
      logical, intent(out) :: refused
      type(error_t), allocatable, intent(out) :: error

      call system_clock(self%clock_begin)
      call self%place%claim(directory, source, refused, error)
      if (.not. allocated(error)) self%keeps_earlier_run = self%place%has_results()
   end subroutine open_run

   !> Write scene.nml, and then remove the files of an earlier run.
   subroutine begin_run(self, scene, error)
      class(run_output_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      associate (folder => self%place%directory)
         call write_text_file(folder//"/scene.nml", scene_text(scene), error)
         if (allocated(error)) return
         self%keeps_earlier_run = .false.
         call self%place%clear()
         call reserve_file(folder//"/run.json", record_size, error)
         if (allocated(error)) return
         call self%prepare(scene)
         call self%snapshots%clear(0)
         if (scene%output%vtu) call self%snapshots%make_folder(error)
      end associate
   end subroutine begin_run

   !> Open all files, without writing any.
   subroutine prepare_tables(self, scene)
      class(run_output_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene

      associate (folder => self%place%directory)
         self%writes_vtu = scene%output%vtu
         self%interval = scene%output%interval
         call self%tables%open(folder, scene)
         call self%network%open(folder//"/network.json", fracture_names(scene), scene%has_fluid())
         call self%snapshots%open(folder, scene)
      end associate
   end subroutine prepare_tables

   !> Go on with the tables of a scene with other wells or growth.
   subroutine take_over(self, scene)
      class(run_output_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(tables_t) :: before

      call move_alloc(self%tables%all, before%all)
      call self%tables%open(self%place%directory, scene)
      call self%tables%take_over(before)
   end subroutine take_over

   !> Go on with files that were loaded: write scene.nml, take over the VTU files that belong to the
   !! loaded state, and remove later ones.
   subroutine continue_run(self, scene, origin, error)
      class(run_output_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: origin  !< folder of the run that was loaded
      type(error_t), allocatable, intent(out) :: error
      logical :: is_same, was_there

      associate (folder => self%place%directory)
         is_same = self%place%is_place_of(origin)
         if (.not. is_same) call self%place%clear()
         call write_text_file(folder//"/scene.nml", scene_text(scene), error)
         if (allocated(error)) return
         self%keeps_earlier_run = .false.
         call remove_file(folder//"/run.json", was_there)
         call reserve_file(folder//"/run.json", record_size, error)
         if (allocated(error)) return
         if (is_same) then
            call self%snapshots%clear(self%snapshots%n_written)
         else
            call self%snapshots%clear(0)
         end if
         if (scene%output%vtu .or. self%snapshots%n_written > 0) then
            call self%snapshots%make_folder(error)
         end if
         if (.not. (allocated(error) .or. is_same)) call self%snapshots%copy_from(origin, error)
      end associate
   end subroutine continue_run

   !> Store or load the rows and lines so far: their number, and in `visit_text` the texts.
   subroutine visit(self, archive)
      class(run_output_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("files")
      call self%tables%visit(archive)
      call self%snapshots%visit(archive)
      call self%network%visit(archive)
      call self%log_text%visit(archive)
      call self%record%visit(archive)
      if (archive%is_loading) self%log_written = 0_lk
      if (archive%is_loading) self%record_written = 0_lk
      call archive%item("next_fields", self%next_fields)
      call archive%leave()
   end subroutine visit

   subroutine visit_text(self, archive)
      class(run_output_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("texts")
      call self%tables%visit_text(archive)
      call self%snapshots%visit_text(archive)
      call self%network%visit_text(archive)
      call self%log_text%visit_text(archive)
      call self%record%visit_text(archive)
      call archive%leave()
   end subroutine visit_text

   !> Names of the fractures of a scene.
   pure function fracture_names(scene) result(names)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable :: names(:)
      integer :: i

      allocate (names(0))
      if (.not. allocated(scene%fractures)) return
      do i = 1, size(scene%fractures)
         call add_text(names, trim(scene%fractures(i)%name))
      end do
   end function fracture_names

   !> Fields are due: the interval of the scene has passed.
   pure function fields_due(self, time)
      class(run_output_t), intent(in) :: self
      real(rk), intent(in) :: time  !< [s]
      logical :: fields_due

      fields_due = time >= self%next_fields - 1.0e-6_rk*self%interval
   end function fields_due

   !> Write the fields of the state in the last row of history.csv: VTU files, if the scene has
   !! them, and the rows of fractures.csv.
   subroutine write_fields(self, fields, error, with_rows, with_vtu)
      class(run_output_t), intent(inout) :: self
      type(snapshot_t), intent(in) :: fields
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: with_rows, with_vtu  !< .false.: without these
      logical :: has_rows, has_vtu

      has_rows = .true.
      if (present(with_rows)) has_rows = with_rows
      has_vtu = self%writes_vtu
      if (present(with_vtu)) has_vtu = has_vtu .and. with_vtu
      if (has_rows) then
         call self%tables%fracture_rows(fields%time, fields%mesh%fracture, fields%fracture)
      end if
      if (has_vtu) call self%snapshots%write(fields, self%tables%history_rows(), error)
      if (self%interval > 0.0_rk) then
         self%next_fields = self%interval &
                            *(aint(fields%time/self%interval + 1.0e-6_rk) + 1.0_rk)
      end if
   end subroutine write_fields

   !> Add a line to run.log, which begins with the wall time since `open`.
   subroutine log(self, message)
      class(run_output_t), intent(inout) :: self
      character(len=*), intent(in) :: message
      character(len=16) :: stamp

      write (stamp, '(f12.3," s  ")') wall_time(self)
      call self%log_text%append(stamp//message//newline)
   end subroutine log

   !> Write all changed files if the time between two writings has passed.
   subroutine tick(self, error)
      class(run_output_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (wall_time(self) - self%last_flush >= max(pause, pause_per_cost*self%flush_cost)) then
         call self%flush(error)
      end if
   end subroutine tick

   !> Write all changed files, also after a failure of one of them.
   subroutine flush_run(self, error)
      class(run_output_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error  !< the first failure
      type(error_t), allocatable :: trouble
      real(rk) :: begun

      begun = wall_time(self)
      call self%tables%flush(error)
      call self%snapshots%flush(trouble)
      call keep_first(trouble, error)
      call self%network%flush(trouble)
      call keep_first(trouble, error)
      call write_longer(self%log_text, self%place%directory//"/run.log", self%log_written, trouble)
      call keep_first(trouble, error)
      call write_longer(self%record, self%place%directory//"/"//record_name, self%record_written, &
                        trouble)
      call keep_first(trouble, error)
      self%last_flush = wall_time(self)
      self%flush_cost = self%last_flush - begun
   end subroutine flush_run

   !> Write a text if it has become longer.
   subroutine write_longer(text, path, written, error)
      type(text_buffer_t), intent(in) :: text
      character(len=*), intent(in) :: path
      integer(lk), intent(inout) :: written  !< length on disk
      type(error_t), allocatable, intent(out) :: error

      if (text%length == written) return
      call write_text_file(path, text%text(), error)
      if (.not. allocated(error)) written = text%length
   end subroutine write_longer

   !> End the run: write all files, and run.json last, with its status failed if other files could
   !! not be written. A run that has not begun keeps the files of an earlier one.
   subroutine close_run(self, record, timers, error)
      class(run_output_t), intent(inout) :: self
      type(run_record_t), intent(inout) :: record
      type(timers_t), intent(in) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: trouble
      type(text_t), allocatable :: files(:)

      if (.not. self%keeps_earlier_run) then
         call self%flush(error)
         if (.not. allocated(error)) then
            call self%snapshots%list_files(files)
            call add_text(files, "scene.nml")
            call self%place%check(files, error)
         end if
         if (allocated(error) .and. record%status /= status_failed) then
            record%status = status_failed
            record%reason = error%message
         end if
         call record%write(self%place%directory//"/run.json", timers, trouble)
         call keep_first(trouble, error)
      end if
      call self%place%release()
   end subroutine close_run

   !> Wall time since `open` [s].
   function wall_time(self)
      class(run_output_t), intent(in) :: self
      real(rk) :: wall_time
      integer(lk) :: now, rate

      call system_clock(now, rate)
      wall_time = real(now - self%clock_begin, rk)/real(rate, rk)
   end function wall_time

end module report_run
