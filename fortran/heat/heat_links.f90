!> Heat that is conducted and carried by fluid between two temperatures, and the limited
!! reconstruction along fractures.
!!
!! Between two points with the conductance G and the flow f = C_f q from the first to the second,
!! the exact steady heat flow in one dimension is (Scharfetter and Gummel 1969)
!!   Q = G B(-f/G) T_1 - G B(f/G) T_2,  B(x) = x/(exp(x) - 1):
!! second order where conduction dominates, upwind where flow does, with coefficients that are never
!! negative. Without conduction (G = 0) it is the upwind flow.
!!
!! Along fractures, where little is conducted, the upwind flow alone smears over cells. There the
!! temperature at the end of a cell is T + psi(r) (T_next - T)/2, r = (T - T_in)/(T_next - T), with
!! the limiter of van Leer (1974), which keeps it between T and T_next.
module heat_links
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: coefficients, external_t, limited, link_t

   !> Two unknowns between which heat passes.
   type :: link_t
      integer(ik) :: ends(2) = 0
      real(rk) :: conductance = 0.0_rk  !< G [W/(m K)]
      logical :: conducts = .true.  !< else the multi-point fluxes conduct, and the flow is added
      logical :: is_limited = .false.  !< along a fracture: the end of the cell is reconstructed
      real(rk) :: flow = 0.0_rk  !< f from the first to the second [W/(m K)]
   end type link_t

   !> An unknown that heat enters or leaves from outside.
   type :: external_t
      integer(ik) :: unknown = 0
      integer(ik) :: well = 0  !< its number; 0: a side
      real(rk) :: conductance = 0.0_rk  !< G [W/(m K)]
      real(rk) :: flow = 0.0_rk  !< f into the body [W/(m K)]
      real(rk) :: temperature = 0.0_rk  !< outside [K]
   end type external_t

contains

   !> Coefficients a, b of the heat flow a T_1 - b T_2; a - b = f. Where the multi-point fluxes
   !! conduct, theirs is left out.
   pure function coefficients(conductance, flow, conducts) result(ab)
      real(rk), intent(in) :: conductance  !< G [W/(m K)]
      real(rk), intent(in) :: flow  !< f [W/(m K)]
      logical, intent(in) :: conducts
      real(rk) :: ab(2)  !< [W/(m K)]

      if (conductance > tiny(1.0_rk)*abs(flow)) then
         associate (peclet => flow/conductance)
            ab = conductance*[bernoulli(-peclet), bernoulli(peclet)]
         end associate
         if (.not. conducts) ab = ab - conductance
      else
         ab = [max(flow, 0.0_rk), max(-flow, 0.0_rk)]
      end if
   end function coefficients

   !> x/(exp(x) - 1).
   elemental real(rk) function bernoulli(x)
      real(rk), intent(in) :: x  !< [-]
      real(rk), parameter :: small = 1.0e-3_rk, large = 500.0_rk

      if (abs(x) < small) then
         bernoulli = 1.0_rk - 0.5_rk*x + x**2/12.0_rk
      else if (abs(x) > large) then
         bernoulli = max(-x, 0.0_rk)
      else
         bernoulli = x/(exp(x) - 1.0_rk)
      end if
   end function bernoulli

   !> Temperature at the end of a cell beyond that of the cell itself.
   pure real(rk) function limited(before, own, next) result(beyond)
      real(rk), intent(in) :: before, own, next  !< of what flows in, the cell, the next one [K]

      beyond = 0.0_rk
      associate (into => own - before, out => next - own)
         if (into*out > 0.0_rk) beyond = into*out/(into + out)
      end associate
   end function limited

end module heat_links
