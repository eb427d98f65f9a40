!> The estimated cost of a run: its steps and CPU time on one thread. The coefficients are fitted to
!! the scenes of inputs (docs/howto_stress.md has predicted and measured values), within a factor
!! of two for scenes like them. How far fractures grow is not known before: without a fluid their
!! growth is taken to cross half of the body, with one to double the number of steps of a stage. In
!! networks few tips grow, those that the fluid reaches; which ones is not known either.
module app_cost
   use app_size, only: estimate_t, size_of_scene
   use base_kinds, only: ik, rk
   use mechanics_results, only: touches
   use scene_stress, only: far_stress_t, find_far_stress, parts_of_scene
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: cost_of_scene, cost_t

   type :: cost_t
      real(rk) :: steps = 0.0_rk  !< rows of history.csv after the first
      real(rk) :: increments = 0.0_rk  !< of growth, which are steps without a fluid
      real(rk) :: cells = 0.0_rk  !< at the beginning
      real(rk) :: seconds = 0.0_rk  !< [s]
      real(rk) :: factor = 2.0_rk  !< the time is known within this factor, as a rule [-]
   end type cost_t

   ! Chosen steps: they begin small after each switch of a well.
   real(rk), parameter :: steps_at_all = 30.0_rk, steps_per_switch = 35.0_rk
   real(rk), parameter :: steps_of_growth = 75.0_rk
   ! With a fluid, per step [s]
   real(rk), parameter :: per_cell = 4.0e-6_rk, per_fracture_cell = 1.3e-4_rk
   real(rk), parameter :: per_tip = 1.5e-3_rk, per_cell_and_growing_tip = 1.1e-5_rk
   real(rk), parameter :: tips_that_grow = 4.0_rk  !< at most [-]
   real(rk), parameter :: factor_of_networks = 4.0_rk  !< cost_t%factor with more of them [-]
   ! Without a fluid [s]
   real(rk), parameter :: per_first_cell = 9.5e-5_rk  !< mesh and stated errors, once
   real(rk), parameter :: per_element = 5.0e-6_rk, per_element_and_tip = 1.8e-6_rk
   real(rk), parameter :: with_contact = 1.5_rk  !< contact iterates [-]
   real(rk), parameter :: cells_per_increment = 22.0_rk  !< mean over the run

contains

   !> Estimate the cost of a scene.
   function cost_of_scene(scene, n_cells) result(cost)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: n_cells(2)  !< by the mesh library
      type(cost_t) :: cost
      type(estimate_t) :: size_of
      real(rk) :: cells, factor, tips

      size_of = size_of_scene(scene, n_cells)
      cost%cells = size_of%cells
      cost%steps = size_of%steps
      tips = 2.0_rk*real(size(scene%fractures), rk)
      if (scene%has_fluid()) then
         if (scene%time%tolerance > 0.0_rk) then
            cost%steps = steps_at_all + steps_per_switch*real(switches(scene), rk)
            if (scene%growth%enabled) cost%steps = cost%steps + steps_of_growth
            if (scene%time%step > 0.0_rk) cost%steps = max(cost%steps, &
                                                           scene%time%end/scene%time%step)
         end if
         cost%seconds = cost%steps*(per_cell*size_of%cells &
                                    + per_fracture_cell*size_of%fracture_cells)
         if (scene%growth%enabled) then
            cost%seconds = cost%seconds + cost%steps*min(tips, tips_that_grow) &
                           *per_cell_and_growing_tip*size_of%cells
            if (tips > tips_that_grow) cost%factor = factor_of_networks
         else if (scene%growth%intensities) then
            cost%seconds = cost%seconds + cost%steps*tips*per_tip
         end if
         return
      end if
      associate (body => scene%domain)
         if (scene%growth%enabled) then
            cost%increments = 0.5_rk*min(body%x_max - body%x_min, body%y_max - body%y_min) &
                              /scene%increment_of(1_ik)
         end if
      end associate
      ! Imposed slip loads the tips of its fractures alone.
      associate (slips => scene%fractures%law == "slip")
         if (any(slips)) tips = 2.0_rk*real(count(slips), rk)
      end associate
      cost%steps = cost%steps + cost%increments
      cells = size_of%cells + cells_per_increment*cost%increments
      factor = contact_factor(scene)
      cost%seconds = per_first_cell*size_of%cells + factor*cost%steps*cells &
                     *(per_element + per_element_and_tip*tips)
   end function cost_of_scene

   !> The part of contact in the cost, by the share of fractures whose faces touch [-]. It is little
   !! where the load opens all of them, and for a lone one without friction.
   real(rk) function contact_factor(scene) result(factor)
      type(scene_t), intent(in) :: scene
      type(far_stress_t) :: far
      integer :: n

      factor = 1.0_rk
      n = count(touches(scene%fractures))
      if (n == 0 .or. size(scene%fractures) == 1 .and. &
          .not. any(scene%fractures%friction > 0.0_rk)) return
      factor = 1.0_rk + with_contact*(real(n, rk)/real(size(scene%fractures), rk))**2
      call find_far_stress(scene, far)
      if (allocated(far%unknown)) then
         factor = sqrt(factor)  ! in between
         return
      end if
      associate (parts => parts_of_scene(scene, far))
         if (all(parts%normal < 0.0_rk)) factor = 1.0_rk
      end associate
   end function contact_factor

   !> Number of different times at which wells begin a stage, or end.
   pure integer function switches(scene) result(n)
      type(scene_t), intent(in) :: scene
      real(rk) :: first
      real(rk), allocatable :: times(:)
      integer(ik) :: k
      integer :: w

      allocate (times(0))
      do w = 1, size(scene%injections)
         associate (well => scene%injections(w))
            times = [times, well%end, (well%stage_start(k), k=1, well%stage_count())]
         end associate
      end do
      n = 0
      do while (any(times < scene%time%end))
         first = minval(times)
         times = pack(times, times > first)
         n = n + 1
      end do
   end function switches

end module app_cost
