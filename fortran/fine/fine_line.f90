!> The line of three nodes that an edge of a six-node triangle is: start, end, and one within.
!!
!! Its shape functions are quadratic in a parameter x, 0 at the start and 1 at the end. The node
!! within is at x = 1/2 and in the middle of the edge, where x is the share of the length from the
!! start. At a crack tip it lies at the quarter point, and the share of the length from the tip is
!! x**2, x counted from there (Barsoum 1976; Henshell and Shaw 1975). `tip_end` says which end is
!! such a tip: 1 or 2, or 0 for none.
module fine_line
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: line_parameter, line_resultants, line_shapes, line_slopes, node_within

contains

   !> The shape functions of start, end and the node within.
   pure function line_shapes(x) result(shapes)
      real(rk), intent(in) :: x  !< parameter, 0 to 1 [-]
      real(rk) :: shapes(3)

      shapes = [(1.0_rk - x)*(1.0_rk - 2.0_rk*x), x*(2.0_rk*x - 1.0_rk), 4.0_rk*x*(1.0_rk - x)]
   end function line_shapes

   !> Their derivatives by the parameter.
   pure function line_slopes(x) result(slopes)
      real(rk), intent(in) :: x  !< parameter, 0 to 1 [-]
      real(rk) :: slopes(3)

      slopes = [4.0_rk*x - 3.0_rk, 4.0_rk*x - 1.0_rk, 4.0_rk - 8.0_rk*x]
   end function line_slopes

   !> The parameter of a place on the line.
   pure real(rk) function line_parameter(share, tip_end) result(x)
      real(rk), intent(in) :: share  !< of the length from the start, 0 to 1 [-]
      integer(ik), intent(in) :: tip_end

      x = share
      if (tip_end == 1) x = sqrt(share)
      if (tip_end == 2) x = 1.0_rk - sqrt(1.0_rk - share)
   end function line_parameter

   !> Where the node within lies: its share of the length from the start.
   pure real(rk) function node_within(tip_end) result(share)
      integer(ik), intent(in) :: tip_end

      share = 0.5_rk
      if (tip_end == 1) share = 0.25_rk
      if (tip_end == 2) share = 0.75_rk
   end function node_within

   !> The integrals of the shape functions along the line, over its length: the nodes' shares in the
   !! resultant of a uniform load. A tip has none.
   pure function line_resultants(tip_end) result(share)
      integer(ik), intent(in) :: tip_end
      real(rk) :: share(3)

      share = [1.0_rk, 1.0_rk, 4.0_rk]/6.0_rk
      if (tip_end == 1) share(1:2) = [0.0_rk, 1.0_rk]/3.0_rk
      if (tip_end == 2) share(1:2) = [1.0_rk, 0.0_rk]/3.0_rk
   end function line_resultants

end module fine_line
