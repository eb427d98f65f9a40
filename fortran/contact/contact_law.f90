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
!! Joints close under pressure (Bandis, Lumsden and Barton 1983): pressed with s = -f_n their faces
!! come nearer than where they touch, by
!!   d(s) = s/(k_ni + s/d_max),   that is   s = k_ni d/(1 - d/d_max),
!! so a closed point has [u]_n - g + d(s) = 0 in place of [u]_n - g = 0, and open ones are as ever,
!! for d(0) = 0. In s the law has no pole and is concave, linear under tension; in d Newton's method
!! would leave d < d_max. Its equation is multiplied by that of two springs in a row,
!! 1/(1/c + 1/k_ni) in place of c, with which it has the size of -f_n where states change. What
!! closure the faces have where jumps count from, d_rest, is taken off: those of a scene with a
!! stress in situ fit each other under that.
!! A bond holds faces together until it is broken: they bear a tension T b and a shear of C b beside
!! friction, where b falls from 1 to 0 for good, with the path of slip and with the largest opening,
!!   b = max(0, 1 - D/D_c - W/W_c),   f_n <= T b,   |f_tau| <= max(0, C b - mu_s f_n)
!! (a cohesive crack, initially rigid: Hillerborg 1976; Camacho and Ortiz 1996). Faces apart by w
!! bear f_n = T b(w); where they were farther apart before, by W, this falls with w to zero, so that
!! opening takes the energy T W_c/2 and shear C D_c/2 [J/m2], each once. In a law that does not
!! `wear` within the step mu and b stand still: contact_newton looks for solutions from there.
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
!!
!! The contact state of a fracture cell, in one numbering for all rooms and files.
module contact_law
   use base_kinds, only: ik, rk
   use base_tolerances, only: round_off
   implicit none(type, external)
   private

   public :: contact_equations, contact_equations_t, contact_law_t, contact_residual, is_same
   public :: is_valid, state_name, state_open, state_slip, state_stick

   !> Parameters of the law.
   type :: contact_law_t
      real(rk) :: friction = 0.0_rk  !< mu_s [-]
      real(rk) :: dilation = 0.0_rk  !< tan(psi) [-]
      logical :: bilateral = .false.  !< the faces cannot part
      real(rk) :: weakening = 0.0_rk  !< what friction loses per slip, (mu_s - mu_r)/D_c [1/m]
      real(rk) :: weakening_slip = 0.0_rk  !< in which it does, D_c or what is left of it [m]
      real(rk) :: dilation_end = 0.0_rk  !< 1 over the slip at which dilation ends; 0: never [1/m]
      real(rk) :: compliance = 0.0_rk  !< 1/k_ni; 0: the faces do not close further [m/Pa]
      real(rk) :: closure_end = 0.0_rk  !< 1/d_max [1/m]
      real(rk) :: closure_at_rest = 0.0_rk  !< d_rest, of faces without jumps [m]
      real(rk) :: tension = 0.0_rk  !< T [Pa]
      real(rk) :: cohesion = 0.0_rk  !< C [Pa]
      real(rk) :: wear_by_slip = 0.0_rk  !< 1/D_c, of the bond [1/m]
      real(rk) :: wear_by_opening = 0.0_rk  !< 1/W_c [1/m]
      real(rk) :: bond = 1.0_rk  !< b [-]
      real(rk) :: opened = 0.0_rk  !< W, how far the faces have been apart so far [m]
      logical :: wears = .true.  !< mu and b fall within the step
   contains
      procedure :: add_share
      procedure :: divide
      procedure :: ages
      procedure :: aged
      procedure :: friction_at
      procedure :: dilated
      procedure :: closure
      procedure :: spring
      procedure :: apart
      procedure :: is_bonded
      procedure :: bond_left
      procedure :: strength
      procedure :: as_grown
      procedure, private :: numbers
      procedure, private :: set_numbers
   end type contact_law_t

   integer, parameter :: n_numbers = 12  !< of a law, but for its age

   !> Of the opening that breaks a bond: so far it closes as if it had not opened, for what rounding
   !! has left of an opening that is none has no stiffness.
   real(rk), parameter :: hardly_open = 1.0e-6_rk

   !> What a bond bears where its faces are apart by w and have slipped in the step.
   type :: strength_t
      real(rk) :: tension = 0.0_rk, cohesion = 0.0_rk  !< [Pa]
      real(rk) :: tension_by(2) = 0.0_rk  !< by w, and by the size of the slip [Pa/m]
      real(rk) :: cohesion_by(2) = 0.0_rk  !< the same
   end type strength_t

   !> The faces at a point as they are to each other, and what the law makes of it.
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

   integer(ik), parameter :: state_stick = 0  !< the faces touch and hold
   integer(ik), parameter :: state_slip = 1  !< the faces touch and slide
   integer(ik), parameter :: state_open = 2  !< the faces do not touch

contains

   !> The numbers of a law, of which means are made.
   pure function numbers(self)
      class(contact_law_t), intent(in) :: self
      real(rk) :: numbers(n_numbers)

      numbers = [self%friction, self%dilation, self%weakening, self%weakening_slip, &
                 self%dilation_end, self%compliance, self%closure_end, self%closure_at_rest, &
                 self%tension, self%cohesion, self%wear_by_slip, self%wear_by_opening]
   end function numbers

   !> Give a law these numbers.
   pure subroutine set_numbers(self, numbers)
      class(contact_law_t), intent(inout) :: self
      real(rk), intent(in) :: numbers(n_numbers)

      self%friction = numbers(1)
      self%dilation = numbers(2)
      self%weakening = numbers(3)
      self%weakening_slip = numbers(4)
      self%dilation_end = numbers(5)
      self%compliance = numbers(6)
      self%closure_end = numbers(7)
      self%closure_at_rest = numbers(8)
      self%tension = numbers(9)
      self%cohesion = numbers(10)
      self%wear_by_slip = numbers(11)
      self%wear_by_opening = numbers(12)
   end subroutine set_numbers

   !> Whether the parameters are finite and not negative.
   elemental logical function is_valid(law)
      type(contact_law_t), intent(in) :: law

      associate (numbers => [law%numbers(), law%bond, law%opened])
         is_valid = all(numbers >= 0.0_rk .and. numbers <= huge(1.0_rk))
      end associate
   end function is_valid

   !> Whether two laws have the same parameters, bit for bit.
   elemental logical function is_same(law, other)
      type(contact_law_t), intent(in) :: law, other

      is_same = (law%bilateral .eqv. other%bilateral) &
                .and. .not. any(abs([law%numbers(), law%bond, law%opened] &
                                    - [other%numbers(), other%bond, other%opened]) > 0.0_rk)
   end function is_same

   !> Add to the weighted sum of laws whose faces meet. The sum is bilateral or not from the start.
   pure subroutine add_share(self, law, share)
      class(contact_law_t), intent(inout) :: self
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: share  !< its weight [any unit]

      call self%set_numbers(self%numbers() + share*law%numbers())
   end subroutine add_share

   !> The mean from the weighted sum.
   pure subroutine divide(self, total)
      class(contact_law_t), intent(inout) :: self
      real(rk), intent(in) :: total  !< of the weights [unit of the shares]

      call self%set_numbers(self%numbers()/total)
   end subroutine divide

   !> What the faces have been through changes the law.
   elemental logical function ages(self)
      class(contact_law_t), intent(in) :: self

      ages = self%weakening > 0.0_rk .or. self%is_bonded()
   end function ages

   !> The law of a point that has slipped along a path so far, and been open so far.
   elemental type(contact_law_t) function aged(self, path, opened) result(law)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: path  !< [m]
      real(rk), intent(in) :: opened  !< [m]

      law = self
      law%friction = self%friction - self%weakening*min(path, self%weakening_slip)
      law%weakening_slip = max(0.0_rk, self%weakening_slip - path)
      law%bond = max(0.0_rk, self%bond - self%wear_by_slip*path - self%wear_by_opening*opened)
      law%opened = 0.0_rk
      if (opened*self%wear_by_opening > hardly_open) law%opened = opened
   end function aged

   !> The law of faces that have grown from these: they are broken, and fit each other.
   elemental type(contact_law_t) function as_grown(self) result(law)
      class(contact_law_t), intent(in) :: self

      law = self
      law%compliance = 0.0_rk
      law%closure_at_rest = 0.0_rk
      law%tension = 0.0_rk
      law%cohesion = 0.0_rk
   end function as_grown

   !> Friction after a further slip, and its derivative by that slip's size.
   pure subroutine friction_at(self, slip, friction, slope)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: slip  !< of the step [m]
      real(rk), intent(out) :: friction  !< [-]
      real(rk), intent(out) :: slope  !< [1/m]

      friction = self%friction
      slope = 0.0_rk
      if (.not. self%wears) return
      friction = friction - self%weakening*min(abs(slip), self%weakening_slip)
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

   !> How far pressed faces come nearer than where they touch, and its derivative; linear where the
   !! pressure is tension.
   elemental subroutine closure(self, pressure, closed, slope)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< s [Pa]
      real(rk), intent(out) :: closed  !< d - d_rest [m]
      real(rk), intent(out) :: slope  !< [m/Pa]
      real(rk) :: stiffer

      stiffer = 1.0_rk/(1.0_rk + self%compliance*self%closure_end*max(0.0_rk, pressure))
      closed = self%compliance*pressure*stiffer - self%closure_at_rest
      slope = self%compliance*stiffer**2
   end subroutine closure

   !> What multiplies the normal equation: c, in a row with the joint's own stiffness [Pa/m].
   elemental real(rk) function spring(self, stiffness)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: stiffness  !< c [Pa/m]

      spring = stiffness/(1.0_rk + stiffness*self%compliance)
   end function spring

   !> How far the faces are apart beyond what they are when they touch under their traction: w [m].
   pure real(rk) function apart(self, traction, jump)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk) :: closed, gap, slope

      call self%dilated(jump(2), sign(1.0_rk, jump(2)), gap, slope)
      call self%closure(-traction(1), closed, slope)
      apart = jump(1) - gap + closed
   end function apart

   !> Something of a bond is left.
   elemental logical function is_bonded(self)
      class(contact_law_t), intent(in) :: self

      is_bonded = self%bond > 0.0_rk .and. (self%tension > 0.0_rk .or. self%cohesion > 0.0_rk)
   end function is_bonded

   !> What is left of a bond: b [-].
   elemental real(rk) function bond_left(self, apart, slip) result(bond)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: apart  !< w [m]
      real(rk), intent(in) :: slip  !< of the step [m]

      bond = self%bond
      if (self%wears) bond = max(0.0_rk, bond - self%wear_by_slip*abs(slip) - &
                                 self%wear_by_opening*max(0.0_rk, apart - self%opened))
   end function bond_left

   !> What the bond bears.
   pure type(strength_t) function strength(self, apart, slip) result(found)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: apart  !< w [m]
      real(rk), intent(in) :: slip  !< of the step [m]
      real(rk) :: bond, bond_by(2)

      bond = self%bond_left(apart, slip)
      bond_by = 0.0_rk
      if (self%wears) then
         bond_by(2) = -self%wear_by_slip
         if (apart > self%opened) bond_by(1) = -self%wear_by_opening
      end if
      if (.not. bond > 0.0_rk) return
      found%cohesion = self%cohesion*bond
      found%cohesion_by = self%cohesion*bond_by
      found%tension = self%tension*bond
      found%tension_by = self%tension*bond_by
      if (.not. (self%opened > 0.0_rk .and. apart < self%opened)) return
      ! Closing again, to the origin.
      associate (share => max(0.0_rk, apart)/self%opened)
         found%tension = found%tension*share
         found%tension_by(2) = found%tension_by(2)*share
         if (apart > 0.0_rk) found%tension_by(1) = self%tension*bond/self%opened
      end associate
   end function strength

   !> Normal and tangential equation with their derivatives.
   !!
   !! A point that slipped one way in the last iteration and would slip the other way now is tried
   !! as sticking: without this the iteration may go to and fro between the two.
   pure subroutine contact_equations(law, stiffness, traction, jump, slip_before, way, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< contact traction f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip_before  !< [u]_tau at the last accepted time [m]
      integer(ik), intent(inout) :: way  !< of slip in this iteration: -1, 1, or 0 for none
      type(contact_equations_t), intent(out) :: found
      type(faces_t) :: faces

      faces = faces_at(law, stiffness, traction, jump, slip_before)
      if (law%is_bonded()) then
         call bonded_equations(law, stiffness, traction, faces, way, found)
      else
         call unbonded_equations(law, stiffness, traction, faces, way, found)
      end if
   end subroutine contact_equations

   !> How the faces are to each other at a traction and jump.
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
   pure subroutine unbonded_equations(law, stiffness, traction, faces, way, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      type(faces_t), intent(in) :: faces
      integer(ik), intent(inout) :: way  !< of slip in this iteration: -1, 1, or 0 for none
      type(contact_equations_t), intent(inout) :: found  !< derivatives are zero at first
      real(rk) :: pressure
      integer(ik) :: way_before

      associate (spring => faces%spring, friction => faces%friction, slip => faces%slip)
         pressure = -traction(1) - spring*faces%apart
         way_before = way
         way = 0
         if (.not. pressure > 0.0_rk .and. .not. law%bilateral) then
            found%state = state_open
            found%residual = traction
            found%by_traction(1, 1) = 1.0_rk
            found%by_traction(2, 2) = 1.0_rk
            return
         end if
         call touch(faces, found)
         if (.not. abs(faces%shear) < friction*pressure) way = merge(1, -1, faces%shear > 0.0_rk)
         if (.not. pressure > 0.0_rk) then
            if (abs(slip) > 0.0_rk) way = merge(1, -1, slip > 0.0_rk)
         else if (way*way_before < 0 .and. friction > 0.0_rk) then
            way = 0
         end if
         if (way == 0) then
            call stick(stiffness, slip, found)
            return
         end if
         found%state = state_slip
         found%residual(2) = traction(2) - friction*pressure*way
         found%by_traction(2, :) = [friction*way*(1.0_rk + spring*faces%apart_by(1)), 1.0_rk]
         found%by_jump(2, :) = friction*way*spring*faces%apart_by(2:)
         found%by_jump(2, 2) = found%by_jump(2, 2) - way*way_of_slip(slip, way) &
                               *faces%friction_by_slip*pressure
      end associate
   end subroutine unbonded_equations

   !> The normal equation of faces that touch: they are not apart.
   pure subroutine touch(faces, found)
      type(faces_t), intent(in) :: faces
      type(contact_equations_t), intent(inout) :: found

      found%residual(1) = faces%spring*faces%apart
      found%by_traction(1, 1) = faces%spring*faces%apart_by(1)
      found%by_jump(1, :) = faces%spring*faces%apart_by(2:)
   end subroutine touch

   !> The tangential equation of faces that hold: they do not slip.
   pure subroutine stick(stiffness, slip, found)
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: slip  !< of the step [m]
      type(contact_equations_t), intent(inout) :: found

      if (found%state /= state_open) found%state = state_stick
      found%residual(2) = stiffness*slip
      found%by_jump(2, 2) = stiffness
   end subroutine stick

   !> The slip of the step, or the one to come, has a way too.
   pure real(rk) function way_of_slip(slip, way)
      real(rk), intent(in) :: slip  !< of the step [m]
      integer(ik), intent(in) :: way

      way_of_slip = sign(1.0_rk, slip)
      if (.not. abs(slip) > 0.0_rk) way_of_slip = real(way, rk)
   end function way_of_slip

   !> The same where a bond holds: with its tension the faces are pressed on each other, and where
   !! they are apart it goes on pulling.
   pure subroutine bonded_equations(law, stiffness, traction, faces, way, found)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: stiffness  !< c [Pa/m]
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      type(faces_t), intent(in) :: faces
      integer(ik), intent(inout) :: way  !< of slip in this iteration: -1, 1, or 0 for none
      type(contact_equations_t), intent(inout) :: found  !< derivatives are zero at first
      type(strength_t) :: bond
      real(rk) :: bound, bound_by(3), pressure, sign_of_slip
      integer(ik) :: way_before
      logical :: is_apart

      associate (spring => faces%spring, friction => faces%friction, apart_by => faces%apart_by)
         bond = law%strength(faces%apart, faces%slip)
         is_apart = .not. bond%tension - traction(1) - spring*faces%apart > 0.0_rk
         pressure = -traction(1)
         if (.not. is_apart) pressure = pressure - spring*faces%apart
         bound = bond%cohesion + friction*pressure
         way_before = way
         way = 0
         if (.not. abs(faces%shear) < bound) way = merge(1, -1, faces%shear > 0.0_rk)
         if (way*way_before < 0 .and. bound > 0.0_rk) way = 0
         sign_of_slip = way_of_slip(faces%slip, way)
         found%state = merge(state_open, state_slip, is_apart)
         if (is_apart) then
            found%residual(1) = traction(1) - bond%tension
            found%by_traction(1, 1) = 1.0_rk - bond%tension_by(1)*apart_by(1)
            found%by_jump(1, :) = -bond%tension_by(1)*apart_by(2:)
            found%by_jump(1, 2) = found%by_jump(1, 2) - bond%tension_by(2)*sign_of_slip
         else
            call touch(faces, found)
         end if
         if (way == 0) then
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
         found%residual(2) = traction(2) - bound*way
         found%by_traction(2, 1) = -bound_by(1)*way
         found%by_jump(2, :) = -bound_by(2:)*way
      end associate
   end subroutine bonded_equations

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
      ! Friction must not drive the slip.
      worst = max(worst, min(stiffness*abs(slip), max(0.0_rk, -traction(2)*sign(1.0_rk, slip))))
      ! max() passes over what is not a number.
      if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) worst = huge(1.0_rk)
   end function contact_residual

   !> The word for a contact state.
   pure function state_name(state) result(name)
      integer(ik), intent(in) :: state
      character(len=:), allocatable :: name

      select case (state)
      case (state_stick)
         name = "stick"
      case (state_slip)
         name = "slip"
      case (state_open)
         name = "open"
      case default
         name = "unknown"
      end select
   end function state_name

end module contact_law
