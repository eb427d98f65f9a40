!> A window in an archive (base_archive): its meshes are stored, its model is made again from them.
submodule(twolevel_window) twolevel_window_archive
   use base_kinds, only: lk
   use fine_archive, only: set_fine_extents, visit_conditions, visit_loads
   use mesh_archive, only: visit_mesher, visit_mesher_and_mesh, visit_network
   implicit none(type, external)

contains

   module procedure visit

   call archive%enter("window")
   call archive%set_extent("serves", -1_ik)
   call archive%set_extent("served", -1_ik)
   call archive%list("serves", self%serves, "serves")
   if (archive%is_loading .and. allocated(self%serves)) then
      if (any(self%serves < 1 .or. self%serves > size(tips))) call archive%set_fault("serves")
   end if
   if (allocated(archive%fault)) return
   call archive%item("is_body", self%is_body)
   call archive%item("lower", self%lower)
   call archive%item("upper", self%upper)
   call archive%item("coarser", self%coarser)
   call archive%item("element_size", self%element_size)
   call archive%item("usual_edge", self%usual_edge)
   call archive%item("times_larger", self%times_larger)
   call archive%item("has_moved", self%has_moved)
   call visit_mesher_and_mesh(archive, "mesh", self%mesher, self%mesh)
   call visit_mesher(archive, "as_made", self%as_made)
   call visit_made(self, archive)
   if (self%mesh%n_cells > 0) call visit_model(self, archive, scene, tips, error)
   call archive%leave()
   if (.not. (archive%is_loading .and. allocated(self%made)) .or. allocated(error)) return
   if (allocated(archive%fault) .or. .not. self%made%is_projected) return
   if (.not. (allocated(values%of) .and. allocated(values%is_grown))) then
      call archive%set_fault("values")
      return
   end if
   call self%project(mesher, coarse, values%is_grown, error)
   if (allocated(error)) return
   if (any(self%faces%coarse_cell < 1)) call archive%set_fault("cell_fracture")
   end procedure visit

   subroutine visit_made(self, archive)
      type(window_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer(lk) :: n

      n = merge(1_lk, -1_lk, allocated(self%made))
      call archive%count("made", n)
      if (archive%is_loading) then
         if (allocated(self%made)) deallocate (self%made)
         if (n > 0_lk) allocate (self%made)
      end if
      if (.not. allocated(self%made)) return
      associate (made => self%made)
         call visit_network(archive, "network", made%network)
         call archive%list("kept", made%kept, "kept ?; 1:vertices")
         call archive%set_extent("kept", -1_ik)
         call archive%list("place", made%place, "2, tips")
         call archive%list("is_free", made%is_free, "tips")
         call archive%list("has_focus", made%has_focus, "tips")
         call archive%list("changes", made%changes, "changes ?")
         call archive%set_extent("changes", -1_ik)
         if (archive%is_loading .and. .not. allocated(made%changes)) then
            if (self%mesh%n_cells > 0) call archive%set_fault("changes")
         else if (archive%is_loading) then
            if (all(size(made%changes) /= [0_ik, self%mesh%n_cells])) then
               call archive%set_fault("changes")
            end if
         end if
         call archive%list("held", made%held, "held ?")
         call archive%set_extent("held", -1_ik)
         if (archive%is_loading .and. allocated(made%held)) then
            if (size(made%held) /= self%mesh%fracture%n_cells) call archive%set_fault("held")
         end if
         call archive%item("is_projected", made%is_projected)
      end associate
   end subroutine visit_made

   !> The model of a mesh, with its matrix, and the last solution. A window that has been meshed in
   !! a try and not evaluated since has no solution, and perhaps no matrix.
   subroutine visit_model(self, archive, scene, tips, error)
      type(window_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      type(scene_t), intent(in) :: scene
      type(window_tip_t), intent(in) :: tips(:)
      type(error_t), allocatable, intent(out) :: error
      logical :: has_stiffness, is_ready, undrained
      integer(lk) :: n

      has_stiffness = allocated(self%model%stiffness)
      is_ready = self%model%ready
      undrained = self%undrained
      call archive%item("undrained", undrained)
      call archive%item("has_stiffness", has_stiffness)
      call archive%item("is_ready", is_ready)
      if (allocated(archive%fault)) return
      if (archive%is_loading) then
         self%sides = window_sides(scene, self%is_body, self%lower, self%upper)
         call self%set_up(scene, tips, error)
         if (.not. allocated(error) .and. undrained) call self%set_rock(scene, undrained, error)
         if (allocated(error)) return
      end if
      call set_fine_extents(archive, self%model%mesh)
      call archive%list("at", self%at, "served; 0:own_tips")
      if (allocated(archive%fault)) return
      if (all(size(self%serves) /= [0, size(self%at)])) call archive%set_fault("serves")
      call visit_loads(archive, "loads", self%loads)
      call archive%list("displacement", self%displacement, "2, fine_nodes ?")
      call visit_conditions(archive, "conditions", self%model%conditions)
      if (is_ready .and. .not. allocated(self%model%conditions%law)) then
         call archive%set_fault("conditions")
      end if
      if (allocated(archive%fault)) return
      if (archive%is_loading .and. is_ready) then
         call self%model%prepare(self%model%conditions, error, &
                                 self%sides%held_edge(self%model%mesh))
         if (allocated(error)) return
      end if
      if (.not. has_stiffness .and. archive%is_loading) deallocate (self%model%stiffness)
      call archive%extent("served", self%served, n, "served ?")
      if (archive%is_loading .and. n >= 0_lk) allocate (self%served(n))
      if (n >= 0_lk) call visit_served(self, archive, error)
   end subroutine visit_model

   !> Tips that the window serves, with what finds their intensities.
   subroutine visit_served(self, archive, error)
      type(window_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i
      logical :: has_probe

      do i = 1, size(self%served, kind=ik)
         has_probe = self%served(i)%has_probe
         call archive%item("is_evaluated", self%served(i)%is_evaluated)
         call archive%item("has_probe", has_probe)
         if (.not. archive%is_loading .or. .not. has_probe) cycle
         call probe_of_tip(self%model, self%at(i), self%served(i)%probe, error)
         if (allocated(error)) return
         self%served(i)%has_probe = .true.
      end do
   end subroutine visit_served

end submodule twolevel_window_archive
