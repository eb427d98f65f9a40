!> Orders of unknowns: permutations, the same every time; of a grid, with the fill that nested
!! dissection is known for; and MUMPS, which takes them.
program test_algebra_ordering
   use algebra_mumps, only: mumps_indefinite, mumps_t
   use algebra_ordering, only: dissect, expand_order, neighbours_of
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call finds_neighbours()
   call dissects_grid()
   call orders_little()
   call expands()
   call serves_mumps()
   call checks%finish()

contains

   !> The lower triangle of a square grid's graph, the diagonal included, row by row.
   pure function grid(n) result(columns)
      integer(ik), intent(in) :: n  !< nodes along a side
      type(lists_t) :: columns
      integer(ik) :: found(3*n*n), i, j, k, node

      allocate (columns%first(n*n + 1))
      k = 0
      do j = 1, n
         do i = 1, n
            node = n*(j - 1) + i
            columns%first(node) = k + 1
            if (j > 1) then
               k = k + 1
               found(k) = node - n
            end if
            if (i > 1) then
               k = k + 1
               found(k) = node - 1
            end if
            k = k + 1
            found(k) = node
         end do
      end do
      columns%first(n*n + 1) = k + 1
      columns%item = found(:k)
   end function grid

   pure logical function is_permutation(place)
      integer(ik), intent(in) :: place(:)
      logical :: is_taken(size(place))
      integer :: i

      is_taken = .false.
      is_permutation = all(place >= 1 .and. place <= size(place))
      if (.not. is_permutation) return
      do i = 1, size(place)
         is_taken(place(i)) = .true.
      end do
      is_permutation = all(is_taken)
   end function is_permutation

   !> Both neighbours of a node of a chain, from the one that its row holds; the last row left out.
   subroutine finds_neighbours()
      type(lists_t) :: columns, neighbours

      columns%first = [1_ik, 2_ik, 4_ik, 6_ik, 8_ik]
      columns%item = [1_ik, 1_ik, 2_ik, 2_ik, 3_ik, 3_ik, 4_ik]
      neighbours = neighbours_of(columns, 3_ik)
      call checks%is_true(size(neighbours%first) == 4, "as many lists as rows")
      call checks%is_true(all(neighbours%of(1_ik) == [2]), "of the first")
      call checks%is_true(all(neighbours%of(2_ik) == [1, 3]), "of the second")
      call checks%is_true(neighbours%length(3_ik) == 1 .and. all(neighbours%of(3_ik) == [2]), &
                          "of the third, without the row that is left out")
   end subroutine finds_neighbours

   !> The factors of an n x n grid hold less than 31/4 n^2 log2(n) entries (George 1973), where row
   !! by row they would hold n^3.
   subroutine dissects_grid()
      integer(ik), parameter :: n = 60
      type(lists_t) :: neighbours
      integer(ik), allocatable :: again(:), place(:)

      neighbours = neighbours_of(grid(n), n*n)
      call dissect(neighbours, place, error)
      call checks%no_error(error, "dissect")
      call checks%is_true(is_permutation(place), "every place is taken once")
      call dissect(neighbours, again, error)
      call checks%is_true(all(again == place), "the same order again")
      call checks%is_true(fill(neighbours, place) < 7.75_rk*n*n*log(real(n, rk))/log(2.0_rk), &
                          "no more fill than nested dissection has")
   end subroutine dissects_grid

   !> Entries of the factors: the neighbours of each node when it leaves, which become neighbours of
   !! each other.
   real(rk) function fill(neighbours, place)
      type(lists_t), intent(in) :: neighbours
      integer(ik), intent(in) :: place(:)
      logical, allocatable :: meet(:, :)
      integer(ik) :: i, j, k, n, order(size(place))

      n = size(place, kind=ik)
      allocate (meet(n, n), source=.false.)
      do i = 1, n
         order(place(i)) = i
      end do
      do i = 1, n
         do k = neighbours%first(i), neighbours%last(i)
            meet(place(neighbours%item(k)), place(i)) = .true.
         end do
      end do
      fill = 0.0_rk
      do i = 1, n
         fill = fill + 1 + count(meet(i + 1:, i))
         ! The first of them takes over the others.
         j = findloc(meet(i + 1:, i), .true., dim=1) + i
         if (j == i) cycle
         meet(j + 1:, j) = meet(j + 1:, j) .or. meet(j + 1:, i)
      end do
   end function fill

   !> No node, one, and two that do not meet.
   subroutine orders_little()
      type(lists_t) :: neighbours
      integer(ik), allocatable :: place(:)
      integer(ik) :: n

      do n = 0, 2
         neighbours%first = spread(1_ik, 1, n + 1)
         neighbours%item = [integer(ik) ::]
         call dissect(neighbours, place, error)
         call checks%no_error(error, "few nodes")
         call checks%is_true(size(place) == n .and. is_permutation(place), "a place for each")
      end do
   end subroutine orders_little

   !> Two blocks of three exchanged, and one that has no place.
   subroutine expands()
      call checks%is_true(all(expand_order([2_ik, 1_ik], 3_ik, 3_ik) &
                              == [4, 5, 6, 1, 2, 3, 7, 8, 9]), "places of unknowns")
   end subroutine expands

   !> A grid whose sides are held has the solution 1 under the load that this makes; condensed onto
   !! its last two nodes in a given order it is the same matrix as without the order.
   subroutine serves_mumps()
      integer(ik), parameter :: n = 20
      type(lists_t) :: columns
      type(mumps_t) :: condensed, ordered, plain
      integer(ik), allocatable :: place(:), row(:)
      integer(ik) :: i, k
      real(rk), allocatable :: values(:), x(:, :)
      real(rk) :: expected(2, 2), schur(2, 2)

      columns = grid(n)
      row = [((i, k=1, columns%length(i)), i=1, n*n)]
      values = merge(4.0_rk, -1.0_rk, row == columns%item)
      allocate (x(n*n, 1), source=0.0_rk)
      do k = 1, size(row)
         x(row(k), 1) = x(row(k), 1) + values(k)
         if (row(k) /= columns%item(k)) x(columns%item(k), 1) = x(columns%item(k), 1) + values(k)
      end do
      call dissect(neighbours_of(columns, n*n), place, error)
      call ordered%analyse(n*n, row, columns%item, mumps_indefinite, error, place=place)
      call checks%no_error(error, "analyse in this order")
      call ordered%factorize(values, error)
      call checks%no_error(error, "factorize in this order")
      call ordered%solve(x, error)
      call checks%is_close(maxval(abs(x - 1.0_rk)), 0.0_rk, 1.0e-12_rk, "the solution is one")
      associate (last => [n*n - 1, n*n])
         call dissect(neighbours_of(columns, n*n - 2_ik), place, error)
         call condensed%analyse(n*n, row, columns%item, mumps_indefinite, error, schur=last, &
                                place=[place, last])
         call checks%no_error(error, "analyse with unknowns to condense onto last")
         call condensed%factorize(values, error, schur)
         call plain%analyse(n*n, row, columns%item, mumps_indefinite, error, schur=last)
         call plain%factorize(values, error)
         call plain%get_schur(expected)
      end associate
      call checks%is_close(maxval(abs(schur - expected)), 0.0_rk, 1.0e-13_rk, "condensed alike")
      call checks%is_close(schur(2, 1), schur(1, 2), 0.0_rk, "both triangles are given")
   end subroutine serves_mumps

end program test_algebra_ordering
