!> Slip events of fractures, composed of the slipping patches of each step.
!!
!! In a step, a patch is a row of cells of one fracture whose faces slip. Patches of two consecutive
!! steps belong to the same event if they have faces in common; an event that divides continues as
!! one, and events that meet are merged. An event is over when none of its faces slips any more, or
!! when its largest slip rate passes a threshold: faster slip is seismic, from its nucleation, the
!! step in which the rate exceeds the threshold, to its arrest, when it falls below; slip before and
!! afterwards forms separate aseismic events. Rates are means of a step. Without radiation damping
!! the simulation is quasi-static: events last as long as their load drives them, and slip jumps
!! occur within one step.
!!
!! The static stress drop is the mean over the event's patch of the fall of the shear traction, from
!! the state before its first step to that after its last one.
!!
!! Seismic moment M0 = sum of G times slip times area (Aki 1966), with the G of the rock at each
!! cell and an assumed length out of the plane; moment magnitude M_w = (log10(M0/(N m)) - 9.1)/1.5
!! (Hanks and Kanamori 1979, in SI units as in the IASPEI standard of 2005).
!!
!! Shear tractions are stored by arc length, so that they can be compared with those of a later
!! mesh.
module report_slip
   use base_archive, only: archive_t
   use base_kinds, only: ik, rk
   use contact_law, only: state_open, state_stick
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: fracture_mesh_t
   use report_jump_errors, only: finite_volumes, last_of_zone
   use report_rows, only: slip_errors_t, slip_event_t
   implicit none(type, external)
   private

   public :: magnitude, slip_catalogue_t, slip_step_t

   !> Slip of all fracture cells in a time step.
   type :: slip_step_t
      real(rk) :: dt = 0.0_rk  !< length of the step, positive [s]
      real(rk), allocatable :: potency(:)  !< (cells) slip of the step times length [m2]
      real(rk), allocatable :: shear(:)  !< (cells) modulus G of the adjacent rock [Pa]
      integer(ik), allocatable :: state(:)  !< (cells) of contact_law
      real(rk), allocatable :: traction(:)  !< (cells) f_tau after the step [Pa]
      logical :: is_sudden = .false.  !< growth was unstable in the step
   end type slip_step_t

   !> Slip of one step, or of several.
   type :: amount_t
      real(rk) :: potency = 0.0_rk  !< slip times length [m2]
      real(rk) :: moment = 0.0_rk  !< seismic moment per metre out of the plane [N]
      real(rk) :: open = 0.0_rk  !< part of the moment on open faces [N]
      real(rk) :: sudden = 0.0_rk  !< part of the moment in unstable growth [N]
      real(rk) :: place(2) = 0.0_rk  !< sum of moment times position [N m]
      real(rk) :: s(2) = [huge(1.0_rk), -huge(1.0_rk)]  !< arc lengths, from and to [m]
      real(rk) :: rate = 0.0_rk  !< largest slip rate of a cell [m/s]
      real(rk) :: fastest(2) = 0.0_rk  !< centre of that cell [m]
      real(rk) :: cell = 0.0_rk  !< length of the longest cell [m]
   end type amount_t

   !> Shear tractions of fracture cells.
   type :: shear_t
      integer(ik), allocatable :: fracture(:)  !< (cells)
      real(rk), allocatable :: s(:, :)  !< (2, cells) arc lengths of their ends [m]
      real(rk), allocatable :: traction(:)  !< (cells) f_tau [Pa]
   contains
      procedure :: keep
      procedure :: of_fracture
      procedure :: fall
   end type shear_t

   !> An event that has not ended.
   type :: live_t
      logical :: has_begun = .false.  !< the event began before the present step
      type(slip_event_t) :: event
      type(amount_t) :: before  !< slip before the present step
      type(amount_t) :: now  !< slip in the present step
      type(shear_t) :: start  !< tractions of its fracture before the event
      real(rk) :: steps(2) = 0.0_rk  !< lengths of its first and its last step [s]
   end type live_t

   !> Adjacent sliding cells in the last step.
   type :: patch_t
      integer(ik) :: fracture = 0
      real(rk) :: s(2) = 0.0_rk  !< arc lengths, from and to [m]
      integer(ik) :: live = 0  !< index of its event
   end type patch_t

   !> The slip events of a run.
   type :: slip_catalogue_t
      real(rk) :: breadth = 1.0_rk  !< out-of-plane length [m]
      real(rk) :: least_slip = 0.0_rk  !< smallest mean slip of an event [m]
      real(rk) :: seismic_rate = huge(1.0_rk)  !< smallest slip rate of seismic events [m/s]
      integer(ik) :: n = 0  !< number of events that have ended
      type(slip_event_t), allocatable :: news(:)  !< ended events that have not been logged
      !> present events, in the order of their beginning
      type(live_t), allocatable, private :: live(:)
      type(patch_t), allocatable, private :: patch(:)  !< patches of the last step
      type(shear_t), private :: last  !< tractions after the last step
   contains
      procedure :: begin
      procedure :: remember
      procedure :: follow
      procedure :: end_all
      procedure :: visit
   end type slip_catalogue_t

   interface
      !> Store or load all components.
      module subroutine visit(self, archive)
         implicit none(type, external)
         class(slip_catalogue_t), intent(inout), target :: self
         type(archive_t), intent(inout) :: archive
      end subroutine visit
   end interface

contains

   !> Begin without any event.
   subroutine begin(self, breadth, least_slip, seismic_rate)
      class(slip_catalogue_t), intent(out) :: self
      real(rk), intent(in) :: breadth  !< out-of-plane length [m]
      real(rk), intent(in) :: least_slip  !< smallest mean slip of an event [m]
      real(rk), intent(in) :: seismic_rate  !< smallest slip rate of seismic events [m/s]

      self%breadth = breadth
      self%least_slip = least_slip
      self%seismic_rate = seismic_rate
      allocate (self%news(0), self%live(0), self%patch(0))
   end subroutine begin

   !> Keep the tractions before the first step.
   pure subroutine remember(self, fracture, traction)
      class(slip_catalogue_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: traction(:)  !< (cells) f_tau [Pa]

      call self%last%keep(fracture, traction)
   end subroutine remember

   !> Add the slip of a step that led to a time.
   pure subroutine follow(self, time, fracture, step)
      class(slip_catalogue_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: fracture
      type(slip_step_t), intent(in) :: step
      type(patch_t), allocatable :: patches(:)
      logical :: slides(size(step%state))
      integer(ik) :: cell, first, p

      slides = step%state /= state_stick .and. step%potency > 0.0_rk
      allocate (patches(0))
      if (.not. allocated(self%last%s)) call self%last%keep(fracture, step%traction)
      do p = 1, size(self%live)
         self%live(p)%now = amount_t()
      end do
      first = 1
      do while (first <= fracture%n_cells)
         if (.not. slides(first)) then
            first = first + 1
            cycle
         end if
         cell = last_of_zone(fracture, slides, first)
         associate (s => [fracture%cell_s(1, first), fracture%cell_s(2, cell)])
            patches = [patches, patch_t(fracture%cell_fracture(first), s)]
         end associate
         call assign_patch(self, patches)
         p = size(patches)
         call add(self%live(patches(p)%live)%now, amount_of(fracture, first, cell, step))
         first = cell + 1
      end do
      call move_alloc(patches, self%patch)
      do p = 1, size(self%live)
         if (any(self%patch%live == p)) call add_step(self, p, time, step%dt)
      end do
      call end_quiet(self)
      call self%last%keep(fracture, step%traction)
   end subroutine follow

   !> Assign the last of the patches to an event: the first of those with common faces, with which
   !! the others are merged, or a new one.
   pure subroutine assign_patch(self, patches)
      class(slip_catalogue_t), intent(inout) :: self
      type(patch_t), intent(inout) :: patches(:)  !< of this step
      logical :: meets(size(self%patch))
      type(live_t) :: new
      integer(ik) :: i, keeps

      associate (patch => patches(size(patches)), before => self%patch)
         meets = before%fracture == patch%fracture .and. before%s(1) < patch%s(2) &
                 .and. before%s(2) > patch%s(1)
         if (.not. any(meets)) then
            new%event%fracture = patch%fracture
            self%live = [self%live, new]
            patch%live = size(self%live)
            return
         end if
         keeps = minval(before%live, mask=meets)
         patch%live = keeps
         do i = 1, size(meets)
            if (.not. meets(i) .or. before(i)%live == keeps) cycle
            call merge_events(self, before(i)%live, keeps, patches)
         end do
      end associate
   end subroutine assign_patch

   !> Merge an event with another one. If one of them is seismic and the other aseismic, the
   !! aseismic one ends as a separate event.
   pure subroutine merge_events(self, gone, keeps, patches)
      class(slip_catalogue_t), intent(inout) :: self
      integer(ik), value :: gone  !< live events
      integer(ik), intent(in) :: keeps
      type(patch_t), intent(inout) :: patches(:)  !< of this step
      type(live_t) :: slow

      associate (a => self%live(keeps), b => self%live(gone))
         call add(a%now, b%now)
         if (a%event%is_seismic .neqv. b%event%is_seismic) then
            slow = b
            if (b%event%is_seismic) then
               slow = a
               a%event = b%event
               a%before = b%before
               a%start = b%start
            end if
            call list(self, slow, "speed")
         else
            a%event%time = min(a%event%time, b%event%time)
            a%event%end = max(a%event%end, b%event%end)
            a%event%largest_rate = max(a%event%largest_rate, b%event%largest_rate)
            call add(a%before, b%before)
         end if
         b%has_begun = .false.
         b%before = amount_t()
         b%now = amount_t()
      end associate
      where (self%patch%live == gone) self%patch%live = keeps
      where (patches%live == gone) patches%live = keeps
   end subroutine merge_events

   !> Slip of successive cells in a step.
   pure function amount_of(fracture, first, last, step) result(amount)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: first, last  !< cells
      type(slip_step_t), intent(in) :: step
      type(amount_t) :: amount
      real(rk) :: centre(2), moment(size(step%potency)), rate
      integer(ik) :: cell

      moment = step%shear*step%potency
      amount%potency = sum(step%potency(first:last))
      amount%moment = sum(moment(first:last))
      amount%open = sum(moment(first:last), mask=step%state(first:last) == state_open)
      if (step%is_sudden) amount%sudden = amount%moment
      amount%s = [fracture%cell_s(1, first), fracture%cell_s(2, last)]
      amount%cell = maxval(fracture%cell_s(2, first:last) - fracture%cell_s(1, first:last))
      do cell = first, last
         centre = fracture_cell_centre(fracture, cell)
         amount%place = amount%place + moment(cell)*centre
         rate = step%potency(cell) &
                /((fracture%cell_s(2, cell) - fracture%cell_s(1, cell))*step%dt)
         if (.not. rate > amount%rate) cycle
         amount%rate = rate
         amount%fastest = centre
      end do
   end function amount_of

   !> Add an amount of slip to another.
   pure subroutine add(amount, more)
      type(amount_t), intent(inout) :: amount
      type(amount_t), intent(in) :: more

      amount%potency = amount%potency + more%potency
      amount%moment = amount%moment + more%moment
      amount%open = amount%open + more%open
      amount%sudden = amount%sudden + more%sudden
      amount%place = amount%place + more%place
      amount%s = [min(amount%s(1), more%s(1)), max(amount%s(2), more%s(2))]
      amount%cell = max(amount%cell, more%cell)
      if (.not. more%rate > amount%rate) return
      amount%rate = more%rate
      amount%fastest = more%fastest
   end subroutine add

   !> Add a step to an event, or begin another event where the slip rate passes the threshold.
   pure subroutine add_step(self, p, time, dt)
      class(slip_catalogue_t), intent(inout) :: self
      integer(ik), intent(in) :: p  !< live event
      real(rk), intent(in) :: time, dt  !< [s]
      logical :: is_seismic

      associate (live => self%live(p))
         is_seismic = live%now%rate >= self%seismic_rate
         if (live%has_begun .and. (live%event%is_seismic .neqv. is_seismic)) then
            call list(self, live, "speed")
            live%has_begun = .false.
         end if
         if (.not. live%has_begun) then
            live%event = slip_event_t(time=time - dt, fracture=live%event%fracture, &
                                      is_seismic=is_seismic, onset_xy=live%now%fastest)
            live%before = amount_t()
            live%start = self%last%of_fracture(live%event%fracture)
            live%has_begun = .true.
            live%steps = dt
         end if
         live%steps(2) = dt
         live%event%end = time
         live%event%largest_rate = max(live%event%largest_rate, &
                                       live%now%moment*self%breadth/dt)
         call add(live%before, live%now)
      end associate
   end subroutine add_step

   !> End the events of which no cell slides any more.
   pure subroutine end_quiet(self)
      class(slip_catalogue_t), intent(inout) :: self
      logical :: goes_on(size(self%live))
      integer(ik) :: i

      do i = 1, size(goes_on)
         goes_on(i) = any(self%patch%live == i)
         if (.not. goes_on(i)) call list(self, self%live(i), "stick")
      end do
      do i = 1, size(self%patch)
         self%patch(i)%live = count(goes_on(:self%patch(i)%live))
      end do
      self%live = pack(self%live, goes_on)
   end subroutine end_quiet

   !> End all events with the run.
   pure subroutine end_all(self)
      class(slip_catalogue_t), intent(inout) :: self
      integer(ik) :: i

      if (.not. allocated(self%live)) return
      do i = 1, size(self%live)
         call list(self, self%live(i), "run")
      end do
      self%live = self%live(:0)
      self%patch = self%patch(:0)
   end subroutine end_all

   !> Add an event that has ended to the list, unless it is too small or merged with another one.
   pure subroutine list(self, live, ended_by)
      class(slip_catalogue_t), intent(inout) :: self
      type(live_t), intent(in) :: live
      character(len=*), intent(in) :: ended_by
      type(slip_event_t) :: event
      real(rk) :: length

      if (.not. live%before%potency > 0.0_rk) return
      event = live%event
      event%s = live%before%s
      length = event%s(2) - event%s(1)
      event%mean_slip = live%before%potency/length
      if (.not. event%mean_slip >= self%least_slip) return
      self%n = self%n + 1
      event%number = self%n
      event%xy = live%before%place/live%before%moment
      event%area = length*self%breadth
      event%moment = live%before%moment*self%breadth
      event%magnitude = magnitude(event%moment)
      event%largest_slip_rate = live%before%rate
      event%mean_slip_rate = event%mean_slip/(event%end - event%time)
      event%stress_drop = live%start%fall(self%last, event%s)
      event%open_share = live%before%open/live%before%moment
      event%sudden_share = live%before%sudden/live%before%moment
      event%ended_by = ended_by
      event%error = errors_of(event, live, ends_known(self%last, event), self%breadth)
      self%news = [self%news, event]
   end subroutine list

   !> Number of ends of the patch of an event that are ends of its fracture.
   pure integer function ends_known(mesh, event) result(n)
      type(shear_t), intent(in) :: mesh
      type(slip_event_t), intent(in) :: event

      associate (of_event => mesh%fracture == event%fracture)
         n = count([event%s(1) <= minval(mesh%s(1, :), mask=of_event), &
                    event%s(2) >= maxval(mesh%s(2, :), mask=of_event)])
      end associate
   end function ends_known

   !> Estimated errors of an event: its patch is known to a cell at each end within its fracture,
   !! its times to a step.
   pure type(slip_errors_t) function errors_of(event, live, n_known, breadth) result(error)
      type(slip_event_t), intent(in) :: event
      type(live_t), intent(in) :: live
      integer, intent(in) :: n_known  !< ends of the patch that are ends of the fracture
      real(rk), intent(in) :: breadth  !< out-of-plane length [m]
      real(rk) :: of_ends, share

      associate (law => finite_volumes, per_half => 2.0_rk*live%before%cell &
                 /(event%s(2) - event%s(1)))
         of_ends = (2 - n_known)*0.5_rk*per_half
         share = law%rest - law%less + per_half*merge(law%of_sum, law%within, n_known == 2)
      end associate
      error%time = maxval(live%steps)
      error%place = live%before%cell
      error%area = (2 - n_known)*live%before%cell*breadth
      error%moment = share*event%moment
      error%magnitude = share/(1.5_rk*log(10.0_rk))
      error%mean_slip = (share + of_ends)*event%mean_slip
      error%mean_slip_rate = error%mean_slip/(event%end - event%time) &
                             + event%mean_slip_rate*error%time/(event%end - event%time)
      error%stress_drop = (share + of_ends)*abs(event%stress_drop)
   end function errors_of

   !> Moment magnitude [-].
   elemental real(rk) function magnitude(moment)
      real(rk), intent(in) :: moment  !< [N m]

      magnitude = (log10(moment) - 9.1_rk)/1.5_rk
   end function magnitude

   !> Keep the tractions of a state.
   pure subroutine keep(self, mesh, traction)
      class(shear_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: traction(:)  !< (cells) [Pa]

      self%fracture = mesh%cell_fracture
      self%s = mesh%cell_s
      self%traction = traction
   end subroutine keep

   !> Tractions of one fracture.
   pure function of_fracture(self, fracture) result(part)
      class(shear_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      type(shear_t) :: part
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i

      cells = pack([(i, i=1, size(self%fracture))], self%fracture == fracture)
      part%fracture = self%fracture(cells)
      part%s = self%s(:, cells)
      part%traction = self%traction(cells)
   end function of_fracture

   !> Decrease of the shear traction up to a later time, in its earlier direction, as the mean over
   !! a part of the fracture without new cells [Pa].
   pure real(rk) function fall(self, later, s)
      class(shear_t), intent(in) :: self  !< of one fracture
      type(shear_t), intent(in) :: later
      real(rk), intent(in) :: s(2)  !< the part, as arc lengths [m]
      real(rk) :: length, middle, total
      integer(ik) :: cell, i

      total = 0.0_rk
      length = 0.0_rk
      if (size(self%fracture) > 0) then
         do i = 1, size(later%fracture, kind=ik)
            if (later%fracture(i) /= self%fracture(1)) cycle
            middle = 0.5_rk*sum(later%s(:, i))
            if (middle < s(1) .or. middle > s(2)) cycle
            cell = findloc(self%s(1, :) <= middle .and. middle <= self%s(2, :), .true., dim=1, &
                           kind=ik)
            if (cell == 0) cycle
            associate (part => later%s(2, i) - later%s(1, i), before => self%traction(cell))
               total = total + part*(abs(before) - sign(1.0_rk, before)*later%traction(i))
               length = length + part
            end associate
         end do
      end if
      fall = 0.0_rk
      if (length > 0.0_rk) fall = total/length
   end function fall

end module report_slip
