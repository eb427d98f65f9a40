!> The routines of LAPACK and BLAS in use, declared so that the compiler checks every call.
!!
!! Dense systems with n unknowns and nrhs right-hand sides; lda and ldb are the numbers of rows that
!! the arrays have. `info` is 0 for success, -i where argument i is wrong, and i where pivot i is
!! exactly zero or, for Cholesky, not positive (LAPACK Users' Guide, third edition, Anderson and
!! others 1999).
module algebra_lapack
   use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: dgemm, dgesv, dgetrf, dgetrs, dlacn2, dlaswp, dpotrf, dpotrs, dsyev, dsyrk, dtrsm
   public :: estimate_norm, symmetric_product

   interface
      !> C := alpha op(A) op(B) + beta C.
      subroutine dgemm(transa, transb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
         import :: ik, rk
         implicit none(type, external)
         character(len=1), intent(in) :: transa, transb
         integer(ik), intent(in) :: m, n, k, lda, ldb, ldc
         real(rk), intent(in) :: alpha, beta
         ! Parts of larger matrices, whose last column may end early.
         ! allow(C071)
         real(rk), intent(in) :: a(lda, *), b(ldb, *)
         ! allow(C071)
         real(rk), intent(inout) :: c(ldc, *)
      end subroutine dgemm

      !> Solve A X = B by LU factors with row exchanges. On return A holds the factors, B is X.
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: ik, rk
         implicit none(type, external)
         integer(ik), intent(in) :: n, nrhs, lda, ldb
         real(rk), intent(inout) :: a(lda, n)
         integer(ik), intent(out) :: ipiv(n)  !< row i was exchanged with row ipiv(i)
         real(rk), intent(inout) :: b(ldb, nrhs)
         integer(ik), intent(out) :: info
      end subroutine dgesv

      !> Replace A by its LU factors, with row exchanges.
      subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: ik, rk
         implicit none(type, external)
         integer(ik), intent(in) :: m, n, lda
         real(rk), intent(inout) :: a(lda, n)
         integer(ik), intent(out) :: ipiv(min(m, n))
         integer(ik), intent(out) :: info
      end subroutine dgetrf

      !> Solve A X = B, or with its transpose, from the factors of dgetrf.
      subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: trans  !< "N" for A, "T" for its transpose
         integer(ik), intent(in) :: n, nrhs, lda, ldb
         real(rk), intent(in) :: a(lda, n)
         integer(ik), intent(in) :: ipiv(n)
         real(rk), intent(inout) :: b(ldb, nrhs)
         integer(ik), intent(out) :: info
      end subroutine dgetrs

      !> Estimate the 1-norm of a matrix from its products: begin with kase = 0; as long as it comes
      !! back as 1 or 2, replace x by the product of the matrix, or of its transpose, with x.
      subroutine dlacn2(n, v, x, isgn, est, kase, isave)
         import :: ik, rk
         implicit none(type, external)
         integer(ik), intent(in) :: n
         real(rk), intent(inout) :: v(n), x(n)
         integer(ik), intent(inout) :: isgn(n)
         real(rk), intent(inout) :: est
         integer(ik), intent(inout) :: kase, isave(3)
      end subroutine dlacn2

      !> Interchange rows k1 to k2 of A with those that ipiv names, one after another.
      subroutine dlaswp(n, a, lda, k1, k2, ipiv, incx)
         import :: ik, rk
         implicit none(type, external)
         integer(ik), intent(in) :: n, lda, k1, k2, incx
         real(rk), intent(inout) :: a(lda, n)
         integer(ik), intent(in) :: ipiv(k2)
      end subroutine dlaswp

      !> Replace a triangle of the symmetric positive definite A by its Cholesky factor.
      subroutine dpotrf(uplo, n, a, lda, info)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: uplo  !< "U" or "L": the triangle that is given; the other stays
         integer(ik), intent(in) :: n, lda
         real(rk), intent(inout) :: a(lda, n)
         integer(ik), intent(out) :: info
      end subroutine dpotrf

      !> Solve A X = B from the factor of dpotrf.
      subroutine dpotrs(uplo, n, nrhs, a, lda, b, ldb, info)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: uplo  !< as for dpotrf
         integer(ik), intent(in) :: n, nrhs, lda, ldb
         real(rk), intent(in) :: a(lda, n)
         real(rk), intent(inout) :: b(ldb, nrhs)
         integer(ik), intent(out) :: info
      end subroutine dpotrs

      !> Eigenvalues of a symmetric matrix, in ascending order.
      pure subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: jobz  !< "N": without the eigenvectors
         character, intent(in) :: uplo  !< the triangle that counts, "U" or "L"; used up
         integer(ik), intent(in) :: n, lda, lwork
         real(rk), intent(inout) :: a(lda, n)
         real(rk), intent(out) :: w(n)
         real(rk), intent(out) :: work(lwork)
         integer(ik), intent(out) :: info
      end subroutine dsyev

      !> y := alpha A x + beta y with a symmetric A.
      subroutine dsymv(uplo, n, alpha, a, lda, x, incx, beta, y, incy)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: uplo  !< the triangle that is read, "U" or "L"
         integer(ik), intent(in) :: n, lda, incx, incy
         real(rk), intent(in) :: alpha, beta
         real(rk), intent(in) :: a(lda, n), x(n)
         real(rk), intent(inout) :: y(n)
      end subroutine dsymv

      !> C = beta C + alpha A A' or, transposed, A' A, of C only one triangle.
      subroutine dsyrk(uplo, trans, n, k, alpha, a, lda, beta, c, ldc)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: uplo  !< "U" or "L": the triangle of C
         character, intent(in) :: trans  !< "N" for A A', "T" for A' A
         integer(ik), intent(in) :: n, k, lda, ldc
         real(rk), intent(in) :: alpha, beta
         real(rk), intent(in) :: a(lda, merge(k, n, trans == "N"))
         real(rk), intent(inout) :: c(ldc, n)
      end subroutine dsyrk

      !> Solve A X = alpha B or, from the right, X A = alpha B with a triangular A.
      subroutine dtrsm(side, uplo, transa, diag, m, n, alpha, a, lda, b, ldb)
         import :: ik, rk
         implicit none(type, external)
         character, intent(in) :: side  !< "L" or "R": where A stands
         character, intent(in) :: uplo  !< "U" or "L": the triangle that A is
         character, intent(in) :: transa  !< "N" for A, "T" for its transpose
         character, intent(in) :: diag  !< "U": ones on the diagonal, "N": what stands there
         integer(ik), intent(in) :: m, n, lda, ldb
         real(rk), intent(in) :: alpha
         real(rk), intent(in) :: a(lda, merge(m, n, side == "L"))
         real(rk), intent(inout) :: b(ldb, n)
      end subroutine dtrsm
   end interface

   integer(c_intptr_t), parameter :: cache_line = 64_c_intptr_t  ! [byte]
   integer(ik), parameter :: spare = 7  ! reals of a cache line but one

contains

   !> dlacn2 with arrays that begin at cache lines. OpenBLAS adds up long arrays in an order that
   !! depends on where they begin, and a restarted run has another memory.
   subroutine estimate_norm(n, v, x, isgn, est, kase, isave)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: v(n), x(n)
      integer(ik), intent(inout) :: isgn(n)
      real(rk), intent(inout) :: est
      integer(ik), intent(inout) :: kase, isave(3)
      real(rk), target :: v_store(n + spare), x_store(n + spare)
      integer(ik) :: at_v, at_x

      at_v = first_in_line(v_store)
      at_x = first_in_line(x_store)
      v_store(at_v:at_v + n - 1) = v
      x_store(at_x:at_x + n - 1) = x
      call dlacn2(n, v_store(at_v), x_store(at_x), isgn, est, kase, isave)
      v = v_store(at_v:at_v + n - 1)
      x = x_store(at_x:at_x + n - 1)
   end subroutine estimate_norm

   !> Product of a symmetric matrix, of which one triangle is read, with a vector. For large
   !! matrices it is memory that decides: three times as fast as matmul at 2,600 rows.
   function symmetric_product(matrix, x) result(y)
      real(rk), intent(in), contiguous :: matrix(:, :)  !< (n, n)
      real(rk), intent(in), contiguous :: x(:)  !< (n)
      real(rk) :: y(size(x))

      y = 0.0_rk
      associate (n => size(x, kind=ik))
         if (n > 0) call dsymv("L", n, 1.0_rk, matrix, n, x, 1_ik, 0.0_rk, y, 1_ik)
      end associate
   end function symmetric_product

   !> Index of the first element that begins a cache line.
   function first_in_line(store) result(at)
      real(rk), intent(in), target, contiguous :: store(:)
      integer(ik) :: at
      integer(c_intptr_t) :: address

      address = transfer(c_loc(store), address)
      at = 1 + int(modulo(-address, cache_line)/8_c_intptr_t, ik)
   end function first_in_line

end module algebra_lapack
