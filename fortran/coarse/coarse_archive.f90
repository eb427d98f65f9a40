!> State and model of the coarse level in an archive (base_archive). Stencils and matrices follow
!! from the mesh, the scene and the fracture cells, and are made again.
module coarse_archive
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_model, only: coarse_model_t
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use contact_archive, only: visit_laws
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: visit_cells, visit_factors, visit_report, visit_state, visit_step_values

contains

   subroutine visit_state(archive, name, state)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(state_t), intent(inout) :: state

      call archive%enter(name)
      call archive%item("time", state%time)
      call archive%list("unknowns", state%unknowns, "3, blocks")
      call archive%list("layer", state%layer, "layer_nodes, layers ?")
      call archive%list("content", state%content, "cells")
      call archive%list("tractions", state%tractions, "corners ?")
      call archive%list("jump", state%jump, "2, 2, fcells")
      call archive%list("slip_before", state%slip_before, "2, fcells")
      call archive%list("slip_path", state%slip_path, "2, fcells ?")
      call archive%list("opened", state%opened, "2, fcells ?")
      call archive%list("opened_before", state%opened_before, "2, fcells ?")
      call archive%list("traction", state%traction, "2, 2, fcells")
      call archive%list("contact", state%contact, "2, fcells")
      call archive%list("pressure", state%pressure, "fcells")
      call archive%list("aperture", state%aperture, "fcells")
      call archive%list("void", state%void, "fcells")
      call archive%list("flow", state%flow, "pairs")
      call archive%list("branch_flow", state%branch_flow, "branches")
      call archive%list("joint_pressure", state%joint_pressure, "joints")
      call archive%list("well_flow", state%well_flow, "well_flows ?")
      call archive%list("well_head", state%well_head, "wells ?")
      call archive%list("well_rate", state%well_rate, "wells ?")
      call archive%list("rock_well_control", state%rock_well_control, "rock_wells")
      call archive%list("rings", state%rings, "ring_nodes, rings ?")
      call archive%list("injection", state%injection, "fcells")
      call archive%list("leakoff", state%leakoff, "fcells")
      call archive%item("guess_dt", state%guess%dt)
      call archive%list("guess_change", state%guess%change)
      call archive%leave()
   end subroutine visit_state

   subroutine visit_report(archive, name, report)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(step_report_t), intent(inout) :: report

      call archive%enter(name)
      call archive%item("iterations", report%iterations)
      call archive%item("converged", report%converged)
      call archive%item("contact_residual", report%contact_residual)
      call archive%item("condition", report%condition)
      call archive%item("error_bound", report%error_bound)
      call archive%item("loop_flow_error", report%loop_flow_error)
      call archive%item("stress_scale", report%stress_scale)
      call archive%item("mass_error", report%mass_error)
      call archive%item("compressed", report%compressed)
      call archive%item("rock_outflow", report%rock_outflow)
      call archive%list("reason", report%reason)
      call archive%item("cell", report%cell)
      call archive%item("is_drained", report%is_drained)
      call archive%leave()
   end subroutine visit_report

   subroutine visit_cells(archive, name, cells)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fracture_cells_t), intent(inout) :: cells

      call archive%enter(name)
      call visit_laws(archive, "law", cells%law)
      call archive%list("residual_aperture", cells%residual_aperture, "fcells")
      call archive%list("roughness", cells%roughness, "fcells")
      call archive%list("share", cells%share, "fcells ?")
      call archive%list("has_tip", cells%has_tip, "fcells ?")
      call archive%list("viscous", cells%viscous, "fcells ?")
      call archive%list("leak_resistance", cells%leak_resistance, "fcells ?")
      ! Set in the first step on a mesh.
      call archive%agree(name, [allocated(cells%share), allocated(cells%has_tip), &
                                allocated(cells%viscous), allocated(cells%leak_resistance)])
      call archive%list("has_layer", cells%has_layer, "2, fcells ?")
      call archive%list("skin", cells%skin, "fcells ?")
      call archive%list("injection", cells%injection, "fcells")
      call archive%list("pressure_in_situ", cells%pressure_in_situ, "fcells ?")
      call archive%list("viscosity_ratio", cells%viscosity_ratio, "fcells ?")
      call archive%leave()
   end subroutine visit_cells

   !> What the last step has set in a model.
   subroutine visit_step_values(archive, name, model)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(coarse_model_t), intent(inout) :: model

      call archive%enter(name)
      call archive%enter("wells")
      call archive%list("control", model%wells%control)
      call archive%list("rate", model%wells%rate)
      call archive%list("pressure", model%wells%pressure)
      call archive%leave()
      call archive%enter("rock_wells")
      call archive%list("index", model%rock_wells%index, "rock_wells ?")
      call archive%list("left_over", model%rock_wells%left_over, "rock_wells ?")
      call archive%list("ring_flow", model%rock_wells%ring_flow, "rings ?")
      call archive%list("source", model%rock_wells%source)
      call archive%list("conductance", model%rock_wells%conductance, "rock_wells ?")
      call archive%list("rock", model%rock_wells%rock, "rock_wells ?")
      call archive%list("control", model%rock_wells%control)
      call archive%leave()
      call archive%list("joint_injection", model%joints%injection, "joints")
      call archive%list("joint_is_shut", model%joints%is_shut, "branches")
      call archive%list("joint_side_pressure", model%joints%side_pressure, "joints")
      call archive%list("ends_viscous", model%ends%viscous, "mesh_tips ?")
      call archive%list("source", model%source)
      call archive%leave()
   end subroutine visit_step_values

   !> Factors for a step length, made again from the same matrix in the same order.
   subroutine visit_factors(archive, name, model, mesh, error)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(coarse_model_t), intent(inout) :: model
      type(mesh_t), intent(in) :: mesh
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: dt
      real(rk), allocatable :: spring(:)
      integer(ik) :: factorizations

      call archive%enter(name)
      associate (condensed => model%condensed)
         dt = condensed%dt
         factorizations = condensed%factorizations
         if (allocated(condensed%spring)) spring = condensed%spring
         call archive%set_extent("condensed", 6*mesh%fracture%n_cells)
         call archive%item("dt", dt)
         call archive%item("factorizations", factorizations)
         call archive%list("spring", spring, "condensed ?")
         call archive%list("held", condensed%held, "held_cells ?")
         call archive%item("needs_exchanges", condensed%factors%needs_exchanges)
         if (archive%is_loading .and. dt > 0.0_rk) then
            if (model%rock_wells%n > 0) call model%rock_wells%take_place(model%matrix)
            call model%layers%set_terms(dt, model%matrix)
            call condensed%factorize(mesh, model%matrix, dt, error)
            if (allocated(error)) return
            if (allocated(spring)) call condensed%support(spring)
         end if
         condensed%factorizations = factorizations
         call archive%list("rock", condensed%rock, "condensed_rock ?")
         call archive%list("diagonal", condensed%diagonal, "condensed ?")
      end associate
      call model%factors%visit(archive, model%condensed%coupling%n_bulk, error)
      call archive%leave()
   end subroutine visit_factors

end module coarse_archive
