!> Tips under a layer of fluid pressure that is thinner than a coarse cell.
!!
!! Windows take the rock's own pressure (coarse_own_pressure). Within sqrt(c t) of the faces the
!! pressure is that of the fluid. Where this distance is less than a cell there are two effects
!! (docs/theory.md):
!!   - the tip is drained where the surrounding rock is not. K of the window is too large by up to a
!!     fifth of 1 - F times K, F = (1 - nu_u)/(1 - nu). K_II of the body as one window exceeds the
!!     exact one, sqrt(F) times that of undrained rock, by a part of this that does not depend on
!!     the size of the cells. The corrected K_II is without it (drained_excess);
!!   - the layer presses the faces together. Where the coarse level has the layer K_I contains this
!!     (twolevel_back_stress). Where it does not, the stated error does: a difference dp between
!!     fluid and rock since the time t lowers K_I by
!!     (1 + F)/2 sqrt(2) eta/Gamma(5/4) dp (c t)^(1/4), eta = alpha G/(lambda + 2 G).
module twolevel_drained_tips
   use base_kinds, only: ik, rk
   use coarse_rock, only: rock_t
   use coarse_state, only: state_t
   use coarse_tip_drainage, only: pressure_of_face
   use mesh_types, only: mesh_t
   use twolevel_faces, only: coarse_values_t
   implicit none(type, external)
   private

   public :: drained_excess, layer_at_tip, layer_t, thin_layer_errors

   !> Data of the layer at the end of a fracture.
   type :: layer_t
      real(rk) :: cell = 0.0_rk  !< length of the coarse fracture cell at the tip [m]
      real(rk) :: diffusivity = 0.0_rk  !< c [m2/s]
      real(rk) :: drained_tip = 1.0_rk  !< F = (1 - nu_u)/(1 - nu) [-]
      real(rk) :: eta = 0.0_rk  !< poroelastic stress coefficient [-]
      !> pressure of the fluid minus the rock's own pressure at the faces [Pa]
      real(rk) :: jump = 0.0_rk
      logical :: is_known = .false.  !< the coarse level has the layer (coarse_layers)
   end type layer_t

   !> Error of K at a drained tip in undrained rock, over 1 - F times K, and of K_I of layers, over
   !! itself: verification/sudden_pressure [-].
   real(rk), parameter :: share_of_drained_tip = 0.2_rk, share_of_layer = 0.15_rk
   !> Excess of K_II of the body as one window, over 1 - F times K_II, and how it falls with
   !! x = sqrt(c t) over the cell: 1/(1 + 2.5 x + 4 x**2). Within 0.03 in 13 bodies with other
   !! directions, rocks and cells [-].
   real(rk), parameter :: excess_of_drained = 0.16_rk, falls(2) = [2.5_rk, 4.0_rk]

contains

   !> Layer at an end of a fracture; without effect if the fracture has no cells.
   pure function layer_at_tip(mesh, rock, state, values, fracture, end) result(layer)
      type(mesh_t), intent(in) :: mesh  !< coarse
      type(rock_t), intent(in) :: rock
      type(state_t), intent(in) :: state
      type(coarse_values_t), intent(in) :: values
      integer(ik), intent(in) :: fracture  !< number of the fracture in the network
      integer(ik), intent(in) :: end  !< 1: start of the polyline, 2: its end
      type(layer_t) :: layer
      integer(ik) :: at, cell, i, side
      real(rk) :: stiffness, undrained

      associate (here => mesh%fracture)
         if (end == 1) then
            at = minloc(here%cell_s(1, :), dim=1, mask=here%cell_fracture == fracture)
         else
            at = maxloc(here%cell_s(2, :), dim=1, mask=here%cell_fracture == fracture)
         end if
         if (at == 0) return
         layer%cell = here%cell_s(2, at) - here%cell_s(1, at)
         if (mesh%n_layers > 0) layer%is_known = any(mesh%face_layer(here%cell_faces(:, at)) > 0)
         cell = mesh%face_cells(1, here%cell_faces(1, at))
         layer%jump = state%pressure(at) &
                      - 0.5_rk*sum([(pressure_of_face(values%drained, mesh, values%nodal(3, :), &
                                                      here%cell_faces(side, at)), side=1, 2)])
      end associate
      i = min(cell, size(rock%shear, kind=ik))
      associate (g => rock%shear(i), lame => rock%lame(i), biot => rock%biot(i), &
                 storage => rock%storage(i))
         stiffness = lame + 2.0_rk*g
         undrained = lame + biot**2/storage
         layer%diffusivity = rock%mobility_at(cell)/(storage + biot**2/stiffness)
         layer%drained_tip = (undrained + 2.0_rk*g)/(undrained + g)*(lame + g)/stiffness
         layer%eta = biot*g/stiffness
      end associate
   end function layer_at_tip

   !> Possible errors of K_I and K_II by layers that the cells do not resolve [Pa m^1/2].
   pure function thin_layer_errors(layer, k, is_closed, age, back_stress) result(errors)
      type(layer_t), intent(in) :: layer
      real(rk), intent(in) :: k(2)  !< K_I, K_II [Pa m^1/2]
      logical, intent(in) :: is_closed  !< the faces touch at the tip: K_I = 0
      real(rk), intent(in) :: age  !< age of the layer [s]
      !> K_I of the layers, which is known where the coarse level has them [Pa m^1/2]
      real(rk), intent(in) :: back_stress
      real(rk) :: errors(2)
      real(rk) :: factor, unresolved

      errors = 0.0_rk
      if (.not. layer%cell > 0.0_rk) return
      unresolved = 1.0_rk/(1.0_rk + 4.0_rk*layer%diffusivity*age/layer%cell**2)
      errors = share_of_drained_tip*(1.0_rk - layer%drained_tip)*abs(k)*unresolved
      if (layer%is_known) then
         errors(1) = errors(1) + share_of_layer*abs(back_stress)
      else
         factor = 0.5_rk*(1.0_rk + layer%drained_tip)*sqrt(2.0_rk)*layer%eta/gamma(1.25_rk)
         errors(1) = errors(1) + factor*abs(layer%jump)*unresolved &
                     *min(layer%diffusivity*age, layer%cell**2)**0.25_rk
      end if
      if (is_closed) errors(1) = 0.0_rk
   end function thin_layer_errors

   !> Relative excess of K_II of the body as one window by a drained tip [-].
   pure real(rk) function drained_excess(layer, age) result(excess)
      type(layer_t), intent(in) :: layer
      real(rk), intent(in) :: age  !< [s]
      real(rk) :: x

      excess = 0.0_rk
      if (.not. layer%cell > 0.0_rk) return
      x = sqrt(layer%diffusivity*age)/layer%cell
      excess = excess_of_drained*(1.0_rk - layer%drained_tip)/(1.0_rk + x*(falls(1) + x*falls(2)))
   end function drained_excess

end module twolevel_drained_tips
