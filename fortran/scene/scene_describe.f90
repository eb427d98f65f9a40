!> docs/input.md, written from the table of parameters.
!!
!! What scenes without a fluid can say and scenes with one, side by side, for docs/input.md.
module scene_describe
   use scene_parameters, only: choice_name, choice_value, group_t, groups, in_fluid, &
                               in_mechanics, kind_choice, kind_integer, kind_logical, kind_name, &
                               kind_real, kind_reals, kind_wholes, need_always, need_choice, &
                               need_fluid, need_fracture, need_growth, need_tips, parameter_t, &
                               parameters
   use scene_words, only: in_words
   implicit none(type, external)
   private

   public :: describe_input

   !&<
   character(len=*), parameter :: introduction(*) = [character(len=128) :: &
      "# Scene files", &
      "", &
      "This page is written by `wingcrack-solver --describe-input` from the table that the", &
      "reading follows; a test holds it against the code.", &
      "", &
      "A scene file is a text of Fortran namelist groups, in any order:", &
      "", &
      "```fortran", &
      "! a comment, to the end of the line", &
      "&fracture", &
      "  name = 'main'                     ! texts in quotes; within '...', '' is one quote", &
      "  x = 0.9, 1.0, 1.1                 ! lists with commas or blanks; 2*1.0 is 1.0, 1.0", &
      "  y = 1.0 1.0 1.05", &
      "  friction = 0.5, dilation_deg = 1  ! several names may share a line", &
      "  aperture = 1.0e-3                 ! or 1d-3", &
      "/                                   ! ends the group", &
      "```", &
      "", &
      "* All numbers are in SI units; angles are in degrees and carry `_deg` in their name.", &
      "* Compressive stress is negative, fluid pressure is positive.", &
      "* Rates are per metre of thickness.", &
      "* Groups and names may be in upper or lower case. Texts are taken as they are.", &
      "* A group is given once, unless it says `repeated`: then once per item.", &
  "* `include 'rock.inc'` between groups stands for the groups of that file, which is looked for", &
      "  beside the file that includes it, and may include others: at most 1000 files, nested at", &
      "  most 20 deep.", &
   "* `&define depth = 2500.0, stress = '-24.0e3*depth' /` gives names to numbers. From there on", &
      "  a text in place of a number is an expression of numbers, such names, + - * / ^ and", &
      "  brackets: `sxx = 'stress', syy = '0.6*stress'`. At most 1000 values have names, and an", &
      "  expression has at most 10000 characters.", &
   "* A file has at most 4 MB, all files of a scene have at most 10 MB together, and a scene has", &
      "  at most 10000 groups. Pipes and devices are not read.", &
      "* Unknown groups and names, values of the wrong kind, values out of range and values that", &
      "  contradict each other are errors; nothing is run or written then.", &
      "* Every run writes `scene.nml`, the scene as understood with every default written out."]
   !&>

   !> What a scene can say, and whether either kind can say it.
   type :: row_t
      character(len=72) :: what = ""
      character(len=56) :: without = ""
      character(len=88) :: with = ""
   end type row_t

   type(row_t), parameter :: rows(*) = [ &
                             row_t("body", "rectangle, disc, polygon", &
                                 "the same; except for a rectangle the window is the whole body"), &
                             row_t("rock by region", "yes", &
                                  "yes, and permeability, porosity, Biot's coefficient, density"), &
                             row_t("gravity, stress in situ", "yes", &
                                   "yes, and hydrostatic pressure"), &
               row_t("sides: displacement, traction in x and y, along and across, springs", "yes", &
                                   "yes"), &
                             row_t("sides: pressure, inflow", "no: there is no fluid", &
                                   "yes"), &
                       row_t("time-dependent sides", "no: loads vary by the load factor, `&load`", &
                                   "yes, all values but springs"), &
                             row_t("unloading", "a load factor that decreases, or a load cycle", &
                                   "decreasing values of sides, extraction wells"), &
                             row_t("restraints, point loads", "yes", &
                              "yes; the window is then the whole body, since a square does not "// &
                                   "include them"), &
                             row_t("faces `friction`, `frictionless`", "yes", &
                                   "yes"), &
                             row_t("faces `open`", "yes", &
                    "no: overlapping faces would have negative fluid volume; use `frictionless`"), &
                             row_t("faces with a given `slip`", "yes", &
                                "no: prescribed slip would need a schedule; use wells and sides"), &
                             row_t("faces `held_closed`", "yes", &
                                   "no: fluid could not open them"), &
                             row_t("`face_pressure`", "yes", &
                                   "no: replaced by the fluid pressure"), &
                             row_t("radiation damping", "no: there is no time", &
                                   "yes, without intensities"), &
                             row_t("growth", "in equilibrium, `paris`", &
                                   "in equilibrium, `paris`"), &
                             row_t("mesh", "`&fe`, and adaptive refinement by `&adaptive`", &
                                   "`&coarse`, and `&fine` windows around the tips")]

contains

   !> Write the page to an open unit.
   subroutine describe_input(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      do i = 1, size(introduction)
         write (unit, "(a)") trim(introduction(i))
      end do
      do i = 1, size(groups)
         call describe_group(unit, groups(i))
      end do
      call describe_parity(unit)
   end subroutine describe_input

   subroutine describe_group(unit, group)
      integer, intent(in) :: unit
      type(group_t), intent(in) :: group
      integer :: i

      write (unit, "(a)") ""
      if (group%repeated) then
         write (unit, "(a)") "## &"//trim(group%name)//" (repeated)"
      else
         write (unit, "(a)") "## &"//trim(group%name)
      end if
      write (unit, "(a)") "", trim(group%meaning)//scene_words(group%scenes), ""
      write (unit, "(a)") "| name | kind | unit | default | allowed | meaning |", &
         "|---|---|---|---|---|---|"
      do i = 1, size(parameters)
         if (parameters(i)%group /= group%name) cycle
         write (unit, "(a)") "| `"//trim(parameters(i)%name)//"` | "//kind_words(parameters(i))// &
            " | "//trim(parameters(i)%unit)//" | "//default_words(parameters(i))//" | "// &
            allowed_words(parameters(i))//" | "//trim(parameters(i)%meaning)// &
            table_words(parameters(i))//" |"
      end do
   end subroutine describe_group

   !> Which scenes may have a group, as a sentence.
   pure function scene_words(scenes) result(words)
      integer, intent(in) :: scenes
      character(len=:), allocatable :: words

      words = ""
      if (scenes == in_fluid) words = " Only in scenes with &fluid."
      if (scenes == in_mechanics) words = " Only in scenes without &fluid."
   end function scene_words

   !> Who may give a parameter and beside what, as the end of a phrase.
   pure function table_words(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      words = ""
      if (parameter%with /= "") words = "; given together with "//trim(parameter%with)
      if (parameter%of /= "" .and. parameter%need /= need_choice) then
         words = words//"; only with "//choice_words(parameter)
      end if
      if (parameter%scenes == in_fluid) words = words//"; only with &fluid"
      if (parameter%scenes == in_mechanics) words = words//"; only without &fluid"
   end function table_words

   !> The choice that a parameter belongs to.
   pure function choice_words(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      words = "the "//choice_name(parameter)//" '"//choice_value(parameter)//"'"
   end function choice_words

   pure function kind_words(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      select case (parameter%kind)
      case (kind_real)
         words = "number"
         if (parameter%choices /= "") words = "number or text"
      case (kind_reals)
         words = "list of numbers"
      case (kind_integer)
         words = "whole number"
      case (kind_wholes)
         words = "list of whole numbers"
      case (kind_logical)
         words = "logical"
      case default
         words = "text"
      end select
   end function kind_words

   pure function default_words(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      if (parameter%default /= "") then
         words = "`"//trim(parameter%default)//"`"
         return
      end if
      select case (parameter%need)
      case (need_always)
         words = "required"
      case (need_fluid)
         words = "required with &fluid"
      case (need_fracture)
         words = "required with &fracture"
      case (need_tips)
         words = "required with growth or intensities"
      case (need_growth)
         words = "required with growth"
      case (need_choice)
         words = "required with "//choice_words(parameter)
      case default
         words = trim(parameter%absent)
         if (.not. parameter%derived) words = "none: "//words
      end select
   end function default_words

   !> The words that may be chosen.
   pure function listed(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words
      character(len=*), parameter :: separator = "`, `"
      integer :: bar

      words = trim(parameter%choices)
      bar = index(words, "|")
      do while (bar > 0)
         words = words(1:bar - 1)//separator//words(bar + 1:)
         bar = index(words, "|")
      end do
      words = "`"//words//"`"
   end function listed

   pure function allowed_words(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      select case (parameter%kind)
      case (kind_choice)
         words = listed(parameter)
      case (kind_logical)
         words = "`.true.`, `.false.`"
      case (kind_name)
         words = "at most 64 letters, digits, `_`, `-`, `.`"
      case (kind_integer, kind_real, kind_reals, kind_wholes)
         words = in_words(parameter%range, whole=any(parameter%kind == [kind_integer, kind_wholes]))
         if (parameter%at_most /= "") then
            if (words /= "") words = words//", "
            words = words//"at most "//trim(parameter%at_most)
         end if
         if (words == "") words = "any finite"
         if (parameter%choices /= "") words = words//", or "//listed(parameter)
      case default
         words = "at most 256 bytes of UTF-8"
      end select
   end function allowed_words

   !> Write the section to an open unit.
   subroutine describe_parity(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      write (unit, "(a)") "", "## With and without a fluid", "", &
         "Where a column has no, the scene is refused with a message.", "", &
         "| | without &fluid | with &fluid |", "|---|---|---|"
      do i = 1, size(rows)
         write (unit, "(a)") "| "//trim(rows(i)%what)//" | "//trim(rows(i)%without)//" | "// &
            trim(rows(i)%with)//" |"
      end do
   end subroutine describe_parity

end module scene_describe
