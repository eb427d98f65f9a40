!> What has happened in a run since its files were last written.
module report_chronicle
   use base_kinds, only: ik, rk
   use base_texts, only: add_text, text_t
   use report_rows, only: slip_event_t, tip_row_t, well_row_t
   implicit none(type, external)
   private

   public :: chronicle_t, event_t
   public :: event_arrest, event_bifurcation, event_growth, event_growth_onset
   public :: event_joint, event_opening
   public :: event_remesh, event_slip_onset, event_step_cut, event_unstable, event_well
   public :: event_window

   ! Kinds of events.
   character(len=*), parameter :: event_slip_onset = "slip_onset"
   character(len=*), parameter :: event_opening = "opening"
   character(len=*), parameter :: event_growth = "growth"
   character(len=*), parameter :: event_growth_onset = "growth_onset"
   character(len=*), parameter :: event_joint = "joint"
   character(len=*), parameter :: event_arrest = "arrest"
   character(len=*), parameter :: event_step_cut = "step_cut"
   character(len=*), parameter :: event_unstable = "unstable_growth"
   character(len=*), parameter :: event_bifurcation = "bifurcation"
   character(len=*), parameter :: event_remesh = "remesh"
   character(len=*), parameter :: event_window = "window"
   character(len=*), parameter :: event_well = "well"

   !> A row of events.csv. What does not apply to it is left empty.
   type :: event_t
      real(rk) :: time = 0.0_rk  !< [s]
      character(len=:), allocatable :: kind  !< event_slip_onset .. event_step_cut
      character(len=:), allocatable :: detail  !< a few words with numbers and units
      integer(ik) :: fracture = 0  !< 0: of none
      logical :: has_place = .false.
      real(rk) :: xy(2) = 0.0_rk  !< [m]
   end type event_t

   !> Events and rows of tips in their order, lines for the log.
   type :: chronicle_t
      type(event_t), allocatable :: events(:)
      type(tip_row_t), allocatable :: tips(:)
      type(well_row_t), allocatable :: wells(:)
      type(slip_event_t), allocatable :: slip_events(:)  !< that are over
      type(text_t), allocatable :: remarks(:)  !< lines for the log
      logical :: has_new_network = .false.  !< the mesh has followed growth
   contains
      procedure :: clear
      procedure :: add_event
      procedure :: add_tip
      procedure :: add_remark
   end type chronicle_t

contains

   !> Nothing has happened yet.
   pure subroutine clear(self)
      class(chronicle_t), intent(inout) :: self

      self%events = [event_t ::]
      self%tips = [tip_row_t ::]
      self%wells = [well_row_t ::]
      self%slip_events = [slip_event_t ::]
      self%remarks = [text_t ::]
      self%has_new_network = .false.
   end subroutine clear

   !> Add an event.
   pure subroutine add_event(self, time, kind, detail, fracture, xy)
      class(chronicle_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: kind, detail
      integer(ik), intent(in), optional :: fracture
      real(rk), intent(in), optional :: xy(2)  !< [m]
      type(event_t) :: event
      type(event_t), allocatable :: longer(:)

      event%time = time
      event%kind = kind
      event%detail = detail
      if (present(fracture)) event%fracture = fracture
      event%has_place = present(xy)
      if (present(xy)) event%xy = xy
      allocate (longer(size(self%events) + 1))
      longer(:size(self%events)) = self%events
      longer(size(longer)) = event
      call move_alloc(longer, self%events)
   end subroutine add_event

   !> Add a row of tips.csv.
   pure subroutine add_tip(self, row)
      class(chronicle_t), intent(inout) :: self
      type(tip_row_t), intent(in) :: row

      self%tips = [self%tips, row]
   end subroutine add_tip

   !> Add a line for the log.
   pure subroutine add_remark(self, line)
      class(chronicle_t), intent(inout) :: self
      character(len=*), intent(in) :: line

      call add_text(self%remarks, line)
   end subroutine add_remark

end module report_chronicle
