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

   public :: coefficients, external_t, find_direction, limited, limited_terms, link_t

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

   !> What the limited temperatures add to the upwind flow along fractures [W/m].
   pure function limited_terms(links, externals, first_cell, first_joint, temperature) &
      & result(added)
      type(link_t), intent(in) :: links(:)
      type(external_t), intent(in) :: externals(:)
      integer(ik), intent(in) :: first_cell, first_joint  !< unknowns of fracture cells, joints
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk) :: added(size(temperature))
      real(rk) :: ahead, passed
      real(rk), dimension(2, size(temperature)) :: beyond, into
      integer(ik) :: k, next, own

      added = 0.0_rk
      if (.not. any(links%is_limited)) return
      into = 0.0_rk
      beyond = 0.0_rk
      do k = 1, size(links, kind=ik)
         associate (link => links(k))
            if (.not. link%is_limited) cycle
            call find_direction(link, own, next)
            into(:, next) = into(:, next) + abs(link%flow)*[1.0_rk, temperature(own)]
            beyond(:, own) = beyond(:, own) + abs(link%flow)*[1.0_rk, temperature(next)]
         end associate
      end do
      do k = 1, size(externals, kind=ik)
         associate (external => externals(k))
            if (external%unknown < first_cell .or. external%flow < 0.0_rk) cycle
            into(:, external%unknown) = into(:, external%unknown) &
                                        + external%flow*[1.0_rk, external%temperature]
         end associate
      end do
      do k = 1, size(links, kind=ik)
         associate (link => links(k))
            if (.not. link%is_limited) cycle
            call find_direction(link, own, next)
            if (own >= first_joint .or. .not. into(1, own) > 0.0_rk) cycle
            associate (before => into(2, own)/into(1, own), here => temperature(own))
               ahead = temperature(next)
               if (next >= first_joint) then
                  ! The cells behind the joint; at an outlet the temperature goes on as before.
                  ahead = 2.0_rk*here - before
                  if (beyond(1, next) > 0.0_rk) ahead = beyond(2, next)/beyond(1, next)
               end if
               passed = abs(link%flow)*limited(before, here, ahead)
            end associate
            added([own, next]) = added([own, next]) + passed*[-1.0_rk, 1.0_rk]
         end associate
      end do
   end function limited_terms

   !> The unknown that a link takes fluid from, and the other one.
   pure subroutine find_direction(link, own, next)
      type(link_t), intent(in) :: link
      integer(ik), intent(out) :: own, next

      own = link%ends(merge(1, 2, link%flow >= 0.0_rk))
      next = sum(link%ends) - own
   end subroutine find_direction

end module heat_links
