!> Checks regions: the names that their shape requires, simple outlines, overlap with the body.
module scene_check_regions
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_plane, only: cross, crosses, norm2, polygon_area
   use base_tolerances, only: round_off, same_place
   use scene_check_permeability, only: check_tensor
   use scene_fluid_law, only: least_compressibility, skempton, storage
   use scene_parameters, only: groups
   use scene_region_outline, only: body_part, region_outline
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: material_t, region_t, scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_given_regions, check_regions

   !> Names of which a region must give at least one.
   character(len=17), parameter :: of_rock(11) = [character(len=17) :: &
                                           "young", "poisson", "biot", "porosity", "permeability", &
                                                  "permeability_xx", "density", "toughness", &
                                                  "heat_capacity", "heat_conductivity", &
                                                  "heat_expansion"]
   !> Largest ratio of Young's moduli of adjacent rocks, limited by rounding [-].
   real(rk), parameter :: stiffest = 1.0e9_rk
   real(rk), parameter :: most_contrast = 1.0e12_rk  !< largest ratio of permeabilities [-]

   integer, parameter :: most_points = 1000  !< points of a curve: every pair of edges is compared

contains

   !> Regions have rock properties, and all shapes except the parabola have points.
   pure subroutine check_given_regions(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=1), parameter :: names(2) = ["x", "y"]
      type(value_t) :: shape
      integer :: axis, i, k

      do i = 1, sheet%length
         if (groups(sheet%records(i)%group)%name /= "region") cycle
         shape = sheet%records(i)%value("shape")
         if (.not. any([(sheet%records(i)%is_given(trim(of_rock(k))), k=1, size(of_rock))])) then
            call refuse(error, sheet, i, "name", "is given, but the region has no rock "// &
                        "properties: it must have at least one of young, poisson, biot, "// &
                        "porosity, permeability, density, toughness, heat_capacity, "// &
                        "heat_conductivity, heat_expansion")
            return
         end if
         do axis = 1, 2
            associate (is_given => sheet%records(i)%is_given(names(axis)))
               if (is_given .and. shape%text == "parabola") then
                  call refuse(error, sheet, i, names(axis), "is given, but the shape "// &
                              "'parabola' has x_vertex, y_vertex and curvature instead")
               else if (.not. (is_given .or. shape%text == "parabola")) then
                  call refuse(error, sheet, i, names(axis), "[m], which the shape '"// &
                              shape%text//"' needs, is missing")
               end if
            end associate
            if (allocated(error)) return
         end do
      end do
   end subroutine check_given_regions

   !> Check the numbers of each region against each other and the body.
   pure subroutine check_regions(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      do i = 1, size(scene%regions)
         record = sheet%find("region", i)
         call check_points(sheet, record, scene%regions(i), error)
         if (.not. allocated(error)) call check_outline(sheet, record, scene, i, error)
         if (.not. allocated(error)) call check_rock(sheet, record, scene, scene%regions(i), error)
         if (scene%has_fluid() .and. .not. allocated(error)) then
            call check_tensor(sheet, record, scene%regions(i)%material, error)
         end if
         if (.not. allocated(error)) call check_contrasts(sheet, scene, i, error)
         if (allocated(error)) return
      end do
   end subroutine check_regions

   !> In the rock of a region storage is positive, and the undrained pressure due to a load is not
   !! larger than the load. A toughness requires one of the scene's rock.
   pure subroutine check_rock(sheet, record, scene, region, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(scene_t), intent(in) :: scene
      type(region_t), intent(in) :: region
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: name, whose

      whose = "of region '"//trim(region%name)//"' "
      associate (m => region%material, fluid => scene%fluid, given => sheet%records(record))
         if (m%toughness < huge(1.0_rk) .and. &
             .not. scene%material%toughness < huge(1.0_rk)) then
            call refuse(error, sheet, record, "toughness", whose//"is given, but that of "// &
                        "&material, which the rest of the body has, is missing")
            return
         end if
         if (.not. scene%has_fluid()) return
         name = "porosity"
         if (given%is_given("biot")) name = "biot"
         if (m%biot < m%porosity) then
            call refuse(error, sheet, record, name, whose// &
                        "makes its Biot coefficient "//real_text(m%biot)// &
                        " smaller than its porosity, "//real_text(m%porosity)// &
                        ", but it must be at least that")
         else if (.not. storage(m, fluid) > 0.0_rk) then
            call refuse(error, sheet, record, name, whose// &
                        "gives no storage: phi c_p and the part of the solid are both zero, "// &
                        "but their sum must be positive")
         else if (.not. fluid%compressibility > 0.0_rk .and. &
                  skempton(m, fluid) > 1.0_rk + round_off) then
            call refuse(error, sheet, record, "name", "'"//trim(region%name)//"' stands for a "// &
                        "rock whose Skempton coefficient B = alpha/(K S + alpha^2) is "// &
                        rounded_text(skempton(m, fluid))//" with a fluid of no "// &
                        "compressibility, but that must be at most 1; "// &
                        rounded_text(least_compressibility(m))//" 1/Pa would make it 1")
         end if
      end associate
   end subroutine check_rock

   !> Young's moduli, and with a fluid permeabilities, of a region and of the scene's rock or an
   !! earlier region do not differ too much for rounding; permeabilities are averaged in cut cells.
   pure subroutine check_contrasts(sheet, scene, i, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< region
      type(error_t), allocatable, intent(out) :: error
      type(material_t) :: other
      character(len=:), allocatable :: name, whose
      real(rk) :: extremes(2), others(2)
      integer :: k, record

      record = sheet%find("region", i)
      whose = "of region '"//trim(scene%regions(i)%name)//"' and "
      do k = 0, i - 1
         other = scene%material
         if (k > 0) other = scene%regions(k)%material
         associate (young => scene%regions(i)%material%young)
            if (max(young/other%young, other%young/young) > stiffest*(1.0_rk + round_off)) then
              call refuse(error, sheet, record, "young", whose//"that of the rock around it or "// &
                           "of another region differ by more than a factor of 1e9 but must not")
               return
            end if
         end associate
         if (.not. scene%has_fluid()) cycle
         extremes = principal(scene%regions(i)%material)
         others = principal(other)
         if (max(extremes(2)/others(1), others(2)/extremes(1)) &
             <= most_contrast*(1.0_rk + round_off)) cycle
         name = "permeability"
         if (.not. sheet%records(record)%is_given(name)) name = "permeability_xx"
        call refuse(error, sheet, record, name, whose//"the permeability of the rock around it "// &
                     "or of another region differ by more than a factor of 1e12 but must not")
         return
      end do
   end subroutine check_contrasts

   !> The least and the largest permeability over all directions.
   pure function principal(material) result(extremes)
      type(material_t), intent(in) :: material
      real(rk) :: extremes(2)  !< [m2]
      real(rk) :: largest

      associate (m => material)
         largest = 0.5_rk*(m%permeability_xx + m%permeability_yy) &
                   + hypot(0.5_rk*(m%permeability_xx - m%permeability_yy), m%permeability_xy)
         extremes = [(m%permeability_xx*m%permeability_yy - m%permeability_xy**2)/largest, largest]
      end associate
   end function principal

   !> Lists of coordinates have the lengths that the shape requires.
   pure subroutine check_points(sheet, record, region, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(region_t), intent(in) :: region
      type(error_t), allocatable, intent(out) :: error

      select case (region%shape)
      case ("parabola")
         call check_list(sheet, record, region, "x_vertex", region%x_vertex, 1, 2, error)
         if (.not. allocated(error)) call check_equal(sheet, record, region, "y_vertex", &
                                                region%y_vertex, "x_vertex", region%x_vertex, error)
         if (.not. allocated(error)) call check_equal(sheet, record, region, "curvature", &
                                               region%curvature, "x_vertex", region%x_vertex, error)
         return
      case ("half_plane")
         call check_list(sheet, record, region, "x", region%x, 2, 2, error)
      case ("band")
         call check_list(sheet, record, region, "x", region%x, 2, most_points, error)
         if (.not. allocated(error)) call check_list(sheet, record, region, "x_other", &
                                                     region%x_other, 2, most_points, error)
         if (.not. allocated(error)) call check_equal(sheet, record, region, "y_other", &
                                                   region%y_other, "x_other", region%x_other, error)
      case default
         call check_list(sheet, record, region, "x", region%x, 3, 2*most_points, error)
      end select
      if (.not. allocated(error)) call check_equal(sheet, record, region, "y", region%y, "x", &
                                                   region%x, error)
   end subroutine check_points

   !> The number of values of a list is within limits.
   pure subroutine check_list(sheet, record, region, name, values, least, most, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record, least, most
      type(region_t), intent(in) :: region
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: values(:)  !< [m]
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: wanted

      if (size(values) >= least .and. size(values) <= most) return
      wanted = integer_text(int(least, ik))
      if (most > least) wanted = wanted//" to "//integer_text(int(most, ik))
      call refuse(error, sheet, record, name, "of region '"//trim(region%name)//"' has "// &
                  count_text(size(values))//" but the shape '"//trim(region%shape)// &
                  "' must have "//wanted)
   end subroutine check_list

   !> Two lists have equally many values.
   pure subroutine check_equal(sheet, record, region, name, values, like, others, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(region_t), intent(in) :: region
      character(len=*), intent(in) :: name, like
      real(rk), intent(in) :: values(:), others(:)  !< [any unit]
      type(error_t), allocatable, intent(out) :: error

      if (size(values) == size(others)) return
      call refuse(error, sheet, record, name, "of region '"//trim(region%name)//"' has "// &
                  count_text(size(values))//" but must have as many as "//like//", "// &
                  integer_text(size(others, kind=ik)))
   end subroutine check_equal

   !> "1 value", "2 values".
   pure function count_text(n) result(text)
      integer, intent(in) :: n
      character(len=:), allocatable :: text

      text = integer_text(int(n, ik))//trim(merge(" value ", " values", n == 1))
   end function count_text

   !> The outline has an area, does not cross itself, and contains a part of the body.
   pure subroutine check_outline(sheet, record, scene, i, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< region
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: corners(:, :)
      character(len=:), allocatable :: name, whose
      real(rk) :: area
      integer(ik) :: edges(2)

      associate (region => scene%regions(i), body => scene%domain)
         name = trim(merge("x_vertex", "x       ", region%shape == "parabola"))
         whose = "of region '"//trim(region%name)//"' "
         if (region%shape == "half_plane") then
            if (.not. norm2([region%x(2) - region%x(1), region%y(2) - region%y(1)]) > &
                0.0_rk) then
               call refuse(error, sheet, record, name, whose//"and y give one point twice but "// &
                           "must give two, a line")
               return
            end if
         end if
         corners = region_outline(region, body)
         if (region%shape /= "half_plane") then
            edges = first_crossing(corners)
            if (edges(1) > 0) then
              call refuse(error, sheet, record, name, "and the rest "//whose//"give an outline "// &
                          "that crosses or touches itself near "//place_text(corners(:, edges(1))) &
                           //" but its edges must meet at their ends only")
               return
            end if
         end if
         area = polygon_area(body_part(region, body))
         if (.not. area > same_place*(body%x_max - body%x_min)*(body%y_max - body%y_min)) then
            call refuse(error, sheet, record, name, "and the rest "//whose//"define a region "// &
                        "outside the body, but it must contain a part of the body")
         end if
      end associate
   end subroutine check_outline

   !> The first pair of edges that cross, touch or overlap, where edge k connects corner k and the
   !! next; 0 if there is none.
   pure function first_crossing(corners) result(edges)
      real(rk), intent(in) :: corners(:, :)  !< (2, n) [m]
      integer(ik) :: edges(2)
      integer(ik) :: a, b, n, next_a, next_b

      n = size(corners, 2, kind=ik)
      edges = 0
      do a = 1, n
         next_a = mod(a, n) + 1_ik
         do b = a + 1, n
            next_b = mod(b, n) + 1_ik
            if (b == next_a .or. next_b == a) then
               if (.not. folds_back(corners, merge(a, b, b == next_a))) cycle
            else if (.not. crosses(corners(:, [a, next_a]), corners(:, [b, next_b]))) then
               cycle
            end if
            edges = [a, b]
            return
         end do
      end do
   end function first_crossing

   !> The edge after an edge overlaps with it.
   pure logical function folds_back(corners, edge)
      real(rk), intent(in) :: corners(:, :)  !< [m]
      integer(ik), intent(in) :: edge
      real(rk) :: along(2), after(2)
      integer(ik) :: n, next

      n = size(corners, 2, kind=ik)
      next = mod(edge, n) + 1_ik
      along = corners(:, next) - corners(:, edge)
      after = corners(:, mod(next, n) + 1_ik) - corners(:, next)
      folds_back = abs(cross(along, after)) <= same_place*norm2(along)*norm2(after) .and. &
                   dot_product(along, after) < 0.0_rk
   end function folds_back

   !> A point in words, rounded.
   pure function place_text(xy) result(text)
      real(rk), intent(in) :: xy(2)  !< [m]
      character(len=:), allocatable :: text

      text = "("//rounded_text(xy(1))//", "//rounded_text(xy(2))//")"
   end function place_text

end module scene_check_regions
