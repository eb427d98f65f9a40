!> Fracture cells of a coarse mesh that replace cells of the mesh before. A joint divides a cell, or
!! moves a node between two cells; all other cells are unchanged.
module twolevel_overlaps
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use coarse_layer_profiles, only: kept_faces_t
   use mesh_types, only: fracture_mesh_t
   implicit none(type, external)
   private

   public :: fracture_overlaps, kept_faces, overlaps_t

   !> Old cells that each new cell overlaps, in their order along the fracture.
   type :: overlaps_t
      integer(ik), allocatable :: first(:)  !< (new cells + 1) index into `old` and `length`
      integer(ik), allocatable :: old(:)
      real(rk), allocatable :: length(:)  !< length of the overlap [m]
   contains
      procedure :: is_new
      procedure :: is_whole
      procedure :: main
      procedure :: mean
   end type overlaps_t

contains

   !> Find the overlaps from the arc lengths of the cells.
   pure function fracture_overlaps(before, after) result(overlaps)
      type(fracture_mesh_t), intent(in) :: before, after
      type(overlaps_t) :: overlaps
      real(rk) :: length, shared(before%n_cells)
      integer(ik), allocatable :: found(:)
      integer(ik) :: i, j

      allocate (overlaps%first(after%n_cells + 1), source=1_ik)
      allocate (overlaps%old(0), overlaps%length(0))
      do i = 1, after%n_cells
         associate (s => after%cell_s(:, i))
            length = s(2) - s(1)
            shared = min(s(2), before%cell_s(2, :)) - max(s(1), before%cell_s(1, :))
            found = pack([(j, j=1, before%n_cells)], &
                         before%cell_fracture == after%cell_fracture(i) .and. &
                         shared > same_place*length)
         end associate
         overlaps%old = [overlaps%old, found]
         overlaps%length = [overlaps%length, shared(found)]
         overlaps%first(i + 1) = size(overlaps%old, kind=ik) + 1
      end do
   end function fracture_overlaps

   !> Faces of fracture cells before that those of a new mesh consist of.
   pure function kept_faces(before, after) result(faces)
      type(fracture_mesh_t), intent(in) :: before, after
      type(kept_faces_t) :: faces
      type(overlaps_t) :: overlaps
      integer(ik) :: c, k

      overlaps = fracture_overlaps(before, after)
      faces%before%first = overlaps%first
      faces%before%item = overlaps%old
      faces%of_old = overlaps%length
      faces%of_new = overlaps%length
      do c = 1, after%n_cells
         do k = faces%before%first(c), faces%before%last(c)
            associate (old => before%cell_s(:, faces%before%item(k)), new => after%cell_s(:, c))
               faces%of_old(k) = min(1.0_rk, faces%of_old(k)/(old(2) - old(1)))
               faces%of_new(k) = min(1.0_rk, faces%of_new(k)/(new(2) - new(1)))
            end associate
         end do
      end do
   end function kept_faces

   !> Whether a cell overlaps no old cell: the cell has been added by growth.
   elemental logical function is_new(self, cell)
      class(overlaps_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      is_new = self%first(cell + 1) == self%first(cell)
   end function is_new

   !> Whether a cell equals an old cell, neither divided nor moved.
   pure logical function is_whole(self, cell, before, after)
      class(overlaps_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      type(fracture_mesh_t), intent(in) :: before, after

      is_whole = self%first(cell + 1) == self%first(cell) + 1
      if (.not. is_whole) return
      associate (s => after%cell_s(:, cell), old => before%cell_s(:, self%old(self%first(cell))))
         is_whole = all(abs(s - old) <= same_place*(s(2) - s(1)))
      end associate
   end function is_whole

   !> Old cell with the largest overlap; 0 for a cell added by growth.
   pure integer(ik) function main(self, cell)
      class(overlaps_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      main = 0
      associate (first => self%first(cell), last => self%first(cell + 1) - 1)
         if (last >= first) main = self%old(first - 1 + maxloc(self%length(first:last), dim=1))
      end associate
   end function main

   !> Mean of values of the old cells, weighted with the overlaps, for a cell that has some.
   pure real(rk) function mean(self, cell, values)
      class(overlaps_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: values(:)  !< (old cells)

      associate (first => self%first(cell), last => self%first(cell + 1) - 1)
         mean = sum(values(self%old(first:last))*self%length(first:last)) &
                /sum(self%length(first:last))
      end associate
   end function mean

end module twolevel_overlaps
