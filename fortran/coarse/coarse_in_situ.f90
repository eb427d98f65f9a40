!> The reference state of a scene with a stress in situ or with a fluid that has weight.
!!
!! All pressures of the coarse level are relative to this state: p' = p - p_0(y) with
!!   p_0 = p_initial + rho_f g (y - y_datum),
!! so that Darcy's and the cubic law need no gravity. Its stresses are relative to sigma_0(y),
!! linear in y:
!!   sigma = sigma_0 + sigma',   sigma' = C : eps(u) - alpha p' I,   div sigma' + b = 0
!! with b the weight that sigma_0 does not balance. A body at rest is then exactly zero. On the
!! fractures the contact traction is that of the total stress and pressure,
!!   f = f' + sigma_0 n + p_0 n,   f' = sigma' n + p' n.
!!
!! A stress in situ is the total stress at the initial pressure, which tractions on the sides
!! balance; those of the scene are added to them. Without one the initial pressure acts on rock
!! without strain, sigma_0 = -alpha p_0 I, and the tractions of the scene are the total ones.
module coarse_in_situ
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_layout, only: condensed_layout_t
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: find_in_situ, in_situ_state_t, weight_of_scene

   !> State to which pressures and stresses are relative.
   type :: in_situ_state_t
      real(rk) :: stress(3) = 0.0_rk  !< xx, yy, xy at the datum [Pa]
      real(rk) :: stress_per_y(2) = 0.0_rk  !< xx, yy: rise per metre upwards [Pa/m]
      real(rk) :: pressure = 0.0_rk  !< at the datum [Pa]
      real(rk) :: pressure_per_y = 0.0_rk  !< rise per metre upwards [Pa/m]
      real(rk) :: y_datum = 0.0_rk  !< [m]
      !> Whether the sides bear the stress in addition to the tractions of the scene; else these are
      !! the total ones.
      logical :: is_held = .false.
   contains
      procedure :: stress_at
      procedure :: pressure_at
      procedure :: side_traction
      procedure :: add_contact_tractions
      procedure :: contact_pressure
   end type in_situ_state_t

contains

   !> The state in situ of a scene, if it has a stress in situ or a fluid with weight.
   pure subroutine find_in_situ(scene, biot, state)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: biot  !< Biot's coefficient in the plane [-]
      type(in_situ_state_t), allocatable, intent(out) :: state
      real(rk) :: per_y
      logical :: has_stress

      associate (given => scene%in_situ)
         has_stress = any(abs([given%stress, given%per_y]) > 0.0_rk)
         per_y = scene%fluid%density*scene%gravity(2)
         if (.not. (has_stress .or. abs(per_y) > 0.0_rk)) return
         allocate (state)
         state%pressure = scene%initial%pressure
         state%pressure_per_y = per_y
         state%y_datum = given%y_datum
         state%is_held = has_stress
         if (has_stress) then
            state%stress = given%stress
            state%stress_per_y = given%per_y
         else
            state%stress(1:2) = -biot*state%pressure
            state%stress_per_y = -biot*per_y
         end if
      end associate
   end subroutine find_in_situ

   !> Weight of the rock with its pore fluid [N/m3]. A stress in situ that varies with y balances it
   !! and therefore defines it, since the scene's numbers may be rounded.
   pure function weight_of_scene(scene) result(weight)
      type(scene_t), intent(in) :: scene
      real(rk) :: weight(2)

      weight = scene%material%density*scene%gravity
      if (any(abs(scene%in_situ%per_y) > 0.0_rk)) weight = [0.0_rk, -scene%in_situ%per_y(2)]
   end function weight_of_scene

   !> Stress at a height: xx, yy, xy [Pa].
   pure function stress_at(self, y) result(stress)
      class(in_situ_state_t), intent(in) :: self
      real(rk), intent(in) :: y  !< [m]
      real(rk) :: stress(3)

      stress = self%stress
      stress(1:2) = stress(1:2) + self%stress_per_y*(y - self%y_datum)
   end function stress_at

   !> Pressure at a height [Pa].
   elemental real(rk) function pressure_at(self, y)
      class(in_situ_state_t), intent(in) :: self
      real(rk), intent(in) :: y  !< [m]

      pressure_at = self%pressure + self%pressure_per_y*(y - self%y_datum)
   end function pressure_at

   !> Traction on the outer boundary relative to the state in situ, from that of the scene [Pa].
   pure function side_traction(self, given, outward, y) result(traction)
      class(in_situ_state_t), intent(in) :: self
      real(rk), intent(in) :: given(2)  !< [Pa]
      real(rk), intent(in) :: outward(2)  !< unit vector [-]
      real(rk), intent(in) :: y  !< [m]
      real(rk) :: traction(2)
      real(rk) :: stress(3)

      traction = given
      if (self%is_held) return
      stress = self%stress_at(y)
      traction = traction - [dot_product(stress([1, 3]), outward), &
                             dot_product(stress([3, 2]), outward)]
   end function side_traction

   !> Add the tractions of the state in situ to the load on the condensed fractures, so that contact
   !! tractions are total. Tractions of the coarse level are linear along a face and known at its
   !! ends.
   pure subroutine add_contact_tractions(self, fracture, length, normal, layout, g)
      class(in_situ_state_t), intent(in) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: length(:)  !< (fracture cells) [m]
      real(rk), intent(in) :: normal(:, :)  !< (2, fracture cells) from side + to side - [-]
      type(condensed_layout_t), intent(in) :: layout
      real(rk), intent(inout) :: g(:)  !< as layout says [N/m], [m2]
      real(rk) :: stress(3), traction(2), y
      integer(ik) :: at, cell, end

      do cell = 1, fracture%n_cells
         do end = 1, 2
            y = fracture%point_xy(2, fracture%cell_points(end, cell))
            stress = self%stress_at(y)
            associate (n => normal(:, cell))
               traction = [dot_product(stress([1, 3]), n), dot_product(stress([3, 2]), n)]
               traction = [dot_product(traction, n) + self%pressure_at(y), &
                           traction(1)*n(2) - traction(2)*n(1)]
            end associate
            at = layout%at_jump(cell, end)
            g(at:at + 1) = g(at:at + 1) + 0.5_rk*length(cell)*traction
         end do
      end do
   end subroutine add_contact_tractions

   !> Compressive stress across a fracture cell at its middle less the pressure, at least 0 [Pa].
   pure real(rk) function contact_pressure(self, fracture, cell) result(pressure)
      class(in_situ_state_t), intent(in) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: cell
      real(rk) :: stress(3), along(2), y

      associate (ends => fracture%point_xy(:, fracture%cell_points(:, cell)))
         along = (ends(:, 2) - ends(:, 1))/norm2(ends(:, 2) - ends(:, 1))
         y = 0.5_rk*sum(ends(2, :))
      end associate
      stress = self%stress_at(y)
      pressure = -(stress(1)*along(2)**2 + stress(2)*along(1)**2 &
                   - 2.0_rk*stress(3)*along(1)*along(2)) - self%pressure_at(y)
      pressure = max(0.0_rk, pressure)
   end function contact_pressure

end module coarse_in_situ
