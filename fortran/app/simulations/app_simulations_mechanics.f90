!> Without the coarse level: only scenes without a fluid.
submodule(app_simulations) app_simulations_mechanics
   use mechanics_body, only: body_spec
   use mechanics_simulation, only: mechanics_simulation_t
   implicit none(type, external)

contains

   module procedure simulates_fluids
   simulates_fluids = .false.
   end procedure simulates_fluids

   module procedure first_mesh

   spec = body_spec(scene, network)
   end procedure first_mesh

   module procedure allocate_simulation

   type(mechanics_simulation_t), allocatable :: body

   if (scene%has_fluid()) return
   allocate (body)
   call move_alloc(body, simulation)
   end procedure allocate_simulation

end submodule app_simulations_mechanics
