!> Law of a fracture at one point: Coulomb friction with weakening, shear dilation, closure under
!! pressure, and a bond. Contact without these is the special case of zero parameters.
!!
!! Signs: contact_point. [u]_n is the normal jump, [u]_tau the slip, f_n and f_tau the contact
!! traction.
!!
!! Dilation: the gap g = tan(psi) |[u]_tau|, up to a slip at which dilation ends.
!!
!! Slip weakening (Ida 1972; Palmer and Rice 1973): friction falls linearly with the slip path D,
!!   mu(D) = mu_s - (mu_s - mu_r) min(1, D/D_c)
!! `aged` gives the law after a slip path; the slip of the present step weakens it further.
!!
!! Closure of joints (Bandis, Lumsden and Barton 1983): under a pressure s = -f_n the faces close by
!!   d(s) = s/(k_ni + s/d_max),   that is   s = k_ni d/(1 - d/d_max).
!! As a function of s, closure has no pole and is concave; for s < 0 it is continued linearly. As a
!! function of d, Newton's method would leave d < d_max. Jumps count from faces with the closure
!! d_rest: with a stress in situ, the faces fit each other under that stress.
!!
!! Bond: until it is broken it bears a tension T b and, besides friction, a shear C b. b falls
!! permanently from 1 to 0 with the slip path D and the largest opening W:
!!   b = max(0, 1 - D/D_c - W/W_c),   f_n <= T b,   |f_tau| <= max(0, C b - mu_s f_n)
!! (a cohesive crack, initially rigid: Hillerborg 1976; Camacho and Ortiz 1996). Faces at a distance
!! w bear f_n = T b(w); if the largest opening W is greater, f_n falls linearly with w to zero.
!! Opening takes the energy T W_c/2 and shear C D_c/2 [J/m2], each once.
!!
!! If `wears` is false, mu and b are constant within the step (contact_newton).
!!
!! A bilateral law has no open state: the faces keep the gap g under tension too, and f_tau = mu_s z
!! sign(d[u]_tau) holds for negative z. It is the model of reference solutions for cracks that are
!! closed everywhere. Since friction under tension drives the slip, it is valid only where tension
!! is confined to small zones.
module contact_law
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: contact_law_t, is_same, is_valid, state_name, state_open, state_slip, state_stick
   public :: strength_t

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
      procedure :: joint_pressure
      procedure :: spring
      procedure :: apart
      procedure :: is_bonded
      procedure :: bond_left
      procedure :: strength
      procedure :: as_grown
      procedure :: weaken
      procedure, private :: numbers
      procedure, private :: set_numbers
   end type contact_law_t

   integer, parameter :: n_numbers = 12  !< of a law, but for its age

   !> Share of the opening that breaks a bond, below which the faces count as not opened: an opening
   !! of the size of rounding errors has no stiffness.
   real(rk), parameter :: hardly_open = 1.0e-6_rk

   !> Strength of a bond at the distance w of the faces, after the slip of the step.
   type :: strength_t
      real(rk) :: tension = 0.0_rk, cohesion = 0.0_rk  !< [Pa]
      real(rk) :: tension_by(2) = 0.0_rk  !< by w, and by the size of the slip [Pa/m]
      real(rk) :: cohesion_by(2) = 0.0_rk  !< the same
   end type strength_t

   integer(ik), parameter :: state_stick = 0  !< the faces touch and hold
   integer(ik), parameter :: state_slip = 1  !< the faces touch and slide
   integer(ik), parameter :: state_open = 2  !< the faces do not touch

contains

   !> The parameters of a law as an array, from which means are made.
   pure function numbers(self)
      class(contact_law_t), intent(in) :: self
      real(rk) :: numbers(n_numbers)

      numbers = [self%friction, self%dilation, self%weakening, self%weakening_slip, &
                 self%dilation_end, self%compliance, self%closure_end, self%closure_at_rest, &
                 self%tension, self%cohesion, self%wear_by_slip, self%wear_by_opening]
   end function numbers

   !> Set the parameters of a law.
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

   !> Add to the weighted sum of laws of faces that meet; `bilateral` is unchanged.
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

   !> Whether the law depends on the history of the faces.
   elemental logical function ages(self)
      class(contact_law_t), intent(in) :: self

      ages = self%weakening > 0.0_rk .or. self%is_bonded()
   end function ages

   !> The law of a point after a slip path and a largest opening.
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

   !> The law of new faces that grow from a fracture with this law: without bond, and fitting each
   !! other.
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

   !> Gap of dilation at a slip, and its derivative by the slip.
   pure subroutine dilated(self, slip, slip_sign, gap, slope)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: slip  !< [u]_tau [m]
      real(rk), intent(in) :: slip_sign  !< 1 or -1; without slip, the sign of the trial shear
      real(rk), intent(out) :: gap  !< [m]
      real(rk), intent(out) :: slope  !< [-]

      slope = self%dilation*slip_sign
      gap = slope*slip
      if (abs(slip)*self%dilation_end > 1.0_rk) then
         gap = self%dilation/self%dilation_end
         slope = 0.0_rk
      end if
   end subroutine dilated

   !> Closure under a pressure, less d_rest, and its derivative; linear under tension.
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

   !> Pressure s between the faces of a joint that closes, from their jump: the inverse of
   !! `closure`. Zero where the faces are apart, and for laws without closure.
   pure real(rk) function joint_pressure(self, jump) result(pressure)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk) :: closed, gap, slope

      pressure = 0.0_rk
      call self%dilated(jump(2), sign(1.0_rk, jump(2)), gap, slope)
      closed = gap - jump(1) + self%closure_at_rest
      if (.not. (self%compliance > 0.0_rk .and. closed > 0.0_rk)) return
      if (.not. closed*self%closure_end < 1.0_rk) return  ! the law has a pole there
      pressure = closed/(self%compliance*(1.0_rk - closed*self%closure_end))
   end function joint_pressure

   !> Factor of the normal equation: c in series with the stiffness of the joint [Pa/m].
   elemental real(rk) function spring(self, stiffness)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: stiffness  !< c [Pa/m]

      spring = stiffness/(1.0_rk + stiffness*self%compliance)
   end function spring

   !> Distance w of the faces from contact under their traction [m].
   pure real(rk) function apart(self, traction, jump)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk) :: closed, gap, slope

      call self%dilated(jump(2), sign(1.0_rk, jump(2)), gap, slope)
      call self%closure(-traction(1), closed, slope)
      apart = jump(1) - gap + closed
   end function apart

   !> Whether the bond is not broken.
   elemental logical function is_bonded(self)
      class(contact_law_t), intent(in) :: self

      is_bonded = self%bond > 0.0_rk .and. (self%tension > 0.0_rk .or. self%cohesion > 0.0_rk)
   end function is_bonded

   !> Remaining share b of the bond [-].
   elemental real(rk) function bond_left(self, apart, slip) result(bond)
      class(contact_law_t), intent(in) :: self
      real(rk), intent(in) :: apart  !< w [m]
      real(rk), intent(in) :: slip  !< of the step [m]

      bond = self%bond
      if (self%wears) bond = max(0.0_rk, bond - self%wear_by_slip*abs(slip) - &
                                 self%wear_by_opening*max(0.0_rk, apart - self%opened))
   end function bond_left

   !> Reduce the strength of a law that is constant within the step to that after the slip and
   !! opening of the step. The strength never increases.
   pure subroutine weaken(self, held, traction, jump, slip, lost)
      class(contact_law_t), intent(in) :: self  !< law at the start of the step
      type(contact_law_t), intent(inout) :: held  !< law of constant strength
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip  !< of the step [m]
      real(rk), intent(out) :: lost  !< decrease of strength [Pa]
      type(contact_law_t) :: last
      real(rk) :: slope

      last = held
      held = self
      held%wears = .false.
      call self%friction_at(slip, held%friction, slope)
      held%friction = min(held%friction, last%friction)
      held%bond = min(self%bond_left(self%apart(traction, jump), slip), last%bond)
      lost = (last%friction - held%friction)*max(0.0_rk, -traction(1)) &
             + (last%bond - held%bond)*max(self%tension, self%cohesion)
   end subroutine weaken

   !> Strength of the bond, and its derivatives.
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
