!> Relative errors of slip and opening of fracture cells, from the sizes of the cells.
!!
!! Cells whose faces move form zones along a fracture. A zone slips and opens as if its ends lay
!! elsewhere by a share of the cells there, so that a jump at the distance d from an end has the
!! relative error of that share of the cell over d, with a remainder that does not depend on the
!! place; sums over a zone (volume, moment) have that of its middle. That of slip falls faster, with
!! a higher power of the distance. A kink gives rise to an error
!! in proportion to the sine of its angle, in the whole zone and, with the inverse of the distance,
!! next to it. So does a crossing with a fracture that moves, as both faces of each are offset
!! there. The shares of the two discretizations were measured with closed forms (Sneddon 1946; one
!! crack under uniform shear) at 4 to 40 cells per half-length, for Poisson's ratios of 0.1 and
!! 0.3 (verification/stated_errors_all).
module report_jump_errors
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use mesh_types, only: fracture_mesh_t, point_joint_t, point_joint_x, point_tip
   implicit none(type, external)
   private

   public :: by_crossings, closure_error, error_of_largest, finite_elements, finite_volumes, &
             jump_errors_t, jump_law_t, last_of_zone, relative_jump_errors, unevenness

   !> Shares of a discretization, each times a cell's length over a distance [-].
   type :: jump_law_t
      real(rk) :: rest = 0.0_rk  !< independent of the place
      real(rk) :: less = 0.0_rk  !< by which it is less for slip
      real(rk) :: fall = 0.0_rk  !< by which the power of the distance is higher for slip
      real(rk) :: at_tip = 0.0_rk  !< end of a zone at a free tip
      real(rk) :: at_joint = 0.0_rk  !< end of a zone at another end of a fracture
      real(rk) :: within = 0.0_rk  !< end of a zone where faces stick
      real(rk) :: of_kink = 0.0_rk  !< times the sine of the kink, over half of the zone
      real(rk) :: at_kink = 0.0_rk  !< the same over the distance from the kink
      logical :: at_crossings = .false.  !< crossings act like kinks
      real(rk) :: of_sum = 0.0_rk  !< sums over a zone, times the power of cell over half-length
      real(rk) :: power = 1.0_rk
   end type jump_law_t

   type(jump_law_t), parameter :: finite_volumes = &
                        jump_law_t(0.005_rk, 0.003_rk, 0.25_rk, 0.075_rk, 0.15_rk, 0.5_rk, 0.2_rk, &
                                             0.03_rk, .true., 0.075_rk, 1.0_rk)
   type(jump_law_t), parameter :: finite_elements = &
                        jump_law_t(4.0e-4_rk, 0.0_rk, 0.0_rk, 8.0e-3_rk, 0.05_rk, 0.25_rk, 0.2_rk, &
                                             0.05_rk, .false., 0.35_rk, 1.5_rk)

   !> (fracture cells)
   type :: jump_errors_t
      real(rk), allocatable :: share(:)  !< relative error of the opening [-]
      real(rk), allocatable :: of_slip(:)  !< the same of the slip [-]
      real(rk), allocatable :: of_sum(:)  !< of sums of openings over its zone [-]
      real(rk), allocatable :: of_slip_sum(:)  !< the same of slip [-]
      !> mean of the distances from the ends of its zone by their product: a uniform change of
      !! traction by s changes the jump by 4 s/E' times it; 0 where no face moves [m]
      real(rk), allocatable :: reach(:)
      !> sine of the sharper of the kinks at its ends within the zone: faces that slide past it open
      real(rk), allocatable :: kink(:)
   end type jump_errors_t

contains

   !> Relative errors of the cells.
   pure function relative_jump_errors(fracture, moves, law) result(errors)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moves(:)  !< (cells)
      type(jump_law_t), intent(in) :: law
      type(jump_errors_t) :: errors
      integer(ik) :: first, last

      allocate (errors%share(size(moves)), errors%of_sum(size(moves)), source=law%rest)
      allocate (errors%reach(size(moves)), errors%kink(size(moves)), source=0.0_rk)
      first = 1
      do while (first <= fracture%n_cells)
         last = last_of_zone(fracture, moves, first)
         if (moves(first)) call add_zone(fracture, moves, first, last, law, errors)
         first = last + 1
      end do
      associate (of_ends => errors%share - law%rest)
         errors%of_slip = law%rest - law%less + of_ends*min(1.0_rk, of_ends/(2.0_rk*law%at_tip)) &
                          **law%fall
      end associate
      errors%of_slip_sum = errors%of_sum - law%less
   end function relative_jump_errors

   !> The last cell of a zone whose cells all move, or all do not. Cells are stored along each
   !! fracture.
   pure integer(ik) function last_of_zone(fracture, moves, first) result(last)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moves(:)  !< (cells)
      integer(ik), intent(in) :: first

      last = first
      do while (last < fracture%n_cells)
         if (moves(last + 1) .neqv. moves(first)) return
         if (fracture%cell_fracture(last + 1) /= fracture%cell_fracture(first)) return
         last = last + 1
      end do
   end function last_of_zone

   !> Errors in a zone of adjacent cells.
   pure subroutine add_zone(fracture, moves, first, last, law, errors)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moves(:)  !< (cells)
      integer(ik), intent(in) :: first, last  !< cells
      type(jump_law_t), intent(in) :: law
      type(jump_errors_t), intent(inout) :: errors
      real(rk) :: ends(2), half, of_end(2), size_of(2)
      real(rk) :: kink(first:last)  ! at the end of a cell: its length there by the sine [m]
      integer(ik) :: i

      ends = [fracture%cell_s(1, first), fracture%cell_s(2, last)]
      size_of = [length_of(first), length_of(last)]
      half = 0.5_rk*(ends(2) - ends(1))
      if (.not. half > 0.0_rk) return
      kink = kinks(fracture, first, last)
      errors%kink(first:last) = max(kink, eoshift(kink, -1)) &
                                /(fracture%cell_s(2, first:last) - fracture%cell_s(1, first:last))
      if (law%at_crossings) call add_crossings(fracture, moves, first, kink)
      do i = first, last
         associate (middle => 0.5_rk*sum(fracture%cell_s(:, i)))
            if (.not. (middle > ends(1) .and. middle < ends(2))) cycle
            errors%reach(i) = sqrt((middle - ends(1))*(ends(2) - middle))
            of_end = [share_at(first, 1)*size_of(1)/(middle - ends(1)), &
                      share_at(last, 2)*size_of(2)/(ends(2) - middle)]
            ! Where faces stick beyond, slip has the square of the length of the zone.
            where ([share_at(first, 1), share_at(last, 2)] >= law%within) &
               of_end = of_end*(1.0_rk + 0.25_rk*of_end)
            errors%share(i) = law%rest + law%of_kink*maxval(kink)/half + maxval(of_end)
            if (any(kink > 0.0_rk)) errors%share(i) = errors%share(i) + law%at_kink &
                                        & *maxval(kink/abs(fracture%cell_s(2, first:last) - middle))
         end associate
      end do
      errors%of_sum(first:last) = law%rest + law%of_kink*maxval(kink)/half &
                                  + law%of_sum*(maxval(size_of)/half)**law%power &
                                  + maxval([share_at(first, 1) - law%at_tip, &
                                            share_at(last, 2) - law%at_tip])*maxval(size_of)/half

   contains

      pure real(rk) function length_of(cell)
         integer(ik), intent(in) :: cell

         length_of = fracture%cell_s(2, cell) - fracture%cell_s(1, cell)
      end function length_of

      !> Share of the cell at an end of the zone.
      pure real(rk) function share_at(cell, end) result(share)
         integer(ik), intent(in) :: cell
         integer, intent(in) :: end  !< 1 start, 2 end
         integer(ik) :: next

         next = cell + merge(-1_ik, 1_ik, end == 1)
         share = law%within
         if (next >= 1 .and. next <= fracture%n_cells) then
            ! A cell ahead of a tip has no length.
            if (fracture%cell_fracture(next) == fracture%cell_fracture(cell)) then
               if (.not. length_of(next) > 0.0_rk) share = law%at_tip
               return
            end if
         end if
         share = law%at_joint
         if (fracture%point_kind(fracture%cell_points(end, cell)) == point_tip) share = law%at_tip
      end function share_at

   end subroutine add_zone

   !> Shorter of the two cells at the end of each cell of a zone, times the sine of the kink there
   !! [m].
   pure function kinks(fracture, first, last) result(part)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: first, last  !< cells
      real(rk) :: part(first:last)
      integer(ik) :: i

      part = 0.0_rk
      do i = first, last - 1
         part(i) = part_of_crossing(fracture, i, i + 1)
      end do
   end function kinks

   !> The same where the zone is crossed by a fracture that moves.
   pure subroutine add_crossings(fracture, moves, first, part)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moves(:)  !< (cells)
      integer(ik), intent(in) :: first  !< cell of the zone
      real(rk), intent(inout) :: part(first:)  !< (cells of the zone) [m]
      integer(ik) :: i, k

      do i = first, ubound(part, 1, kind=ik) - 1
         associate (kind => fracture%point_kind(fracture%cell_points(2, i)))
            if (kind /= point_joint_t .and. kind /= point_joint_x) cycle
         end associate
         do k = 1, fracture%n_cells
            if (fracture%cell_fracture(k) == fracture%cell_fracture(i) .or. .not. moves(k)) cycle
            if (all(fracture%cell_points(:, k) /= fracture%cell_points(2, i))) cycle
            part(i) = max(part(i), part_of_crossing(fracture, i, k))
         end do
      end do
   end subroutine add_crossings

   !> The shorter of two cells, times the sine between them [m].
   pure real(rk) function part_of_crossing(fracture, i, k) result(part)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: i, k  !< cells
      real(rk) :: along(2, 2)

      associate (points => fracture%cell_points(:, [i, k]))
         along = fracture%point_xy(:, points(2, :)) - fracture%point_xy(:, points(1, :))
      end associate
      part = abs(along(1, 1)*along(2, 2) - along(2, 1)*along(1, 2)) &
             /max(norm2(along(:, 1)), norm2(along(:, 2)))
   end function part_of_crossing

   !> Errors of the slip of cells that move by that of fractures that cross theirs, as by kinks [m].
   pure function by_crossings(fracture, moves, slip, law) result(error)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moves(:)  !< (cells)
      real(rk), intent(in) :: slip(:)  !< (cells) magnitudes [m]
      type(jump_law_t), intent(in) :: law
      real(rk) :: error(size(slip))
      real(rk) :: part(1)
      integer(ik) :: i, k

      error = 0.0_rk
      do i = 1, fracture%n_cells - 1
         if (fracture%cell_fracture(i + 1) /= fracture%cell_fracture(i)) cycle
         associate (at => fracture%cell_points(2, i), here => fracture%cell_fracture(i))
            if (fracture%point_kind(at) /= point_joint_x) cycle
            do k = 1, fracture%n_cells
               if (fracture%cell_fracture(k) == here .or. .not. moves(k)) cycle
               if (all(fracture%cell_points(:, k) /= at)) cycle
               part = part_of_crossing(fracture, i, k)*law%at_kink*slip(k)
               where (fracture%cell_fracture == here .and. moves) error = max(error, &
                  & part(1)/abs(fracture%cell_s(2, i) - 0.5_rk*sum(fracture%cell_s, dim=1)))
            end do
         end associate
      end do
   end function by_crossings

   !> Differences of the values of cells from the mean of their neighbours on the fracture.
   pure function unevenness(fracture, values) result(difference)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: values(:)
      real(rk) :: difference(size(values))
      real(rk) :: mean
      integer(ik) :: i, k, n, next

      difference = 0.0_rk
      do i = 1, fracture%n_cells
         n = 0
         mean = 0.0_rk
         do k = -1, 1, 2
            next = i + k
            if (next < 1 .or. next > fracture%n_cells) cycle
            if (fracture%cell_fracture(next) /= fracture%cell_fracture(i)) cycle
            n = n + 1
            mean = mean + values(next)
         end do
         if (n > 0) difference(i) = abs(values(i) - mean/n)
      end do
   end function unevenness

   !> Error of the largest value of the cells: that of its cell, at least what that of another cell
   !! may exceed it by; and by how much the parabola through its middle and those of its neighbours
   !! is higher, d^2/(16 h) for the height h over their mean and their difference d. Jumps that are
   !! all negative end in 0 at a tip.
   pure real(rk) function error_of_largest(fracture, values, errors) result(error)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: values(:), errors(:)  !< (cells)
      real(rk) :: around(2), height(size(values))
      integer(ik) :: at, k, next

      at = maxloc(values, dim=1, kind=ik)
      error = max(errors(at), maxval(values + errors) - values(at))
      if (.not. values(at) > 0.0_rk) then
         error = max(error, abs(values(at)))
         return
      end if
      height = unevenness(fracture, values)
      if (.not. height(at) > 0.0_rk) return
      around = values(at)
      do k = 1, 2
         next = at + 2*k - 3
         if (next < 1 .or. next > fracture%n_cells) cycle
         if (fracture%cell_fracture(next) == fracture%cell_fracture(at)) around(k) = values(next)
      end do
      associate (apart => min(0.5_rk, abs(around(2) - around(1))/(4.0_rk*height(at))))
         error = error + height(at)*apart**2
      end associate
   end function error_of_largest

   !> Error of the closure of a joint by that of the traction, which rises at least in proportion
   !! [m].
   elemental real(rk) function closure_error(jump_n, traction_n, traction_error) result(error)
      real(rk), intent(in) :: jump_n  !< closed below 0 [m]
      real(rk), intent(in) :: traction_n  !< compression < 0 [Pa]
      real(rk), intent(in) :: traction_error  !< [Pa]

      error = 0.0_rk
      if (jump_n < 0.0_rk .and. traction_n < 0.0_rk) error = traction_error*jump_n/traction_n
   end function closure_error

end module report_jump_errors
