!> What a running scene tells its files whichever way it is simulated: history, events, tips and
!! their growth.
module app_journal
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use contact_states, only: state_open, state_slip
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t
   use results_rows, only: history_row_t, tip_row_t
   use output_progress, only: progress_t, progress_values_t
   use output_record, only: run_record_t
   use output_run, only: run_output_t
   use output_tables, only: event_arrest, event_growth, event_joint, event_opening, event_remesh, &
                            event_slip_onset
   use scene_types, only: scene_t
   use tips_growth, only: growth_drive_t
   use tips_state, only: tip_state_t
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: journal_t

   !> Files, record and progress line of a run, and what has been told once and for all.
   type :: journal_t
      type(run_output_t) :: files
      type(run_record_t) :: record
      type(progress_t) :: progress
      real(rk) :: fields_time = -huge(1.0_rk)  !< of the last written fields [s]
      logical, allocatable, private :: has_slipped(:), has_opened(:)  !< (fractures)
      logical, allocatable, private :: has_arrested(:)  !< (tips)
   contains
      procedure :: open => open_journal
      procedure :: state_done
      procedure :: contact_events
      procedure :: tips_done
      procedure :: growth_done
      procedure :: mesh_done
   end type journal_t

contains

   !> Open the files.
   subroutine open_journal(self, directory, quiet, scene, error)
      class(journal_t), intent(inout) :: self
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      call self%files%open(directory, scene, error, has_fluid=scene%has_fluid())
      if (allocated(error)) return
      call self%progress%begin(quiet)
      allocate (self%has_slipped(size(scene%fractures)), source=.false.)
      allocate (self%has_opened(size(scene%fractures)), source=.false.)
   end subroutine open_journal

   !> An accepted state: its row of history.csv, the largest values of the run, the progress line.
   subroutine state_done(self, row, progress, error)
      class(journal_t), intent(inout) :: self
      type(history_row_t), intent(in) :: row
      type(progress_values_t), intent(in) :: progress  !< what the row does not hold
      type(error_t), allocatable, intent(out) :: error
      type(progress_values_t) :: shown

      call self%files%history_row(row)
      associate (record => self%record)
         record%mass_error_relative = max(record%mass_error_relative, row%mass_error_relative)
         record%newton_total = record%newton_total + row%newton_iterations
         record%newton_max = max(record%newton_max, row%newton_iterations)
      end associate
      call self%files%tick(error)
      shown = progress
      shown%time = row%time
      shown%step = self%record%steps
      shown%newton_iterations = row%newton_iterations
      shown%n_stick = row%n_stick
      shown%n_slip = row%n_slip
      shown%n_open = row%n_open
      shown%fracture_length = row%fracture_length
      call self%progress%show(shown)
   end subroutine state_done

   !> First slip and first opening of each fracture. Where `slips` or `opens` is false for a
   !! fracture, it does so from the start, and no event tells it.
   subroutine contact_events(self, time, fracture, state, slips, opens)
      class(journal_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: state(:)  !< (fracture cells) of contact_states
      logical, intent(in) :: slips(:), opens(:)  !< (fractures)
      real(rk) :: centre(2)
      integer(ik) :: cell, f

      do cell = 1, fracture%n_cells
         f = fracture%cell_fracture(cell)
         centre = 0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, cell)), dim=2)
         if (state(cell) == state_slip .and. slips(f) .and. .not. self%has_slipped(f)) then
            self%has_slipped(f) = .true.
            call self%files%event_row(time, event_slip_onset, "first slip", f, centre)
         else if (state(cell) == state_open .and. opens(f) .and. .not. self%has_opened(f)) then
            self%has_opened(f) = .true.
            call self%files%event_row(time, event_opening, "first opening", f, centre)
         end if
      end do
   end subroutine contact_events

   !> A row of tips.csv for each tip. Where any tip has just grown, all are as before that.
   subroutine tips_done(self, time, tips)
      class(journal_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      class(tip_state_t), intent(in) :: tips(:)
      logical :: any_grew
      integer(ik) :: i

      any_grew = any(tips%advance > 0.0_rk)
      do i = 1, size(tips)
         associate (tip => tips(i))
            if (tip%advance > 0.0_rk) then
               call add_row(tip%origin, tip%intensity_before, tip%drive_before, tip%kink, &
                            tip%advance)
            else if (any_grew) then
               call add_row(tip%xy, tip%intensity_before, tip%drive_before, &
                            tip%drive_before%angle, 0.0_rk)
            else
               call add_row(tip%xy, tip%intensity, tip%drive, tip%drive%angle, 0.0_rk)
            end if
         end associate
      end do

   contains

      subroutine add_row(xy, intensity, drive, angle, advance)
         real(rk), intent(in) :: xy(2)
         type(intensity_t), intent(in) :: intensity
         type(growth_drive_t), intent(in) :: drive
         real(rk), intent(in) :: angle, advance

         call self%files%tip_row(tip_row_t(time=time, tip=i, fracture=tips(i)%fracture, xy=xy, &
                                           k1=intensity%k1, k2=intensity%k2, &
                                           k1_dc=intensity%k1_dc, k2_dc=intensity%k2_dc, &
                                           keq=drive%intensity, g=drive%energy, angle=angle, &
                                           advance=advance, k1_error=intensity%k1_error, &
                                           k2_error=intensity%k2_error, &
                                           g_domain=intensity%g_domain, &
                                           g_error=intensity%g_error, &
                                           k1_dc_error=intensity%k1_dc_error, &
                                           k2_dc_error=intensity%k2_dc_error, &
                                           k1_corrected=intensity%k1_corrected, &
                                           k2_corrected=intensity%k2_corrected))
      end subroutine add_row

   end subroutine tips_done

   !> Events of the tips that have just grown, joined something or stopped short of it.
   subroutine growth_done(self, time, scene, tips)
      class(journal_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(scene_t), intent(in) :: scene
      class(tip_state_t), intent(in) :: tips(:)
      real(rk), parameter :: degrees = 180.0_rk/acos(-1.0_rk)  ! per radian
      character(len=64) :: detail
      integer(ik) :: i

      if (.not. allocated(self%has_arrested)) then
         allocate (self%has_arrested(size(tips)), source=.false.)
      end if
      do i = 1, size(tips)
         associate (tip => tips(i))
            if (tip%advance > 0.0_rk) then
               write (detail, "(a,es10.3,a,f7.2,a)") "advance ", tip%advance, " m, kink ", &
                  tip%kink*degrees, " deg"
               call self%files%event_row(time, event_growth, trim(detail), tip%fracture, tip%xy)
               if (allocated(tip%joint)) then
                  call self%files%event_row(time, event_joint, tip%joint, tip%fracture, tip%xy)
               end if
            else if (allocated(tip%arrest_reason) .and. .not. self%has_arrested(i)) then
               self%has_arrested(i) = .true.
               call self%record%warn("fracture "//trim(scene%fractures(tip%fracture)%name)// &
                                     " stopped growing "//tip%arrest_reason)
               call self%files%event_row(time, event_arrest, tip%arrest_reason, tip%fracture, &
                                         tip%xy)
            end if
         end associate
      end do
   end subroutine growth_done

   !> The mesh has followed the growth.
   subroutine mesh_done(self, time, network, mesh)
      class(journal_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(network_t), intent(in) :: network  !< as the mesh has it
      type(mesh_t), intent(in) :: mesh
      character(len=64) :: detail

      write (detail, "(i0,a,i0,a)") mesh%n_cells, " cells, ", mesh%fracture%n_cells, &
         " fracture cells"
      call self%files%event_row(time, event_remesh, trim(detail))
      call self%files%network_step(time, network, mesh)
   end subroutine mesh_done

end module app_journal
