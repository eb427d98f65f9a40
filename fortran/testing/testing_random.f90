!> Random numbers that are the same on every machine.
module testing_random
   use base_kinds, only: lk
   implicit none(type, external)
   private

   public :: random_t

   integer(lk), parameter :: modulus = 2147483647_lk, multiplier = 16807_lk

   !> A linear congruential sequence (Lewis, Goodman and Miller 1969).
   type :: random_t
      integer(lk), private :: seed = 20231101_lk
   contains
      procedure :: start
      procedure :: below
   end type random_t

contains

   !> Begin the sequence that belongs to a number, 0 or more. Those of neighbours have nothing in
   !! common.
   pure subroutine start(self, number)
      class(random_t), intent(inout) :: self
      integer(lk), intent(in) :: number
      integer :: i

      self%seed = 1_lk + mod(number, modulus - 1_lk)
      do i = 1, 4
         self%seed = mod(multiplier*self%seed + 12345_lk*i, modulus)
      end do
      if (self%seed == 0_lk) self%seed = 1_lk
   end subroutine start

   !> A number from 0 to n - 1.
   integer function below(self, n)
      class(random_t), intent(inout) :: self
      integer, intent(in) :: n

      self%seed = mod(multiplier*self%seed, modulus)
      below = int(mod(self%seed, int(n, lk)))
   end function below

end module testing_random
