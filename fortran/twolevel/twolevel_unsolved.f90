!> The message of a step that is not solved: the reason, with the fracture and the place, and the
!! well that has emptied the cell.
module twolevel_unsolved
   use base_kinds, only: ik, rk
   use base_number, only: place_text
   use coarse_state, only: step_report_t
   use mesh_types, only: fracture_mesh_t, network_t
   use scene_types, only: injection_t
   implicit none(type, external)
   private

   public :: why_unsolved

contains

   !> Reason in a report, in the terms of the scene.
   pure function why_unsolved(report, network, fracture, wells, share, rate) result(words)
      type(step_report_t), intent(in) :: report  !< not converged
      type(network_t), intent(in) :: network
      type(fracture_mesh_t), intent(in) :: fracture
      type(injection_t), intent(in) :: wells(:)
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, wells) of each well's flow [-]
      real(rk), intent(in) :: rate(:)  !< (wells) prescribed rates [m2/s]
      character(len=:), allocatable :: words
      character(len=:), allocatable :: name, place
      integer(ik) :: w

      words = report%reason
      if (report%cell == 0) return
      name = name_of(network, fracture%cell_fracture(report%cell))
      place = place_text(0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, report%cell)), &
                                    dim=2))
      if (.not. report%is_drained) then
         words = words//", on "//name//" at "//place
         return
      end if
      w = drawing_well(fracture, report%cell, share, rate)
      if (w == 0) then
         words = name//" has less fluid at "//place//" than flows out of it there"
      else
         words = name//" has less fluid at "//place//" than well '"//trim(wells(w)%name)// &
                 "' extracts: give the well a pressure as its limit, or a smaller rate"
      end if
   end function why_unsolved

   !> Name of a fracture, as text.
   pure function name_of(network, number) result(name)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: number
      character(len=:), allocatable :: name

      name = "a fracture"
      if (allocated(network%names)) name = "fracture '"//trim(network%names(number)%text)//"'"
   end function name_of

   !> Well with the largest extraction from a cell, or else from its fracture; 0: none.
   pure integer(ik) function drawing_well(fracture, cell, share, rate) result(well)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: share(:, :)  !< (fracture cells, wells) [-]
      real(rk), intent(in) :: rate(:)  !< (wells) [m2/s]
      real(rk) :: drawn(size(rate))
      logical :: is_in(size(rate))
      integer :: w

      well = 0
      if (size(rate) == 0) return
      is_in = [(any(share(:, w) > 0.0_rk .and. fracture%cell_fracture &
                    == fracture%cell_fracture(cell)), w=1, size(rate))]
      drawn = merge(-rate, 0.0_rk, is_in)
      if (any(share(cell, :) > 0.0_rk .and. rate < 0.0_rk)) drawn = -rate*share(cell, :)
      if (any(drawn > 0.0_rk)) well = maxloc(drawn, dim=1, kind=ik)
   end function drawing_well

end module twolevel_unsolved
