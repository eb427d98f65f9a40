!> The stress that a scene states far from its fractures, and what it means for each straight part
!! of a fracture: tractions, slip tendency, and the pressures at which it slips and opens.
!!
!! The stress is uniform or linear in y. In situ it is given; sides add to it, or define it without
!! one. With tractions on opposite sides it is in equilibrium with them; a direction in which both
!! sides are held, or have prescribed displacements, has that strain from the reference state on,
!! which is the one in situ, or else rock without strain at the initial pressure (coarse_in_situ).
!! The pressure is the initial one. Fractures, regions and stages of wells do not disturb it here.
module scene_stress
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: round_off
   use scene_sides, only: boundary_side_t, normal_tractions
   use scene_types, only: fracture_t, material_t, scene_t
   implicit none(type, external)
   private

   public :: far_stress_t, find_far_stress, part_t, parts_of_scene

   !> Stress and pressure far from fractures. Compression is negative.
   type :: far_stress_t
      real(rk) :: stress(3) = 0.0_rk  !< xx, yy, xy at the datum [Pa]
      real(rk) :: per_y(2) = 0.0_rk  !< xx, yy: increase per metre upwards [Pa/m]
      real(rk) :: pressure = 0.0_rk  !< at the datum [Pa]
      real(rk) :: pressure_per_y = 0.0_rk  !< increase per metre upwards [Pa/m]
      real(rk) :: y_datum = 0.0_rk  !< [m]
      character(len=:), allocatable :: unknown  !< the reason why it is not known; else unallocated
   contains
      procedure :: stress_at
      procedure :: pressure_at
   end type far_stress_t

   !> A straight part of a fracture, at that of its ends where it slips first.
   type :: part_t
      integer(ik) :: fracture = 0  !< index into scene%fractures
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
      real(rk) :: length = 0.0_rk  !< [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector along it
      real(rk) :: pressure = 0.0_rk  !< initial [Pa]
      real(rk) :: normal = 0.0_rk  !< total normal traction, compression positive [Pa]
      real(rk) :: shear = 0.0_rk  !< its shear traction, without sign [Pa]
      real(rk) :: slips_at = 0.0_rk  !< pressure [Pa]
      real(rk) :: opens_at = 0.0_rk  !< pressure [Pa]
   contains
      procedure :: tendency
   end type part_t

contains

   !> Stress at a level: xx, yy, xy [Pa].
   pure function stress_at(self, y) result(stress)
      class(far_stress_t), intent(in) :: self
      real(rk), intent(in) :: y  !< [m]
      real(rk) :: stress(3)

      stress = self%stress
      stress(1:2) = stress(1:2) + self%per_y*(y - self%y_datum)
   end function stress_at

   !> Pressure at a level [Pa].
   pure real(rk) function pressure_at(self, y) result(pressure)
      class(far_stress_t), intent(in) :: self
      real(rk), intent(in) :: y  !< [m]

      pressure = self%pressure + self%pressure_per_y*(y - self%y_datum)
   end function pressure_at

   !> The stress of a scene at its beginning, without a fluid at load factor 1.
   pure subroutine find_far_stress(scene, far)
      type(scene_t), intent(in) :: scene
      type(far_stress_t), intent(out) :: far
      type(boundary_side_t) :: sides(4)
      real(rk) :: biot
      logical :: in_situ

      associate (given => scene%in_situ)
         in_situ = any(abs([given%stress, given%per_y]) > 0.0_rk)
         far%y_datum = given%y_datum
         far%pressure = scene%initial%pressure
         far%pressure_per_y = scene%fluid%density*scene%gravity(2)
         ! Without a stress in situ the rock is without strain at the initial pressure.
         biot = scene%material%biot
         if (scene%material%plane_stress) biot = biot*(1.0_rk - 2.0_rk*scene%material%poisson) &
                                                 /(1.0_rk - scene%material%poisson)
         far%stress(1:2) = -biot*far%pressure
         far%per_y = -biot*far%pressure_per_y
         if (in_situ) then
            far%stress = given%stress
            far%per_y = given%per_y
         end if
      end associate
      sides = scene%sides
      call sides%set_time(0.0_rk, 0.0_rk)
      far%unknown = reason(scene, sides, in_situ)
      if (len(far%unknown) > 0) return
      deallocate (far%unknown)
      call add_sides(scene, sides, in_situ, far)
   end subroutine find_far_stress

   !> Why the stress is not uniform or linear in y; empty if it is.
   pure function reason(scene, sides, in_situ) result(words)
      type(scene_t), intent(in) :: scene
      type(boundary_side_t), intent(in) :: sides(4)
      logical, intent(in) :: in_situ
      character(len=:), allocatable :: words
      character(len=*), parameter :: of_points = "points of the body are loaded or held"
      real(rk) :: scale, normal(4)
      logical :: held(4)
      integer :: i

      words = ""
      normal = normal_tractions(sides)
      scale = round_off*max(maxval(abs(normal)), maxval(abs(sides%shear_traction)))
      held = [(sides(i)%displacement_given(merge(1, 2, i <= 2)), i=1, 4)]
      if (scene%domain%shape /= "rectangle") then
         if (scene%n_parts() > 0) then
            if (.not. in_situ .or. any(scene%parts%largest_stress() > 0.0_rk)) then
               words = "the body is no rectangle, and its boundary has loads"
            end if
         else if (.not. in_situ) then
            words = "the body is no rectangle, and has no stress in situ"
         end if
      else if (abs(normal(1) - normal(2)) > scale .and. .not. any(held(1:2)) .or. &
               abs(normal(3) - normal(4)) > scale .and. .not. any(held(3:4))) then
         words = "opposite sides bear different tractions"
      else if (any(abs([(sides(i)%spring, i=1, 4)]) > 0.0_rk)) then
         words = "the sides have springs"
      else if (.not. in_situ .and. any(abs(scene%gravity*scene%material%density) > 0.0_rk)) then
         words = "the weight of the rock loads it, without a stress in situ"
      else if (.not. spread_of(shears(sides)) <= scale) then
         words = "the sides bear different shear tractions"
      end if
      if (words /= "" .or. .not. scene%has_points()) return
      ! Restraints that only fix the rigid motions bear nothing.
      do i = 1, size(scene%restraints)
         if (any(abs(scene%restraints(i)%displacement) > 0.0_rk)) words = of_points
      end do
      do i = 1, size(scene%point_loads)
         if (any(abs(scene%point_loads(i)%force) > 0.0_rk)) words = of_points
      end do
   end function reason

   !> The shear stress by each side that has a traction along it; the others have that of the first
   !! such side [Pa].
   pure function shears(sides) result(shear)
      type(boundary_side_t), intent(in) :: sides(4)
      real(rk) :: shear(4)
      logical :: free(4)
      integer :: i

      ! Left, right, bottom, top: outward normals -x, x, -y, y.
      shear = [-sides(1)%traction(2), sides(2)%traction(2), -sides(3)%traction(1), &
               sides(4)%traction(1)] + [1, 1, -1, -1]*sides%shear_traction
      free = [(.not. sides(i)%displacement_given(merge(2, 1, i <= 2)), i=1, 4)]
      if (.not. any(free)) then
         shear = 0.0_rk
      else
         where (.not. free) shear = shear(findloc(free, .true., dim=1))
      end if
   end function shears

   pure real(rk) function spread_of(values)
      real(rk), intent(in) :: values(:)  !< [any unit]

      spread_of = maxval(values) - minval(values)
   end function spread_of

   !> Add what the sides do to the reference state.
   pure subroutine add_sides(scene, sides, in_situ, far)
      type(scene_t), intent(in) :: scene
      type(boundary_side_t), intent(in) :: sides(4)
      logical, intent(in) :: in_situ
      type(far_stress_t), intent(inout) :: far
      real(rk) :: by_sides(2), change(2), strain(2), normal(4), across, along, size(2), sheared(4)
      logical :: is_strained(2)
      integer :: a, b

      if (scene%domain%shape /= "rectangle") return
      normal = normal_tractions(sides)
      sheared = shears(sides)
      far%stress(3) = far%stress(3) + sheared(1)
      size = [scene%domain%x_max - scene%domain%x_min, scene%domain%y_max - scene%domain%y_min]
      do a = 1, 2
         associate (first => sides(2*a - 1), second => sides(2*a))
            is_strained(a) = first%displacement_given(a) .and. second%displacement_given(a)
            strain(a) = (second%displacement(a) - first%displacement(a))/size(a)
            by_sides(a) = normal(2*a)
            if (second%displacement_given(a)) by_sides(a) = normal(2*a - 1)
         end associate
      end do
      ! Change of the stress from the reference state; tractions without one are total.
      call moduli(scene%material, across, along)
      change = by_sides
      if (.not. in_situ) change = change - far%stress(1:2)
      do a = 1, 2
         if (.not. is_strained(a)) cycle
         b = 3 - a
         if (is_strained(b)) then
            change(a) = across*strain(a) + along*strain(b)
         else
            change(a) = across*strain(a) + along*(change(b) - along*strain(a))/across
         end if
      end do
      if (.not. in_situ) then
         ! The weight of the fluid acts on the rock too (buoyancy); tractions do not vary with y.
         where (.not. is_strained) far%per_y = 0.0_rk
      end if
      far%stress(1:2) = far%stress(1:2) + change
   end subroutine add_sides

   !> Stress per strain in the same direction, and in the other one [Pa].
   pure subroutine moduli(m, across, along)
      type(material_t), intent(in) :: m
      real(rk), intent(out) :: across, along

      if (m%plane_stress) then
         across = m%young/(1.0_rk - m%poisson**2)
         along = m%poisson*across
      else
         along = m%young*m%poisson/((1.0_rk + m%poisson)*(1.0_rk - 2.0_rk*m%poisson))
         across = along + m%young/(1.0_rk + m%poisson)
      end if
   end subroutine moduli

   !> All straight parts of the fractures of a scene.
   pure function parts_of_scene(scene, far) result(parts)
      type(scene_t), intent(in) :: scene
      type(far_stress_t), intent(in) :: far
      type(part_t), allocatable :: parts(:)
      integer(ik) :: f, k

      allocate (parts(0))
      do f = 1, size(scene%fractures, kind=ik)
         associate (this => scene%fractures(f))
            parts = [parts, (part_between(this, f, [this%x(k), this%y(k)], &
                                          [this%x(k + 1), this%y(k + 1)], far), &
                             k=1, size(this%x, kind=ik) - 1)]
         end associate
      end do
   end function parts_of_scene

   !> A part between two points. Pressures at which it slips and opens, over the initial one, are
   !! smallest at one of its ends, since the stress is linear.
   pure type(part_t) function part_between(fracture, number, from, to, far) result(part)
      type(fracture_t), intent(in) :: fracture
      integer(ik), intent(in) :: number  !< of the fracture
      real(rk), intent(in) :: from(2), to(2)  !< [m]
      type(far_stress_t), intent(in) :: far
      type(part_t) :: other

      part = part_at(from)
      other = part_at(to)
      if (other%slips_at - other%pressure < part%slips_at - part%pressure) part = other

   contains

      pure type(part_t) function part_at(xy) result(at)
         real(rk), intent(in) :: xy(2)  !< [m]
         real(rk) :: s(3), traction(2), normal(2)

         at%fracture = number
         at%x = xy(1)
         at%y = xy(2)
         at%length = norm2(to - from)
         at%direction = (to - from)/at%length
         normal = [-at%direction(2), at%direction(1)]
         s = far%stress_at(xy(2))
         traction = [s(1)*normal(1) + s(3)*normal(2), s(3)*normal(1) + s(2)*normal(2)]
         at%normal = -dot_product(traction, normal)
         at%shear = abs(dot_product(traction, at%direction))
         at%pressure = far%pressure_at(xy(2))
         at%opens_at = at%normal + fracture%tensile_strength
         at%slips_at = at%opens_at
         if (at%shear <= round_off*maxval(abs(s))) then
            at%shear = 0.0_rk  ! across a principal stress
         else if (at%shear > fracture%cohesion) then
            ! Without friction any shear stress lets it slip.
            at%slips_at = -huge(1.0_rk)
            if (fracture%friction > 0.0_rk) then
               at%slips_at = at%normal - (at%shear - fracture%cohesion)/fracture%friction
            end if
         end if
      end function part_at

   end function part_between

   !> Slip tendency: shear traction over the effective normal traction; huge where it is open [-].
   elemental real(rk) function tendency(self)
      class(part_t), intent(in) :: self

      tendency = huge(1.0_rk)
      if (self%normal > self%pressure) tendency = self%shear/(self%normal - self%pressure)
   end function tendency

end module scene_stress
