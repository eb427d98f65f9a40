!> Fields at written times: a VTU file for each dimension, gathered in PVD collections.
!! output_columns says what the fields mean.
module output_snapshots
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_texts, only: text_t
   use mesh_types, only: fracture_mesh_t, mesh_t
   use output_tensors, only: displacement_3d, permeability_tensor, stress_tensor, &
                             tensor_components
   use results_fields, only: fracture_fields_t, intersection_fields_t, matrix_fields_t
   use output_columns, only: fracture_fields, intersection_fields, matrix_fields
   use output_files, only: make_directory, remove_file
   use output_pvd, only: collection_t
   use output_vtu, only: vtk_line, vtk_quadratic_triangle, vtk_triangle, vtk_vertex, vtu_grid_t
   use scene_types, only: material_t, scene_t
   implicit none(type, external)
   private

   public :: snapshots_t

   character(len=*), parameter :: folder = "vtu"  !< of the VTU files, in the run's directory
   character(len=*), parameter :: dimension_names(3) = [character(len=13) :: "matrix", &
      & "fractures", "intersections"]

   !> The snapshots of a run.
   type :: snapshots_t
      integer :: n_written = 0  !< times
      character(len=:), allocatable, private :: directory
      type(material_t), private :: material
      type(collection_t), private :: collections(3)
      logical, private :: counts = .false.  !< in these stand rows of the history, and not times
   contains
      procedure :: open => open_snapshots
      procedure :: write => write_snapshot
      procedure :: list_files
      procedure :: flush => flush_snapshots
   end type snapshots_t

contains

   !> Begin; the files of an earlier run in the same directory are removed.
   subroutine open_snapshots(self, directory, scene, error)
      class(snapshots_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      self%directory = directory
      self%counts = allocated(scene%load%factors)
      self%material = scene%material
      call remove_earlier(directory)
      do i = 1, 3
         call self%collections(i)%open(directory//"/"//trim(dimension_names(i))//".pvd", &
                                       is_falling=scene%load%to < scene%load%from .and. &
                                       .not. self%counts)
      end do
      if (scene%output%vtu) call make_directory(directory//"/"//folder, error)
   end subroutine open_snapshots

   !> Write the fields of a state.
   subroutine write_snapshot(self, time, history_row, mesh, matrix, fracture, intersections, error)
      class(snapshots_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      integer(ik), intent(in) :: history_row  !< with the same state, from 1
      type(mesh_t), intent(in) :: mesh
      type(matrix_fields_t), intent(in) :: matrix
      type(fracture_fields_t), intent(in) :: fracture
      type(intersection_fields_t), intent(in) :: intersections  !< may be empty
      type(error_t), allocatable, intent(out) :: error
      type(vtu_grid_t) :: grid

      call fill_matrix(grid, time, mesh, matrix, self%material)
      call write_one(self, 1, time, history_row, grid, error)
      if (.not. allocated(error) .and. mesh%fracture%n_cells > 0) then
         call fill_fractures(grid, time, mesh%fracture, fracture)
         call write_one(self, 2, time, history_row, grid, error)
      end if
      if (.not. allocated(error) .and. allocated(intersections%point)) then
         if (size(intersections%point) > 0) then
            call fill_intersections(grid, time, mesh%fracture, intersections)
            call write_one(self, 3, time, history_row, grid, error)
         end if
      end if
      if (.not. allocated(error)) self%n_written = self%n_written + 1
   end subroutine write_snapshot

   !> Write the collections that have changed.
   subroutine flush_snapshots(self, error)
      class(snapshots_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, 3
         call self%collections(i)%flush(error)
         if (allocated(error)) return
      end do
   end subroutine flush_snapshots

   !> Paths of the VTU files of the rock that were written, from the run's directory.
   pure subroutine list_files(self, paths)
      class(snapshots_t), intent(in) :: self
      type(text_t), allocatable, intent(out) :: paths(:)
      integer :: n

      allocate (paths(self%n_written))
      do n = 1, self%n_written
         paths(n)%text = file_name(1, n - 1)
      end do
   end subroutine list_files

   !> Write one grid and add it to its collection.
   subroutine write_one(self, i, time, history_row, grid, error)
      class(snapshots_t), intent(inout) :: self
      integer, intent(in) :: i  !< index of the dimension
      real(rk), intent(in) :: time  !< [s]
      integer(ik), intent(in) :: history_row
      type(vtu_grid_t), intent(inout) :: grid
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: file
      real(rk) :: listed

      listed = time
      if (self%counts) listed = real(history_row, rk)
      call grid%set_history_row(history_row)
      file = file_name(i, self%n_written)
      call grid%write(self%directory//"/"//file, error)
      if (.not. allocated(error)) call self%collections(i)%add(listed, file)
   end subroutine write_one

   subroutine fill_matrix(grid, time, mesh, fields, material)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(mesh_t), intent(in) :: mesh
      type(matrix_fields_t), intent(in) :: fields
      type(material_t), intent(in) :: material

      if (allocated(fields%cell_nodes)) then
         call grid%begin(fields%node_xy, fields%cell_nodes, vtk_quadratic_triangle, time)
      else
         call grid%begin(mesh%xy, mesh%cell_nodes, vtk_triangle, time)
      end if
      if (allocated(fields%node_displacement)) then
         call grid%add_at_points("nodal_displacement", displacement_3d(fields%node_displacement), &
                                 ["X", "Y", "Z"])
      end if
      if (allocated(fields%displacement)) then
         call grid%add("displacement", displacement_3d(fields%displacement), ["X", "Y", "Z"])
      end if
      if (allocated(fields%pressure)) call grid%add("pressure", fields%pressure)
      if (allocated(fields%stress)) then
         call grid%add("stress", stress_tensor(fields, material), tensor_components)
      end if
      if (allocated(fields%pressure)) then
         call grid%add("permeability", permeability_tensor(fields, material, mesh), &
            & tensor_components)
      end if
      call grid%set_units(matrix_fields%name, matrix_fields%unit)
   end subroutine fill_matrix

   subroutine fill_fractures(grid, time, mesh, fields)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: mesh
      type(fracture_fields_t), intent(in) :: fields

      call grid%begin(mesh%point_xy, mesh%cell_points, vtk_line, time)
      call grid%add("fracture", mesh%cell_fracture)
      call grid%add("arc_length", 0.5_rk*(mesh%cell_s(1, :) + mesh%cell_s(2, :)))
      if (allocated(fields%aperture)) call grid%add("aperture", fields%aperture)
      if (allocated(fields%jump_n)) call add_pair(grid, "jump", fields%jump_n, fields%jump_t)
      if (allocated(fields%traction_n)) then
         call add_pair(grid, "traction", fields%traction_n, fields%traction_t)
      end if
      if (allocated(fields%pressure)) call grid%add("pressure", fields%pressure)
      if (allocated(fields%flow)) call grid%add("flow", fields%flow)
      if (allocated(fields%state)) call grid%add("state", fields%state)
      call grid%set_units(fracture_fields%name, fracture_fields%unit)
   end subroutine fill_fractures

   subroutine fill_intersections(grid, time, mesh, fields)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: mesh
      type(intersection_fields_t), intent(in) :: fields
      integer(ik) :: vertices(1, size(fields%point)), i

      vertices(1, :) = [(i, i=1, size(fields%point, kind=ik))]
      call grid%begin(mesh%point_xy(:, fields%point), vertices, vtk_vertex, time)
      if (allocated(fields%pressure)) call grid%add("pressure", fields%pressure)
      call grid%set_units(intersection_fields%name, intersection_fields%unit)
   end subroutine fill_intersections

   !> A normal and a tangential component as one field.
   subroutine add_pair(grid, name, normal, tangential)
      type(vtu_grid_t), intent(inout) :: grid
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: normal(:), tangential(:)  !< (n_cells) [m] or [Pa]
      real(rk) :: both(2, size(normal))

      both(1, :) = normal
      both(2, :) = tangential
      call grid%add(name, both, [character(len=10) :: "normal", "tangential"])
   end subroutine add_pair

   !> Remove the snapshots of an earlier run, the last one first so that an interrupted removal can
   !! go on.
   subroutine remove_earlier(directory)
      character(len=*), intent(in) :: directory
      logical :: was_there
      integer :: n, i

      do i = 1, 3
         call remove_file(directory//"/"//trim(dimension_names(i))//".pvd", was_there)
      end do
      n = 0
      do
         inquire (file=directory//"/"//file_name(1, n), exist=was_there)
         if (.not. was_there) exit
         n = n + 1
      end do
      do n = n, 0, -1
         do i = 3, 1, -1
            call remove_file(directory//"/"//file_name(i, n), was_there)
            call remove_file(directory//"/"//file_name(i, n)//".part", was_there)
         end do
      end do
   end subroutine remove_earlier

   !> Path of a VTU file from the run's directory.
   pure function file_name(i, number) result(file)
      integer, intent(in) :: i  !< index of the dimension
      integer, intent(in) :: number  !< of the written time, from 0
      character(len=:), allocatable :: file
      character(len=10) :: digits

      write (digits, "(i6.6)") number
      file = folder//"/"//trim(dimension_names(i))//"_"//trim(digits)//".vtu"
   end function file_name

end module output_snapshots
