!> Contact and friction on the node pairs of a mesh: which pairs there are, what their history is,
!! and the solution by the iteration of contact_newton on the equations of contact_pairs.
!!
!! The nodal lengths L are the integrals of the shape functions over the faces (1/6, 4/6, 1/6 of a
!! cell, and 0, 2/3, 1/3 from the tip in a quarter-point element); they are positive wherever a pair
!! exists, so the sign of a force is that of the traction f.
!!
!! At a joint one link follows from the others (fine_joints). Its jump is C w, and its traction f_c
!! that of the middle of its cell, at the node m: S w - g = -L f - C' L_c f_c with f_c = -(S w -
!! g)_m/L_m. Rows of S and g combined accordingly leave the form above. Where such an end loads
!! unknowns that are no jumps of pairs, these stand behind w; combined, their rows have no f left,
!! and they are eliminated.
!!
!! What is kept of contact when the mesh changes.
module fine_contact
   use algebra_lapack, only: dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use base_plane, only: turned_left
   use base_tolerances, only: same_place
   use contact_law, only: contact_law_t, state_open
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, &
                             outcome_converged, outcome_not_a_number, outcome_singular
   use contact_pairs, only: contact_pairs_t
   use fine_element, only: line_parameter, line_resultants, line_shapes
   use fine_faces, only: constraints_t, face_conditions_t, face_contact
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: close_joints, contact_problem_t, contact_t, eliminate_loose, loose_unknowns
   public :: new_contact, set_contact_problem, show_closing, solve_contact, transfer_contact

   !> Contact on all faces, node by node as start, end, mid of each fracture cell; what several
   !! cells share has the same value in each of them. Zero and open where there is no contact.
   type :: contact_t
      !> (tau n, start end mid, fracture cell): the last solution, guess for the next [m]
      real(rk), allocatable :: jump(:, :, :)
      real(rk), allocatable :: slip_before(:, :)  !< (3, fracture cells) when last accepted [m]
      real(rk), allocatable :: slip_path(:, :)  !< (3, fracture cells) slipped so far [m]
      real(rk), allocatable :: opened(:, :)  !< (3, fracture cells) apart so far at most [m]
      real(rk), allocatable :: apart(:, :)  !< (3, fracture cells) in the last solution [m]
      real(rk), allocatable :: traction(:, :, :)  !< (tau n, start end mid, fracture cell) [Pa]
      integer(ik), allocatable :: state(:, :)  !< (start end mid, fracture cell) of contact_law
      integer(ik) :: iterations = 0  !< of the last solution
      logical :: was_restarted = .false.  !< by pivoting, as the iteration had cycled
      real(rk) :: residual = 0.0_rk  !< how far it is from the law, over the largest traction [-]
   contains
      procedure :: accept
   end type contact_t

   !> An end of a cell whose traction is that of the cell's middle.
   type :: closing_t
      integer(ik) :: cell = 0, end = 0  !< fracture cell and its end at the joint
      integer(ik) :: middle = 0  !< contact number of the middle of the cell
      real(rk) :: ratio = 0.0_rk  !< nodal length at the joint over that of the middle [-]
      real(rk), allocatable :: jump_of(:, :)  !< C (n tau, kept) its jump from all kept unknowns
   end type closing_t

   !> Unknowns that such ends load and that are no jumps of pairs, as functions of these.
   type :: loose_t
      integer(ik) :: n = 0
      real(rk), allocatable :: factors(:, :)  !< (n, n) of their own equations
      integer(ik), allocatable :: pivots(:)  !< (n)
      real(rk), allocatable :: by_jump(:, :)  !< (n, 2 pairs) what jumps take off them [-]
      real(rk), allocatable :: in_rows(:, :)  !< (n, 2 pairs) theirs in the pairs' equations [Pa]
   end type loose_t

   !> The pairs of a mesh.
   type, extends(contact_pairs_t) :: contact_problem_t
      type(closing_t), allocatable :: closing(:)
      type(loose_t) :: loose
      type(contact_law_t), allocatable :: fresh_law(:)  !< (n) of faces that have not slipped
      real(rk), allocatable :: share(:, :)  !< (3, fracture cells) of each cell in L [m]
      integer(ik), allocatable :: place(:, :)  !< (3, fracture cells) contact number, or 0
   end type contact_problem_t

contains

   !> Closed faces that have not slipped.
   pure function new_contact(fine) result(contact)
      type(fine_mesh_t), intent(in) :: fine
      type(contact_t) :: contact

      associate (n => fine%fracture%n_cells)
         allocate (contact%jump(2, 3, n), contact%traction(2, 3, n), source=0.0_rk)
         allocate (contact%slip_before(3, n), contact%slip_path(3, n), source=0.0_rk)
         allocate (contact%opened(3, n), contact%apart(3, n), source=0.0_rk)
         allocate (contact%state(3, n), source=state_open)
      end associate
   end function new_contact

   !> The last solution becomes the history of the next.
   pure subroutine accept(self)
      class(contact_t), intent(inout) :: self

      self%slip_path = self%slip_path + abs(self%jump(1, :, :) - self%slip_before)
      self%slip_before = self%jump(1, :, :)
      self%opened = max(self%opened, self%apart)
   end subroutine accept

   !> Nodal lengths and laws; `condensed` is left to the owner of the matrix. Where cells meet, the
   !! parameters are means weighted by their lengths; if some of them cannot part, of these alone.
   pure subroutine set_contact_problem(fine, conditions, constraints, young, problem)
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(in) :: constraints
      real(rk), intent(in) :: young  !< [Pa]
      type(contact_problem_t), intent(out) :: problem
      integer(ik), allocatable :: contact_of_pair(:)
      real(rk), allocatable :: weight(:)
      integer(ik) :: cell, i, k

      problem%n = size(constraints%contact_pairs)
      allocate (contact_of_pair(0:constraints%n_pairs), source=0_ik)
      do i = 1, problem%n
         contact_of_pair(constraints%contact_pairs(i)) = i
      end do
      allocate (problem%law(problem%n), problem%slip_given(problem%n))
      allocate (problem%length(problem%n), source=0.0_rk)
      allocate (problem%share(3, fine%fracture%n_cells), source=0.0_rk)
      allocate (problem%place(3, fine%fracture%n_cells), source=0_ik)
      problem%slip_given = .false.
      allocate (problem%load(2*problem%n), problem%residual(2*problem%n))
      allocate (problem%traction(2, problem%n))
      allocate (problem%slip_before(problem%n), problem%given(problem%n))
      allocate (problem%slip_sign(problem%n), problem%state(problem%n))
      do cell = 1, fine%fracture%n_cells
         if (conditions%condition(cell) /= face_contact) cycle
         problem%share(:, cell) = fine%face_length(cell)*line_resultants(fine%face_tip(cell))
         do k = 1, 3
            i = contact_of_pair(constraints%face_pair(k, cell))
            problem%place(k, cell) = i
            if (i == 0) cycle
            associate (given => conditions%law(cell))
               problem%length(i) = problem%length(i) + problem%share(k, cell)
               problem%law(i)%bilateral = problem%law(i)%bilateral .or. given%contact%bilateral
               problem%slip_given(i) = problem%slip_given(i) .or. given%slip_given
            end associate
         end do
      end do
      allocate (weight(problem%n), source=0.0_rk)
      do cell = 1, fine%fracture%n_cells
         do k = 1, 3
            i = problem%place(k, cell)
            if (i == 0) cycle
            associate (law => problem%law(i), given => conditions%law(cell)%contact)
               if (law%bilateral .and. .not. given%bilateral) cycle
               weight(i) = weight(i) + problem%share(k, cell)
               call law%add_share(given, problem%share(k, cell))
            end associate
         end do
      end do
      do i = 1, problem%n
         call problem%law(i)%divide(weight(i))
         if (.not. problem%slip_given(i)) cycle
         problem%law(i)%friction = 0.0_rk
         problem%law(i)%weakening = 0.0_rk
      end do
      problem%fresh_law = problem%law
      if (problem%n > 0) problem%stiffness = young*problem%n/sum(problem%length)
      call find_closing(fine, constraints, problem)
   end subroutine set_contact_problem

   !> The ends without a law, with their jumps as sums of unknowns.
   pure subroutine find_closing(fine, constraints, problem)
      type(fine_mesh_t), intent(in) :: fine
      type(constraints_t), intent(in) :: constraints
      type(contact_problem_t), intent(inout) :: problem
      real(rk) :: tau(2), axes(2, 2)
      integer(ik) :: column, i, j, node, side, row

      allocate (problem%closing(size(constraints%closing, 2)))
      problem%loose%n = size(constraints%kept_dofs, kind=ik) - 2*problem%n
      ! Rows of S that close_joints combines are not; eliminate_loose changes all of them.
      allocate (problem%is_symmetric(2*problem%n), source=problem%loose%n == 0)
      do i = 1, size(problem%closing)
         associate (link => problem%closing(i))
            link%cell = constraints%closing(1, i)
            link%end = constraints%closing(2, i)
            link%middle = problem%place(3, link%cell)
            link%ratio = problem%share(link%end, link%cell)/problem%length(link%middle)
            allocate (link%jump_of(2, size(constraints%kept_dofs)), source=0.0_rk)
            tau = fine%face_tangent(:, link%cell)
            axes = reshape([turned_left(tau), tau], [2, 2])
            do side = 1, 2
               node = fine%face_nodes(link%end, side, link%cell)
               do column = 1, constraints%n_columns(node)
                  ! The motion of the joint as a whole is no jump, and falls out of the difference.
                  row = findloc(constraints%kept_dofs, constraints%dof(column, node), dim=1)
                  if (row == 0) cycle
                  do j = 1, 2
                     link%jump_of(j, row) = link%jump_of(j, row) + (2*side - 3) &
                                            *dot_product(axes(:, j), &
                                                         constraints%basis(:, column, node))
                  end do
               end do
            end do
            where (any(abs(link%jump_of(:, :2*problem%n)) > 0.0_rk, dim=1))
               problem%is_symmetric = .false.
            end where
         end associate
      end do
   end subroutine find_closing

   !> Let the tractions of closing ends act: combine the rows of the condensed system or the load.
   pure subroutine close_joints(problem, rows)
      type(contact_problem_t), intent(in) :: problem
      !> (any, kept) an equation per column [Pa], or the load [N/m]
      real(rk), intent(inout) :: rows(:, :)
      integer(ik) :: i, row

      do i = 1, size(problem%closing)
         associate (link => problem%closing(i), middle => problem%closing(i)%middle)
            do row = 1, size(rows, 2, kind=ik)
               if (.not. any(abs(link%jump_of(:, row)) > 0.0_rk)) cycle
               rows(:, row) = rows(:, row) &
                              - link%ratio*(link%jump_of(1, row)*rows(:, 2*middle - 1) &
                                            + link%jump_of(2, row)*rows(:, 2*middle))
            end do
         end associate
      end do
   end subroutine close_joints

   !> Eliminate the unknowns that are no jumps of pairs from the condensed system.
   subroutine eliminate_loose(problem, is_singular)
      type(contact_problem_t), intent(inout) :: problem
      logical, intent(out) :: is_singular
      real(rk), allocatable :: rows(:, :)
      integer(ik) :: info

      is_singular = .false.
      if (problem%loose%n == 0) return
      call move_alloc(problem%condensed, rows)
      associate (loose => problem%loose, m => 2*problem%n)
         loose%factors = rows(m + 1:, m + 1:)
         loose%by_jump = transpose(rows(:m, m + 1:))
         loose%in_rows = rows(m + 1:, :m)
         allocate (loose%pivots(loose%n))
         call dgetrf(loose%n, loose%n, loose%factors, loose%n, loose%pivots, info)
         is_singular = info /= 0
         if (is_singular) return
         call dgetrs("T", loose%n, m, loose%factors, loose%n, loose%pivots, loose%by_jump, &
                     loose%n, info)
         problem%condensed = rows(:m, :m) - matmul(transpose(loose%by_jump), loose%in_rows)
      end associate
   end subroutine eliminate_loose

   !> The eliminated unknowns without jumps of pairs; `by_jump` takes off what jumps do to them.
   function loose_unknowns(loose, load) result(x)
      type(loose_t), intent(in) :: loose
      real(rk), intent(in) :: load(:)  !< (n) [N/m]
      real(rk), allocatable :: x(:)  !< (n) [m]
      real(rk) :: column(loose%n, 1)
      integer(ik) :: info

      column(:, 1) = load
      if (loose%n > 0) then
         call dgetrs("T", loose%n, 1_ik, loose%factors, loose%n, loose%pivots, column, loose%n, &
                     info)
      end if
      x = column(:, 1)
   end function loose_unknowns

   !> Jumps, tractions and states of the closing ends, from a solution.
   pure subroutine show_closing(fine, problem, displacement, contact)
      type(fine_mesh_t), intent(in) :: fine
      type(contact_problem_t), intent(in) :: problem
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(contact_t), intent(inout) :: contact
      integer(ik) :: i
      real(rk) :: jump(2), tau(2)

      do i = 1, size(problem%closing)
         associate (cell => problem%closing(i)%cell, end => problem%closing(i)%end)
            associate (nodes => fine%face_nodes(end, :, cell))
               jump = displacement(:, nodes(2)) - displacement(:, nodes(1))
            end associate
            tau = fine%face_tangent(:, cell)
            contact%jump(:, end, cell) = [dot_product(tau, jump), &
                                          dot_product(turned_left(tau), jump)]
            contact%traction(:, end, cell) = contact%traction(:, 3, cell)
            contact%state(end, cell) = contact%state(3, cell)
         end associate
      end do
   end subroutine show_closing

   !> Find the jumps that fulfil equilibrium and the law. A reason is given if that fails.
   subroutine solve_contact(problem, load, given_jump, contact, jump, reason, cell)
      type(contact_problem_t), intent(inout) :: problem
      real(rk), intent(in) :: load(:)  !< g (2 n) [N/m]
      real(rk), intent(in) :: given_jump(:, :, :)  !< (tau n, start end mid, fracture cell) [m]
      type(contact_t), intent(inout) :: contact  !< replaced only by a solution
      real(rk), intent(out) :: jump(:)  !< w (2 n) [m]
      character(len=:), allocatable, intent(out) :: reason
      integer(ik), intent(out) :: cell  !< fracture cell where it fails most; 0: none is known
      type(iteration_report_t) :: report
      real(rk) :: opened(problem%n), path(problem%n), x(2*problem%n)

      cell = 0
      call gather(problem, contact%jump(2, :, :), jump(1 :: 2))
      call gather(problem, contact%jump(1, :, :), jump(2 :: 2))
      call gather(problem, contact%slip_before, problem%slip_before)
      call gather(problem, contact%slip_path, path)
      call gather(problem, contact%opened, opened)
      problem%law = problem%fresh_law%aged(path, opened)
      call gather(problem, given_jump(1, :, :), problem%given)
      where (problem%slip_given)
         jump(2 :: 2) = problem%given
      else where
         problem%given = 0.0_rk
      end where
      problem%load = load
      problem%slip_sign = 0
      problem%spring = 0.0_rk
      problem%state = -1  ! none yet
      x = problem%stiffness*jump
      call iterate(problem, x, iteration_settings_t(), report)
      select case (report%outcome)
      case (outcome_converged)
         continue
      case (outcome_not_a_number)
         reason = "NaN in the contact iteration"
      case (outcome_singular)
         reason = "a part of the body that is held only by contact can move as a rigid body"
      case default
         reason = "contact with friction did not converge; usual causes are fractures that "// &
                  "nearly touch and friction above 1"
         cell = worst_cell(problem, x)
      end select
      if (allocated(reason)) return

      jump = x/problem%stiffness
      contact%iterations = report%iterations
      contact%was_restarted = report%was_restarted
      contact%residual = problem%law_residual(x)
      contact%jump = 0.0_rk
      contact%traction = 0.0_rk
      contact%state = state_open
      call scatter(problem, jump, problem%traction, problem%state, contact)
   end subroutine solve_contact

   !> The fracture cell of the pair whose equations are missed most at x; 0: none is known.
   integer(ik) function worst_cell(problem, x) result(worst)
      type(contact_problem_t), intent(inout) :: problem
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik) :: pair

      call problem%evaluate(x)
      pair = (maxloc(abs(problem%residual), dim=1, kind=ik) + 1)/2
      do worst = 1, size(problem%place, 2)
         if (any(problem%place(:, worst) == pair)) return
      end do
      worst = 0
   end function worst_cell

   !> From values on the cells to values at the pairs: means weighted by the cells' lengths.
   pure subroutine gather(problem, cells, pairs)
      type(contact_problem_t), intent(in) :: problem
      real(rk), intent(in) :: cells(:, :)  !< (3, fracture cells) [m]
      real(rk), intent(out) :: pairs(:)  !< (n) [m]
      integer(ik) :: cell, k

      pairs = 0.0_rk
      do cell = 1, size(cells, 2)
         do k = 1, 3
            associate (i => problem%place(k, cell))
               if (i == 0) cycle
               pairs(i) = pairs(i) + problem%share(k, cell)/problem%length(i)*cells(k, cell)
            end associate
         end do
      end do
   end subroutine gather

   !> From pairs to cells.
   pure subroutine scatter(problem, jump, traction, state, contact)
      type(contact_problem_t), intent(in) :: problem
      real(rk), intent(in) :: jump(:)  !< (2 n) n and tau of each pair [m]
      real(rk), intent(in) :: traction(:, :)  !< (n tau, n) [Pa]
      integer(ik), intent(in) :: state(:)
      type(contact_t), intent(inout) :: contact
      integer(ik) :: cell, k

      do cell = 1, size(problem%place, 2)
         do k = 1, 3
            associate (i => problem%place(k, cell))
               if (i == 0) cycle
               contact%jump(:, k, cell) = jump([2*i, 2*i - 1])
               contact%traction(:, k, cell) = traction([2, 1], i)
               contact%apart(k, cell) = problem%law(i)%apart(traction(:, i), jump(2*i - 1:2*i))
               contact%state(k, cell) = state(i)
            end associate
         end do
      end do
   end subroutine scatter

   !> Contact on a new mesh: where the old mesh had the fracture, jump and slip of its nodes,
   !! interpolated; elsewhere it stays as it is.
   pure subroutine transfer_contact(fine_old, old, fine_new, new)
      type(fine_mesh_t), intent(in) :: fine_old
      type(contact_t), intent(in) :: old
      type(fine_mesh_t), intent(in) :: fine_new
      type(contact_t), intent(inout) :: new
      real(rk) :: weight(3)
      integer(ik) :: cell, k, source

      do cell = 1, fine_new%fracture%n_cells
         do k = 1, 3
            call find(fine_new%fracture%cell_fracture(cell), fine_new%face_s(k, cell), source, &
                      weight)
            if (source == 0) cycle
            new%jump(:, k, cell) = matmul(old%jump(:, :, source), weight)
            new%slip_before(k, cell) = dot_product(old%slip_before(:, source), weight)
            new%slip_path(k, cell) = dot_product(old%slip_path(:, source), weight)
            new%opened(k, cell) = max(0.0_rk, dot_product(old%opened(:, source), weight))
         end do
      end do

   contains

      !> The old cell at an arc length of a fracture, and the shares of its nodes.
      pure subroutine find(f, s, source, weight)
         integer(ik), intent(in) :: f
         real(rk), intent(in) :: s  !< [m]
         integer(ik), intent(out) :: source  !< 0: none
         real(rk), intent(out) :: weight(3)  !< start, end, mid [-]
         real(rk) :: x
         integer(ik) :: i

         source = 0
         weight = 0.0_rk
         do i = 1, fine_old%fracture%n_cells
            if (fine_old%fracture%cell_fracture(i) /= f) cycle
            x = (s - fine_old%face_s(1, i))/(fine_old%face_s(2, i) - fine_old%face_s(1, i))
            if (x < -same_place .or. x > 1.0_rk + same_place) cycle
            source = i
            x = line_parameter(min(1.0_rk, max(0.0_rk, x)), fine_old%face_tip(i))
            weight = line_shapes(x)
            return
         end do
      end subroutine find

   end subroutine transfer_contact

end module fine_contact
