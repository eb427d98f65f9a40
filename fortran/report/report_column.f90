!> A column of a table, key of a JSON file or field of a VTU file, with its error or the reason why
!! none is stated, and the runs that have it.
module report_column
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: applies, column_t, well_count, always, with_fluid, with_fractures, without_fluid
   public :: with_growth, with_toughness, with_joints, with_wells, with_entries
   public :: with_fluid_and_growth, with_wells_and_growth, with_one_well, at_most_one
   public :: with_several, with_error, with_heat, with_heat_and_fractures, with_heat_and_wells
   public :: an_error, chosen, counted, label, measured, of_heat, of_step, placed, states

   ! Runs in which a column, key or field is written.
   character(len=*), parameter :: always = "always"
   character(len=*), parameter :: with_fluid = "with a fluid"
   character(len=*), parameter :: with_fractures = "with a fluid and fractures"
   character(len=*), parameter :: without_fluid = "without a fluid"
   character(len=*), parameter :: with_growth = "without a fluid, with growth"
   character(len=*), parameter :: with_toughness = "with tips and a toughness"
   character(len=*), parameter :: with_joints = "with a fluid and joints"
   character(len=*), parameter :: with_wells = "with a fluid and wells"
   character(len=*), parameter :: with_entries = "with a fluid and wells with entries"
   character(len=*), parameter :: with_fluid_and_growth = "with a fluid and growth"
   character(len=*), parameter :: with_wells_and_growth = "with a fluid, wells and growth"
   character(len=*), parameter :: with_one_well = "with a fluid and one well"
   character(len=*), parameter :: at_most_one = "with a fluid and at most one well"
   character(len=*), parameter :: with_several = "with a fluid and several wells"
   character(len=*), parameter :: with_error = "with &adaptive"
   character(len=*), parameter :: with_heat = "with &heat"
   character(len=*), parameter :: with_heat_and_fractures = "with &heat and fractures"
   character(len=*), parameter :: with_heat_and_wells = "with &heat and wells"

   ! Reasons why no error is stated.
   character(len=*), parameter :: an_error = "none: itself an error"
   character(len=*), parameter :: chosen = "none: chosen by the run, exact"
   character(len=*), parameter :: counted = "none: a count"
   character(len=*), parameter :: label = "none: a name, number or text"
   character(len=*), parameter :: measured = "none: measured"
   character(len=*), parameter :: of_step = "none: a mean over one time step, whose length decides"
   character(len=*), parameter :: placed = "none: a point of the mesh, exact"
   character(len=*), parameter :: of_heat = &
                                  "none: to be seen by smaller cells and tolerance of &heat"
   character(len=*), parameter :: states = &
                                  "none: states of cells; where they change is known to one cell"

   !> A column of a table, a key of a JSON file (a dot leads into an object, brackets into a list)
   !! or a field of a VTU file.
   type :: column_t
      character(len=28) :: name = ""
      character(len=8) :: unit = "-"
      character(len=40) :: runs = always  !< runs in which it is written
      character(len=160) :: meaning = ""  !< empty: `Estimated error of` the name without `_error`
      !> where its error is: a column, key or field of this file, or "X of FILE"; or "none: " and
      !! the reason
      character(len=128) :: error = an_error
   end type column_t

contains

   !> A column is written in the run of a scene, as far as that follows from the scene.
   elemental logical function applies(column, scene)
      type(column_t), intent(in) :: column
      type(scene_t), intent(in) :: scene

      select case (column%runs)
      case (with_fluid)
         applies = scene%has_fluid()
      case (with_fractures)
         applies = scene%has_fluid() .and. scene%has_fractures()
      case (with_wells)
         applies = scene%has_fluid() .and. scene%has_wells()
      case (with_entries)
         applies = scene%has_fluid() .and. scene%has_entries()
      case (with_fluid_and_growth)
         applies = scene%has_fluid() .and. scene%growth%enabled
      case (with_wells_and_growth)
         applies = scene%has_fluid() .and. scene%has_wells() .and. scene%growth%enabled
      case (with_one_well)
         applies = scene%has_fluid() .and. well_count(scene) == 1
      case (at_most_one)
         applies = scene%has_fluid() .and. well_count(scene) <= 1
      case (with_several)
         applies = scene%has_fluid() .and. well_count(scene) > 1
      case (with_heat)
         applies = allocated(scene%heat)
      case (with_heat_and_fractures)
         applies = allocated(scene%heat) .and. scene%has_fractures()
      case (with_heat_and_wells)
         applies = allocated(scene%heat) .and. scene%has_wells()
      case (without_fluid)
         applies = .not. scene%has_fluid()
      case default
         applies = .true.
      end select
   end function applies

   !> Number of wells of a scene with a fluid.
   pure integer function well_count(scene) result(n)
      type(scene_t), intent(in) :: scene

      n = 0
      if (scene%has_fluid() .and. scene%has_wells()) n = size(scene%injections)
   end function well_count

end module report_column
