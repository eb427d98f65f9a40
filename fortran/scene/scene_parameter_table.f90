!> The names of a scene file, each with its group, kind, unit, default, range and meaning. A new
!! name is one entry here and one line in scene_exchange.
module scene_parameter_table
   use scene_body_parameters, only: body_parameters
   use scene_parameters, only: in_fluid, in_mechanics, kind_choice, kind_integer, kind_logical, &
                               kind_name, kind_names, kind_reals, kind_text, need_always, &
                               need_choice, need_fluid, need_growth, parameter_t
   use scene_words, only: at_least_zero, below_one, biot_range, dilation_range, exponent_range, &
                          newton_range, passes_range, poisson_range, porosity_range, positive, &
                          rosette_range, share, steps_range, tolerance_range
   implicit none(type, external)
   private

   public :: parameters

   ! The parts of the table, which keep their own layout; one statement cannot be longer.
   !&<
   type(parameter_t), parameter :: rock_parameters(*) = [ &
      parameter_t("material", "young", unit="Pa", need=need_always, range=positive, &
         meaning="Young's modulus E"), &
      parameter_t("material", "poisson", need=need_always, range=poisson_range, &
         meaning="Poisson's ratio nu (drained)"), &
      parameter_t("material", "biot", need=need_fluid, range=biot_range, &
         meaning="Biot's coefficient alpha"), &
      parameter_t("material", "porosity", need=need_fluid, range=porosity_range, &
         meaning="Porosity phi"), &
      parameter_t("material", "permeability", unit="m2", range=positive, &
         absent="see permeability_xx", &
         meaning="Isotropic permeability; with a fluid either this or the tensor is required"), &
      parameter_t("material", "permeability_xx", unit="m2", range=positive, &
         absent="see permeability", meaning="Component xx of the permeability tensor"), &
      parameter_t("material", "permeability_yy", unit="m2", range=positive, &
         absent="see permeability", meaning="Component yy of the permeability tensor"), &
      parameter_t("material", "permeability_xy", unit="m2", absent="0", &
         meaning="Component xy of the permeability tensor"), &
      parameter_t("material", "density", unit="kg/m3", range=positive, absent="no weight", &
         meaning="Density of the rock, with a fluid including the pore fluid, for gravity"), &
      parameter_t("material", "radiation_damping", unit="Pa s/m", default="0.0", &
         range=at_least_zero, scenes=in_fluid, &
         meaning="Radiation damping: shear traction per slip rate, G/(2 c_s), with the shear "// &
                 "wave velocity c_s; gives unstable slip a duration. Not with intensities"), &
      parameter_t("material", "toughness", unit="Pa m^1/2", need=need_growth, absent="unlimited", &
         range=at_least_zero, meaning="Fracture toughness K_IC; 0: fractures grow without it, "// &
                 "only with a fluid"), &
      parameter_t("material", "plane", kind_choice, default="'strain'", choices="strain|stress", &
         meaning="Plane strain or plane stress"), &
      parameter_t("material", "storage", kind_choice, default="'thesis'", &
         choices="thesis|textbook", &
         meaning="Storage S: phi c_p + (alpha - phi)/K_dr, or textbook: the second term times "// &
                 "(1 - alpha)"), &
      parameter_t("material", "heat_capacity", unit="J/m3/K", absent="no &heat", range=positive, &
         scenes=in_fluid, only_with="heat", &
         meaning="Heat capacity per volume, with the pore fluid"), &
      parameter_t("material", "heat_conductivity", unit="W/m/K", absent="no &heat", &
         range=positive, scenes=in_fluid, only_with="heat", &
         meaning="Heat conductivity, with the pore fluid"), &
      parameter_t("material", "heat_expansion", unit="1/K", absent="none", &
         range=at_least_zero, only_with="heat|temperature", &
         meaning="Thermal expansion of volume of the solid, three times that of length"), &
      parameter_t("fluid", "compressibility", unit="1/Pa", need=need_always, range=at_least_zero, &
         meaning="Compressibility c_p"), &
      parameter_t("fluid", "viscosity", unit="Pa s", need=need_always, range=positive, &
         meaning="Dynamic viscosity mu"), &
      parameter_t("fluid", "density", unit="kg/m3", range=positive, absent="no weight", &
         meaning="Density of the fluid, for gravity: pressures of &initial and &side are then "// &
                 "those at y_datum of &in_situ"), &
      parameter_t("fluid", "vapour_pressure", unit="Pa", absent="0, or without loads no limit", &
         derived=.true., &
         meaning="Lowest pressure in fractures, at which vapour forms: about 0 for absolute "// &
                 "pressures"), &
      parameter_t("fluid", "viscosity_law", kind_choice, default="'constant'", &
         choices="constant|exponential|table", &
         meaning="Pressure dependence of the viscosity in fractures. The rock uses `viscosity` "// &
                 "and `compressibility`"), &
      parameter_t("fluid", "viscosity_exponent", unit="1/Pa", need=need_choice, &
         absent="no exponential law", range=exponent_range, of="viscosity_law=exponential", &
         meaning="beta in mu = viscosity exp(beta (p - reference_pressure))"), &
      parameter_t("fluid", "density_law", kind_choice, default="'linear'", &
         choices="linear|exponential|table", &
         meaning="Density in fractures. linear: a volume V stores V c_p dp in a step. "// &
                 "exponential: exp(compressibility (p - reference_pressure))"), &
      parameter_t("fluid", "reference_pressure", unit="Pa", &
         absent="pressure of &initial, if there is a law", derived=.true., &
         meaning="Pressure at which the fluid has its `viscosity`, and the reference density "// &
                 "of rates, volumes and balances"), &
      parameter_t("fluid", "table_pressure", kind_reals, "Pa", absent="no table", &
         meaning="Increasing pressures of a table. Logarithms are interpolated linearly; "// &
                 "beyond the table values are constant and run.json warns"), &
      parameter_t("fluid", "table_viscosity", kind_reals, "Pa s", need_choice, absent="no table", &
         range=positive, of="viscosity_law=table", meaning="Viscosities at these pressures"), &
      parameter_t("fluid", "table_density", kind_reals, "kg/m3", need_choice, absent="no table", &
         range=positive, of="density_law=table", &
         meaning="Densities at these pressures, not decreasing; only ratios matter"), &
      parameter_t("fluid", "heat_capacity", unit="J/m3/K", absent="no &heat", range=positive, &
         only_with="heat", meaning="Heat capacity per volume at the reference density"), &
      parameter_t("fluid", "heat_expansion", unit="1/K", absent="none", only_with="heat", &
         meaning="Thermal expansion of volume, in the pores"), &
      parameter_t("fluid", "table_temperature", kind_reals, "K", absent="one viscosity", &
         with="viscosity_at", only_with="heat", &
         meaning="Increasing temperatures of a table of the viscosity in fractures, its "// &
                 "logarithm linear in between. Rock keeps `viscosity`, as at the "// &
                 "temperature of &heat"), &
      parameter_t("fluid", "viscosity_at", kind_reals, "Pa s", absent="one viscosity", &
         range=positive, with="table_temperature", only_with="heat", &
         meaning="Viscosities at these temperatures, at reference_pressure; a viscosity_law "// &
                 "multiplies them"), &
      parameter_t("region", "name", kind_name, need=need_always, &
         meaning="Name, different from that of every other region"), &
      parameter_t("region", "shape", kind_choice, default="'polygon'", &
         choices="polygon|half_plane|band|parabola", &
         meaning="A polygon, the half-plane left of a line, a band between two curves, or the "// &
                 "part right of a parabola or between two"), &
      parameter_t("region", "x", kind_reals, "m", absent="a parabola", &
         meaning="x of a polygon's corners, in either orientation; of two points of the line; "// &
                 "or along the first curve of a band"), &
      parameter_t("region", "y", kind_reals, "m", absent="a parabola", meaning="y of the same"), &
      parameter_t("region", "x_other", kind_reals, "m", need_choice, absent="no band", &
         of="shape=band", &
         meaning="x along the second curve of a band, in the same direction as the first"), &
      parameter_t("region", "y_other", kind_reals, "m", need_choice, absent="no band", &
         of="shape=band", meaning="y along the second curve"), &
      parameter_t("region", "x_vertex", kind_reals, "m", need_choice, absent="no parabola", &
         of="shape=parabola", &
         meaning="x of the vertex of one parabola or of two: x = x_vertex + curvature (y - "// &
                 "y_vertex)^2"), &
      parameter_t("region", "y_vertex", kind_reals, "m", need_choice, absent="no parabola", &
         of="shape=parabola", meaning="y of the vertex"), &
      parameter_t("region", "curvature", kind_reals, "1/m", need_choice, absent="no parabola", &
         of="shape=parabola", meaning="Positive: open to the right; 0: a straight line"), &
      parameter_t("region", "young", unit="Pa", range=positive, absent="that of &material", &
         derived=.true., meaning="Young's modulus E (drained)"), &
      parameter_t("region", "poisson", range=poisson_range, absent="that of &material", &
         derived=.true., meaning="Poisson's ratio nu (drained)"), &
      parameter_t("region", "biot", scenes=in_fluid, range=biot_range, absent="that of &material", &
         derived=.true., meaning="Biot's coefficient alpha"), &
      parameter_t("region", "porosity", scenes=in_fluid, range=porosity_range, &
         absent="that of &material", derived=.true., meaning="Porosity phi"), &
      parameter_t("region", "permeability", unit="m2", scenes=in_fluid, range=positive, &
         absent="see permeability_xx", meaning="Isotropic permeability"), &
      parameter_t("region", "permeability_xx", unit="m2", scenes=in_fluid, range=positive, &
         absent="see permeability, or &material", &
         meaning="Component xx of the permeability tensor"), &
      parameter_t("region", "permeability_yy", unit="m2", scenes=in_fluid, range=positive, &
         absent="see permeability", meaning="Component yy of the permeability tensor"), &
      parameter_t("region", "permeability_xy", unit="m2", scenes=in_fluid, absent="0", &
         meaning="Component xy of the permeability tensor"), &
      parameter_t("region", "density", unit="kg/m3", scenes=in_fluid, range=positive, &
         absent="that of &material", derived=.true., &
         meaning="Density of the rock including the pore fluid; the body settles under it. Not "// &
                 "with a stress in situ that varies with y, nor with windows"), &
      parameter_t("region", "toughness", unit="Pa m^1/2", range=at_least_zero, &
         absent="that of &material", derived=.true., &
         meaning="Fracture toughness K_IC of tips in the region"), &
      parameter_t("region", "heat_capacity", unit="J/m3/K", absent="that of &material", &
         derived=.true., range=positive, scenes=in_fluid, only_with="heat", &
         meaning="Heat capacity per volume"), &
      parameter_t("region", "heat_conductivity", unit="W/m/K", absent="that of &material", &
         derived=.true., range=positive, scenes=in_fluid, only_with="heat", &
         meaning="Heat conductivity"), &
      parameter_t("region", "heat_expansion", unit="1/K", absent="that of &material", &
         derived=.true., range=at_least_zero, only_with="heat|temperature", &
         meaning="Thermal expansion of volume of the solid")]

   type(parameter_t), parameter :: fracture_parameters(*) = [ &
      parameter_t("fracture", "name", kind_name, need=need_always, &
         meaning="Name, different from that of every other fracture"), &
      parameter_t("fracture", "x", kind_reals, "m", need_always, &
         meaning="x of the vertices, from one end to the other"), &
      parameter_t("fracture", "y", kind_reals, "m", need_always, meaning="y of the vertices"), &
      parameter_t("fracture", "law", kind_choice, default="'friction'", &
         choices="friction|frictionless|slip|open", &
         meaning="Law of the faces; open and slip only without a fluid. slip: contact with "// &
                 "prescribed slip; open: traction-free, may overlap"), &
      parameter_t("fracture", "slip", unit="m", need=need_choice, absent="not given", &
         of="law=slip", scenes=in_mechanics, &
         meaning="Prescribed slip of the left side relative to the right side in the "// &
                 "fracture's direction, times the load factor"), &
      parameter_t("fracture", "slip_taper", unit="m", range=positive, scenes=in_mechanics, &
         of="law=slip", absent="half the fracture's length", derived=.true., &
         meaning="The prescribed slip increases from a free end as a quarter ellipse of this "// &
                 "length"), &
      parameter_t("fracture", "friction", need=need_choice, range=at_least_zero, &
         of="law=friction", absent="no friction", &
         meaning="Coefficient of friction mu_s; 0: frictionless"), &
      parameter_t("fracture", "friction_residual", with="weakening_slip", range=at_least_zero, &
         of="law=friction", at_most="friction", absent="friction does not weaken", &
         meaning="Residual friction mu_r after weakening_slip"), &
      parameter_t("fracture", "weakening_slip", unit="m", range=positive, of="law=friction", &
         with="friction_residual", absent="friction does not weaken", &
         meaning="Slip distance over which friction decreases, linearly with the accumulated "// &
                 "slip path"), &
      parameter_t("fracture", "dilation_slip", unit="m", range=positive, of="law=friction", &
         absent="unlimited dilation", meaning="Slip at which dilation ends"), &
      parameter_t("fracture", "dilation_deg", unit="degree", default="0.0", range=dilation_range, &
         of="law=friction", meaning="Dilation angle psi: opening is tan(psi) times slip"), &
      parameter_t("fracture", "normal_stiffness", unit="Pa/m", with="closure", range=positive, &
         absent="closed faces are rigid", &
         meaning="Initial normal stiffness k_ni of faces in contact at zero stress, s = k_ni "// &
                 "d/(1 - d/closure)"), &
      parameter_t("fracture", "closure", unit="m", with="normal_stiffness", range=positive, &
         absent="closed faces are rigid", &
         meaning="Maximum closure d under contact stress; aperture is that at zero contact "// &
                 "stress. Wings do not close"), &
      parameter_t("fracture", "cohesion", unit="Pa", range=positive, of="law=friction", &
         absent="no bond", &
         meaning="Shear strength of a bond, in addition to friction. Slip of weakening_slip "// &
                 "breaks it permanently; friction_residual may be friction"), &
      parameter_t("fracture", "tensile_strength", unit="Pa", range=positive, of="law=friction", &
         with="opening_weakening", absent="no bond", &
         meaning="Tensile strength of the same bond, at most cohesion/friction"), &
      parameter_t("fracture", "opening_weakening", unit="m", range=positive, of="law=friction", &
         with="tensile_strength", absent="no bond", &
         meaning="Opening that breaks the bond, with the energy tensile_strength "// &
                 "opening_weakening/2"), &
      parameter_t("fracture", "toughness", unit="Pa m^1/2", range=at_least_zero, &
         absent="that of the rock", &
         meaning="K_IC of its tips and those of its wings, in any rock"), &
      parameter_t("fracture", "skin", unit="Pa s/m", scenes=in_fluid, range=positive, &
         absent="no skin", &
         meaning="Resistance of a layer on each face, pressure difference over flux between "// &
                 "fracture and rock; new faces have none"), &
      parameter_t("fracture", "held_closed", kind_logical, default=".false.", scenes=in_mechanics, &
         meaning="The faces slide but never separate, and friction continues with tensile "// &
                 "normal traction: a model of reference solutions. New faces may separate"), &
      parameter_t("fracture", "face_pressure", unit="Pa", default="0.0", scenes=in_mechanics, &
         meaning="Pressure on the faces, also on those of its wings, times the load factor, in "// &
                 "addition to contact"), &
      parameter_t("fracture", "aperture", unit="m", need=need_fluid, range=positive, absent="0", &
         meaning="Residual hydraulic aperture a_0 of the closed fracture"), &
      parameter_t("fracture", "cell_size", unit="m", absent="size_fracture", range=positive, &
         derived=.true., &
         meaning="Size of cells or elements along the fracture, at most its length; where "// &
                 "size_fracture is omitted a fraction of its length"), &
      parameter_t("fracture", "window", unit="m", absent="window of &fine", range=positive, &
         derived=.true., scenes=in_fluid, meaning="Edge of the windows of its tips"), &
      parameter_t("fracture", "increment", unit="m", absent="increment of &growth", &
         range=positive, derived=.true., &
         meaning="Largest advance of its tips, as increment of &growth")]

   type(parameter_t), parameter :: process_parameters(*) = [ &
      parameter_t("injection", "name", kind_name, absent="well_ and its number", derived=.true., &
         meaning="Name, different from that of every other well"), &
      parameter_t("injection", "fracture", kind_names, absent="in the rock, at x and y", &
         meaning="Name of the fracture, or 'nearest', the one nearest to x and y; several "// &
                 "names: a well with an entry into each, see entry_loss"), &
      parameter_t("injection", "rate", kind_reals, "m2/s", absent="follows from pressure", &
         meaning="Volume per time and metre of thickness, of the whole well; negative: "// &
                 "extraction. One value, or one per stage"), &
      parameter_t("injection", "pressure", kind_reals, "Pa", absent="no limit", &
         meaning="Pressure of the well, at its depth; with a rate its limit: the largest in "// &
                 "injection, the lowest in extraction. One value, or one per stage"), &
      parameter_t("injection", "time", kind_reals, "s", range=at_least_zero, &
         absent="one stage, from start", meaning="Start of each stage, in increasing order"), &
      parameter_t("injection", "schedule", kind_text, absent="no table", &
         meaning="CSV file with a row per stage instead of time, rate and pressure: columns "// &
                 "time_s, rate_m2_s, pressure_pa, temperature_k; in the folder of the scene"), &
      parameter_t("injection", "columns", kind_text, absent="names of the columns", &
         meaning="Columns of a table with other headers: HEADER=name [unit], "// &
                 "... as q=rate [l/s]; others are ignored, and rows that repeat the one before"), &
      parameter_t("injection", "temperature", kind_reals, "K", absent="no &heat, or extraction", &
         only_with="heat", &
         meaning="Temperature of the injected fluid. One value, or one per stage"), &
      parameter_t("injection", "start", unit="s", default="0.0", range=at_least_zero, &
         meaning="Start time; with stages that of the first"), &
      parameter_t("injection", "end", unit="s", range=positive, absent="end of the run", &
         meaning="Time of shut-in, after start and after the start of the last stage"), &
      parameter_t("injection", "x", kind_reals, "m", absent="over the whole fracture", with="y", &
         per_entry=.true., meaning="x of the point of injection, one value per entry"), &
      parameter_t("injection", "y", kind_reals, "m", absent="over the whole fracture", with="x", &
         per_entry=.true., meaning="y of the same"), &
      parameter_t("injection", "storage", unit="m2/Pa", default="0.0", range=at_least_zero, &
         meaning="Wellbore storage: stored volume per metre of thickness and per pressure at "// &
                 "the head"), &
      parameter_t("injection", "friction", unit="Pa s/m2", default="0.0", range=at_least_zero, &
         meaning="Pressure loss between well head and fracture, per rate"), &
      parameter_t("injection", "turbulence", unit="Pa s2/m4", default="0.0", range=at_least_zero, &
         meaning="Pressure loss per rate squared"), &
      parameter_t("injection", "entry_loss", kind_reals, "Pa s2/m4", range=at_least_zero, &
         absent="no loss", per_entry=.true., &
         meaning="Pressure loss at an entry per square of its flow, as of perforations; one "// &
                 "value, or one per entry"), &
      parameter_t("injection", "radius", unit="m", default="0.1", range=positive, &
         meaning="Radius of a well in the rock, for its pressure; not for a well in a fracture"), &
      parameter_t("initial", "fracture_pressure", kind_choice, default="'equilibrated'", &
         choices="equilibrated|undrained", &
         meaning="After loading: that of the surrounding rock, or the undrained response in "// &
                 "the fracture"), &
      parameter_t("initial", "pressure", unit="Pa", default="0.0", &
         meaning="Pore pressure before loading; with a fluid density that at y_datum of "// &
                 "&in_situ"), &
      parameter_t("heat", "temperature", unit="K", need=need_always, &
         meaning="Temperature before the first step, at y_datum. Any scale with steps of 1 K"), &
      parameter_t("heat", "temperature_per_y", unit="K/m", default="0.0", &
         meaning="Its change per metre upwards"), &
      parameter_t("heat", "y_datum", unit="m", default="0.0", meaning="Level of temperature"), &
      parameter_t("heat", "tolerance", default="1.0e-3", range=share, &
         meaning="Error in time of a substep of the heat, relative to the heat moved so far"), &
      parameter_t("heat", "source_power", kind_reals, "W/m", absent="no source", with="source_x", &
         meaning="Power of sources of heat at points of the rock, without fluid; negative: it "// &
                 "is drawn"), &
      parameter_t("heat", "source_x", kind_reals, "m", absent="no source", with="source_y", &
         meaning="x of these points"), &
      parameter_t("heat", "source_y", kind_reals, "m", absent="no source", with="source_power", &
         meaning="y of the same"), &
      parameter_t("heat", "source_cell_size", unit="m", absent="as elsewhere", range=positive, &
         meaning="Size of cells at the sources, which grows from there"), &
      parameter_t("temperature", "change", unit="K", default="0.0", &
         meaning="Change at x_datum and y_datum; negative: colder"), &
      parameter_t("temperature", "change_per_x", unit="K/m", default="0.0", &
         meaning="Its gradient in x"), &
      parameter_t("temperature", "change_per_y", unit="K/m", default="0.0", &
         meaning="Its gradient in y"), &
      parameter_t("temperature", "x_datum", unit="m", default="0.0", meaning="Place of change"), &
      parameter_t("temperature", "y_datum", unit="m", default="0.0", meaning="The same in y"), &
      parameter_t("temperature", "face_change", unit="K", absent="no face", with="face_depth", &
         meaning="Change of a plane face, in addition"), &
      parameter_t("temperature", "face_depth", unit="m", absent="no face", range=positive, &
         with="face_change", meaning="Depth of its front, 2 sqrt(D t): heat diffusivity, time"), &
      parameter_t("temperature", "face_x", unit="m", default="0.0", meaning="x of a point of it"), &
      parameter_t("temperature", "face_y", unit="m", default="0.0", meaning="y of the same"), &
      parameter_t("temperature", "face_inward_deg", unit="degree", default="0.0", &
         meaning="Direction from the face into the rock, counter-clockwise from the x axis"), &
      parameter_t("time", "end", unit="s", need=need_always, range=positive, &
         meaning="End of the run"), &
      parameter_t("time", "step", unit="s", range=positive, at_most="end", &
         absent="limited by tolerance", meaning="Step size; with a tolerance the largest one"), &
      parameter_t("time", "tolerance", range=below_one, derived=.true., &
         absent="0.01, or 0 with step alone", &
         meaning="Time error of a step relative to the range of pressure, slip and opening so "// &
                 "far; 0: the default, 0.01 without step or with growth in equilibrium"), &
      parameter_t("time", "first", unit="s", range=positive, at_most="end", &
         absent="with a tolerance 1e-7 of end", &
         meaning="First step with a tolerance, at most step; that of a run that is continued "// &
                 "stays"), &
      parameter_t("time", "growth_factor", default="0.01", range=share, &
         meaning="Fraction of step used after growth with law = 'paris'"), &
      parameter_t("time", "smallest_factor", range=below_one, derived=.true., &
         at_most="growth_factor", absent="1e-6, or 1e-9 without step", &
         meaning="Fraction of step, or of 1e7 first steps without it, below which a cut step "// &
                 "ends the run; no step is cut to less than a 64th of that; 0: the default"), &
      parameter_t("time", "replay", kind_text, default="''", scenes=in_fluid, &
         meaning="Folder of a run whose steps, path segments and windows are taken"), &
      parameter_t("in_situ", "sxx", unit="Pa", default="0.0", meaning="Stress xx at y_datum"), &
      parameter_t("in_situ", "syy", unit="Pa", default="0.0", meaning="Stress yy at y_datum"), &
      parameter_t("in_situ", "sxy", unit="Pa", default="0.0", meaning="Stress xy"), &
      parameter_t("in_situ", "sxx_per_y", unit="Pa/m", default="0.0", &
         meaning="Change of stress xx per metre upwards"), &
      parameter_t("in_situ", "syy_per_y", unit="Pa/m", default="0.0", &
         meaning="Change of stress yy per metre upwards; it must balance the weight: density "// &
                 "times gravity g gives density*g"), &
      parameter_t("in_situ", "y_datum", unit="m", default="0.0", &
         meaning="Level of the prescribed stresses xx and yy, and with a fluid density of all "// &
                 "pressures"), &
      parameter_t("gravity", "x", unit="m/s2", default="0.0", meaning="Acceleration in x"), &
      parameter_t("gravity", "y", unit="m/s2", default="0.0", &
         meaning="Acceleration in y, on earth -9.81"), &
      parameter_t("load", "from", default="0.0", meaning="Load factor before the first step"), &
      parameter_t("load", "to", default="1.0", &
         meaning="Load factor at the end, different from from"), &
      parameter_t("load", "factors", kind_reals, absent="one load segment, to its end", &
         meaning="Successive load factors instead of to: the table of a load cycle. Each "// &
                 "differs from the previous one"), &
      parameter_t("load", "steps", kind_integer, default="1", range=steps_range, &
         meaning="Number of equal steps between from and to, or to each of factors"), &
      parameter_t("load", "control", kind_choice, absent="'length', with factors 'dead'", &
         derived=.true., choices="length|dead", &
         meaning="If equilibrium growth requires a smaller load, the factor decreases "// &
                 "(length), or stays and growth is unstable until it arrests (dead)")]

   type(parameter_t), parameter :: numerics_parameters(*) = [ &
      parameter_t("fe", "size_fracture", unit="m", range=positive, &
         absent="a 20th of each fracture's length", derived=.true., at_most="size_boundary", &
         meaning="Element size at the fractures, at most the length of each. By default each "// &
                 "fracture has its own cell_size (docs/theory.md)"), &
      parameter_t("fe", "size_boundary", unit="m", range=positive, derived=.true., &
         absent="a 20th of the domain's shorter edge", &
         meaning="Element size far from the fractures, at most the shorter edge of the domain"), &
      parameter_t("fe", "rosette_radius", unit="m", range=positive, absent="size_fracture", &
         derived=.true., &
         meaning="Size of the elements around a tip, smaller if another object is near, in "// &
                 "proportion where a fracture has its own cell_size"), &
      parameter_t("fe", "rosette_sectors", kind_integer, default="12", range=rosette_range, &
         meaning="Quarter-point elements around a tip"), &
      parameter_t("fe", "element", kind_choice, default="'quarter_point'", &
         choices="quarter_point|collapsed|plain", &
         meaning="Elements around a tip: triangles with quarter points, collapsed "// &
                 "quadrilaterals with quarter points, or ordinary triangles"), &
      parameter_t("adaptive", "enabled", kind_logical, default=".false.", &
         meaning="Adaptive meshes"), &
      parameter_t("adaptive", "tolerance", range=share, derived=.true., &
         absent="0.01, or 0.5 with &fluid", &
        meaning="Target relative error in the energy norm: of the stresses; with &fluid of the "// &
                 "response to the wells"), &
      parameter_t("adaptive", "passes", kind_integer, default="4", range=passes_range, &
         meaning="Maximum number of adapted meshes"), &
      parameter_t("coarse", "size_fracture", unit="m", range=positive, &
         absent="a 20th of each fracture's length", derived=.true., at_most="size_boundary", &
         meaning="Cell size dH at the fractures, at most the length of each. By default each "// &
                 "fracture has its own cell_size (docs/theory.md)"), &
      parameter_t("coarse", "size_boundary", unit="m", range=positive, derived=.true., &
         absent="a 20th of the domain's shorter edge", &
         meaning="Cell size far from the fractures, at most the shorter edge of the domain"), &
      parameter_t("coarse", "newton_max", kind_integer, default="30", range=newton_range, &
         meaning="Newton iterations before a step is cut"), &
      parameter_t("coarse", "newton_tolerance", default="1.0e-9", range=tolerance_range, &
         meaning="Relative residual at which a step has converged"), &
      parameter_t("coarse", "condensation", kind_choice, default="'auto'", &
         choices="auto|full|sparse", &
         meaning="Solution of the fracture equations: condensation of the rock onto a full "// &
                 "matrix, or one sparse system; `auto` selects the cheaper one"), &
      parameter_t("coarse", "layers", kind_choice, default="'auto'", choices="auto|off", &
         meaning="Layers of fluid pressure thinner than a cell, next to fractures and drained "// &
                 "sides: resolved where the first step may contain one, or not"), &
      parameter_t("fine", "window", unit="m", range=positive, derived=.true., choices="body", &
         absent="5 lengths, 10 at a side, or 'body'", &
         meaning="Edge l of the square window around a tip, more than 2 size_ratio dH; or the "// &
                 "whole body as one window for all tips"), &
      parameter_t("fine", "size_ratio", default="0.5", range=share, &
         meaning="Fine mesh size at the tip as a fraction eps_m of dH"), &
      parameter_t("fine", "rosette_sectors", kind_integer, default="12", range=rosette_range, &
         meaning="Quarter-point elements around a tip"), &
      parameter_t("fine", "face_condition", kind_choice, default="'contact'", &
         choices="contact|jump|traction", &
         meaning="Condition on existing fracture faces: contact, or the coarse jump or traction"), &
      parameter_t("growth", "enabled", kind_logical, default=".false.", meaning="Fractures grow"), &
      parameter_t("growth", "intensities", kind_logical, default=".false.", &
         meaning="Compute stress intensity factors; always done with growth"), &
      parameter_t("growth", "law", kind_choice, default="'equilibrium'", &
         choices="equilibrium|paris", &
         meaning="Growing tips remain at K_eq = K_IC in time or under load, or advance by "// &
                 "increments, at constant load, by the Paris-type law of the thesis"), &
      parameter_t("growth", "increment", unit="m", range=at_least_zero, derived=.true., &
         absent="the fine mesh size, or size_fracture", &
         meaning="Largest advance l_max of a tip, or length of a path segment; 0: the default, "// &
                 "the fine mesh size, or without a fluid size_fracture"), &
      parameter_t("growth", "increments", kind_choice, default="'auto'", scenes=in_fluid, &
         choices="auto|constant|by_length", &
         meaning="Increments of fractures that are twice as long as at first: constant, or in "// &
                 "proportion to the length; auto: so where no cells are given either"), &
      parameter_t("growth", "exponent", default="0.35", range=at_least_zero, &
         meaning="Exponent m of advance = l_max (G/G_max)^m, with law = 'paris'"), &
      parameter_t("growth", "threshold", scenes=in_fluid, default="0.5", range=positive, &
         meaning="Growth updates the coarse level at this fraction eps_p of dH, with law = "// &
                 "'paris'"), &
      parameter_t("growth", "new_aperture", unit="m", default="1.0e-5", range=positive, &
         scenes=in_fluid, &
         meaning="Residual aperture of new fracture cells: a roughness that conducts fluid but "// &
                 "stores none, unless new_volume is 'prefilled'"), &
      parameter_t("growth", "new_volume", kind_choice, default="'conserved'", scenes=in_fluid, &
         choices="conserved|prefilled", &
         meaning="Fluid of new cells: supplied by the connected cells as they open, or added "// &
                 "with them"), &
      parameter_t("growth", "stop_gain", unit="m", range=positive, absent="no limit", &
         meaning="The run ends when any fracture end has grown by this length"), &
      parameter_t("probe", "name", kind_name, need=need_always, &
         meaning="Name, different from that of every other probe"), &
      parameter_t("probe", "x", unit="m", need=need_always, meaning="x, within the domain"), &
      parameter_t("probe", "y", unit="m", need=need_always, meaning="y, within the domain"), &
      parameter_t("output", "vtu", kind_logical, default=".true.", meaning="Write VTU fields"), &
      parameter_t("output", "windows", kind_logical, default=".false.", scenes=in_fluid, &
         meaning="With them the meshes of the windows of the tips, windows.pvd"), &
      parameter_t("output", "interval", unit="s", range=at_least_zero, scenes=in_fluid, &
         absent="the regular step", derived=.true., &
         meaning="Time between written fields; 0: the regular step"), &
      parameter_t("output", "growth_states", kind_integer, range=at_least_zero, default="200", &
         meaning="Maximum number of states of growth with VTU files, in addition to those of "// &
                 "interval or of the load steps"), &
      parameter_t("output", "stimulated_jump", unit="m", default="1.0e-6", range=positive, &
         scenes=in_fluid, &
         meaning="Slip or opening since the start above which fractures count as stimulated, "// &
                 "and mean slip of the smallest event in slip_events.csv"), &
      parameter_t("output", "out_of_plane_length", unit="m", absent="thickness of &scene", &
         range=positive, derived=.true., scenes=in_fluid, &
         meaning="Assumed out-of-plane length of the fractures, used only for area and moment "// &
                 "in slip_events.csv"), &
      parameter_t("output", "seismic_slip_rate", unit="m/s", default="1.0e-3", range=positive, &
         scenes=in_fluid, &
         meaning="Slip rate above which slip is seismic: where the largest one of a patch "// &
                 "passes it, an event of slip_events.csv ends and another one begins"), &
      parameter_t("output", "checkpoint", unit="s", range=at_least_zero, default="600.0", &
         meaning="Wall time between checkpoints, from which run --restart goes on; others are "// &
                 "written when stages of wells begin, after a signal and at the end; 0: none"), &
      parameter_t("output", "checkpoint_states", kind_integer, range=at_least_zero, default="0", &
         meaning="Number of accepted states between checkpoints; 0: the wall time decides")]
   !&>

   type(parameter_t), parameter :: parameters(*) = [ &
                                   body_parameters, rock_parameters, fracture_parameters, &
                                   process_parameters, numerics_parameters]

end module scene_parameter_table
