!> The one table of everything a scene file can say: its groups, and the names of
!> scene_parameter_table.
!>
!> Reading, checking of single values, writing of scene.nml and docs/input.md all follow from it.
!> A new parameter is one entry there and one line in scene_exchange.
module scene_parameters
   use scene_parameter_table, only: body_parameters, fracture_parameters, group_t, in_all, &
                                    in_fluid, in_mechanics, kind_choice, kind_integer, &
                                    kind_logical, kind_name, kind_real, kind_reals, kind_text, &
                                    kind_wholes, need_always, need_choice, need_fluid, &
                                    need_fracture, need_growth, need_never, need_tips, &
                                    numerics_parameters, parameter_t, process_parameters, &
                                    rock_parameters, text_length
   implicit none(type, external)
   private

   public :: group_t, parameter_t
   public :: groups, parameters, side_names, text_length
   public :: kind_choice, kind_integer, kind_logical, kind_name, kind_real, kind_reals, kind_text
   public :: kind_wholes
   public :: need_always, need_choice, need_fluid, need_fracture, need_growth, need_never
   public :: need_tips
   public :: applies, choice_name, choice_value, in_all, in_fluid, in_mechanics

   !> Sides of the body in the order of scene_t%sides.
   character(len=6), parameter :: side_names(4) = ["left  ", "right ", "bottom", "top   "]

   ! The table keeps its own layout.
   !&<
   type(group_t), parameter :: groups(*) = [ &
      group_t("scene", implied=.true., meaning="What the scene is called."), &
      group_t("domain", implied=.true., &
         meaning="The body, of unit thickness: a rectangle, a disc "// &
              "or a polygon."), &
      group_t("material", implied=.true., &
              meaning="The rock, linear elastic and porous. The storage coefficient that "// &
              "follows from it must be positive, and `biot` at least `porosity`. Permeability "// &
              "is either isotropic or a positive definite tensor."), &
      group_t("fluid", &
              meaning="The fluid in pores and fractures. A scene without this group is "// &
              "mechanics only, and can have neither injections nor pressures: finite elements "// &
              "on the whole body under a load that rises or falls."), &
      group_t("region", repeated=.true., &
              meaning="A part of the body with rock of its own: what it does not give is that "// &
              "of &material. It may reach beyond the body, and fractures may cross it. Where "// &
              "two overlap, the later one in the file counts. Coarse cells follow its outline "// &
              "where there is room; one that the outline cuts takes means of the rocks, so a "// &
              "region should be wider than a cell."), &
      group_t("fracture", repeated=.true., &
              meaning="A fracture: a polyline inside the domain. Its ends may lie on the "// &
              "boundary; it must not run along the boundary. With a fluid such an end is "// &
              "sealed, unless the side has a pressure, which then is that of the end; and "// &
              "fractures may cross, touch or share ends as long as none grows. Of a joint that "// &
              "closes under pressure (normal_stiffness), jumps and stress intensity factors "// &
              "count from faces that touch without, in a scene with a stress in situ from "// &
              "that. What grows from a fracture has its friction, but no closure, bond or skin."), &
      group_t("side", repeated=.true., &
             meaning="A side of the body: of a rectangle one of its four, of a polygon some of "// &
              "its edges, of a disc its rim or an arc of it. Per component either the "// &
              "displacement or the total traction is prescribed; what is not given is free of "// &
            "traction. Displacements or springs must hold the body against translation and "// &
              "rotation. With a fluid all values may change with time."), &
      group_t("restraint", repeated=.true., &
              meaning="A point of the body held in place. It becomes a node of the mesh, and "// &
              "must not lie on a fracture, unless at a tip: each face has nodes of its own. "// &
              "Three components hold a body that nothing else does, and bear nothing where its "// &
              "loads are in balance; what they bear otherwise is a point load, around which "// &
              "results depend on the size of cells."), &
      group_t("point_load", repeated=.true., &
              meaning="A force at a point of the body, per metre of thickness, times the load "// &
              "factor. The point becomes a node of the mesh, and must not lie on a fracture, "// &
              "unless at a tip: each face has nodes of its own."), &
      group_t("injection", repeated=.true., scenes=in_fluid, &
              meaning="A well, at a rate, at a pressure, or at a rate up to a pressure, in "// &
              "stages. It feeds a fracture as it is at the start, or the cell nearest to a "// &
              "point of it (two equally near: half each), where fractures meet all of them; or "// &
              "the rock around a point. No step straddles the beginning of a stage, or its "// &
              "reaching or leaving of a limit."), &
      group_t("initial", implied=.true., scenes=in_fluid, &
              meaning="State before the first step."), &
      group_t("time", implied=.true., scenes=in_fluid, meaning="Time steps."), &
      group_t("in_situ", implied=.true., &
              meaning="Stress in the body before the load, in equilibrium with tractions on "// &
              "its sides, which go on acting beside those of &side, and with gravity where it "// &
              "changes with y. The load factor does not scale it. With a fluid it is the total "// &
              "stress at the initial pressure."), &
      group_t("gravity", implied=.true., &
              meaning="Acceleration that gives the rock its weight, density times gravity, "// &
              "which the load factor does not scale. An in-situ stress that changes with y "// &
              "carries it from the start; without one it loads the body. A fluid with a "// &
              "density has weight too: its pressure grows with depth from the start."), &
      group_t("load", implied=.true., scenes=in_mechanics, &
              meaning="How the load changes: tractions, point loads and displacements are "// &
              "those of the scene times a factor, which rises, or falls where to is less than "// &
              "from, or goes to and fro between factors; the first state, at from, is reached "// &
              "from nothing. Faces keep what they have slipped until friction lets them slip "// &
              "back, and cracks do not heal. With growth the factor at which the next tip "// &
              "grows is found, and never stepped over."), &
      group_t("fe", implied=.true., scenes=in_mechanics, &
              meaning="Finite elements on the whole body: six-node triangles, with "// &
              "quarter-point elements around the fracture tips."), &
      group_t("adaptive", implied=.true., scenes=in_mechanics, &
              meaning="Meshes that follow the estimated error of the stresses (Zienkiewicz and "// &
          "Zhu): after the first mesh of the body and after every growth. Within size_boundary "// &
              "of a point load, whose energy is infinite, the error does not count."), &
      group_t("coarse", implied=.true., scenes=in_fluid, &
              meaning="The coarse level: finite volumes on the whole body."), &
      group_t("fine", implied=.true., scenes=in_fluid, &
              meaning="The fine level: finite elements in a window around each fracture tip. "// &
              "Used where growth or stress intensity factors are asked for."), &
      group_t("growth", implied=.true., meaning="Fracture growth."), &
      group_t("probe", repeated=.true., &
              meaning="A point of the rock where the state is recorded in probes.csv."), &
      group_t("output", implied=.true., meaning="What is written, and how often.")]
   !&>

   type(parameter_t), parameter :: parameters(*) = [ &
                                   body_parameters, rock_parameters, fracture_parameters, &
                                   process_parameters, numerics_parameters]

contains

   !> Whether a scene with or without a fluid may have a group or a parameter.
   elemental logical function applies(scenes, has_fluid)
      integer, intent(in) :: scenes  !< in_all, in_fluid or in_mechanics
      logical, intent(in) :: has_fluid

      applies = scenes == in_all .or. (scenes == in_fluid .eqv. has_fluid)
   end function applies

   !> The name that makes the choice to which a parameter belongs.
   pure function choice_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter  !< of a choice
      character(len=:), allocatable :: name

      name = parameter%of(:index(parameter%of, "=") - 1)
   end function choice_name

   !> What that name must be.
   pure function choice_value(parameter) result(value)
      type(parameter_t), intent(in) :: parameter  !< of a choice
      character(len=:), allocatable :: value

      value = trim(parameter%of(index(parameter%of, "=") + 1:))
   end function choice_value

end module scene_parameters
