!> network.json: the fracture network at the end and at every time when it changed, and its joints.
!! report_keys defines its keys.
module report_network
   use base_archive, only: archive_t
   use base_buffer, only: newline, text_buffer_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_plane, only: norm2
   use base_texts, only: text_t
   use base_tolerances, only: same_place
   use mesh_archive, only: visit_fracture_mesh, visit_network
   use mesh_types, only: fracture_mesh_t, network_t, point_boundary, point_corner
   use report_files, only: write_text_file
   use report_json, only: json_t
   implicit none(type, external)
   private

   public :: network_record_t

   !> Names of the kinds of joints, point_boundary to point_corner.
   character(len=*), parameter :: joint_names(point_boundary:point_corner) = &
                                  [character(len=8) :: "boundary", "T", "X", "V"]

   !> A joint: a point where a fracture ends on, crosses or meets another, or ends on the outer
   !! boundary.
   type :: joint_t
      integer(ik) :: kind = 0  !< point_boundary .. point_corner
      real(rk) :: xy(2) = 0.0_rk  !< [m]
      real(rk) :: time = 0.0_rk  !< time of its first state [s]
      integer(ik), allocatable :: fractures(:)  !< fractures at the joint
   end type joint_t

   !> The network in all its states.
   type :: network_record_t
      character(len=:), allocatable, private :: path
      type(text_t), allocatable, private :: names(:)  !< of the fractures
      character(len=:), allocatable, private :: clock  !< key of the times
      type(network_t), private :: network  !< last state
      type(fracture_mesh_t), private :: mesh  !< last state
      !> (2, tips) fracture, end of initial tips
      integer(ik), allocatable, private :: tip_ends(:, :)
      type(joint_t), allocatable, private :: joints(:)
      type(text_buffer_t), private :: steps  !< JSON of the steps so far
      logical, private :: is_written = .true.
   contains
      procedure :: open => open_record
      procedure :: step
      procedure :: flush => flush_record
      procedure :: visit
      procedure :: visit_text
   end type network_record_t

contains

   !> Begin a record.
   subroutine open_record(self, path, names, has_fluid)
      class(network_record_t), intent(out) :: self
      character(len=*), intent(in) :: path
      type(text_t), intent(in) :: names(:)  !< of the fractures
      logical, intent(in) :: has_fluid  !< .false.: times are load factors

      self%clock = "load_factor"
      if (has_fluid) self%clock = "time_s"
      self%path = path
      self%names = names
      allocate (self%joints(0))
   end subroutine open_record

   !> Add the network at a time, if it has changed.
   subroutine step(self, time, network, mesh)
      class(network_record_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(network_t), intent(in) :: network
      type(fracture_mesh_t), intent(in) :: mesh  !< with kinds of points and tips
      type(json_t) :: json

      if (same_network(network, self%network) .and. self%steps%length > 0) return
      self%network = network
      self%mesh = mesh
      if (.not. allocated(self%tip_ends)) then
         self%tip_ends = reshape([mesh%tip_fracture, mesh%tip_end], [2_ik, mesh%n_tips], &
                                 order=[2, 1])
      end if
      call note_joints(self, time)
      json%one_line = .true.
      call json%begin_object("")
      call json%add(self%clock, time)
      call add_fractures(json, self)
      call add_tips(json, self)
      call json%end_object()
      if (self%steps%length > 0) call self%steps%append(",")
      call self%steps%append(newline//"    "//json%text())
      self%is_written = .false.
   end subroutine step

   !> Write the file whole, if the network has changed.
   subroutine flush_record(self, error)
      class(network_record_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(json_t) :: json
      integer :: i

      if (self%is_written) return
      call json%begin_object("")
      call add_fractures(json, self)
      call add_tips(json, self)
      call json%begin_array("joints")
      do i = 1, size(self%joints)
         call json%begin_object("")
         call json%add("kind", trim(joint_names(self%joints(i)%kind)))
         call json%add(self%clock, self%joints(i)%time)
         call json%add("x_m", self%joints(i)%xy(1))
         call json%add("y_m", self%joints(i)%xy(2))
         call json%add("fractures", self%joints(i)%fractures)
         call json%end_object()
      end do
      call json%end_array()
      call json%add_raw("steps", "["//self%steps%text()//newline//"  ]")
      call json%end_object()
      call write_text_file(self%path, json%text(), error)
      self%is_written = .not. allocated(error)
   end subroutine flush_record

   !> The polylines.
   subroutine add_fractures(json, record)
      type(json_t), intent(inout) :: json
      type(network_record_t), intent(in) :: record
      integer(ik) :: f

      call json%begin_array("fractures")
      associate (network => record%network)
         do f = 1, size(network%first, kind=ik) - 1_ik
            associate (xy => network%xy(:, network%first(f):network%first(f + 1) - 1))
               call json%begin_object("")
               call json%add("fracture", f)
               if (f <= size(record%names)) call json%add("name", record%names(f)%text)
               call json%add("length_m", sum(norm2(xy(:, 2:) - xy(:, :size(xy, 2) - 1), dim=1)))
               call json%add("s_start_m", network%s_start(f))
               call json%add("x_m", xy(1, :))
               call json%add("y_m", xy(2, :))
               call json%end_object()
            end associate
         end do
      end associate
      call json%end_array()
   end subroutine add_fractures

   !> The free tips, with their numbers from the start of the run.
   subroutine add_tips(json, record)
      type(json_t), intent(inout) :: json
      type(network_record_t), intent(in) :: record
      integer(ik) :: i

      call json%begin_array("tips")
      associate (mesh => record%mesh)
         do i = 1, mesh%n_tips
            call json%begin_object("")
            call json%add("tip", int(findloc(record%tip_ends(1, :) == mesh%tip_fracture(i) .and. &
                                             record%tip_ends(2, :) == mesh%tip_end(i), .true., &
                                             dim=1), ik))
            call json%add("fracture", mesh%tip_fracture(i))
            call json%add("end", trim(merge("start", "end  ", mesh%tip_end(i) == 1)))
            call json%add("x_m", mesh%point_xy(1, mesh%tip_point(i)))
            call json%add("y_m", mesh%point_xy(2, mesh%tip_point(i)))
            call json%add("direction", mesh%tip_direction(:, i))
            call json%end_object()
         end do
      end associate
      call json%end_array()
   end subroutine add_tips

   !> Update the joints; earlier ones keep their times.
   subroutine note_joints(self, time)
      class(network_record_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]

      type(joint_t), allocatable :: now(:)
      integer(ik) :: point
      integer :: i, n
      real(rk) :: same  ! distance of equal points [m]

      same = same_place*max(maxval(abs(self%network%xy)), tiny(1.0_rk))
      allocate (now(count(self%mesh%point_kind >= point_boundary)))
      n = 0
      do point = 1, self%mesh%n_points
         if (self%mesh%point_kind(point) < point_boundary) cycle
         n = n + 1
         now(n)%kind = self%mesh%point_kind(point)
         now(n)%xy = self%mesh%point_xy(:, point)
         now(n)%time = time
         now(n)%fractures = fractures_at(self%mesh, point)
         do i = 1, size(self%joints)
            if (self%joints(i)%kind == now(n)%kind .and. &
                norm2(self%joints(i)%xy - now(n)%xy) <= same) now(n)%time = self%joints(i)%time
         end do
      end do
      call move_alloc(now, self%joints)
   end subroutine note_joints

   !> The fractures that have cells at a point, each once.
   pure function fractures_at(mesh, point) result(fractures)
      type(fracture_mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: point
      integer(ik), allocatable :: fractures(:)
      integer(ik) :: i, f

      allocate (fractures(0))
      do i = 1, mesh%point_cells%length(point)
         f = mesh%cell_fracture(mesh%point_cells%at(point, i))
         if (.not. any(fractures == f)) fractures = [fractures, f]
      end do
   end function fractures_at

   !> Both networks have the same polylines.
   pure function same_network(a, b) result(same)
      type(network_t), intent(in) :: a, b
      logical :: same

      same = allocated(a%first) .and. allocated(b%first)
      if (same) same = size(a%first) == size(b%first) .and. size(a%xy) == size(b%xy)
      if (same) same = all(a%first == b%first) .and. maxval(abs(a%xy - b%xy)) <= 0.0_rk
   end function same_network

   !> Store or load the network in all its states.
   subroutine visit(self, archive)
      class(network_record_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer(lk) :: i, n

      call visit_network(archive, "network", self%network)
      call visit_fracture_mesh(archive, "mesh", self%mesh)
      call archive%list("tip_ends", self%tip_ends, "2, tip_ends")
      n = size(self%joints, kind=lk)
      call archive%count("joints", n)
      if (archive%is_loading) then
         deallocate (self%joints)
         allocate (self%joints(max(n, 0_lk)))
         self%is_written = .false.
      end if
      do i = 1_lk, n
         associate (joint => self%joints(i))
            call archive%item("kind", joint%kind)
            call archive%item("xy", joint%xy)
            call archive%item("time", joint%time)
            call archive%list("fractures", joint%fractures)
         end associate
      end do
      call self%steps%visit(archive)
   end subroutine visit

   !> Store or load the text of the states.
   subroutine visit_text(self, archive)
      class(network_record_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call self%steps%visit_text(archive)
   end subroutine visit_text

end module report_network
