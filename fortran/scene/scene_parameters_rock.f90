!> What a scene file can say of rock and fluid.
module scene_parameters_rock
   use scene_intervals, only: at_least_zero, biot_range, exponent_range, poisson_range, &
                              porosity_range, positive
   use scene_parameter_types, only: in_fluid, kind_choice, kind_name, kind_reals, need_always, &
                                    need_choice, need_fluid, need_growth, parameter_t
   implicit none(type, external)
   private

   public :: rock_parameters

   ! The table keeps its own layout.
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
                  meaning="Isotropic permeability; with a fluid either this or the tensor is "// &
                  "required"), &
      parameter_t("material", "permeability_xx", unit="m2", range=positive, &
                  absent="see permeability", &
                  meaning="Component xx of the permeability tensor"), &
      parameter_t("material", "permeability_yy", unit="m2", range=positive, &
                  absent="see permeability", &
                  meaning="Component yy of the permeability tensor"), &
      parameter_t("material", "permeability_xy", unit="m2", absent="0", &
                  meaning="Component xy of the permeability tensor"), &
      parameter_t("material", "density", unit="kg/m3", range=positive, absent="no weight", &
                  meaning="Density of the rock, with a fluid in its pores, for gravity"), &
      parameter_t("material", "radiation_damping", unit="Pa s/m", default="0.0", &
                  range=at_least_zero, scenes=in_fluid, &
                  meaning="Shear traction that slip radiates per velocity: G/(2 c_s), with the "// &
                  "velocity of shear waves c_s; unstable slip lasts by it. Not with intensities"), &
      parameter_t("material", "toughness", unit="Pa m^1/2", need=need_growth, &
                  absent="unlimited", range=positive, &
                  meaning="Fracture toughness K_IC"), &
      parameter_t("material", "plane", kind_choice, default="'strain'", choices="strain|stress", &
                  meaning="Plane strain or plane stress"), &
      parameter_t("material", "storage", kind_choice, default="'thesis'", &
                  choices="thesis|textbook", &
                  meaning="Storage S: phi c_p + (alpha - phi)/K_dr, or textbook: the second "// &
                  "term times (1 - alpha)"), &
      parameter_t("fluid", "compressibility", unit="1/Pa", need=need_always, range=at_least_zero, &
                  meaning="Compressibility c_p"), &
      parameter_t("fluid", "viscosity", unit="Pa s", need=need_always, range=positive, &
                  meaning="Dynamic viscosity mu"), &
      parameter_t("fluid", "density", unit="kg/m3", range=positive, absent="no weight", &
                  meaning="Density of the fluid, for gravity: pressures of &initial and &side "// &
                  "are then those at y_datum of &in_situ"), &
      parameter_t("fluid", "vapour_pressure", unit="Pa", absent="0, or without loads no limit", &
                  derived=.true., &
                  meaning="Least pressure in fractures, which vapour fills where fluid lacks: "// &
                  "about 0 if pressures count from vacuum"), &
      parameter_t("fluid", "viscosity_law", kind_choice, default="'constant'", &
                  choices="constant|exponential|table", &
                  meaning="How the viscosity in fractures follows pressure. The rock keeps "// &
                  "`viscosity` and `compressibility`"), &
      parameter_t("fluid", "viscosity_exponent", unit="1/Pa", need=need_choice, &
                  absent="no exponential law", range=exponent_range, &
                  of="viscosity_law=exponential", &
                  meaning="beta in mu = viscosity exp(beta (p - reference_pressure))"), &
      parameter_t("fluid", "density_law", kind_choice, default="'linear'", &
                  choices="linear|exponential|table", &
                  meaning="That in fractures. linear: a volume V stores V c_p dp of a step's "// &
                  "dp. Exponential: exp(compressibility (p - reference_pressure))"), &
      parameter_t("fluid", "reference_pressure", unit="Pa", &
                  absent="pressure of &initial, if there is a law", derived=.true., &
                  meaning="Pressure at which the fluid has its `viscosity`, and the density in "// &
                  "which rates, volumes and balances count it"), &
      parameter_t("fluid", "table_pressure", kind_reals, "Pa", absent="no table", &
                  meaning="Rising pressures of a table. Between them the logarithms are "// &
                  "linear, beyond them values constant, of which run.json warns"), &
      parameter_t("fluid", "table_viscosity", kind_reals, "Pa s", need_choice, &
                  absent="no table", range=positive, of="viscosity_law=table", &
                  meaning="Viscosities at these pressures"), &
      parameter_t("fluid", "table_density", kind_reals, "kg/m3", need_choice, &
                  absent="no table", range=positive, of="density_law=table", &
                  meaning="Densities at these pressures, not falling; only ratios count"), &
      parameter_t("region", "name", kind_name, need=need_always, &
                  meaning="Name, different from that of every other region"), &
      parameter_t("region", "shape", kind_choice, default="'polygon'", &
                  choices="polygon|half_plane|band|parabola", &
                  meaning="A polygon, all to the left of a line, between two curves, or to the "// &
                  "right of a parabola or between two"), &
      parameter_t("region", "x", kind_reals, "m", absent="a parabola", &
                  meaning="x of a polygon's corners, either way round; of two points of the "// &
                  "line; or along the first curve of a band"), &
      parameter_t("region", "y", kind_reals, "m", absent="a parabola", meaning="y of the same"), &
      parameter_t("region", "x_other", kind_reals, "m", need_choice, absent="no band", &
                  of="shape=band", &
                  meaning="x along the second curve of a band, the same way as the first"), &
      parameter_t("region", "y_other", kind_reals, "m", need_choice, absent="no band", &
                  of="shape=band", meaning="y along the second curve"), &
      parameter_t("region", "x_vertex", kind_reals, "m", need_choice, absent="no parabola", &
                  of="shape=parabola", &
                  meaning="x of the vertex of one parabola or of two: x = x_vertex + curvature "// &
                  "(y - y_vertex)^2"), &
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
                  absent="see permeability_xx", &
                  meaning="Isotropic permeability"), &
      parameter_t("region", "permeability_xx", unit="m2", scenes=in_fluid, range=positive, &
                  absent="see permeability, or &material", &
                  meaning="Component xx of the permeability tensor"), &
      parameter_t("region", "permeability_yy", unit="m2", scenes=in_fluid, range=positive, &
                  absent="see permeability", &
                  meaning="Component yy of the permeability tensor"), &
      parameter_t("region", "permeability_xy", unit="m2", scenes=in_fluid, absent="0", &
                  meaning="Component xy of the permeability tensor"), &
      parameter_t("region", "density", unit="kg/m3", scenes=in_fluid, range=positive, &
                  absent="that of &material", derived=.true., &
                  meaning="Density of the rock with what fills its pores; the body settles "// &
                  "under it. Not with a stress in situ that changes with y, nor with windows"), &
      parameter_t("region", "toughness", unit="Pa m^1/2", range=positive, &
                  absent="that of &material", derived=.true., &
                  meaning="Fracture toughness K_IC, which counts where a tip is")]
   !&>

end module scene_parameters_rock
