!> The names of a scene file for the body: its shape, sides, restraints and point loads.
module scene_body_parameters
   use scene_parameters, only: in_fluid, kind_choice, kind_name, kind_reals, kind_text, &
                               kind_wholes, need_always, need_choice, parameter_t
   use scene_words, only: at_least_one, at_least_zero, positive
   implicit none(type, external)
   private

   public :: body_parameters

   ! The table keeps its own layout.
   !&<
   type(parameter_t), parameter :: body_parameters(*) = [ &
      parameter_t("scene", "name", kind_name, absent="the file's name without .nml", &
         derived=.true., meaning="Short name; results are in `out/<name>` unless --out is used"), &
      parameter_t("scene", "title", kind_text, default="''", meaning="One-line description"), &
      parameter_t("scene", "thickness", unit="m", default="1.0", range=positive, &
         meaning="Of the body, out of the plane: by it rates in volumes per time, as rate_l_s, "// &
                 "become rates per metre of thickness"), &
      parameter_t("domain", "shape", kind_choice, default="'rectangle'", &
         choices="rectangle|disc|polygon", meaning="Shape of the body"), &
      parameter_t("domain", "x_min", unit="m", need=need_choice, absent="no rectangle", &
         of="shape=rectangle", meaning="Left side"), &
      parameter_t("domain", "x_max", unit="m", need=need_choice, absent="no rectangle", &
         of="shape=rectangle", meaning="Right side, above x_min"), &
      parameter_t("domain", "y_min", unit="m", need=need_choice, absent="no rectangle", &
         of="shape=rectangle", meaning="Bottom side"), &
      parameter_t("domain", "y_max", unit="m", need=need_choice, absent="no rectangle", &
         of="shape=rectangle", meaning="Top side, above y_min"), &
      parameter_t("domain", "x_centre", unit="m", need=need_choice, absent="no disc", &
         of="shape=disc", meaning="x of the disc's centre"), &
      parameter_t("domain", "y_centre", unit="m", need=need_choice, absent="no disc", &
         of="shape=disc", meaning="y of the disc's centre"), &
      parameter_t("domain", "radius", unit="m", need=need_choice, range=positive, of="shape=disc", &
         absent="no disc", meaning="Radius of the disc"), &
      parameter_t("domain", "x", kind_reals, "m", need_choice, absent="no polygon", &
         of="shape=polygon", &
         meaning="x of the corners of a polygon, in either orientation; edge k connects corner "// &
                 "k and the next one, the last edge ends at corner 1"), &
      parameter_t("domain", "y", kind_reals, "m", need_choice, absent="no polygon", &
         of="shape=polygon", meaning="y of the corners"), &
      parameter_t("side", "name", kind_name, need=need_always, &
         meaning="`left`, `right`, `bottom` or `top` of a rectangle; otherwise any, different "// &
                 "from that of every other side"), &
      parameter_t("side", "edges", kind_wholes, absent="no polygon", range=at_least_one, &
         meaning="Numbers of a polygon's edges, required there"), &
      parameter_t("side", "arc_from_deg", unit="degree", absent="the whole rim", &
         with="arc_to_deg", &
         meaning="Start of an arc of a disc's rim, counter-clockwise from the x axis"), &
      parameter_t("side", "arc_to_deg", unit="degree", absent="the whole rim", &
         with="arc_from_deg", meaning="End of the arc, above arc_from_deg by at most 360"), &
      parameter_t("side", "x_displacement", kind_reals, "m", absent="traction is prescribed", &
         meaning="Prescribed displacement in x"), &
      parameter_t("side", "y_displacement", kind_reals, "m", absent="traction is prescribed", &
         meaning="Prescribed displacement in y"), &
      parameter_t("side", "x_traction", kind_reals, "Pa", &
         absent="0, or displacement is prescribed", &
         meaning="Total traction in x: on the right side, compression is negative"), &
      parameter_t("side", "y_traction", kind_reals, "Pa", &
         absent="0, or displacement is prescribed", &
         meaning="Total traction in y: on the top side, compression is negative"), &
      parameter_t("side", "normal_traction", kind_reals, "Pa", absent="0", &
         meaning="Traction along the outward normal, compression is negative; not with "// &
                 "displacements or tractions in x and y"), &
      parameter_t("side", "shear_traction", kind_reals, "Pa", absent="0", &
         meaning="Tangential traction, positive with the body on the left; conditions as for "// &
                 "normal_traction"), &
      parameter_t("side", "x_spring", unit="Pa/m", absent="no spring", range=positive, &
         meaning="Stiffness of springs on the side in x: traction opposite to the displacement "// &
                 "and proportional to it, in addition to prescribed tractions"), &
      parameter_t("side", "y_spring", unit="Pa/m", absent="no spring", range=positive, &
         meaning="The same in y"), &
      parameter_t("side", "pressure", kind_reals, "Pa", absent="no flow", scenes=in_fluid, &
         meaning="Prescribed pore pressure; with a fluid density that at y_datum of &in_situ"), &
      parameter_t("side", "inflow", kind_reals, "m/s", absent="no flow", scenes=in_fluid, &
         meaning="Prescribed inflow per time and area; negative: outflow. Not with pressure"), &
      parameter_t("side", "temperature", unit="K", absent="no conduction", scenes=in_fluid, &
         only_with="heat", &
         meaning="Prescribed temperature, also of fluid that enters"), &
      parameter_t("side", "heat_flux", unit="W/m2", absent="0", scenes=in_fluid, &
         only_with="heat", &
         meaning="Heat conducted into the body per time and area. Not with temperature"), &
      parameter_t("side", "time", kind_reals, "s", absent="constant in time", scenes=in_fluid, &
         range=at_least_zero, &
         meaning="Times of the values of the side, each of which has one value or one per "// &
                 "time; linear between times, with a jump at two equal times. No step "// &
                 "straddles them"), &
      parameter_t("side", "schedule", kind_text, absent="no table", scenes=in_fluid, &
         meaning="CSV file in the folder of the scene with a row per time, instead of time and "// &
                 "values: columns time_s, x_traction_pa, pressure_pa, inflow_m_s and so on"), &
      parameter_t("restraint", "x", unit="m", need=need_always, meaning="x of the point"), &
      parameter_t("restraint", "y", unit="m", need=need_always, meaning="y of the point"), &
      parameter_t("restraint", "x_displacement", unit="m", absent="free in x", &
         meaning="Prescribed displacement in x, times the load factor"), &
      parameter_t("restraint", "y_displacement", unit="m", absent="free in y", &
         meaning="Prescribed displacement in y, times the load factor"), &
      parameter_t("point_load", "x", unit="m", need=need_always, meaning="x of the point"), &
      parameter_t("point_load", "y", unit="m", need=need_always, meaning="y of the point"), &
      parameter_t("point_load", "x_force", unit="N/m", default="0.0", meaning="Force in x"), &
      parameter_t("point_load", "y_force", unit="N/m", default="0.0", meaning="Force in y")]
   !&>

end module scene_body_parameters
