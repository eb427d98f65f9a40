!> Fluid pressure on the fracture faces of a window, from the pressure of the coarse cells.
!!
!! The coarse level has the pressure at the middles of its cells; between them it is linear. Toward
!! a tip that advances at the speed V, a fluid of viscosity mu follows at the same speed through an
!! opening w that falls with the square root of the distance d: dp/dd = 12 mu V/w^2 goes with 1/d,
!! so that the pressure is linear in ln d, from the last two middles on. This holds in cells that
!! have grown. At the tips of other cells, and beyond the coarse fracture, the pressure is that of
!! the last cell. A face takes the mean pressure with the weight 1/sqrt(d) with which it enters the
!! stress intensity factor. Of the cell of the tip, only the part behind the tip counts. Where
!! viscosity has an effect at the scale of the cells, the pressure is that of coarse_tip_layer.
module twolevel_pressure
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use coarse_tip_layer, only: mean_pressure_shape, pressure_shape
   use fine_mesh, only: fine_mesh_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: match_pressure, pressure_map_t

   !> Interpolation from the middles of two coarse cells to each face of a window.
   type :: pressure_map_t
      integer(ik), allocatable :: cell(:, :)  !< (2, fracture cells) coarse fracture cells
      real(rk), allocatable :: weight(:)  !< of the second; negative beyond the first [-]
      real(rk), allocatable :: face(:, :)  !< (2, fracture cells) ends, from the tip; 0: none [m]
      real(rk), allocatable :: middle(:, :)  !< (2, fracture cells) of the cells, from the tip [m]
   contains
      procedure :: on_faces
   end type pressure_map_t

contains

   !> Find the coarse cells and weights for the faces of a window.
   pure function match_pressure(fine, coarse, is_grown) result(map)
      type(fine_mesh_t), intent(in) :: fine
      type(mesh_t), intent(in) :: coarse
      !> (coarse fracture cells) fluid follows the tip in these cells
      logical, intent(in) :: is_grown(:)
      type(pressure_map_t) :: map
      real(rk) :: ends(2), middle(coarse%fracture%n_cells)
      logical :: is_tip(2), is_wet(coarse%fracture%n_cells)
      integer(ik) :: end, f, i

      associate (n => fine%fracture%n_cells)
         allocate (map%cell(2, n), source=0_ik)
         allocate (map%weight(n), source=0.0_rk)
         allocate (map%face(2, n), map%middle(2, n), source=0.0_rk)
      end associate
      do f = 1, maxval([0_ik, fine%fracture%cell_fracture])
         call find_ends(fine, f, ends, is_tip)
         call find_middles(coarse, f, ends, middle, is_wet)
         do end = 1, 2
            if (is_tip(end)) is_tip(end) = lies_in(coarse, is_grown .and. is_wet, ends(end))
         end do
         do i = 1, fine%fracture%n_cells
            if (fine%fracture%cell_fracture(i) /= f) cycle
            call match_face(fine%face_s(:2, i), ends, is_tip, middle, is_wet, i, map)
         end do
      end do
   end function match_pressure

   !> Whether a tip lies in one of the selected coarse cells, and not beyond the coarse fracture.
   pure logical function lies_in(coarse, are_meant, tip)
      type(mesh_t), intent(in) :: coarse
      logical, intent(in) :: are_meant(:)  !< (coarse fracture cells)
      real(rk), intent(in) :: tip  !< arc length [m]

      associate (s => coarse%fracture%cell_s)
         lies_in = any(are_meant .and. s(1, :) - tip <= same_place*(s(2, :) - s(1, :)) &
                       .and. tip - s(2, :) <= same_place*(s(2, :) - s(1, :)))
      end associate
   end function lies_in

   !> Free tips of a fracture in the window.
   pure subroutine find_ends(fine, fracture, ends, is_tip)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: fracture
      real(rk), intent(out) :: ends(2)  !< arc length [m]; huge without a tip
      logical, intent(out) :: is_tip(2)
      integer(ik) :: end, tip

      ends = [-huge(1.0_rk), huge(1.0_rk)]
      is_tip = .false.
      associate (here => fine%fracture)
         do tip = 1, here%n_tips
            if (here%tip_fracture(tip) /= fracture) cycle
            end = here%tip_end(tip)
            is_tip(end) = .true.
            if (end == 1) then
               ends(end) = minval(here%cell_s(1, :), mask=here%cell_fracture == fracture)
            else
               ends(end) = maxval(here%cell_s(2, :), mask=here%cell_fracture == fracture)
            end if
         end do
      end associate
   end subroutine find_ends

   !> Middles of those parts of the coarse cells of a fracture that lie behind its tips.
   pure subroutine find_middles(coarse, fracture, ends, middle, is_wet)
      type(mesh_t), intent(in) :: coarse
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: ends(2)  !< [m]
      real(rk), intent(out) :: middle(:)  !< (coarse fracture cells) arc length [m]
      logical, intent(out) :: is_wet(:)  !< cells of this fracture, except those ahead of a tip
      real(rk) :: nothing
      integer(ik) :: j

      do j = 1, coarse%fracture%n_cells
         associate (s => coarse%fracture%cell_s(:, j))
            middle(j) = 0.5_rk*(max(s(1), ends(1)) + min(s(2), ends(2)))
            ! A cell whose start a tip has just reached, within rounding, has no part behind the
            ! tip.
            nothing = same_place*(s(2) - s(1))
            is_wet(j) = coarse%fracture%cell_fracture(j) == fracture .and. &
                        s(1) + nothing < ends(2) .and. s(2) - nothing > ends(1)
         end associate
      end do
   end subroutine find_middles

   !> The two middles that the pressure on a face follows from.
   pure subroutine match_face(s, ends, is_tip, middle, is_wet, i, map)
      real(rk), intent(in) :: s(2)  !< its ends [m]
      real(rk), intent(in) :: ends(2)  !< of the fracture [m]
      logical, intent(in) :: is_tip(2)
      real(rk), intent(in) :: middle(:)  !< middles of the coarse cells [m]
      logical, intent(in) :: is_wet(:)
      integer(ik), intent(in) :: i  !< number of the face
      type(pressure_map_t), intent(inout) :: map  !< 0 for this face
      real(rk) :: at
      integer(ik) :: end

      at = 0.5_rk*sum(s)
      associate (cell => map%cell(:, i), weight => map%weight(i), face => map%face(:, i), &
                 d => map%middle(:, i))
         do end = 1, 2
            if (.not. is_tip(end)) cycle
            cell(1) = minloc(abs(middle - ends(end)), dim=1, mask=is_wet)
            if (cell(1) == 0) return
            cell(2) = minloc(abs(middle - ends(end)), dim=1, &
                             mask=is_wet .and. abs(middle - middle(cell(1))) > 0.0_rk)
            if (cell(2) == 0) cell(2) = cell(1)
            d = abs(middle(cell) - ends(end))
            if (abs(at - ends(end)) > d(2)) cycle
            if (d(2) > d(1)) then
               face = abs(s - ends(end))
               weight = mean_logarithm(face/d(1))/log(d(2)/d(1))
            end if
            return
         end do
         cell(1) = maxloc(middle, dim=1, mask=is_wet .and. middle <= at)
         cell(2) = minloc(middle, dim=1, mask=is_wet .and. middle > at)
         if (cell(1) == 0) cell(1) = cell(2)
         if (cell(2) == 0) cell(2) = cell(1)
         if (cell(1) == cell(2)) return
         weight = (at - middle(cell(1)))/(middle(cell(2)) - middle(cell(1)))
      end associate
   end subroutine match_face

   !> Mean of ln d between two distances with the weight 1/sqrt(d).
   pure real(rk) function mean_logarithm(d)
      real(rk), intent(in) :: d(2)  !< over a length [-]
      real(rk) :: lower, upper

      lower = minval(d)
      upper = maxval(d)
      mean_logarithm = sqrt(upper)*(log(upper) - 2.0_rk)
      if (lower > 0.0_rk) mean_logarithm = mean_logarithm - sqrt(lower)*(log(lower) - 2.0_rk)
      mean_logarithm = mean_logarithm/(sqrt(upper) - sqrt(lower))
   end function mean_logarithm

   !> Pressure on the faces. It does not rise beyond the last middle, and is not below what the
   !! fluid bears. Where pressures count beyond those in situ, what is found is the whole one.
   pure function on_faces(self, pressure, lowest, in_situ, viscous) result(found)
      class(pressure_map_t), intent(in) :: self
      real(rk), intent(in) :: pressure(:)  !< (coarse fracture cells) [Pa]
      real(rk), intent(in) :: lowest  !< [Pa]
      real(rk), intent(in), optional :: in_situ(:)  !< (faces) [Pa]
      !> (coarse fracture cells) of coarse_tip_layer where a tip lies in one, else 0 [1/m^(1/2)]
      real(rk), intent(in), optional :: viscous(:)
      real(rk) :: found(size(self%weight))  !< [Pa]
      real(rk) :: least(size(self%weight))  ! [Pa]
      real(rk) :: weight
      integer(ik) :: i

      least = lowest
      if (present(in_situ)) least = lowest - in_situ
      do i = 1, size(found, kind=ik)
         weight = self%weight(i)
         if (present(viscous)) then
            if (viscous(self%cell(1, i)) > 0.0_rk) weight = viscous_weight(self, i, viscous)
         end if
         associate (p => pressure(self%cell(:, i)))
            found(i) = p(1) + weight*(p(2) - p(1))
            if (weight < 0.0_rk) found(i) = max(least(i), min(p(1), found(i)))
         end associate
      end do
      if (present(in_situ)) found = found + in_situ
   end function on_faces

   !> The weight of the second middle where viscosity has an effect at the scale of the cells.
   pure real(rk) function viscous_weight(self, face, viscous) result(weight)
      class(pressure_map_t), intent(in) :: self
      integer(ik), intent(in) :: face
      real(rk), intent(in) :: viscous(:)  !< (coarse fracture cells) [1/m^(1/2)]

      weight = self%weight(face)
      if (.not. maxval(self%face(:, face)) > 0.0_rk) return
      associate (b => viscous(self%cell(1, face)), d => self%middle(:, face))
         weight = (mean_pressure_shape(b, self%face(:, face)) - pressure_shape(b, d(1))) &
                  /(pressure_shape(b, d(2)) - pressure_shape(b, d(1)))
      end associate
   end function viscous_weight

end module twolevel_pressure
