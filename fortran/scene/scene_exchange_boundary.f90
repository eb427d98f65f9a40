!> Carries what holds and loads a body between the groups of a sheet and a scene, either way.
module scene_exchange_boundary
   use base_kinds, only: radians, rk
   use scene_exchange_values, only: exchange, to_degrees
   use scene_sheet, only: record_t
   use scene_sides, only: boundary_side_t, of_inflow, of_normal_traction, of_pressure, &
                          of_shear_traction, of_x_displacement, of_x_traction, &
                          of_y_displacement, of_y_traction, side_course_t, &
                          side_quantities
   use scene_types, only: boundary_part_t, point_load_t, restraint_t
   implicit none(type, external)
   private

   public :: exchange_part, exchange_point_load, exchange_restraint, exchange_side

contains

   !> A part of the boundary of a polygon or a disc.
   pure subroutine exchange_part(record, part, reading)
      type(record_t), intent(inout) :: record
      type(boundary_part_t), intent(inout) :: part
      logical, intent(in) :: reading
      real(rk) :: arc_deg(2)

      call exchange(record, "name", part%name, reading)
     if (reading) part%whole_rim = .not. (record%is_set("edges") .or. record%is_set("arc_from_deg"))
      if (reading .or. allocated(part%edges)) call exchange(record, "edges", part%edges, reading)
      if (.not. (part%whole_rim .or. allocated(part%edges))) then
         arc_deg = [to_degrees(part%arc(1)), to_degrees(part%arc(2))]
         call exchange(record, "arc_from_deg", arc_deg(1), reading)
         call exchange(record, "arc_to_deg", arc_deg(2), reading)
         part%arc = arc_deg*radians
      end if
      call exchange_side(record, part%boundary_side_t, reading)
   end subroutine exchange_part

   !> Without the side's name, which its place in scene_t%sides gives.
   pure subroutine exchange_side(record, side, reading)
      type(record_t), intent(inout) :: record
      type(boundary_side_t), intent(inout) :: side
      logical, intent(in) :: reading

      if (reading) then
         side%displacement_given = [record%is_set("x_displacement"), &
                                    record%is_set("y_displacement")]
         side%pressure_given = record%is_set("pressure")
      end if
      if (reading .or. side%changes()) call exchange(record, "time", side%course%time, reading)
      if (side%pressure_given) call exchange_value(record, of_pressure, side%pressure, &
                                                   side%course, reading)
      call exchange_value(record, of_inflow, side%inflow, side%course, reading, nothing=0.0_rk)
      call exchange_value(record, of_normal_traction, side%normal_traction, side%course, &
                          reading, nothing=0.0_rk)
      call exchange_value(record, of_shear_traction, side%shear_traction, side%course, &
                          reading, nothing=0.0_rk)
      call exchange(record, "x_spring", side%spring(1), reading, nothing=0.0_rk)
      call exchange(record, "y_spring", side%spring(2), reading, nothing=0.0_rk)
      if (record%is_set("normal_traction") .or. record%is_set("shear_traction")) return
      if (side%displacement_given(1)) then
         call exchange_value(record, of_x_displacement, side%displacement(1), side%course, reading)
      else
         call exchange_value(record, of_x_traction, side%traction(1), side%course, reading)
      end if
      if (side%displacement_given(2)) then
         call exchange_value(record, of_y_displacement, side%displacement(2), side%course, reading)
      else
         call exchange_value(record, of_y_traction, side%traction(2), side%course, reading)
      end if
   end subroutine exchange_side

   !> A quantity of a side: one value, or one per time.
   pure subroutine exchange_value(record, quantity, value, course, reading, nothing)
      type(record_t), intent(inout) :: record
      integer, intent(in) :: quantity  !< index into side_quantities
      real(rk), intent(inout) :: value  !< [unit of the quantity]
      type(side_course_t), intent(inout) :: course
      logical, intent(in) :: reading
      real(rk), intent(in), optional :: nothing  !< what an absent value is
      real(rk), allocatable :: list(:)
      character(len=:), allocatable :: name

      name = trim(side_quantities(quantity))
      if (.not. reading .and. allocated(course%values(quantity)%of)) then
         call exchange(record, name, course%values(quantity)%of, reading)
         return
      end if
      call exchange(record, name, value, reading, nothing)
      if (.not. reading) return
      call exchange(record, name, list, reading)
      if (.not. allocated(list)) return
      if (size(list) > 1) call move_alloc(list, course%values(quantity)%of)
   end subroutine exchange_value

   pure subroutine exchange_restraint(record, restraint, reading)
      type(record_t), intent(inout) :: record
      type(restraint_t), intent(inout) :: restraint
      logical, intent(in) :: reading
      character(len=1), parameter :: axes(2) = ["x", "y"]
      integer :: axis

      call exchange(record, "x", restraint%x, reading)
      call exchange(record, "y", restraint%y, reading)
      do axis = 1, 2
         if (.not. restraint%displacement_given(axis)) cycle
         call exchange(record, axes(axis)//"_displacement", restraint%displacement(axis), reading)
      end do
   end subroutine exchange_restraint

   pure subroutine exchange_point_load(record, point_load, reading)
      type(record_t), intent(inout) :: record
      type(point_load_t), intent(inout) :: point_load
      logical, intent(in) :: reading

      call exchange(record, "x", point_load%x, reading)
      call exchange(record, "y", point_load%y, reading)
      call exchange(record, "x_force", point_load%force(1), reading)
      call exchange(record, "y_force", point_load%force(2), reading)
   end subroutine exchange_point_load

end module scene_exchange_boundary
