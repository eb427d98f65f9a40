!> Kinds of all numbers, and pi.
module base_kinds
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   implicit none(type, external)
   private

   public :: degrees, ik, lk, pi, radians, rk

   integer, parameter :: rk = real64  !< reals
   integer, parameter :: ik = int32  !< integers: indices into meshes and matrices
   integer, parameter :: lk = int64  !< integers that count operations or clock ticks

   real(rk), parameter :: pi = acos(-1.0_rk)
   real(rk), parameter :: degrees = 180.0_rk/pi  !< per radian
   real(rk), parameter :: radians = pi/180.0_rk  !< per degree

end module base_kinds
