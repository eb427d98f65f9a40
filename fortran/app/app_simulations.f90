!> The kinds of simulations of a program. They are chosen when the program is linked: one of the
!! submodules in `simulations` belongs to each program.
module app_simulations
   use mesh_builder, only: mesh_spec_t
   use mesh_types, only: network_t
   use report_simulation, only: simulation_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: allocate_simulation, first_mesh, simulates_fluids

   interface
      !> This program can simulate scenes with a fluid.
      pure module logical function simulates_fluids()
         implicit none(type, external)
      end function simulates_fluids

      !> Specification of the first mesh of a scene.
      module function first_mesh(scene, network) result(spec)
         implicit none(type, external)
         type(scene_t), intent(in) :: scene
         type(network_t), intent(in) :: network  !< network of the scene
         type(mesh_spec_t) :: spec
      end function first_mesh

      !> Allocate the simulation of a scene; it remains unallocated if this program has none.
      module subroutine allocate_simulation(scene, simulation)
         implicit none(type, external)
         type(scene_t), intent(in) :: scene
         class(simulation_t), allocatable, intent(out) :: simulation
      end subroutine allocate_simulation
   end interface

end module app_simulations
