!> run.json: the scene, the end and the cost of a run, with the keys of report_keys; and the last
!! lines on the terminal.
module report_record
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_number, only: brief_text, integer_text
   use base_texts, only: add_text, text_t
   use base_timers, only: phase_count, phase_names, timers_t
   use report_files, only: write_text_file
   use report_json, only: json_t
   use report_progress, only: duration_text
   use report_rows, only: dof_block_t, summary_t
   implicit none(type, external)
   private

   public :: closing_lines, peak_memory_mb, run_record_t, status_failed, status_finished
   public :: status_stopped

   character(len=*), parameter :: status_finished = "finished"  !< the end of the scene was reached
   character(len=*), parameter :: status_stopped = "stopped"  !< interrupted from outside
   character(len=*), parameter :: status_failed = "failed"  !< the run could not continue

   !> The contents of run.json without the timers. Components without default must be set.
   type, extends(summary_t) :: run_record_t
      character(len=:), allocatable :: scene  !< name of the scene
      character(len=:), allocatable :: version  !< version of the program
      character(len=:), allocatable :: status  !< status_finished, status_stopped or status_failed
      character(len=:), allocatable :: reason  !< reason of the end
   contains
      procedure :: write => write_record
   end type run_record_t

contains

   !> Write run.json.
   subroutine write_record(self, path, timers, error)
      class(run_record_t), intent(in) :: self
      character(len=*), intent(in) :: path
      type(timers_t), intent(in) :: timers
      type(error_t), allocatable, intent(out) :: error

      type(json_t) :: json

      call json%begin_object("")
      call json%add("scene", self%scene)
      call json%add("version", self%version)
      call json%add("status", self%status)
      call json%add("reason", self%reason)
      call json%add("steps", self%steps)
      call json%add("cells", self%cells)
      call json%add("fracture_cells", self%fracture_cells)
      call add_dofs(json, self%dofs)
      call json%add("used", self%used)
      call json%add("left_out", self%left_out)
      call add_timers(json, timers)
      call json%add("cpu_s", timers%cpu_seconds())
      call json%add("wall_s", timers%wall_seconds())
      call json%add("peak_memory_mb", peak_memory_mb())
      call json%add("mass_error_relative", self%mass_error_relative)
      call json%add("contact_residual", self%contact_residual)
      if (self%keq_over_kic > 0.0_rk) then
         call json%add("keq_over_kic", self%keq_over_kic)
         call json%add("keq_over_kic_error", self%extreme_error(1))
      end if
      if (self%lowest_pressure < huge(1.0_rk)) then
         call json%add("lowest_pressure_pa", self%lowest_pressure)
         call json%add("lowest_pressure_error_pa", self%extreme_error(2))
      end if
      if (self%condition_estimate > 0.0_rk) then
         call json%add("condition_estimate", self%condition_estimate)
         call json%add("forward_error_bound", self%forward_error_bound)
      end if
      if (self%smallest_angle > 0.0_rk) then
         call json%add("smallest_angle_deg", self%smallest_angle*180.0_rk/pi)
      end if
      if (self%energy_error > 0.0_rk) then
         call json%add("energy_error_relative", self%energy_error)
      end if
      if (self%heat%error >= 0.0_rk) then
         call json%add("heat_error_relative", self%heat%error)
         call json%add("heat_beyond_range_k", self%heat%beyond_range)
      end if
      call json%begin_object("newton_iterations")
      call json%add("total", self%newton_total)
      call json%add("max", self%newton_max)
      call json%end_object()
      call json%add("step_cuts", self%step_cuts)
      if (self%has_growth) then
         call json%add("increments", self%increments)
         call json%begin_object("meshes")
         call json%add("whole", self%meshes_whole)
         call json%add("patched", self%meshes_patched)
         call json%end_object()
      end if
      if (self%growth_jumps >= 0) then
         call json%add("growth_jumps", self%growth_jumps)
         call json%add("longest_growth_jump_m", self%longest_jump)
      end if
      call json%add("warnings", self%warnings)
      call json%end_object()
      call write_text_file(path, json%text(), error)
   end subroutine write_record

   !> Unknowns by kind.
   subroutine add_dofs(json, dofs)
      type(json_t), intent(inout) :: json
      type(dof_block_t), allocatable, intent(in) :: dofs(:)
      integer :: i

      call json%begin_object("dofs")
      if (allocated(dofs)) then
         do i = 1, size(dofs)
            call json%add(dofs(i)%name, dofs(i)%n)
         end do
      end if
      call json%end_object()
   end subroutine add_dofs

   !> Processor time by phase.
   subroutine add_timers(json, timers)
      type(json_t), intent(inout) :: json
      type(timers_t), intent(in) :: timers
      integer :: i

      call json%begin_object("timers_s")
      do i = 1, phase_count
         call json%add(trim(phase_names(i)), timers%seconds(i))
      end do
      call json%end_object()
   end subroutine add_timers

   !> Peak memory of the process so far [MB of 2**20 bytes]; NaN if it is not known.
   function peak_memory_mb() result(megabytes)
      use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
      real(rk) :: megabytes
      character(len=128) :: line
      integer :: unit, status
      real(rk) :: kilobytes

      megabytes = ieee_value(megabytes, ieee_quiet_nan)
      open (newunit=unit, file="/proc/self/status", action="read", status="old", iostat=status)
      if (status /= 0) return
      do
         read (unit, "(a)", iostat=status) line
         if (status /= 0) exit
         if (line(1:6) == "VmHWM:") then
            read (line(7:), *, iostat=status) kilobytes
            if (status == 0) megabytes = kilobytes/1024.0_rk
            exit
         end if
      end do
      close (unit)
   end function peak_memory_mb

   !> The last lines on the terminal without warnings (app_warnings).
   function closing_lines(record, last_state, length, gain, seconds, directory) result(lines)
      type(run_record_t), intent(in) :: record
      character(len=*), intent(in) :: last_state  !< a time or load factor in words
      real(rk), intent(in) :: length  !< of all fractures at the end [m]
      real(rk), intent(in) :: gain  !< growth in the run [m]
      real(rk), intent(in) :: seconds  !< wall time of the run [s]
      character(len=*), intent(in) :: directory  !< directory of the results
      type(text_t), allocatable :: lines(:)
      character(len=:), allocatable :: line

      call add_text(lines, record%status//": "//record%reason)
      line = "reached "//last_state//" in "//counted(record%steps, "step")
      if (record%has_growth) line = line//" and "//counted(record%increments, "increment")// &
                                    " of growth"
      call add_text(lines, line//", "//duration_text(seconds))
      if (length > 0.0_rk) then
         line = "fractures are "//brief_text(length, 4)//" m long"
         if (gain > 0.0_rk) line = line//", of which "//brief_text(gain, 4)//" m have grown"
         if (.not. gain > 0.0_rk) line = line//"; nothing has grown"
         call add_text(lines, line)
      end if
      if (record%growth_jumps > 0) then
         call add_text(lines, "grows by "//counted(record%growth_jumps, "jump")//" of up to "// &
                       brief_text(record%longest_jump, 3)//" m")
      end if
      if (record%keq_over_kic > 0.0_rk) then
         call add_text(lines, "largest K_eq/K_IC "//brief_text(record%keq_over_kic, 4))
      end if
      call add_text(lines, "results in "//directory)
   end function closing_lines

   !> A number with its noun in singular or plural.
   pure function counted(n, thing) result(words)
      integer(ik), intent(in) :: n
      character(len=*), intent(in) :: thing  !< noun in singular
      character(len=:), allocatable :: words

      words = integer_text(n)//" "//thing
      if (n /= 1) words = words//"s"
   end function counted

end module report_record
