!> Checks numbers of the geometry against each other: extents, cell sizes, lists of coordinates, and
!! positions of wells and probes. Whether body and fractures can be meshed is checked by the mesh
!! library.
!!
!! Whether a polygon, given by its corners, contains a point.
module scene_check_geometry
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_plane, only: point_distance, triangle_area
   use base_tolerances, only: same_place
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: domain_t, fracture_t, scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_domain, check_fractures, check_least_size, check_probes, contains_point
   public :: distance_to, holds_point, point_text

   !> Smaller elements, over the body's diagonal, drown in the rounding of coordinates.
   real(rk), parameter :: least_size = 1.0e-8_rk

contains

   !> The rectangle has an area, and the cells fit into it.
   pure subroutine check_domain(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: shorter_edge

      call check_shape(sheet, scene, error)
      if (allocated(error)) return
      associate (d => scene%domain, size_boundary => scene%discretization%size_boundary)
         if (.not. d%x_max > d%x_min) then
            call refuse(error, sheet, sheet%find("domain"), "x_max", "is "//real_text(d%x_max)// &
                        " but must be greater than x_min, "//real_text(d%x_min))
            return
         else if (.not. d%y_max > d%y_min) then
            call refuse(error, sheet, sheet%find("domain"), "y_max", "is "//real_text(d%y_max)// &
                        " but must be greater than y_min, "//real_text(d%y_min))
            return
         end if
         shorter_edge = min(d%x_max - d%x_min, d%y_max - d%y_min)
         if (size_boundary > shorter_edge) then
            call refuse(error, sheet, mesh_record(sheet), "size_boundary", "is "// &
                        real_text(size_boundary)//" but must be at most the shorter edge of "// &
                        "the domain, "//rounded_text(shorter_edge))
         end if
      end associate
   end subroutine check_domain

   !> No size that a scene gives is lost in its body.
   pure subroutine check_least_size(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: least
      integer :: i

      associate (body => scene%domain, sizes => scene%discretization)
         least = least_size*norm2([body%x_max - body%x_min, body%y_max - body%y_min])
         do i = 1, merge(size(scene%fractures), 0, sizes%chosen)  ! then cells are no cause
            call check_length(sheet, scene, i, least, error)
            if (allocated(error)) return
         end do
         if (size(scene%fractures) > 0 .and. scene%smallest_cell() < least) then
            call refuse(error, sheet, mesh_record(sheet), "size_fracture", &
                        blurred(scene%smallest_cell(), least))
         else if (.not. scene%has_fluid() .and. sizes%rosette_radius < least) then
            call refuse(error, sheet, mesh_record(sheet), "rosette_radius", &
                        blurred(sizes%rosette_radius, least))
         else if (scene%growth%intensities .and. scene%has_fluid()) then
            if (sizes%fine_ratio*scene%smallest_cell() >= least) return
            call refuse(error, sheet, sheet%find("fine"), "size_ratio", &
                        blurred(sizes%fine_ratio, least/scene%smallest_cell()))
         end if
      end associate
   end subroutine check_least_size

   !> A fracture is long enough for any cells.
   pure subroutine check_length(sheet, scene, i, least, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< index of the fracture
      real(rk), intent(in) :: least  !< [m]
      type(error_t), allocatable, intent(out) :: error

      call check_vertices(sheet, i, scene%fractures(i), error)
      if (allocated(error)) return
      associate (length => scene%fractures(i)%length())
         if (length >= least) return
         call refuse(error, sheet, sheet%find("fracture", i), "x", "and y of fracture '"// &
                     trim(scene%fractures(i)%name)//"' give it a length of "// &
                     rounded_text(length)//" but it must have at least "//rounded_text(least)// &
                     ": elements of less than "//real_text(least_size)//" of the body's "// &
                     "diagonal cannot be meshed")
      end associate
   end subroutine check_length

   pure function blurred(given, least) result(reason)
      real(rk), intent(in) :: given, least  !< [m], or shares of another size
      character(len=:), allocatable :: reason

      reason = "is "//real_text(given)//" but must be at least "//rounded_text(least)// &
               ": elements of less than "//real_text(least_size)//" of the body's diagonal "// &
               "cannot be meshed"
   end function blurred

   !> What a shape needs.
   pure subroutine check_shape(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      if (scene%domain%shape == "polygon") call check_corners(sheet, scene%domain, error)
   end subroutine check_shape

   !> A polygon has corners.
   pure subroutine check_corners(sheet, domain, error)
      type(sheet_t), intent(in) :: sheet
      type(domain_t), intent(in) :: domain
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_corners = 2000  ! every pair of edges is compared
      integer(ik) :: n
      integer :: record

      record = sheet%find("domain")
      n = size(domain%x, kind=ik)
      if (size(domain%y) /= n) then
         call refuse(error, sheet, record, "y", "has "// &
                     integer_text(size(domain%y, kind=ik))//" values but must have as many as "// &
                     "x, "//integer_text(n))
      else if (n < 3) then
         call refuse(error, sheet, record, "x", "has "//integer_text(n)//" values but must "// &
                     "have at least 3, the corners of the polygon")
      else if (n > most_corners) then
         call refuse(error, sheet, record, "x", "has "//integer_text(n)//" values but must "// &
                     "have at most 2000")
      end if
   end subroutine check_corners

   !> The group that tells the cell sizes.
   pure integer function mesh_record(sheet)
      type(sheet_t), intent(in) :: sheet

      mesh_record = sheet%find("coarse") + sheet%find("fe")  ! a scene has one of them
   end function mesh_record

   !> Fractures are polylines, longer than their cells.
   pure subroutine check_fractures(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%fractures)
         call check_vertices(sheet, i, scene%fractures(i), error)
         if (allocated(error)) return
         if (scene%fractures(i)%cell_size > 0.0_rk) then
            call check_cell_size(sheet, scene, i, error)
            if (allocated(error)) return
         else if (scene%discretization%size_fracture > scene%fractures(i)%length()) then
            call refuse(error, sheet, mesh_record(sheet), "size_fracture", "is "// &
                        real_text(scene%discretization%size_fracture)// &
                        " but must be at most the length of fracture '"// &
                        trim(scene%fractures(i)%name)//"', "// &
                        rounded_text(scene%fractures(i)%length())//"; omit it, so that "// &
                        "cells follow from the length of each fracture")
            return
         end if
      end do
   end subroutine check_fractures

   !> Cells of its own are no larger than the fracture, and than those far from it.
   pure subroutine check_cell_size(sheet, scene, i, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< index of the fracture
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: bound
      real(rk) :: most

      associate (fracture => scene%fractures(i))
         bound = "size_boundary"
         most = scene%discretization%size_boundary
         if (fracture%length() < most) then
            most = fracture%length()
            bound = "the length of the fracture"
         end if
         if (fracture%cell_size <= most) return
         call refuse(error, sheet, sheet%find("fracture", i), "cell_size", "of fracture '"// &
                     trim(fracture%name)//"' is "//real_text(fracture%cell_size)// &
                     " but must be at most "//bound//", "//rounded_text(most))
      end associate
   end subroutine check_cell_size

   pure subroutine check_vertices(sheet, i, fracture, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index of the fracture
      type(fracture_t), intent(in) :: fracture
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: whose
      integer :: record, n

      record = sheet%find("fracture", i)
      whose = "of fracture '"//trim(fracture%name)//"' "
      n = size(fracture%x)
      if (size(fracture%y) /= n) then
         call refuse(error, sheet, record, "y", whose//"has "//integer_text(size(fracture%y, &
                                                                                 kind=ik))// &
                     " values but must have as many as x, "//integer_text(int(n, ik)))
      else if (n < 2) then
         call refuse(error, sheet, record, "x", whose//"has one value but must have at least "// &
                     "two, the ends of the fracture")
      end if
   end subroutine check_vertices

   pure subroutine check_probes(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%probes)
         associate (probe => scene%probes(i))
            if (contains_point(scene%domain, probe%x, probe%y)) cycle
            call refuse(error, sheet, sheet%find("probe", i), "x", "and y of probe '"// &
                        trim(probe%name)//"' are "//point_text(probe%x, probe%y)// &
                        " but must lie within the domain")
         end associate
         return
      end do
   end subroutine check_probes

   !> Inside or on the boundary.
   pure logical function contains_point(domain, x, y)
      type(domain_t), intent(in) :: domain
      real(rk), intent(in) :: x, y

      if (domain%shape == "polygon") then
         contains_point = holds_point(domain%x, domain%y, [x, y])
         return
      end if
      contains_point = x >= domain%x_min .and. x <= domain%x_max .and. &
                       y >= domain%y_min .and. y <= domain%y_max
      if (domain%shape == "disc") then
         contains_point = hypot(x - domain%x_centre, &
                                y - domain%y_centre) <= domain%radius*(1.0_rk + same_place)
      end if
   end function contains_point

   !> Distance of a point from the nearest point of a polyline [m].
   pure real(rk) function distance_to(fracture, x, y) result(distance)
      type(fracture_t), intent(in) :: fracture
      real(rk), intent(in) :: x, y
      real(rk) :: along(2), to_point(2), share
      integer :: k

      distance = huge(1.0_rk)
      do k = 2, size(fracture%x)
         along = [fracture%x(k) - fracture%x(k - 1), fracture%y(k) - fracture%y(k - 1)]
         to_point = [x - fracture%x(k - 1), y - fracture%y(k - 1)]
         share = min(1.0_rk, max(0.0_rk, dot_product(along, to_point)/dot_product(along, along)))
         distance = min(distance, norm2(to_point - share*along))
      end do
   end function distance_to

   pure function point_text(x, y) result(text)
      real(rk), intent(in) :: x, y
      character(len=:), allocatable :: text

      text = "("//real_text(x)//", "//real_text(y)//")"
   end function point_text

   !> A point lies inside or, up to rounding, on the boundary.
   pure logical function holds_point(x, y, point)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk) :: extent, edge(2, 2)
      integer(ik) :: n, k, next
      logical :: is_inside

      n = size(x, kind=ik)
      extent = max(maxval(x) - minval(x), maxval(y) - minval(y))
      holds_point = .true.
      is_inside = .false.
      do k = 1, n
         next = mod(k, n) + 1_ik
         edge = reshape([x(k), y(k), x(next), y(next)], [2, 2])
         if (point_distance(point, edge) <= same_place*extent) return
         ! A ray to the right meets the outline an odd number of times (Shimrat 1962).
         if ((edge(2, 1) > point(2)) .eqv. (edge(2, 2) > point(2))) cycle
         if ((triangle_area(reshape([edge(:, 1), edge(:, 2), point], [2, 3])) > 0.0_rk) .eqv. &
             edge(2, 2) > edge(2, 1)) is_inside = .not. is_inside
      end do
      holds_point = is_inside
   end function holds_point

end module scene_check_geometry
