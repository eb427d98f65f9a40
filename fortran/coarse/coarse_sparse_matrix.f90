!> Cells and fractures together as one sparse matrix, for coarse_sparse_step: the equations of the
!! cells, which are constant for one length of the time step, and those of the fractures, with each
!! force as the sum over the cells around it (coarse_condensed).
module coarse_sparse_matrix
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_slopes, only: slopes_t
   implicit none(type, external)
   private

   public :: assemble_rock, assemble_rows

contains

   !> The equations of the cells as triplets, for scaled equations and unknowns.
   subroutine assemble_rock(condensed, slopes, col_scale, row, col, values)
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes  !< of the equations of the fractures
      real(rk), allocatable, intent(out) :: col_scale(:)
      integer(ik), allocatable, intent(out) :: row(:), col(:)
      real(rk), allocatable, intent(out) :: values(:)
      integer(ik), allocatable :: rock_col(:), rock_row(:)
      real(rk), allocatable :: rock(:)
      integer(ik) :: at, k, n, n_bulk, q

      call condensed%factors%get_entries(rock_row, rock_col, rock)
      n_bulk = condensed%coupling%n_bulk
      n = 2*count(rock_row /= rock_col) + count(rock_row == rock_col) &
          + count(condensed%coupling%col <= n_bulk)
      allocate (row(n), col(n), values(n))
      ! Pressures and flows of the fluid in the units of the rock's pressures at the fractures.
      associate (scale => condensed%factors%scale)
         allocate (col_scale(n_bulk + slopes%n), source=minval(scale(n_bulk + 3 :: 3)))
         col_scale(:n_bulk) = scale(:n_bulk)
         col_scale(n_bulk + slopes%x_of_q) = scale(n_bulk + 1:n_bulk + size(slopes%x_of_q)) &
                                             /slopes%q_per_x
      end associate
      n = 0
      do k = 1, size(rock)
         call add(rock_row(k), rock_col(k), rock(k))
         if (rock_row(k) /= rock_col(k)) call add(rock_col(k), rock_row(k), rock(k))
      end do
      ! C'Q, for unknowns as they are: values so far are those of scaled ones.
      do q = 1, size(slopes%x_of_q)
         do k = condensed%coupling%first(q), condensed%coupling%first(q + 1) - 1
            at = condensed%coupling%col(k)
            if (at > n_bulk) cycle
            associate (unknown => n_bulk + slopes%x_of_q(q))
               call add(at, unknown, condensed%coupling%value(k)*slopes%q_per_x(q)*col_scale(at) &
                        *col_scale(unknown))
            end associate
         end do
      end do

   contains

      subroutine add(i, j, value)
         integer(ik), intent(in) :: i, j
         real(rk), intent(in) :: value

         n = n + 1
         row(n) = i
         col(n) = j
         values(n) = value
      end subroutine add

   end subroutine assemble_rock

   !> The equations of the fractures as triplets.
   subroutine assemble_rows(condensed, slopes, col_scale, row_scale, row_factor, row, col, values)
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: col_scale(:)
      real(rk), allocatable, intent(out) :: row_scale(:), row_factor(:)
      integer(ik), allocatable, intent(out) :: row(:), col(:)
      real(rk), allocatable, intent(out) :: values(:)
      integer(ik) :: k, m, n, n_bulk

      n_bulk = condensed%coupling%n_bulk
      associate (force => pack(slopes%force, slopes%force > 0), first => condensed%coupling%first)
         n = slopes%n_local + sum(first(force + 1) - first(force) + 1)
      end associate
      allocate (row(n), col(n), values(n), row_scale(slopes%n), row_factor(slopes%n))
      n = 0
      do k = 1, slopes%n_local
         call add(slopes%row(k), n_bulk + slopes%col(k), slopes%value(k))
      end do
      do k = 1, slopes%n
         do m = 1, size(slopes%force, 1)
            if (slopes%force(m, k) > 0) call add_force(k, slopes%force(m, k), slopes%weight(m, k))
         end do
      end do
      call scale_rows(row - n_bulk, col - n_bulk, col_scale(n_bulk + 1:), values, row_scale, &
                      row_factor)

   contains

      subroutine add(i, j, value)
         integer(ik), intent(in) :: i, j
         real(rk), intent(in) :: value

         n = n + 1
         row(n) = n_bulk + i
         col(n) = j
         values(n) = value*col_scale(j)
      end subroutine add

      !> Add a force, as the sum over the surrounding cells.
      subroutine add_force(i, force, weight)
         integer(ik), intent(in) :: i, force
         real(rk), intent(in) :: weight
         integer(ik) :: entry, j

         associate (coupling => condensed%coupling, x_of_q => slopes%x_of_q, &
                    q_per_x => slopes%q_per_x)
            do entry = coupling%first(force), coupling%first(force + 1) - 1
               j = coupling%col(entry)
               if (j <= n_bulk) then
                  call add(i, j, weight*coupling%value(entry))
               else
                  j = j - n_bulk
                  call add(i, n_bulk + x_of_q(j), weight*coupling%value(entry)*q_per_x(j))
               end if
            end do
            call add(i, n_bulk + x_of_q(force), weight*condensed%spring(force)*q_per_x(force))
         end associate
      end subroutine add_force

   end subroutine assemble_rows

   !> Scale equations to a largest coefficient of one.
   pure subroutine scale_rows(row, col, col_scale, values, row_scale, row_factor)
      integer(ik), intent(in) :: row(:), col(:)  !< among those of the fractures; cells: below one
      real(rk), intent(in) :: col_scale(:)  !< of the fractures' unknowns
      real(rk), intent(inout) :: values(:)
      real(rk), intent(out) :: row_scale(:)  !< largest coefficient by such an unknown, unscaled
      real(rk), intent(out) :: row_factor(:)  !< factors of the equations
      integer(ik) :: k

      row_scale = 0.0_rk
      row_factor = 0.0_rk
      do k = 1, size(row)
         associate (scale => row_scale(row(k)), largest => row_factor(row(k)))
            largest = max(largest, abs(values(k)))
            if (col(k) > 0) scale = max(scale, abs(values(k))/col_scale(col(k)))
         end associate
      end do
      where (row_scale > 0.0_rk)
         row_factor = 1.0_rk/row_factor
      else where
         row_scale = 1.0_rk
         row_factor = 1.0_rk
      end where
      values = values*row_factor(row)
   end subroutine scale_rows

end module coarse_sparse_matrix
