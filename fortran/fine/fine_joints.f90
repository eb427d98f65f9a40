!> Contact where more than two nodes meet: at T and X joints.
!!
!! Each fracture cell that ends at the joint separates two of its nodes: a link between them. The
!! links close to a ring, so one jump follows from the others. Along a tree of links, from a root
!! whose links belong to one fracture where there is such a node, every node moves with the node
!! before it and the jump of the link between them. The two unknowns that a node loses become the
!! jump. The link that closes the ring has no law: its traction is that of the middle of
!! its cell (fine_contact).
!!
!! The same holds for every other end of a cell whose nodes cannot be tied, as nodes with a
!! prescribed displacement: on a roller the support bears a part of the force, which cannot be
!! separated from that of the law. The nodes keep their own unknowns, loaded by the traction of the
!! middle.
module fine_joints
   use base_kinds, only: ik, rk
   use base_plane, only: turned_left
   use fine_boundary, only: fine_boundary_t
   use fine_faces, only: columns_max, constraints_t, face_contact, face_conditions_t, face_loaded
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: tie_joints

   !> Ends of cells in contact at joints.
   type :: links_t
      integer(ik) :: n = 0
      integer(ik), allocatable :: cell(:), end(:)  !< (n) fracture cell and its end, 1 or 2
      integer(ik), allocatable :: nodes(:, :)  !< (2, n) on side +, -
   end type links_t

contains

   !> Add the links of all joints to the pairs in contact, and find the ends without a law.
   pure subroutine tie_joints(fine, boundary, conditions, constraints)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(inout) :: constraints
      type(links_t) :: links
      logical, allocatable :: reached(:)
      integer(ik) :: i, root

      call find_links(fine, boundary, conditions, constraints, links)
      allocate (reached(fine%n_nodes), source=.false.)
      do i = 1, links%n
         if (any(reached(links%nodes(:, i)))) cycle
         root = root_of(fine, links, links%nodes(1, i))
         call grow_tree(fine, links, root, reached, constraints)
      end do
      call find_closing(fine, conditions, constraints)
   end subroutine tie_joints

   !> Find the ends in contact without a law, and the unknowns that they load besides the jumps.
   pure subroutine find_closing(fine, conditions, constraints)
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(inout) :: constraints
      integer(ik) :: cell, k

      constraints%kept_dofs = constraints%contact_dofs
      do cell = 1, fine%fracture%n_cells
         if (conditions%condition(cell) /= face_contact) cycle
         if (.not. has_law(3_ik, cell)) cycle
         do k = 1, 2
            associate (nodes => fine%face_nodes(k, :, cell))
               if (nodes(1) == nodes(2) .or. has_law(k, cell)) cycle
               if (all(constraints%n_columns(nodes) == 0)) cycle
               constraints%closing = reshape([constraints%closing, cell, k], &
                                             [2_ik, size(constraints%closing, 2, ik) + 1_ik])
               call keep_loaded(nodes(1), nodes(2), constraints)
            end associate
         end do
      end do

   contains

      !> The node of a cell belongs to a pair that is not just loaded.
      pure logical function has_law(node, of_cell)
         integer(ik), intent(in) :: node, of_cell  !< 1 to 3

         has_law = .false.
         associate (pair => constraints%face_pair(node, of_cell))
            if (pair > 0) has_law = constraints%pair_condition(pair) /= face_loaded
         end associate
      end function has_law

   end subroutine find_closing

   !> Keep the unknowns on which opposite forces on two nodes do work.
   pure subroutine keep_loaded(plus, minus, constraints)
      integer(ik), intent(in) :: plus, minus
      type(constraints_t), intent(inout) :: constraints
      integer(ik) :: column, nodes(2), other, side
      real(rk) :: motion(2)

      nodes = [plus, minus]
      do side = 1, 2
         other = nodes(3 - side)
         do column = 1, constraints%n_columns(nodes(side))
            associate (dof => constraints%dof(column, nodes(side)))
               if (any(constraints%kept_dofs == dof)) cycle
               associate (same => findloc(constraints%dof(:constraints%n_columns(other), other), &
                                          dof, dim=1))
                  motion = constraints%basis(:, column, nodes(side))
                  if (same > 0) motion = motion - constraints%basis(:, same, other)
               end associate
               if (any(abs(motion) > 0.0_rk)) constraints%kept_dofs = [constraints%kept_dofs, dof]
            end associate
         end do
      end do
   end subroutine keep_loaded

   !> Ends at joints have two nodes and belong to no pair.
   pure subroutine find_links(fine, boundary, conditions, constraints, links)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      type(face_conditions_t), intent(in) :: conditions
      type(constraints_t), intent(in) :: constraints
      type(links_t), intent(out) :: links
      integer(ik) :: cell, k

      associate (n => 2*fine%fracture%n_cells)
         allocate (links%cell(n), links%end(n), links%nodes(2, n))
      end associate
      do cell = 1, fine%fracture%n_cells
         if (conditions%condition(cell) /= face_contact) cycle
         do k = 1, 2
            associate (nodes => fine%face_nodes(k, :, cell))
               if (nodes(1) == nodes(2) .or. constraints%face_pair(k, cell) > 0) cycle
               if (any(boundary%prescribed(:, nodes))) cycle
               links%n = links%n + 1
               links%cell(links%n) = cell
               links%end(links%n) = k
               links%nodes(:, links%n) = nodes
            end associate
         end do
      end do
   end subroutine find_links

   !> The best root among the nodes linked to a given one: of two links of one fracture if possible.
   pure integer(ik) function root_of(fine, links, start)
      type(fine_mesh_t), intent(in) :: fine
      type(links_t), intent(in) :: links
      integer(ik), intent(in) :: start
      integer(ik), allocatable :: members(:)
      integer(ik) :: best, i, j, other, score

      members = [start]
      i = 1
      do while (i <= size(members))
         do j = 1, links%n
            other = opposite(links, j, members(i))
            if (other == 0) cycle
            if (.not. any(members == other)) members = [members, other]
         end do
         i = i + 1
      end do
      best = -1
      root_of = start
      do i = 1, size(members)
         score = through(members(i))
         if (score <= best) cycle
         best = score
         root_of = members(i)
      end do

   contains

      !> Number of links of a node, ten times over if two are of one fracture.
      pure integer(ik) function through(node)
         integer(ik), intent(in) :: node
         integer(ik) :: first, second

         through = 0
         do first = 1, links%n
            if (opposite(links, first, node) == 0) cycle
            through = through + 1
            do second = first + 1, links%n
               if (opposite(links, second, node) == 0) cycle
               if (fine%fracture%cell_fracture(links%cell(first)) &
                   == fine%fracture%cell_fracture(links%cell(second))) through = through + 10
            end do
         end do
      end function through

   end function root_of

   !> The other node of a link, 0 if the link does not belong to the node.
   pure integer(ik) function opposite(links, link, node)
      type(links_t), intent(in) :: links
      integer(ik), intent(in) :: link, node

      opposite = 0
      if (links%nodes(1, link) == node) opposite = links%nodes(2, link)
      if (links%nodes(2, link) == node) opposite = links%nodes(1, link)
   end function opposite

   !> Tie the nodes of one joint, breadth first, as long as their unknowns fit.
   pure subroutine grow_tree(fine, links, root, reached, constraints)
      type(fine_mesh_t), intent(in) :: fine
      type(links_t), intent(in) :: links
      integer(ik), intent(in) :: root
      logical, intent(inout) :: reached(:)
      type(constraints_t), intent(inout) :: constraints
      integer(ik), allocatable :: queue(:)
      integer(ik) :: at, child, link

      queue = [root]
      reached(root) = .true.
      at = 1
      do while (at <= size(queue))
         do link = 1, links%n
            child = opposite(links, link, queue(at))
            if (child == 0) cycle
            if (reached(child)) cycle
            if (constraints%n_columns(queue(at)) + 2 > columns_max) cycle
            reached(child) = .true.
            queue = [queue, child]
            call tie(fine, links%cell(link), links%end(link), queue(at), child, constraints)
         end do
         at = at + 1
      end do
   end subroutine grow_tree

   !> Let a node move with its parent and the jump between them, and make the link a pair.
   pure subroutine tie(fine, cell, end, parent, child, constraints)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: cell, end, parent, child
      type(constraints_t), intent(inout) :: constraints
      integer(ik) :: jump_dofs(2), n
      real(rk) :: direction, tau(2)

      tau = fine%face_tangent(:, cell)
      ! [u] is the displacement of side - less that of side +.
      direction = merge(1.0_rk, -1.0_rk, child == fine%face_nodes(end, 2, cell))
      jump_dofs = constraints%dof(1:2, child)
      n = constraints%n_columns(parent)
      constraints%n_columns(child) = n + 2
      constraints%dof(1:n + 2, child) = [constraints%dof(1:n, parent), jump_dofs]
      constraints%basis(:, 1:n, child) = constraints%basis(:, 1:n, parent)
      constraints%basis(:, n + 1, child) = direction*turned_left(tau)
      constraints%basis(:, n + 2, child) = direction*tau

      constraints%n_pairs = constraints%n_pairs + 1
      associate (pair => constraints%n_pairs)
         constraints%pair_nodes(:, pair) = fine%face_nodes(end, :, cell)
         constraints%face_pair(end, cell) = pair
         constraints%pair_condition = [constraints%pair_condition, face_contact]
         constraints%tangent = reshape([constraints%tangent, tau], [2_ik, pair])
         constraints%contact_pairs = [constraints%contact_pairs, pair]
         constraints%contact_dofs = [constraints%contact_dofs, jump_dofs]
      end associate
   end subroutine tie

end module fine_joints
