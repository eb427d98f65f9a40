!> Largest difference of two numbers that are equal except for rounding.
!!
!! Only tolerances of rounding are here. A tolerance of a method (a pivot, a residual, a share of a
!! step) is defined in its module.
module base_tolerances
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: round_off, same_direction, same_place, same_time, same_value

   !> Two points are one: distance over the extent of what they belong to, a body, fracture, circle
   !! or cell. Coordinates carry some 1e-16 of that, given ones the digits somebody wrote; no mesh
   !! resolves lengths near it.
   real(rk), parameter :: same_place = 1.0e-9_rk

   !> Two directions are one: angle [rad], its sine, or the difference of unit vectors.
   real(rk), parameter :: same_direction = 1.0e-9_rk

   !> Two results are one: difference over their size. Equations solved one after the other, as
   !! those of contact and growth are, leave less than this between them.
   real(rk), parameter :: same_value = 1.0e-9_rk

   !> Two times or steps are one: difference over their size. They are sums of few terms.
   real(rk), parameter :: same_time = 1.0e-12_rk

   !> What is nothing: a sum over the size of its terms, where these cancel up to rounding.
   real(rk), parameter :: round_off = 1.0e-12_rk

end module base_tolerances
