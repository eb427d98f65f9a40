!> Conditions on the fracture faces, and the relations between the displacements of both sides.
!!
!! Where two nodes face each other across a fracture, u(+) = m - [u]/2 and u(-) = m + [u]/2 with
!! their mean m and jump [u] = u(-) - u(+). A prescribed jump leaves m as unknown; a slipping pair
!! keeps m and the amount of slip d, with [u] = d*(tau + dilation*n); a pair in contact keeps m and
!! both components of the jump, which follow from the contact law (fine_contact). Every displacement
!! is linear in these unknowns, u = T q + c, and the stiffness becomes T' K T: definite, without
!! penalty or multipliers.
!!
!! Where more than two nodes meet (T and X joints) the copies at the joint itself remain free, for
!! all conditions of the cells around, unless these are in contact (fine_joints). A pair with a
!! prescribed displacement remains free, too; in contact it has the traction of the middle of its
!! cell.
module fine_faces
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, turned_left
   use contact_law, only: contact_law_t, is_valid
   use fine_boundary, only: fine_boundary_t
   use fine_element, only: line_resultants
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: build_constraints, check_conditions, constraints_t, face_conditions_t, columns_max
   public :: face_contact, face_jump, face_law_t, face_loaded, face_slip, faces_at_joints
   public :: loaded_everywhere, prescribe_jumps

   integer(ik), parameter :: columns_max = 8  !< unknowns that may move one node

   ! Conditions of a fracture cell. Where cells meet, the larger number holds at their common nodes.
   integer(ik), parameter :: face_loaded = 1  !< contact traction and fluid pressure given
   integer(ik), parameter :: face_slip = 2  !< slip free, opening tied to it; traction given
   integer(ik), parameter :: face_contact = 3  !< contact traction found by the law of the cell
   integer(ik), parameter :: face_jump = 4  !< displacement jump given

   !> The law of a cell whose condition is face_contact.
   type :: face_law_t
      type(contact_law_t) :: contact  !< without parameters: frictionless
      logical :: slip_given = .false.  !< [u]_tau is that of the loads; friction plays no part
   end type face_law_t

   !> What holds on each fracture cell; the values belong to the loads.
   type :: face_conditions_t
      integer(ik), allocatable :: condition(:)  !< (fracture cells) face_loaded .. face_jump
      real(rk), allocatable :: dilation(:)  !< (fracture cells) sign of slip * tan(psi) [-]
      type(face_law_t), allocatable :: law(:)  !< (fracture cells)
   end type face_conditions_t

   !> How displacements depend on the unknowns.
   type :: constraints_t
      integer(ik) :: n_dofs = 0
      integer(ik), allocatable :: n_columns(:)  !< (n_nodes) unknowns that move a node
      integer(ik), allocatable :: dof(:, :)  !< (columns_max, n_nodes) which ones
      real(rk), allocatable :: basis(:, :, :)  !< (2, columns_max, n_nodes) how it moves with each
      logical, allocatable :: prescribed(:)  !< (n_nodes) part of its displacement is given
      ! Pairs of nodes that face each other.
      integer(ik) :: n_pairs = 0
      integer(ik), allocatable :: pair_nodes(:, :)  !< (2, n_pairs) on side +, -
      integer(ik), allocatable :: pair_condition(:)  !< (n_pairs)
      integer(ik), allocatable :: face_pair(:, :)  !< (3, fracture cells) start, end, mid; 0: none
      logical, allocatable :: face_flipped(:, :)  !< the cell sees the pair's sides exchanged
      real(rk), allocatable :: tangent(:, :)  !< (2, n_pairs) tau of slipping and touching pairs
      ! Pairs in contact.
      integer(ik), allocatable :: contact_pairs(:)  !< (n_contact) which pairs
      integer(ik), allocatable :: contact_dofs(:)  !< (2 n_contact) unknowns [u]_n, [u]_tau of each
      integer(ik), allocatable :: closing(:, :)  !< (2, n) cell and end in contact without a law
      integer(ik), allocatable :: kept_dofs(:)  !< contact_dofs, then what else those ends load
   end type constraints_t

contains

   !> Contact traction and pressure given on every fracture cell.
   pure function loaded_everywhere(fine) result(conditions)
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t) :: conditions

      allocate (conditions%condition(fine%fracture%n_cells), source=face_loaded)
      allocate (conditions%dilation(fine%fracture%n_cells), source=0.0_rk)
      allocate (conditions%law(fine%fracture%n_cells))
   end function loaded_everywhere

   !> Refuse unknown conditions and arrays of the wrong size.
   pure subroutine check_conditions(fine, conditions, error)
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t), intent(in) :: conditions
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: origin = "check_conditions"

      if (.not. (allocated(conditions%condition) .and. allocated(conditions%dilation) &
                 .and. allocated(conditions%law))) then
         call raise_error(error, origin, "the face conditions have not been set")
      else if (size(conditions%condition) /= fine%fracture%n_cells &
               .or. size(conditions%dilation) /= fine%fracture%n_cells &
               .or. size(conditions%law) /= fine%fracture%n_cells) then
         call raise_error(error, origin, "the face conditions have the wrong number of cells")
      else if (any(conditions%condition < face_loaded .or. conditions%condition > face_jump)) then
         call raise_error(error, origin, "a fracture cell has an unknown face condition")
      else if (.not. sum(abs(conditions%dilation)) <= huge(1.0_rk)) then
         call raise_error(error, origin, "a dilation is not a finite number")
      else if (any(conditions%condition == face_contact)) then
         if (all(is_valid(conditions%law%contact))) return
         call raise_error(error, origin, "friction and dilation must be finite and not negative")
      end if
   end subroutine check_conditions

   !> Find the pairs, and number the unknowns.
   pure subroutine build_constraints(fine, boundary, conditions, constraints)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(out) :: constraints
      real(rk), allocatable :: dilation(:)
      integer(ik), allocatable :: follows(:)
      integer(ik) :: component, node, pair, plus, minus

      call find_pairs(fine, constraints)
      call combine_conditions(fine, boundary, conditions, constraints, dilation)

      allocate (constraints%n_columns(fine%n_nodes), follows(fine%n_nodes), source=0_ik)
      allocate (constraints%dof(columns_max, fine%n_nodes), source=0_ik)
      allocate (constraints%basis(2, columns_max, fine%n_nodes), source=0.0_rk)
      do node = 1, fine%n_nodes
         do component = 1, 2
            if (boundary%prescribed(component, node)) cycle
            constraints%n_columns(node) = constraints%n_columns(node) + 1
            constraints%basis(component, constraints%n_columns(node), node) = 1.0_rk
         end do
      end do
      constraints%prescribed = any(boundary%prescribed, dim=1)

      ! The minus node of a tied pair takes the unknowns of its plus node.
      do pair = 1, constraints%n_pairs
         plus = constraints%pair_nodes(1, pair)
         minus = constraints%pair_nodes(2, pair)
         select case (constraints%pair_condition(pair))
         case (face_jump)
            constraints%prescribed([plus, minus]) = .true.
         case (face_slip)
            constraints%n_columns([plus, minus]) = 3
            constraints%basis(:, 3, plus) = -0.5_rk*(constraints%tangent(:, pair) &
                                                     + dilation(pair)*normal_of(pair))
            constraints%basis(:, 3, minus) = -constraints%basis(:, 3, plus)
         case (face_contact)
            constraints%n_columns([plus, minus]) = 4
            constraints%basis(:, 3, plus) = -0.5_rk*normal_of(pair)
            constraints%basis(:, 4, plus) = -0.5_rk*constraints%tangent(:, pair)
            constraints%basis(:, 3:4, minus) = -constraints%basis(:, 3:4, plus)
         case default
            cycle  ! both nodes keep their own unknowns
         end select
         follows(minus) = plus
      end do

      call number_unknowns(follows, constraints)

   contains

      !> From side + to side -.
      pure function normal_of(slipping) result(normal)
         integer(ik), intent(in) :: slipping
         real(rk) :: normal(2)

         normal = turned_left(constraints%tangent(:, slipping))
      end function normal_of

   end subroutine build_constraints

   !> Number the unknowns of the nodes, then those of contact.
   pure subroutine number_unknowns(follows, constraints)
      integer(ik), intent(in) :: follows(:)  !< (n_nodes) the node whose unknowns it has; 0: its own
      type(constraints_t), intent(inout) :: constraints
      integer(ik) :: column, node, pair

      do node = 1, size(follows, kind=ik)
         if (follows(node) > 0) cycle
         do column = 1, constraints%n_columns(node)
            constraints%n_dofs = constraints%n_dofs + 1
            constraints%dof(column, node) = constraints%n_dofs
         end do
      end do
      do node = 1, size(follows, kind=ik)
         if (follows(node) > 0) constraints%dof(:, node) = constraints%dof(:, follows(node))
      end do
      allocate (constraints%contact_pairs(0), constraints%contact_dofs(0))
      allocate (constraints%closing(2, 0))
      do pair = 1, constraints%n_pairs
         if (constraints%pair_condition(pair) /= face_contact) cycle
         constraints%contact_pairs = [constraints%contact_pairs, pair]
         constraints%contact_dofs = [constraints%contact_dofs, &
                                     constraints%dof(3:4, constraints%pair_nodes(1, pair))]
      end do
   end subroutine number_unknowns

   !> Node pairs across the fractures, without tips (one node) and joints (more than two).
   pure subroutine find_pairs(fine, constraints)
      type(fine_mesh_t), intent(in) :: fine
      type(constraints_t), intent(inout) :: constraints
      integer(ik), allocatable :: partner(:), pair_of(:)
      logical, allocatable :: is_joint(:)
      integer(ik) :: cell, k

      allocate (partner(fine%n_nodes), pair_of(fine%n_nodes), source=0_ik)
      allocate (is_joint(fine%n_nodes), source=.false.)
      do cell = 1, fine%fracture%n_cells
         do k = 1, 3
            associate (plus => fine%face_nodes(k, 1, cell), minus => fine%face_nodes(k, 2, cell))
               if (plus == minus) cycle
               if (partner(plus) == 0) partner(plus) = minus
               if (partner(minus) == 0) partner(minus) = plus
               if (partner(plus) /= minus .or. partner(minus) /= plus) then
                  is_joint([plus, minus, partner(plus), partner(minus)]) = .true.
               end if
            end associate
         end do
      end do

      allocate (constraints%face_pair(3, fine%fracture%n_cells), source=0_ik)
      allocate (constraints%face_flipped(3, fine%fracture%n_cells), source=.false.)
      allocate (constraints%pair_nodes(2, 3*fine%fracture%n_cells))
      do cell = 1, fine%fracture%n_cells
         do k = 1, 3
            associate (plus => fine%face_nodes(k, 1, cell), minus => fine%face_nodes(k, 2, cell))
               if (plus == minus .or. any(is_joint([plus, minus]))) cycle
               if (pair_of(plus) == 0) then
                  constraints%n_pairs = constraints%n_pairs + 1
                  constraints%pair_nodes(:, constraints%n_pairs) = [plus, minus]
                  pair_of([plus, minus]) = constraints%n_pairs
               end if
               constraints%face_pair(k, cell) = pair_of(plus)
               constraints%face_flipped(k, cell) = constraints%pair_nodes(1, pair_of(plus)) /= plus
            end associate
         end do
      end do
   end subroutine find_pairs

   !> Whether the ends of fracture cells lie at joints, where more than two nodes meet.
   pure function faces_at_joints(fine) result(is_at_joint)
      type(fine_mesh_t), intent(in) :: fine
      logical :: is_at_joint(fine%fracture%n_cells)
      type(constraints_t) :: constraints

      call find_pairs(fine, constraints)
      is_at_joint = any(constraints%face_pair(:2, :) == 0 .and. &
                        fine%face_nodes(:2, 1, :) /= fine%face_nodes(:2, 2, :), dim=1)
   end function faces_at_joints

   !> The condition of each pair, and the frame of pairs that may slip. At a kink it is the mean of
   !! the frames of the cells that have the pair's condition, and so is the dilation. In contact the
   !! mean is weighted by the cells' nodal lengths: a uniform pressure then has no shear component.
   !! Where only some of the cells cannot part, these alone count: the mouth of a wing slides along
   !! the main fracture.
   pure subroutine combine_conditions(fine, boundary, conditions, constraints, dilation)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(inout) :: constraints
      real(rk), allocatable, intent(out) :: dilation(:)  !< (n_pairs) tan(psi) [-]
      integer(ik), allocatable :: n_alike(:)
      logical, allocatable :: is_bilateral(:)
      real(rk) :: share(3), tau(2)
      integer(ik) :: cell, k, pair

      allocate (constraints%tangent(2, constraints%n_pairs), source=0.0_rk)
      allocate (dilation(constraints%n_pairs), source=0.0_rk)
      allocate (n_alike(constraints%n_pairs), source=0_ik)
      allocate (constraints%pair_condition(constraints%n_pairs), source=face_loaded)
      allocate (is_bilateral(constraints%n_pairs), source=.false.)
      do cell = 1, fine%fracture%n_cells
         do k = 1, 3
            pair = constraints%face_pair(k, cell)
            if (pair == 0) cycle
            associate (strictest => constraints%pair_condition(pair))
               strictest = max(strictest, conditions%condition(cell))
            end associate
            if (conditions%condition(cell) == face_contact) then
               is_bilateral(pair) = is_bilateral(pair) .or. conditions%law(cell)%contact%bilateral
            end if
         end do
      end do
      do pair = 1, constraints%n_pairs
         if (any(boundary%prescribed(:, constraints%pair_nodes(:, pair)))) then
            constraints%pair_condition(pair) = face_loaded
         end if
      end do

      do cell = 1, fine%fracture%n_cells
         do k = 1, 3
            pair = constraints%face_pair(k, cell)
            if (pair == 0) cycle
            if (conditions%condition(cell) /= constraints%pair_condition(pair)) cycle
            ! Seen from the other side tau, n and the jump all change sign: its components do not.
            tau = fine%face_tangent(:, cell)
            if (constraints%face_flipped(k, cell)) tau = -tau
            if (conditions%condition(cell) == face_contact) then
               if (is_bilateral(pair) .and. .not. conditions%law(cell)%contact%bilateral) cycle
               share = line_resultants(fine%face_tip(cell))
               tau = share(k)*fine%face_length(cell)*tau
            end if
            constraints%tangent(:, pair) = constraints%tangent(:, pair) + tau
            dilation(pair) = dilation(pair) + conditions%dilation(cell)
            n_alike(pair) = n_alike(pair) + 1
         end do
      end do
      do pair = 1, constraints%n_pairs
         if (n_alike(pair) == 0) cycle
         tau = constraints%tangent(:, pair)
         constraints%tangent(:, pair) = tau/norm2(tau)
         dilation(pair) = dilation(pair)/n_alike(pair)
      end do
   end subroutine combine_conditions

   !> Add half of the given jumps to the given part of the displacements of both sides. Where two
   !! cells meet, the mean of what they say is taken.
   pure subroutine prescribe_jumps(fine, conditions, constraints, jump, displacement)
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(in) :: constraints
      real(rk), intent(in) :: jump(:, :, :)  !< (tau n, start end mid, fracture cell) [m]
      real(rk), intent(inout) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), allocatable :: total(:, :)
      integer(ik), allocatable :: n_given(:)
      real(rk) :: tau(2), vector(2), half(2)
      integer(ik) :: cell, k, pair

      allocate (total(2, constraints%n_pairs), source=0.0_rk)
      allocate (n_given(constraints%n_pairs), source=0_ik)
      do cell = 1, fine%fracture%n_cells
         if (conditions%condition(cell) /= face_jump) cycle
         tau = fine%face_tangent(:, cell)
         do k = 1, 3
            pair = constraints%face_pair(k, cell)
            if (pair == 0) cycle
            vector = jump(1, k, cell)*tau + jump(2, k, cell)*[-tau(2), tau(1)]
            if (constraints%face_flipped(k, cell)) vector = -vector
            total(:, pair) = total(:, pair) + vector
            n_given(pair) = n_given(pair) + 1
         end do
      end do
      do pair = 1, constraints%n_pairs
         if (constraints%pair_condition(pair) /= face_jump) cycle
         half = 0.5_rk*total(:, pair)/n_given(pair)
         associate (nodes => constraints%pair_nodes(:, pair))
            displacement(:, nodes(1)) = displacement(:, nodes(1)) - half
            displacement(:, nodes(2)) = displacement(:, nodes(2)) + half
         end associate
      end do
   end subroutine prescribe_jumps

end module fine_faces
