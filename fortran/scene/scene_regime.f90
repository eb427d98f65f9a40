!> The regime of growth of a fracture that a well supplies: dominated by the toughness of the rock
!! or by the viscosity of the fluid, with the fluid in the fracture or in the rock.
!!
!! In plane strain, at a constant rate Q of both wings, it is given by two numbers, with K' =
!! sqrt(32/pi) K_IC, E' = E/(1 - nu^2) and mu' = 12 mu: the dimensionless toughness
!!   K_m = K'/(E'^3 mu' Q)^(1/4),
!! which does not change with time (Detournay 2004, International Journal of Geomechanics 4, 35),
!! and the dimensionless leak-off
!!   C_m = C' (E' t/(mu' Q^3))^(1/6),
!! with Carter's coefficient C' = 2 dp sqrt(k S/(pi mu)) for a pressure dp above that of the rock
!! (Adachi and Detournay 2008, Engineering Fracture Mechanics 75, 4666). Most fluid is in the
!! fracture while C_m is small, and in the rock once it is large.
module scene_regime
   use base_kinds, only: pi, rk
   use scene_fluid_law, only: strained_storage
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: carter_coefficient, dimensionless_leakoff, dimensionless_toughness, find_regime
   public :: regime_words

contains

   !> K_m of growth at a rate; 0 without one [-].
   pure real(rk) function dimensionless_toughness(scene, toughness, rate) result(value)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^(1/2)]
      real(rk), intent(in) :: rate  !< Q [m2/s]

      value = 0.0_rk
      if (.not. rate > 0.0_rk) return
      value = sqrt(32.0_rk/pi)*toughness &
              /(crack_modulus(scene)**3*12.0_rk*scene%fluid%viscosity*rate)**0.25_rk
   end function dimensionless_toughness

   !> C_m of growth at a rate; 0 without one, or without leak-off [-].
   pure real(rk) function dimensionless_leakoff(scene, rise, rate, time) result(value)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: rise  !< dp, of the pressure above that of the rock [Pa]
      real(rk), intent(in) :: rate  !< Q [m2/s]
      real(rk), intent(in) :: time  !< t, since the rate began [s]

      value = 0.0_rk
      if (.not. (rate > 0.0_rk .and. time > 0.0_rk)) return
      value = carter_coefficient(scene, rise) &
              *(crack_modulus(scene)*time/(12.0_rk*scene%fluid%viscosity*rate**3))**(1.0_rk/6.0_rk)
   end function dimensionless_leakoff

   !> C' of the scene's rock; 0 where fluid does not flow into it [m/s^(1/2)].
   pure real(rk) function carter_coefficient(scene, rise) result(coefficient)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: rise  !< dp, of the pressure above that of the rock [Pa]
      real(rk) :: permeability

      coefficient = 0.0_rk
      if (.not. rise > 0.0_rk) return
      associate (m => scene%material, viscosity => scene%fluid%viscosity)
         permeability = sqrt(max(0.0_rk, m%permeability_xx*m%permeability_yy &
                                 - m%permeability_xy**2))
         ! Across the fracture the rock is strained, along it not.
         coefficient = 2.0_rk*rise*sqrt(permeability*strained_storage(m, scene%fluid) &
                                        /(pi*viscosity))
      end associate
   end function carter_coefficient

   !> E' [Pa].
   pure real(rk) function crack_modulus(scene)
      type(scene_t), intent(in) :: scene

      crack_modulus = scene%material%young
      if (.not. scene%material%plane_stress) then
         crack_modulus = crack_modulus/(1.0_rk - scene%material%poisson**2)
      end if
   end function crack_modulus

   !> The smallest K_m of the wells with a rate in a fracture, if the scene grows; and C_m of that
   !! well at the end of the scene.
   pure subroutine find_regime(scene, toughness, leakoff, well)
      type(scene_t), intent(in) :: scene
      real(rk), intent(out) :: toughness  !< K_m [-]
      real(rk), intent(out) :: leakoff  !< C_m; 0: without leak-off, or not known [-]
      integer, intent(out) :: well  !< which one has it; 0: there is none
      real(rk) :: rate, value
      integer :: i

      toughness = huge(1.0_rk)
      leakoff = 0.0_rk
      well = 0
      if (.not. (scene%growth%enabled .and. scene%has_fluid() .and. &
                 allocated(scene%injections))) return
      do i = 1, size(scene%injections)
         if (scene%injections(i)%fracture == 0 .or. .not. allocated(scene%injections(i)%rate)) cycle
         rate = maxval(scene%injections(i)%rate)/scene%injections(i)%entry_count()
         if (.not. rate > 0.0_rk) cycle
         value = dimensionless_toughness(scene, min(scene%material%toughness, &
                                                    scene%fractures(scene%injections(i)%fracture) &
                                                    %toughness), rate)
         if (value >= toughness) cycle
         toughness = value
         leakoff = dimensionless_leakoff(scene, least_compression(scene) &
                                         - scene%initial%pressure, rate, scene%time%end)
         well = i
      end do
   end subroutine find_regime

   !> The smallest compression of the rock, in situ at half its height or by its sides: about the
   !! pressure at which fractures grow [Pa].
   pure real(rk) function least_compression(scene) result(least)
      type(scene_t), intent(in) :: scene
      real(rk) :: stress(3)
      integer :: i

      associate (given => scene%in_situ, domain => scene%domain)
         stress = given%stress
         stress(1:2) = stress(1:2) + given%per_y*(0.5_rk*(domain%y_min + domain%y_max) &
                                                  - given%y_datum)
      end associate
      least = -0.5_rk*(stress(1) + stress(2)) - hypot(0.5_rk*(stress(1) - stress(2)), stress(3))
      if (any(abs(stress) > 0.0_rk)) return
      ! Left, right, bottom, top: their outward normals have the sign of -1, 1, -1, 1.
      least = huge(1.0_rk)
      do i = 1, 2
         least = min(least, max(compression(2*i - 1), compression(2*i)))
      end do

   contains

      !> By what is prescribed at a side; a side that is held has that of the opposite one [Pa].
      pure real(rk) function compression(side)
         integer, intent(in) :: side

         compression = -scene%sides(side)%normal_traction &
                       - real(merge(-1, 1, mod(side, 2) == 1), rk) &
                       *scene%sides(side)%traction((side + 1)/2)
      end function compression

   end function least_compression

   !> What decides: viscosity up to a K_m of 1, toughness from 4 on.
   pure function regime_words(dimensionless_toughness) result(words)
      real(rk), intent(in) :: dimensionless_toughness  !< [-]
      character(len=:), allocatable :: words

      if (dimensionless_toughness > 3.99_rk) then
         words = "toughness-dominated growth"
      else if (dimensionless_toughness > 1.01_rk) then
         words = "growth depends on toughness and viscosity"
      else
         words = "viscosity-dominated growth"
      end if
   end function regime_words

end module scene_regime
