!> The linear step of the fractures' equations where the body is condensed onto them as a full
!! matrix.
!!
!! As many unknowns as possible are eliminated from that matrix first (algebra_links), so that it is
!! small even for many fracture cells. All but one kind of links are exact. The pressure of a face
!! differs from that of the fluid by the resistance of the fracture to the volume that leaves
!! through the face. This volume depends on all unknowns, and the difference is negligible where the
!! rock conducts far less. It is omitted from the links, and the step is improved until it satisfies
!! the complete equations.
module coarse_full_step
   use algebra_links, only: links_t, new_links
   use base_kinds, only: ik, rk
   use coarse_slopes, only: slopes_t
   use coarse_sparse_matrix, only: apply_rows
   use contact_dense, only: factorize_full, solve_factorized
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: find_full_step, full_slopes, kinds_t

   !> Numbers of unknowns that may be linked, which are those of their equations too.
   type :: kinds_t
      integer(ik), allocatable :: jump(:)  !< [u]_n of each point; [u]_tau follows it
      integer(ik), allocatable :: face(:)  !< pressures of the rock at the faces
      integer(ik), allocatable :: fluid(:)  !< pressures in the cells
      !> Flows along fractures, and the pressure at one end of each. That at the other end is not
      !! among those of the flows before it.
      integer(ik), allocatable :: flow(:), end_of_flow(:)
   end type kinds_t

   !> So much of a face's pressure may come from its own volume if it is to be linked [-].
   real(rk), parameter :: little = 1.0e-4_rk

   integer(ik), parameter :: many = 1000  !< unknowns: elimination of fewer costs milliseconds
   integer(ik), parameter :: rounds_max = 6  !< of improvement
   real(rk), parameter :: well = 16.0_rk*epsilon(1.0_rk)  !< fulfilled: residual over unknowns [-]

contains

   !> Solve for the step. The condition is that of the equations which are left.
   subroutine find_full_step(stiffness, slopes, kinds, x_of_q, q_per_x, is_flow, residual, &
                             stress_scale, with_condition, step, quality, links_faces)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      type(kinds_t), intent(in) :: kinds
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      logical, intent(in) :: is_flow(:)  !< (n) unknowns whose errors the condition leaves out
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      real(rk), intent(in) :: stress_scale  !< [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      !> Faces may be linked; default: where there are many unknowns, and it saves much
      logical, intent(in), optional :: links_faces
      integer(ik), allocatable :: local(:), first(:)
      logical :: is_good

      call slopes%by_row(first, local)
      is_good = slopes%n >= many
      if (present(links_faces)) is_good = links_faces
      if (is_good) then
         call try_step(with_faces=.true.)
         if (is_good .or. quality%is_singular) return
      end if
      call try_step(with_faces=.false.)

   contains

      subroutine try_step(with_faces)
         logical, intent(in) :: with_faces
         type(links_t) :: links
         integer(ik), allocatable :: equations(:), pivots(:), unknowns(:)
         real(rk), allocatable :: matrix(:, :), rest(:), scale(:), solution(:)
         real(rk) :: answer(size(step)), left(size(step)), row(size(step)), worst, worst_before
         integer(ik) :: k, n, n_faces

         call find_links(stiffness, slopes, first, local, kinds, with_faces, links, n_faces)
         call links%take_residual(residual)
         equations = links%kept_equations()
         unknowns = links%kept_unknowns()
         n = size(unknowns, kind=ik)
         allocate (matrix(n, n), rest(n), scale(n), solution(n), pivots(n))
         do k = 1, n
            call fill_row(stiffness, slopes, first, local, x_of_q, q_per_x, equations(k), row)
            rest(k) = residual(equations(k))
            call links%reduce(row, rest(k))
            matrix(:, k) = row(unknowns)
         end do
         call factorize_full(matrix, with_condition, scale, pivots, quality, is_flow(unknowns))
         is_good = .not. quality%is_singular
         if (quality%is_singular) return
         call solve_factorized(matrix, scale, pivots, rest, solution)
         step(unknowns) = solution
         call links%complete(step)
         if (n_faces == 0) return
         worst_before = huge(1.0_rk)
         do k = 1, rounds_max
            call multiply(step, answer)
            left = residual + answer
            worst = maxval(abs(left(links%unknown(:n_faces))))
            is_good = worst <= well*maxval(abs(step))
            if (is_good .or. .not. worst < 0.5_rk*worst_before) exit
            worst_before = worst
            call links%take_residual(left)
            answer = 0.0_rk
            call links%complete(answer)
            step = step + answer
            call multiply(answer, row)
            rest = left(equations) + row(equations)
            call solve_factorized(matrix, scale, pivots, rest, solution)
            answer(unknowns) = solution
            links%rest(:links%n) = 0.0_rk
            call links%complete(answer)
            step = step + answer
         end do
         quality%rest = worst/stress_scale
      end subroutine try_step

      !> What all equations make of a step.
      subroutine multiply(x, answer)
         real(rk), intent(in) :: x(:)  !< [Pa]
         real(rk), intent(out) :: answer(:)  !< [Pa]

         call apply_rows(slopes, x, matmul(stiffness, x(x_of_q)*q_per_x), answer)
      end subroutine multiply

   end subroutine find_full_step

   !> What can be linked: faces, the first of all, then exactly pressures of fluid, then jumps.
   subroutine find_links(stiffness, slopes, first, local, kinds, with_faces, links, n_faces)
      real(rk), intent(in) :: stiffness(:, :)  !< [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: first(:), local(:)  !< entries of each row
      type(kinds_t), intent(in) :: kinds
      logical, intent(in) :: with_faces  !< whose links are not exact
      type(links_t), intent(out) :: links
      integer(ik), intent(out) :: n_faces  !< so many links are not
      real(rk) :: entry(slopes%n), own(2, 2)
      integer(ik) :: i
      logical :: is_own(2)

      links = new_links(slopes%n)
      entry = 0.0_rk
      if (with_faces) then
         do i = 1, size(kinds%face, kind=ik)
            if (is_little(kinds%face(i))) call link_by(kinds%face(i), kinds%face(i))
         end do
      end if
      n_faces = links%n
      do i = 1, size(kinds%fluid, kind=ik)
         if (.not. has_forces(kinds%fluid(i))) call link_by(kinds%fluid(i), kinds%fluid(i))
      end do
      do i = 1, size(kinds%flow, kind=ik)
         if (links%is_linked(kinds%end_of_flow(i))) cycle
         if (.not. has_forces(kinds%flow(i))) call link_by(kinds%flow(i), kinds%end_of_flow(i))
      end do
      do i = 1, size(kinds%jump, kind=ik)
         associate (at => kinds%jump(i))
            call look_at(at, at, own(1, :), is_own(1))
            call look_at(at + 1, at, own(2, :), is_own(2))
            call links%link_pair(at, own, is_own)
         end associate
      end do

   contains

      !> The volume that leaves through a face has next to no part in the equation of its pressure.
      pure logical function is_little(face)
         integer(ik), intent(in) :: face
         real(rk) :: by_itself
         integer(ik) :: k

         is_little = .false.
         if (slopes%force(1, face) == 0 .or. slopes%force(2, face) /= 0) return
         by_itself = 0.0_rk
         do k = first(face), first(face + 1) - 1
            if (slopes%col(local(k)) == face) by_itself = by_itself + slopes%value(local(k))
         end do
         associate (force => slopes%force(1, face))
            is_little = abs(slopes%weight(1, face)*stiffness(force, force)) < little*abs(by_itself)
         end associate
      end function is_little

      pure logical function has_forces(row)
         integer(ik), intent(in) :: row

         has_forces = any(abs(slopes%weight(:, row)) > 0.0_rk)
      end function has_forces

      !> Link an unknown by the local part of an equation, if it has the largest entry there, and
      !! the others have not left.
      subroutine link_by(equation, unknown)
         integer(ik), intent(in) :: equation, unknown
         integer(ik), allocatable :: partner(:)
         integer(ik) :: k, n

         allocate (partner(first(equation + 1) - first(equation)))
         n = 0
         do k = first(equation), first(equation + 1) - 1
            associate (col => slopes%col(local(k)), value => slopes%value(local(k)))
               if (.not. abs(value) > 0.0_rk) cycle
               if (col /= unknown .and. all(partner(:n) /= col)) then
                  n = n + 1
                  partner(n) = col
               end if
               entry(col) = entry(col) + value
            end associate
         end do
         associate (pivot => entry(unknown), others => partner(:n))
            if (abs(pivot) > 0.0_rk .and. .not. any(abs(entry(others)) > abs(pivot)) .and. &
                .not. any(links%is_linked(others))) then
               call links%link(unknown, [equation, 0_ik], [-1.0_rk/pivot, 0.0_rk], others, &
                               -entry(others)/pivot)
            end if
         end associate
         entry(partner(:n)) = 0.0_rk
         entry(unknown) = 0.0_rk
      end subroutine link_by

      !> The derivatives of an equation by both jumps of its end, if there are no others.
      pure subroutine look_at(row, at, by_jump, has_no_other)
         integer(ik), intent(in) :: row, at
         real(rk), intent(out) :: by_jump(2)
         logical, intent(out) :: has_no_other
         integer(ik) :: k

         by_jump = 0.0_rk
         has_no_other = .not. has_forces(row)
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

   end subroutine find_links

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
