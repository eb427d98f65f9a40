!> Contact at one point of a fracture: the equations of its law (contact_law) for Newton's method.
!!
!! Complementarity functions of a primal-dual active set (Hueeber and Wohlmuth 2005; docs/theory.md)
!! in scalar form, each divided by its positive factor so that it is a stress [Pa] or, times the
!! stiffness c, a displacement. With the trial pressure z = -f_n - c ([u]_n - g) and the trial shear
!! q = f_tau + c d[u]_tau:
!!   open   z <= 0:             f_n = 0,               f_tau = 0
!!   stick  |q| < mu_s z:       c ([u]_n - g) = 0,     c d[u]_tau = 0
!!   slip   |q| >= mu_s z > 0:  c ([u]_n - g) = 0,     f_tau - mu_s z sign(q) = 0
!! Without slip, the gap g of dilation increases in the direction of the trial shear. A slip of the
!! size of rounding errors counts as zero: with its sign, the gap might decrease, and the point
!! could only return in every iteration.
!!
!! With closure, [u]_n - g + d(s) replaces [u]_n - g. The equation is multiplied by the stiffness of
!! two springs in series, 1/(1/c + 1/k_ni), so that it has the size of -f_n where states change.
!!
!! Signs: sigma n = f - p_F n with n from side + to side - makes f the traction on side +, while the
!! jump is u(-) - u(+). Friction pulls side + along with side -, so f_tau has the sign of the slip
!! increment; it opposes the slip on side -, where the traction is -f. (The thesis writes -f_tau for
!! f_tau, as for a traction on side -; with sigma n as above, friction would then do positive work.)
module contact_point
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: round_off
   use contact_law, only: contact_law_t, state_open, state_slip, state_stick, strength_t
   implicit none(type, external)
   private

   public :: contact_equations, contact_equations_t, contact_residual

   !> Relative position of the faces at a point, and the terms of the law there.
   type :: faces_t
      real(rk) :: slip = 0.0_rk  !< of the step [m]
      real(rk) :: shear = 0.0_rk  !< trial shear q [Pa]
      real(rk) :: apart = 0.0_rk  !< w [m]
      real(rk) :: apart_by(3) = 0.0_rk  !< its derivatives by f_n, [u]_n, [u]_tau [m/Pa], [-]
      real(rk) :: friction = 0.0_rk  !< [-]
      real(rk) :: friction_by_slip = 0.0_rk  !< by the size of the slip [1/m]
      real(rk) :: spring = 0.0_rk  !< what multiplies the normal equation [Pa/m]
   end type faces_t

   !> Normal and tangential equation of a point.
   type :: contact_equations_t
      integer(ik) :: state = -1  !< of contact
      real(rk) :: residual(2) = 0.0_rk  !< [Pa]
      real(rk) :: by_traction(2, 2) = 0.0_rk  !< d residual_i / d traction_j [-]
      real(rk) :: by_jump(2, 2) = 0.0_rk  !< d residual_i / d jump_j [Pa/m]
   end type contact_equations_t

contains

   !> Normal and tangential equation with their derivatives.
   !!
   !! A point whose direction of slip differs from that of the last iteration is set to stick:
   !! otherwise the iteration may alternate between the two directions.
   pure subroutine contact_equations(law, stiffness, traction, jump, slip_before, slip_sign, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< contact traction f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      integer(ik), intent(inout) :: slip_sign  !< of this iteration: -1, 1, or 0 for no slip
      type(contact_equations_t), intent(out) :: found
      type(faces_t) :: faces

      faces = faces_at(law, stiffness, traction, jump, slip_before)
      if (law%is_bonded()) then
         call bonded_equations(law, stiffness, traction, faces, slip_sign, found)
      else
         call unbonded_equations(law, stiffness, traction, faces, slip_sign, found)
      end if
   end subroutine contact_equations

   !> The faces at a traction and jump.
   pure type(faces_t) function faces_at(law, stiffness, traction, jump, slip_before) result(faces)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      real(rk) :: closed, closing, gap, gap_slope
      logical :: has_slipped

      faces%slip = jump(2) - slip_before
      faces%shear = traction(2) + stiffness*faces%slip
      has_slipped = abs(jump(2)) > round_off*max(abs(slip_before), norm2(traction)/stiffness)
      call law%dilated(jump(2), sign(1.0_rk, merge(jump(2), faces%shear, has_slipped)), gap, &
                       gap_slope)
      call law%friction_at(faces%slip, faces%friction, faces%friction_by_slip)
      call law%closure(-traction(1), closed, closing)
      faces%spring = law%spring(stiffness)
      faces%apart = jump(1) - gap + closed
      faces%apart_by = [-closing, 1.0_rk, -gap_slope]
   end function faces_at

   !> The equations where no bond holds.
   pure subroutine unbonded_equations(law, stiffness, traction, faces, slip_sign, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      type(faces_t), intent(in) :: faces
      integer(ik), intent(inout) :: slip_sign  !< of this iteration: -1, 1, or 0 for no slip
      type(contact_equations_t), intent(inout) :: found  !< derivatives are zero at first
      real(rk) :: pressure
      integer(ik) :: sign_before

      associate (spring => faces%spring, friction => faces%friction, slip => faces%slip)
         pressure = -traction(1) - spring*faces%apart
         sign_before = slip_sign
         slip_sign = 0
         if (.not. pressure > 0.0_rk .and. .not. law%bilateral) then
            found%state = state_open
            found%residual = traction
            found%by_traction(1, 1) = 1.0_rk
            found%by_traction(2, 2) = 1.0_rk
            return
         end if
         call touch(faces, found)
      if (.not. abs(faces%shear) < friction*pressure) slip_sign = merge(1, -1, faces%shear > 0.0_rk)
         if (.not. pressure > 0.0_rk) then
            if (abs(slip) > 0.0_rk) slip_sign = merge(1, -1, slip > 0.0_rk)
         else if (slip_sign*sign_before < 0 .and. friction > 0.0_rk) then
            slip_sign = 0
         end if
         if (slip_sign == 0) then
            call stick(stiffness, slip, found)
            return
         end if
         found%state = state_slip
         found%residual(2) = traction(2) - friction*pressure*slip_sign
         found%by_traction(2, :) = [friction*slip_sign*(1.0_rk + spring*faces%apart_by(1)), 1.0_rk]
         found%by_jump(2, :) = friction*slip_sign*spring*faces%apart_by(2:)
         found%by_jump(2, 2) = found%by_jump(2, 2) - slip_sign*sign_of_slip_at(slip, slip_sign) &
                               *faces%friction_by_slip*pressure
      end associate
   end subroutine unbonded_equations

   !> The normal equation of closed faces: w = 0.
   pure subroutine touch(faces, found)
      type(faces_t), intent(in) :: faces
      type(contact_equations_t), intent(inout) :: found

      found%residual(1) = faces%spring*faces%apart
      found%by_traction(1, 1) = faces%spring*faces%apart_by(1)
      found%by_jump(1, :) = faces%spring*faces%apart_by(2:)
   end subroutine touch

   !> The tangential equation of sticking faces: no slip.
   pure subroutine stick(stiffness, slip, found)
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: slip  !< of the step [m]
      type(contact_equations_t), intent(inout) :: found

      if (found%state /= state_open) found%state = state_stick
      found%residual(2) = stiffness*slip
      found%by_jump(2, 2) = stiffness
   end subroutine stick

   !> Sign of the slip of the step; without slip, the given sign.
   pure real(rk) function sign_of_slip_at(slip, slip_sign)
      real(rk), intent(in) :: slip  !< of the step [m]
      integer(ik), intent(in) :: slip_sign

      sign_of_slip_at = sign(1.0_rk, slip)
      if (.not. abs(slip) > 0.0_rk) sign_of_slip_at = real(slip_sign, rk)
   end function sign_of_slip_at

   !> The equations of bonded faces: closed up to the tension of the bond, and under this tension
   !! while they are apart.
   pure subroutine bonded_equations(law, stiffness, traction, faces, slip_sign, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      type(faces_t), intent(in) :: faces
      integer(ik), intent(inout) :: slip_sign  !< of this iteration: -1, 1, or 0 for no slip
      type(contact_equations_t), intent(inout) :: found  !< derivatives are zero at first
      type(strength_t) :: bond
      real(rk) :: bound, bound_by(3), pressure, sign_of_slip
      integer(ik) :: sign_before
      logical :: is_apart

      associate (spring => faces%spring, friction => faces%friction, apart_by => faces%apart_by)
         bond = law%strength(faces%apart, faces%slip)
         is_apart = .not. bond%tension - traction(1) - spring*faces%apart > 0.0_rk
         pressure = -traction(1)
         if (.not. is_apart) pressure = pressure - spring*faces%apart
         bound = bond%cohesion + friction*pressure
         sign_before = slip_sign
         slip_sign = 0
         if (.not. abs(faces%shear) < bound) slip_sign = merge(1, -1, faces%shear > 0.0_rk)
         if (slip_sign*sign_before < 0 .and. bound > 0.0_rk) slip_sign = 0
         sign_of_slip = sign_of_slip_at(faces%slip, slip_sign)
         found%state = merge(state_open, state_slip, is_apart)
         if (is_apart) then
            found%residual(1) = traction(1) - bond%tension
            found%by_traction(1, 1) = 1.0_rk - bond%tension_by(1)*apart_by(1)
            found%by_jump(1, :) = -bond%tension_by(1)*apart_by(2:)
            found%by_jump(1, 2) = found%by_jump(1, 2) - bond%tension_by(2)*sign_of_slip
         else
            call touch(faces, found)
         end if
         if (slip_sign == 0) then
            call stick(stiffness, faces%slip, found)
            return
         end if
         found%residual(2) = traction(2)
         found%by_traction(2, 2) = 1.0_rk
         if (.not. bound > 0.0_rk) return
         bound_by = bond%cohesion_by(1)*apart_by
         bound_by(1) = bound_by(1) - friction
         if (.not. is_apart) bound_by = bound_by - friction*spring*apart_by
         bound_by(3) = bound_by(3) &
                       + (bond%cohesion_by(2) + faces%friction_by_slip*pressure)*sign_of_slip
         found%residual(2) = traction(2) - bound*slip_sign
         found%by_traction(2, 1) = -bound_by(1)*slip_sign
         found%by_jump(2, :) = -bound_by(2:)*slip_sign
      end associate
   end subroutine bonded_equations

   !> Violation of the law at a point [Pa]: gap, sign of the contact pressure, friction bound and
   !! direction of slip, each separately and independent of the equations of Newton's method.
   pure function contact_residual(law, stiffness, traction, jump, slip_before) result(worst)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< contact traction f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      real(rk) :: worst  !< [Pa]

      real(rk) :: bound, friction, opening, slip, slope, spring
      type(strength_t) :: bond

      opening = law%apart(traction, jump)
      spring = law%spring(stiffness)
      slip = jump(2) - slip_before
      call law%friction_at(slip, friction, slope)
      bound = friction*max(0.0_rk, -traction(1))
      if (law%is_bonded()) then
         bond = law%strength(opening, slip)
         bound = max(0.0_rk, bond%cohesion - friction*traction(1))
      end if
      if (law%bilateral .and. traction(1) > 0.0_rk) then
         bound = friction*traction(1)
         worst = max(spring*abs(opening), &
                     min(abs(traction(2) + sign(bound, slip)), &
                         max(stiffness*abs(slip), abs(traction(2)) - bound)))
         if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) worst = huge(1.0_rk)
         return
      end if
      worst = abs(traction(2)) - bound
      if (law%bilateral) then
         worst = max(worst, spring*abs(opening))
      else
         worst = max(worst, -spring*opening, traction(1) - bond%tension, &
                     min(spring*abs(opening), abs(traction(1) - bond%tension)))
      end if
      worst = max(worst, min(stiffness*abs(slip), abs(abs(traction(2)) - bound)))
      ! Friction opposes the slip.
      worst = max(worst, min(stiffness*abs(slip), max(0.0_rk, -traction(2)*sign(1.0_rk, slip))))
      ! max() ignores NaN.
      if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) worst = huge(1.0_rk)
   end function contact_residual

end module contact_point
