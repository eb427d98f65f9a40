!> Contact with Coulomb friction and shear dilation at one point of a fracture, as equations for
!! Newton's method.
!!
!! Complementarity functions of a primal-dual active set (Hueeber and Wohlmuth 2005; docs/theory.md)
!! in their scalar form, each divided by its positive factor so that it is a stress [Pa] or,
!! times the stiffness c, a displacement. With the trial pressure z = -f_n - c ([u]_n - g) and the
!! trial shear q = f_tau + c d[u]_tau:
!!   open   z <= 0:             f_n = 0,               f_tau = 0
!!   stick  |q| < mu_s z:       c ([u]_n - g) = 0,     c d[u]_tau = 0
!!   slip   |q| >= mu_s z > 0:  c ([u]_n - g) = 0,     f_tau - mu_s z sign(q) = 0
!! The gap g = tan(psi) |[u]_tau|; without slip it rises whichever way the shear drives. What
!! rounding has left of a slip that is none counts as none: with its sign the gap would fall the
!! other way, and a step could take the point nowhere but back, again and again.
!! A bilateral law knows no open state: the faces keep the gap g under tension too, where z <= 0,
!! and f_tau = mu_s z sign(d[u]_tau) goes on holding. It is the model of reference solutions for
!! cracks that are closed all along; friction under tension drives the slip, either way, so it makes
!! sense only where the tension is confined to small zones and the rest of the crack decides the
!! way.
!!
!! Signs: sigma n = f - p_F n with n from side + to side - makes f the traction on side +, while the
!! jump is u(-) - u(+). Friction drags side + along with side -, so f_tau has the sign of the slip
!! increment; it opposes the slip on side -, where the traction is -f. (The thesis writes -f_tau for
!! f_tau, as for a traction on side -; with sigma n as above that would let friction do work on the
!! slip.)
module contact_law
   use base_kinds, only: ik, rk
   use base_tolerances, only: round_off
   use contact_states, only: state_open, state_slip, state_stick
   implicit none(type, external)
   private

   public :: contact_equations, contact_law_t, contact_residual, is_same, is_valid

   !> Parameters of the law.
   type :: contact_law_t
      real(rk) :: friction = 0.0_rk  !< mu_s [-]
      real(rk) :: dilation = 0.0_rk  !< tan(psi) [-]
      logical :: bilateral = .false.  !< the faces cannot part
   contains
      procedure :: add_share
      procedure :: divide
   end type contact_law_t

contains

   !> Whether the parameters are finite and not negative.
   elemental logical function is_valid(law)
      type(contact_law_t), intent(in) :: law

      associate (numbers => [law%friction, law%dilation])
         is_valid = all(numbers >= 0.0_rk .and. numbers <= huge(1.0_rk))
      end associate
   end function is_valid

   !> Whether two laws have the same parameters, bit for bit.
   elemental logical function is_same(law, other)
      type(contact_law_t), intent(in) :: law, other

      is_same = (law%bilateral .eqv. other%bilateral) &
                .and. .not. (abs(law%friction - other%friction) > 0.0_rk .or. &
                             abs(law%dilation - other%dilation) > 0.0_rk)
   end function is_same

   !> Add to the weighted sum of laws whose faces meet. The sum is bilateral or not from the start.
   pure subroutine add_share(self, law, share)
      class(contact_law_t), intent(inout) :: self
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: share  !< its weight [any unit]

      self%friction = self%friction + share*law%friction
      self%dilation = self%dilation + share*law%dilation
   end subroutine add_share

   !> The mean from the weighted sum.
   pure subroutine divide(self, total)
      class(contact_law_t), intent(inout) :: self
      real(rk), intent(in) :: total  !< of the weights [unit of the shares]

      self%friction = self%friction/total
      self%dilation = self%dilation/total
   end subroutine divide

   !> Normal and tangential equation with their derivatives.
   !!
   !! A point that slipped one way in the last iteration and would slip the other way now is tried
   !! as sticking: without this the iteration may go to and fro between the two.
   pure subroutine contact_equations(law, stiffness, traction, jump, slip_before, way, state, &
                                     residual, by_traction, by_jump)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< contact traction f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      integer(ik), intent(inout) :: way  !< of slip in this iteration: -1, 1, or 0 for none
      integer(ik), intent(out) :: state
      real(rk), intent(out) :: residual(2)  !< [Pa]
      real(rk), intent(out) :: by_traction(2, 2)  !< d residual_i / d traction_j [-]
      real(rk), intent(out) :: by_jump(2, 2)  !< d residual_i / d jump_j [Pa/m]
      real(rk) :: gap_slope, pressure, shear
      integer(ik) :: way_before
      logical :: has_slipped

      shear = traction(2) + stiffness*(jump(2) - slip_before)
      has_slipped = abs(jump(2)) > round_off*max(abs(slip_before), norm2(traction)/stiffness)
      gap_slope = law%dilation*sign(1.0_rk, merge(jump(2), shear, has_slipped))
      pressure = -traction(1) - stiffness*(jump(1) - gap_slope*jump(2))
      by_traction = 0.0_rk
      by_jump = 0.0_rk
      way_before = way
      way = 0
      if (.not. pressure > 0.0_rk .and. .not. law%bilateral) then
         state = state_open
         residual = traction
         by_traction(1, 1) = 1.0_rk
         by_traction(2, 2) = 1.0_rk
         return
      end if
      residual(1) = stiffness*(jump(1) - gap_slope*jump(2))
      by_jump(1, :) = stiffness*[1.0_rk, -gap_slope]
      if (.not. abs(shear) < law%friction*pressure) way = merge(1, -1, shear > 0.0_rk)
      if (.not. pressure > 0.0_rk) then
         if (abs(jump(2) - slip_before) > 0.0_rk) way = merge(1, -1, jump(2) > slip_before)
      else if (way*way_before < 0 .and. law%friction > 0.0_rk) then
         way = 0
      end if
      if (way == 0) then
         state = state_stick
         residual(2) = stiffness*(jump(2) - slip_before)
         by_jump(2, 2) = stiffness
      else
         state = state_slip
         residual(2) = traction(2) - law%friction*pressure*way
         by_traction(2, :) = [law%friction*way, 1.0_rk]
         by_jump(2, :) = law%friction*way*stiffness*[1.0_rk, -gap_slope]
      end if
   end subroutine contact_equations

   !> How far a point is from fulfilling the law [Pa]: gap, sign of the contact pressure, friction
   !! bound and direction of slip, each by itself and independent of the equations that Newton's
   !! method solves.
   pure function contact_residual(law, stiffness, traction, jump, slip_before) result(worst)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< contact traction f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      real(rk) :: worst  !< [Pa]

      real(rk) :: bound, opening, slip

      opening = jump(1) - law%dilation*abs(jump(2))
      slip = jump(2) - slip_before
      bound = law%friction*max(0.0_rk, -traction(1))
      if (law%bilateral .and. traction(1) > 0.0_rk) then
         bound = law%friction*traction(1)
         worst = max(stiffness*abs(opening), &
                     min(abs(traction(2) + sign(bound, slip)), &
                         max(stiffness*abs(slip), abs(traction(2)) - bound)))
         if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) worst = huge(1.0_rk)
         return
      end if
      worst = abs(traction(2)) - bound
      if (law%bilateral) then
         worst = max(worst, stiffness*abs(opening))
      else
         worst = max(worst, -stiffness*opening, traction(1), &
                     min(stiffness*abs(opening), abs(traction(1))))
      end if
      worst = max(worst, min(stiffness*abs(slip), abs(abs(traction(2)) - bound)))
      ! Friction must not drive the slip.
      worst = max(worst, min(stiffness*abs(slip), max(0.0_rk, -traction(2)*sign(1.0_rk, slip))))
      ! max() passes over what is not a number.
      if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) worst = huge(1.0_rk)
   end function contact_residual

end module contact_law
