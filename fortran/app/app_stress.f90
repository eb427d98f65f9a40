!> What a scene states before it runs, as JSON: the stress far from its fractures, and for each of
!! these the tractions, the pressures at which it slips, opens and grows; K_m of wells; the cost.
module app_stress
   use app_cost, only: cost_t, cost_of_scene
   use base_kinds, only: degrees, ik, pi, rk
   use growth_law, only: equivalent_intensity, kink_angle
   use report_json, only: json_t
   use scene_plausible, only: doubts_of_scene
   use scene_regime, only: dimensionless_toughness
   use scene_stress, only: far_stress_t, find_far_stress, part_t, parts_of_scene
   use scene_types, only: injection_t, no_limit, scene_t
   implicit none(type, external)
   private

   public :: stress_description

contains

   !> Pressure at which a straight crack in an infinite body grows: K_eq, of K_I by its opening and
   !! K_II by the shear traction beyond friction, is K_IC; without growth below it [Pa].
   pure real(rk) function grows_at(part, half_length, friction, cohesion, toughness) &
      result(pressure)
      type(part_t), intent(in) :: part
      real(rk), intent(in) :: half_length  !< [m]
      real(rk), intent(in) :: friction, cohesion  !< [-], [Pa]
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]
      real(rk) :: high, low, root
      integer :: i

      root = sqrt(pi*half_length)
      low = min(part%pressure, part%normal) - toughness/root
      if (friction > 0.0_rk) low = min(low, part%normal - part%shear/friction)
      high = part%normal + toughness/root
      pressure = high
      do i = 1, 100  ! K_eq increases with the pressure
         pressure = 0.5_rk*(low + high)
         if (driven(pressure) < toughness) then
            low = pressure
         else
            high = pressure
         end if
      end do

   contains

      !> K_eq at a pressure [Pa m^1/2].
      pure real(rk) function driven(pressure)
         real(rk), intent(in) :: pressure  !< [Pa]
         real(rk) :: k1, k2

         k1 = max(0.0_rk, pressure - part%normal)*root
         k2 = part%shear*root
         if (pressure < part%normal) then
            k2 = max(0.0_rk, part%shear - cohesion - friction*(part%normal - pressure))*root
         end if
         driven = equivalent_intensity(k1, k2, kink_angle(k1, k2))
      end function driven

   end function grows_at

   !> The description of a scene, as JSON.
   function stress_description(scene, n_cells) result(text)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: n_cells(2)  !< cells, fracture cells, by the mesh library
      character(len=:), allocatable :: text
      type(json_t) :: json
      type(far_stress_t) :: far
      type(cost_t) :: cost
      integer :: i

      call find_far_stress(scene, far)
      call json%begin_object("")
      call json%add("scene", trim(scene%name))
      if (allocated(far%unknown)) then
         call json%add("stress_unknown", far%unknown)
      else
         call add_stress(scene, far, json)
      end if
      call json%begin_array("wells")
      do i = 1, merge(size(scene%injections), 0, scene%has_wells())
         call add_well(scene, scene%injections(i), json)
      end do
      call json%end_array()
      cost = cost_of_scene(scene, n_cells)
      call json%begin_object("cost")
      call json%add("steps", nint(cost%steps, ik))
      call json%add("increments", nint(cost%increments, ik))
      call json%add("cells", nint(cost%cells, ik))
      call json%add("cpu_s", cost%seconds)
      call json%add("factor", cost%factor)
      call json%end_object()
      associate (doubts => doubts_of_scene(scene))
         call json%begin_array("warnings")
         do i = 1, size(doubts)
            call json%add("", doubts(i)%text)
         end do
         call json%end_array()
      end associate
      call json%end_object()
      text = json%text()
   end function stress_description

   !> The stress, and a row for each straight part of a fracture.
   subroutine add_stress(scene, far, json)
      type(scene_t), intent(in) :: scene
      type(far_stress_t), intent(in) :: far
      type(json_t), intent(inout) :: json
      type(part_t), allocatable :: parts(:)
      integer :: i

      call json%begin_object("stress")
      call json%add("xx_pa", far%stress(1))
      call json%add("yy_pa", far%stress(2))
      call json%add("xy_pa", far%stress(3))
      call json%add("xx_per_y_pa_m", far%per_y(1))
      call json%add("yy_per_y_pa_m", far%per_y(2))
      call json%add("pressure_pa", far%pressure)
      call json%add("pressure_per_y_pa_m", far%pressure_per_y)
      call json%add("y_datum_m", far%y_datum)
      call json%add("y_min_m", scene%domain%y_min)
      call json%add("y_max_m", scene%domain%y_max)
      call json%end_object()
      parts = parts_of_scene(scene, far)
      call json%begin_array("fractures")
      do i = 1, size(parts)
         call add_part(scene, parts(i), json)
      end do
      call json%end_array()
   end subroutine add_stress

   subroutine add_part(scene, part, json)
      type(scene_t), intent(in) :: scene
      type(part_t), intent(in) :: part
      type(json_t), intent(inout) :: json
      real(rk) :: toughness

      associate (fracture => scene%fractures(part%fracture))
         call json%begin_object("")
         call json%add("fracture", trim(fracture%name))
         call json%add("law", trim(fracture%law))
         call json%add("x_m", part%x)
         call json%add("y_m", part%y)
         call json%add("angle_deg", modulo(degrees*atan2(part%direction(2), part%direction(1)), &
                                           180.0_rk))
         call json%add("length_m", part%length)
         call json%add("pressure_pa", part%pressure)
         call json%add("normal_pa", part%normal)
         call json%add("shear_pa", part%shear)
         if (part%normal > part%pressure) call json%add("slip_tendency", part%tendency())
         if (fracture%law == "friction" .or. fracture%law == "frictionless") then
            call json%add("friction", fracture%friction)
            call json%add("cohesion_pa", fracture%cohesion)
            if (part%slips_at > -huge(1.0_rk)) call json%add("slips_at_pa", part%slips_at)
            call json%add("opens_at_pa", part%opens_at)
            toughness = min(fracture%toughness, scene%material%toughness)
            if (toughness < huge(1.0_rk)) then
               call json%add("grows_at_pa", grows_at(part, 0.5_rk*fracture%length(), &
                                                     fracture%friction, fracture%cohesion, &
                                                     toughness))
            end if
         end if
         call json%end_object()
      end associate
   end subroutine add_part

   subroutine add_well(scene, well, json)
      type(scene_t), intent(in) :: scene
      type(injection_t), intent(in) :: well
      type(json_t), intent(inout) :: json
      real(rk) :: toughness
      integer :: k

      call json%begin_object("")
      call json%add("well", trim(well%name))
      if (allocated(well%rate)) then
         call json%add("largest_rate_m2_s", maxval(well%rate))
         if (well%fracture > 0 .and. maxval(well%rate) > 0.0_rk) then
            toughness = min(scene%material%toughness, scene%fractures(well%fracture)%toughness)
            if (toughness < huge(1.0_rk)) call json%add("k_m", dimensionless_toughness( &
                                            scene, toughness, maxval(well%rate)/well%entry_count()))
         end if
      end if
      if (allocated(well%pressure)) then
         call json%begin_array("pressures_pa")
         do k = 1, size(well%pressure)
            if (well%pressure(k) < no_limit) call json%add("", well%pressure(k))
         end do
         call json%end_array()
      end if
      if (well%fracture > 0) then
         call json%begin_array("fractures")
         if (allocated(well%entries)) then
            do k = 1, size(well%entries)
               call json%add("", trim(scene%fractures(well%entries(k)%fracture)%name))
            end do
         else
            call json%add("", trim(scene%fractures(well%fracture)%name))
         end if
         call json%end_array()
      end if
      call json%end_object()
   end subroutine add_well

end module app_stress
