!> Numbering of the unknowns of the coarse level. Equations have the numbers of the unknowns that
!! they determine.
!!
!! The whole body has blocks of three numbers: (u_x, u_y, p) per cell, then two blocks per fracture
!! cell, (jump x, y at its start, p on side +) and (jump x, y at its end, p on side -). With layers
!! (coarse_layers), a block for each of them stands before those of the fractures: the mean pressure
!! at the outer end of the layer, half the difference of that at the start of its face from that at
!! its end, and, in the first layer of a cell, the pressure of the rest of the cell.
!!
!! Condensed onto the fractures, q, per fracture cell:
!!   [u]_n, [u]_tau at its start, p+, [u]_n, [u]_tau at its end, p-
!! All unknowns on the fractures, x: per fracture cell the same and p_F; after the last cell the
!! flows along the fractures, one per pair of cells that exchange fluid; then those into joints, one
!! per branch, and those of wells and of their entries; then the pressures of the joints.
module coarse_layout
   use base_kinds, only: ik
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: at_component, block_count, bulk_count, end_block, end_of_block
   public :: fracture_cell_of_block, layer_block, condensed_layout_t, fracture_layout_t

   !> Numbers in q.
   type :: condensed_layout_t
      integer(ik) :: n_cells = 0  !< fracture cells
      integer(ik) :: per_cell = 6
   contains
      procedure :: count => condensed_count
      procedure :: at_jump
      procedure :: at_face_pressure
   end type condensed_layout_t

   !> Numbers in x.
   type, extends(condensed_layout_t) :: fracture_layout_t
      integer(ik) :: n_flows = 0  !< pairs of cells that exchange fluid
      integer(ik) :: n_branches = 0  !< cells that reach a joint, by joint
      integer(ik) :: n_wells = 0  !< and their entries, whose flow is an unknown
      integer(ik) :: n_joints = 0
   contains
      procedure :: count => fracture_count
      procedure :: cell_count
      procedure :: at_pressure
      procedure :: at_flow
      procedure :: at_branch
      procedure :: at_well
      procedure :: at_joint
   end type fracture_layout_t

contains

   !> How many unknowns there are.
   pure integer(ik) function condensed_count(self)
      class(condensed_layout_t), intent(in) :: self

      condensed_count = self%per_cell*self%n_cells
   end function condensed_count

   !> How many unknowns there are.
   pure integer(ik) function fracture_count(self)
      class(fracture_layout_t), intent(in) :: self

      fracture_count = self%cell_count() + self%n_flows + self%n_branches + self%n_wells &
                       + self%n_joints
   end function fracture_count

   !> How many of the unknowns belong to a single cell; they come first.
   pure integer(ik) function cell_count(self)
      class(fracture_layout_t), intent(in) :: self

      cell_count = self%per_cell*self%n_cells
   end function cell_count

   !> [u]_n at an end of a fracture cell; [u]_tau follows.
   elemental integer(ik) function at_jump(self, cell, end)
      class(condensed_layout_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      integer(ik), intent(in) :: end  !< 1 start, 2 end

      at_jump = self%per_cell*(cell - 1) + 3*end - 2
   end function at_jump

   !> Pressure of the rock at a face of a fracture cell.
   elemental integer(ik) function at_face_pressure(self, cell, side)
      class(condensed_layout_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      integer(ik), intent(in) :: side  !< 1 side +, 2 side -

      at_face_pressure = self%per_cell*(cell - 1) + 3*side
   end function at_face_pressure

   !> Pressure p_F of the fluid in a fracture cell.
   elemental integer(ik) function at_pressure(self, cell)
      class(fracture_layout_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      at_pressure = self%per_cell*cell
   end function at_pressure

   !> Flow from the first to the second cell of a pair.
   elemental integer(ik) function at_flow(self, pair)
      class(fracture_layout_t), intent(in) :: self
      integer(ik), intent(in) :: pair

      at_flow = self%cell_count() + pair
   end function at_flow

   !> Flow of a branch into its joint.
   elemental integer(ik) function at_branch(self, branch)
      class(fracture_layout_t), intent(in) :: self
      integer(ik), intent(in) :: branch

      at_branch = self%at_flow(self%n_flows) + branch
   end function at_branch

   !> Flow of a well into what it feeds, or of an entry; a number of wells_t.
   elemental integer(ik) function at_well(self, well)
      class(fracture_layout_t), intent(in) :: self
      integer(ik), intent(in) :: well

      at_well = self%at_branch(self%n_branches) + well
   end function at_well

   !> Pressure of a joint.
   elemental integer(ik) function at_joint(self, joint)
      class(fracture_layout_t), intent(in) :: self
      integer(ik), intent(in) :: joint

      at_joint = self%at_well(self%n_wells) + joint
   end function at_joint

   !> How many blocks the whole body has.
   pure integer(ik) function block_count(mesh)
      type(mesh_t), intent(in) :: mesh

      block_count = bulk_count(mesh) + 2*mesh%fracture%n_cells
   end function block_count

   !> How many blocks stand before those of the fractures.
   elemental integer(ik) function bulk_count(mesh)
      type(mesh_t), intent(in) :: mesh

      bulk_count = mesh%n_cells + mesh%n_layers
   end function bulk_count

   !> The block of a layer.
   elemental integer(ik) function layer_block(mesh, layer)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: layer

      layer_block = mesh%n_cells + layer
   end function layer_block

   !> The block with the jump at an end of a fracture cell. At the start it has the pressure on side
   !! +, at the end that on side -.
   elemental integer(ik) function end_block(mesh, cell, end)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell  !< fracture cell
      integer(ik), intent(in) :: end  !< 1 start, 2 end

      end_block = bulk_count(mesh) + 2*(cell - 1) + end
   end function end_block

   !> The fracture cell that a block beyond those of the cells belongs to.
   pure integer(ik) function fracture_cell_of_block(mesh, block)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: block

      fracture_cell_of_block = (block - bulk_count(mesh) + 1)/2
   end function fracture_cell_of_block

   !> The end of its fracture cell that such a block belongs to: 1 start, 2 end.
   pure integer(ik) function end_of_block(mesh, block)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: block

      end_of_block = 2 - mod(block - bulk_count(mesh), 2_ik)
   end function end_of_block

   !> Where a component of a block stands if all blocks are written one after another.
   elemental integer(ik) function at_component(block, component)
      integer(ik), intent(in) :: block
      integer(ik), intent(in) :: component  !< 1 x, 2 y, 3 pressure

      at_component = 3*(block - 1) + component
   end function at_component

end module coarse_layout
