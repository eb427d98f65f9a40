!> The fine problem: elasticity on six-node triangles, factorized once and solved for many loads.
module fine_model
   use algebra_multifrontal, only: multifrontal_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: place_text
   use fine_boundary, only: check_boundary, check_support, clamped_boundary, find_loose, &
                            fine_boundary_t
   use fine_contact, only: close_joints, contact_problem_t, contact_t, eliminate_loose, &
                           loose_unknowns, new_contact, set_contact_problem, show_closing, &
                           solve_contact
   use fine_elasticity, only: check_elasticity, elasticity_t, rocks_t
   use fine_element, only: stiffness_matrix
   use fine_elements, only: pattern_of, pattern_t, tied_elements_t
   use fine_faces, only: build_constraints, check_conditions, constraints_t, face_conditions_t, &
                         face_contact, face_loaded, prescribe_jumps
   use fine_joints, only: tie_joints
   use fine_loads, only: add_face_forces, add_volume_forces, check_loads, fine_loads_t
   use fine_mesh, only: build_fine_mesh, fine_mesh_t, tip_collapsed
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: fracture_mesh_t, mesh_t
   implicit none(type, external)
   private

   public :: fine_model_t

   !> A body with its matrix. Not to be copied: the factors belong to the original.
   type :: fine_model_t
      type(fine_mesh_t) :: mesh
      type(elasticity_t) :: elasticity  !< the only rock, or the first
      type(rocks_t) :: rocks
      type(fine_boundary_t) :: boundary
      type(face_conditions_t) :: conditions
      type(constraints_t) :: constraints
      type(contact_problem_t) :: contact_problem
      real(rk), allocatable :: stiffness(:, :, :)  !< (12, 12, n_cells) element matrices [Pa]
      !> (n_cells) elements that change as tips move along their segments; empty: none is known
      logical, allocatable :: changes(:)
      logical :: ready = .false.
      type(multifrontal_t), allocatable, private :: solver
      !> The unknowns of the elements that the solver has analysed: meshes whose nodes have moved
      !! have the same.
      type(pattern_t), private :: analysed
      !> What the solver has factorized, if some elements change: other elements that are the same
      !! need not be eliminated again.
      real(rk), allocatable, private :: factorized(:, :, :)  !< stiffness (12, 12, n_cells) [Pa]
      real(rk), allocatable, private :: factorized_basis(:, :, :)  !< of the constraints
   contains
      procedure :: set_mesh
      procedure :: take_order
      procedure :: prepare
      procedure :: solve
      procedure :: influence
      procedure :: external_forces
      procedure :: strain_energy
      procedure :: element_forces
      procedure :: displacement_gradient
   end type fine_model_t

contains

   !> Number the nodes, so that conditions and loads can be set up for them, and form the element
   !! matrices, of one rock or of several.
   subroutine set_mesh(self, mesh, elasticity, error, tip_element, rocks)
      class(fine_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(elasticity_t), intent(in) :: elasticity
      type(error_t), allocatable, intent(out) :: error
      integer(ik), intent(in), optional :: tip_element  !< of fine_mesh; default: tip_quarter
      type(rocks_t), intent(in), optional :: rocks  !< of the elements, in place of `elasticity`
      integer(ik) :: cell, i
      real(rk), allocatable :: lame_lambda(:), shear_modulus(:)
      real(rk) :: xy(2, 6)

      self%ready = .false.
      self%rocks = rocks_t(elasticity=[elasticity], of_cell=[1_ik])
      if (present(rocks)) self%rocks = rocks
      self%elasticity = self%rocks%elasticity(1)
      do i = 1, size(self%rocks%elasticity, kind=ik)
         if (.not. allocated(error)) call check_elasticity(self%rocks%elasticity(i), error)
      end do
      if (.not. allocated(error)) call build_fine_mesh(mesh, self%mesh, error, tip_element)
      if (allocated(error)) return
      if (allocated(self%stiffness)) deallocate (self%stiffness)
      allocate (self%stiffness(12, 12, self%mesh%n_cells))
      lame_lambda = [(self%rocks%elasticity(i)%lame_lambda(), i=1, size(self%rocks%elasticity))]
      shear_modulus = [(self%rocks%elasticity(i)%shear_modulus(), &
                        i=1, size(self%rocks%elasticity))]
      do cell = 1, self%mesh%n_cells
         i = self%rocks%index_of(cell)
         xy = self%mesh%xy(:, self%mesh%cell_nodes(:, cell))
         call stiffness_matrix(xy, self%mesh%tip_corner(cell), lame_lambda(i), shear_modulus(i), &
                               self%stiffness(:, :, cell), self%mesh%tip_element == tip_collapsed)
      end do
   end subroutine set_mesh

   !> Take over the order of elimination of another body, whose mesh differs only in the positions
   !! of its nodes. The other body must be set up again.
   subroutine take_order(self, from)
      class(fine_model_t), intent(inout) :: self
      type(fine_model_t), intent(inout) :: from

      if (.not. allocated(from%analysed%first_unknown)) return
      call move_alloc(from%solver, self%solver)
      call move_alloc(from%factorized, self%factorized)
      call move_alloc(from%factorized_basis, self%factorized_basis)
      self%analysed = from%analysed
      deallocate (from%analysed%first_unknown)
      self%ready = .false.
      from%ready = .false.
      if (allocated(from%stiffness)) deallocate (from%stiffness)
   end subroutine take_order

   !> Assemble and factorize for the given face conditions; may be called again when they change.
   subroutine prepare(self, conditions, error, boundary)
      class(fine_model_t), intent(inout) :: self
      type(face_conditions_t), intent(in) :: conditions
      type(error_t), allocatable, intent(out) :: error
      type(fine_boundary_t), intent(in), optional :: boundary  !< default: all displacements given
      integer(ik), allocatable :: bonds(:, :)

      self%ready = .false.
      if (.not. allocated(self%stiffness)) then
         call raise_error(error, "fine_model_t%prepare", "set_mesh has to come first")
         return
      end if
      call check_conditions(self%mesh, conditions, error)
      if (allocated(error)) return
      self%conditions = conditions
      self%boundary = clamped_boundary(self%mesh)
      if (present(boundary)) self%boundary = boundary
      call check_boundary(self%mesh, self%boundary, error)
      if (allocated(error)) return
      call build_constraints(self%mesh, self%boundary, conditions, self%constraints)
      call tie_joints(self%mesh, self%boundary, conditions, self%constraints)
      if (present(boundary)) then
         associate (tied => self%constraints%pair_condition /= face_loaded)
            allocate (bonds(2, count(tied)))
            bonds(1, :) = pack(self%constraints%pair_nodes(1, :self%constraints%n_pairs), tied)
            bonds(2, :) = pack(self%constraints%pair_nodes(2, :self%constraints%n_pairs), tied)
         end associate
         call check_support(self%mesh, self%boundary, bonds, error)
         if (allocated(error)) return
      end if
      if (self%constraints%n_dofs > 0) then
         call factorize(self, error)
         if (allocated(error)) return
         call condense_contact(self, error)
         if (allocated(error)) return
      end if
      self%ready = .true.
   end subroutine prepare

   !> Factorize the sum of the elements' matrices.
   subroutine factorize(self, error)
      class(fine_model_t), intent(inout), target :: self
      type(error_t), allocatable, intent(out) :: error
      type(tied_elements_t) :: elements
      type(pattern_t) :: pattern
      logical :: others_are_same

      if (.not. allocated(self%changes)) allocate (self%changes(0))
      pattern = pattern_of(self%mesh%cell_nodes, self%constraints, self%changes)
      others_are_same = .false.
      if (.not. pattern%is_same_as(self%analysed)) then
         if (allocated(self%analysed%first_unknown)) deallocate (self%analysed%first_unknown)
         if (.not. allocated(self%solver)) allocate (self%solver)
         if (size(self%changes) > 0) then
            call self%solver%analyse(pattern%first_unknown, pattern%blocks, error, &
                                     kept=pattern%kept, changes=pattern%changes)
         else
            call self%solver%analyse(pattern%first_unknown, pattern%blocks, error, &
                                     kept=pattern%kept)
         end if
         if (allocated(error)) return
         self%analysed = pattern
      else if (allocated(self%factorized)) then
         others_are_same = are_same(self)
      end if
      if (allocated(self%factorized)) deallocate (self%factorized, self%factorized_basis)
      elements%cell_nodes => self%mesh%cell_nodes
      elements%stiffness => self%stiffness
      elements%constraints => self%constraints
      call self%solver%factorize(elements, error, others_are_same)
      if (allocated(error) .or. size(self%changes) == 0) return
      self%factorized = self%stiffness
      self%factorized_basis = self%constraints%basis
   end subroutine factorize

   !> Whether the elements that do not change are those that have been factorized, bit for bit.
   pure logical function are_same(self)
      type(fine_model_t), intent(in) :: self
      real(rk) :: change
      integer(ik) :: cell

      are_same = .false.
      do cell = 1, self%mesh%n_cells
         if (self%changes(cell)) cycle
         change = sum(abs(self%stiffness(:, :, cell) - self%factorized(:, :, cell)))
         associate (nodes => self%mesh%cell_nodes(:, cell))
            change = change + sum(abs(self%constraints%basis(:, :, nodes) &
                                      - self%factorized_basis(:, :, nodes)))
         end associate
         if (.not. change <= 0.0_rk) return
      end do
      are_same = .true.
   end function are_same

   !> Condense the matrix onto the jumps of the pairs in contact, if there are any.
   !!
   !! The Schur complement that the elimination leaves costs no more than solving for one right-hand
   !! side per jump: it is what those solutions would compute, restricted to the fronts that hold
   !! the jumps.
   subroutine condense_contact(self, error)
      class(fine_model_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      logical :: is_singular

      call set_contact_problem(self%mesh, self%conditions, self%constraints, &
                               self%rocks%elasticity(1)%young, self%contact_problem)
      associate (problem => self%contact_problem)
         if (problem%n == 0) return
         call self%solver%get_schur(problem%condensed)
         call close_joints(problem, problem%condensed)
         call eliminate_loose(problem, is_singular)
         if (.not. is_singular) return
         call raise_error(error, "fine_model_t%prepare", "the end of a fracture on a side "// &
                          "with prescribed displacements can move freely")
      end associate
   end subroutine condense_contact

   !> Displacements under the given loads. Faces in contact start from `contact`, which holds their
   !! history, and leave their solution there; without it they start closed and new.
   subroutine solve(self, loads, displacement, error, contact)
      class(fine_model_t), intent(inout) :: self
      type(fine_loads_t), intent(in) :: loads
      real(rk), allocatable, intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(error_t), allocatable, intent(out) :: error
      type(contact_t), intent(inout), optional :: contact
      type(contact_t) :: touching
      real(rk), allocatable :: force(:, :)
      integer(ik) :: cell

      if (.not. self%ready) then
         call raise_error(error, "fine_model_t%solve", "prepare has to come first")
         return
      end if
      call check_loads(self%mesh, loads, error)
      if (allocated(error)) return

      ! The given part of the displacements.
      allocate (displacement(2, self%mesh%n_nodes), source=0.0_rk)
      where (self%boundary%prescribed) displacement = loads%boundary_displacement
      call prescribe_jumps(self%mesh, self%conditions, self%constraints, loads%jump, displacement)

      ! Forces, less those that the given displacements take.
      force = self%external_forces(loads)
      do cell = 1, self%mesh%n_cells
         associate (nodes => self%mesh%cell_nodes(:, cell))
            if (.not. any(self%constraints%prescribed(nodes))) cycle
            force(:, nodes) = force(:, nodes) - self%element_forces(displacement, cell)
         end associate
      end do

      touching = new_contact(self%mesh)
      if (present(contact)) touching = contact
      if (self%constraints%n_dofs > 0) then
         call solve_free_part(self, force, loads%jump, displacement, touching, error)
      end if
      if (allocated(error)) return
      if (present(contact)) contact = touching
      if (.not. sum(abs(displacement)) <= huge(1.0_rk)) then
         call raise_error(error, "fine_model_t%solve", "a displacement is not a finite number")
      end if
   end subroutine solve

   !> Displacements under nodal forces alone, without faces in contact: all prescribed displacements
   !! and jumps are 0.
   subroutine influence(self, force, displacement, error)
      class(fine_model_t), intent(inout) :: self
      real(rk), intent(in) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk), allocatable, intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(error_t), allocatable, intent(out) :: error
      type(contact_t) :: none
      real(rk) :: no_jump(2, 3, self%mesh%fracture%n_cells)

      if (.not. self%ready) then
         call raise_error(error, "fine_model_t%influence", "prepare has to come first")
         return
      else if (self%contact_problem%n > 0) then
         call raise_error(error, "fine_model_t%influence", "faces in contact answer nonlinearly")
         return
      end if
      allocate (displacement(2, self%mesh%n_nodes), source=0.0_rk)
      no_jump = 0.0_rk
      if (self%constraints%n_dofs > 0) then
         call solve_free_part(self, force, no_jump, displacement, none, error)
      end if
   end subroutine influence

   !> Add the displacements of the free unknowns to the prescribed ones.
   subroutine solve_free_part(self, force, given_jump, displacement, contact, error)
      class(fine_model_t), intent(inout) :: self
      real(rk), intent(in) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk), intent(in) :: given_jump(:, :, :)  !< (tau n, start end mid, fracture cell) [m]
      real(rk), intent(inout) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(contact_t), intent(inout) :: contact
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: x(:, :)
      integer(ik) :: node, column

      allocate (x(self%constraints%n_dofs, 1), source=0.0_rk)
      associate (n_columns => self%constraints%n_columns, dof => self%constraints%dof, &
                 basis => self%constraints%basis)
         do node = 1, self%mesh%n_nodes
            do column = 1, n_columns(node)
               x(dof(column, node), 1) = x(dof(column, node), 1) &
                                         + dot_product(basis(:, column, node), force(:, node))
            end do
         end do
         call solve_unknowns(self, given_jump, contact, x, error)
         if (allocated(error)) return
         do node = 1, self%mesh%n_nodes
            do column = 1, n_columns(node)
               displacement(:, node) = displacement(:, node) &
                                       + x(dof(column, node), 1)*basis(:, column, node)
            end do
         end do
      end associate
      call show_closing(self%mesh, self%contact_problem, displacement, contact)
   end subroutine solve_free_part

   !> Unknowns from their loads, with faces in contact by the condensed system.
   subroutine solve_unknowns(self, given_jump, contact, x, error)
      class(fine_model_t), intent(inout) :: self
      real(rk), intent(in) :: given_jump(:, :, :)  !< (tau n, start end mid, fracture cells) [m]
      type(contact_t), intent(inout) :: contact
      real(rk), intent(inout), contiguous :: x(:, :)  !< (n_dofs, 1) loads [N/m], then unknowns [m]
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: load(1, size(self%constraints%kept_dofs)), jump(2*self%contact_problem%n)
      real(rk), allocatable :: loose(:)
      character(len=:), allocatable :: reason
      integer(ik) :: cell

      if (self%contact_problem%n == 0) then
         call self%solver%solve(x(:, 1), error)
         return
      end if
      call self%solver%condense(x(:, 1), load(1, :), error)
      if (allocated(error)) return
      associate (problem => self%contact_problem, m => size(jump))
         call close_joints(problem, load)
         loose = loose_unknowns(problem%loose, load(1, m + 1:))
         if (problem%loose%n > 0) load(1, :m) = load(1, :m) - matmul(loose, problem%loose%in_rows)
         call solve_contact(problem, load(1, :m), given_jump, contact, jump, reason, cell)
         if (allocated(reason)) then
            call raise_error(error, "fine_model_t%solve", "contact: "//reason// &
                             cell_place(self%mesh%fracture, cell)//loose_place(self))
            return
         end if
         if (problem%loose%n > 0) loose = loose - matmul(problem%loose%by_jump, jump)
      end associate
      call self%solver%expand([jump, loose], x(:, 1), error)
   end subroutine solve_unknowns

   !> Place of a fracture cell for messages; empty for cell 0.
   pure function cell_place(fracture, cell) result(words)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: cell
      character(len=:), allocatable :: words

      words = ""
      if (cell == 0) return
      words = ", most of all at "//place_text(fracture_cell_centre(fracture, cell))
   end function cell_place

   !> Place of a part that is held only by contact, for messages; empty if there is none.
   pure function loose_place(self) result(words)
      class(fine_model_t), intent(in) :: self
      character(len=:), allocatable :: words, place
      integer(ik) :: no_bonds(2, 0)

      words = ""
      call find_loose(self%mesh, self%boundary, no_bonds, place)
      if (allocated(place)) words = " (only contact holds the part at "//place//")"
   end function loose_place

   !> Nodal forces of all loads. Contact tractions that belong to the solution are not among them.
   pure function external_forces(self, loads) result(force)
      class(fine_model_t), intent(in) :: self
      type(fine_loads_t), intent(in) :: loads
      real(rk), allocatable :: force(:, :)  !< (2, n_nodes) [N/m]

      real(rk) :: traction(2, size(loads%traction, 2))

      traction = loads%traction
      where (spread(self%conditions%condition == face_contact, 1, 2)) traction = 0.0_rk
      force = loads%force
      call add_face_forces(self%mesh, traction, loads%fluid_pressure, force)
      call add_volume_forces(self%mesh, self%rocks, loads, force)
   end function external_forces

   !> Energy of the elastic strain, without the work of initial stresses [J/m].
   pure function strain_energy(self, displacement) result(energy)
      class(fine_model_t), intent(in) :: self
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk) :: energy
      integer(ik) :: cell

      energy = 0.0_rk
      do cell = 1, self%mesh%n_cells
         energy = energy + 0.5_rk*sum(displacement(:, self%mesh%cell_nodes(:, cell)) &
                                      *self%element_forces(displacement, cell))
      end do
   end function strain_energy

   !> Nodal forces of the strain of an element, without pore pressure.
   pure function element_forces(self, displacement, cell) result(force)
      class(fine_model_t), intent(in) :: self
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell
      real(rk) :: force(2, 6)  !< [N/m]
      real(rk) :: nodal(12)

      nodal = reshape(displacement(:, self%mesh%cell_nodes(:, cell)), [12])
      force = reshape(matmul(self%stiffness(:, :, cell), nodal), [2, 6])
   end function element_forces

   !> Displacement gradient d u_i / d x_j at a point of an element.
   pure function displacement_gradient(self, displacement, cell, lambda) result(gradient)
      class(fine_model_t), intent(in) :: self
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: lambda(3)  !< reference coordinates; not those of the tip [-]
      real(rk) :: gradient(2, 2)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant

      associate (nodes => self%mesh%cell_nodes(:, cell))
         call self%mesh%evaluate(cell, lambda, values, gradients, area_coordinates, determinant)
         gradient = matmul(displacement(:, nodes), transpose(gradients))
      end associate
   end function displacement_gradient

end module fine_model
