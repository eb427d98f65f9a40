!> The order of elimination of the unknowns of a sparse system: nested dissection by METIS (Karypis
!! and Kumar 1998), or approximate minimum degree by CAMD of SuiteSparse (Amestoy, Davis and Duff
!! 2004). Nested dissection gives fewer entries in the factors of large meshes, and takes longer.
module algebra_ordering
   use, intrinsic :: iso_c_binding, only: c_int32_t, c_null_ptr, c_ptr
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: dissect, expand_order, minimum_degree, neighbours_of

   integer, parameter :: n_options = 40  !< METIS_NOPTIONS
   ! Places of options among those, from 0 (moptions_et of metis.h).
   integer, parameter :: option_seed = 8, option_compress = 12, option_numbering = 17
   integer(c_int32_t), parameter :: metis_ok = 1
   integer(c_int32_t), parameter :: seed = 1  !< any: the same at every call

   interface
      integer(c_int32_t) function metis_set_default_options(options) &
         bind(c, name="METIS_SetDefaultOptions")
         import :: c_int32_t, n_options
         implicit none(type, external)
         integer(c_int32_t), intent(out) :: options(n_options)
      end function metis_set_default_options

      integer(c_int32_t) function algebra_node_nd(n, first, item, options, order, place) bind(c)
         import :: c_int32_t, n_options
         implicit none(type, external)
         integer(c_int32_t), value :: n
         integer(c_int32_t), intent(in) :: first(n + 1), item(first(n + 1))
         integer(c_int32_t), intent(in) :: options(n_options)
         integer(c_int32_t), intent(out) :: order(n), place(n)
      end function algebra_node_nd

      integer(c_int32_t) function camd_order(n, first, item, order, control, info, set) bind(c)
         import :: c_int32_t, c_ptr
         implicit none(type, external)
         integer(c_int32_t), value :: n
         integer(c_int32_t), intent(in) :: first(n + 1), item(first(n + 1)), set(n)
         integer(c_int32_t), intent(out) :: order(n)
         type(c_ptr), value :: control, info
      end function camd_order
   end interface

contains

   !> Order the nodes of a graph. The same graph has the same order every time.
   !!
   !! An error is raised where METIS refuses: no memory, or a graph that is none.
   subroutine dissect(neighbours, place, error)
      !> Of each node; symmetric, no node its own neighbour
      type(lists_t), intent(in) :: neighbours
      integer(ik), allocatable, intent(out) :: place(:)  !< (n) of each node in the order, from 1
      type(error_t), allocatable, intent(out) :: error
      integer(c_int32_t) :: options(0:n_options - 1), status
      integer(c_int32_t), allocatable :: order(:)
      integer(ik) :: n

      n = size(neighbours%first, kind=ik) - 1
      allocate (order(n), place(n))
      if (n < 2) then
         place = 1
         return
      end if
      if (metis_set_default_options(options) == metis_ok) then
         options(option_seed) = seed
         options(option_compress) = 0  ! nodes with the same neighbours are not looked for
         options(option_numbering) = 0  ! from 1 METIS would change the graph for a while
         associate (first => neighbours%first - 1, item => neighbours%item - 1)
            ! METIS seeds and draws the random numbers of the C library, as gmsh does.
            !$omp critical (c_random_numbers)
            status = algebra_node_nd(n, first, item, options, order, place)
            !$omp end critical (c_random_numbers)
            if (status == metis_ok) then
               place = place + 1
               return
            end if
         end associate
      end if
      call raise_error(error, "dissect", "METIS could not order the unknowns")
   end subroutine dissect

   !> Order the nodes of a graph by approximate minimum degree, one group after another.
   subroutine minimum_degree(later, group, order, error)
      type(lists_t), intent(in) :: later  !< of each node its neighbours with higher numbers, rising
      integer(ik), intent(in) :: group(:)  !< (n) numbers from 0, less than n
      integer(ik), allocatable, intent(out) :: order(:)  !< (n) the nodes one after another
      type(error_t), allocatable, intent(out) :: error
      integer(c_int32_t), parameter :: camd_ok = 0
      integer(c_int32_t) :: status
      integer(ik) :: n

      n = size(group, kind=ik)
      allocate (order(n))
      if (n == 0) return
      status = camd_order(n, later%first - 1, later%item - 1, order, c_null_ptr, c_null_ptr, &
                          int(group, c_int32_t))
      order = order + 1
      if (status /= camd_ok) then
         call raise_error(error, "minimum_degree", "CAMD could not order the unknowns")
      end if
   end subroutine minimum_degree

   !> The graph of a symmetric matrix from the columns of its lower triangle, row by row, the
   !! diagonal included or not.
   pure function neighbours_of(columns, n) result(neighbours)
      type(lists_t), intent(in) :: columns
      integer(ik), intent(in) :: n  !< so many rows; those after them are left out
      type(lists_t) :: neighbours
      integer(ik), allocatable :: next(:)
      integer(ik) :: i, j, k

      allocate (neighbours%first(n + 1), source=0_ik)
      associate (first => neighbours%first)
         do i = 1, n
            do k = columns%first(i), columns%last(i)
               j = columns%item(k)
               if (j == i) cycle
               first(i + 1) = first(i + 1) + 1
               first(j + 1) = first(j + 1) + 1
            end do
         end do
         first(1) = 1
         do i = 1, n
            first(i + 1) = first(i + 1) + first(i)
         end do
         allocate (neighbours%item(first(n + 1) - 1))
         next = first(:n)
      end associate
      do i = 1, n
         do k = columns%first(i), columns%last(i)
            j = columns%item(k)
            if (j == i) cycle
            neighbours%item(next(i)) = j
            neighbours%item(next(j)) = i
            next([i, j]) = next([i, j]) + 1
         end do
      end do
   end function neighbours_of

   !> From places of blocks to those of their unknowns, which stand one block after another; blocks
   !! that have no place come last as they stand.
   pure function expand_order(place, per_block, n_blocks) result(expanded)
      integer(ik), intent(in) :: place(:)  !< (first blocks) from 1
      integer(ik), intent(in) :: per_block  !< unknowns of a block
      integer(ik), intent(in) :: n_blocks
      integer(ik) :: expanded(per_block*n_blocks)
      integer(ik) :: a, at, i

      do i = 1, n_blocks
         at = i
         if (i <= size(place)) at = place(i)
         do a = 1, per_block
            expanded(per_block*(i - 1) + a) = per_block*(at - 1) + a
         end do
      end do
   end function expand_order

end module algebra_ordering
