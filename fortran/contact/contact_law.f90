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
!! The gap g = tan(psi) |[u]_tau|, up to a slip at which dilation ends; without slip it rises
!! whichever way the shear drives. What rounding has left of a slip that is none counts as none:
!! with its sign the gap would fall the other way, and a step could take the point nowhere but back,
!! again and again.
!! Friction may weaken with slip (slip weakening, Ida 1972; Palmer and Rice 1973), linearly with the
!! path D that the faces have slipped:
!!   mu(D) = mu_s - (mu_s - mu_r) min(1, D/D_c)
!! The law of a point is that of its path so far, `aged`; what it slips within the step weakens it
!! further.
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
      real(rk) :: weakening = 0.0_rk  !< what friction loses per slip, (mu_s - mu_r)/D_c [1/m]
      real(rk) :: weakening_slip = 0.0_rk  !< in which it does, D_c or what is left of it [m]
      real(rk) :: dilation_end = 0.0_rk  !< 1 over the slip at which dilation ends; 0: never [1/m]
   contains
      procedure :: add_share
      procedure :: divide
      procedure :: aged
      procedure :: friction_at
      procedure :: dilated
   end type contact_law_t

contains

   !> Whether the parameters are finite and not negative.
   elemental logical function is_valid(law)
      type(contact_law_t), intent(in) :: law

      associate (numbers => [law%friction, law%weakening, law%weakening_slip, law%dilation, &
                             law%dilation_end])
         is_valid = all(numbers >= 0.0_rk .and. numbers <= huge(1.0_rk))
      end associate
   end function is_valid

   !> Whether two laws have the same parameters, bit for bit.
   elemental logical function is_same(law, other)
      type(contact_law_t), intent(in) :: law, other

      is_same = (law%bilateral .eqv. other%bilateral) &
                .and. .not. (abs(law%friction - other%friction) > 0.0_rk .or. &
                             abs(law%weakening - other%weakening) > 0.0_rk .or. &
                             abs(law%weakening_slip - other%weakening_slip) > 0.0_rk .or. &
                             abs(law%dilation - other%dilation) > 0.0_rk .or. &
                             abs(law%dilation_end - other%dilation_end) > 0.0_rk)
   end function is_same

   !> Add to the weighted sum of laws whose faces meet. The sum is bilateral or not from the start.
   pure subroutine add_share(self, law, share)
      class(contact_law_t), intent(inout) :: self
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: share  !< its weight [any unit]

      self%friction = self%friction + share*law%friction
      self%weakening = self%weakening + share*law%weakening
      self%weakening_slip = self%weakening_slip + share*law%weakening_slip
      self%dilation = self%dilation + share*law%dilation
      self%dilation_end = self%dilation_end + share*law%dilation_end
   end subroutine add_share

   !> The mean from the weighted sum.
   pure subroutine divide(self, total)
      class(contact_law_t), intent(inout) :: self
      real(rk), intent(in) :: total  !< of the weights [unit of the shares]

      self%friction = self%friction/total
      self%weakening = self%weakening/total
      self%weakening_slip = self%weakening_slip/total
      self%dilation = self%dilation/total
      self%dilation_end = self%dilation_end/total
   end subroutine divide

   !> The law of a point that has slipped along a path so far.
   elemental type(contact_law_t) function aged(self, path) result(law)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: path  !< [m]

      law = self
      law%friction = self%friction - self%weakening*min(path, self%weakening_slip)
      law%weakening_slip = max(0.0_rk, self%weakening_slip - path)
   end function aged

   !> Friction after a further slip, and its derivative by that slip's size.
   pure subroutine friction_at(self, slip, friction, slope)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: slip  !< of the step [m]
      real(rk), intent(out) :: friction  !< [-]
      real(rk), intent(out) :: slope  !< [1/m]

      friction = self%friction - self%weakening*min(abs(slip), self%weakening_slip)
      slope = 0.0_rk
      if (abs(slip) < self%weakening_slip) slope = -self%weakening
   end subroutine friction_at

   !> The gap that a slip makes, and its derivative by the slip, whose sign it has from the way that
   !! the shear drives where there is none.
   pure subroutine dilated(self, slip, way, gap, slope)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: slip  !< [u]_tau [m]
      real(rk), intent(in) :: way  !< 1 or -1: the sign of the slip, or what it will have
      real(rk), intent(out) :: gap  !< [m]
      real(rk), intent(out) :: slope  !< [-]

      slope = self%dilation*way
      gap = slope*slip
      if (abs(slip)*self%dilation_end > 1.0_rk) then
         gap = self%dilation/self%dilation_end
         slope = 0.0_rk
      end if
   end subroutine dilated

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
      real(rk) :: by_slip, friction, gap, gap_slope, pressure, shear, slip_way
      integer(ik) :: way_before
      logical :: has_slipped

      shear = traction(2) + stiffness*(jump(2) - slip_before)
      has_slipped = abs(jump(2)) > round_off*max(abs(slip_before), norm2(traction)/stiffness)
      call law%dilated(jump(2), sign(1.0_rk, merge(jump(2), shear, has_slipped)), gap, gap_slope)
      call law%friction_at(jump(2) - slip_before, friction, by_slip)
      pressure = -traction(1) - stiffness*(jump(1) - gap)
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
      residual(1) = stiffness*(jump(1) - gap)
      by_jump(1, :) = stiffness*[1.0_rk, -gap_slope]
      if (.not. abs(shear) < friction*pressure) way = merge(1, -1, shear > 0.0_rk)
      if (.not. pressure > 0.0_rk) then
         if (abs(jump(2) - slip_before) > 0.0_rk) way = merge(1, -1, jump(2) > slip_before)
      else if (way*way_before < 0 .and. friction > 0.0_rk) then
         way = 0
      end if
      if (way == 0) then
         state = state_stick
         residual(2) = stiffness*(jump(2) - slip_before)
         by_jump(2, 2) = stiffness
      else
         state = state_slip
         residual(2) = traction(2) - friction*pressure*way
         by_traction(2, :) = [friction*way, 1.0_rk]
         by_jump(2, :) = friction*way*stiffness*[1.0_rk, -gap_slope]
         ! The slip of the step, or the one to come, has a way too.
         slip_way = sign(1.0_rk, jump(2) - slip_before)
         if (.not. abs(jump(2) - slip_before) > 0.0_rk) slip_way = real(way, rk)
         by_jump(2, 2) = by_jump(2, 2) - way*slip_way*by_slip*pressure
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

      real(rk) :: bound, friction, gap, opening, slip, slope

      call law%dilated(jump(2), sign(1.0_rk, jump(2)), gap, slope)
      opening = jump(1) - gap
      slip = jump(2) - slip_before
      call law%friction_at(slip, friction, slope)
      bound = friction*max(0.0_rk, -traction(1))
      if (law%bilateral .and. traction(1) > 0.0_rk) then
         bound = friction*traction(1)
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
