!> What the scene says of a fracture's faces, as the law of contact takes it.
module simulation_laws
   use base_kinds, only: rk
   use contact_law, only: contact_law_t
   use scene_types, only: fracture_t
   implicit none(type, external)
   private

   public :: law_of_fracture

contains

   !> The law where the faces touch; what the scene holds closed is bilateral besides.
   elemental type(contact_law_t) function law_of_fracture(fracture) result(law)
      type(fracture_t), intent(in) :: fracture

      law%friction = fracture%friction
      law%dilation = tan(fracture%dilation)
      if (fracture%weakening_slip > 0.0_rk) then
         law%weakening_slip = fracture%weakening_slip
         law%weakening = (fracture%friction - fracture%friction_residual)/fracture%weakening_slip
      end if
      if (fracture%normal_stiffness > 0.0_rk) then
         law%compliance = 1.0_rk/fracture%normal_stiffness
         law%closure_end = 1.0_rk/fracture%closure
      end if
      law%cohesion = fracture%cohesion
      law%tension = fracture%tensile_strength
      if (fracture%weakening_slip > 0.0_rk) law%wear_by_slip = 1.0_rk/fracture%weakening_slip
      if (fracture%opening_weakening > 0.0_rk) then
         law%wear_by_opening = 1.0_rk/fracture%opening_weakening
      end if
      if (fracture%dilation_slip < huge(1.0_rk)) law%dilation_end = 1.0_rk/fracture%dilation_slip
   end function law_of_fracture

end module simulation_laws
