!> What a scene file can say of fractures.
module scene_parameters_fracture
   use scene_intervals, only: at_least_zero, dilation_range, positive
   use scene_parameter_types, only: in_fluid, in_mechanics, kind_choice, kind_logical, &
                                    kind_name, kind_reals, need_always, need_choice, need_fluid, &
                                    parameter_t
   implicit none(type, external)
   private

   public :: fracture_parameters

   ! The table keeps its own layout.
   !&<
   type(parameter_t), parameter :: fracture_parameters(*) = [ &
      parameter_t("fracture", "name", kind_name, need=need_always, &
                  meaning="Name, different from that of every other fracture"), &
      parameter_t("fracture", "x", kind_reals, "m", need_always, &
                  meaning="x of the vertices, from one end to the other"), &
      parameter_t("fracture", "y", kind_reals, "m", need_always, meaning="y of the vertices"), &
      parameter_t("fracture", "law", kind_choice, default="'friction'", &
                  choices="friction|frictionless|slip|open", &
                  meaning="What the faces do; open and slip only without a fluid. "// &
                  "Slip: contact with a given slip; open: free of traction, free to overlap"), &
      parameter_t("fracture", "slip", unit="m", need=need_choice, absent="not given", &
                  of="law=slip", scenes=in_mechanics, &
                  meaning="Given slip, left against right side in the fracture's direction, "// &
                  "times the load factor"), &
      parameter_t("fracture", "slip_taper", unit="m", range=positive, scenes=in_mechanics, &
                  of="law=slip", &
                  absent="half the fracture's length", derived=.true., &
                  meaning="The given slip rises from a free end as a quarter of an ellipse of "// &
                  "this length"), &
      parameter_t("fracture", "friction", need=need_choice, range=at_least_zero, &
                  of="law=friction", absent="no friction", &
                  meaning="Coefficient of friction mu_s; 0: frictionless"), &
      parameter_t("fracture", "friction_residual", with="weakening_slip", range=at_least_zero, &
                  of="law=friction", at_most="friction", absent="friction does not weaken", &
                  meaning="Friction mu_r that is left after weakening_slip"), &
      parameter_t("fracture", "weakening_slip", unit="m", range=positive, of="law=friction", &
                  with="friction_residual", absent="friction does not weaken", &
                  meaning="Slip over which friction falls, linearly with the path that the "// &
                  "faces have slipped"), &
      parameter_t("fracture", "dilation_slip", unit="m", range=positive, of="law=friction", &
                  absent="dilation goes on", &
                  meaning="Slip at which dilation ends"), &
      parameter_t("fracture", "dilation_deg", unit="degree", default="0.0", range=dilation_range, &
                  of="law=friction", &
                  meaning="Dilation angle psi: slip opens the fracture by tan(psi) of itself"), &
      parameter_t("fracture", "normal_stiffness", unit="Pa/m", with="closure", range=positive, &
                  absent="closed faces are rigid", &
                  meaning="Stiffness k_ni at which faces that touch without pressure begin to "// &
                  "close under it, s = k_ni d/(1 - d/closure)"), &
      parameter_t("fracture", "closure", unit="m", with="normal_stiffness", range=positive, &
                  absent="closed faces are rigid", &
                  meaning="Largest closure d under contact pressure; aperture is that of faces "// &
                  "that touch without. Wings do not close"), &
      parameter_t("fracture", "cohesion", unit="Pa", range=positive, of="law=friction", &
                  absent="no bond", &
                  meaning="Shear strength of a bond beside friction. Slip of weakening_slip "// &
                  "breaks it for good; friction_residual may be friction"), &
      parameter_t("fracture", "tensile_strength", unit="Pa", range=positive, of="law=friction", &
                  with="opening_weakening", absent="no bond", &
                  meaning="Tension that the same bond bears, at most cohesion/friction"), &
      parameter_t("fracture", "opening_weakening", unit="m", range=positive, of="law=friction", &
                  with="tensile_strength", absent="no bond", &
                  meaning="Opening that breaks the bond, with the energy tensile_strength "// &
                  "opening_weakening/2"), &
      parameter_t("fracture", "toughness", unit="Pa m^1/2", range=positive, &
                  absent="that of the rock", &
                  meaning="K_IC at which its tips and those of its wings grow, whatever rock "// &
                  "they are in"), &
      parameter_t("fracture", "skin", unit="Pa s/m", scenes=in_fluid, range=positive, &
                  absent="no skin", &
                  meaning="Pressure over flux that a layer on each face takes between fracture "// &
                  "and rock; faces that grow have none"), &
      parameter_t("fracture", "held_closed", kind_logical, default=".false.", &
                  scenes=in_mechanics, &
                  meaning="The faces slide but never part, and friction goes on with the "// &
                  "normal traction where that is tension: a model of reference solutions. "// &
                  "Faces that grow may part"), &
      parameter_t("fracture", "face_pressure", unit="Pa", default="0.0", scenes=in_mechanics, &
                  meaning="Pressure that pushes the faces apart, those of its wings too, times "// &
                  "the load factor; contact carries the rest"), &
      parameter_t("fracture", "aperture", unit="m", need=need_fluid, range=positive, absent="0", &
                  meaning="Residual hydraulic aperture a_0 of the closed fracture")]
   !&>

end module scene_parameters_fracture
