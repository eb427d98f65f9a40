!> Fields of a state in an archive (base_archive).
module report_fields_archive
   use base_archive, only: archive_t
   use mesh_archive, only: visit_mesh
   use report_rows, only: fracture_fields_t, intersection_fields_t, matrix_fields_t
   use report_simulation, only: snapshot_t
   implicit none(type, external)
   private

   public :: visit_snapshot

contains

   subroutine visit_snapshot(archive, name, fields)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(snapshot_t), intent(inout) :: fields

      call archive%enter(name)
      call archive%item("time", fields%time)
      call visit_mesh(archive, "mesh", fields%mesh)
      call visit_matrix(archive, fields%matrix)
      call visit_fracture(archive, fields%fracture)
      call visit_intersection(archive, fields%intersection)
      call archive%leave()
   end subroutine visit_snapshot

   subroutine visit_matrix(archive, matrix)
      type(archive_t), intent(inout) :: archive
      type(matrix_fields_t), intent(inout) :: matrix

      call archive%list("displacement", matrix%displacement)
      call archive%list("stress", matrix%stress)
      call archive%list("pressure", matrix%pressure)
      call archive%list("permeability", matrix%permeability)
      call archive%list("poisson", matrix%poisson)
      call archive%list("biot", matrix%biot)
      call archive%list("node_displacement", matrix%node_displacement)
      call archive%list("node_xy", matrix%node_xy)
      call archive%list("cell_nodes", matrix%cell_nodes)
      call archive%list("displacement_error", matrix%displacement_error)
      call archive%list("stress_error", matrix%stress_error)
      call archive%list("pressure_error", matrix%pressure_error)
   end subroutine visit_matrix

   subroutine visit_fracture(archive, fracture)
      type(archive_t), intent(inout) :: archive
      type(fracture_fields_t), intent(inout) :: fracture

      call archive%list("aperture", fracture%aperture)
      call archive%list("jump_n", fracture%jump_n)
      call archive%list("jump_t", fracture%jump_t)
      call archive%list("traction_n", fracture%traction_n)
      call archive%list("traction_t", fracture%traction_t)
      call archive%list("pressure", fracture%pressure)
      call archive%list("void", fracture%void)
      call archive%list("flow", fracture%flow)
      call archive%list("state", fracture%state)
      associate (error => fracture%error)
         call archive%list("jump_n", error%jump_n)
         call archive%list("jump_t", error%jump_t)
         call archive%list("traction_n", error%traction_n)
         call archive%list("traction_t", error%traction_t)
         call archive%list("pressure", error%pressure)
         call archive%list("flow", error%flow)
      end associate
   end subroutine visit_fracture

   subroutine visit_intersection(archive, intersection)
      type(archive_t), intent(inout) :: archive
      type(intersection_fields_t), intent(inout) :: intersection

      call archive%list("point", intersection%point)
      call archive%list("pressure", intersection%pressure)
      call archive%list("pressure_error", intersection%pressure_error)
   end subroutine visit_intersection

end module report_fields_archive
