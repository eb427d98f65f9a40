!> What a scene has and leaves out, without running it.
module app_check
   use app_size, only: estimate_t, size_of_scene
   use app_warnings, only: show_warnings
   use base_kinds, only: lk, rk
   use scene_growth_regime, only: find_regime, regime_words
   use scene_plausible, only: doubts_of_scene
   use scene_types, only: scene_t
   use growth_network, only: network_of_scene, total_length
   implicit none(type, external)
   private

   public :: describe_scene

contains

   !> Print the scene's contents and its estimated size.
   subroutine describe_scene(scene, unit)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: unit

      type(estimate_t) :: estimate
      real(rk) :: length, toughness
      integer :: well

      associate (body => scene%domain)
         length = total_length(network_of_scene(scene))
         estimate = size_of_scene(scene)
         write (unit, "(2a)") "scene:        ", trim(scene%name)
         if (len_trim(scene%title) > 0) write (unit, "(2a)") "title:        ", trim(scene%title)
         write (unit, "(a,2(es10.3,a))") "body:        ", body%x_max - body%x_min, " x", &
            body%y_max - body%y_min, " m, "//trim(merge("poroelastic", "elastic    ", &
                                                        scene%has_fluid()))
         write (unit, "(a,i0,a,es10.3,a)") "fractures:    ", size(scene%fractures), ", together", &
            length, " m"
         if (allocated(scene%regions)) write (unit, "(a,i0)") "regions:      ", size(scene%regions)
         if (scene%has_fluid()) write (unit, "(a,i0)") "wells:        ", size(scene%injections)
         write (unit, "(a,i0)") "probes:       ", size(scene%probes)
         if (scene%has_fluid()) then
            write (unit, "(a,es10.3,a,i0,a)") "time:        ", scene%time%end, " s in "// &
               trim(merge("about", "     ", scene%time%tolerance > 0.0_rk))//" ", &
               int(estimate%steps, lk), trim(merge(" chosen steps ", " regular steps", &
                                                   scene%time%tolerance > 0.0_rk))
         else if (allocated(scene%load%factors)) then
            write (unit, "(a,i0,2(a,es10.3),a,i0,a)") "load factors: ", &
               size(scene%load%factors), " in turn between", minval(scene%load%factors), &
               " and", maxval(scene%load%factors), ", ", scene%load%steps, " steps to each"
            write (unit, "(a)") "left out:     pressure, flow, coarse level"
         else
            write (unit, "(2(a,es10.3),a,i0,a)") "load factor: ", scene%load%from, " to", &
               scene%load%to, " in ", scene%load%steps, " steps"
            write (unit, "(a)") "left out:     pressure, flow, coarse level"
         end if
         write (unit, "(2a)") "tips:         ", trim(merge("growth     ", &
                                                           merge("intensities", "left out   ", &
                                                                 scene%growth%intensities), &
                                                           scene%growth%enabled))
         call find_regime(scene, toughness, well)
         if (well > 0) write (unit, "(3a,es9.3,3a)") "regime:       ", &
            regime_words(toughness), ", K_m = ", toughness, " (well '", &
            trim(scene%injections(well)%name), "')"
         write (unit, "(2a)") "VTU files:    ", trim(merge("yes     ", "left out", &
                                                           scene%output%vtu))
         write (unit, "(a,i0,a,i0,a)") "about:        ", int(estimate%cells, lk), " cells, ", &
            int(estimate%fracture_cells, lk), " fracture cells"
      end associate
      call show_warnings(doubts_of_scene(scene), unit)
   end subroutine describe_scene

end module app_check
