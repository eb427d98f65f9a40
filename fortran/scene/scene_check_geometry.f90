!> Checks numbers of the geometry against each other: extents, cell sizes, lists of coordinates, and
!! positions of wells and probes. The mesh library checks whether body and fractures can be meshed.
module scene_check_geometry
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_plane, only: meeting, nearest_share, norm2, point_distance
   use base_tolerances, only: same_place
   use scene_region_outline, only: is_inside
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: domain_t, fracture_t, scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_domain, check_fractures, check_least_size, check_probes, contains_point
   public :: distance_to, holds_point, near_end_t, near_ends, point_text

   !> Smallest size of elements over the body's diagonal, for the rounding of coordinates [-].
   real(rk), parameter :: least_size = 1.0e-8_rk

   !> An end of a fracture near a target.
   type :: near_end_t
      integer :: fracture = 0  !< fracture of the end
      integer :: other = 0  !< fracture near the end; 0: a side
      integer :: side = 0  !< left, right, bottom, top
      real(rk) :: distance = 0.0_rk  !< [m]
      logical :: is_past = .false.  !< the fracture crosses the other one and ends behind it
   end type near_end_t

contains

   !> The body has an area, and the cells fit into it.
   pure subroutine check_domain(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: shorter_edge

      if (scene%domain%shape == "polygon") call check_corners(sheet, scene%domain, error)
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

   !> The given sizes are large enough for the coordinates of the body.
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
                        too_small(scene%smallest_cell(), least))
         else if (.not. scene%has_fluid() .and. sizes%rosette_radius < least) then
            call refuse(error, sheet, mesh_record(sheet), "rosette_radius", &
                        too_small(sizes%rosette_radius, least))
         else if (scene%growth%intensities .and. scene%has_fluid()) then
            if (sizes%fine_ratio*scene%smallest_cell() >= least) return
            call refuse(error, sheet, sheet%find("fine"), "size_ratio", &
                        too_small(sizes%fine_ratio, least/scene%smallest_cell()))
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

   !> Reason for refusing a size.
   pure function too_small(given, least) result(reason)
      real(rk), intent(in) :: given, least  !< [m], or fractions of another size [-]
      character(len=:), allocatable :: reason

      reason = "is "//real_text(given)//" but must be at least "//rounded_text(least)// &
               ": elements of less than "//real_text(least_size)//" of the body's diagonal "// &
               "cannot be meshed"
   end function too_small

   !> A polygon has 3 to 2000 corners, each with x and y.
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

   !> Index of the group with the cell sizes in sheet%records.
   pure integer function mesh_record(sheet)
      type(sheet_t), intent(in) :: sheet

      mesh_record = sheet%find("coarse") + sheet%find("fe")  ! a scene has one of them
   end function mesh_record

   !> Fractures are polylines, at least as long as their cells.
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

   !> The cell_size of a fracture is at most its length and size_boundary.
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

   !> A fracture has at least two vertices, each with x and y.
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

   !> Probes lie in the body.
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

   !> A point lies inside the body or on its boundary.
   pure logical function contains_point(domain, x, y)
      type(domain_t), intent(in) :: domain
      real(rk), intent(in) :: x, y  !< [m]

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
      real(rk), intent(in) :: x, y  !< [m]
      real(rk) :: segment(2, 2)
      integer :: k

      distance = huge(1.0_rk)
      do k = 2, size(fracture%x)
         segment = transpose(reshape([fracture%x(k - 1:k), fracture%y(k - 1:k)], [2, 2]))
         distance = min(distance, point_distance([x, y], segment))
      end do
   end function distance_to

   !> A point in words: "(x, y)".
   pure function point_text(x, y) result(text)
      real(rk), intent(in) :: x, y  !< [m]
      character(len=:), allocatable :: text

      text = "("//real_text(x)//", "//real_text(y)//")"
   end function point_text

   !> A point lies inside a polygon or, up to rounding, on its boundary.
   pure logical function holds_point(x, y, point)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk) :: extent, outline(2, size(x))
      integer :: k, n

      n = size(x)
      outline(1, :) = x
      outline(2, :) = y
      extent = max(maxval(x) - minval(x), maxval(y) - minval(y))
      holds_point = is_inside(outline, point)
      do k = 1, n
         if (holds_point) return
         holds_point = point_distance(point, outline(:, [k, mod(k, n) + 1])) <= same_place*extent
      end do
   end function holds_point

   !> All ends that are near another fracture or a side but do not touch it. Two ends near each
   !! other are listed once.
   pure function near_ends(fractures, domain, near) result(list)
      type(fracture_t), intent(in) :: fractures(:)
      type(domain_t), intent(in) :: domain  !< only sides of a rectangle are checked
      real(rk), intent(in) :: near  !< distance [m]
      type(near_end_t), allocatable :: list(:)
      real(rk) :: distance, last(2, 2), to_side(4)
      integer :: end, i, j, side
      logical :: is_at_end, is_past

      allocate (list(0))
      do i = 1, size(fractures)
         do end = 1, 2
            last = last_segment(fractures(i), end)
            to_side = [last(1, 1) - domain%x_min, domain%x_max - last(1, 1), &
                       last(2, 1) - domain%y_min, domain%y_max - last(2, 1)]
            do side = 1, merge(4, 0, domain%shape == "rectangle")
               if (is_near(to_side(side))) list = [list, near_end_t(i, 0, side, to_side(side))]
            end do
            do j = 1, size(fractures)
               if (j == i) cycle
               call measure(last, fractures(j), distance, is_at_end, is_past)
               if (.not. is_near(distance)) cycle
               if (is_at_end .and. j < i .and. .not. is_past) cycle
               list = [list, near_end_t(i, j, 0, distance, is_past)]
            end do
         end do
      end do

   contains

      pure logical function is_near(distance)
         real(rk), intent(in) :: distance  !< [m]

         is_near = distance > same_place*fractures(i)%length() .and. distance < near
      end function is_near

   end function near_ends

   !> The last segment at an end of a fracture, from the end inwards [m].
   pure function last_segment(fracture, end) result(ends)
      type(fracture_t), intent(in) :: fracture
      integer, intent(in) :: end  !< 1 or 2
      real(rk) :: ends(2, 2)
      integer :: first, next

      first = merge(1, size(fracture%x), end == 1)
      next = merge(2, size(fracture%x) - 1, end == 1)
      ends(:, 1) = [fracture%x(first), fracture%y(first)]
      ends(:, 2) = [fracture%x(next), fracture%y(next)]
   end function last_segment

   !> Find the distance of an end from a fracture, or the length beyond a fracture that it crosses.
   pure subroutine measure(last, other, distance, is_at_end, is_past)
      real(rk), intent(in) :: last(2, 2)  !< last segment, from the end inwards [m]
      type(fracture_t), intent(in) :: other
      real(rk), intent(out) :: distance  !< [m]
      logical, intent(out) :: is_at_end  !< the nearest point is an end of the other fracture
      logical, intent(out) :: is_past  !< the fracture crosses the other one
      real(rk) :: ends(2, 2), here, length, place, share(2)
      integer(ik) :: n, v

      distance = huge(1.0_rk)
      is_at_end = .false.
      is_past = .false.
      length = norm2(last(:, 2) - last(:, 1))
      n = size(other%x, kind=ik)
      do v = 1, n - 1
         ends = reshape([other%x(v), other%y(v), other%x(v + 1), other%y(v + 1)], [2, 2])
         here = point_distance(last(:, 1), ends)
         share = meeting(last, ends)
         if (all(share >= 0.0_rk .and. share <= 1.0_rk) .and. &
             here > same_place*length .and. share(1)*length < distance) then
            distance = share(1)*length
            is_past = .true.
            is_at_end = .false.
         else if (here < distance) then
            distance = here
            is_past = .false.
            place = nearest_share(last(:, 1), ends)
            is_at_end = (v == 1 .and. place <= 0.0_rk) .or. (v == n - 1 .and. place >= 1.0_rk)
         end if
      end do
   end subroutine measure

end module scene_check_geometry
