!> What a running scene hands to its files and to the terminal, whichever way it is simulated.
module app_journal
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use mesh_types, only: mesh_t, network_t
   use output_progress, only: progress_t, progress_values_t
   use output_run, only: run_output_t
   use results_fields, only: intersection_fields_t
   use results_rows, only: history_row_t, probe_row_t
   use simulation_types, only: simulation_t, snapshot_t
   implicit none(type, external)
   private

   public :: journal_t

   !> Files and progress line of a run.
   type :: journal_t
      type(run_output_t) :: files
      type(progress_t) :: progress
      real(rk) :: fields_time = -huge(1.0_rk)  !< of the last written fields [s]
   contains
      procedure :: open => open_journal
      procedure :: write_state
      procedure :: write_chronicle
      procedure :: write_fields
   end type journal_t

contains

   !> Open the files, and write the first network.
   subroutine open_journal(self, directory, quiet, simulation, error)
      class(journal_t), intent(inout) :: self
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      class(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error

      call self%files%open(directory, simulation%scene, error)
      if (allocated(error)) return
      call self%progress%begin(quiet)
      call write_network(self, simulation)
   end subroutine open_journal

   subroutine write_network(self, simulation)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(in) :: simulation
      type(network_t) :: network
      type(mesh_t) :: mesh

      call simulation%present_network(network, mesh)
      call self%files%network_step(simulation%time(), network, mesh)
   end subroutine write_network

   !> An accepted state: history, probes, fields where they are due, the progress line.
   subroutine write_state(self, simulation, error)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(inout) :: simulation
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      type(probe_row_t) :: probes
      character(len=:), allocatable :: log_line
      logical :: has_fluid

      has_fluid = simulation%scene%has_fluid()
      row = simulation%history()
      if (size(simulation%scene%probes) > 0) then
         call simulation%probes(probes, error)
         if (allocated(error)) return
         call self%files%probe_row(row%time, probes)
      end if
      ! Only a scene in time has an interval between its fields.
      if (simulation%shows_state .and. (self%files%fields_due(row%time) .or. .not. has_fluid)) then
         call self%write_fields(simulation, error)
         if (allocated(error)) return
      end if
      call self%files%history_row(row)
      call self%files%tick(error)
      call self%progress%show(progress_values_t( &
                              share=simulation%share_done(), time=row%time, &
                              step=simulation%summary%steps, n_stick=row%n_stick, &
                              n_slip=row%n_slip, n_open=row%n_open, &
                              fracture_length=row%fracture_length, &
                              has_well=size(simulation%scene%injections) > 0, &
                              well_pressure=row%well_pressure, &
                              keq_over_kic=simulation%keq_over_kic(), is_load=.not. has_fluid), &
                              log_line)
      if (allocated(log_line)) call self%files%log(log_line)
   end subroutine write_state

   !> What has happened since the last time.
   subroutine write_chronicle(self, simulation)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(inout) :: simulation
      integer(ik) :: i

      associate (chronicle => simulation%chronicle)
         do i = 1, size(chronicle%events, kind=ik)
            associate (event => chronicle%events(i))
               if (event%has_place) then
                  call self%files%event_row(event%time, event%kind, event%detail, event%fracture, &
                                            event%xy)
               else
                  call self%files%event_row(event%time, event%kind, event%detail)
               end if
            end associate
         end do
         do i = 1, size(chronicle%tips, kind=ik)
            call self%files%tip_row(chronicle%tips(i))
         end do
         do i = 1, size(chronicle%remarks, kind=ik)
            call self%files%log(chronicle%remarks(i)%text)
         end do
         if (chronicle%has_new_network) call write_network(self, simulation)
         call chronicle%clear()
      end associate
   end subroutine write_chronicle

   !> Fields of the last good state, unless those of its time have been written.
   subroutine write_fields(self, simulation, error)
      class(journal_t), intent(inout) :: self
      class(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error
      type(snapshot_t), allocatable :: fields
      type(intersection_fields_t) :: none

      call simulation%snapshot(fields)
      if (.not. allocated(fields)) return
      if (.not. fields%time > self%fields_time) return
      allocate (none%point(0), none%pressure(0))
      call self%files%write_fields(fields%time, fields%mesh, fields%matrix, fields%fracture, none, &
                                   error)
      self%fields_time = fields%time
   end subroutine write_fields

end module app_journal
