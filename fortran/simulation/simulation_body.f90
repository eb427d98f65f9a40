!> The shape of a scene's body, as the mesher takes it.
module simulation_body
   use mesh_builder, only: mesh_spec_t
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: shape_body

contains

   !> Give a mesh the corners and the sides of a body that is no rectangle, and the points that are
   !! loaded or held.
   pure subroutine shape_body(scene, spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t), intent(inout) :: spec
      type(outline_t) :: outline

      if (scene%domain%shape == "rectangle" .and. .not. scene%has_points()) return
      outline = outline_of_scene(scene)
      spec%fixed_points = outline%fixed_points
      if (scene%domain%shape == "rectangle") return
      spec%corners = outline%corners
      spec%edge_side = outline%edge_side
      spec%is_window = .false.  ! whose edges are straight and cut fractures
   end subroutine shape_body

end module simulation_body
