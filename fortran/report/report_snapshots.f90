!> Fields at written times: a VTU file for each dimension, with the components that ParaView
!! expects, and collections of them (.pvd). report_keys defines the fields.
!!
!! ParaView expects times in increasing order, and shows files of equal time on top of one another.
!! So states of equal time have consecutive numbers, and those of a falling load have the last state
!! first.
module report_snapshots
   use base_archive, only: archive_t
   use base_buffer, only: newline, text_buffer_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: exact_text
   use base_texts, only: text_t
   use mesh_types, only: fracture_mesh_t, mesh_t
   use report_keys, only: fracture_fields, intersection_fields, matrix_fields, window_fields
   use report_files, only: copy_file, make_directory, remove_file, write_text_file
   use report_rows, only: fracture_fields_t, intersection_fields_t, matrix_fields_t
   use report_simulation, only: snapshot_t
   use report_vtu, only: vtk_line, vtk_quadratic_triangle, vtk_triangle, vtk_vertex, vtu_grid_t
   use scene_types, only: material_t, scene_t
   implicit none(type, external)
   private

   public :: collection_t, snapshots_t

   character(len=*), parameter :: folder = "vtu"  !< folder of the VTU files in the run's directory
   character(len=*), parameter :: dimension_names(4) = [character(len=13) :: "matrix", &
      & "fractures", "intersections", "windows"]

   !> One collection, of complete files only.
   type :: collection_t
      integer :: n_files = 0
      character(len=:), allocatable, private :: path
      logical, private :: is_falling = .false.  !< times decrease
      real(rk), private :: last = 0.0_rk  !< last time in the collection
      type(text_buffer_t), private :: entries  !< lines, in the order of the run
      integer, private :: written = 0  !< number of files in the collection on disk
   contains
      procedure :: open => open_collection
      procedure :: add
      procedure :: flush => flush_collection
   end type collection_t

   !> The snapshots of a run.
   type :: snapshots_t
      integer :: n_written = 0  !< number of written times
      character(len=:), allocatable, private :: directory
      type(material_t), private :: material
      type(collection_t), private :: collections(size(dimension_names))
      logical, private :: counts = .false.  !< times of collections are rows of history.csv
   contains
      procedure :: open => open_snapshots
      procedure :: write => write_snapshot
      procedure :: make_folder
      procedure :: clear
      procedure :: copy_from
      procedure :: list_files
      procedure :: visit
      procedure :: visit_text
      procedure :: flush => flush_snapshots
   end type snapshots_t

   !> Symmetric tensors in ParaView's order.
   character(len=2), parameter :: tensor_components(6) = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]

contains

   !> Begin.
   subroutine open_snapshots(self, directory, scene)
      class(snapshots_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene
      integer :: i

      self%directory = directory
      self%counts = allocated(scene%load%factors)
      self%material = scene%material
      do i = 1, size(dimension_names)
         call self%collections(i)%open(directory//"/"//trim(dimension_names(i))//".pvd", &
                                       is_falling=scene%load%to < scene%load%from .and. &
                                       .not. self%counts)
      end do
   end subroutine open_snapshots

   !> Make the folder of the VTU files.
   subroutine make_folder(self, error)
      class(snapshots_t), intent(in) :: self
      type(error_t), allocatable, intent(out) :: error

      call make_directory(self%directory//"/"//folder, error)
   end subroutine make_folder

   !> Copy the files written so far from another run's directory.
   subroutine copy_from(self, origin, error)
      class(snapshots_t), intent(in) :: self
      character(len=*), intent(in) :: origin
      type(error_t), allocatable, intent(out) :: error
      logical :: exists
      integer :: i, n

      do n = 0, self%n_written - 1
         do i = 1, size(dimension_names)
            inquire (file=origin//"/"//file_name(i, n), exist=exists)
            if (.not. exists) cycle
           call copy_file(origin//"/"//file_name(i, n), self%directory//"/"//file_name(i, n), error)
            if (allocated(error)) return
         end do
      end do
   end subroutine copy_from

   !> Write the fields of a state: a file for each dimension that it has.
   subroutine write_snapshot(self, fields, history_row, error)
      class(snapshots_t), intent(inout) :: self
      type(snapshot_t), intent(in) :: fields
      integer(ik), intent(in) :: history_row  !< of the same state, from 1
      type(error_t), allocatable, intent(out) :: error
      type(vtu_grid_t) :: grid

      call fill_matrix(grid, fields%time, fields%mesh, fields%matrix, self%material)
      call write_one(self, 1, fields%time, history_row, grid, error)
      if (.not. allocated(error) .and. fields%mesh%fracture%n_cells > 0) then
         call fill_fractures(grid, fields%time, fields%mesh%fracture, fields%fracture)
         call write_one(self, 2, fields%time, history_row, grid, error)
      end if
      if (.not. allocated(error) .and. allocated(fields%intersection%point)) then
         if (size(fields%intersection%point) > 0) then
            call fill_intersections(grid, fields%time, fields%mesh%fracture, fields%intersection)
            call write_one(self, 3, fields%time, history_row, grid, error)
         end if
      end if
      if (.not. allocated(error) .and. allocated(fields%windows)) then
         call grid%begin(fields%windows%xy, fields%windows%cell_nodes, vtk_triangle, fields%time)
         call grid%add("tip", fields%windows%tip)
         call grid%set_units(window_fields%name, window_fields%unit)
         call write_one(self, 4, fields%time, history_row, grid, error)
      end if
      if (.not. allocated(error)) self%n_written = self%n_written + 1
   end subroutine write_snapshot

   !> Write the collections that have changed.
   subroutine flush_snapshots(self, error)
      class(snapshots_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, size(dimension_names)
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
      grid%history_row = history_row
      file = file_name(i, self%n_written)
      call grid%write(self%directory//"/"//file, error)
      if (.not. allocated(error)) call self%collections(i)%add(listed, file)
   end subroutine write_one

   !> The grid of the rock.
   subroutine fill_matrix(grid, time, mesh, fields, material)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(mesh_t), intent(in) :: mesh
      type(matrix_fields_t), intent(in) :: fields
      type(material_t), intent(in) :: material
      real(rk), allocatable :: permeability(:, :)

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
      call grid%add("pressure", fields%pressure)
      if (allocated(fields%stress)) then
         call grid%add("stress", stress_tensor(fields, material), tensor_components)
      end if
      if (allocated(fields%pressure)) then
         permeability = spread([material%permeability_xx, material%permeability_yy, &
                                material%permeability_xy], 2, mesh%n_cells)
         if (allocated(fields%permeability)) permeability = fields%permeability
         call grid%add("permeability", in_plane(permeability), tensor_components)
      end if
      call grid%add("displacement_error", fields%displacement_error)
      call grid%add("pressure_error", fields%pressure_error)
      call grid%add("stress_error", fields%stress_error)
      call grid%add("temperature", fields%temperature)
      call grid%add("temperature_error", fields%temperature_error)
      call grid%set_units(matrix_fields%name, matrix_fields%unit)
   end subroutine fill_matrix

   !> The grid of the fractures.
   subroutine fill_fractures(grid, time, mesh, fields)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: mesh
      type(fracture_fields_t), intent(in) :: fields

      call grid%begin(mesh%point_xy, mesh%cell_points, vtk_line, time)
      call grid%add("fracture", mesh%cell_fracture)
      call grid%add("arc_length", 0.5_rk*(mesh%cell_s(1, :) + mesh%cell_s(2, :)))
      call grid%add("aperture", fields%aperture)
      call add_pair(grid, "jump", fields%jump_n, fields%jump_t)
      call add_pair(grid, "traction", fields%traction_n, fields%traction_t)
      call grid%add("pressure", fields%pressure)
      call grid%add("flow", fields%flow)
      if (allocated(fields%state)) call grid%add("state", fields%state)
      associate (error => fields%error)
         if (allocated(fields%aperture)) call grid%add("aperture_error", error%jump_n)
         call add_pair(grid, "jump_error", error%jump_n, error%jump_t)
         call add_pair(grid, "traction_error", error%traction_n, error%traction_t)
         call grid%add("pressure_error", error%pressure)
         call grid%add("flow_error", error%flow)
      end associate
      call grid%add("temperature", fields%temperature)
      call grid%add("temperature_error", fields%error%temperature)
      call grid%set_units(fracture_fields%name, fracture_fields%unit)
   end subroutine fill_fractures

   !> The grid of the intersections.
   subroutine fill_intersections(grid, time, mesh, fields)
      type(vtu_grid_t), intent(out) :: grid
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: mesh
      type(intersection_fields_t), intent(in) :: fields
      integer(ik) :: vertices(1, size(fields%point)), i

      vertices(1, :) = [(i, i=1, size(fields%point, kind=ik))]
      call grid%begin(mesh%point_xy(:, fields%point), vertices, vtk_vertex, time)
      call grid%add("pressure", fields%pressure)
      call grid%add("pressure_error", fields%pressure_error)
      call grid%set_units(intersection_fields%name, intersection_fields%unit)
   end subroutine fill_intersections

   !> A normal and a tangential component as one field; none without values.
   subroutine add_pair(grid, name, normal, tangential)
      type(vtu_grid_t), intent(inout) :: grid
      character(len=*), intent(in) :: name
      real(rk), intent(in), optional :: normal(:), tangential(:)  !< (n_cells) [m] or [Pa]

      if (.not. present(normal)) return
      call grid%add(name, transpose(reshape([normal, tangential], [size(normal), 2])), &
                    [character(len=10) :: "normal", "tangential"])
   end subroutine add_pair

   !> Remove snapshots of an earlier run, the last one first, so that an interrupted removal can be
   !! continued.
   subroutine clear(self, first)
      class(snapshots_t), intent(in) :: self
      integer, intent(in) :: first  !< number of the first file that is removed
      logical :: was_there
      integer :: n, i

      associate (directory => self%directory)
         do i = 1, size(dimension_names)
            if (first == 0) call remove_file(directory//"/"//trim(dimension_names(i))//".pvd", &
                                             was_there)
         end do
         n = first
         do
            inquire (file=directory//"/"//file_name(1, n), exist=was_there)
            if (.not. was_there) exit
            n = n + 1
         end do
         do n = n, first, -1
            do i = size(dimension_names), 1, -1
               call remove_file(directory//"/"//file_name(i, n), was_there)
               call remove_file(directory//"/"//file_name(i, n)//".part", was_there)
            end do
         end do
      end associate
   end subroutine clear

   !> Path of a VTU file from the run's directory.
   pure function file_name(i, number) result(file)
      integer, intent(in) :: i  !< index of the dimension
      integer, intent(in) :: number  !< of the written time, from 0
      character(len=:), allocatable :: file
      character(len=10) :: digits

      write (digits, "(i6.6)") number
      file = folder//"/"//trim(dimension_names(i))//"_"//trim(digits)//".vtu"
   end function file_name

   !> Displacement with a z component, as VTK requires.
   pure function displacement_3d(displacement) result(u)
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_cells or n_nodes) [m]
      real(rk) :: u(3, size(displacement, 2))

      u(1:2, :) = displacement
      u(3, :) = 0.0_rk
   end function displacement_3d

   !> Total stress as a symmetric tensor; zz follows from the plane state.
   !!
   !! Plane strain: effective stress obeys sigma'_zz = nu (sigma'_xx + sigma'_yy) with sigma' =
   !! sigma + alpha p, so that sigma_zz = nu (sigma_xx + sigma_yy) - (1 - 2 nu) alpha p. Plane
   !! stress: sigma_zz = 0.
   pure function stress_tensor(fields, material) result(stress)
      type(matrix_fields_t), intent(in) :: fields
      type(material_t), intent(in) :: material
      real(rk) :: stress(6, size(fields%stress, 2))  !< xx, yy, zz, xy, yz, xz [Pa]
      real(rk), dimension(size(fields%stress, 2)) :: biot, poisson

      stress = in_plane(fields%stress)
      if (material%plane_stress) return
      poisson = material%poisson
      biot = material%biot
      if (allocated(fields%poisson)) poisson = fields%poisson
      if (allocated(fields%biot)) biot = fields%biot
      stress(3, :) = poisson*(fields%stress(1, :) + fields%stress(2, :))
      if (allocated(fields%pressure)) then
         stress(3, :) = stress(3, :) - (1.0_rk - 2.0_rk*poisson)*biot*fields%pressure
      end if
   end function stress_tensor

   !> A symmetric tensor in the plane with the other components, which are 0.
   pure function in_plane(plane) result(tensor)
      real(rk), intent(in) :: plane(:, :)  !< (xx yy xy, n_cells) [any unit]
      real(rk) :: tensor(6, size(plane, 2))  !< xx, yy, zz, xy, yz, xz

      tensor = 0.0_rk
      tensor([1, 2, 4], :) = plane
   end function in_plane

   !> Begin a collection; it is on disk only once it has a file.
   subroutine open_collection(self, path, is_falling)
      class(collection_t), intent(out) :: self
      character(len=*), intent(in) :: path
      logical, intent(in), optional :: is_falling  !< times decrease; default: they increase

      self%path = path
      if (present(is_falling)) self%is_falling = is_falling
   end subroutine open_collection

   !> Add a file. Its time in the collection is at least the number next to the time before.
   subroutine add(self, time, file)
      class(collection_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: file  !< path from the collection's directory
      real(rk) :: listed

      listed = time
      if (self%n_files > 0 .and. self%is_falling) then
         listed = min(time, nearest(self%last, -1.0_rk))
      else if (self%n_files > 0) then
         listed = max(time, nearest(self%last, 1.0_rk))
      end if
      call self%entries%append('    <DataSet timestep="'//exact_text(listed)// &
                               '" part="0" file="'//file//'"/>'//newline)
      self%last = listed
      self%n_files = self%n_files + 1
   end subroutine add

   !> Write the collection whole, if it has changed.
   subroutine flush_collection(self, error)
      class(collection_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: lines

      if (self%n_files == self%written) return
      lines = self%entries%text()
      if (self%is_falling) lines = last_first(lines)
      call write_text_file(self%path, &
                           '<?xml version="1.0"?>'//newline// &
                           '<VTKFile type="Collection" version="1.0">'//newline// &
                           "  <Collection>"//newline//lines// &
                           "  </Collection>"//newline//"</VTKFile>"//newline, error)
      if (.not. allocated(error)) self%written = self%n_files
   end subroutine flush_collection

   !> The lines of a text in reverse order.
   pure function last_first(text) result(reversed)
      character(len=*), intent(in) :: text  !< whole lines
      character(len=len(text)) :: reversed
      integer :: first, last, done

      done = 0
      last = len(text)
      do while (last > 0)
         first = index(text(:last - 1), newline, back=.true.) + 1
         reversed(done + 1:done + last - first + 1) = text(first:last)
         done = done + last - first + 1
         last = first - 1
      end do
   end function last_first

   !> Store or load the collections; the files themselves stay where they are.
   subroutine visit(self, archive)
      class(snapshots_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer :: i

      call archive%item("n_written", self%n_written)
      do i = 1, size(self%collections)
         associate (collection => self%collections(i))
            call archive%item("n_files", collection%n_files)
            call archive%item("last", collection%last)
            call collection%entries%visit(archive)
            if (min(collection%n_files, self%n_written) < 0 .or. &
                max(collection%n_files, self%n_written) > collection%entries%length) then
               if (i == 1) call archive%set_fault("n_written")
            end if
            if (archive%is_loading) collection%written = 0
         end associate
      end do
   end subroutine visit

   !> Store or load their texts.
   subroutine visit_text(self, archive)
      class(snapshots_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer :: i

      do i = 1, size(self%collections)
         call self%collections(i)%entries%visit_text(archive)
      end do
   end subroutine visit_text

end module report_snapshots
