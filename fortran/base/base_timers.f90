!> CPU time by phase. Phases nest: starting one pauses the enclosing one, so that the sum of all
!! phases does not exceed the time of the process.
!!
!! They are passed to all procedures with long computations, together with the check for requests to
!! end the program.
module base_timers
   use base_errors, only: error_t, raise_error
   use base_kinds, only: lk, rk
   implicit none(type, external)
   private

   public :: phase_assemble, phase_contact, phase_count, phase_discretize, phase_factorize
   public :: phase_mesh, phase_names, phase_output, phase_remesh, phase_solve, phase_tips
   public :: listener_t, phase_transfer, timers_t

   integer, parameter :: phase_mesh = 1  !< first mesh
   integer, parameter :: phase_discretize = 2  !< stencils of the finite volumes
   integer, parameter :: phase_assemble = 3  !< matrices and right-hand sides
   integer, parameter :: phase_factorize = 4  !< orderings, factors, Schur complements
   integer, parameter :: phase_solve = 5  !< back-substitutions
   integer, parameter :: phase_contact = 6  !< Newton iteration on the fractures
   integer, parameter :: phase_tips = 7  !< fine level: windows, intensities, growth
   integer, parameter :: phase_remesh = 8  !< meshes after the first
   integer, parameter :: phase_transfer = 9  !< state from one mesh to the next
   integer, parameter :: phase_output = 10  !< files and progress line
   integer, parameter :: phase_count = 10

   !> Names as run.json has them.
   character(len=10), parameter :: phase_names(phase_count) = [character(len=10) :: &
                                                               "mesh", "discretize", &
                                                               "assemble", "factorize", &
                                                               "solve", "contact", "tips", &
                                                               "remesh", "transfer", "output"]

   !> Receiver of notices during long computations.
   type, abstract :: listener_t
   contains
      procedure(hear_of_work), deferred :: hear
   end type listener_t

   abstract interface
      !> Called before a long computation; `ends` requests the end of the run.
      subroutine hear_of_work(self, ends)
         import :: listener_t
         implicit none(type, external)
         class(listener_t), intent(inout) :: self
         logical, intent(out) :: ends
      end subroutine hear_of_work
   end interface

   !> The stop watch of one run.
   type :: timers_t
      private
      real(rk) :: spent(phase_count) = 0.0_rk  !< [s], without the running phase's last stretch
      integer, allocatable :: running(:)  !< phases begun and not ended, the innermost last
      integer :: depth = 0
      real(rk) :: since = 0.0_rk  !< CPU time when the innermost phase began or went on [s]
      integer(lk) :: wall_begin = 0_lk  !< clock ticks
      real(rk) :: ticks_per_second = 0.0_rk
      class(listener_t), pointer, public :: listener => null()  !< not associated: nobody
   contains
      procedure :: heed
      procedure :: begin
      procedure :: start
      procedure :: stop => stop_phase
      procedure :: seconds
      procedure, nopass :: cpu_seconds
      procedure :: wall_seconds
   end type timers_t

contains

   !> Set all to zero; the wall time counts from here.
   subroutine begin(self)
      class(timers_t), intent(out) :: self
      integer(lk) :: rate

      call system_clock(self%wall_begin, rate)
      self%ticks_per_second = real(rate, rk)
      allocate (self%running(8))
   end subroutine begin

   !> Notify the listener of a long computation. If it requests the end, an interruption is raised,
   !! and the caller returns as after an error.
   subroutine heed(self, error)
      class(timers_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      logical :: ends

      if (.not. associated(self%listener)) return
      call self%listener%hear(ends)
      if (.not. ends) return
      call raise_error(error, "", "interrupted")
      error%is_interruption = .true.
   end subroutine heed

   !> Begin a phase; the phase around it pauses.
   subroutine start(self, phase)
      class(timers_t), intent(inout) :: self
      integer, intent(in) :: phase  !< phase_mesh .. phase_output

      if (.not. allocated(self%running)) call self%begin()
      call book(self)
      if (self%depth == size(self%running)) self%running = [self%running, self%running]
      self%depth = self%depth + 1
      self%running(self%depth) = phase
   end subroutine start

   !> End a phase, with any phase inside it that an early return left running; the one around goes
   !! on. A phase that is not running is left alone.
   subroutine stop_phase(self, phase)
      class(timers_t), intent(inout) :: self
      integer, intent(in) :: phase
      integer :: level

      do level = self%depth, 1, -1
         if (self%running(level) == phase) then
            call book(self)
            self%depth = level - 1
            exit
         end if
      end do
   end subroutine stop_phase

   !> CPU time spent in a phase so far, without the phases nested in it [s].
   real(rk) function seconds(self, phase)
      class(timers_t), intent(in) :: self
      integer, intent(in) :: phase
      real(rk) :: now

      seconds = self%spent(phase)
      if (self%depth > 0) then
         if (self%running(self%depth) == phase) then
            call cpu_time(now)
            seconds = seconds + now - self%since
         end if
      end if
   end function seconds

   !> CPU time of the process since it began, with what no phase covers [s].
   real(rk) function cpu_seconds()
      call cpu_time(cpu_seconds)
   end function cpu_seconds

   !> Wall time since `begin` [s].
   real(rk) function wall_seconds(self)
      class(timers_t), intent(in) :: self
      integer(lk) :: now

      wall_seconds = 0.0_rk
      if (self%ticks_per_second > 0.0_rk) then
         call system_clock(now)
         wall_seconds = real(now - self%wall_begin, rk)/self%ticks_per_second
      end if
   end function wall_seconds

   !> Add the interval that ends now to the innermost phase.
   subroutine book(self)
      class(timers_t), intent(inout) :: self
      real(rk) :: now
      integer :: phase

      call cpu_time(now)
      if (self%depth > 0) then
         phase = self%running(self%depth)
         self%spent(phase) = self%spent(phase) + now - self%since
      end if
      self%since = now
   end subroutine book

end module base_timers
