!> The table of all columns of a run's tables (keys and fields: report_keys).
!!
!! The tables of a run and the table of names (report_describe) take the names and the order of the
!! columns from here. A new column is one entry here, at its position, with the column of its error
!! or the reason why there is none, and one line in report_tables, the source of its value.
module report_columns
   use report_column, only: always, an_error, at_most_one, chosen, column_t, counted, label, &
                            of_heat, of_step, placed, states, with_entries, with_fluid, &
                            with_fluid_and_growth, with_fractures, with_heat, &
                            with_heat_and_fractures, with_heat_and_wells, with_one_well, &
                            with_several, with_wells, with_wells_and_growth, without_fluid
   implicit none(type, external)
   private

   public :: event_columns, fracture_columns, history_columns, probe_columns
   public :: entry_columns, slip_event_columns, tip_columns, well_columns

   ! The tables keep their own layout.
   !&<
   type(column_t), parameter :: history_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time", chosen), &
      column_t("load_factor", "-", without_fluid, "Factor on the loads of the scene", chosen), &
      column_t("dt_s", "s", with_fluid, "Step size: time_s since the previous row", chosen), &
      column_t("newton_iterations", "-", always, "Contact iterations in the step", counted), &
      column_t("well_pressure_pa", "Pa", at_most_one, &
         "Fluid pressure at the well in fracture or rock; in a fracture the mean over the "// &
         "cells and joints it supplies; 0 without a well", "well_pressure_error_pa"), &
      column_t("NAME_well_pressure_pa", "Pa", with_several, &
         "The same for each well by name: one column per well", &
         "pressure_error_pa of wells.csv"), &
      column_t("injected_m2", "m2", with_fluid, &
         "Injected volume so far, less the produced volume (produced_m2)", "injected_error_m2"), &
      column_t("leakoff_m2", "m2", with_fluid, &
         "Leak-off from the fractures into the rock so far; negative: into the fractures", &
         "leakoff_error_m2"), &
      column_t("prefilled_m2", "m2", with_fluid, &
         "Initial fluid of new fracture cells so far", &
         "none: a definition, the content of the new cells; no fluid is lost"), &
      column_t("outflow_m2", "m2", with_fluid, &
         "Outflow through fracture ends on sides with prescribed pressure so far; "// &
         "negative: inflow", "outflow_error_m2"), &
      column_t("fracture_volume_m2", "m2", always, &
         "Volume of the fractures: aperture, without a fluid opening, times length", &
         "fracture_volume_error_m2"), &
      column_t("mass_error_relative", "-", with_fluid, &
         "Numerical error of the fluid mass so far, relative to the injected volume or the"// &
         " fracture volume", an_error), &
      column_t("max_slip_m", "m", always, "Largest absolute slip", "max_slip_error_m"), &
      column_t("max_opening_m", "m", always, "Largest normal jump", "max_opening_error_m"), &
      column_t("n_stick", "-", always, "Fracture cells that stick", states), &
      column_t("n_slip", "-", always, "Fracture cells that slip", states), &
      column_t("n_open", "-", always, "Fracture cells that are open", states), &
      column_t("fracture_length_m", "m", always, &
         "Length of all fractures", &
         "fracture_length_error_m; without a fluid none: growth by increments, the load is"// &
         " uncertain"), &
      column_t("n_tips", "-", always, "Free tips", counted), &
      column_t("n_intersections", "-", always, "Intersections of fractures", counted), &
      column_t("seismic_moment_nm", "N m/m", always, &
         "Sum over all cells of shear modulus times slip so far times length", &
         "seismic_moment_error_nm"), &
      column_t("fracture_length_error_m", "m", with_fluid, &
  "Estimated error of fracture_length_m if tips have grown, without jumps to come (growth_jump "// &
         "of events.csv has their times); -1 with law = 'paris' (no estimate)", an_error), &
      column_t("well_pressure_error_pa", "Pa", with_fluid, &
         "Estimated error of the well pressure, with several wells of their mean; -1 with "// &
         "law = 'paris'", an_error), &
      column_t("strain_energy_j", "J/m", without_fluid, &
         "Elastic energy of the body", "strain_energy_error_j"), &
      column_t("injection_rate_m2_s", "m2/s", with_wells, &
         "Net flow from all wells in the step", "injection_rate_error_m2_s"), &
      column_t("injectivity_m2_s_pa", "m2/s/Pa", with_one_well, &
         "injection_rate_m2_s of a well in a fracture over the rise of well_pressure_pa "// &
         "above the initial pressure of the surrounding rock; 0 without a rise", &
         "injectivity_error_m2_s_pa"), &
      column_t("produced_m2", "m2", with_wells, "Produced volume so far", "produced_error_m2"), &
      column_t("fracture_fluid_m2", "m2", with_fractures, &
         "Increase of fluid in the fractures so far, by volume and compression; joints "// &
         "have no volume", "fracture_fluid_error_m2"), &
      column_t("rock_fluid_m2", "m2", with_fluid, &
         "Increase of fluid in the rock so far", "rock_fluid_error_m2"), &
      column_t("rock_outflow_m2", "m2", with_fluid, &
         "Outflow from the rock through sides with prescribed pressure so far; negative: "// &
         "inflow", "rock_outflow_error_m2"), &
      column_t("stimulated_length_m", "m", with_fractures, &
         "Length of fractures that are new, or have at any time slipped or opened by more "// &
         "than stimulated_jump of &output since the start", "stimulated_length_error_m"), &
      column_t("connected_length_m", "m", with_wells, &
         "Length of the fractures connected to the wells along fractures and through "// &
         "joints", "connected_length_error_m"), &
      column_t("connected_stimulated_m", "m", with_wells, &
         "Connected part of stimulated_length_m", "connected_stimulated_error_m"), &
      column_t("n_clusters", "-", with_fractures, "Clusters of connected fractures", counted), &
      column_t("max_slip_rate_m_s", "m/s", with_fluid, &
         "Largest slip rate, mean over the step", "max_slip_rate_error_m_s"), &
      column_t("connections_per_branch", "-", with_fractures, &
         "Mean number of connected ends of a branch of the network: 0 to 2 (Sanderson and "// &
         "Nixon 2015)", counted), &
      column_t("dimensionless_toughness", "-", with_wells_and_growth, &
         "K_m of injection_rate_m2_s and the toughness of &material: viscosity dominates "// &
         "below 1, toughness above 4; 0 without injection", &
         "none: an order of magnitude; its relative error is a quarter of that of the rate"), &
      column_t("dimensionless_leakoff", "-", with_wells_and_growth, &
         "C_m, likewise, of the largest well pressure above the initial one: leak-off "// &
         "dominates where it is large", &
         "none: an order of magnitude; its relative error is about that of pressure and rate"), &
      column_t("injected_error_m2", "m2", with_fluid), &
      column_t("produced_error_m2", "m2", with_wells), &
      column_t("leakoff_error_m2", "m2", with_fluid), &
      column_t("outflow_error_m2", "m2", with_fluid), &
      column_t("fracture_fluid_error_m2", "m2", with_fractures), &
      column_t("rock_fluid_error_m2", "m2", with_fluid), &
      column_t("rock_outflow_error_m2", "m2", with_fluid), &
      column_t("fracture_volume_error_m2", "m2", always), &
      column_t("max_slip_error_m", "m", always), &
      column_t("max_opening_error_m", "m", always), &
      column_t("seismic_moment_error_nm", "N m/m", always), &
      column_t("strain_energy_error_j", "J/m", without_fluid), &
      column_t("injection_rate_error_m2_s", "m2/s", with_wells, &
         "Estimated error of injection_rate_m2_s; 0 where all rates are prescribed", an_error), &
      column_t("injectivity_error_m2_s_pa", "m2/s/Pa", with_one_well), &
      column_t("stimulated_length_error_m", "m", with_fractures, &
         "Estimated error of stimulated_length_m: a cell at each of its ends, and the "// &
         "error of the fractures' length", an_error), &
      column_t("connected_length_error_m", "m", with_wells), &
      column_t("connected_stimulated_error_m", "m", with_wells), &
      column_t("max_slip_rate_error_m_s", "m/s", with_fluid), &
      column_t("unknowns", "-", always, &
         "Unknowns of the body, with a fluid of the coarse level: the sum of dofs in run.json "// &
         "without the windows, for the mesh of the step", counted), &
      column_t("heat_stored_j", "J/m", with_heat, &
         "Increase of heat in the body so far; heat counts from the temperature of &heat", &
         of_heat), &
      column_t("heat_by_wells_j", "J/m", with_heat, &
         "Heat that wells have supplied so far", of_heat), &
      column_t("heat_by_sides_j", "J/m", with_heat, &
         "Heat into the body across its outer boundary so far, and from sources", of_heat), &
      column_t("heat_error_relative", "-", with_heat, &
       "Numerical error of the balance of heat so far, relative to the heat moved, at least to "// &
         "1e-5 of that before the first step", an_error)]

   type(column_t), parameter :: tip_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv", chosen), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv", chosen), &
      column_t("tip", "-", always, &
         "Number of the tip, from 1: the same in all rows and in network.json", label), &
      column_t("fracture", "-", always, &
         "Number of its fracture, from 1 in the scene's order", label), &
      column_t("x_m", "m", always, &
         "Position of the tip before the increment", &
         "position_error_m; without a fluid none: growth by increments, the load is uncertain"), &
      column_t("y_m", "m", always, &
         "Position of the tip before the increment", &
         "position_error_m; without a fluid none: growth by increments, the load is uncertain"), &
      column_t("k1_pa_sqrtm", "Pa m^1/2", always, &
         "Mode I stress intensity factor, by the interaction integral", "k1_error_pa_sqrtm"), &
      column_t("k2_pa_sqrtm", "Pa m^1/2", always, &
         "Mode II stress intensity factor, by the interaction integral", "k2_error_pa_sqrtm"), &
      column_t("k1_dc_pa_sqrtm", "Pa m^1/2", always, &
         "Mode I stress intensity factor, by displacement correlation", "k1_dc_error_pa_sqrtm"), &
      column_t("k2_dc_pa_sqrtm", "Pa m^1/2", always, &
         "Mode II stress intensity factor, by displacement correlation", &
         "k2_dc_error_pa_sqrtm"), &
      column_t("keq_pa_sqrtm", "Pa m^1/2", always, &
         "Equivalent stress intensity factor in the direction of growth, compared with the"// &
         " toughness", "keq_error_pa_sqrtm"), &
      column_t("g_j_m2", "J/m2", always, &
         "Energy release rate in the direction of growth", "g_error_j_m2"), &
      column_t("angle_deg", "degree", always, &
         "Direction of growth from straight ahead, positive counter-clockwise", &
         "angle_error_deg"), &
      column_t("advance_m", "m", always, &
         "Advance in this increment; 0: none", &
         "position_error_m; without a fluid none: growth by increments, the load is uncertain"), &
      column_t("k1_error_pa_sqrtm", "Pa m^1/2", always), &
      column_t("k2_error_pa_sqrtm", "Pa m^1/2", always), &
      column_t("g_ahead_j_m2", "J/m2", always, &
         "Energy release rate straight ahead, by the J-integral", "g_ahead_error_j_m2"), &
      column_t("g_ahead_error_j_m2", "J/m2", always), &
      column_t("k1_dc_error_pa_sqrtm", "Pa m^1/2", always), &
      column_t("k2_dc_error_pa_sqrtm", "Pa m^1/2", always), &
      column_t("k1_corrected_pa_sqrtm", "Pa m^1/2", always, &
         "k1_pa_sqrtm corrected for the error of the mesh, where that is known; else the "// &
         "same", "k1_error_pa_sqrtm"), &
      column_t("k2_corrected_pa_sqrtm", "Pa m^1/2", always, &
         "k2_pa_sqrtm corrected for the error of the mesh, where that is known; else the "// &
         "same", "k2_error_pa_sqrtm"), &
      column_t("apparent_toughness_pa_sqrtm", "Pa m^1/2", with_fluid_and_growth, &
         "Toughness that would give, without viscosity, the opening a coarse cell's length"// &
         " behind the tip; the toughness where viscosity has no effect", &
         "none: a law of the opening behind the tip, valid where cells resolve the viscous"// &
         " layer"), &
      column_t("history_row", "-", always, "Number of the row of history.csv, from 1", label), &
      column_t("keq_error_pa_sqrtm", "Pa m^1/2", always, &
         "Estimated error of keq_pa_sqrtm, from those of K_I and K_II", an_error), &
      column_t("g_error_j_m2", "J/m2", always, "Estimated error of g_j_m2, likewise", an_error), &
      column_t("angle_error_deg", "degree", always, &
         "Estimated error of angle_deg, likewise; at most 70.53, the largest kink", an_error), &
      column_t("position_error_m", "m", with_fluid, &
         "Estimated error of the position along the path; -1 with law = 'paris' (no "// &
         "estimate)", an_error)]

   type(column_t), parameter :: fracture_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv", chosen), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv", chosen), &
      column_t("fracture", "-", always, &
         "Number of the fracture, from 1 in the scene's order", label), &
      column_t("s_m", "m", always, &
         "Arc length of the cell centre along the fracture; negative where it grew at its "// &
         "start", placed), &
      column_t("x_m", "m", always, "Cell centre", placed), &
      column_t("y_m", "m", always, "Cell centre", placed), &
      column_t("aperture_m", "m", always, &
         "Hydraulic aperture; empty without a fluid", "aperture_error_m"), &
      column_t("jump_n_m", "m", always, &
         "Normal jump of the displacement: opening", "jump_n_error_m"), &
      column_t("jump_t_m", "m", always, &
         "Tangential jump of the displacement: slip", "jump_t_error_m"), &
      column_t("traction_n_pa", "Pa", always, "Normal contact traction", "traction_n_error_pa"), &
      column_t("traction_t_pa", "Pa", always, &
         "Tangential contact traction", "traction_t_error_pa"), &
      column_t("pressure_pa", "Pa", with_fluid, &
         "Fluid pressure in the fracture", "pressure_error_pa"), &
      column_t("void_m", "m", with_fluid, &
         "Part of the aperture filled with vapour", "aperture_error_m"), &
      column_t("flow_m2_s", "m2/s", with_fluid, &
         "Flow along the fracture, mean of the cell's two ends", "flow_error_m2_s"), &
      column_t("state", "-", always, "Contact state", states), &
      column_t("history_row", "-", always, "Number of the row of history.csv, from 1", label), &
      column_t("aperture_error_m", "m", always, &
         "Estimated error of aperture_m; empty without a fluid", an_error), &
      column_t("jump_n_error_m", "m", always), &
      column_t("jump_t_error_m", "m", always), &
      column_t("traction_n_error_pa", "Pa", always), &
      column_t("traction_t_error_pa", "Pa", always), &
      column_t("pressure_error_pa", "Pa", with_fluid), &
      column_t("flow_error_m2_s", "m2/s", with_fluid), &
      column_t("temperature_k", "K", with_heat_and_fractures, &
         "Temperature of the fluid and of the faces, on the scale of the scene", &
         "temperature_error_k"), &
      column_t("temperature_error_k", "K", with_heat_and_fractures)]

   !> NAME stands for the name of a probe; all columns except the first two repeat for each probe.
   type(column_t), parameter :: probe_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv", chosen), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv", chosen), &
      column_t("NAME_p_pa", "Pa", with_fluid, "Pore pressure", "NAME_p_error_pa"), &
      column_t("NAME_ux_m", "m", always, "Displacement in x", "NAME_u_error_m"), &
      column_t("NAME_uy_m", "m", always, "Displacement in y", "NAME_u_error_m"), &
      column_t("NAME_sxx_pa", "Pa", always, "Total stress xx", "NAME_s_error_pa"), &
      column_t("NAME_syy_pa", "Pa", always, "Total stress yy", "NAME_s_error_pa"), &
      column_t("NAME_sxy_pa", "Pa", always, "Total stress xy", "NAME_s_error_pa"), &
      column_t("NAME_p_error_pa", "Pa", with_fluid, &
         "Estimated error of the pore pressure", an_error), &
      column_t("NAME_u_error_m", "m", always, "Estimated error of each displacement", an_error), &
      column_t("NAME_s_error_pa", "Pa", always, "Estimated error of each stress", an_error)]

   type(column_t), parameter :: event_columns(*) = [ &
      column_t("time_s", "s", with_fluid, &
         "Time, as in history.csv", &
         "none: that of the step; detail of growth_onset and growth_jump states it"), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv", chosen), &
      column_t("kind", "-", always, "Kind of event", label), &
      column_t("fracture", "-", always, "Number of the fracture; empty if none", label), &
      column_t("x_m", "m", always, &
         "Position; empty if not applicable", &
         "none: centre of a cell, or a tip: position_error_m of tips.csv"), &
      column_t("y_m", "m", always, &
         "Position; empty if not applicable", &
         "none: centre of a cell, or a tip: position_error_m of tips.csv"), &
      column_t("detail", "-", always, "Short description", label)]

   type(column_t), parameter :: well_columns(*) = [ &
      column_t("time_s", "s", with_wells, "Time", chosen), &
      column_t("well", "-", with_wells, "Name of the well", label), &
      column_t("stage", "-", with_wells, "Number of its stage, from 1; 0: shut in", label), &
      column_t("control", "-", with_wells, "Active control, see below", label), &
      column_t("rate_m2_s", "m2/s", with_wells, &
         "Rate into the well head, mean over the step", "rate_error_m2_s"), &
      column_t("flow_m2_s", "m2/s", with_wells, &
         "Flow from the well into fracture or rock: rate_m2_s less wellbore storage", &
         "flow_error_m2_s"), &
      column_t("pressure_pa", "Pa", with_wells, &
         "Fluid pressure at the well in fracture or rock; mean over the cells it supplies. "// &
         "With entries that in the well, before their losses", &
         "pressure_error_pa"), &
      column_t("head_pressure_pa", "Pa", with_wells, &
         "Pressure at the well head, with pressure losses; without the weight of the fluid", &
         "head_pressure_error_pa"), &
      column_t("injected_m2", "m2", with_wells, &
         "Volume into the well head so far", "injected_error_m2"), &
      column_t("injectivity_m2_s_pa", "m2/s/Pa", with_wells, &
         "flow_m2_s over the rise of pressure_pa since the start", "injectivity_error_m2_s_pa"), &
      column_t("asked_m2_s", "m2/s", with_wells, &
         "Prescribed rate of its stage; 0 without one", "none: of the scene"), &
      column_t("rate_error_m2_s", "m2/s", with_wells, &
         "Estimated error of rate_m2_s; 0 where it is prescribed", an_error), &
      column_t("flow_error_m2_s", "m2/s", with_wells), &
      column_t("pressure_error_pa", "Pa", with_wells, &
         "Estimated error of pressure_pa in time and space, with that by the length of "// &
         "growing fractures", an_error), &
      column_t("head_pressure_error_pa", "Pa", with_wells), &
      column_t("injected_error_m2", "m2", with_wells, &
         "Estimated error of injected_m2; 0 where the rate is prescribed", an_error), &
      column_t("injectivity_error_m2_s_pa", "m2/s/Pa", with_wells), &
      column_t("temperature_k", "K", with_heat_and_wells, &
         "Temperature of what the well takes out of the body, mean over the step; else of what "// &
         "it supplies", "temperature_error_k"), &
      column_t("temperature_error_k", "K", with_heat_and_wells, &
         "Estimated error of temperature_k; 0 of what it supplies", an_error)]

   type(column_t), parameter :: entry_columns(*) = [ &
      column_t("time_s", "s", with_entries, "Time", chosen), &
      column_t("well", "-", with_entries, "Name of the well", label), &
      column_t("entry", "-", with_entries, "Number of the entry in its well, from 1", label), &
      column_t("fracture", "-", with_entries, "Number of the fracture", label), &
      column_t("flow_m2_s", "m2/s", with_entries, &
         "Flow from the well into the fracture, mean over the step; negative: out of it", &
         "flow_error_m2_s"), &
      column_t("share", "-", with_entries, &
         "flow_m2_s over that of the well; 0 where the well has none", "share_error"), &
      column_t("pressure_pa", "Pa", with_entries, &
         "Fluid pressure at the entry in the fracture, behind its loss; mean over the cells "// &
         "it supplies", "pressure_error_pa"), &
      column_t("flow_error_m2_s", "m2/s", with_entries), &
      column_t("share_error", "-", with_entries), &
      column_t("pressure_error_pa", "Pa", with_entries, &
         "Estimated error of pressure_pa in time and space, with that by the length of "// &
         "growing fractures", an_error)]

   type(column_t), parameter :: slip_event_columns(*) = [ &
      column_t("event", "-", with_fluid, &
         "Number of the event, from 1, in the order of end times", label), &
      column_t("time_s", "s", with_fluid, &
         "Start of slip of the patch, or time at which it passed seismic_slip_rate", &
         "time_error_s"), &
      column_t("end_s", "s", with_fluid, &
         "End of slip, or time at which it passed seismic_slip_rate, or end of the run", &
         "time_error_s"), &
      column_t("fracture", "-", with_fluid, &
         "Number of the fracture, from 1 in the scene's order", label), &
      column_t("x_m", "m", with_fluid, "Slip-weighted centre of the event", "place_error_m"), &
      column_t("y_m", "m", with_fluid, "Slip-weighted centre of the event", "place_error_m"), &
      column_t("s_from_m", "m", with_fluid, &
         "Start of the slipped part, arc length as in fractures.csv", "place_error_m"), &
      column_t("s_to_m", "m", with_fluid, "End of the slipped part", "place_error_m"), &
      column_t("area_m2", "m2", with_fluid, &
         "Slipped length times out_of_plane_length of &output", "area_error_m2"), &
      column_t("mean_slip_m", "m", with_fluid, &
         "Mean absolute slip over that area", "mean_slip_error_m"), &
      column_t("moment_nm", "N m", with_fluid, &
         "Seismic moment: shear modulus times mean slip times area", "moment_error_nm"), &
      column_t("largest_moment_rate_nm_s", "N m/s", with_fluid, &
         "Largest moment rate, mean over a time step", of_step), &
      column_t("magnitude", "-", with_fluid, &
         "Moment magnitude (log10(moment_nm) - 9.1)/1.5 (Hanks and Kanamori 1979)", &
         "magnitude_error"), &
      column_t("open_share", "-", with_fluid, &
         "Share of the moment from open cells, without friction", &
         "none: a sum by contact states, of cells"), &
      column_t("sudden_share", "-", with_fluid, &
         "Share of the moment from steps with unstable growth, which is instantaneous", &
         "none: a sum by steps"), &
      column_t("ended_by", "-", with_fluid, "Reason of its end", label), &
      column_t("kind", "-", with_fluid, &
         "Whether the largest slip rate exceeds seismic_slip_rate of &output in every step", &
         label), &
      column_t("duration_s", "s", with_fluid, "end_s - time_s", "time_error_s"), &
      column_t("x_onset_m", "m", with_fluid, &
         "Nucleation point: centre of the cell with the largest slip rate in its first "// &
         "step", "place_error_m"), &
      column_t("y_onset_m", "m", with_fluid, "y of the same", "place_error_m"), &
      column_t("largest_slip_rate_m_s", "m/s", with_fluid, &
         "Largest slip rate of a cell, mean over a time step", of_step), &
      column_t("mean_slip_rate_m_s", "m/s", with_fluid, &
         "Mean slip over duration", "mean_slip_rate_error_m_s"), &
      column_t("stress_drop_pa", "Pa", with_fluid, &
         "Static stress drop: decrease of the shear traction in the event, mean over its "// &
         "area", "stress_drop_error_pa"), &
      column_t("time_error_s", "s", with_fluid, &
         "Estimated error of start, end and duration: the longest of its first and last "// &
         "step", an_error), &
      column_t("place_error_m", "m", with_fluid, &
         "Estimated error of its positions: the longest fracture cell of its patch", an_error), &
      column_t("area_error_m2", "m2", with_fluid, &
         "Estimated error of area_m2: such a cell at each end within its fracture", an_error), &
      column_t("mean_slip_error_m", "m", with_fluid), &
      column_t("moment_error_nm", "N m", with_fluid), &
      column_t("magnitude_error", "-", with_fluid), &
      column_t("mean_slip_rate_error_m_s", "m/s", with_fluid), &
      column_t("stress_drop_error_pa", "Pa", with_fluid)]
   !&>

end module report_columns
