!> Strength that is held within a step, and falls from one solution to the next: see contact_newton.
module contact_wear
   use base_kinds, only: rk
   use contact_law, only: contact_law_t
   implicit none(type, external)
   private

   public :: weaken

contains

   !> Let a held law become as weak as what the faces have slipped and opened in the step leaves it;
   !! it never becomes stronger again.
   pure subroutine weaken(law, traction, jump, slip, held, lost)
      type(contact_law_t), intent(in) :: law  !< at the start of the step
      real(rk), intent(in) :: traction(2)  !< f_n, f_tau [Pa]
      real(rk), intent(in) :: jump(2)  !< [u]_n, [u]_tau [m]
      real(rk), intent(in) :: slip  !< of the step [m]
      type(contact_law_t), intent(inout) :: held  !< law whose strength does not change
      real(rk), intent(out) :: lost  !< strength [Pa]
      type(contact_law_t) :: last
      real(rk) :: slope

      last = held
      held = law
      held%wears = .false.
      call law%friction_at(slip, held%friction, slope)
      held%friction = min(held%friction, last%friction)
      held%bond = min(law%bond_left(law%apart(traction, jump), slip), last%bond)
      lost = (last%friction - held%friction)*max(0.0_rk, -traction(1)) &
             + (last%bond - held%bond)*max(law%tension, law%cohesion)
   end subroutine weaken

end module contact_wear
