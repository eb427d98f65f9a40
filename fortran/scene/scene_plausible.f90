!> Warnings for scenes that can be simulated but are probably not intended: values out of the usual
!! range, as from wrong units, inconsistent values, and ends of fractures that almost touch
!! something or just pass it. Scenes that cannot be simulated are refused (scene_check).
module scene_plausible
   use base_kinds, only: degrees, ik, pi, rk
   use base_plane, only: norm2, polygon_area
   use base_texts, only: add_text, text_t
   use base_tolerances, only: round_off, same_time
   use scene_check_geometry, only: near_end_t, near_ends
   use scene_check_mechanics, only: surplus_restraints
   use scene_check_permeability, only: anisotropy
   use scene_fluid_law, only: skempton, strained_storage
   use scene_regime, only: find_regime
   use scene_region_outline, only: body_part
   use scene_sides, only: normal_tractions
   use scene_stress, only: far_stress_t, find_far_stress, part_t, parts_of_scene
   use scene_types, only: fracture_t, no_limit, scene_t
   use scene_words, only: rounded_text
   implicit none(type, external)
   private

   public :: doubt_t, doubts, doubts_of_scene

   !> A plausibility check.
   type :: doubt_t
      character(len=12) :: group = ""
      character(len=16) :: name = ""
      character(len=8) :: unit = "-"
      character(len=64) :: doubtful = ""  !< condition of the warning, in words
      character(len=150) :: usual = ""  !< usual values or consequences; a sentence
   end type doubt_t

   ! Indices into the table.
   integer, parameter :: of_young = 1, of_poisson = 2, of_density = 3, of_porosity = 4, &
                         of_permeability = 5, of_toughness = 6, of_compressibility = 7, &
                         of_viscosity = 8, of_friction = 9, of_dilation = 10, of_aperture = 11, &
                         of_traction = 12, of_start = 13, of_window = 14, of_interval = 15, &
                         of_stiff_fluid = 16, of_region = 17, of_width = 18, of_gap = 19, &
                         of_stub = 20, of_anisotropy = 21, of_fluid_density = 22, &
                         of_weightless = 23, of_uniform = 24, of_tension = 25, of_dry = 26, &
                         of_overpressure = 27, of_viscous = 28, of_surplus = 29, &
                         of_friction_there = 30, of_wide = 31, of_sealed = 32, &
                         of_would_grow = 33, of_thickness = 34, of_no_growth = 35, of_moved = 36, &
                         of_next = 37, of_front = 38, of_tolerance = 39

   ! The table keeps its own layout.
   !&<
   type(doubt_t), parameter :: doubts(*) = [ &
      doubt_t("material", "young", "Pa", "below 1e8 or above 1e12", "rock has 1e9 to 1e11 Pa"), &
      doubt_t("material", "poisson", "-", &
         "above 0.49, with intensities, in plane strain, without &adaptive", &
         "elements around the tips are then too stiff: stress intensity factors are up to 1 % "// &
         "off, with &adaptive 0.1 %"), &
      doubt_t("material", "density", "kg/m3", "below 100 or above 10000, if not 0", &
         "rock has 2000 to 3000 kg/m3"), &
      doubt_t("material", "porosity", "-", "above 0.5", "rock has 0.001 to 0.3, not per cent"), &
      doubt_t("material", "permeability", "m2", "above 1e-8, with &fluid", &
         "rock has 1e-22 to 1e-11 m2, and a millidarcy is 1e-15 m2"), &
      doubt_t("material", "toughness", "Pa m^1/2", "below 1e4 or above 1e8, with growth", &
         "rock has 1e5 to 1e7 Pa m^1/2, and 1 MPa m^1/2 is 1e6"), &
      doubt_t("fluid", "compressibility", "1/Pa", "above 1e-6", &
         "water has 4e-10 1/Pa, a gas the inverse of its pressure"), &
      doubt_t("fluid", "viscosity", "Pa s", "below 1e-6 or above 10", &
         "water has 1e-4 to 1e-3 Pa s, gels 0.01 to 1 Pa s"), &
      doubt_t("fracture", "friction", "-", "above 1.5", "rock has 0.3 to 1"), &
      doubt_t("fracture", "dilation_deg", "degree", "above the angle of friction", &
         "a slipping fracture then releases energy instead of dissipating it; 0 to 10 is usual"), &
      doubt_t("fracture", "aperture", "m", "above a tenth of the fracture's length", &
         "natural fractures have 1e-5 to 1e-3 m; the cubic law is valid for thin ones"), &
      doubt_t("side", "traction", "Pa", "tension across a side, with wells", &
         "rock at depth is compressed, and compression is negative"), &
      doubt_t("injection", "start", "s", "not before the end of &time", &
         "the well is never active"), &
      doubt_t("fine", "window", "m", "at least the body's shorter side, with &fluid", &
         "a window is a part of the body around a tip; a few fracture lengths are usual, and "// &
         "'body' is one window for all tips"), &
      doubt_t("output", "interval", "s", "below the step of &time", &
         "fields are written at most once per step"), &
      doubt_t("fluid", "compressibility", "1/Pa", &
         "above 0, but Skempton's coefficient B exceeds 1", &
         "the undrained pressure then exceeds the load; rock has B of 0.3 to 1"), &
      doubt_t("region", "permeability", "m2", "above 1e-8", &
         "rock has 1e-22 to 1e-11 m2, and a millidarcy is 1e-15 m2"), &
      doubt_t("region", "width", "m", "below size_boundary: twice its area over its outline", &
         "cells may be wider and average its permeability with that around it; reduce "// &
         "size_boundary"), &
      doubt_t("fracture", "gap", "m", "of an end below 0.05 increments, with growth and &fluid", &
         "the ligament fails as soon as the tip exceeds its toughness; let them touch, or "// &
         "separate them, if this is unintended"), &
      doubt_t("fracture", "stub", "m", &
         "past a fracture that it crosses below 0.05 increments, likewise", &
         "its end is a separate tip, with cells as small as the stub; let it end on the other "// &
         "one if this is unintended"), &
      doubt_t("material", "anisotropy", "-", "above 10, with &fluid", &
         "with such anisotropy pressures may leave their bounds: by a fifth of their range at "// &
         "100"), &
      doubt_t("fluid", "density", "kg/m3", "below 1 or above 3000, if not 0", &
         "water has 1000 kg/m3"), &
      doubt_t("fluid", "density", "kg/m3", "0, with &gravity", &
         "its pressure then does not increase with depth; water has 1000 kg/m3"), &
      doubt_t("in_situ", "syy_per_y", "Pa/m", "0, with &gravity and a stress, with &fluid", &
         "the weight then loads the body in addition to that stress; a gradient of density "// &
         "times gravity balances it from the start"), &
      doubt_t("in_situ", "tension", "Pa", "above 0 somewhere in the body, with &fluid", &
         "rock at depth is compressed, and compression is negative"), &
      doubt_t("initial", "pressure", "Pa", &
         "below vapour_pressure somewhere, by the fluid's density", &
         "there is no water table: fractures there begin with vapour; use a larger pressure or "// &
         "another y_datum"), &
      doubt_t("initial", "pressure", "Pa", "above the smallest compression in situ somewhere", &
         "fractures across that compression are open from the start"), &
      doubt_t("injection", "K_m", "-", &
         "below 0.2, of a rate in a fracture, with growth (docs/theory.md)", &
         "growth is then viscosity-dominated; growth is verified for K_m of 0.2 and more"), &
      doubt_t("restraint", "surplus", "-", "above 0: more components than fix the rigid motions", &
         "they are then point loads, around which results depend on the cell size; use "// &
         "displacements or springs on sides instead"), &
      doubt_t("material", "poisson", "-", &
         "above 0.49, likewise, with friction, with &adaptive too", &
         "friction then follows wrong normal tractions around tips: K_II of closed sliding "// &
         "tips is several per cent off, within their stated errors"), &
      doubt_t("fracture", "aperture", "m", "above 0.005, with &fluid", &
         "natural fractures have 1e-5 to 1e-3 m, and an aperture in mm needs aperture_mm"), &
      doubt_t("injection", "reach", "m", &
         "sqrt(c t) reaches a side, none with pressure or inflow", &
         "the body is sealed and its pressure changes with the volume of the wells; give sides "// &
         "a pressure, or inflow = 0 if they are sealed"), &
      doubt_t("growth", "K_I", "Pa m^1/2", &
         "above toughness at a pressure of its wells, without growth", &
         "the fracture would grow, which is left out: enabled = .true. of &growth simulates it"), &
      doubt_t("scene", "thickness", "m", "assumed, and a rate is a volume per time", &
         "rates such as rate_l_s are those of this height of the fractures; give thickness"), &
      doubt_t("growth", "enabled", "logical", &
         "assumed, in a group that gives neither it nor intensities", &
        "nothing grows; enabled = .true. lets fractures grow, and .false. says that they do not"), &
      doubt_t("injection", "distance", "m", &
         "above a tenth of the length of the fracture, if 'nearest'", &
         "the well is moved so far to reach the nearest fracture; give its name, or leave it "// &
         "out for a well in the rock"), &
      doubt_t("injection", "next distance", "m", &
         "of another fracture within 5 % of that of the nearest, likewise", &
         "two fractures are about equally near, and the nearest is fed; give its name"), &
      doubt_t("temperature", "face_depth", "m", "below size_boundary, without &adaptive", &
         "elements at the face are wider than the front, which the stated errors do not contain"), &
      doubt_t("time", "tolerance", "-", "above 0.01, with growth and &fluid", &
         "tips may jump within a step without being seen to, and stated errors do not contain it")]
   !&>

   !> Distance below which an end reaches a target (twolevel_segments) [increments].
   real(rk), parameter :: near_end = 0.05_rk

   character(len=9), parameter :: sides(4) = [" 'left'  ", " 'right' ", " 'bottom'", " 'top'   "]

   real(rk), parameter, public :: least_verified = 0.2_rk  !< smallest K_m of verification/kgd [-]

contains

   !> A sentence for each plausibility check that a scene does not pass.
   pure function doubts_of_scene(scene) result(list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable :: list(:)
      logical :: has_fluid

      allocate (list(0))
      has_fluid = scene%has_fluid()
      call doubt_material(scene, has_fluid, list)
      call doubt_fractures(scene%fractures, has_fluid, list)
      call doubt_growth(scene, list)
      call add(list, scene%thickness_assumed, of_thickness, scene%thickness)
      call add(list, scene%growth%enabled_assumed, of_no_growth, 0.0_rk)
      if (has_fluid) call doubt_flow(scene, list)
      if (has_fluid) call doubt_column(scene, list)
      if (has_fluid .and. scene%growth%enabled) call doubt_ends(scene, list)
      if (allocated(scene%regions)) call doubt_regions(scene, list)
      if (allocated(scene%temperature)) then
         associate (depth => scene%temperature%face_depth)
            call add(list, depth > 0.0_rk .and. depth < scene%discretization%size_boundary &
                     .and. .not. scene%adaptive%enabled, of_front, depth)
         end associate
      end if
      if (scene%has_points()) then
         associate (surplus => surplus_restraints(scene))
            call add(list, surplus > 0 .and. size(scene%restraints) > 0, of_surplus, &
                     real(surplus, rk))
         end associate
      end if
   end function doubts_of_scene

   !> Check the rock.
   pure subroutine doubt_material(scene, has_fluid, list)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: has_fluid
      type(text_t), allocatable, intent(inout) :: list(:)

      associate (m => scene%material)
         call add(list,.not. within(m%young, 1.0e8_rk, 1.0e12_rk), of_young, m%young)
         ! The bound is measured: verification/extreme_cracks.
         if (m%poisson > 0.49_rk .and. scene%growth%intensities .and. .not. m%plane_stress) then
            associate (f => scene%fractures)
               if (any(f%law == "friction" .and. f%friction > 0.0_rk)) then
                  call add(list, .true., of_friction_there, m%poisson)
               else
                  call add(list,.not. scene%adaptive%enabled, of_poisson, m%poisson)
               end if
            end associate
         end if
         call add(list, m%density > 0.0_rk .and. .not. within(m%density, 100.0_rk, 1.0e4_rk), &
                  of_density, m%density)
         call add(list, m%porosity > 0.5_rk, of_porosity, m%porosity)
         associate (largest => max(m%permeability_xx, m%permeability_yy))
            call add(list, has_fluid .and. largest > 1.0e-8_rk, of_permeability, largest)
         end associate
         if (has_fluid) call add(list, anisotropy(m) > 10.0_rk, of_anisotropy, anisotropy(m))
         if (scene%growth%enabled) then
            call add(list,.not. within(m%toughness, 1.0e4_rk, 1.0e8_rk), of_toughness, &
                     m%toughness)
         end if
      end associate
   end subroutine doubt_material

   !> Check the laws of the fractures.
   pure subroutine doubt_fractures(fractures, has_fluid, list)
      type(fracture_t), intent(in) :: fractures(:)
      logical, intent(in) :: has_fluid
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk), parameter :: widest = 5.0e-3_rk*(1.0_rk + round_off)  ! [m]
      integer :: i

      do i = 1, size(fractures)
         associate (f => fractures(i), whose => " '"//trim(fractures(i)%name)//"'")
            call add(list, f%friction > 1.5_rk, of_friction, f%friction, whose)
            call add(list, f%law == "friction" .and. tan(f%dilation) > f%friction, of_dilation, &
                     f%dilation*degrees, whose)
            if (.not. has_fluid) cycle
            call add(list, f%aperture > 0.1_rk*f%length(), of_aperture, f%aperture, whose)
            call add(list, within(f%aperture, widest, 0.1_rk*f%length()), of_wide, f%aperture, &
                     whose)
         end associate
      end do
   end subroutine doubt_fractures

   !> Check the growth regime, viscosity-dominated growth has not been verified, and the tolerance
   !! in time, with which jumps are seen.
   pure subroutine doubt_growth(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk), parameter :: nearly = 0.99_rk, most_tolerance = 0.01_rk*(1.0_rk + round_off)
      real(rk) :: leakoff, value
      integer :: well

      call find_regime(scene, value, leakoff, well)
      if (scene%growth%enabled .and. scene%has_fluid()) then
         call add(list, scene%time%tolerance > most_tolerance, of_tolerance, scene%time%tolerance)
      end if
      if (well > 0) call add(list, value < nearly*least_verified, of_viscous, value, &
                             " '"//trim(scene%injections(well)%name)//"'")
      if (.not. scene%growth%enabled .and. scene%has_wells()) call doubt_no_growth(scene, list)
   end subroutine doubt_growth

   !> Check whether fractures that do not grow would do so at the pressure of a well: K_I of the
   !! straight crack between their ends, without those around it.
   pure subroutine doubt_no_growth(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      type(far_stress_t) :: far
      type(part_t), allocatable :: parts(:)
      real(rk) :: intensity, largest, toughness
      integer :: i, k

      call find_far_stress(scene, far)
      if (allocated(far%unknown)) return
      parts = parts_of_scene(scene, far)
      do i = 1, size(scene%fractures)
         toughness = min(scene%fractures(i)%toughness, scene%material%toughness)
         if (.not. toughness < huge(1.0_rk)) cycle
         largest = largest_pressure(scene, i)
         intensity = -huge(1.0_rk)
         do k = 1, size(parts)
            if (parts(k)%fracture /= i) cycle
            intensity = max(intensity, (largest - parts(k)%normal) &
                            *sqrt(0.5_rk*pi*scene%fractures(i)%length()))
         end do
         call add(list, intensity > toughness, of_would_grow, intensity, &
                  " of '"//trim(scene%fractures(i)%name)//"'")
      end do
   end subroutine doubt_no_growth

   !> The largest pressure that wells prescribe in a fracture, or allow [Pa].
   pure real(rk) function largest_pressure(scene, fracture) result(largest)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: fracture  !< index into scene%fractures
      integer :: i
      logical :: is_there
      logical, allocatable :: is_upper(:)  ! (stages) and not the lower limit of a producer

      largest = -huge(1.0_rk)
      do i = 1, size(scene%injections)
         associate (well => scene%injections(i))
            if (.not. allocated(well%pressure)) cycle
            is_there = well%fracture == fracture
            if (allocated(well%entries)) is_there = any(well%entries%fracture == fracture)
            if (.not. is_there) cycle
            is_upper = well%pressure < no_limit
            if (allocated(well%rate)) is_upper = is_upper .and. well%rate > 0.0_rk
            largest = max(largest, maxval(well%pressure, mask=is_upper))
         end associate
      end do
   end function largest_pressure

   !> Check for ends that almost touch something, or just pass it.
   pure subroutine doubt_ends(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      type(near_end_t), allocatable :: found(:)
      real(rk) :: longest
      character(len=:), allocatable :: other
      integer :: i

      longest = max(scene%growth%increment, maxval([scene%fractures%increment, 0.0_rk]))
      found = near_ends(scene%fractures, scene%domain, near_end*longest)
      do i = 1, size(found)
         associate (this => found(i))
            if (.not. this%distance < near_end*scene%increment_of(this%fracture)) cycle
            if (this%other > 0) then
               other = " '"//trim(scene%fractures(this%other)%name)//"'"
            else
               other = " the side"//trim(sides(this%side))
            end if
            call add(list, .true., merge(of_stub, of_gap, this%is_past), this%distance, " '"// &
                     trim(scene%fractures(this%fracture)%name)//"'"// &
                     trim(merge(" past", " to  ", this%is_past))//other)
         end associate
      end do
   end subroutine doubt_ends

   !> Check the permeability and the width of regions.
   pure subroutine doubt_regions(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk), allocatable :: corners(:, :)
      real(rk) :: width
      integer :: i
      integer(ik) :: k, n

      do i = 1, size(scene%regions)
         associate (region => scene%regions(i), whose => " '"//trim(scene%regions(i)%name)//"'")
            associate (largest => max(region%material%permeability_xx, &
                                      region%material%permeability_yy))
               call add(list, largest > 1.0e-8_rk, of_region, largest, whose)
            end associate
            if (scene%has_fluid()) then
               call add(list, scene%fluid%compressibility > 0.0_rk .and. &
                        skempton(region%material, scene%fluid) > 1.0_rk + round_off, &
                        of_stiff_fluid, scene%fluid%compressibility, whose)
            end if
            corners = body_part(region, scene%domain)
            n = size(corners, 2, kind=ik)
            width = 2.0_rk*polygon_area(corners) &
                    /sum([(norm2(corners(:, mod(k, n) + 1_ik) - corners(:, k)), k=1, n)])
            call add(list, width < scene%discretization%size_boundary, of_width, width, whose)
         end associate
      end do
   end subroutine doubt_regions

   !> Check stress and pressure in situ, at the bottom and the top of the body.
   pure subroutine doubt_column(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk) :: pressure(2), stress(3), tension(2), y(2)
      logical :: has_gradient, has_stress
      integer :: i

      associate (fluid => scene%fluid, given => scene%in_situ, gravity => scene%gravity)
         has_gradient = any(abs(given%per_y) > 0.0_rk)
         has_stress = has_gradient .or. any(abs(given%stress) > 0.0_rk)
         y = [scene%domain%y_min, scene%domain%y_max] - given%y_datum
         pressure = scene%initial%pressure + fluid%density*gravity(2)*y
         do i = 1, 2
            stress = given%stress
            stress(1:2) = stress(1:2) + given%per_y*y(i)
            tension(i) = 0.5_rk*(stress(1) + stress(2)) &
                         + hypot(0.5_rk*(stress(1) - stress(2)), stress(3))
         end do
        call add(list, fluid%density > 0.0_rk .and. .not. within(fluid%density, 1.0_rk, 3.0e3_rk), &
                  of_fluid_density, fluid%density)
         call add(list, any(abs(gravity) > 0.0_rk) .and. .not. fluid%density > 0.0_rk, &
                  of_weightless, fluid%density)
         call add(list, any(abs(gravity) > 0.0_rk) .and. has_stress .and. .not. has_gradient, &
                  of_uniform, given%per_y(2))
         call add(list, fluid%density > 0.0_rk .and. &
                  any(pressure < fluid%vapour_pressure - round_off*maxval(abs(pressure))), of_dry, &
                  minval(pressure))
         if (.not. has_stress) return
         call add(list, any(tension > round_off*maxval(abs(tension))), of_tension, maxval(tension))
         i = maxloc(pressure + tension, dim=1)
         call add(list, size(scene%fractures) > 0 .and. pressure(i) > -tension(i) &
                  + round_off*maxval(abs(tension)) .and. .not. any(tension > 0.0_rk), &
                  of_overpressure, pressure(i))
      end associate
   end subroutine doubt_column

   !> Check the fluid, the wells and the times of a scene with a fluid.
   pure subroutine doubt_flow(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk) :: across(4)
      integer :: i

      associate (fluid => scene%fluid, d => scene%domain)
         call add(list, fluid%compressibility > 1.0e-6_rk, of_compressibility, &
                  fluid%compressibility)
         call add(list, fluid%compressibility > 0.0_rk .and. &
                  skempton(scene%material, fluid) > 1.0_rk + round_off, of_stiff_fluid, &
                  fluid%compressibility)
         call add(list,.not. within(fluid%viscosity, 1.0e-6_rk, 10.0_rk), of_viscosity, &
                  fluid%viscosity)
         across = normal_tractions(scene%sides)
         do i = 1, 4
            call add(list, scene%has_wells() .and. across(i) > 0.0_rk, of_traction, across(i), &
                     trim(sides(i)))
         end do
         call add(list, scene%growth%intensities .and. scene%discretization%window >= &
                  min(d%x_max - d%x_min, d%y_max - d%y_min), of_window, &
                  scene%discretization%window)
      end associate
      if (scene%has_wells()) call doubt_seal(scene, list)
      do i = 1, merge(size(scene%injections), 0, allocated(scene%injections))
         associate (well => scene%injections(i))
            call add(list, well%start >= scene%time%end, of_start, well%start)
            if (.not. well%moved > 0.0_rk) cycle
            call add(list, well%moved > 0.1_rk*scene%fractures(well%fracture)%length(), of_moved, &
                     well%moved, " '"//trim(well%name)//"'")
            call add(list, well%next_distance < 1.05_rk*well%moved, of_next, well%next_distance, &
                     " '"//trim(well%name)//"'")
         end associate
      end do
      associate (interval => scene%output%interval)
         call add(list, interval > 0.0_rk .and. &
                  interval < scene%time%step*(1.0_rk - same_time), of_interval, interval)
      end associate
   end subroutine doubt_flow

   !> Check whether wells change the pressure at sides that are all sealed: the depth of diffusion
   !! from the nearest point of a fracture or well.
   pure subroutine doubt_seal(scene, list)
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable, intent(inout) :: list(:)
      real(rk) :: distance, reach, stored
      integer :: i

      stored = strained_storage(scene%material, scene%fluid)
      if (scene%domain%shape /= "rectangle" .or. .not. stored > 0.0_rk) return
      if (any(scene%sides%pressure_given .or. scene%sides%inflow_given)) return
      distance = huge(1.0_rk)
      associate (d => scene%domain, wells => scene%injections)
         do i = 1, size(scene%fractures)
            associate (x => scene%fractures(i)%x, y => scene%fractures(i)%y)
               distance = min(distance, minval(x) - d%x_min, d%x_max - maxval(x), &
                              minval(y) - d%y_min, d%y_max - maxval(y))
            end associate
         end do
         do i = 1, size(wells)
            if (wells(i)%fracture > 0) cycle
            distance = min(distance, wells(i)%x - d%x_min, d%x_max - wells(i)%x, &
                           wells(i)%y - d%y_min, d%y_max - wells(i)%y)
         end do
      end associate
      associate (m => scene%material)
         ! Diffusivity of rock that is strained in one direction.
         reach = sqrt(max(m%permeability_xx, m%permeability_yy)/scene%fluid%viscosity &
                      *scene%time%end/stored)
      end associate
      call add(list, reach > distance, of_sealed, reach)
   end subroutine doubt_seal

   !> A value lies between two limits.
   pure logical function within(value, lowest, highest)
      real(rk), intent(in) :: value, lowest, highest  !< [any unit]

      within = value >= lowest .and. value <= highest
   end function within

   !> Add the sentence of a check that has failed.
   pure subroutine add(list, has_failed, check, value, whose)
      type(text_t), allocatable, intent(inout) :: list(:)
      logical, intent(in) :: has_failed
      integer, intent(in) :: check  !< index into the table
      real(rk), intent(in) :: value  !< in the unit of the check
      character(len=*), intent(in), optional :: whose  !< name of fracture or side, in quotes
      character(len=:), allocatable :: place, unit
      type(doubt_t) :: d

      if (.not. has_failed) return
      d = doubts(check)
      place = "&"//trim(d%group)
      if (present(whose)) place = place//whose
      unit = ""
      if (d%unit /= "-") unit = " "//trim(d%unit)
      unit = rounded_text(value)//unit
      if (d%unit == "logical") unit = trim(merge(".true. ", ".false.", value > 0.0_rk))
      call add_text(list, place//": "//trim(d%name)//" is "//unit//": "//trim(d%usual))
   end subroutine add

end module scene_plausible
