!> Kinds of all numbers.
module base_kinds
   use, intrinsic :: iso_fortran_env, only: int32, int64, real64
   implicit none(type, external)
   private

   public :: ik, lk, rk

   integer, parameter :: rk = real64  !< reals
   integer, parameter :: ik = int32  !< integers: indices into meshes and matrices
   integer, parameter :: lk = int64  !< integers that count operations or clock ticks

end module base_kinds
