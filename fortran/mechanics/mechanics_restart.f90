!> The complete state of a simulation without a fluid in an archive (docs/architecture.md).
submodule(mechanics_simulation) mechanics_restart
   use base_kinds, only: lk
   use mesh_archive, only: visit_mesh, visit_network
   use report_fields_archive, only: visit_snapshot
   use report_restart, only: visit_simulation
   implicit none(type, external)

contains

   module procedure prepare

      self%end_time = scene%load%to
      call self%programme%begin(scene%load)
      call self%take_scene(scene)
      call self%chronicle%clear()
   end procedure prepare

   module procedure visit
      integer(lk) :: n

      call visit_simulation(archive, self)
      if (allocated(archive%fault)) return
      call self%body%visit(archive, self%scene, self%start, self%network, timers, error)
      if (allocated(error) .or. allocated(archive%fault)) return
      call archive%enter("loaded_body")
      call archive%item("is_cut", self%is_cut)
      call archive%item("meshed_vertices", self%meshed_vertices)
      call archive%item("is_trying", self%is_trying)
      call archive%item("factor", self%factor)
      call archive%item("bounds", self%bounds)
      call archive%item("accepted_moment", self%accepted_moment)
      call archive%leave()
      call self%programme%visit(archive)
      call archive%item("has_onset", self%has_onset)
      call archive%item("accepted_factor", self%accepted_factor)
      call archive%item("has_increment", self%has_increment)
      call self%increment%visit(archive)
      call self%dead_load%visit(archive)
      call archive%item("was_bifurcation", self%was_bifurcation)
      call archive%list("was_uncertain", self%was_uncertain, "tips ?")
      call visit_network(archive, "shown_network", self%shown_network)
      call visit_mesh(archive, "shown_mesh", self%shown_mesh)
      n = merge(1_lk, -1_lk, allocated(self%good))
      call archive%count("good", n)
      if (archive%is_loading .and. n > 0_lk) allocate (self%good)
      if (n > 0_lk) call visit_snapshot(archive, "good", self%good)
   end procedure visit

end submodule mechanics_restart
