!> What scenes without a fluid can say and scenes with one, side by side, for docs/input.md.
module scene_parity
   implicit none(type, external)
   private

   public :: describe_parity

   !&<
   character(len=*), parameter :: table(*) = [character(len=200) :: &
      "## With and without a fluid", &
      "", &
      "Where a column says no, the scene is refused with a sentence.", &
      "", &
      "| | without &fluid | with &fluid |", &
      "|---|---|---|", &
      "| body | rectangle, disc, polygon | the same; where it is no rectangle windows are the whole body |", &
      "| rock by region | yes | yes, and permeability, porosity, Biot's coefficient |", &
      "| gravity, stress in situ | yes | yes, and hydrostatic pressure |", &
      "| sides: displacement, traction in x and y, along and across, springs | yes | yes |", &
      "| sides: pressure, inflow | no: there is nothing to flow | yes |", &
      "| sides in the course of time | no: the load factor drives a scene, `&load` | yes, all values but springs |", &
      "| unloading | a load factor that falls | values of sides that fall, wells that take back |", &
      "| restraints, point loads | yes | yes; windows are the whole body then, for a square would not know them |", &
      "| faces `friction`, `frictionless` | yes | yes |", &
      "| faces `open` | yes | no: faces that overlap would hold less than no fluid; `frictionless` ones part by themselves |", &
      "| faces with a given `slip` | yes | no: the slip would need a course in time; an injection drives it |", &
      "| faces `held_closed` | yes | no: fluid would find no way to open them |", &
      "| `face_pressure` | yes | no: the pressure of the fluid takes its place |", &
      "| radiation damping | no: nothing happens in time | yes, without intensities |", &
      "| growth | in equilibrium, `paris` | in equilibrium, `paris` |", &
      "| mesh | `&fe`, and `&adaptive`, which follows the error | `&coarse`, and `&fine` windows around the tips |"]
   !&>

contains

   !> Write the section to an open unit.
   subroutine describe_parity(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      write (unit, "(a)") ""
      do i = 1, size(table)
         write (unit, "(a)") trim(table(i))
      end do
   end subroutine describe_parity

end module scene_parity
