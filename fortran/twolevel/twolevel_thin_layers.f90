!> Possible effect of layers of fluid pressure thinner than a coarse cell on the stress intensity
!! factors.
!!
!! Windows take the rock's own pressure (coarse_own_pressure). Within sqrt(c t) of the faces the
!! pressure is that of the fluid. Where this distance is less than a cell two effects are missing,
!! both known in closed form for a layer that is thin compared with the fracture (docs/theory.md):
!!   - the tip is drained where the surrounding rock is not: K is (1 - nu_u)/(1 - nu) times that of
!!     undrained rock, however thin the layer is, and the result of the window lies between;
!!   - the layer presses the faces together. A difference dp between fluid and rock since the time t
!!     lowers K_I by sqrt(2) eta/Gamma(5/4) dp (c t)^(1/4), eta = alpha G/(lambda + 2 G).
module twolevel_thin_layers
   use base_kinds, only: ik, rk
   use coarse_rock, only: rock_t
   use coarse_state, only: state_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: layer_t, layer_at_tip, thin_layer_errors

   !> Data of the layer at the end of a fracture.
   type :: layer_t
      real(rk) :: cell = 0.0_rk  !< length of the coarse fracture cell at the tip [m]
      real(rk) :: diffusivity = 0.0_rk  !< c [m2/s]
      real(rk) :: drained_tip = 1.0_rk  !< (1 - nu_u)/(1 - nu) [-]
      real(rk) :: eta = 0.0_rk  !< poroelastic stress coefficient [-]
      !> pressure of the fluid minus the rock's own pressure at the faces [Pa]
      real(rk) :: jump = 0.0_rk
   end type layer_t

contains

   !> Layer at an end of a fracture; without effect if the fracture has no cells.
   pure function layer_at_tip(mesh, rock, state, own_pressure, fracture, end) result(layer)
      type(mesh_t), intent(in) :: mesh  !< coarse
      type(rock_t), intent(in) :: rock
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: own_pressure(:)  !< (n_nodes) pressure of the rock [Pa]
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
         cell = mesh%face_cells(1, here%cell_faces(1, at))
         layer%jump = state%pressure(at) &
           - 0.25_rk*sum([(own_pressure(mesh%face_nodes(:, here%cell_faces(side, at))), side=1, 2)])
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
   pure function thin_layer_errors(layer, k, is_closed, age) result(errors)
      type(layer_t), intent(in) :: layer
      real(rk), intent(in) :: k(2)  !< K_I, K_II [Pa m^1/2]
      logical, intent(in) :: is_closed  !< the faces touch at the tip: K_I = 0
      real(rk), intent(in) :: age  !< age of the layer [s]
      real(rk) :: errors(2)
      real(rk) :: factor, unresolved

      errors = 0.0_rk
      if (.not. layer%cell > 0.0_rk) return
      unresolved = 1.0_rk/(1.0_rk + 4.0_rk*layer%diffusivity*age/layer%cell**2)
      errors = (1.0_rk - layer%drained_tip)*abs(k)
      factor = sqrt(2.0_rk)*layer%eta/gamma(1.25_rk)
      errors(1) = errors(1) + factor*abs(layer%jump) &
                  *min(layer%diffusivity*age, layer%cell**2)**0.25_rk
      errors = unresolved*errors
      if (is_closed) errors(1) = 0.0_rk
   end function thin_layer_errors

end module twolevel_thin_layers
