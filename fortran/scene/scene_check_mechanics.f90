!> Checks how the body is held and loaded.
module scene_check_mechanics
   use base_errors, only: error_t, raise_error
   use base_kinds, only: rk
   use scene_check_geometry, only: contains_point, point_text
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: scene_t
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: check_laws, check_load, check_points, check_support

contains

   !> Sides and restraints hold the body against its three rigid motions,
   !> u = (a - w y, b + w x): the held components exclude all of them.
   pure subroutine check_support(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: smallest = 1.0e-12_rk  ! of the sums' own scale
      real(rk) :: centre(2), reach, held(3, 3), rest, ends(2, 2, 4)
      integer :: side, k

      associate (d => scene%domain)
         centre = 0.5_rk*[d%x_min + d%x_max, d%y_min + d%y_max]
         reach = hypot(d%x_max - d%x_min, d%y_max - d%y_min)
         ends = reshape([d%x_min, d%y_min, d%x_min, d%y_max, d%x_max, d%y_min, d%x_max, d%y_max, &
                         d%x_min, d%y_min, d%x_max, d%y_min, d%x_min, d%y_max, d%x_max, d%y_max], &
                        [2, 2, 4])
      end associate
      held = 0.0_rk
      do side = 1, merge(0, 4, scene%domain%shape == "disc")
         do k = 1, 2
            call hold(ends(:, k, side), scene%sides(side)%displacement_given, held)
         end do
      end do
      do k = 1, size(scene%restraints)
         associate (point => scene%restraints(k))
            call hold([point%x, point%y], point%displacement_given, held)
         end associate
      end do
      if (.not. held(1, 1) > 0.0_rk) then
         call raise_error(error, "", sheet%path//": &side: no side has an x_displacement, but "// &
                          "one must hold the body against moving in x (see docs/input.md)")
         return
      else if (.not. held(2, 2) > 0.0_rk) then
         call raise_error(error, "", sheet%path//": &side: no side has a y_displacement, but "// &
                          "one must hold the body against moving in y (see docs/input.md)")
         return
      end if
      rest = held(3, 3) - held(1, 3)**2/held(1, 1) - held(2, 3)**2/held(2, 2)
      if (.not. rest > smallest*(held(1, 1) + held(2, 2))) then
         call raise_error(error, "", sheet%path//": &side: the body can rotate, but a side "// &
                          "must hold it: left or right an x_displacement, or bottom or top a "// &
                          "y_displacement (see docs/input.md)")
      end if

   contains

      !> Add the products of what a, b and w do to the held components of a point.
      pure subroutine hold(xy, given, sums)
         real(rk), intent(in) :: xy(2)  !< [m]
         logical, intent(in) :: given(2)
         real(rk), intent(inout) :: sums(3, 3)
         real(rk) :: arm(2), row(3)
         integer :: component, j

         arm = (xy - centre)/reach
         do component = 1, 2
            if (.not. given(component)) cycle
            row = merge([1.0_rk, 0.0_rk, -arm(2)], [0.0_rk, 1.0_rk, arm(1)], component == 1)
            do j = 1, 3
               sums(:, j) = sums(:, j) + row(j)*row
            end do
         end do
      end subroutine hold

   end subroutine check_support

   !> The load rises.
   pure subroutine check_load(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      associate (load => scene%load)
         if (.not. load%to > load%from) then
            call refuse(error, sheet, sheet%find("load"), "to", "is "//real_text(load%to)// &
                        " but must be greater than from, "//real_text(load%from))
         else if (scene%growth%enabled .and. load%from < 0.0_rk) then
            call refuse(error, sheet, sheet%find("load"), "from", "is "//real_text(load%from)// &
                        " but must be at least 0.0 where fractures grow")
         else if (scene%adaptive%enabled .and. size(scene%point_loads) > 0) then
            call refuse(error, sheet, sheet%find("adaptive"), "enabled", "is .true., but a "// &
                        "point load has infinite energy, which no mesh can follow")
         end if
      end associate
   end subroutine check_load

   !> Restraints and point loads are points of the body, and do something.
   pure subroutine check_points(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%restraints)
         associate (point => scene%restraints(i), record => sheet%find("restraint", i))
            if (.not. contains_point(scene%domain, point%x, point%y)) then
               call refuse(error, sheet, record, "x", "and y are "//point_text(point%x, point%y)// &
                           " but must lie within the domain")
               return
            else if (.not. any(point%displacement_given)) then
               call refuse(error, sheet, record, "", "holds nothing, but x_displacement or "// &
                           "y_displacement must be given")
               return
            end if
         end associate
      end do
      do i = 1, size(scene%point_loads)
         associate (point => scene%point_loads(i))
            if (contains_point(scene%domain, point%x, point%y)) cycle
            call refuse(error, sheet, sheet%find("point_load", i), "x", "and y are "// &
                        point_text(point%x, point%y)//" but must lie within the domain")
         end associate
         return
      end do
   end subroutine check_points

   !> Which face laws go with which scenes.
   pure subroutine check_laws(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%fractures)
         associate (fracture => scene%fractures(i), record => sheet%find("fracture", i))
            if (scene%has_fluid() .and. fracture%law /= "friction") then
               call refuse(error, sheet, record, "law", "is '"//trim(fracture%law)// &
                           "' but must be 'friction' in a scene with &fluid")
               return
            else if (fracture%law /= "friction" .and. &
                     (sheet%records(record)%is_given("friction") .or. &
                      sheet%records(record)%is_given("dilation_deg"))) then
               call refuse(error, sheet, record, "friction", "or dilation_deg is given with "// &
                           "the law '"//trim(fracture%law)//"', which has neither")
               return
            else if (fracture%law /= "slip" .and. &
                     (sheet%records(record)%is_given("slip") .or. &
                      sheet%records(record)%is_given("slip_taper"))) then
               call refuse(error, sheet, record, "slip", "or slip_taper is given with the law '"// &
                           trim(fracture%law)//"', which has neither")
               return
            else if (fracture%law == "open" .and. fracture%held_closed) then
               call refuse(error, sheet, record, "held_closed", "is .true., but the faces of "// &
                           "the law 'open' do not touch; give 'friction' or 'frictionless'")
               return
            end if
         end associate
      end do
   end subroutine check_laws

end module scene_check_mechanics
