!> Wells whose rate depends on pressures: a pressure is given, or bounds a rate, or the well itself
!! holds fluid. Those in fractures have their flow into these as an unknown of the step
!! (coarse_well_flow), those in the rock stand in its matrix (coarse_rock_wells). Wells that inject
!! at a given rate are none of these, but sources of their cells.
!!
!! The well's pressure is that at its head, without the weight of its fluid: what fracture or rock
!! have at the well, and what the flow to there loses.
module coarse_wells
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: wells_t
   public :: control_limited, control_pressure, control_rate, control_shut

   integer(ik), parameter :: control_shut = 0  !< nothing flows
   integer(ik), parameter :: control_rate = 1  !< into the well at its head
   integer(ik), parameter :: control_pressure = 2
   integer(ik), parameter :: control_limited = 3  !< a rate, as far as pressure allows

   type :: wells_t
      integer(ik) :: n = 0  !< in fractures
      integer(ik) :: n_all = 0  !< these first, then those in the rock
      integer(ik), allocatable :: number(:)  !< (n_all) among all wells of the scene
      real(rk), allocatable :: share(:, :)  !< (fracture cells, n) of its flow, into each [-]
      real(rk), allocatable :: joint_share(:, :)  !< (joints, n) [-]
      !> (n) it stands between two cells, half a cell away from the middles of both
      logical, allocatable :: is_between(:)
      real(rk), allocatable :: storage(:)  !< (n_all) [m2/Pa]
      real(rk), allocatable :: friction(:)  !< (n_all) pressure lost per flow [Pa s/m2]
      real(rk), allocatable :: turbulence(:)  !< (n_all) and per its square [Pa s2/m4]
      !> (n_all) in situ, beyond which its pressures count; unallocated: 0 [Pa]
      real(rk), allocatable :: pressure_in_situ(:)
      ! In the present step:
      integer(ik), allocatable :: control(:)  !< (n_all)
      real(rk), allocatable :: rate(:)  !< (n_all) asked for; negative: extraction [m2/s]
      real(rk), allocatable :: pressure(:)  !< (n_all) asked for, or the limit [Pa]
   contains
      procedure :: lost
      procedure :: is_at_limit
   end type wells_t

contains

   !> Pressure that a flow loses on its way through the well, and its derivative.
   pure subroutine lost(self, well, flow, pressure, slope)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: flow  !< into the fracture [m2/s]
      real(rk), intent(out) :: pressure  !< [Pa]
      real(rk), intent(out) :: slope  !< [Pa s/m2]

      pressure = (self%friction(well) + self%turbulence(well)*abs(flow))*flow
      slope = self%friction(well) + 2.0_rk*self%turbulence(well)*abs(flow)
   end subroutine lost

   !> A limited well has the pressure of its limit, and less than its rate.
   pure logical function is_at_limit(self, well, rate, head)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: rate  !< into the well, at its head [m2/s]
      real(rk), intent(in) :: head  !< pressure there [Pa]
      real(rk), parameter :: rounding(2) = [1.0e-9_rk, 1.0e-6_rk]  ! of the rate, of the pressure
      real(rk) :: in_situ

      is_at_limit = .false.
      if (self%control(well) /= control_limited) return
      in_situ = 0.0_rk
      if (allocated(self%pressure_in_situ)) in_situ = self%pressure_in_situ(well)
      associate (limit => self%pressure(well))
         is_at_limit = rate/self%rate(well) < 1.0_rk - rounding(1) .and. &
                       sign(1.0_rk, self%rate(well))*(head - limit) &
                       >= -rounding(2)*max(abs(head + in_situ), abs(limit + in_situ))
      end associate
   end function is_at_limit

end module coarse_wells
