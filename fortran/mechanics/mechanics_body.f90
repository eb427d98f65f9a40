!> The whole body as one mesh of finite elements: how it is held and loaded, and how it answers.
module mechanics_body
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_assemble, phase_factorize, phase_solve, phase_tips, timers_t
   use fine_boundary, only: add_point_force, add_side_traction, fine_boundary_t, free_boundary, &
                            hold_side, nearest_node
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use mechanics_outline, only: outline_of_scene, outline_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use tips_intensity, only: tip_intensity
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: body_t

   !> A body on one mesh, and its state under a load.
   type :: body_t
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads  !< at the present load factor
      real(rk), allocatable :: displacement(:, :)  !< (2, nodes) [m]
      type(intensity_t), allocatable :: intensity(:)  !< (free tips of the mesh)
   contains
      procedure :: build
      procedure :: respond
   end type body_t

contains

   !> Mesh the body with its fractures, assemble and factorize.
   subroutine build(self, scene, network, mesh_phase, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      integer, intent(in) :: mesh_phase  !< of the timers: the first mesh or a later one
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(elasticity_t) :: elasticity

      if (allocated(self%displacement)) deallocate (self%displacement)
      call timers%start(mesh_phase)
      call build_mesh(body_spec(scene), network, self%mesher, self%mesh, error)
      call timers%stop(mesh_phase)
      if (allocated(error)) return
      elasticity = elasticity_t(young=scene%material%young, poisson=scene%material%poisson, &
                                plane_stress=scene%material%plane_stress)
      call timers%start(phase_assemble)
      call self%model%set_mesh(self%mesh, elasticity, error)
      call timers%stop(phase_assemble)
      if (allocated(error)) return
      call timers%start(phase_factorize)
      call self%model%prepare(loaded_everywhere(self%model%mesh), error, &
                              held_boundary(scene, self%model%mesh))
      call timers%stop(phase_factorize)
   end subroutine build

   !> What to mesh.
   pure function body_spec(scene) result(spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t) :: spec
      type(outline_t) :: outline

      outline = outline_of_scene(scene)
      spec%corners = outline%corners
      spec%edge_side = outline%edge_side
      spec%fixed_points = outline%fixed_points
      spec%size_boundary = scene%discretization%size_boundary
      spec%size_fracture = scene%discretization%size_fracture
      if (.not. spec%size_fracture > 0.0_rk) spec%size_fracture = spec%size_boundary
      spec%rosette_sectors = scene%discretization%rosette_sectors
      spec%rosette_radius = scene%discretization%rosette_radius
      if (.not. spec%rosette_radius > 0.0_rk) spec%rosette_radius = spec%size_fracture
   end function body_spec

   !> Which displacements are given.
   pure function held_boundary(scene, fine) result(boundary)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t) :: boundary
      integer(ik) :: side, axis, i, node

      boundary = free_boundary(fine)
      do side = 1, size(scene%sides, kind=ik)
         do axis = 1, 2
            if (scene%sides(side)%displacement_given(axis)) then
               call hold_side(fine, side, axis, boundary)
            end if
         end do
      end do
      do i = 1, size(scene%restraints)
         associate (point => scene%restraints(i))
            node = nearest_node(fine, [point%x, point%y])
            boundary%prescribed(:, node) = boundary%prescribed(:, node) .or. &
                                           point%displacement_given
         end associate
      end do
   end function held_boundary

   !> The loads of a scene at a load factor.
   pure function body_loads(scene, fine, factor) result(loads)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: factor  !< [-]
      type(fine_loads_t) :: loads
      integer(ik) :: face, side, axis, i, node, nodes(3)

      loads = no_loads(fine)
      do face = 1, size(fine%boundary_sides, kind=ik)
         side = fine%boundary_sides(face)
         nodes = [fine%boundary_faces(:, face), fine%boundary_middles(face)]
         do axis = 1, 2
            if (.not. scene%sides(side)%displacement_given(axis)) cycle
            loads%boundary_displacement(axis, nodes) = factor*scene%sides(side)%displacement(axis)
         end do
      end do
      do side = 1, size(scene%sides, kind=ik)
         if (.not. any(abs(scene%sides(side)%traction) > 0.0_rk)) cycle
         call add_side_traction(fine, side, factor*scene%sides(side)%traction, loads%force)
      end do
      do i = 1, size(scene%restraints)
         associate (point => scene%restraints(i))
            node = nearest_node(fine, [point%x, point%y])
            where (point%displacement_given)
               loads%boundary_displacement(:, node) = factor*point%displacement
            end where
         end associate
      end do
      do i = 1, size(scene%point_loads)
         associate (point => scene%point_loads(i))
            call add_point_force(fine, [point%x, point%y], factor*point%force, loads%force)
         end associate
      end do
   end function body_loads

   !> Displacements, and stress intensity factors where the scene wants them, at a load factor.
   subroutine respond(self, scene, factor, timers, error)
      class(body_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: factor  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: tip

      call timers%start(phase_solve)
      self%loads = body_loads(scene, self%model%mesh, factor)
      call self%model%solve(self%loads, self%displacement, error)
      call timers%stop(phase_solve)
      if (allocated(error) .or. .not. scene%growth%intensities) return
      call timers%start(phase_tips)
      if (allocated(self%intensity)) deallocate (self%intensity)
      allocate (self%intensity(self%mesh%fracture%n_tips))
      do tip = 1, self%mesh%fracture%n_tips
         call tip_intensity(self%model, self%loads, self%displacement, tip, self%intensity(tip), &
                            error)
         if (allocated(error)) exit
      end do
      call timers%stop(phase_tips)
   end subroutine respond

end module mechanics_body
