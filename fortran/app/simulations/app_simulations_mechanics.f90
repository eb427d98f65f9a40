!> Without the coarse level: only scenes without a fluid.
submodule(app_simulations) app_simulations_mechanics
   use mechanics_body, only: body_spec
   use mechanics_simulation, only: mechanics_simulation_t
   implicit none(type, external)

contains

   pure module logical function simulates_fluids()
      simulates_fluids = .false.
   end function simulates_fluids

   module function first_mesh(scene, network) result(spec)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(mesh_spec_t) :: spec

      spec = body_spec(scene, network)
   end function first_mesh

   module subroutine allocate_simulation(scene, simulation)
      type(scene_t), intent(in) :: scene
      class(simulation_t), allocatable, intent(out) :: simulation

      type(mechanics_simulation_t), allocatable :: body

      if (scene%has_fluid()) return
      allocate (body)
      call move_alloc(body, simulation)
   end subroutine allocate_simulation

end submodule app_simulations_mechanics
