!> What a scene has and leaves out, without running it.
module app_check
   use app_warnings, only: show_warnings
   use base_kinds, only: ik, rk
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

      real(rk) :: length
      integer(ik) :: fracture_cells

      associate (d => scene%discretization, body => scene%domain)
         length = total_length(network_of_scene(scene))
         fracture_cells = 0
         if (length > 0.0_rk) fracture_cells = nint(length/d%size_fracture, ik)
         write (unit, "(2a)") "scene:        ", trim(scene%name)
         if (len_trim(scene%title) > 0) write (unit, "(2a)") "title:        ", trim(scene%title)
         write (unit, "(a,2(es10.3,a))") "body:        ", body%x_max - body%x_min, " x", &
            body%y_max - body%y_min, " m, "//trim(merge("poroelastic", "elastic    ", &
                                                        scene%has_fluid()))
         write (unit, "(a,i0,a,es10.3,a)") "fractures:    ", size(scene%fractures), ", together", &
            length, " m"
         if (scene%has_fluid()) write (unit, "(a,i0)") "wells:        ", size(scene%injections)
         write (unit, "(a,i0)") "probes:       ", size(scene%probes)
         if (scene%has_fluid()) then
            write (unit, "(a,es10.3,a,i0,a)") "time:        ", scene%time%end, " s in ", &
               ceiling(scene%time%end/scene%time%step), " regular steps"
         else
            write (unit, "(2(a,es10.3),a,i0,a)") "load factor: ", scene%load%from, " to", &
               scene%load%to, " in ", scene%load%steps, " steps"
            write (unit, "(a)") "left out:     pressure, flow, coarse level"
         end if
         write (unit, "(2a)") "tips:         ", trim(merge("growth     ", &
                                                           merge("intensities", "left out   ", &
                                                                 scene%growth%intensities), &
                                                           scene%growth%enabled))
         write (unit, "(2a)") "VTU files:    ", trim(merge("yes     ", "left out", &
                                                           scene%output%vtu))
         write (unit, "(a,i0,a,i0,a)") "about:        ", estimated_cells(scene), " cells, ", &
            fracture_cells, " fracture cells"
      end associate
      call show_warnings(doubts_of_scene(scene), unit)
   end subroutine describe_scene

   !> Number of cells by integrating 1/area over the body, cell size linear in the distance from the
   !! middle.
   pure function estimated_cells(scene) result(n)
      type(scene_t), intent(in) :: scene
      integer(ik) :: n

      integer, parameter :: samples = 200
      !> of the farthest distance, where sizes stop growing (size_field.cpp)
      real(rk), parameter :: reach = 0.5_rk
      real(rk) :: distance, count, half(2), length, size_here, x, y
      integer :: i, j

      length = total_length(network_of_scene(scene))
      associate (d => scene%discretization, body => scene%domain)
         half = 0.5_rk*[body%x_max - body%x_min, body%y_max - body%y_min]
         count = 0.0_rk
         do j = 1, samples
            do i = 1, samples
               x = half(1)*(2.0_rk*real(i, rk) - 1.0_rk - samples)/samples
               y = half(2)*(2.0_rk*real(j, rk) - 1.0_rk - samples)/samples
               distance = max(0.0_rk, hypot(x, y) - 0.25_rk*length)
               size_here = d%size_boundary
               if (length > 0.0_rk) size_here = min(size_here, d%size_fracture &
                                                    + (d%size_boundary - d%size_fracture)*distance &
                                                    /(reach*norm2(half)))
               count = count + 1.0_rk/size_here**2
            end do
         end do
         n = nint(4.0_rk*half(1)*half(2)*count/samples**2*4.0_rk/sqrt(3.0_rk), ik)
      end associate
   end function estimated_cells

end module app_check
