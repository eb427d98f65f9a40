!> All kinds: both levels with a fluid, finite elements without.
submodule(app_simulations) app_simulations_all
   use mechanics_body, only: body_spec
   use mechanics_simulation, only: mechanics_simulation_t
   use twolevel_setup, only: coarse_spec
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

contains

   module procedure simulates_fluids
   simulates_fluids = .true.
   end procedure simulates_fluids

   module procedure first_mesh

   if (scene%has_fluid()) then
      spec = coarse_spec(scene)
   else
      spec = body_spec(scene, network)
   end if
   end procedure first_mesh

   module procedure allocate_simulation

   type(two_levels_t), allocatable :: levels
   type(mechanics_simulation_t), allocatable :: body

   ! Moved: in an allocation of `simulation` itself gfortran 12 copies unset components.
   if (scene%has_fluid()) then
      allocate (levels)
      call move_alloc(levels, simulation)
   else
      allocate (body)
      call move_alloc(body, simulation)
   end if
   end procedure allocate_simulation

end submodule app_simulations_all
