!> Carries what holds and loads a body between the groups of a sheet and a scene, either way.
module scene_exchange_boundary
   use base_kinds, only: rk
   use scene_exchange_values, only: exchange, radians, to_degrees
   use scene_sheet, only: record_t
   use scene_types, only: boundary_part_t, boundary_side_t, point_load_t, restraint_t
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
      if (side%pressure_given) call exchange(record, "pressure", side%pressure, reading)
      call exchange(record, "normal_traction", side%normal_traction, reading, nothing=0.0_rk)
      call exchange(record, "shear_traction", side%shear_traction, reading, nothing=0.0_rk)
      if (record%is_set("normal_traction") .or. record%is_set("shear_traction")) return
      if (side%displacement_given(1)) then
         call exchange(record, "x_displacement", side%displacement(1), reading)
      else
         call exchange(record, "x_traction", side%traction(1), reading)
      end if
      if (side%displacement_given(2)) then
         call exchange(record, "y_displacement", side%displacement(2), reading)
      else
         call exchange(record, "y_traction", side%traction(2), reading)
      end if
   end subroutine exchange_side

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
