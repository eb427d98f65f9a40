!> What a scene file can say of meshes, growth and output.
module scene_parameters_numerics
   use scene_intervals, only: at_least_zero, newton_range, passes_range, positive, &
                              rosette_range, share, tolerance_range
   use scene_parameter_types, only: in_fluid, kind_choice, kind_integer, kind_logical, &
                                    kind_name, need_always, need_fracture, need_tips, parameter_t
   implicit none(type, external)
   private

   public :: numerics_parameters

   ! The table keeps its own layout.
   !&<
   type(parameter_t), parameter :: numerics_parameters(*) = [ &
      parameter_t("fe", "size_fracture", unit="m", need=need_fracture, range=positive, &
                  absent="no fracture", &
                  at_most="size_boundary", &
                  meaning="Element size at the fractures, at most the length of each fracture"), &
      parameter_t("fe", "size_boundary", unit="m", need=need_always, range=positive, &
                  meaning="Element size far from the fractures, at most the shorter edge of "// &
                  "the domain"), &
      parameter_t("fe", "rosette_radius", unit="m", range=positive, absent="size_fracture", &
                  derived=.true., &
                  meaning="Size of the elements around a tip, less where something is near"), &
      parameter_t("fe", "rosette_sectors", kind_integer, default="12", range=rosette_range, &
                  meaning="Quarter-point elements around a tip"), &
      parameter_t("fe", "element", kind_choice, default="'quarter_point'", &
                  choices="quarter_point|collapsed|plain", &
                  meaning="Around a tip: triangles with quarter points, collapsed "// &
                  "quadrilaterals with quarter points, or triangles like all others"), &
      parameter_t("adaptive", "enabled", kind_logical, default=".false.", &
                  meaning="The mesh follows the error"), &
      parameter_t("adaptive", "tolerance", default="0.01", range=share, &
                  meaning="Wanted error of the stresses in the energy norm, over the norm"), &
      parameter_t("adaptive", "passes", kind_integer, default="4", range=passes_range, &
                  meaning="Meshes after the first at most"), &
      parameter_t("coarse", "size_fracture", unit="m", need=need_fracture, range=positive, &
                  absent="no fracture", &
                  at_most="size_boundary", &
                  meaning="Cell size dH at the fractures, at most the length of each fracture"), &
      parameter_t("coarse", "size_boundary", unit="m", need=need_always, range=positive, &
                  meaning="Cell size far from the fractures, at most the shorter edge of the "// &
                  "domain"), &
      parameter_t("coarse", "newton_max", kind_integer, default="30", range=newton_range, &
                  meaning="Newton iterations before a step is cut"), &
      parameter_t("coarse", "newton_tolerance", default="1.0e-9", range=tolerance_range, &
                  meaning="Relative residual at which a step has converged"), &
      parameter_t("coarse", "condensation", kind_choice, default="'auto'", &
                  choices="auto|full|sparse", &
                 meaning="How the fractures' equations are solved: on a full matrix onto which "// &
                  "the rock is condensed, or without it; `auto` takes what is cheaper"), &
      parameter_t("fine", "window", unit="m", need=need_tips, range=positive, &
                  choices="body", absent="no fine level", &
                 meaning="Edge l of the square window around a tip, more than 2 size_ratio dH; "// &
                  "or the whole body, one window for all tips"), &
      parameter_t("fine", "size_ratio", default="0.5", range=share, &
                  meaning="Fine mesh size at the tip as a share eps_m of dH"), &
      parameter_t("fine", "rosette_sectors", kind_integer, default="12", range=rosette_range, &
                  meaning="Quarter-point elements around a tip"), &
      parameter_t("fine", "face_condition", kind_choice, default="'contact'", &
                  choices="contact|jump|traction", &
                  meaning="On old fracture faces: contact solved again, or the coarse jump or "// &
                  "traction"), &
      parameter_t("growth", "enabled", kind_logical, default=".false.", meaning="Fractures grow"), &
      parameter_t("growth", "intensities", kind_logical, default=".false.", &
                  meaning="Compute stress intensity factors; always done with growth"), &
      parameter_t("growth", "law", kind_choice, default="'equilibrium'", &
                  choices="equilibrium|paris", &
                  meaning="Growing tips stay at K_eq = K_IC as time goes on or the load "// &
                  "changes, or advance by steps, at one load, by the Paris-type law of the "// &
                  "thesis"), &
      parameter_t("growth", "increment", unit="m", range=at_least_zero, derived=.true., &
                  absent="the fine mesh size, or size_fracture", &
                  meaning="Largest advance l_max of a tip at a time, or length of a piece of "// &
                  "its path; 0: the default, "// &
                  "the fine mesh size, or without a fluid size_fracture"), &
      parameter_t("growth", "exponent", default="0.35", range=at_least_zero, &
                  meaning="Exponent m of advance = l_max (G/G_max)^m, with law = 'paris'"), &
      parameter_t("growth", "threshold", scenes=in_fluid, default="0.5", range=positive, &
                 meaning="Growth is handed to the coarse level at this share eps_p of dH, with "// &
                  "law = 'paris'"), &
      parameter_t("growth", "new_aperture", unit="m", default="1.0e-5", range=positive, &
                  scenes=in_fluid, &
                  meaning="Residual aperture of new fracture cells: a roughness that conducts "// &
                  "fluid but holds none, unless new_volume is 'prefilled'"), &
      parameter_t("growth", "new_volume", kind_choice, default="'conserved'", &
                  scenes=in_fluid, &
                  choices="conserved|prefilled", &
                  meaning="Fluid of new cells: drawn from the connected cells as they open, or "// &
                  "appearing with them"), &
      parameter_t("growth", "stop_gain", unit="m", range=positive, absent="no limit", &
                  meaning="The run ends when any fracture end has grown by this"), &
      parameter_t("probe", "name", kind_name, need=need_always, &
                  meaning="Name, different from that of every other probe"), &
      parameter_t("probe", "x", unit="m", need=need_always, meaning="x, within the domain"), &
      parameter_t("probe", "y", unit="m", need=need_always, meaning="y, within the domain"), &
      parameter_t("output", "vtu", kind_logical, default=".true.", meaning="Write VTU fields"), &
      parameter_t("output", "interval", unit="s", range=at_least_zero, scenes=in_fluid, &
                  absent="the regular step", derived=.true., &
                  meaning="Time between written fields; 0: the regular step"), &
      parameter_t("output", "growth_states", kind_integer, range=at_least_zero, default="200", &
                  meaning="Most states of growth that VTU files are written of beside those of "// &
                  "interval or of the load's steps"), &
      parameter_t("output", "stimulated_jump", unit="m", default="1.0e-6", range=positive, &
                  scenes=in_fluid, &
                  meaning="Slip or opening since the start from which faces of fractures count "// &
                  "as stimulated, and mean slip from which slip_events.csv has an event"), &
      parameter_t("output", "out_of_plane_length", unit="m", default="1.0", range=positive, &
                  scenes=in_fluid, &
                meaning="Assumed length of the fractures out of the plane, for area and moment "// &
                  "in slip_events.csv; nothing else depends on it"), &
      parameter_t("output", "seismic_slip_rate", unit="m/s", default="1.0e-3", range=positive, &
                  scenes=in_fluid, &
                  meaning="Slip rate from which slip is seismic: where the largest one of a "// &
                  "patch passes it, an event of slip_events.csv ends and another one begins")]
   !&>

end module scene_parameters_numerics
