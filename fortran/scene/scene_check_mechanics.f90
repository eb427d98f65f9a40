!> Checks the supports and loads of the body.
module scene_check_mechanics
   use base_errors, only: error_t, raise_error
   use base_kinds, only: rk
   use scene_sheet, only: refuse, sheet_t
   use scene_sides, only: boundary_side_t
   use scene_types, only: boundary_part_t, domain_t, load_t, scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_laws, check_load, check_restraints, check_support, check_weight
   public :: surplus_restraints

   real(rk), parameter :: smallest = 1.0e-12_rk  !< eigenvalue of held_motions that counts [-]

contains

   !> Sides and restraints prevent the three rigid motions of the body, u = (a - w y, b + w x).
   pure subroutine check_support(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: held(3, 3), rest
      character(len=:), allocatable :: holder

      held = held_motions(scene, .true.)
      holder = "&side or a &restraint"
      if (.not. held(1, 1) > 0.0_rk) then
         call raise_error(error, "", sheet%path//": the body can move in x; give a "//holder// &
                          " an x_displacement (see docs/input.md)")
         return
      else if (.not. held(2, 2) > 0.0_rk) then
         call raise_error(error, "", sheet%path//": the body can move in y; give a "//holder// &
                          " a y_displacement (see docs/input.md)")
         return
      end if
      rest = held(3, 3) - held(1, 3)**2/held(1, 1) - held(2, 3)**2/held(2, 2)
      if (.not. rest > smallest*(held(1, 1) + held(2, 2))) then
         if (scene%domain%shape == "rectangle") then
            holder = "&side, left or right, an x_displacement, or bottom or top a "// &
                     "y_displacement, or a &restraint either"
         else
            holder = holder//" that prevents its rotation a displacement too"
         end if
         call raise_error(error, "", sheet%path//": the body can rotate; give a "//holder// &
                          " (see docs/input.md)")
      end if
   end subroutine check_support

   !> Number of components of restraints beyond those that prevent the rigid motions left by the
   !! sides.
   pure integer function surplus_restraints(scene) result(surplus)
      type(scene_t), intent(in) :: scene
      real(rk) :: held(3, 3)
      integer :: i, k

      surplus = -3
      do i = 1, size(scene%restraints)
         surplus = surplus + count(scene%restraints(i)%displacement_given)
      end do
      held = held_motions(scene, .false.)
      do k = 1, 3  ! the rank, by elimination
         i = maxloc([held(1, 1), held(2, 2), held(3, 3)], dim=1)
         if (.not. held(i, i) > smallest) exit
         surplus = surplus + 1
         held = held - spread(held(:, i), 2, 3)*spread(held(i, :), 1, 3)/held(i, i)
         held(i, :) = 0.0_rk
         held(:, i) = 0.0_rk
      end do
   end function surplus_restraints

   !> Sums, over the prescribed components, of products of their changes by a, b and w, with lengths
   !! over the diagonal of the body.
   pure function held_motions(scene, with_restraints) result(held)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: with_restraints  !< in addition to the sides
      real(rk) :: held(3, 3)
      real(rk) :: ends(2, 2, 4)
      integer :: side, k

      held = 0.0_rk
      associate (d => scene%domain)
         ends = reshape([d%x_min, d%y_min, d%x_min, d%y_max, d%x_max, d%y_min, d%x_max, d%y_max, &
                         d%x_min, d%y_min, d%x_max, d%y_min, d%x_min, d%y_max, d%x_max, d%y_max], &
                        [2, 2, 4])
      end associate
      do side = 1, merge(4, 0, scene%domain%shape == "rectangle")
         do k = 1, 2
            call hold_point(scene%domain, ends(:, k, side), bears(scene%sides(side)), held)
         end do
      end do
      do side = 1, scene%n_parts()
         call hold_part(scene%domain, scene%parts(side), held)
      end do
      if (.not. with_restraints) return
      do k = 1, size(scene%restraints)
         associate (point => scene%restraints(k))
            call hold_point(scene%domain, [point%x, point%y], point%displacement_given, held)
         end associate
      end do
   end function held_motions

   !> Components in which a side is supported, by a displacement or by springs.
   pure function bears(side)
      class(boundary_side_t), intent(in) :: side
      logical :: bears(2)

      bears = side%displacement_given .or. side%spring > 0.0_rk
   end function bears

   !> Add a part of the boundary to the sums of held_motions: the ends of a polygon's edges, or
   !! three points of an arc.
   pure subroutine hold_part(domain, part, held)
      type(domain_t), intent(in) :: domain
      type(boundary_part_t), intent(in) :: part
      real(rk), intent(inout) :: held(3, 3)
      real(rk) :: angle, arc(2)
      integer :: i, next

      if (.not. any(bears(part))) return
      if (allocated(part%edges)) then
         do i = 1, size(part%edges)
            associate (first => part%edges(i))
               next = mod(first, size(domain%x)) + 1
               call hold_point(domain, [domain%x(first), domain%y(first)], bears(part), held)
               call hold_point(domain, [domain%x(next), domain%y(next)], bears(part), held)
            end associate
         end do
         return
      end if
      arc = part%arc
      if (part%whole_rim) arc = [0.0_rk, 4.0_rk]
      do i = 0, 2
         angle = arc(1) + 0.5_rk*real(i, rk)*(arc(2) - arc(1))
         call hold_point(domain, [domain%x_centre + domain%radius*cos(angle), &
                                  domain%y_centre + domain%radius*sin(angle)], bears(part), held)
      end do
   end subroutine hold_part

   !> Add the supported components of a point to the sums of held_motions.
   pure subroutine hold_point(domain, xy, given, held)
      type(domain_t), intent(in) :: domain
      real(rk), intent(in) :: xy(2)  !< [m]
      logical, intent(in) :: given(2)  !< x, y
      real(rk), intent(inout) :: held(3, 3)
      real(rk) :: arm(2), row(3)
      integer :: component, j

      associate (d => domain)
         arm = (xy - 0.5_rk*[d%x_min + d%x_max, d%y_min + d%y_max]) &
               /hypot(d%x_max - d%x_min, d%y_max - d%y_min)
      end associate
      do component = 1, 2
         if (.not. given(component)) cycle
         row = merge([1.0_rk, 0.0_rk, -arm(2)], [0.0_rk, 1.0_rk, arm(1)], component == 1)
         do j = 1, 3
            held(:, j) = held(:, j) + row(j)*row
         end do
      end do
   end subroutine hold_point

   !> The load changes during the programme.
   pure subroutine check_load(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      associate (load => scene%load)
         if (allocated(load%factors)) then
            call check_cycle(sheet, load, error)
            return
         end if
         if (abs(load%to - load%from) > 0.0_rk) return
         call refuse(error, sheet, sheet%find("load"), "to", "is "//real_text(load%to)// &
                     " but must differ from from, "//real_text(load%from)// &
                     ", or the load would not change")
      end associate
   end subroutine check_load

   !> Successive factors of a load cycle differ, and growth does not change them (dead load).
   pure subroutine check_cycle(sheet, load, error)
      type(sheet_t), intent(in) :: sheet
      type(load_t), intent(in) :: load  !< with factors
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      record = sheet%find("load")
      if (sheet%records(record)%is_given("to")) then
         call refuse(error, sheet, record, "to", "is given with factors, which determine it, "// &
                     "but must not be")
      else if (load%control == "length") then
         call refuse(error, sheet, record, "control", "is 'length' but must be 'dead' with "// &
                     "factors, since growth under length control changes the load")
      else if (size(load%factors) == 1 .and. .not. abs(load%factors(1) - load%from) > 0.0_rk) then
         call refuse(error, sheet, record, "factors", "is "//real_text(load%from)//" but must "// &
                     "differ from from, or the load would not change")
      end if
      if (allocated(error)) return
      do i = 2, size(load%factors)
         if (abs(load%factors(i) - load%factors(i - 1)) > 0.0_rk) cycle
         call refuse(error, sheet, record, "factors", "has "//real_text(load%factors(i))// &
                     " twice in a row, but each factor must differ from the one before it")
         return
      end do
   end subroutine check_cycle

   !> With gravity the rock has a density, and an in-situ stress that varies with y balances the
   !! weight.
   pure subroutine check_weight(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: balance = 1.0e-3_rk  ! of the weight, as a user rounds it
      real(rk) :: weight

      associate (gravity => scene%gravity, per_y => scene%in_situ%per_y)
         if (any(abs(gravity) > 0.0_rk) .and. .not. scene%material%density > 0.0_rk) then
            call refuse(error, sheet, sheet%find("gravity"), "", "is given, but the material "// &
                        "has no density")
            return
         end if
         if (.not. any(abs(per_y) > 0.0_rk)) return
         weight = scene%material%density*gravity(2)
         if (abs(gravity(1)) > 0.0_rk) then
            call refuse(error, sheet, sheet%find("gravity"), "x", "is "//real_text(gravity(1))// &
                        " but must be 0, since an in-situ stress that varies only with y "// &
                        "balances no weight in x")
         else if (.not. abs(per_y(2) + weight) <= balance*abs(weight)) then
            call refuse(error, sheet, sheet%find("in_situ"), "syy_per_y", "is "// &
                        real_text(per_y(2))//" but must balance the weight: density times "// &
                        "gravity requires "//rounded_text(0.0_rk - weight)//" Pa/m")
         end if
      end associate
   end subroutine check_weight

   !> Each restraint prescribes at least one component.
   pure subroutine check_restraints(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%restraints)
         if (any(scene%restraints(i)%displacement_given)) cycle
         call refuse(error, sheet, sheet%find("restraint", i), "", "has no component, but "// &
                     "x_displacement or y_displacement must be given")
         return
      end do
   end subroutine check_restraints

   !> Laws of the faces that a scene with a fluid, or faces that are held closed, cannot have.
   pure subroutine check_laws(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(scene%fractures)
         associate (fracture => scene%fractures(i), record => sheet%find("fracture", i))
            if (scene%has_fluid() .and. any(fracture%law == ["open", "slip"])) then
               call refuse(error, sheet, record, "law", "is '"//trim(fracture%law)// &
                           "' but must be 'friction' or 'frictionless' in a scene with &fluid, "// &
                           "whose faces bear on each other or on the fluid")
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
