!> Reading of a scene file.
!!
!! Defaults that depend on other values: resolved only here, so that scene.nml shows the numbers
!! used.
module scene_namelist
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use scene_check, only: check_scene, check_sheet
   use scene_exchange, only: sheet_to_scene
   use scene_exchange_values, only: not_given
   use scene_fluid_law, only: has_law
   use scene_parse, only: parse_scene
   use scene_schedule, only: load_schedules
   use scene_sheet, only: sheet_t
   use scene_sizes, only: choose_sizes
   use scene_types, only: injection_t, material_t, region_t, scene_t
   implicit none(type, external)
   private

   public :: read_scene, resolve_defaults

contains

   !> Read a scene, fill in its defaults and check it. On an error the scene is not to be used.
   !! Whether its geometry can be meshed is not for this room to judge.
   subroutine read_scene(path, scene, error, source)
      character(len=*), intent(in) :: path
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(sheet_t), intent(out), optional :: source  !< the file, for messages about its lines
      type(sheet_t) :: sheet

      call parse_scene(path, sheet, error)
      if (allocated(error)) return
      call load_schedules(sheet, error)
      if (allocated(error)) return
      call check_sheet(sheet, error)
      if (allocated(error)) return
      call sheet_to_scene(sheet, scene)
      call resolve_defaults(scene)
      call check_scene(sheet, scene, error)
      if (present(source)) source = sheet
   end subroutine read_scene

   !> Give every value that is still 0, for it was not given, what it stands for.
   pure subroutine resolve_defaults(scene)
      type(scene_t), intent(inout) :: scene
      integer :: i

      if (.not. scene%has_fluid()) then  ! the programme takes one unit of time
         scene%time%end = 1.0_rk
         scene%time%step = 1.0_rk/real(scene%load%steps, rk)
      end if
      associate (load => scene%load)
         if (allocated(load%factors)) load%to = load%factors(size(load%factors))
         if (load%control == "") load%control = merge("dead  ", "length", allocated(load%factors))
      end associate
      call choose_steps(scene)
      if (scene%has_fluid() .and. .not. scene%fluid%vapour_pressure > -huge(1.0_rk)) then
         if (is_pressed(scene)) scene%fluid%vapour_pressure = 0.0_rk
      end if
      if (scene%has_fluid() .and. has_law(scene%fluid)) then
         associate (reference => scene%fluid%reference_pressure)
            if (.not. reference > -huge(1.0_rk)) reference = scene%initial%pressure
         end associate
      end if
      call choose_sizes(scene)
      associate (d => scene%discretization)
         if (.not. scene%has_fluid()) then
            call default(d%rosette_radius, d%size_fracture)
            call default(d%rosette_radius, d%size_boundary)  ! without fractures
         end if
      end associate
      if (allocated(scene%injections)) call name_wells(scene%injections)
      if (allocated(scene%regions)) call complete(scene%material, scene%regions)
      do i = 1, size(scene%fractures)
         if (scene%fractures(i)%law /= "slip") cycle
         call default(scene%fractures(i)%slip_taper, 0.5_rk*scene%fractures(i)%length())
      end do
   end subroutine resolve_defaults

   !> Wells without a name are called after their number; with stages they begin with the first,
   !! and one rate or pressure is that of all.
   pure subroutine name_wells(wells)
      type(injection_t), intent(inout) :: wells(:)
      integer(ik) :: i

      do i = 1, size(wells, kind=ik)
         if (wells(i)%name == "") wells(i)%name = "well_"//integer_text(i)
         if (.not. allocated(wells(i)%time)) cycle
         wells(i)%start = wells(i)%time(1)
         call repeat_value(wells(i)%rate, size(wells(i)%time))
         call repeat_value(wells(i)%pressure, size(wells(i)%time))
      end do
   end subroutine name_wells

   !> One value is that of all stages.
   pure subroutine repeat_value(list, n)
      real(rk), allocatable, intent(inout) :: list(:)  !< [any unit]
      integer, intent(in) :: n

      if (.not. allocated(list)) return
      if (size(list) == 1) list = spread(list(1), 1, n)
   end subroutine repeat_value

   !> The rock of regions is that of the scene but for what they give themselves.
   pure subroutine complete(material, regions)
      type(material_t), intent(in) :: material  !< of the scene
      type(region_t), intent(inout) :: regions(:)
      type(material_t) :: own
      integer :: i

      do i = 1, size(regions)
         own = regions(i)%material
         regions(i)%material = material
         associate (all => regions(i)%material)
            call take(own%young, all%young)
            call take(own%poisson, all%poisson)
            call take(own%biot, all%biot)
            call take(own%porosity, all%porosity)
            call take(own%density, all%density)
            call take(own%toughness, all%toughness)
            if (.not. own%permeability_xx > 0.0_rk) cycle
            all%permeability_xx = own%permeability_xx
            all%permeability_yy = own%permeability_yy
            all%permeability_xy = own%permeability_xy
         end associate
      end do
   end subroutine complete

   pure subroutine take(own, value)
      real(rk), intent(in) :: own  !< what is given, or not_given [any unit]
      real(rk), intent(inout) :: value  !< [unit of own]

      if (own < not_given) value = own
   end subroutine take

   !> Steps of a given length, or such that their error is small; fields as often as they are given,
   !! or a hundred times.
   pure subroutine choose_steps(scene)
      type(scene_t), intent(inout) :: scene
      real(rk), parameter :: usual_tolerance = 0.01_rk
      logical :: is_free

      associate (time => scene%time)
         is_free = .not. time%step > 0.0_rk
         if (is_free .or. (scene%has_fluid() .and. scene%growth%enabled .and. &
                           scene%growth%law == "equilibrium")) then
            call default(time%tolerance, usual_tolerance)
         end if
         call default(time%smallest_factor, merge(1.0e-9_rk, 1.0e-6_rk, is_free))
         call default(scene%output%interval, merge(0.01_rk*time%end, time%step, is_free))
      end associate
   end subroutine choose_steps

   !> Whether stresses and pressures of the scene are those of a state in situ, and not changes of
   !! one that it does not tell: only then 0 is vacuum.
   pure logical function is_pressed(scene)
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: outward(4) = [-1.0_rk, 1.0_rk, -1.0_rk, 1.0_rk]
      integer, parameter :: axis(4) = [1, 1, 2, 2]  ! across each side
      integer :: i

      is_pressed = scene%initial%pressure > 0.0_rk .or. scene%fluid%density > 0.0_rk &
                   .or. any(scene%in_situ%stress(1:2) < 0.0_rk) &
                   .or. any(abs(scene%in_situ%per_y) > 0.0_rk)
      do i = 1, 4
         associate (side => scene%sides(i))
            is_pressed = is_pressed .or. outward(i)*side%traction(axis(i)) < 0.0_rk &
                         .or. (side%pressure_given .and. side%pressure > 0.0_rk)
         end associate
      end do
      is_pressed = is_pressed .or. any(scene%sides%normal_traction < 0.0_rk)
      if (.not. allocated(scene%parts)) return
      associate (side => scene%parts)
         is_pressed = is_pressed .or. any(side%normal_traction < 0.0_rk) &
                      .or. any(side%pressure_given .and. side%pressure > 0.0_rk)
      end associate
   end function is_pressed

   pure subroutine default(value, otherwise)
      real(rk), intent(inout) :: value  !< [any unit]
      real(rk), intent(in) :: otherwise  !< [unit of value]

      if (.not. value > 0.0_rk) value = otherwise
   end subroutine default

end module scene_namelist
