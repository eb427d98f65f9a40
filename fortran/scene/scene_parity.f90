!> What scenes without a fluid can say and scenes with one, side by side, for docs/input.md.
module scene_parity
   implicit none(type, external)
   private

   public :: describe_parity

   !> What a scene can say, and whether either kind can say it.
   type :: row_t
      character(len=72) :: what = ""
      character(len=56) :: without = ""
      character(len=88) :: with = ""
   end type row_t

   type(row_t), parameter :: rows(*) = [ &
                             row_t("body", "rectangle, disc, polygon", &
                                 "the same; where it is no rectangle windows are the whole body"), &
                             row_t("rock by region", "yes", &
                                  "yes, and permeability, porosity, Biot's coefficient, density"), &
                             row_t("gravity, stress in situ", "yes", &
                                   "yes, and hydrostatic pressure"), &
               row_t("sides: displacement, traction in x and y, along and across, springs", "yes", &
                                   "yes"), &
                             row_t("sides: pressure, inflow", "no: there is nothing to flow", &
                                   "yes"), &
               row_t("sides in the course of time", "no: the load factor drives a scene, `&load`", &
                                   "yes, all values but springs"), &
                             row_t("unloading", "a load factor that falls, or goes to and fro", &
                                   "values of sides that fall, wells that take back"), &
                             row_t("restraints, point loads", "yes", &
                        "yes; windows are the whole body then, for a square would not know them"), &
                             row_t("faces `friction`, `frictionless`", "yes", &
                                   "yes"), &
                             row_t("faces `open`", "yes", &
                  "no: faces that overlap hold less than no fluid; `frictionless` ones part by "// &
                                   "themselves"), &
                             row_t("faces with a given `slip`", "yes", &
                            "no: the slip would need a course in time; wells and sides drive it"), &
                             row_t("faces `held_closed`", "yes", &
                                   "no: fluid would find no way to open them"), &
                             row_t("`face_pressure`", "yes", &
                                   "no: the pressure of the fluid takes its place"), &
                             row_t("radiation damping", "no: nothing happens in time", &
                                   "yes, without intensities"), &
                             row_t("growth", "in equilibrium, `paris`", &
                                   "in equilibrium, `paris`"), &
                             row_t("mesh", "`&fe`, and `&adaptive`, which follows the error", &
                                   "`&coarse`, and `&fine` windows around the tips")]

contains

   !> Write the section to an open unit.
   subroutine describe_parity(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      write (unit, "(a)") "", "## With and without a fluid", "", &
         "Where a column says no, the scene is refused with a sentence.", "", &
         "| | without &fluid | with &fluid |", "|---|---|---|"
      do i = 1, size(rows)
         write (unit, "(a)") "| "//trim(rows(i)%what)//" | "//trim(rows(i)%without)//" | "// &
            trim(rows(i)%with)//" |"
      end do
   end subroutine describe_parity

end module scene_parity
