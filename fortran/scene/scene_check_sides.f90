!> Checks the sides of the body, their names and conditions, and the faces of fractures: closure and
!! aperture, the strengths of a bond and friction, toughness.
module scene_check_sides
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_number, only: integer_text
   use base_tolerances, only: same_direction
   use scene_parameters, only: groups, side_names
   use scene_sheet, only: record_t, refuse, sheet_t
   use scene_sides, only: side_quantities
   use scene_types, only: boundary_part_t, fracture_t, scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_faces, check_parts, check_sides

   real(rk), parameter :: turn = 2.0_rk*pi  !< [rad]

   !> Largest closure over the aperture: smaller apertures are lost among the iterates with
   !! overlapping faces (coarse_fracture_flow) [-].
   real(rk), parameter :: largest_closure = 0.98_rk

contains

   !> Names given for a side are consistent with each other and with the shape of the body.
   pure subroutine check_sides(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: shape
      integer :: i

      shape = sheet%records(sheet%find("domain"))%value("shape")
      do i = 1, sheet%length
         if (groups(sheet%records(i)%group)%name /= "side") cycle
         call check_place(sheet, i, shape%text, error)
         if (.not. allocated(error)) call check_values(sheet, i, error)
         if (.not. allocated(error)) call check_course(sheet, i, error)
         if (allocated(error)) return
      end do
   end subroutine check_sides

   !> Location of a side: sides of a rectangle have names, those of a polygon edges, of a disc arcs.
   pure subroutine check_place(sheet, i, shape, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index of the record
      character(len=*), intent(in) :: shape
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: name, from, to

      associate (record => sheet%records(i))
         name = record%value("name")
         if (shape == "rectangle" .and. .not. any(side_names == name%text)) then
            call refuse(error, sheet, i, "name", "is '"//name%text//"' but must be 'left', "// &
                        "'right', 'bottom' or 'top'")
         else if (shape /= "polygon" .and. record%is_given("edges")) then
            call refuse(error, sheet, i, "edges", "is given, but only a polygon has edges")
         else if (shape == "polygon" .and. .not. record%is_given("edges")) then
            call refuse(error, sheet, i, "edges", "is missing, but a side of a polygon needs "// &
                        "the numbers of its edges")
         else if (shape /= "disc" .and. (record%is_given("arc_from_deg") .or. &
                                         record%is_given("arc_to_deg"))) then
            call refuse(error, sheet, i, given_of(record, "arc_from_deg", "arc_to_deg"), &
                        "is given, but only a disc has arcs")
         else if (record%is_given("arc_from_deg") .and. record%is_given("arc_to_deg")) then
            from = record%value("arc_from_deg")
            to = record%value("arc_to_deg")
            if (.not. (to%reals(1) > from%reals(1) .and. to%reals(1) <= from%reals(1) + 360)) then
               call refuse(error, sheet, i, "arc_to_deg", "is "//real_text(to%reals(1))// &
                           " but must be above arc_from_deg, "//real_text(from%reals(1))// &
                           ", by at most 360")
            end if
         end if
      end associate
   end subroutine check_place

   !> Per component displacement or traction is given, or normal and shear tractions.
   pure subroutine check_values(sheet, i, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index of the record
      type(error_t), allocatable, intent(out) :: error
      character(len=1), parameter :: axes(2) = ["x", "y"]
      character(len=14), parameter :: by_axis(4) = ["x_displacement", "y_displacement", &
                                                    "x_traction    ", "y_traction    "]
      integer :: axis, k

      associate (record => sheet%records(i))
         do axis = 1, 2
            if (record%is_given(axes(axis)//"_displacement") .and. &
                record%is_given(axes(axis)//"_traction")) then
               call refuse(error, sheet, i, axes(axis)//"_traction", "is given with "// &
                           axes(axis)//"_displacement, but only one of them can be prescribed")
               return
            else if (record%is_given(axes(axis)//"_displacement") .and. &
                     record%is_given(axes(axis)//"_spring")) then
               call refuse(error, sheet, i, axes(axis)//"_spring", "is given with "// &
                           axes(axis)//"_displacement, but a side with a prescribed "// &
                           "displacement must not have a spring in the same direction")
               return
            end if
         end do
         if (record%is_given("inflow") .and. record%is_given("pressure")) then
            call refuse(error, sheet, i, "inflow", "is given with pressure, but only one of "// &
                        "them can be prescribed")
            return
         end if
         if (.not. (record%is_given("normal_traction") .or. &
                    record%is_given("shear_traction"))) return
         do k = 1, size(by_axis)
            if (.not. record%is_given(trim(by_axis(k)))) cycle
            call refuse(error, sheet, i, given_of(record, "normal_traction", "shear_traction"), &
                        "is given with "//trim(by_axis(k))//", but a side has either normal "// &
                        "and shear tractions, or values in x and y")
            return
         end do
      end associate
   end subroutine check_values

   !> Each quantity has one value or one per time, and the times increase.
   pure subroutine check_course(sheet, i, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index of the record
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: time, value
      integer(ik) :: k, n, most, wrong

      time = sheet%records(i)%value("time")
      n = 1
      if (time%is_set) n = size(time%reals, kind=ik)
      most = 1
      do k = 1, size(side_quantities, kind=ik)
         value = sheet%records(i)%value(trim(side_quantities(k)))
         if (.not. value%is_set) cycle
         most = max(most, size(value%reals, kind=ik))
         if (any(size(value%reals) == [1_ik, n])) cycle
         if (time%is_set) then
            call refuse(error, sheet, i, trim(side_quantities(k)), "has "// &
                        integer_text(size(value%reals, kind=ik))//" values but must have one, "// &
                        "or as many as time, "//integer_text(n))
         else
            call refuse(error, sheet, i, trim(side_quantities(k)), "has "// &
                        integer_text(size(value%reals, kind=ik))//" values but must have one, "// &
                        "unless time says when they hold")
         end if
         return
      end do
      if (.not. time%is_set) return
      wrong = 0
      do k = n, 2, -1
         if (time%reals(k) < time%reals(k - 1)) wrong = k
      end do
      if (most == 1) then
         call refuse(error, sheet, i, "time", "is given, but no value of the side changes with "// &
                     "it; one must have "//integer_text(max(n, 2_ik))//" values, one per time")
      else if (wrong > 0) then
         call refuse(error, sheet, i, "time", "decreases from "// &
                     real_text(time%reals(wrong - 1))//" to "//real_text(time%reals(wrong))// &
                     ", but must increase")
      else
         do k = 3, n
            if (time%reals(k) > time%reals(k - 2)) cycle
            call refuse(error, sheet, i, "time", "has "//real_text(time%reals(k))//" three "// &
                        "times but at most two can be equal, before and after a jump")
            return
         end do
      end if
   end subroutine check_course

   !> The first of two names that is given.
   pure function given_of(record, first, second) result(name)
      type(record_t), intent(in) :: record
      character(len=*), intent(in) :: first, second
      character(len=:), allocatable :: name

      name = second
      if (record%is_given(first)) name = first
   end function given_of

   !> Parts of a boundary exist and do not overlap.
   pure subroutine check_parts(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: n_edges
      integer :: i, k

      if (scene%domain%shape == "rectangle") return
      do i = 1, size(scene%parts)
         associate (part => scene%parts(i))
            if (allocated(part%edges)) then
               n_edges = size(scene%domain%x, kind=ik)
               if (any(part%edges > n_edges)) then
                  call refuse(error, sheet, sheet%find("side", i), "edges", "has "// &
                              integer_text(maxval(part%edges))//" but must be at most "// &
                              integer_text(n_edges)//", the number of edges")
                  return
               end if
            end if
            do k = 1, i - 1
               if (.not. overlap(scene%parts(k), part)) cycle
               call refuse(error, sheet, sheet%find("side", i), "name", "'"//trim(part%name)// &
                           "' has a part of the boundary that side '"// &
                           trim(scene%parts(k)%name)//"' has, but sides must not overlap")
               return
            end do
         end associate
      end do
   end subroutine check_parts

   !> Two parts of a boundary share more than their ends.
   pure logical function overlap(a, b)
      type(boundary_part_t), intent(in) :: a, b
      integer :: k

      if (allocated(a%edges)) then
         overlap = any([(any(a%edges == b%edges(k)), k=1, size(b%edges))])
      else if (a%whole_rim .or. b%whole_rim) then
         overlap = .true.
      else  ! one of them begins within the other
         overlap = modulo(b%arc(1) - a%arc(1) + same_direction, turn) < &
                   a%arc(2) - a%arc(1) .or. &
                   modulo(a%arc(1) - b%arc(1) + same_direction, turn) < b%arc(2) - b%arc(1)
      end if
   end function overlap

   !> Faces of all fractures of a scene.
   pure subroutine check_faces(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%fractures)
         call check_closure(sheet, sheet%find("fracture", i), scene%fractures(i), &
                            scene%has_fluid(), error)
         if (.not. allocated(error)) call check_bond(sheet, sheet%find("fracture", i), &
                                                     scene%fractures(i), error)
         if (allocated(error)) return
         if (scene%fractures(i)%toughness < huge(1.0_rk) .and. &
             .not. scene%material%toughness < huge(1.0_rk)) then
            call refuse(error, sheet, sheet%find("fracture", i), "toughness", &
                        "is given, but that of &material, which other tips have, is missing")
            return
         end if
      end do
   end subroutine check_faces

   !> Faces with closure touch, and their aperture remains positive.
   pure subroutine check_closure(sheet, record, fracture, has_fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(fracture_t), intent(in) :: fracture
      logical, intent(in) :: has_fluid
      type(error_t), allocatable, intent(out) :: error

      if (.not. fracture%normal_stiffness > 0.0_rk) return
      if (fracture%law == "open") then
         call refuse(error, sheet, record, "normal_stiffness", "is given, but the faces of the "// &
                     "law 'open' do not touch; give 'friction' or 'frictionless'")
      else if (fracture%held_closed) then
         call refuse(error, sheet, record, "normal_stiffness", "is given, but faces that are "// &
                     "held closed, held_closed = .true., cannot close further; omit one of "// &
                     "them")
      else if (has_fluid .and. fracture%closure > largest_closure*fracture%aperture) then
         call refuse(error, sheet, record, "closure", "is "//real_text(fracture%closure)// &
                     " m but must be at most "//real_text(largest_closure)//" of the "// &
                     "aperture, "//rounded_text(largest_closure*fracture%aperture)// &
                     " m, since a part of it remains open under any stress")
      end if
   end subroutine check_closure

   !> A bond has a shear strength and a slip that breaks it, and at most the tensile strength at
   !! which the shear strength vanishes.
   pure subroutine check_bond(sheet, record, fracture, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(fracture_t), intent(in) :: fracture
      type(error_t), allocatable, intent(out) :: error

      if (fracture%cohesion > 0.0_rk .and. .not. fracture%weakening_slip > 0.0_rk) then
         call refuse(error, sheet, record, "cohesion", "is given, but weakening_slip, the slip "// &
                     "that breaks the bond, is missing")
      else if (fracture%tensile_strength > 0.0_rk .and. .not. fracture%cohesion > 0.0_rk) then
         call refuse(error, sheet, record, "tensile_strength", "is given, but cohesion, the "// &
                     "shear strength of the same bond, is missing")
      else if (fracture%tensile_strength*fracture%friction > fracture%cohesion) then
         call refuse(error, sheet, record, "tensile_strength", "is "// &
                     real_text(fracture%tensile_strength)//" Pa but must be at most "// &
                     "cohesion/friction, "// &
                     rounded_text(fracture%cohesion/fracture%friction)//" Pa, where the "// &
                     "shear strength is none")
      else if (fracture%cohesion > 0.0_rk .and. fracture%held_closed) then
         call refuse(error, sheet, record, "cohesion", "is given, but a bond of faces that "// &
                     "are held closed, held_closed = .true., never breaks; omit one of them")
      end if
   end subroutine check_bond

end module scene_check_sides
