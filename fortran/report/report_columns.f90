!> The table of all columns, keys and fields of a run's files.
!!
!! The tables of a run and the table of names (report_describe) take the names and the order of the
!! columns from here; tests compare the keys of run.json and network.json and the fields of the VTU
!! files with it. A new column is one entry here, at its position, and one line in report_tables,
!! the source of its value.
module report_columns
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: applies, column_t, well_count, word_t
   public :: event_columns, fracture_columns, history_columns, probe_columns
   public :: slip_event_columns, tip_columns, well_columns
   public :: fracture_fields, intersection_fields, matrix_fields
   public :: network_keys, record_keys
   public :: contact_words, end_words, event_words, joint_words, slip_words, status_words, &
             well_words

   ! Runs in which a column, key or field is written.
   character(len=*), parameter :: always = "always"
   character(len=*), parameter :: with_fluid = "with a fluid"
   character(len=*), parameter :: with_fractures = "with a fluid and fractures"
   character(len=*), parameter :: without_fluid = "without a fluid"
   character(len=*), parameter :: with_growth = "without a fluid, with growth"
   character(len=*), parameter :: with_toughness = "with tips and a toughness"
   character(len=*), parameter :: with_joints = "with a fluid and joints"
   character(len=*), parameter :: with_wells = "with a fluid and wells"
   character(len=*), parameter :: with_fluid_and_growth = "with a fluid and growth"
   character(len=*), parameter :: with_wells_and_growth = "with a fluid, wells and growth"
   character(len=*), parameter :: with_one_well = "with a fluid and one well"
   character(len=*), parameter :: at_most_one = "with a fluid and at most one well"
   character(len=*), parameter :: with_several = "with a fluid and several wells"
   character(len=*), parameter :: with_error = "without a fluid, with &adaptive"

   !> A column of a table, a key of a JSON file (a dot leads into an object, brackets into a list)
   !! or a field of a VTU file.
   type :: column_t
      character(len=28) :: name = ""
      character(len=8) :: unit = "-"
      character(len=40) :: runs = always  !< runs in which it is written
      character(len=160) :: meaning = ""
   end type column_t

   !> A possible word of a column or key.
   type :: word_t
      character(len=16) :: word = ""
      character(len=208) :: meaning = ""
   end type word_t

   ! The tables keep their own layout.
   !&<
   type(column_t), parameter :: history_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time"), &
      column_t("load_factor", "-", without_fluid, "Factor on the loads of the scene"), &
      column_t("dt_s", "s", with_fluid, "Step size: time_s since the previous row"), &
      column_t("newton_iterations", "-", always, "Contact iterations in the step"), &
      column_t("well_pressure_pa", "Pa", at_most_one, &
         "Fluid pressure at the well in fracture or rock; in a fracture the mean over the "// &
         "cells and joints it supplies; 0 without a well"), &
      column_t("NAME_well_pressure_pa", "Pa", with_several, &
         "The same for each well by name: one column per well"), &
      column_t("injected_m2", "m2", with_fluid, &
         "Injected volume so far, less the produced volume (produced_m2)"), &
      column_t("leakoff_m2", "m2", with_fluid, &
         "Leak-off from the fractures into the rock so far; negative: into the fractures"), &
      column_t("prefilled_m2", "m2", with_fluid, "Initial fluid of new fracture cells so far"), &
      column_t("outflow_m2", "m2", with_fluid, &
         "Outflow through fracture ends on sides with prescribed pressure so far; negative: "// &
         "inflow"), &
      column_t("fracture_volume_m2", "m2", always, &
         "Volume of the fractures: aperture, without a fluid opening, times length"), &
      column_t("mass_error_relative", "-", with_fluid, &
         "Numerical error of the fluid mass so far, relative to the injected volume or the "// &
         "fracture volume"), &
      column_t("max_slip_m", "m", always, "Largest absolute slip"), &
      column_t("max_opening_m", "m", always, "Largest normal jump"), &
      column_t("n_stick", "-", always, "Fracture cells that stick"), &
      column_t("n_slip", "-", always, "Fracture cells that slip"), &
      column_t("n_open", "-", always, "Fracture cells that are open"), &
      column_t("fracture_length_m", "m", always, "Length of all fractures"), &
      column_t("n_tips", "-", always, "Free tips"), &
      column_t("n_intersections", "-", always, "Intersections of fractures"), &
      column_t("seismic_moment_nm", "N m/m", always, &
         "Sum over all cells of shear modulus times slip so far times length"), &
      column_t("fracture_length_error_m", "m", with_fluid, &
         "Estimated error of fracture_length_m if tips have grown; -1 with law = 'paris' (no "// &
         "estimate)"), &
      column_t("well_pressure_error_pa", "Pa", with_fluid, &
         "Estimated error of the well pressure, with several wells of their mean; -1 with law "// &
         "= 'paris'"), &
      column_t("strain_energy_j", "J/m", without_fluid, "Elastic energy of the body"), &
      column_t("injection_rate_m2_s", "m2/s", with_wells, "Net flow from all wells in the step"), &
      column_t("injectivity_m2_s_pa", "m2/s/Pa", with_one_well, &
         "injection_rate_m2_s of a well in a fracture over the rise of well_pressure_pa above "// &
         "the initial pressure of the surrounding rock; 0 without a rise"), &
      column_t("produced_m2", "m2", with_wells, "Produced volume so far"), &
      column_t("fracture_fluid_m2", "m2", with_fractures, &
         "Increase of fluid in the fractures so far, by volume and compression; joints have no "// &
         "volume"), &
      column_t("rock_fluid_m2", "m2", with_fluid, "Increase of fluid in the rock so far"), &
      column_t("rock_outflow_m2", "m2", with_fluid, &
         "Outflow from the rock through sides with prescribed pressure so far; negative: inflow"), &
      column_t("stimulated_length_m", "m", with_fractures, &
         "Length of fractures that are new, or have at any time slipped or opened by more than "// &
         "stimulated_jump of &output since the start"), &
      column_t("connected_length_m", "m", with_wells, &
         "Length of the fractures connected to the wells along fractures and through joints"), &
      column_t("connected_stimulated_m", "m", with_wells, &
         "Connected part of stimulated_length_m"), &
      column_t("n_clusters", "-", with_fractures, "Clusters of connected fractures"), &
      column_t("max_slip_rate_m_s", "m/s", with_fluid, "Largest slip rate, mean over the step"), &
      column_t("connections_per_branch", "-", with_fractures, &
         "Mean number of connected ends of a branch of the network: 0 to 2 (Sanderson and "// &
         "Nixon 2015)"), &
      column_t("dimensionless_toughness", "-", with_wells_and_growth, &
               "K_m of injection_rate_m2_s and the toughness of &material: viscosity "// &
               "dominates below 1, toughness above 4; 0 without injection"), &
      column_t("dimensionless_leakoff", "-", with_wells_and_growth, &
               "C_m, likewise, of the largest well pressure above the initial one: leak-off "// &
               "dominates where it is large")]

   type(column_t), parameter :: tip_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv"), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv"), &
      column_t("tip", "-", always, &
         "Number of the tip, from 1: the same in all rows and in network.json"), &
      column_t("fracture", "-", always, "Number of its fracture, from 1 in the scene's order"), &
      column_t("x_m", "m", always, "Position of the tip before the increment"), &
      column_t("y_m", "m", always, "Position of the tip before the increment"), &
      column_t("k1_pa_sqrtm", "Pa m^1/2", always, &
         "Mode I stress intensity factor, by the interaction integral"), &
      column_t("k2_pa_sqrtm", "Pa m^1/2", always, &
         "Mode II stress intensity factor, by the interaction integral"), &
      column_t("k1_dc_pa_sqrtm", "Pa m^1/2", always, &
         "Mode I stress intensity factor, by displacement correlation"), &
      column_t("k2_dc_pa_sqrtm", "Pa m^1/2", always, &
         "Mode II stress intensity factor, by displacement correlation"), &
      column_t("keq_pa_sqrtm", "Pa m^1/2", always, &
         "Equivalent stress intensity factor in the direction of growth, compared with the "// &
         "toughness"), &
      column_t("g_j_m2", "J/m2", always, "Energy release rate in the direction of growth"), &
      column_t("angle_deg", "degree", always, &
         "Direction of growth from straight ahead, positive counter-clockwise"), &
      column_t("advance_m", "m", always, "Advance in this increment; 0: none"), &
      column_t("k1_error_pa_sqrtm", "Pa m^1/2", always, "Estimated error of k1_pa_sqrtm"), &
      column_t("k2_error_pa_sqrtm", "Pa m^1/2", always, "Estimated error of k2_pa_sqrtm"), &
      column_t("g_ahead_j_m2", "J/m2", always, &
         "Energy release rate straight ahead, by the J-integral"), &
      column_t("g_ahead_error_j_m2", "J/m2", always, "Estimated error of g_ahead_j_m2"), &
      column_t("k1_dc_error_pa_sqrtm", "Pa m^1/2", always, "Estimated error of k1_dc_pa_sqrtm"), &
      column_t("k2_dc_error_pa_sqrtm", "Pa m^1/2", always, "Estimated error of k2_dc_pa_sqrtm"), &
      column_t("k1_corrected_pa_sqrtm", "Pa m^1/2", always, &
         "k1_pa_sqrtm corrected for the error of the mesh, where that is known; else the same"), &
      column_t("k2_corrected_pa_sqrtm", "Pa m^1/2", always, &
         "k2_pa_sqrtm corrected for the error of the mesh, where that is known; else the same"), &
      column_t("apparent_toughness_pa_sqrtm", "Pa m^1/2", with_fluid_and_growth, &
               "Toughness that would give, without viscosity, the opening a coarse cell's "// &
               "length behind the tip; the toughness where viscosity has no effect"), &
      column_t("history_row", "-", always, "Number of the row of history.csv, from 1")]

   type(column_t), parameter :: fracture_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv"), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv"), &
      column_t("fracture", "-", always, "Number of the fracture, from 1 in the scene's order"), &
      column_t("s_m", "m", always, &
         "Arc length of the cell centre along the fracture; negative where it grew at its start"), &
      column_t("x_m", "m", always, "Cell centre"), &
      column_t("y_m", "m", always, "Cell centre"), &
      column_t("aperture_m", "m", always, "Hydraulic aperture; empty without a fluid"), &
      column_t("jump_n_m", "m", always, "Normal jump of the displacement: opening"), &
      column_t("jump_t_m", "m", always, "Tangential jump of the displacement: slip"), &
      column_t("traction_n_pa", "Pa", always, "Normal contact traction"), &
      column_t("traction_t_pa", "Pa", always, "Tangential contact traction"), &
      column_t("pressure_pa", "Pa", with_fluid, "Fluid pressure in the fracture"), &
      column_t("void_m", "m", with_fluid, "Part of the aperture filled with vapour"), &
      column_t("flow_m2_s", "m2/s", with_fluid, &
         "Flow along the fracture, mean of the cell's two ends"), &
      column_t("state", "-", always, "Contact state"), &
      column_t("history_row", "-", always, "Number of the row of history.csv, from 1")]

   !> NAME stands for the name of a probe; all columns except the first two repeat for each probe.
   type(column_t), parameter :: probe_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv"), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv"), &
      column_t("NAME_p_pa", "Pa", with_fluid, "Pore pressure"), &
      column_t("NAME_ux_m", "m", always, "Displacement in x"), &
      column_t("NAME_uy_m", "m", always, "Displacement in y"), &
      column_t("NAME_sxx_pa", "Pa", always, "Total stress xx"), &
      column_t("NAME_syy_pa", "Pa", always, "Total stress yy"), &
      column_t("NAME_sxy_pa", "Pa", always, "Total stress xy")]

   type(column_t), parameter :: event_columns(*) = [ &
      column_t("time_s", "s", with_fluid, "Time, as in history.csv"), &
      column_t("load_factor", "-", without_fluid, "Load factor, as in history.csv"), &
      column_t("kind", "-", always, "Kind of event"), &
      column_t("fracture", "-", always, "Number of the fracture; empty if none"), &
      column_t("x_m", "m", always, "Position; empty if not applicable"), &
      column_t("y_m", "m", always, "Position; empty if not applicable"), &
      column_t("detail", "-", always, "Short description")]

   type(column_t), parameter :: well_columns(*) = [ &
      column_t("time_s", "s", with_wells, "Time"), &
      column_t("well", "-", with_wells, "Name of the well"), &
      column_t("stage", "-", with_wells, "Number of its stage, from 1; 0: shut in"), &
      column_t("control", "-", with_wells, "Active control, see below"), &
      column_t("rate_m2_s", "m2/s", with_wells, "Rate into the well head, mean over the step"), &
      column_t("flow_m2_s", "m2/s", with_wells, &
         "Flow from the well into fracture or rock: rate_m2_s less wellbore storage"), &
      column_t("pressure_pa", "Pa", with_wells, &
         "Fluid pressure at the well in fracture or rock; mean over the cells it supplies"), &
      column_t("head_pressure_pa", "Pa", with_wells, &
         "Pressure at the well head, with pressure losses; without the weight of the fluid"), &
      column_t("injected_m2", "m2", with_wells, "Volume into the well head so far"), &
      column_t("injectivity_m2_s_pa", "m2/s/Pa", with_wells, &
         "flow_m2_s over the rise of pressure_pa since the start"), &
      column_t("asked_m2_s", "m2/s", with_wells, "Prescribed rate of its stage; 0 without one")]

   type(word_t), parameter :: well_words(*) = [ &
      word_t("rate", "the prescribed rate"), &
      word_t("pressure", "the prescribed pressure"), &
      word_t("limit", &
         "the pressure limit of a rate; no flow if the pressure around the well exceeds it"), &
      word_t("shut", &
         "no rate at the head: before its start, or after its end, when stored fluid still flows")]

   type(column_t), parameter :: slip_event_columns(*) = [ &
    column_t("event", "-", with_fluid, "Number of the event, from 1, in the order of end times"), &
      column_t("time_s", "s", with_fluid, &
         "Start of slip of the patch, or time at which it passed seismic_slip_rate"), &
      column_t("end_s", "s", with_fluid, &
         "End of slip, or time at which it passed seismic_slip_rate, or end of the run"), &
      column_t("fracture", "-", with_fluid, &
         "Number of the fracture, from 1 in the scene's order"), &
      column_t("x_m", "m", with_fluid, "Slip-weighted centre of the event"), &
      column_t("y_m", "m", with_fluid, "Slip-weighted centre of the event"), &
      column_t("s_from_m", "m", with_fluid, &
         "Start of the slipped part, arc length as in fractures.csv"), &
      column_t("s_to_m", "m", with_fluid, "End of the slipped part"), &
      column_t("area_m2", "m2", with_fluid, &
         "Slipped length times out_of_plane_length of &output"), &
      column_t("mean_slip_m", "m", with_fluid, "Mean absolute slip over that area"), &
      column_t("moment_nm", "N m", with_fluid, &
         "Seismic moment: shear modulus times mean slip times area"), &
      column_t("largest_moment_rate_nm_s", "N m/s", with_fluid, &
         "Largest moment rate, mean over a time step"), &
      column_t("magnitude", "-", with_fluid, &
         "Moment magnitude (log10(moment_nm) - 9.1)/1.5 (Hanks and Kanamori 1979)"), &
      column_t("open_share", "-", with_fluid, &
         "Share of the moment from open cells, without friction"), &
      column_t("sudden_share", "-", with_fluid, &
         "Share of the moment from steps with unstable growth, which is instantaneous"), &
      column_t("ended_by", "-", with_fluid, "Reason of its end"), &
      column_t("kind", "-", with_fluid, &
         "Whether the largest slip rate exceeds seismic_slip_rate of &output in every step"), &
      column_t("duration_s", "s", with_fluid, "end_s - time_s"), &
      column_t("x_onset_m", "m", with_fluid, &
         "Nucleation point: centre of the cell with the largest slip rate in its first step"), &
      column_t("y_onset_m", "m", with_fluid, "y of the same"), &
      column_t("largest_slip_rate_m_s", "m/s", with_fluid, &
         "Largest slip rate of a cell, mean over a time step"), &
      column_t("mean_slip_rate_m_s", "m/s", with_fluid, "Mean slip over duration"), &
      column_t("stress_drop_pa", "Pa", with_fluid, &
         "Static stress drop: decrease of the shear traction in the event, mean over its area")]

   type(column_t), parameter :: record_keys(*) = [ &
      column_t("scene", "-", always, "The scene's name"), &
      column_t("version", "-", always, "Version of this program"), &
      column_t("status", "-", always, "How the run ended"), &
      column_t("reason", "-", always, "Reason of the end"), &
      column_t("steps", "-", always, "Accepted time steps; without a fluid load states"), &
      column_t("cells", "-", always, "Triangles of the mesh at the end"), &
      column_t("fracture_cells", "-", always, "Fracture cells at the end"), &
      column_t("dofs", "-", always, "Unknowns by kind"), &
      column_t("dofs.displacement", "-", always, "Displacement of the body"), &
      column_t("dofs.matrix_pressure", "-", with_fluid, "Pore pressure"), &
      column_t("dofs.fracture_jump", "-", with_fluid, "Jump of the displacement"), &
      column_t("dofs.fracture_face_pressure", "-", with_fluid, &
         "Pore pressure on the faces of the fractures"), &
      column_t("dofs.fracture_pressure", "-", with_fluid, "Pressure in the fractures"), &
      column_t("dofs.fracture_flow", "-", with_fluid, &
         "Flow between fracture cells and into intersections"), &
      column_t("dofs.intersection_pressure", "-", with_joints, &
         "Pressure at intersections and at fracture ends on sides with prescribed pressure"), &
      column_t("dofs.windows", "-", with_fluid, "Displacement in the windows around the tips"), &
      column_t("dofs.windows_reference", "-", with_fluid, &
         "Displacement in the body as one window, for comparison"), &
      column_t("used", "-", always, "Features used by the run"), &
      column_t("left_out", "-", always, "Features not used"), &
      column_t("timers_s", "s", always, "Processor time by phase"), &
      column_t("timers_s.mesh", "s", always, "Initial mesh"), &
      column_t("timers_s.discretize", "s", always, "Finite-volume stencils"), &
      column_t("timers_s.assemble", "s", always, "Matrices and right-hand sides"), &
      column_t("timers_s.factorize", "s", always, "Factorizations"), &
      column_t("timers_s.solve", "s", always, "Solutions with the factors"), &
      column_t("timers_s.contact", "s", always, "Newton iterations on the fractures"), &
      column_t("timers_s.tips", "s", always, "Windows, stress intensity factors, growth"), &
      column_t("timers_s.remesh", "s", always, "Remeshing"), &
      column_t("timers_s.transfer", "s", always, "State transfer between meshes"), &
      column_t("timers_s.output", "s", always, "Files and progress line"), &
      column_t("cpu_s", "s", always, "Processor time of the whole run"), &
      column_t("wall_s", "s", always, "Wall time"), &
      column_t("peak_memory_mb", "MB", always, "Peak memory, in units of 2^20 bytes"), &
      column_t("mass_error_relative", "-", always, &
         "Largest mass_error_relative of history.csv; 0 without a fluid"), &
      column_t("contact_residual", "-", always, &
         "Largest relative residual of the contact problem at an accepted state"), &
      column_t("keq_over_kic", "-", with_toughness, &
         "Largest keq_pa_sqrtm of tips.csv over the toughness"), &
      column_t("lowest_pressure_pa", "Pa", with_fluid, &
         "Lowest fluid pressure of all cells and accepted states"), &
      column_t("condition_estimate", "-", with_fractures, &
         "Largest estimated condition number of the Newton matrices"), &
      column_t("forward_error_bound", "-", with_fractures, &
         "Largest bound of the relative error of their jumps and pressures"), &
      column_t("smallest_angle_deg", "degree", without_fluid, &
         "Smallest angle of the triangles of all meshes"), &
      column_t("energy_error_relative", "-", with_error, &
         "Estimated error of the last solution in the energy norm"), &
      column_t("newton_iterations", "-", always, "Iterations of the contact problem"), &
      column_t("newton_iterations.total", "-", always, "All iterations, including cut steps"), &
      column_t("newton_iterations.max", "-", always, "Largest number in one accepted step"), &
      column_t("step_cuts", "-", always, "Number of step cuts"), &
      column_t("increments", "-", with_growth, "Increments of growth, each of one or more tips"), &
      column_t("meshes", "-", with_growth, "Number of meshes"), &
      column_t("meshes.whole", "-", with_growth, "Meshes of the whole body"), &
      column_t("meshes.patched", "-", with_growth, "Meshes of patches around growing tips"), &
      column_t("growth_jumps", "-", with_fluid_and_growth, &
      "Number of steps in which tips grew without equilibrium until they arrested"), &
      column_t("longest_growth_jump_m", "m", with_fluid_and_growth, &
         "Longest advance of a tip in one of these steps"), &
      column_t("warnings", "-", always, "Warnings, each once")]

   type(column_t), parameter :: network_keys(*) = [ &
      column_t("fractures", "-", always, "The fractures at the end, in the scene's order"), &
      column_t("fractures[].fracture", "-", always, "Number of the fracture, from 1"), &
      column_t("fractures[].name", "-", always, "Its name in the scene"), &
      column_t("fractures[].length_m", "m", always, "Its length"), &
      column_t("fractures[].s_start_m", "m", always, &
         "Arc length of its first vertex: 0, or negative after growth there"), &
      column_t("fractures[].x_m", "m", always, "x of its vertices, a list"), &
      column_t("fractures[].y_m", "m", always, "y of its vertices, a list"), &
      column_t("tips", "-", always, "The free tips at the end"), &
      column_t("tips[].tip", "-", always, &
         "Number of the tip, as in tips.csv; those of joined tips are not reused"), &
      column_t("tips[].fracture", "-", always, "Number of its fracture"), &
      column_t("tips[].end", "-", always, "End of the fracture: `start` or `end`"), &
      column_t("tips[].x_m", "m", always, "Position of the tip"), &
      column_t("tips[].y_m", "m", always, "Position of the tip"), &
      column_t("tips[].direction", "-", always, "Unit vector straight ahead, x and y"), &
      column_t("joints", "-", always, &
         "Points where fractures meet each other or the boundary; may be empty"), &
      column_t("joints[].kind", "-", always, "Type of joint"), &
      column_t("joints[].time_s", "s", with_fluid, "Time at which the joint formed"), &
      column_t("joints[].load_factor", "-", without_fluid, &
         "Load factor at which the joint formed"), &
      column_t("joints[].x_m", "m", always, "Position of the joint"), &
      column_t("joints[].y_m", "m", always, "Position of the joint"), &
      column_t("joints[].fractures", "-", always, "Numbers of the fractures, each once"), &
      column_t("steps", "-", always, "The network after each change, including the initial one"), &
      column_t("steps[].time_s", "s", with_fluid, "Time of the change"), &
      column_t("steps[].load_factor", "-", without_fluid, "Load factor of the change"), &
      column_t("steps[].fractures", "-", always, "The fractures at that time, as above"), &
      column_t("steps[].tips", "-", always, "The free tips at that time, as above")]

   type(column_t), parameter :: matrix_fields(*) = [ &
      column_t("nodal_displacement", "m", always, "Displacement at the nodes: X, Y, Z"), &
      column_t("displacement", "m", always, "Displacement of the cells: X, Y, Z"), &
      column_t("pressure", "Pa", with_fluid, "Pore pressure"), &
      column_t("stress", "Pa", always, "Total stress: XX, YY, ZZ, XY, YZ, XZ"), &
      column_t("permeability", "m2", with_fluid, "Permeability: XX, YY, ZZ, XY, YZ, XZ")]

   type(column_t), parameter :: fracture_fields(*) = [ &
      column_t("fracture", "-", always, "Number of the fracture, from 1"), &
      column_t("arc_length", "m", always, "s_m of fractures.csv"), &
      column_t("aperture", "m", with_fluid, "Hydraulic aperture"), &
      column_t("jump", "m", always, "Jump of the displacement: normal, tangential"), &
      column_t("traction", "Pa", always, "Contact traction: normal, tangential"), &
      column_t("pressure", "Pa", with_fluid, "Fluid pressure in the fracture"), &
      column_t("flow", "m2/s", with_fluid, "Flow along the fracture"), &
      column_t("state", "-", always, "Contact state: 0 stick, 1 slip, 2 open")]

   type(column_t), parameter :: intersection_fields(*) = [ &
      column_t("pressure", "Pa", with_fluid, &
         "Fluid pressure at intersections and at fracture ends on sides with prescribed pressure")]

   type(word_t), parameter :: contact_words(*) = [ &
      word_t("stick", "closed, no slip increment"), &
      word_t("slip", "closed, slipping"), &
      word_t("open", "open")]

   type(word_t), parameter :: event_words(*) = [ &
      word_t("slip_onset", "a fracture slips for the first time"), &
      word_t("opening", "a fracture opens for the first time"), &
      word_t("growth_onset", "a tip begins to grow; `detail` has the uncertainty of the time"), &
      word_t("growth", "a tip has grown, to the given position"), &
      word_t("joint", "a tip has joined a fracture or the boundary"), &
      word_t("arrest", "a tip has stopped permanently, for the reason in `detail`"), &
      word_t("step_cut", &
         "a time step did not converge, had too large a time error, or tips would begin to "// &
         "grow or grow too far in it: it is repeated with a shorter step"), &
      word_t("unstable_growth", &
         "tips have grown at constant time until they arrested, or exceed K_IC in the initial "// &
         "state and grow at once; without a fluid a row at the start and one at the end, with "// &
         "the energy released"), &
      word_t("bifurcation", &
         "tips grow together, but any difference between them would grow: one of them may "// &
         "advance ahead of the others; or one of equal tips is ahead, by chance"), &
      word_t("remesh", "the mesh was updated after growth"), &
    word_t("well", &
         "a stage of a well begins, it is shut in, or it reaches or leaves its pressure limit; "// &
         "see `detail`"), &
      word_t("growth_jump", &
        "with a fluid, a tip has grown without equilibrium in a step too short to matter, from "// &
         "the given position; `detail` has its length, the well pressure before and after, and "// &
         "the error of the time"), &
      word_t("growth_uncertain", &
         "a tip grows or may grow, but the error of its K makes the pressure or the position "// &
         "uncertain; see `detail`"), &
      word_t("window", &
         "stress intensity factors of a tip that would grow are too uncertain: its window is "// &
         "enlarged or refined; see `detail`")]

   type(word_t), parameter :: end_words(*) = [ &
      word_t("stick", "no cell of it slips any more"), &
      word_t("speed", "its slip rate passed seismic_slip_rate; slip continues as another event"), &
      word_t("run", "the run ended during slip")]

   type(word_t), parameter :: slip_words(*) = [ &
      word_t("seismic", "faster than seismic_slip_rate"), &
      word_t("aseismic", "slower")]

   type(word_t), parameter :: joint_words(*) = [ &
      word_t("boundary", "a fracture ends on the outer boundary"), &
      word_t("T", "a fracture ends on another one"), &
      word_t("X", "two fractures cross"), &
      word_t("V", "the ends of two fractures meet")]

   type(word_t), parameter :: status_words(*) = [ &
      word_t("finished", "the end of the scene was reached"), &
      word_t("stopped", "interrupted from outside"), &
      word_t("failed", "the run could not continue")]
   !&>

contains

   !> A column is written in the run of a scene, as far as that follows from the scene.
   elemental logical function applies(column, scene)
      type(column_t), intent(in) :: column
      type(scene_t), intent(in) :: scene

      select case (column%runs)
      case (with_fluid)
         applies = scene%has_fluid()
      case (with_fractures)
         applies = scene%has_fluid() .and. scene%has_fractures()
      case (with_wells)
         applies = scene%has_fluid() .and. scene%has_wells()
      case (with_fluid_and_growth)
         applies = scene%has_fluid() .and. scene%growth%enabled
      case (with_wells_and_growth)
         applies = scene%has_fluid() .and. scene%has_wells() .and. scene%growth%enabled
      case (with_one_well)
         applies = scene%has_fluid() .and. well_count(scene) == 1
      case (at_most_one)
         applies = scene%has_fluid() .and. well_count(scene) <= 1
      case (with_several)
         applies = scene%has_fluid() .and. well_count(scene) > 1
      case (without_fluid)
         applies = .not. scene%has_fluid()
      case default
         applies = .true.
      end select
   end function applies

   !> Number of wells of a scene with a fluid.
   pure integer function well_count(scene) result(n)
      type(scene_t), intent(in) :: scene

      n = 0
      if (scene%has_fluid() .and. scene%has_wells()) n = size(scene%injections)
   end function well_count

end module report_columns
