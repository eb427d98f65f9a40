!> What the viscosity of the fluid does at the tips that grow in a tried step (coarse_tip_layer):
!! the parameter b of each tip follows from its speed in the step, which the try determines, and
!! from the pressure in its cell before the step, at which fluid leaks off.
!!
!! Layers of fluid pressure at these tips: a tip moves on into rock that the fluid has not reached.
!! Behind a tip of speed V a layer is sqrt(c x/V) thick at a distance x, and its back stress is that
!! of a layer of uniform thickness and an age of `swept` c/V^2 (docs/theory.md).
module twolevel_tip_layers
   use base_kinds, only: ik, rk
   use coarse_rock, only: mean_solid, rock_t, solid_t
   use coarse_tip_layer, only: apparent_toughness, leaking_parameter, viscous_parameter
   use growth_tip, only: tip_t
   use mesh_types, only: mesh_t
   use scene_regime, only: carter_coefficient
   use twolevel_back_stress, only: diffusivity_at
   use twolevel_places, only: advances, end_cell
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: close_tips, find_tip_layers

   !> b sqrt(d), with d the length of the tip's coarse cell, below which viscosity is neglected [-].
   !! The opening there is then 3 % larger than without it.
   real(rk), parameter :: negligible = 0.1_rk

   !> Age of the layer at a moving tip, over c/V^2: (1.282)^4, the ratio of the half moments of the
   !! two layers for V sqrt(c t) = c [-].
   real(rk), parameter :: swept = 2.70_rk

contains

   !> For the tips where they are placed. Growth that jumps has no speed, but where viscosity has
   !! decided before it does not jump.
   subroutine find_tip_layers(self, dt, may_jump)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< of the step [s]
      logical, intent(in) :: may_jump
      integer(ik), allocatable :: free(:)
      real(rk) :: gain(size(self%tip)), length, pressure(size(self%before%pressure)), toughness
      real(rk) :: viscosity, viscous(size(self%tip))
      type(solid_t) :: solid
      integer(ik) :: cell, i

      viscous = 0.0_rk
      ! A tip that pauses, as it does where a segment begins, is probably about to go on.
      self%tip%viscous_rise = sqrt(self%last%front%tip%viscous_rise)
      gain = advances(self%front_state_t, self%start, self%now%segment, self%increments())
      pressure = self%problem%fracture_pressure(self%before) - self%scene%initial%pressure
      do i = 1, size(self%tip, kind=ik)
         self%tip(i)%layer_age = self%last%front%tip(i)%layer_age + dt
         if (.not. (self%tip(i)%is_free .and. gain(i) > 0.0_rk)) cycle
         cell = end_cell(self%problem%mesh%fracture, self%tip(i))
         self%tip(i)%layer_age = min(self%tip(i)%layer_age, &
                                     swept*diffusivity_at(self%problem, cell)*(dt/gain(i))**2)
         if (may_jump .and. .not. self%last%front%tip(i)%is_viscous()) cycle
         length = abs(self%problem%mesh%fracture%cell_s(2, cell) &
                      - self%problem%mesh%fracture%cell_s(1, cell))
         solid = beside(self%problem%model%rock, self%problem%mesh, cell)
         toughness = self%rules%toughness*self%tip(i)%drive%resistance
         viscosity = self%scene%fluid%viscosity
         associate (cells => self%problem%model%cells)
            if (allocated(cells%viscosity_ratio)) viscosity = viscosity*cells%viscosity_ratio(cell)
         end associate
         viscous(i) = viscous_parameter(viscosity, gain(i)/dt, solid%crack_modulus(), toughness)
         if (cell <= size(pressure)) then
            viscous(i) = leaking_parameter(viscous(i), carter_coefficient(self%scene, &
                                                                          pressure(cell)), &
                                           gain(i)/dt, solid%crack_modulus(), toughness, length)
         end if
         viscous(i) = max(0.0_rk, viscous(i) - negligible/sqrt(length))
         self%tip(i)%viscous_rise = max(self%tip(i)%viscous_rise, &
                                        apparent_toughness(viscous(i), length))
      end do
      free = pack([(i, i=1, size(self%tip, kind=ik))], self%tip%is_free)
      associate (ends => self%problem%model%ends)
         if (allocated(ends%viscous)) deallocate (ends%viscous)
         if (any(viscous > 0.0_rk)) ends%viscous = viscous(free)
      end associate
   end subroutine find_tip_layers

   !> Set the driving force to zero at tips that were open before the step and that the suction of
   !! the viscous fluid closes: such a tip is too far ahead, whatever its faces slip. It waits until
   !! it opens again. Open is a tip with more opening than sliding. Where the toughness is no scale
   !! for K, so small a K is not significant.
   subroutine close_tips(self)
      class(two_levels_t), intent(inout) :: self
      logical :: was_closed, was_open
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), before => self%last%front%tip(i))
            if (.not. tip%is_free .or. tip%intensity%k1 > abs(tip%intensity%k2)) cycle
            if (tip%least_scale > self%rules%toughness) cycle
            was_open = before%intensity%k1 > abs(before%intensity%k2)
            was_closed = .not. before%drive%intensity > 0.0_rk .and. &
                         abs(before%intensity%k2) > 0.0_rk
            if (was_closed .or. (was_open .and. tip%is_viscous())) tip%drive%intensity = 0.0_rk
         end associate
      end do
   end subroutine close_tips

   !> The rock on both sides of a fracture cell.
   pure function beside(rock, mesh, cell) result(solid)
      type(rock_t), intent(in) :: rock
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      type(solid_t) :: solid

      solid = mean_solid(rock, mesh%face_cells(1, mesh%fracture%cell_faces(:, cell)))
   end function beside

end module twolevel_tip_layers
