!> What a scene file can say of wells, what was before, time and loads.
module scene_parameters_process
   use scene_intervals, only: at_least_zero, below_one, positive, share, steps_range
   use scene_parameter_types, only: kind_choice, kind_integer, kind_name, kind_reals, kind_text, &
                                    need_always, parameter_t
   implicit none(type, external)
   private

   public :: process_parameters

   ! The table keeps its own layout.
   !&<
   type(parameter_t), parameter :: process_parameters(*) = [ &
      parameter_t("injection", "name", kind_name, absent="well_ and its number", derived=.true., &
                  meaning="Name, different from that of every other well"), &
      parameter_t("injection", "fracture", kind_name, absent="in the rock, at x and y", &
                  meaning="Name of the fracture"), &
      parameter_t("injection", "rate", kind_reals, "m2/s", absent="what pressure makes of it", &
                  meaning="Volume per time and per metre of thickness, over the whole well; "// &
                  "negative: extraction. One value, or one per stage"), &
      parameter_t("injection", "pressure", kind_reals, "Pa", absent="no limit", &
               meaning="Pressure of the well, at its depth; beside a rate the one that it does "// &
                  "not pass: the largest in injection, the least in extraction. As rate"), &
      parameter_t("injection", "time", kind_reals, "s", range=at_least_zero, &
                  absent="one stage, from start", &
                  meaning="When each stage begins, in rising order"), &
      parameter_t("injection", "schedule", kind_text, absent="no table", &
                  meaning="CSV file with a row per stage instead of time, rate and pressure: "// &
                  "columns time_s, rate_m2_s, pressure_pa; beside the scene file"), &
      parameter_t("injection", "start", unit="s", default="0.0", range=at_least_zero, &
                  meaning="Time when it begins; with stages that of the first"), &
      parameter_t("injection", "end", unit="s", range=positive, absent="end of the run", &
                  meaning="Time when it is shut, after start and after the last stage's"), &
      parameter_t("injection", "x", unit="m", absent="over the whole fracture", &
                  with="y", meaning="x of the point of injection"), &
      parameter_t("injection", "y", unit="m", absent="over the whole fracture", &
                  with="x", meaning="y of the point of injection"), &
      parameter_t("injection", "storage", unit="m2/Pa", default="0.0", range=at_least_zero, &
                  meaning="Wellbore storage: fluid that the well itself holds, per metre of "// &
                  "thickness and per pressure at its head"), &
      parameter_t("injection", "friction", unit="Pa s/m2", default="0.0", range=at_least_zero, &
                  meaning="Pressure lost between the well's head and the fracture, per rate"), &
      parameter_t("injection", "turbulence", unit="Pa s2/m4", default="0.0", &
                  range=at_least_zero, &
                  meaning="The same per square of the rate"), &
      parameter_t("injection", "radius", unit="m", default="0.1", range=positive, &
                 meaning="Radius of a well in the rock, for its pressure; not one in a fracture"), &
      parameter_t("initial", "fracture_pressure", kind_choice, default="'equilibrated'", &
                  choices="equilibrated|undrained", &
                  meaning="After loading: that of the matrix around the fracture, or what the "// &
                  "load produces in the fracture when nothing has flowed yet"), &
      parameter_t("initial", "pressure", unit="Pa", default="0.0", &
                  meaning="Pore pressure before the load acts; of a fluid with a density that "// &
                  "at y_datum of &in_situ"), &
      parameter_t("time", "end", unit="s", need=need_always, range=positive, &
                  meaning="End of the run"), &
      parameter_t("time", "step", unit="s", range=positive, at_most="end", &
                  absent="as long as tolerance allows", &
                  meaning="The time step; with a tolerance the longest one"), &
      parameter_t("time", "tolerance", range=below_one, derived=.true., &
                  absent="0.01, or 0 with step alone", &
                 meaning="Error in time that a step may make, over the range of pressure, slip "// &
                  "and opening so far; 0: the default, 0.01 without step or with growth in "// &
                  "equilibrium"), &
      parameter_t("time", "growth_factor", default="0.01", range=share, &
                  meaning="Share of step that follows growth with law = 'paris'"), &
      parameter_t("time", "smallest_factor", range=below_one, derived=.true., &
                  at_most="growth_factor", &
                  absent="1e-6, or 1e-9 without step", &
                  meaning="Share of step, or of end without it, below which a cut step ends "// &
                  "the run; no step is cut to less than a 64th of that; 0: the default"), &
      parameter_t("in_situ", "sxx", unit="Pa", default="0.0", meaning="Stress xx at y_datum"), &
      parameter_t("in_situ", "syy", unit="Pa", default="0.0", meaning="Stress yy at y_datum"), &
      parameter_t("in_situ", "sxy", unit="Pa", default="0.0", meaning="Stress xy"), &
      parameter_t("in_situ", "sxx_per_y", unit="Pa/m", default="0.0", &
                  meaning="Change of stress xx per metre upwards"), &
      parameter_t("in_situ", "syy_per_y", unit="Pa/m", default="0.0", &
                  meaning="Change of stress yy per metre upwards; it must carry the weight: "// &
                  "density times gravity g gives density*g"), &
      parameter_t("in_situ", "y_datum", unit="m", default="0.0", &
                  meaning="Where stress xx and yy are those given, and with a density of the "// &
                  "fluid all pressures"), &
      parameter_t("gravity", "x", unit="m/s2", default="0.0", meaning="Acceleration in x"), &
      parameter_t("gravity", "y", unit="m/s2", default="0.0", &
                  meaning="Acceleration in y, on earth -9.81"), &
      parameter_t("load", "from", default="0.0", &
                  meaning="Load factor before the first step"), &
      parameter_t("load", "to", default="1.0", meaning="Load factor at the end, another one"), &
      parameter_t("load", "factors", kind_reals, absent="straight to its end", &
                  meaning="Load factors through which the load is led in turn instead of to: "// &
                  "the table of a load cycle. Each differs from the one before it"), &
      parameter_t("load", "steps", kind_integer, default="1", range=steps_range, &
                  meaning="Equal steps from the one to the other, with factors to each of them"), &
      parameter_t("load", "control", kind_choice, absent="'length', with factors 'dead'", &
                  derived=.true., choices="length|dead", &
                  meaning="Where growth in equilibrium needs less load than before, the factor "// &
                  "follows it down, or stays: then growth is unstable until it arrests")]
   !&>

end module scene_parameters_process
