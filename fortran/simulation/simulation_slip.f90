!> Slip events: where and when the faces of fractures slide, put together from what each step adds.
!!
!! In a step, a patch is a row of cells of one fracture whose faces slide. Patches of two steps that
!! follow each other belong to the same event if they have faces in common; what divides goes on as
!! one, and events that meet are one from then on. An event is over when nothing of it slides any
!! more. The simulation is quasi-static: events last as long as their load drives them, and what
!! radiates from them is not known.
!!
!! Seismic moment M0 = G times the sum of slip times area (Aki 1966), with an assumed length out of
!! the plane; moment magnitude M_w = (log10(M0/(N m)) - 9.1)/1.5 (Hanks and Kanamori 1979, in SI
!! units as the IASPEI standard of 2005 has it).
module simulation_slip
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t
   use results_rows, only: slip_event_t
   implicit none(type, external)
   private

   public :: magnitude, slip_catalogue_t

   !> An event that is not over.
   type :: live_t
      type(slip_event_t) :: event  !< its place is still weighed with the potency
      real(rk) :: potency = 0.0_rk  !< slip times length so far [m2]
      real(rk) :: last = 0.0_rk  !< of it, in the last step [m2]
      real(rk) :: open = 0.0_rk  !< of it, where the faces do not touch [m2]
      real(rk) :: sudden = 0.0_rk  !< of it, in unstable growth [m2]
   end type live_t

   !> A row of sliding cells in the last step.
   type :: patch_t
      integer(ik) :: fracture = 0
      real(rk) :: s(2) = 0.0_rk  !< arc lengths, from and to [m]
      integer(ik) :: live = 0  !< to which event it belongs
   end type patch_t

   !> The events so far.
   type :: slip_catalogue_t
      real(rk) :: shear = 0.0_rk  !< modulus G [Pa]
      real(rk) :: breadth = 1.0_rk  !< out of the plane [m]
      real(rk) :: least_slip = 0.0_rk  !< mean slip that makes an event [m]
      integer(ik) :: n = 0  !< events that are over
      type(slip_event_t), allocatable :: news(:)  !< that are over since these were taken
      type(live_t), allocatable, private :: live(:)  !< in the order of their beginning
      type(patch_t), allocatable, private :: patch(:)
   contains
      procedure :: begin
      procedure :: follow
      procedure :: end_all
   end type slip_catalogue_t

contains

   !> Nothing slides.
   subroutine begin(self, shear, breadth, least_slip)
      class(slip_catalogue_t), intent(out) :: self
      real(rk), intent(in) :: shear  !< modulus [Pa]
      real(rk), intent(in) :: breadth  !< out of the plane [m]
      real(rk), intent(in) :: least_slip  !< mean slip that makes an event [m]

      self%shear = shear
      self%breadth = breadth
      self%least_slip = least_slip
      allocate (self%news(0), self%live(0), self%patch(0))
   end subroutine begin

   !> A step of length dt that led to a time.
   pure subroutine follow(self, time, dt, fracture, potency, slides, is_open, is_sudden)
      class(slip_catalogue_t), intent(inout) :: self
      real(rk), intent(in) :: time, dt  !< [s]; dt > 0
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: potency(:)  !< (cells) slip of the step times length [m2]
      logical, intent(in) :: slides(:)  !< (cells) its faces do
      logical, intent(in) :: is_open(:)  !< (cells) they do not touch
      logical, intent(in) :: is_sudden  !< growth was unstable in the step
      type(patch_t), allocatable :: patches(:)
      integer(ik) :: cell, first, p

      allocate (patches(0))
      self%live%last = 0.0_rk
      first = 1
      do while (first <= fracture%n_cells)
         if (.not. slides(first)) then
            first = first + 1
            cycle
         end if
         cell = last_of_patch(fracture, slides, first)
         associate (s => [fracture%cell_s(1, first), fracture%cell_s(2, cell)])
            patches = [patches, patch_t(fracture%cell_fracture(first), s)]
         end associate
         call assign_patch(self, patches, time - dt)
         p = size(patches)
         call add_slip(self%live(patches(p)%live), time, fracture, first, cell, potency, is_open, &
                       is_sudden)
         first = cell + 1
      end do
      call move_alloc(patches, self%patch)
      do p = 1, size(self%live)
         associate (live => self%live(p))
            live%event%largest_rate = max(live%event%largest_rate, &
                                          self%shear*live%last*self%breadth/dt)
         end associate
      end do
      call end_quiet(self)
   end subroutine follow

   !> The last cell of a patch. Cells are stored along each fracture.
   pure integer(ik) function last_of_patch(fracture, slides, first) result(last)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: slides(:)  !< (cells)
      integer(ik), intent(in) :: first

      last = first
      do while (last < fracture%n_cells)
         if (.not. slides(last + 1)) return
         if (fracture%cell_fracture(last + 1) /= fracture%cell_fracture(first)) return
         last = last + 1
      end do
   end function last_of_patch

   !> To which event the last one of the patches belongs: the first of those that it has faces in
   !! common with, which takes in the others, or a new one.
   pure subroutine assign_patch(self, patches, time)
      class(slip_catalogue_t), intent(inout) :: self
      type(patch_t), intent(inout) :: patches(:)  !< of this step
      real(rk), intent(in) :: time  !< when the step began [s]
      logical :: meets(size(self%patch))
      type(live_t) :: new
      integer(ik) :: i, keeps

      associate (patch => patches(size(patches)), before => self%patch)
         meets = before%fracture == patch%fracture .and. before%s(1) < patch%s(2) &
                 .and. before%s(2) > patch%s(1)
         if (.not. any(meets)) then
            new%event%time = time
            new%event%fracture = patch%fracture
            new%event%s = patch%s
            self%live = [self%live, new]
            patch%live = size(self%live)
            return
         end if
         keeps = minval(before%live, mask=meets)
         patch%live = keeps
         do i = 1, size(meets)
            if (.not. meets(i) .or. before(i)%live == keeps) cycle
            call take_in(self, before(i)%live, keeps, patches)
         end do
         associate (s => self%live(keeps)%event%s)
            s = [min(s(1), patch%s(1)), max(s(2), patch%s(2))]
         end associate
      end associate
   end subroutine assign_patch

   !> An event becomes part of another one.
   pure subroutine take_in(self, gone, keeps, patches)
      class(slip_catalogue_t), intent(inout) :: self
      integer(ik), value :: gone  !< live events
      integer(ik), intent(in) :: keeps
      type(patch_t), intent(inout) :: patches(:)  !< of this step

      associate (a => self%live(keeps), b => self%live(gone))
         a%event%time = min(a%event%time, b%event%time)
         a%event%end = max(a%event%end, b%event%end)
         a%event%s = [min(a%event%s(1), b%event%s(1)), max(a%event%s(2), b%event%s(2))]
         a%event%xy = a%event%xy + b%event%xy
         a%potency = a%potency + b%potency
         a%last = a%last + b%last
         a%event%largest_rate = max(a%event%largest_rate, b%event%largest_rate)
         a%open = a%open + b%open
         a%sudden = a%sudden + b%sudden
         b%potency = 0.0_rk
      end associate
      where (self%patch%live == gone) self%patch%live = keeps
      where (patches%live == gone) patches%live = keeps
   end subroutine take_in

   !> Slip of some cells that follow each other.
   pure subroutine add_slip(live, time, fracture, first, last, potency, is_open, is_sudden)
      type(live_t), intent(inout) :: live
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: first, last
      real(rk), intent(in) :: potency(:)  !< (cells) [m2]
      logical, intent(in) :: is_open(:)  !< (cells)
      logical, intent(in) :: is_sudden
      integer(ik) :: cell

      live%event%end = time
      live%potency = live%potency + sum(potency(first:last))
      live%last = live%last + sum(potency(first:last))
      live%open = live%open + sum(potency(first:last), mask=is_open(first:last))
      if (is_sudden) live%sudden = live%sudden + sum(potency(first:last))
      do cell = first, last
         live%event%xy = live%event%xy + potency(cell) &
                         *0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, cell)), dim=2)
      end do
   end subroutine add_slip

   !> Events of which nothing slides any more are over.
   pure subroutine end_quiet(self)
      class(slip_catalogue_t), intent(inout) :: self
      logical :: goes_on(size(self%live))
      integer(ik) :: i

      do i = 1, size(goes_on)
         goes_on(i) = any(self%patch%live == i)
         if (.not. goes_on(i)) call list(self, self%live(i), .true.)
      end do
      do i = 1, size(self%patch)
         self%patch(i)%live = count(goes_on(:self%patch(i)%live))
      end do
      self%live = pack(self%live, goes_on)
   end subroutine end_quiet

   !> The run is over: what still slides is listed as it is.
   pure subroutine end_all(self)
      class(slip_catalogue_t), intent(inout) :: self
      integer(ik) :: i

      if (.not. allocated(self%live)) return
      do i = 1, size(self%live)
         call list(self, self%live(i), .false.)
      end do
      self%live = self%live(:0)
      self%patch = self%patch(:0)
   end subroutine end_all

   !> List an event, unless it is too small or part of another one by now.
   pure subroutine list(self, live, sticks)
      class(slip_catalogue_t), intent(inout) :: self
      type(live_t), intent(in) :: live
      logical, intent(in) :: sticks  !< it is over; else the run is
      type(slip_event_t) :: event

      event = live%event
      event%mean_slip = live%potency/(event%s(2) - event%s(1))
      if (.not. (live%potency > 0.0_rk .and. event%mean_slip >= self%least_slip)) return
      self%n = self%n + 1
      event%number = self%n
      event%xy = event%xy/live%potency
      event%area = (event%s(2) - event%s(1))*self%breadth
      event%moment = self%shear*live%potency*self%breadth
      event%magnitude = magnitude(event%moment)
      event%open_share = live%open/live%potency
      event%sudden_share = live%sudden/live%potency
      event%sticks = sticks
      self%news = [self%news, event]
   end subroutine list

   !> Moment magnitude [-].
   elemental real(rk) function magnitude(moment)
      real(rk), intent(in) :: moment  !< [N m]

      magnitude = (log10(moment) - 9.1_rk)/1.5_rk
   end function magnitude

end module simulation_slip
