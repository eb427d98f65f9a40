!> Unstructured grids as VTK's XML files (.vtu) with raw appended arrays, as VTK 9 and ParaView read
!! them.
!!
!! Layout: VTK User's Guide, "VTK XML Formats". Every array is preceded by its size in bytes as
!! UInt64, and its offset counts from the byte after the underscore. Reals are Float64: the values
!! read are exactly those computed. There are no arrays of strings, which simple readers do not
!! support.
module report_vtu
   use, intrinsic :: iso_fortran_env, only: int64, int8
   use base_buffer, only: newline, text_buffer_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: exact_text, integer_text
   use report_files, only: whole_file_t
   implicit none(type, external)
   private

   public :: vtk_line, vtk_quadratic_triangle, vtk_triangle, vtk_vertex, vtu_grid_t

   integer(int8), parameter :: vtk_vertex = 1_int8  !< one node
   integer(int8), parameter :: vtk_line = 3_int8  !< two nodes
   integer(int8), parameter :: vtk_triangle = 5_int8  !< three nodes, counter-clockwise
   !> six nodes: corners counter-clockwise, then those on the edges from each to the next
   integer(int8), parameter :: vtk_quadratic_triangle = 22_int8

   !> A field with a value, or several components, in each cell or at each point.
   type :: vtu_field_t
      character(len=:), allocatable :: name
      character(len=:), allocatable :: components  !< XML attributes of the components; may be empty
      character(len=:), allocatable :: unit  !< unallocated: none
      logical :: at_points = .false.  !< values at points, and not in cells
      real(rk), allocatable :: reals(:)  !< all components of the first cell, of the second, ...
      integer(ik), allocatable :: integers(:)  !< values of an integer field instead of reals
   end type vtu_field_t

   !> A grid with its fields.
   type :: vtu_grid_t
      private
      real(rk), allocatable :: points(:)  !< x, y, 0 of each point [m]
      integer(ik), allocatable :: connectivity(:)  !< from 0
      integer(ik) :: nodes_per_cell = 0
      integer(ik) :: n_cells = 0
      integer(int8) :: cell_type = 0_int8
      real(rk) :: time = 0.0_rk  !< [s]
      integer(ik), public :: history_row = 0  !< of history.csv, for the same state, from 1; 0: none
      type(vtu_field_t), allocatable :: fields(:)
      integer :: n_fields = 0
   contains
      procedure :: begin
      procedure, private :: add_scalar
      procedure, private :: add_vector
      procedure, private :: add_integer
      generic :: add => add_scalar, add_vector, add_integer
      procedure :: add_at_points
      procedure :: set_units
      procedure :: write => write_grid
   end type vtu_grid_t

   !> The XML before the raw arrays, as far as it has been written.
   type :: header_t
      type(text_buffer_t) :: buffer
      integer(int64) :: offset = 0_int64  !< of the next array, from the byte after the underscore
   contains
      procedure :: line
      procedure :: fields
      procedure :: array
   end type header_t

contains

   !> Begin a grid of cells of one kind.
   subroutine begin(self, xy, cells, cell_type, time)
      class(vtu_grid_t), intent(out) :: self
      real(rk), intent(in) :: xy(:, :)  !< (2, n_points) [m]
      integer(ik), intent(in) :: cells(:, :)  !< (nodes per cell, n_cells) from 1
      integer(int8), intent(in) :: cell_type  !< vtk_vertex .. vtk_quadratic_triangle
      real(rk), intent(in) :: time  !< [s]
      integer :: i

      allocate (self%points(3*size(xy, 2)), source=0.0_rk)
      do i = 1, size(xy, 2)
         self%points(3*i - 2:3*i - 1) = xy(:, i)
      end do
      self%nodes_per_cell = size(cells, 1, ik)
      self%n_cells = size(cells, 2, ik)
      self%connectivity = reshape(cells - 1_ik, [size(cells)])
      self%cell_type = cell_type
      self%time = time
      allocate (self%fields(16))
   end subroutine begin

   !> A number in each cell; no field without values.
   subroutine add_scalar(self, name, values)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(in), optional :: values(:)  !< (n_cells) [SI]

      if (.not. present(values)) return
      call new_field(self, name)
      self%fields(self%n_fields)%reals = values
   end subroutine add_scalar

   !> Several numbers in each cell.
   subroutine add_vector(self, name, values, components)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: values(:, :)  !< (n_components, n_cells) [SI]
      character(len=*), intent(in) :: components(:)  !< their names, in order
      integer :: i

      call new_field(self, name)
      associate (field => self%fields(self%n_fields))
         field%reals = reshape(values, [size(values)])
         field%components = ' NumberOfComponents="'//integer_text(size(values, 1, ik))//'"'
         do i = 1, size(components)
            field%components = field%components//" ComponentName"//integer_text(int(i - 1, ik))// &
               & '="'//trim(components(i))//'"'
         end do
      end associate
   end subroutine add_vector

   !> Several numbers at each point.
   subroutine add_at_points(self, name, values, components)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: values(:, :)  !< (n_components, n_points) [SI]
      character(len=*), intent(in) :: components(:)  !< their names, in order

      call self%add(name, values, components)
      self%fields(self%n_fields)%at_points = .true.
   end subroutine add_at_points

   !> An integer in each cell.
   subroutine add_integer(self, name, values)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: values(:)  !< (n_cells)

      call new_field(self, name)
      self%fields(self%n_fields)%integers = values
   end subroutine add_integer

   !> Set the units of the fields added so far, VTK's key UNITS_LABEL.
   pure subroutine set_units(self, names, units)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: names(:)  !< names of fields, some of which may be absent
      character(len=*), intent(in) :: units(:)  !< unit of each; `-`: none
      integer :: i, k

      do i = 1, self%n_fields
         do k = 1, size(names)
            if (self%fields(i)%name /= names(k) .or. units(k) == "-") cycle
            self%fields(i)%unit = trim(units(k))
         end do
      end do
   end subroutine set_units

   !> Write the file.
   subroutine write_grid(self, path, error)
      class(vtu_grid_t), intent(in) :: self
      character(len=*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      type(whole_file_t) :: file
      integer(ik) :: i

      call file%open(path)
      call file%put(header_text(self))
      call put_reals(file, self%points)
      call put_integers(file, self%connectivity)
      call put_integers(file, [(i*self%nodes_per_cell, i=1, self%n_cells)])
      call file%put(int(self%n_cells, int64))
      call file%put(spread(self%cell_type, 1, int(self%n_cells)))
      call put_fields(file, self, .true.)
      call put_fields(file, self, .false.)
      call file%put(newline//"  </AppendedData>"//newline//"</VTKFile>"//newline)
      call file%commit(error)
   end subroutine write_grid

   !> The values of the fields at points, or of those in cells.
   subroutine put_fields(file, self, at_points)
      type(whole_file_t), intent(inout) :: file
      type(vtu_grid_t), intent(in) :: self
      logical, intent(in) :: at_points
      integer :: i

      do i = 1, self%n_fields
         if (self%fields(i)%at_points .neqv. at_points) cycle
         if (allocated(self%fields(i)%reals)) then
            call put_reals(file, self%fields(i)%reals)
         else
            call put_integers(file, self%fields(i)%integers)
         end if
      end do
   end subroutine put_fields

   !> The XML before the raw arrays, with the offset of each of them.
   function header_text(self) result(xml)
      type(vtu_grid_t), intent(in) :: self
      character(len=:), allocatable :: xml
      type(header_t) :: header

      call header%line('<?xml version="1.0"?>')
      call header%line('<VTKFile type="UnstructuredGrid" version="1.0" byte_order="'// &
         & byte_order()//'" header_type="UInt64">')
      call header%line("  <UnstructuredGrid>")
      call header%line('    <FieldData><DataArray type="Float64" Name="TimeValue" '// &
         & 'NumberOfTuples="1" format="ascii">'//exact_text(self%time)//"</DataArray>"// &
         & state_number(self)//"</FieldData>")
      call header%line('    <Piece NumberOfPoints="'// &
         & integer_text(size(self%points, kind=ik)/3_ik)//'" NumberOfCells="'// &
         & integer_text(self%n_cells)//'">')
      call header%line("      <Points>")
      call header%array("Float64", "Points", ' NumberOfComponents="3"', 8*size(self%points), "m")
      call header%line("      </Points>")
      call header%line("      <Cells>")
      call header%array("Int32", "connectivity", "", 4*size(self%connectivity))
      call header%array("Int32", "offsets", "", 4*int(self%n_cells))
      call header%array("UInt8", "types", "", int(self%n_cells))
      call header%line("      </Cells>")
      call header%line("      <PointData>")
      call header%fields(self, .true.)
      call header%line("      </PointData>")
      call header%line("      <CellData>")
      call header%fields(self, .false.)
      call header%line("      </CellData>")
      call header%line("    </Piece>")
      call header%line("  </UnstructuredGrid>")
      call header%line('  <AppendedData encoding="raw">')
      xml = header%buffer%text()//"   _"
   end function header_text

   !> Add a line.
   subroutine line(self, text)
      class(header_t), intent(inout) :: self
      character(len=*), intent(in) :: text

      call self%buffer%append(text//newline)
   end subroutine line

   !> Add the fields at points, or those in cells, in the order of put_fields.
   subroutine fields(self, grid, at_points)
      class(header_t), intent(inout) :: self
      type(vtu_grid_t), intent(in) :: grid
      logical, intent(in) :: at_points
      integer :: i

      do i = 1, grid%n_fields
         associate (field => grid%fields(i))
            if (field%at_points .neqv. at_points) cycle
            if (allocated(field%reals)) then
               call self%array("Float64", field%name, field%components, 8*size(field%reals), &
                               field%unit)
            else
               call self%array("Int32", field%name, "", 4*size(field%integers))
            end if
         end associate
      end do
   end subroutine fields

   !> Add the element of an array, which begins at the present offset.
   subroutine array(self, type_name, name, attributes, n_bytes, unit)
      class(header_t), intent(inout) :: self
      character(len=*), intent(in) :: type_name, name, attributes
      integer, intent(in) :: n_bytes  !< of the values; 8 more hold their number
      character(len=*), intent(in), optional :: unit
      character(len=:), allocatable :: ending

      ending = "/>"
      if (present(unit)) ending = '><InformationKey name="UNITS_LABEL" '// &
         & 'location="vtkDataArray">'//unit//"</InformationKey></DataArray>"
      call self%line('        <DataArray type="'//type_name//'" Name="'//name//'"'//attributes// &
         & ' format="appended" offset="'//integer_text(self%offset)//'"'//ending)
      self%offset = self%offset + 8_int64 + int(n_bytes, int64)
   end subroutine array

   !> The row of history.csv as field data.
   pure function state_number(self) result(xml)
      class(vtu_grid_t), intent(in) :: self
      character(len=:), allocatable :: xml

      xml = ""
      if (self%history_row == 0) return
      xml = '<DataArray type="Int32" Name="history_row" NumberOfTuples="1" format="ascii">'// &
            integer_text(self%history_row)//"</DataArray>"
   end function state_number

   !> Add a field without values.
   subroutine new_field(self, name)
      class(vtu_grid_t), intent(inout) :: self
      character(len=*), intent(in) :: name

      if (self%n_fields == size(self%fields)) self%fields = [self%fields, self%fields]
      self%n_fields = self%n_fields + 1
      self%fields(self%n_fields) = vtu_field_t(name=name, components="")
   end subroutine new_field

   !> Write an array of reals after its size.
   subroutine put_reals(file, values)
      type(whole_file_t), intent(inout) :: file
      real(rk), intent(in) :: values(:)  !< [SI]

      call file%put(8_int64*size(values, kind=int64))
      call file%put(values)
   end subroutine put_reals

   !> Write an array of integers after its size.
   subroutine put_integers(file, values)
      type(whole_file_t), intent(inout) :: file
      integer(ik), intent(in) :: values(:)

      call file%put(4_int64*size(values, kind=int64))
      call file%put(values)
   end subroutine put_integers

   !> Byte order of this machine.
   pure function byte_order() result(name)
      character(len=:), allocatable :: name
      integer(int8) :: bytes(4)

      bytes = transfer(1_ik, bytes)
      if (bytes(1) == 1_int8) then
         name = "LittleEndian"
      else
         name = "BigEndian"
      end if
   end function byte_order

end module report_vtu
