!> The table of all keys of run.json and network.json, and of the fields of the VTU files; tests
!! compare the files of real runs with it.
module report_keys
   use report_column, only: always, an_error, chosen, column_t, counted, label, measured, &
                            of_heat, placed, states, with_error, with_fluid, &
                            with_fluid_and_growth, with_fractures, with_growth, with_heat, &
                            with_joints, with_toughness, without_fluid
   implicit none(type, external)
   private

   public :: fracture_fields, intersection_fields, matrix_fields, network_keys, record_keys
   public :: window_fields

   ! The tables keep their own layout.
   !&<
   type(column_t), parameter :: record_keys(*) = [ &
      column_t("scene", "-", always, "The scene's name", label), &
      column_t("version", "-", always, "Version of this program", label), &
      column_t("status", "-", always, "How the run ended", label), &
      column_t("reason", "-", always, "Reason of the end", label), &
      column_t("steps", "-", always, &
         "Accepted time steps; without a fluid load states", counted), &
      column_t("cells", "-", always, "Triangles of the mesh at the end", counted), &
      column_t("fracture_cells", "-", always, "Fracture cells at the end", counted), &
      column_t("dofs", "-", always, "Unknowns by kind", counted), &
      column_t("dofs.displacement", "-", always, "Displacement of the body", counted), &
      column_t("dofs.matrix_pressure", "-", with_fluid, "Pore pressure", counted), &
      column_t("dofs.fracture_jump", "-", with_fluid, "Jump of the displacement", counted), &
      column_t("dofs.fracture_face_pressure", "-", with_fluid, &
         "Pore pressure on the faces of the fractures", counted), &
      column_t("dofs.fracture_pressure", "-", with_fluid, "Pressure in the fractures", counted), &
      column_t("dofs.fracture_flow", "-", with_fluid, &
         "Flow between fracture cells and into intersections", counted), &
      column_t("dofs.intersection_pressure", "-", with_joints, &
         "Pressure at intersections and at fracture ends on sides with prescribed pressure", &
         counted), &
      column_t("dofs.windows", "-", with_fluid, &
         "Displacement in the windows around the tips", counted), &
      column_t("dofs.windows_reference", "-", with_fluid, &
         "Displacement in the body as one window, for comparison", counted), &
      column_t("used", "-", always, "Features used by the run", label), &
      column_t("left_out", "-", always, "Features not used", label), &
      column_t("timers_s", "s", always, "Processor time by phase", measured), &
      column_t("timers_s.mesh", "s", always, "Initial mesh", measured), &
      column_t("timers_s.discretize", "s", always, "Finite-volume stencils", measured), &
      column_t("timers_s.assemble", "s", always, "Matrices and right-hand sides", measured), &
      column_t("timers_s.factorize", "s", always, "Factorizations", measured), &
      column_t("timers_s.solve", "s", always, "Solutions with the factors", measured), &
      column_t("timers_s.contact", "s", always, "Newton iterations on the fractures", measured), &
      column_t("timers_s.tips", "s", always, &
         "Windows, stress intensity factors, growth", measured), &
      column_t("timers_s.remesh", "s", always, "Remeshing", measured), &
      column_t("timers_s.transfer", "s", always, "State transfer between meshes", measured), &
      column_t("timers_s.output", "s", always, "Files and progress line", measured), &
      column_t("cpu_s", "s", always, "Processor time of the whole run", measured), &
      column_t("wall_s", "s", always, "Wall time", measured), &
      column_t("peak_memory_mb", "MB", always, "Peak memory, in units of 2^20 bytes", measured), &
      column_t("mass_error_relative", "-", always, &
         "Largest mass_error_relative of history.csv; 0 without a fluid", an_error), &
      column_t("contact_residual", "-", always, &
         "Largest relative residual of the contact problem at an accepted state", an_error), &
      column_t("keq_over_kic", "-", with_toughness, &
         "Largest keq_pa_sqrtm of tips.csv over the toughness", "keq_over_kic_error"), &
      column_t("keq_over_kic_error", "-", with_toughness), &
      column_t("lowest_pressure_pa", "Pa", with_fluid, &
         "Lowest fluid pressure of all cells and accepted states", "lowest_pressure_error_pa"), &
      column_t("lowest_pressure_error_pa", "Pa", with_fluid), &
      column_t("condition_estimate", "-", with_fractures, &
         "Largest estimated condition number of the Newton matrices", an_error), &
      column_t("forward_error_bound", "-", with_fractures, &
         "Largest bound of the relative error of their jumps and pressures", an_error), &
      column_t("smallest_angle_deg", "degree", without_fluid, &
         "Smallest angle of the triangles of all meshes", "none: of the mesh, exact"), &
      column_t("energy_error_relative", "-", with_error, &
         "Estimated error in the energy norm, of the last solution, or with a fluid of the "// &
         "response to the wells", an_error), &
      column_t("heat_error_relative", "-", with_heat, &
         "heat_error_relative of the last row of history.csv", an_error), &
      column_t("heat_beyond_range_k", "K", with_heat, &
         "Largest excess of a temperature over the range of those before the first step, of "// &
         "sides and of wells; 0 with a heat_flux or a source", an_error), &
      column_t("newton_iterations", "-", always, "Iterations of the contact problem", counted), &
      column_t("newton_iterations.total", "-", always, &
         "All iterations, including cut steps", counted), &
      column_t("newton_iterations.max", "-", always, &
         "Largest number in one accepted step", counted), &
      column_t("step_cuts", "-", always, "Number of step cuts", counted), &
      column_t("increments", "-", with_growth, &
         "Increments of growth, each of one or more tips", counted), &
      column_t("meshes", "-", with_growth, "Number of meshes", counted), &
      column_t("meshes.whole", "-", with_growth, "Meshes of the whole body", counted), &
      column_t("meshes.patched", "-", with_growth, &
         "Meshes of patches around growing tips", counted), &
      column_t("growth_jumps", "-", with_fluid_and_growth, &
         "Number of steps in which tips grew without equilibrium until they arrested", counted), &
      column_t("longest_growth_jump_m", "m", with_fluid_and_growth, &
         "Longest advance of a tip in one of these steps", &
         "none: growth_jump in events.csv; fracture_length_error_m has the part uncertain "// &
         "in time"), &
      column_t("warnings", "-", always, "Warnings, each once", label)]

   type(column_t), parameter :: network_keys(*) = [ &
      column_t("fractures", "-", always, &
         "The fractures at the end, in the scene's order", label), &
      column_t("fractures[].fracture", "-", always, "Number of the fracture, from 1", label), &
      column_t("fractures[].name", "-", always, "Its name in the scene", label), &
      column_t("fractures[].length_m", "m", always, &
         "Its length", "position_error_m of tips.csv"), &
      column_t("fractures[].s_start_m", "m", always, &
         "Arc length of its first vertex: 0, or negative after growth there", &
         "position_error_m of tips.csv"), &
      column_t("fractures[].x_m", "m", always, &
         "x of its vertices, a list", "position_error_m of tips.csv"), &
      column_t("fractures[].y_m", "m", always, &
         "y of its vertices, a list", "position_error_m of tips.csv"), &
      column_t("tips", "-", always, "The free tips at the end", label), &
      column_t("tips[].tip", "-", always, &
         "Number of the tip, as in tips.csv; those of joined tips are not reused", label), &
      column_t("tips[].fracture", "-", always, "Number of its fracture", label), &
      column_t("tips[].end", "-", always, "End of the fracture: `start` or `end`", label), &
      column_t("tips[].x_m", "m", always, &
         "Position of the tip", "position_error_m of tips.csv"), &
      column_t("tips[].y_m", "m", always, &
         "Position of the tip", "position_error_m of tips.csv"), &
      column_t("tips[].direction", "-", always, &
         "Unit vector straight ahead, x and y", "angle_error_deg of tips.csv"), &
      column_t("joints", "-", always, &
         "Points where fractures meet each other or the boundary; may be empty", label), &
      column_t("joints[].kind", "-", always, "Type of joint", label), &
      column_t("joints[].time_s", "s", with_fluid, "Time at which the joint formed", chosen), &
      column_t("joints[].load_factor", "-", without_fluid, &
         "Load factor at which the joint formed", chosen), &
      column_t("joints[].x_m", "m", always, &
         "Position of the joint", "position_error_m of tips.csv"), &
      column_t("joints[].y_m", "m", always, &
         "Position of the joint", "position_error_m of tips.csv"), &
      column_t("joints[].fractures", "-", always, "Numbers of the fractures, each once", label), &
      column_t("steps", "-", always, &
         "The network after each change, including the initial one", label), &
      column_t("steps[].time_s", "s", with_fluid, "Time of the change", chosen), &
      column_t("steps[].load_factor", "-", without_fluid, "Load factor of the change", chosen), &
      column_t("steps[].fractures", "-", always, "The fractures at that time, as above", label), &
      column_t("steps[].tips", "-", always, "The free tips at that time, as above", label)]

   type(column_t), parameter :: matrix_fields(*) = [ &
      column_t("nodal_displacement", "m", always, &
         "Displacement at the nodes: X, Y, Z", "displacement_error"), &
      column_t("displacement", "m", always, &
         "Displacement of the cells: X, Y, Z", "displacement_error"), &
      column_t("pressure", "Pa", with_fluid, "Pore pressure", "pressure_error"), &
      column_t("stress", "Pa", always, "Total stress: XX, YY, ZZ, XY, YZ, XZ", "stress_error"), &
      column_t("permeability", "m2", with_fluid, &
         "Permeability: XX, YY, ZZ, XY, YZ, XZ", "none: of the scene"), &
      column_t("displacement_error", "m", always, &
         "Estimated error of each component of displacement", an_error), &
      column_t("pressure_error", "Pa", with_fluid), &
      column_t("stress_error", "Pa", always, &
         "Estimated error of each component of stress", an_error), &
     column_t("temperature", "K", with_heat, "Mean temperature of the cell", "temperature_error"), &
      column_t("temperature_error", "K", with_heat)]

   type(column_t), parameter :: fracture_fields(*) = [ &
      column_t("fracture", "-", always, "Number of the fracture, from 1", label), &
      column_t("arc_length", "m", always, "s_m of fractures.csv", placed), &
      column_t("aperture", "m", with_fluid, "Hydraulic aperture", "aperture_error"), &
      column_t("jump", "m", always, &
         "Jump of the displacement: normal, tangential", "jump_error"), &
      column_t("traction", "Pa", always, &
         "Contact traction: normal, tangential", "traction_error"), &
      column_t("pressure", "Pa", with_fluid, &
         "Fluid pressure in the fracture", "pressure_error"), &
      column_t("flow", "m2/s", with_fluid, "Flow along the fracture", "flow_error"), &
      column_t("state", "-", always, "Contact state: 0 stick, 1 slip, 2 open", states), &
      column_t("aperture_error", "m", with_fluid), &
      column_t("jump_error", "m", always, &
         "Estimated error of jump: normal, tangential", an_error), &
      column_t("traction_error", "Pa", always, &
         "Estimated error of traction: normal, tangential", an_error), &
      column_t("pressure_error", "Pa", with_fluid), &
      column_t("flow_error", "m2/s", with_fluid), &
      column_t("temperature", "K", with_heat, "Temperature of fluid and faces", &
         "temperature_error"), &
      column_t("temperature_error", "K", with_heat)]

   type(column_t), parameter :: intersection_fields(*) = [ &
      column_t("pressure", "Pa", with_fluid, &
         "Fluid pressure at intersections and at fracture ends on sides with prescribed "// &
         "pressure", "pressure_error"), &
      column_t("pressure_error", "Pa", with_fluid)]

   type(column_t), parameter :: window_fields(*) = [ &
      column_t("tip", "-", with_fluid, "Number of a tip that the window evaluates", label)]
   !&>

end module report_keys
