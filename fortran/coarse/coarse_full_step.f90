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
   use algebra_blocks, only: is_in_team
   use algebra_links, only: equations_together, links_t, new_links
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_slopes, only: slopes_t
   use coarse_stiffness, only: stiffness_t
   use contact_dense, only: factorize_full, solve_factorized
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: find_full_step, full_slopes, kinds_t, reduced_t

   !> Numbers of unknowns that may be linked, which are those of their equations too.
   type :: kinds_t
      integer(ik), allocatable :: jump(:)  !< [u]_n of each point; [u]_tau follows it
      integer(ik), allocatable :: face(:)  !< pressures of the rock at the faces
      integer(ik), allocatable :: fluid(:)  !< pressures in the cells
      !> Flows along fractures, and the pressure at one end of each. That at the other end is not
      !! among those of the flows before it.
      integer(ik), allocatable :: flow(:), end_of_flow(:)
      logical, allocatable :: is_flow(:)  !< (n) their errors are left out of the condition
      integer(ik) :: many = 1000  !< unknowns from which faces are linked
   end type kinds_t

   !> Equations that remain after elimination of the links.
   type :: reduced_t
      private
      logical :: is_known = .false.  !< factors of an earlier iteration
      integer(ik) :: of = 0  !< factorization of the rock that they belong to
      real(rk) :: step(2) = 0.0_rk  !< start and length of the time step that they belong to [s]
      real(rk), allocatable :: weight(:, :)  !< of the forces in their equations
      real(rk) :: condition = 0.0_rk  !< of their matrix [-]
      type(links_t) :: links
      integer(ik) :: n_faces = 0  !< so many links, the first, are not exact
      integer(ik), allocatable :: equations(:), unknowns(:)  !< their numbers among all
      real(rk), allocatable :: rest(:)  !< their residuals [Pa]
      real(rk), allocatable :: factors(:, :), scale(:)  !< as of factorize_full
      integer(ik), allocatable :: pivots(:)
   contains
      procedure :: keep_for
   end type reduced_t

   !> Largest share of a face's pressure due to its own volume, for which it is linked [-].
   real(rk), parameter :: little = 1.0e-4_rk

   integer(ik), parameter :: rounds_max = 6  !< of improvement
   integer(ik), parameter :: most_directions = 10  !< with earlier factors; then new ones cost less
   !> Residuals that remain with earlier factors, over those before the step, and their bounds over
   !! the stress scale [-].
   real(rk), parameter :: reduction = 1.0e-8_rk, most = 1.0e-11_rk, least = 1.0e-13_rk
   !> Largest forward error by these residuals; with larger conditions factors are not used again
   !! [-].
   real(rk), parameter :: forward = 1.0e-5_rk
   real(rk), parameter :: well = 16.0_rk*epsilon(1.0_rk)  !< fulfilled: residual over unknowns [-]

contains

   !> Solve for the step, with earlier factors if possible. The condition is that of the remaining
   !! equations. Faces are linked if there are many unknowns and the step can be improved until it
   !! satisfies all equations.
   subroutine find_full_step(stiffness, slopes, kinds, residual, stress_scale, with_condition, &
                             reduced, step, quality)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(inout) :: slopes  !< numbered by row afterwards
      type(kinds_t), intent(in) :: kinds
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      real(rk), intent(in) :: stress_scale  !< [Pa]
      logical, intent(in) :: with_condition
      type(reduced_t), intent(inout) :: reduced  !< of an earlier iteration; those used afterwards
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      real(rk) :: worst
      logical :: is_good, with_faces

      if (is_like(reduced, slopes)) then
         call reduce_residual(stiffness, slopes, residual, stress_scale, reduced, step, quality, &
                              is_good)
         if (is_good) return
      end if
      call slopes%by_row()
      with_faces = slopes%n >= kinds%many
      do
         call reduce(stiffness, slopes, kinds, with_faces, residual, with_condition, reduced, &
                     quality)
         if (quality%is_singular) return
         reduced%is_known = .true.
         reduced%condition = quality%condition
         reduced%weight = slopes%weight
         call solve_reduced(reduced, step)
         if (reduced%n_faces == 0) return
         call improve(stiffness, slopes, residual, reduced, step, worst, is_good)
         quality%rest = worst/stress_scale
         if (is_good) return
         with_faces = .false.
      end do
   end subroutine find_full_step

   !> Forget the factors unless they belong to this factorization of the rock and this time step: a
   !! step is to depend on nothing but the state at its start.
   pure subroutine keep_for(self, of, time, dt)
      class(reduced_t), intent(inout) :: self
      integer(ik), intent(in) :: of
      real(rk), intent(in) :: time, dt  !< start and length of the step [s]

      self%is_known = self%is_known .and. self%of == of .and. &
                      .not. any(abs(self%step - [time, dt]) > 0.0_rk)
      self%of = of
      self%step = [time, dt]
   end subroutine keep_for

   !> Whether factors are known of equations in which few points are in another state.
   pure logical function is_like(self, slopes)
      type(reduced_t), intent(in) :: self
      type(slopes_t), intent(in) :: slopes
      real(rk), parameter :: share = 0.5_rk  ! of a weight: no change of contact is less
      integer(ik), parameter :: most_changes = 12

      is_like = self%is_known .and. self%condition*least <= forward
      if (is_like) is_like = size(self%weight, 2) == slopes%n
      if (is_like) is_like = count(abs(slopes%weight - self%weight) &
                                  > share*max(abs(slopes%weight), abs(self%weight))) <= most_changes
   end function is_like

   !> Factorize the equations that remain after elimination of the links.
   subroutine reduce(stiffness, slopes, kinds, with_faces, residual, with_condition, reduced, &
                     quality)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      type(kinds_t), intent(in) :: kinds
      logical, intent(in) :: with_faces  !< whose links are not exact
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      logical, intent(in) :: with_condition
      type(reduced_t), intent(inout) :: reduced
      type(step_quality_t), intent(out) :: quality
      integer(ik) :: n

      reduced%is_known = .false.
      associate (links => reduced%links)
         call find_links(stiffness, slopes, kinds, with_faces, links, reduced%n_faces)
         call links%take_residual(residual)
         reduced%equations = links%kept_equations()
         reduced%unknowns = links%kept_unknowns()
         n = size(reduced%unknowns, kind=ik)
         if (allocated(reduced%factors)) deallocate (reduced%factors, reduced%scale, reduced%pivots)
         allocate (reduced%factors(n, n), reduced%scale(n), reduced%pivots(n))
         reduced%rest = residual(reduced%equations)
      end associate
      call reduce_blocks(stiffness, slopes, reduced)
      call factorize_full(reduced%factors, with_condition, reduced%scale, reduced%pivots, quality, &
                          kinds%is_flow(reduced%unknowns))
   end subroutine reduce

   !> Eliminate the links from the remaining equations.
   recursive subroutine reduce_blocks(stiffness, slopes, reduced)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      type(reduced_t), intent(inout) :: reduced
      real(rk), allocatable :: rows(:, :)
      logical :: counts(slopes%n)
      integer(ik) :: first, last, n

      if (.not. is_in_team()) then
         !$omp parallel
         !$omp single
         call reduce_blocks(stiffness, slopes, reduced)
         !$omp end single
         !$omp end parallel
         return
      end if
      counts = reduced%links%that_count()
      n = size(reduced%unknowns, kind=ik)
      !$omp taskloop grainsize(1) default(shared) private(last, rows)
      do first = 1, n, equations_together
         last = min(n, first + equations_together - 1)
         allocate (rows(last - first + 1, slopes%n))
         call fill_rows(stiffness, slopes, reduced%equations(first:last), counts, rows)
         call reduced%links%reduce(rows, reduced%rest(first:last))
         reduced%factors(:, first:last) = transpose(rows(:, reduced%unknowns))
         deallocate (rows)
      end do
      !$omp end taskloop
   end subroutine reduce_blocks

   !> The step from the remaining equations and the links.
   subroutine solve_reduced(reduced, step)
      type(reduced_t), intent(in) :: reduced
      real(rk), intent(inout) :: step(:)  !< (n) [Pa]
      real(rk) :: solution(size(reduced%unknowns))

      call solve_factorized(reduced%factors, reduced%scale, reduced%pivots, reduced%rest, solution)
      step(reduced%unknowns) = solution
      call reduced%links%complete(step)
   end subroutine solve_reduced

   !> Improve a step with approximate links until it satisfies the complete equations.
   subroutine improve(stiffness, slopes, residual, reduced, step, worst, is_good)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: residual(:)  !< (n) before the step [Pa]
      type(reduced_t), intent(inout) :: reduced
      real(rk), intent(inout) :: step(:)  !< (n) [Pa]
      real(rk), intent(out) :: worst  !< largest residual of these links [Pa]
      logical, intent(out) :: is_good
      real(rk) :: change(size(step)), left(size(step)), worst_before
      integer(ik) :: k

      worst_before = huge(1.0_rk)
      do k = 1, rounds_max
         left = residual + product_of(stiffness, slopes, step)
         worst = maxval(abs(left(reduced%links%unknown(:reduced%n_faces))))
         is_good = worst <= well*maxval(abs(step))
         if (is_good .or. .not. worst < 0.5_rk*worst_before) exit
         worst_before = worst
         call precondition(stiffness, slopes, left, reduced, change)
         step = step + change
      end do
   end subroutine improve

   !> Conjugate residuals (Eisenstat, Elman and Schultz 1983; equivalent to GMRES) with earlier
   !! factors.
   subroutine reduce_residual(stiffness, slopes, residual, stress_scale, reduced, step, quality, &
                              is_done)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: residual(:)  !< (n) before the step [Pa]
      real(rk), intent(in) :: stress_scale  !< [Pa]
      type(reduced_t), intent(inout) :: reduced
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(inout) :: quality
      logical, intent(out) :: is_done
      real(rk), allocatable :: direction(:, :), product(:, :)  ! too large for a stack
      real(rk) :: enough, left(size(step)), share
      integer(ik) :: j, k, pass

      allocate (direction(size(step), most_directions), product(size(step), most_directions))
      enough = max(min(reduction*maxval(abs(residual)), most*stress_scale, &
                       forward/max(reduced%condition, 1.0_rk)*stress_scale), least*stress_scale)
      step = 0.0_rk
      left = residual
      do k = 1, most_directions
         associate (p => direction(:, k), q => product(:, k))
            call precondition(stiffness, slopes, left, reduced, p)
            q = product_of(stiffness, slopes, p)
            do pass = 1, 2  ! twice because of rounding
               do j = 1, k - 1
                  share = dot_product(product(:, j), q)
                  q = q - share*product(:, j)
                  p = p - share*direction(:, j)
               end do
            end do
            share = norm2(q)
            is_done = .false.
            if (.not. share > 0.0_rk) return
            p = p/share
            q = q/share
            share = dot_product(q, left)
            step = step - share*p
            left = left - share*q
         end associate
         is_done = maxval(abs(left)) <= enough
         if (is_done) exit
      end do
      if (.not. is_done) return
      left = residual + product_of(stiffness, slopes, step)  ! as rounding leaves it
      is_done = maxval(abs(left)) <= max(2.0_rk*enough, well*maxval(abs(step)))
      quality%condition = reduced%condition
      quality%rest = maxval(abs(left))/stress_scale
   end subroutine reduce_residual

   !> The step that the factors give for a residual: exact if they are those of the present
   !! equations, and all links are exact.
   subroutine precondition(stiffness, slopes, residual, reduced, step)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      type(reduced_t), intent(inout) :: reduced
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      real(rk) :: by_links(size(step)), left(size(step))

      call reduced%links%take_residual(residual)
      by_links = 0.0_rk
      call reduced%links%complete(by_links)
      left = residual + product_of(stiffness, slopes, by_links)
      reduced%rest = left(reduced%equations)
      reduced%links%rest(:reduced%links%n) = 0.0_rk
      step = 0.0_rk
      call solve_reduced(reduced, step)
      step = step + by_links
   end subroutine precondition

   !> What all equations make of a step.
   function product_of(stiffness, slopes, x) result(answer)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: x(:)  !< (n) [Pa]
      real(rk) :: answer(size(x))  !< [Pa]

      call slopes%apply(x, stiffness%product(x(slopes%x_of_q)*slopes%q_per_x), answer)
   end function product_of

   !> Find the links: faces first, then, exactly, pressures of the fluid, then jumps.
   subroutine find_links(stiffness, slopes, kinds, with_faces, links, n_faces)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
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
            associate (face => kinds%face(i))
               if (is_little(stiffness, slopes, face)) then
                  call link_by(slopes, face, face, entry, links)
               end if
            end associate
         end do
      end if
      n_faces = links%n
      do i = 1, size(kinds%fluid, kind=ik)
         associate (fluid => kinds%fluid(i))
            if (.not. slopes%has_forces(fluid)) call link_by(slopes, fluid, fluid, entry, links)
         end associate
      end do
      do i = 1, size(kinds%flow, kind=ik)
         associate (flow => kinds%flow(i), end => kinds%end_of_flow(i))
            if (links%is_linked(end)) cycle
            if (.not. slopes%has_forces(flow)) call link_by(slopes, flow, end, entry, links)
         end associate
      end do
      do i = 1, size(kinds%jump, kind=ik)
         associate (at => kinds%jump(i))
            call find_by_jump(slopes, at, at, own(1, :), is_own(1))
            call find_by_jump(slopes, at + 1, at, own(2, :), is_own(2))
            call links%link_pair(at, own, is_own)
         end associate
      end do
   end subroutine find_links

   !> Whether the volume that leaves through a face is negligible in the equation of its pressure.
   pure logical function is_little(stiffness, slopes, face)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: face
      real(rk) :: by_itself
      integer(ik) :: k

      is_little = .false.
      if (slopes%force(1, face) == 0 .or. slopes%force(2, face) /= 0) return
      by_itself = 0.0_rk
      do k = slopes%first(face), slopes%first(face + 1) - 1
         associate (at => slopes%local(k))
            if (slopes%col(at) == face) by_itself = by_itself + slopes%value(at)
         end associate
      end do
      associate (force => slopes%force(1, face))
         is_little = abs(slopes%weight(1, face)*stiffness%diagonal(force)) < little*abs(by_itself)
      end associate
   end function is_little

   !> Link an unknown by the local part of an equation, if its entry there is the largest and the
   !! others are not linked.
   subroutine link_by(slopes, equation, unknown, entry, links)
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: equation, unknown
      real(rk), intent(inout) :: entry(:)  !< (n) zero before and after [-]
      type(links_t), intent(inout) :: links
      integer(ik), allocatable :: partner(:)
      integer(ik) :: k, n

      allocate (partner(slopes%first(equation + 1) - slopes%first(equation)))
      n = 0
      do k = slopes%first(equation), slopes%first(equation + 1) - 1
         associate (col => slopes%col(slopes%local(k)), &
                    value => slopes%value(slopes%local(k)))
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
   pure subroutine find_by_jump(slopes, row, at, by_jump, has_no_other)
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: row, at
      real(rk), intent(out) :: by_jump(2)
      logical, intent(out) :: has_no_other
      integer(ik) :: k

      by_jump = 0.0_rk
      has_no_other = .not. slopes%has_forces(row)
      if (.not. has_no_other) return
      do k = slopes%first(row), slopes%first(row + 1) - 1
         associate (col => slopes%col(slopes%local(k)), &
                    value => slopes%value(slopes%local(k)))
            if (col == at .or. col == at + 1) then
               by_jump(col - at + 1) = by_jump(col - at + 1) + value
            else
               has_no_other = has_no_other .and. .not. abs(value) > 0.0_rk
            end if
         end associate
      end do
   end subroutine find_by_jump

   !> All derivatives of equations by the unknowns that count; 0 by the others.
   pure subroutine fill_rows(stiffness, slopes, equations, counts, rows)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: equations(:)
      logical, intent(in) :: counts(:)  !< (n)
      real(rk), intent(out) :: rows(:, :)  !< (equations, n) [-]
      integer(ik) :: force(size(equations), size(slopes%force, 1)), k, m, q  ! rows of S
      real(rk) :: weight(size(equations), size(slopes%force, 1))

      rows = 0.0_rk
      force = transpose(slopes%force(:, equations))
      weight = transpose(slopes%weight(:, equations))
      do m = 1, size(force, 2)
         where (force(:, m) > 0) force(:, m) = stiffness%place(max(force(:, m), 1_ik))
      end do
      where (force == 0)
         force = 1  ! any, without weight
         weight = 0.0_rk
      end where
      do q = 1, size(stiffness%kept, kind=ik)
         associate (x => slopes%x_of_q(stiffness%kept(q)), &
                    factor => slopes%q_per_x(stiffness%kept(q)))
            if (.not. counts(x)) cycle
            do m = 1, size(force, 2)
               do k = 1, size(force, 1)
                  rows(k, x) = rows(k, x) + weight(k, m)*factor*stiffness%entry(q, force(k, m))
               end do
            end do
         end associate
      end do
      do k = 1, size(equations, kind=ik)
         do m = slopes%first(equations(k)), slopes%first(equations(k) + 1) - 1
            associate (entry => rows(k, slopes%col(slopes%local(m))))
               entry = entry + slopes%value(slopes%local(m))
            end associate
         end do
      end do
   end subroutine fill_rows

   !> All derivatives as a full matrix.
   pure subroutine full_slopes(stiffness, slopes, jacobian)
      type(stiffness_t), intent(in) :: stiffness
      type(slopes_t), intent(inout) :: slopes  !< numbered by row afterwards
      real(rk), allocatable, intent(out) :: jacobian(:, :)  !< (n, n) an equation per column [-]
      integer(ik) :: i

      call slopes%by_row()
      allocate (jacobian(slopes%n, slopes%n))
      call fill_rows(stiffness, slopes, [(i, i=1, slopes%n)], spread(.true., 1, slopes%n), jacobian)
      jacobian = transpose(jacobian)
   end subroutine full_slopes

end module coarse_full_step
