!> Values of fine problems in an archive (base_archive).
module fine_archive
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: lk
   use fine_contact, only: contact_t
   use fine_faces, only: face_conditions_t
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use mesh_archive, only: visit_fracture_mesh
   implicit none(type, external)
   private

   public :: set_fine_extents, visit_conditions, visit_contact, visit_fine_mesh, visit_loads

contains

   !> Extents of the arrays of a mesh that follow.
   subroutine set_fine_extents(archive, mesh)
      type(archive_t), intent(inout) :: archive
      type(fine_mesh_t), intent(in) :: mesh

      call archive%set_extent("fine_vertices", mesh%n_vertices)
      call archive%set_extent("fine_nodes", mesh%n_nodes)
      call archive%set_extent("fine_cells", mesh%n_cells)
      call archive%set_extent("fine_faces", mesh%fracture%n_cells)
   end subroutine set_fine_extents

   subroutine visit_fine_mesh(archive, name, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fine_mesh_t), intent(inout) :: mesh

      call archive%enter(name)
      call archive%item("n_vertices", mesh%n_vertices)
      call archive%item("n_nodes", mesh%n_nodes)
      call archive%item("n_cells", mesh%n_cells)
      call visit_fracture_mesh(archive, "fracture", mesh%fracture)
      call set_fine_extents(archive, mesh)
      call archive%list("xy", mesh%xy, "2, fine_nodes ?")
      call archive%list("cell_nodes", mesh%cell_nodes, "6, fine_cells ?; 1:fine_nodes")
      call archive%item("tip_element", mesh%tip_element)
      call archive%list("tip_corner", mesh%tip_corner, "fine_cells ?")
      call archive%list("on_boundary", mesh%on_boundary, "fine_nodes ?")
      call archive%list("boundary_faces", mesh%boundary_faces, "2, fine_sides ?; 1:fine_nodes")
      call archive%list("boundary_middles", mesh%boundary_middles, "fine_sides ?")
      call archive%list("boundary_sides", mesh%boundary_sides, "fine_sides ?")
      call archive%list("face_nodes", mesh%face_nodes, "3, 2, fine_faces ?; 1:fine_nodes")
      call archive%list("face_cells", mesh%face_cells, "2, fine_faces ?; 1:fine_cells")
      call archive%list("face_at_tip", mesh%face_at_tip, "fine_faces ?")
      call archive%list("face_tip", mesh%face_tip, "fine_faces ?")
      call archive%list("face_s", mesh%face_s, "3, fine_faces ?")
      call archive%list("face_tangent", mesh%face_tangent, "2, fine_faces ?")
      call archive%list("face_length", mesh%face_length, "fine_faces ?")
      call archive%leave()
   end subroutine visit_fine_mesh

   subroutine visit_contact(archive, name, contact)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(contact_t), intent(inout) :: contact

      call archive%enter(name)
      call archive%list("jump", contact%jump, "2, 3, fine_faces ?")
      call archive%list("slip_before", contact%slip_before, "3, fine_faces ?")
      call archive%list("slip_path", contact%slip_path, "3, fine_faces ?")
      call archive%list("opened", contact%opened, "3, fine_faces ?")
      call archive%list("apart", contact%apart, "3, fine_faces ?")
      call archive%list("traction", contact%traction, "2, 3, fine_faces ?")
      call archive%list("state", contact%state, "3, fine_faces ?")
      call archive%agree(name, [allocated(contact%jump), allocated(contact%slip_before), &
                                allocated(contact%slip_path), allocated(contact%opened), &
                                allocated(contact%apart), allocated(contact%traction), &
                                allocated(contact%state)])
      call archive%item("iterations", contact%iterations)
      call archive%item("was_restarted", contact%was_restarted)
      call archive%item("residual", contact%residual)
      call archive%leave()
   end subroutine visit_contact

   subroutine visit_loads(archive, name, loads)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fine_loads_t), intent(inout) :: loads

      call archive%enter(name)
      call archive%list("boundary_displacement", loads%boundary_displacement, "2, fine_nodes")
      call archive%list("force", loads%force, "2, fine_nodes")
      call archive%item("body_force", loads%body_force)
      call archive%list("initial_stress", loads%initial_stress, "3, fine_vertices")
      call archive%list("pore_pressure", loads%pore_pressure, "fine_vertices")
      call archive%list("heat_pressure", loads%heat_pressure, "3, fine_cells ?")
      call archive%list("traction", loads%traction, "2, fine_faces")
      call archive%list("fluid_pressure", loads%fluid_pressure, "fine_faces")
      call archive%list("jump", loads%jump, "2, 3, fine_faces ?")
      call archive%leave()
   end subroutine visit_loads

   subroutine visit_conditions(archive, name, conditions)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(face_conditions_t), intent(inout), target :: conditions
      integer(lk) :: n

      call archive%enter(name)
      call archive%list("condition", conditions%condition, "fine_faces ?")
      call archive%list("dilation", conditions%dilation, "fine_faces ?")
      call archive%extent("law", conditions%law, n, "fine_faces ?")
      call archive%agree(name, [n >= 0_lk, allocated(conditions%condition), &
                                allocated(conditions%dilation)])
      if (archive%is_loading) then
         if (allocated(conditions%law)) deallocate (conditions%law)
         if (n >= 0_lk) allocate (conditions%law(n))
      end if
 if (n > 0_lk) call archive%plain("law", c_loc(conditions%law), n*storage_size(conditions%law)/8_lk)
      call archive%leave()
   end subroutine visit_conditions

end module fine_archive
