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

   public :: visit_conditions, visit_contact, visit_fine_mesh, visit_loads

contains

   subroutine visit_fine_mesh(archive, name, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fine_mesh_t), intent(inout) :: mesh

      call archive%enter(name)
      call archive%item("n_vertices", mesh%n_vertices)
      call archive%item("n_nodes", mesh%n_nodes)
      call archive%item("n_cells", mesh%n_cells)
      call archive%list("xy", mesh%xy)
      call archive%list("cell_nodes", mesh%cell_nodes)
      call archive%item("tip_element", mesh%tip_element)
      call archive%list("tip_corner", mesh%tip_corner)
      call archive%list("on_boundary", mesh%on_boundary)
      call archive%list("boundary_faces", mesh%boundary_faces)
      call archive%list("boundary_middles", mesh%boundary_middles)
      call archive%list("boundary_sides", mesh%boundary_sides)
      call archive%list("face_nodes", mesh%face_nodes)
      call archive%list("face_cells", mesh%face_cells)
      call archive%list("face_at_tip", mesh%face_at_tip)
      call archive%list("face_tip", mesh%face_tip)
      call archive%list("face_s", mesh%face_s)
      call archive%list("face_tangent", mesh%face_tangent)
      call archive%list("face_length", mesh%face_length)
      call visit_fracture_mesh(archive, "fracture", mesh%fracture)
      call archive%leave()
   end subroutine visit_fine_mesh

   subroutine visit_contact(archive, name, contact)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(contact_t), intent(inout) :: contact

      call archive%enter(name)
      call archive%list("jump", contact%jump)
      call archive%list("slip_before", contact%slip_before)
      call archive%list("slip_path", contact%slip_path)
      call archive%list("opened", contact%opened)
      call archive%list("apart", contact%apart)
      call archive%list("traction", contact%traction)
      call archive%list("state", contact%state)
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
      call archive%list("boundary_displacement", loads%boundary_displacement)
      call archive%list("force", loads%force)
      call archive%item("body_force", loads%body_force)
      call archive%list("initial_stress", loads%initial_stress)
      call archive%list("pore_pressure", loads%pore_pressure)
      call archive%list("traction", loads%traction)
      call archive%list("fluid_pressure", loads%fluid_pressure)
      call archive%list("jump", loads%jump)
      call archive%leave()
   end subroutine visit_loads

   subroutine visit_conditions(archive, name, conditions)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(face_conditions_t), intent(inout), target :: conditions
      integer(lk) :: n

      call archive%enter(name)
      call archive%list("condition", conditions%condition)
      call archive%list("dilation", conditions%dilation)
      n = -1_lk
      if (allocated(conditions%law)) n = size(conditions%law, kind=lk)
      call archive%count("law", n)
      if (archive%is_loading) then
         if (allocated(conditions%law)) deallocate (conditions%law)
         if (n >= 0_lk) allocate (conditions%law(n))
      end if
 if (n > 0_lk) call archive%plain("law", c_loc(conditions%law), n*storage_size(conditions%law)/8_lk)
      call archive%leave()
   end subroutine visit_conditions

end module fine_archive
