!> The heat of a body at one time.
module heat_state
   use base_archive, only: archive_t
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: heat_state_t

   !> Unknowns as in heat_model, temperatures and heat relative to the temperature of &heat.
   type :: heat_state_t
      !> (unknowns) [K]; unallocated: the run has no heat
      real(rk), allocatable :: temperature(:)
      real(rk), allocatable :: capacity(:)  !< (unknowns) with the fluid that is there now [J/(m K)]
      !> (unknowns) of the last substep; unallocated before the first [K/s]
      real(rk), allocatable :: rate(:)
      !> (unknowns) half its change per time, in the last two of them; unallocated: unknown [K/s2]
      real(rk), allocatable :: bend(:)
      !> (unknowns) rise that acted in the last step; unallocated: none did [K]
      real(rk), allocatable :: acting(:)
      !> (wells) of what flows out of the body, else into it, in the last step [K]
      real(rk), allocatable :: well_temperature(:)
      real(rk) :: last = 0.0_rk  !< length of the last substep [s]
      real(rk) :: next = 0.0_rk  !< length of the next one [s]
      !> Squares of all substeps, each as far as its correction does not count [s2]
      real(rk) :: damped = 0.0_rk
      ! Since the start [J/m]:
      real(rk) :: stored = 0.0_rk  !< increase in the body
      real(rk) :: by_wells = 0.0_rk  !< into the body
      real(rk) :: by_sides = 0.0_rk  !< into the body, by conduction and with fluid
      !> Sum of the amounts of both in all substeps, or if more what has moved within the body, or a
      !! hundred-thousandth of its heat before
      real(rk) :: moved = 0.0_rk
      !> Temperature outside the range of the initial ones and those of sides and wells [K]
      real(rk) :: beyond_range = 0.0_rk
      real(rk) :: range(2) = 0.0_rk  !< that range [K]
   contains
      procedure :: balance_error
      procedure :: visit
   end type heat_state_t

contains

   !> Error of the balance of heat over the heat moved [-].
   pure real(rk) function balance_error(self)
      class(heat_state_t), intent(in) :: self

      balance_error = abs(self%stored - self%by_wells - self%by_sides)/max(self%moved, tiny(1.0_rk))
   end function balance_error

   !> Store or load all components.
   subroutine visit(self, archive)
      class(heat_state_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("heat")
      call archive%list("temperature", self%temperature, "heat ?")
      call archive%list("capacity", self%capacity, "heat ?")
      call archive%list("rate", self%rate, "heat ?")
      call archive%list("bend", self%bend, "heat ?")
      call archive%list("acting", self%acting, "heat ?")
      call archive%list("well_temperature", self%well_temperature, "all_wells ?")
      call archive%agree("heat", [allocated(self%temperature), allocated(self%capacity), &
                                  allocated(self%well_temperature)])
      if (allocated(self%rate)) call archive%agree("heat", [.true., allocated(self%temperature)])
      if (allocated(self%bend)) call archive%agree("heat", [.true., allocated(self%rate)])
      call archive%item("last", self%last)
      call archive%item("next", self%next)
      call archive%item("damped", self%damped)
      call archive%item("stored", self%stored)
      call archive%item("by_wells", self%by_wells)
      call archive%item("by_sides", self%by_sides)
      call archive%item("moved", self%moved)
      call archive%item("beyond_range", self%beyond_range)
      call archive%item("range", self%range(1))
      call archive%item("range", self%range(2))
      call archive%leave()
   end subroutine visit

end module heat_state
