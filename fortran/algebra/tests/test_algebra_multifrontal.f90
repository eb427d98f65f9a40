!> Multifrontal elimination: known solutions, Schur complements against springs in series and dense
!! elimination, singular matrices.
program test_algebra_multifrontal
   use algebra_lapack, only: dgesv
   use algebra_multifrontal, only: multifrontal_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use sample_elements, only: chain, matrices_t
   use testing_checks, only: checks_t
   use testing_random, only: random_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call solves_a_chain()
   call condenses_springs()
   call agrees_with_dense(8_ik, 3_ik, 0_ik)
   call agrees_with_dense(40_ik, 60_ik, 5_ik)
   call agrees_with_dense(150_ik, 300_ik, 40_ik)
   call agrees_with_dense(8_ik, 3_ik, 0_ik, every=2_ik)
   call agrees_with_dense(40_ik, 60_ik, 5_ik, every=3_ik)
   call agrees_with_dense(150_ik, 300_ik, 0_ik, every=1_ik)
   call agrees_with_dense(150_ik, 300_ik, 40_ik, every=3_ik)
   call agrees_with_dense(150_ik, 300_ik, 40_ik, every=3_ik, size_of_negative=1.0e-2_rk)
   call refuses_wrong_signs()
   call eliminates_again(40_ik, 60_ik, 0_ik)
   call eliminates_again(150_ik, 300_ik, 20_ik)
   call solves_a_grid(2_ik)
   call solves_a_grid(60_ik)
   call solves_a_grid(110_ik)  ! large enough to be eliminated in parts
   call refuses()
   call checks%finish()

contains

   !> Second differences: -u'' = 2 on (0, 1) has the solution x(1-x) at the nodes, exactly.
   subroutine solves_a_chain()
      integer(ik), parameter :: n = 50
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      integer(ik) :: i
      real(rk) :: x(n), h

      h = 1.0_rk/real(n + 1, rk)
      matrices = chain(n, h**(-2), .true.)
      call solver%analyse(matrices%first_unknown, matrices%elements, error)
      call checks%no_error(error, "analyse")
      call solver%factorize(matrices, error)
      call checks%no_error(error, "factorize")
      x = 2.0_rk
      call solver%solve(x, error)
      call checks%no_error(error, "solve")
      call checks%is_close(maxval(abs(x - [(i*h*(1.0_rk - i*h), i=1, n)])), 0.0_rk, 1.0e-13_rk, &
                           "parabola")
      matrices%entry = 2.0_rk*matrices%entry
      call solver%factorize(matrices, error)
      x = 4.0_rk
      call solver%solve(x, error)
      call checks%is_close(x(n/2), (n/2)*h*(1.0_rk - (n/2)*h), 1.0e-13_rk, "values replaced")
   end subroutine solves_a_chain

   !> A free chain of springs k, condensed onto unknowns a and b with m springs between them: the
   !! stiffness k/m between the two, which is singular. A force on the middle one of four springs is
   !! borne by halves.
   subroutine condenses_springs()
      integer(ik), parameter :: n = 12, a = 9, b = 5
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      real(rk), allocatable :: s(:, :)
      real(rk) :: load(n), reduced(2), x(n)

      matrices = chain(n, 3.0_rk, .false.)
      call solver%analyse(matrices%first_unknown, matrices%elements, error, kept=[a, b])
      call solver%factorize(matrices, error)
      call checks%no_error(error, "what is kept may float")
      call solver%get_schur(s)
      call checks%is_close(maxval(abs(s - 0.75_rk*reshape([1.0_rk, -1.0_rk, -1.0_rk, 1.0_rk], &
                                                          [2, 2]))), 0.0_rk, 1.0e-14_rk, "springs")
      load = 0.0_rk
      load(7) = 6.0_rk
      call solver%condense(load, reduced, error)
      call checks%no_error(error, "condense")
      call checks%is_close(maxval(abs(reduced - 3.0_rk)), 0.0_rk, 1.0e-14_rk, "load")
      ! With a at 2 and b at 1, the middle is at 1.5 and 2 higher: 6/(3/2 + 3/2).
      call solver%expand([2.0_rk, 1.0_rk], x, error)
      call checks%no_error(error, "expand")
      call checks%is_close(x(7), 3.5_rk, 1.0e-14_rk, "middle")
      call checks%is_close(maxval(abs(x([1, 4, 5, 9, 12]) - [1.0_rk, 1.0_rk, 1.0_rk, 2.0_rk, &
                                                             2.0_rk])), 0.0_rk, 1.0e-14_rk, "ends")
   end subroutine condenses_springs

   !> Random blocks of one to three unknowns in random definite elements, and an element of every
   !! single block. Where some unknowns have negative pivots, what they have with each other is
   !! turned negative: such matrices are quasi-definite. The order is then a given one, that in
   !! which the blocks stand.
   subroutine agrees_with_dense(n_blocks, n_elements, n_kept, every, size_of_negative)
      integer(ik), intent(in) :: n_blocks, n_elements
      integer(ik), intent(in) :: n_kept  !< blocks
      integer(ik), intent(in), optional :: every  !< which unknowns have negative pivots
      real(rk), intent(in), optional :: size_of_negative  !< instead of 1
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      real(rk), allocatable :: dense(:, :), free(:, :), load(:), reduced(:), s(:, :), x(:)
      integer(ik), allocatable :: kept(:), kept_blocks(:), order(:), others(:), places(:)
      logical, allocatable :: is_negative(:)
      integer(ik) :: b, e, i, info, n

      call random_elements(n_blocks, n_elements, matrices)
      n = matrices%first_unknown(n_blocks + 1) - 1
      if (present(every)) then
         is_negative = [(modulo(i, every) == 0, i=1, n)]
         if (present(size_of_negative)) then
            call turn_negative(matrices, is_negative, size_of_negative)
         else
            call turn_negative(matrices, is_negative, 1.0_rk)
         end if
      end if
      allocate (dense(n, n), load(n), x(n), source=0.0_rk)
      do e = 1, size(matrices%elements%first, kind=ik) - 1
         places = unknowns_of(matrices, matrices%elements%of(e))
         dense(places, places) = dense(places, places) &
                                 + reshape(matrices%entry(matrices%first(e): &
                                                          matrices%first(e + 1) - 1), &
                                           [size(places), size(places)])
      end do
      ! Every third block from the end, in that order.
      kept_blocks = [(n_blocks - 3*b, b=0, n_kept - 1)]
      kept = unknowns_of(matrices, kept_blocks)
      others = pack([(i, i=1, n)], [(all(kept /= i), i=1, n)])
      if (present(every)) then
         order = [pack([(b, b=1, n_blocks)], [(all(kept_blocks /= b), b=1, n_blocks)]), kept_blocks]
         call solver%analyse(matrices%first_unknown, matrices%elements, error, kept=kept, &
                             order=order, is_negative=is_negative)
      else
         call solver%analyse(matrices%first_unknown, matrices%elements, error, kept=kept)
      end if
      call checks%no_error(error, "analyse blocks")
      call solver%factorize(matrices, error)
      call checks%no_error(error, "factorize blocks")
      load = [(sin(1.0_rk*i), i=1, n)]
      if (n_kept == 0) then
         x = load
         call solver%solve(x, error)
         call checks%is_close(maxval(abs(matmul(dense, x) - load)), 0.0_rk, 1.0e-12_rk, "blocks")
         return
      end if
      call solver%get_schur(s)
      free = dense(others, kept)
      associate (inner => dense(others, others), m => size(others, kind=ik))
         call solve_dense(m, size(kept, kind=ik), inner, free, info)
      end associate
      free = dense(kept, kept) - matmul(dense(kept, others), free)
      call checks%is_close(maxval(abs(s - free)), 0.0_rk, 1.0e-12_rk*maxval(dense), &
                           "Schur complement of blocks")
      allocate (reduced(size(kept)))
      call solver%condense(load, reduced, error)
      x(kept) = reduced
      associate (m => size(kept, kind=ik))
         free = reshape(reduced, [m, 1_ik])
         call solve_dense(m, 1_ik, s, free, info)
      end associate
      call solver%expand(free(:, 1), x, error)
      call checks%is_close(maxval(abs(matmul(dense, x) - load)), 0.0_rk, 1.0e-11_rk, "by blocks")
   end subroutine agrees_with_dense

   subroutine solve_dense(n, n_sides, matrix, x, info)
      integer(ik), intent(in) :: n, n_sides
      real(rk), intent(in) :: matrix(n, n)
      real(rk), intent(inout) :: x(n, n_sides)
      integer(ik), intent(out) :: info
      real(rk) :: factors(n, n)
      integer(ik) :: pivots(n)

      factors = matrix
      call dgesv(n, n_sides, factors, n, pivots, x, n, info)
   end subroutine solve_dense

   pure function unknowns_of(matrices, blocks) result(unknowns)
      type(matrices_t), intent(in) :: matrices
      integer(ik), intent(in) :: blocks(:)
      integer(ik), allocatable :: unknowns(:)
      integer(ik) :: i, k

      unknowns = [integer(ik) ::]
      do k = 1, size(blocks, kind=ik)
         unknowns = [unknowns, [(i, i=matrices%first_unknown(blocks(k)), &
                                 matrices%first_unknown(blocks(k) + 1) - 1)]]
      end do
   end function unknowns_of

   subroutine random_elements(n_blocks, n_elements, matrices)
      integer(ik), intent(in) :: n_blocks, n_elements
      type(matrices_t), intent(out) :: matrices
      type(random_t) :: random
      real(rk), allocatable :: root(:, :)
      integer(ik), allocatable :: blocks(:)
      integer(ik) :: b, e, i, j, n

      allocate (matrices%first_unknown(n_blocks + 1))
      matrices%first_unknown(1) = 1
      do b = 1, n_blocks
         matrices%first_unknown(b + 1) = matrices%first_unknown(b) + 1 + random%below(3)
      end do
      matrices%elements%first = [1_ik]
      matrices%elements%item = [integer(ik) ::]
      matrices%first = [1_ik]
      matrices%entry = [real(rk) ::]
      do e = 1, n_elements + n_blocks
         blocks = [max(e - n_elements, 1_ik)]
         do while (e <= n_elements .and. size(blocks) < 4)
            b = 1 + random%below(n_blocks)
            if (all(blocks /= b)) blocks = [blocks, b]
         end do
         if (e <= n_elements) blocks = blocks(2:)
         n = size(unknowns_of(matrices, blocks))
         if (allocated(root)) deallocate (root)
         allocate (root(n, n))
         do j = 1, n
            do i = 1, n
               root(i, j) = 0.001_rk*random%below(1001) - 0.5_rk
            end do
            root(j, j) = root(j, j) + 1.0_rk
         end do
         matrices%elements%item = [matrices%elements%item, blocks]
         matrices%elements%first = [matrices%elements%first, &
                                    size(matrices%elements%item, kind=ik) + 1_ik]
         matrices%entry = [matrices%entry, reshape(matmul(root, transpose(root)), [n*n])]
         matrices%first = [matrices%first, size(matrices%entry, kind=ik) + 1_ik]
      end do
   end subroutine random_elements

   !> Where only elements change that are said to, elimination again gives what a whole elimination
   !! gives, bit for bit; where others change too, it is not asked for.
   subroutine eliminates_again(n_blocks, n_elements, n_kept)
      integer(ik), intent(in) :: n_blocks, n_elements, n_kept
      type(multifrontal_t) :: solver, whole
      type(matrices_t) :: matrices
      real(rk), allocatable :: s(:, :), s_whole(:, :), x(:), x_whole(:)
      logical, allocatable :: changes(:)
      integer(ik), allocatable :: kept(:)
      integer(ik) :: b, e, i, n, turn

      call random_elements(n_blocks, n_elements, matrices)
      n = matrices%first_unknown(n_blocks + 1) - 1
      kept = unknowns_of(matrices, [(n_blocks - 3*b, b=0, n_kept - 1)])
      changes = [(modulo(e, 20_ik) == 3, e=1, size(matrices%first, kind=ik) - 1)]
      call solver%analyse(matrices%first_unknown, matrices%elements, error, kept, changes=changes)
      call checks%no_error(error, "analyse elements that change")
      call solver%factorize(matrices, error)
      call whole%analyse(matrices%first_unknown, matrices%elements, error, kept, changes=changes)
      do turn = 1, 3
         do e = 1, size(changes, kind=ik)
            if (.not. (changes(e) .or. turn == 3)) cycle
            associate (own => matrices%entry(matrices%first(e):matrices%first(e + 1) - 1))
               own = 1.25_rk*own
            end associate
         end do
         call solver%factorize(matrices, error, others_are_same=turn < 3)
         call checks%no_error(error, "factorize again")
         call whole%factorize(matrices, error)
         x = [(cos(1.0_rk*i), i=1, n)]
         x_whole = x
         if (n_kept == 0) then
            call solver%solve(x, error)
            call whole%solve(x_whole, error)
         else
            call solver%get_schur(s)
            call whole%get_schur(s_whole)
            call checks%is_close(maxval(abs(s - s_whole)), 0.0_rk, 0.0_rk, "the same complement")
            call solver%condense(x, s(:, 1), error)
            call solver%expand(s(:, 1), x, error)
            call whole%condense(x_whole, s(:, 1), error)
            call whole%expand(s(:, 1), x_whole, error)
         end if
         call checks%is_close(maxval(abs(x - x_whole)), 0.0_rk, 0.0_rk, "the same solution")
      end do
   end subroutine eliminates_again

   !> Springs to both neighbours in a square grid of pairs of unknowns, and to the ground: where all
   !! forces are those of the springs to the ground, all unknowns are 1. Its fronts are large.
   subroutine solves_a_grid(n)
      integer(ik), intent(in) :: n  !< along a side
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      real(rk) :: spring(4, 4), x(2*n*n)
      integer(ik) :: i, j, node

      matrices%first_unknown = [(2*i - 1, i=1, n*n + 1)]
      matrices%elements%item = [integer(ik) ::]
      do j = 1, n
         do i = 1, n
            node = n*(j - 1) + i
            if (i < n) matrices%elements%item = [matrices%elements%item, node, node + 1]
            if (j < n) matrices%elements%item = [matrices%elements%item, node, node + n]
         end do
      end do
      associate (n_elements => size(matrices%elements%item, kind=ik)/2)
         matrices%elements%first = [(2*i - 1, i=1, n_elements + 1)]
         matrices%first = [(16*i - 15, i=1, n_elements + 1)]
         spring = 0.0_rk
         do i = 1, 4
            spring(i, i) = 1.25_rk  ! 1 to the neighbour, 1/4 to the ground
            spring(i, 1 + modulo(i + 1, 4)) = -1.0_rk
         end do
         matrices%entry = [(reshape(spring, [16]), i=1, n_elements)]
      end associate
      call solver%analyse(matrices%first_unknown, matrices%elements, error)
      call checks%no_error(error, "analyse a grid")
      call solver%factorize(matrices, error)
      call checks%no_error(error, "factorize a grid")
      x = 0.0_rk
      do i = 1, size(matrices%elements%item, kind=ik)
         node = matrices%elements%item(i)
         x(2*node - 1:2*node) = x(2*node - 1:2*node) + 0.25_rk
      end do
      call solver%solve(x, error)
      call checks%is_close(maxval(abs(x - 1.0_rk)), 0.0_rk, 1.0e-12_rk, "a grid")
   end subroutine solves_a_grid

   !> Turn what some unknowns have with each other negative, in all elements.
   subroutine turn_negative(matrices, is_negative, factor)
      type(matrices_t), intent(inout) :: matrices
      logical, intent(in) :: is_negative(:)
      real(rk), intent(in) :: factor
      integer(ik), allocatable :: places(:)
      integer(ik) :: a, at, b, e

      at = 0
      do e = 1, size(matrices%elements%first, kind=ik) - 1
         places = unknowns_of(matrices, matrices%elements%of(e))
         do b = 1, size(places, kind=ik)
            do a = 1, size(places, kind=ik)
               at = at + 1
               if (is_negative(places(a)) .and. is_negative(places(b))) then
                  matrices%entry(at) = -factor*matrices%entry(at)
               end if
            end do
         end do
      end do
   end subroutine turn_negative

   !> A definite matrix that is said to be quasi-definite, in small fronts and in a large one.
   subroutine refuses_wrong_signs()
      integer(ik), parameter :: sizes(2) = [5_ik, 200_ik]
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      integer(ik) :: i, j, k, n

      do k = 1, size(sizes)
         n = sizes(k)
         matrices%first_unknown = [1_ik, n + 1]
         matrices%elements%first = [1_ik, 2_ik]
         matrices%elements%item = [1_ik]
         matrices%first = [1_ik, n*n + 1]
         matrices%entry = [((merge(2.0_rk, 1.0_rk/n, i == j), i=1, n), j=1, n)]
         call solver%analyse(matrices%first_unknown, matrices%elements, error, order=[1_ik], &
                             is_negative=[(i == n, i=1, n)])
         call solver%factorize(matrices, error)
         call checks%fails_with(error, "quasi-definite", "a pivot of the wrong sign")
         matrices%entry(n*n) = -2.0_rk
         call solver%factorize(matrices, error)
         call checks%no_error(error, "a pivot of the right sign")
      end do
   end subroutine refuses_wrong_signs

   subroutine refuses()
      type(multifrontal_t) :: solver
      type(matrices_t) :: matrices
      real(rk) :: nothing, x(5)
      integer :: k

      call solver%factorize(matrices, error)
      call checks%fails_with(error, "analysed", "factors of nothing")
      matrices = chain(5_ik, -1.0_rk, .true.)
      call solver%analyse(matrices%first_unknown, matrices%elements, error)
      call solver%factorize(matrices, error)
      call checks%fails_with(error, "indefinite", "negative springs")
      x = 1.0_rk
      call solver%solve(x, error)
      call checks%fails_with(error, "factorized", "solution without factors")
      matrices = chain(5_ik, 1.0_rk, .false.)
      call solver%analyse(matrices%first_unknown, matrices%elements, error)
      call solver%factorize(matrices, error)
      call checks%fails_with(error, "singular", "a chain that floats")
      ! Unknowns that have nothing to do with each other: whichever is eliminated last.
      matrices%first_unknown = [1_ik, 2_ik, 3_ik, 4_ik]
      matrices%elements%first = [1_ik, 2_ik, 3_ik, 4_ik]
      matrices%elements%item = [1_ik, 2_ik, 3_ik]
      matrices%first = [1_ik, 2_ik, 3_ik, 4_ik]
      do k = 1, 3
         matrices%entry = [2.0_rk, 3.0_rk, 5.0_rk]
         matrices%entry(k) = -1.0_rk
         call solver%analyse(matrices%first_unknown, matrices%elements, error)
         call solver%factorize(matrices, error)
         call checks%fails_with(error, "indefinite", "one negative spring of three")
      end do
      nothing = 0.0_rk
      matrices = chain(5_ik, nothing/nothing, .true.)
      call solver%analyse(matrices%first_unknown, matrices%elements, error)
      call solver%factorize(matrices, error)
      call checks%fails_with(error, "finite", "NaN in the matrix")
      call solver%analyse(matrices%first_unknown, matrices%elements, error, kept=[5_ik])
      call solver%factorize(matrices, error)
      call checks%fails_with(error, "finite", "NaN and a kept unknown")
   end subroutine refuses

end program test_algebra_multifrontal
