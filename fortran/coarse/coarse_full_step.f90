!> The linear step of the fractures' equations where the body is condensed onto them as a full
!! matrix.
!!
!! The jumps of ends whose equations hold no force (coarse_slopes) are left out of that matrix
!! (contact_ties).
module coarse_full_step
   use base_kinds, only: ik, rk
   use coarse_slopes, only: slopes_t
   use contact_newton, only: step_quality_t
   use contact_ties, only: new_ties, ties_t
   implicit none(type, external)
   private

   public :: find_full_step, full_slopes

contains

   !> Solve for the step. The condition is that of the equations which are left.
   subroutine find_full_step(stiffness, slopes, jumps, x_of_q, q_per_x, is_flow, residual, &
                             with_condition, step, quality)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: jumps(:)  !< the numbers of [u]_n in x; [u]_tau follows each
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      logical, intent(in) :: is_flow(:)  !< (n) unknowns whose errors the condition leaves out
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      type(ties_t) :: ties
      integer(ik), allocatable :: kept(:), local(:), first(:)
      real(rk), allocatable :: matrix(:, :), rest(:)
      real(rk) :: row(size(step))
      integer(ik) :: k

      call slopes%by_row(first, local)
      ties = found_ties(slopes, first, local, jumps, residual)
      kept = ties%kept()
      allocate (matrix(size(kept), size(kept)), rest(size(kept)))
      do k = 1, size(kept, kind=ik)
         call fill_row(stiffness, slopes, first, local, x_of_q, q_per_x, kept(k), row)
         rest(k) = residual(kept(k))
         call ties%reduce(row, rest(k))
         matrix(:, k) = row(kept)
      end do
      call ties%find_step(matrix, rest, with_condition, step, quality, left_out=is_flow)
   end subroutine find_full_step

   !> Ends whose equations hold their own jumps alone.
   pure function found_ties(slopes, first, local, jumps, residual) result(ties)
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: first(:), local(:)  !< entries of each row
      integer(ik), intent(in) :: jumps(:)  !< the numbers of [u]_n in x
      real(rk), intent(in) :: residual(:)  !< [Pa]
      type(ties_t) :: ties
      real(rk) :: own(2, 2)
      integer(ik) :: at, i
      logical :: is_own(2)

      ties = new_ties(slopes%n)
      do i = 1, size(jumps, kind=ik)
         at = jumps(i)
         call look_at(at, own(1, :), is_own(1))
         call look_at(at + 1, own(2, :), is_own(2))
         call ties%tie(at, own, is_own, residual(at:at + 1))
      end do

   contains

      !> The derivatives of an equation by both jumps of its end, if there are no others.
      pure subroutine look_at(row, by_jump, has_no_other)
         integer(ik), intent(in) :: row
         real(rk), intent(out) :: by_jump(2)
         logical, intent(out) :: has_no_other
         integer(ik) :: k

         by_jump = 0.0_rk
         has_no_other = .not. any(abs(slopes%weight(:, row)) > 0.0_rk)
         if (.not. has_no_other) return
         do k = first(row), first(row + 1) - 1
            associate (col => slopes%col(local(k)), value => slopes%value(local(k)))
               if (col == at .or. col == at + 1) then
                  by_jump(col - at + 1) = by_jump(col - at + 1) + value
               else
                  has_no_other = has_no_other .and. .not. abs(value) > 0.0_rk
               end if
            end associate
         end do
      end subroutine look_at

   end function found_ties

   !> All derivatives of an equation.
   pure subroutine fill_row(stiffness, slopes, first, local, x_of_q, q_per_x, row, derivatives)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: first(:), local(:)  !< entries of each row
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      integer(ik), intent(in) :: row
      real(rk), intent(out) :: derivatives(:)  !< [-]
      integer(ik) :: k, m

      derivatives = 0.0_rk
      do m = 1, size(slopes%force, 1)
         if (slopes%force(m, row) == 0 .or. .not. abs(slopes%weight(m, row)) > 0.0_rk) cycle
         derivatives(x_of_q) = derivatives(x_of_q) + slopes%weight(m, row)*q_per_x &
                               *stiffness(:, slopes%force(m, row))
      end do
      do k = first(row), first(row + 1) - 1
         associate (entry => derivatives(slopes%col(local(k))))
            entry = entry + slopes%value(local(k))
         end associate
      end do
   end subroutine fill_row

   !> All derivatives as a full matrix.
   pure subroutine full_slopes(stiffness, slopes, x_of_q, q_per_x, jacobian)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      real(rk), allocatable, intent(out) :: jacobian(:, :)  !< (n, n) an equation per column [-]
      integer(ik), allocatable :: first(:), local(:)
      integer(ik) :: row

      call slopes%by_row(first, local)
      allocate (jacobian(slopes%n, slopes%n))
      do row = 1, slopes%n
         call fill_row(stiffness, slopes, first, local, x_of_q, q_per_x, row, jacobian(:, row))
      end do
   end subroutine full_slopes

end module coarse_full_step
