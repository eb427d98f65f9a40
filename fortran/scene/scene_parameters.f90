!> The elements of a scene file: the groups, and the properties of the names in them, which
!! scene_parameter_table lists. Reading, checks of single values, writing of scene.nml and the table
!! of names (report_describe) follow from both tables.
module scene_parameters
   use scene_words, only: interval_t
   implicit none(type, external)
   private

   public :: group_t, parameter_t, groups, side_names, text_length, kind_choice, kind_integer
   public :: kind_logical, kind_name, kind_names, kind_real, kind_reals, kind_text, kind_wholes
   public :: need_always, need_choice, need_fluid, need_growth, need_never, applies, choice_name
   public :: choice_value, in_fluid, in_mechanics

   integer, parameter :: kind_real = 1
   integer, parameter :: kind_reals = 2  !< a list of any length
   integer, parameter :: kind_integer = 3
   integer, parameter :: kind_logical = 4
   integer, parameter :: kind_text = 5
   integer, parameter :: kind_name = 6  !< a text that is safe as a file name
   integer, parameter :: kind_choice = 7  !< one of `choices`
   integer, parameter :: kind_wholes = 8  !< a list of whole numbers, stored as reals

   integer, parameter :: kind_names = 9  !< a list of names

   integer, parameter :: need_never = 0
   integer, parameter :: need_always = 1  !< in every group of this name
   integer, parameter :: need_fluid = 2  !< in scenes with a fluid
   integer, parameter :: need_growth = 3  !< with growth
   integer, parameter :: need_choice = 4  !< with the choice of `of`

   ! Scenes that may have a group or a parameter.
   integer, parameter :: in_all = 0
   integer, parameter :: in_fluid = 1  !< scenes with &fluid
   integer, parameter :: in_mechanics = 2  !< scenes without &fluid: mechanics only

   integer, parameter :: text_length = 256  !< longest text; names are shorter (scene_types)

   !> A namelist group.
   type :: group_t
      character(len=12) :: name = ""
      logical :: repeated = .false.  !< one group per item
      logical :: implied = .false.  !< an absent group has the defaults
      integer :: scenes = in_all  !< scenes that may have the group
      character(len=600) :: meaning = ""
   end type group_t

   !> A name within a group.
   type :: parameter_t
      character(len=12) :: group = ""
      character(len=20) :: name = ""
      integer :: kind = kind_real
      character(len=8) :: unit = "-"
      integer :: need = need_never
      character(len=16) :: default = ""  !< default in the form of a file; empty: none
      character(len=40) :: absent = ""  !< meaning of an absent name without a default
      logical :: derived = .false.  !< `absent` is a default that follows from other values
      type(interval_t) :: range = interval_t()
      integer :: scenes = in_all  !< scenes that may have the name
      !> choices, separated by `|`; for a single number: words allowed instead of it
      character(len=32) :: choices = ""
      character(len=160) :: meaning = ""
      logical :: per_entry = .false.  !< a list by entries of a well, and so not by its stages
      character(len=16) :: only_with = ""  !< groups, by `|`, of which the scene must have one
      ! Relations to other names of its group:
      character(len=28) :: of = ""  !< choice of the name, as `law=slip`; empty: every choice
      character(len=20) :: with = ""  !< name that must be given with this one
      character(len=20) :: at_most = ""  !< name of an upper bound
   end type parameter_t

   !> Sides of the body in the order of scene_t%sides.
   character(len=6), parameter :: side_names(4) = ["left  ", "right ", "bottom", "top   "]

   ! The table keeps its own layout.
   !&<
   type(group_t), parameter :: groups(*) = [ &
      group_t("scene", implied=.true., meaning="Name and title of the scene."), &
      group_t("domain", implied=.true., &
         meaning="The body, of unit thickness: a rectangle, a disc or a polygon."), &
      group_t("material", implied=.true., &
         meaning="The rock, linear poroelastic. The resulting storage coefficient must be "// &
                 "positive, and `biot` at least `porosity`. Permeability is either isotropic "// &
                 "or a positive definite tensor."), &
      group_t("fluid", &
         meaning="The fluid in pores and fractures. A scene without this group is mechanics "// &
                 "only, without injections and pressures: finite elements on the whole body "// &
                 "under a variable load."), &
      group_t("region", repeated=.true., &
         meaning="A part of the body with its own rock properties; omitted ones are those of "// &
                 "&material. It may extend beyond the body, and fractures may cross it. Where "// &
                 "two overlap, the later one in the file applies. Coarse cells follow its "// &
                 "outline where there is room; cut cells have averages of the rocks, so a "// &
                 "region should be wider than a cell."), &
      group_t("fracture", repeated=.true., &
         meaning="A fracture: a polyline inside the domain. Its ends may lie on the boundary; "// &
                 "it must not run along the boundary. With a fluid such an end is sealed "// &
                 "unless the side has a prescribed pressure, which is then that of the end; "// &
                 "and fractures may cross, touch or share ends as long as none grows. With "// &
                 "joint closure (normal_stiffness), jumps and stress intensity factors are "// &
                 "relative to faces in contact without stress, or with a stress in situ to "// &
                 "that state. Wings of a fracture have its friction, but no closure, bond or "// &
                 "skin."), &
      group_t("side", repeated=.true., &
         meaning="A side of the body: one of four of a rectangle, some edges of a polygon, the "// &
                 "rim of a disc or an arc of it. Per component either the displacement or the "// &
                 "total traction is prescribed; by default it is traction-free. Displacements "// &
                 "or springs must prevent translation and rotation of the body. With a fluid "// &
                 "all values may vary in time."), &
      group_t("restraint", repeated=.true., &
         meaning="A fixed point of the body. It becomes a node of the mesh, and must not lie "// &
                 "on a fracture except at a tip, since each face has separate nodes. Three "// &
                 "components fix the rigid motions of a body, without force if its loads are "// &
                 "in equilibrium; otherwise the force is a point load, around which results "// &
                 "depend on the cell size."), &
      group_t("point_load", repeated=.true., &
         meaning="A force at a point of the body, per metre of thickness, times the load "// &
                 "factor. The point becomes a node of the mesh, and must not lie on a fracture "// &
                 "except at a tip, since each face has separate nodes."), &
      group_t("injection", repeated=.true., scenes=in_fluid, &
         meaning="A well, at a rate, at a pressure, or at a rate up to a pressure, in stages. "// &
                 "It supplies the initial length of a fracture, or the place on it nearest to "// &
                 "a point, at an intersection all fractures; or the rock around a point. No "// &
                 "step straddles the beginning of a stage, or the time at which a limit is "// &
                 "reached or left."), &
      group_t("initial", implied=.true., scenes=in_fluid, meaning="State before the first step."), &
      group_t("heat", scenes=in_fluid, &
         meaning="Heat in rock and fractures: conduction, and what the fluid carries; none "// &
                 "without this group. Temperatures act on stresses and pressures by "// &
                 "heat_expansion, on viscosity by table_temperature."), &
      group_t("temperature", scenes=in_mechanics, &
         meaning="Change of temperature of a body without a fluid, times the load factor: "// &
                 "linear in x and y, and that of a plane face which has changed at once, "// &
                 "face_change erfc(distance/face_depth). It acts by heat_expansion of the rock."), &
      group_t("time", implied=.true., scenes=in_fluid, meaning="Time steps."), &
      group_t("in_situ", implied=.true., &
         meaning="Stress in the body before loading, in equilibrium with tractions on its "// &
                 "sides, which act in addition to those of &side, and with gravity if it "// &
                 "varies with y. The load factor does not scale it. With a fluid it is the "// &
                 "total stress at the initial pressure."), &
      group_t("gravity", implied=.true., &
         meaning="Acceleration for the weight of the rock, density times gravity, which the "// &
                 "load factor does not scale. An in-situ stress that varies with y balances it "// &
                 "from the start; otherwise it loads the body. A fluid with a density has "// &
                 "weight too: its pressure increases with depth from the start."), &
      group_t("load", implied=.true., scenes=in_mechanics, &
         meaning="Load programme: tractions, point loads and displacements are those of the "// &
                 "scene times a factor, which increases, or decreases if to is less than from, "// &
                 "or follows a table of factors; the first state, at from, is reached from "// &
                 "zero load. Slip is retained until friction allows reverse slip, and cracks "// &
                 "do not heal. With growth the factor of the next onset is found, and never "// &
                 "stepped over."), &
      group_t("fe", implied=.true., scenes=in_mechanics, &
         meaning="Finite elements on the whole body: six-node triangles, with quarter-point "// &
                 "elements around the fracture tips."), &
      group_t("adaptive", implied=.true., &
         meaning="Adaptive meshes. Without &fluid: by the estimated error of the stresses "// &
                 "(Zienkiewicz and Zhu), for the first mesh and after growth. Within "// &
                 "size_boundary of a point load, whose energy is infinite, the error is "// &
                 "ignored. With &fluid: by the error of the response to the wells in trial "// &
                 "steps, before the first step, without growth (docs/theory.md)."), &
      group_t("coarse", implied=.true., scenes=in_fluid, &
         meaning="The coarse level: finite volumes on the whole body."), &
      group_t("fine", implied=.true., scenes=in_fluid, &
         meaning="The fine level: finite elements in a window around each fracture tip. Used "// &
                 "with growth or stress intensity factors."), &
      group_t("growth", implied=.true., meaning="Fracture growth."), &
      group_t("probe", repeated=.true., &
         meaning="A point of the rock where the state is recorded in probes.csv."), &
      group_t("output", implied=.true., meaning="Output of fields and derived quantities.")]
   !&>

contains

   !> A scene with or without a fluid may have a group or a parameter.
   elemental logical function applies(scenes, has_fluid)
      integer, intent(in) :: scenes  !< in_all, in_fluid or in_mechanics
      logical, intent(in) :: has_fluid

      applies = scenes == in_all .or. (scenes == in_fluid .eqv. has_fluid)
   end function applies

   !> Name of the choice to which a parameter belongs, as `law`.
   pure function choice_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter  !< of a choice
      character(len=:), allocatable :: name

      name = parameter%of(:index(parameter%of, "=") - 1)
   end function choice_name

   !> Value of the choice to which a parameter belongs, as `slip`.
   pure function choice_value(parameter) result(value)
      type(parameter_t), intent(in) :: parameter  !< of a choice
      character(len=:), allocatable :: value

      value = trim(parameter%of(index(parameter%of, "=") + 1:))
   end function choice_value

end module scene_parameters
